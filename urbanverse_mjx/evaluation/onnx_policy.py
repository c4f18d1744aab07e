"""Policies in ONNX files of `urbanverse export-onnx` or other sources, as external policies.

In:   a file. Out: `ExternalPolicy`: a `BatchAgent`, with memory if the file has memory inputs. When: once per run;
called every control step, outside jit.
"""

import pathlib

from ..policies.onnx_agent import OnnxAgent
from .external import ExternalPolicy


def load_onnx(path: pathlib.Path) -> ExternalPolicy:
    """Loads a policy from an ONNX file, see `policies.onnx_agent.OnnxAgent`.

    Raises:
      ValidationError: the file does not exist, onnxruntime cannot load it, or no robot has its inputs.
    """
    agent = OnnxAgent(path)
    return ExternalPolicy(agent, agent.observations, agent.size, agent.record)
