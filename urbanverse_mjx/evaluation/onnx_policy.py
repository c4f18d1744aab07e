"""Policies in ONNX files of `urbanverse export-onnx` or other sources, as external policies.

In:   a file. Out: `ExternalPolicy`: a `BatchAgent`, with memory if the file has memory inputs. When: once per run;
called every control step, outside jit.
"""

import hashlib
import pathlib

from ..policies.onnx_agent import OnnxAgent
from .external import ExternalPolicy


def content_sha256(path: pathlib.Path) -> str:
    """SHA-256 of an ONNX file, and of the weights where they lie beside it in a file of the same name and `.data`."""
    digest, weights = hashlib.sha256(path.read_bytes()), path.with_name(f"{path.name}.data")
    if weights.is_file():
        with weights.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    return digest.hexdigest()


def load_onnx(path: pathlib.Path) -> ExternalPolicy:
    """Loads a policy from an ONNX file, see `policies.onnx_agent.OnnxAgent`.

    Raises:
      ValidationError: the file does not exist, onnxruntime cannot load it, or no robot has its inputs.
    """
    agent = OnnxAgent(path)
    return ExternalPolicy(agent, agent.observations, agent.size, agent.record)
