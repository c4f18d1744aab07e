"""Runs an ONNX file of `urbanverse export-onnx` or of another program, one control step per call.

In:   a file. Out: `OnnxAgent`: observations of n robots -> actions, with memory if the file has memory inputs. When:
every control step.
"""

import dataclasses
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from ..datatypes.policy_file import METADATA_KEY, NEXT, PolicyRecord, memories

IMAGE, PROPRIO, PRIVILEGED = "pixels/front", "proprio", "privileged"
#: Observations that a policy may request.
OBSERVATIONS = (IMAGE, "goal", PROPRIO, PRIVILEGED)
#: Other names of observations (docs/sources/reference_systems.md b.7: `rgb`, `goal_vector`).
ALIASES = {"rgb": IMAGE, "image": IMAGE, "pixels": IMAGE, "goal_vector": "goal"}
_DTYPES: dict[str, Any] = {"tensor(float)": np.float32, "tensor(double)": np.float64, "tensor(uint8)": np.uint8}


def open_session(path: pathlib.Path, accelerated: bool = False) -> Any:
    """An `onnxruntime.InferenceSession`.

    Args:
      accelerated: on CUDA where onnxruntime-gpu is installed, and with all threads otherwise; not reproducible to the
        bit. The default is one thread of the CPU.

    Raises:
      ValidationError: the file does not exist, or onnxruntime cannot load it.
    """
    import onnxruntime

    if not path.is_file():
        raise ValidationError(f"--policy: found no file {path}, needed an ONNX file.")
    options = onnxruntime.SessionOptions()
    providers = ["CPUExecutionProvider"]
    if accelerated:
        known = onnxruntime.get_available_providers()
        providers = [p for p in ("CUDAExecutionProvider", *providers) if p in known]
    else:
        # One thread, for reproducible sums.
        options.intra_op_num_threads = 1
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=providers)
    except Exception as error:  # onnxruntime's own classes of errors differ between versions
        reason = str(error).splitlines()[0]
        raise ValidationError(
            f"{path}: found a file that onnxruntime cannot load ({reason}), needed an ONNX file."
        ) from error


def _record_of(session: Any, path: pathlib.Path) -> PolicyRecord | None:
    text = session.get_modelmeta().custom_metadata_map.get(METADATA_KEY)
    return None if text is None else PolicyRecord.from_json(text, str(path))


class OnnxAgent:
    """An ONNX file and its memory.

    Its inputs are observations by name (see `ALIASES`): images (n, H, W, C) or (n, C, H, W), as uint8 or as floats in
    [0, 1]. The output `action`, or otherwise the first one, is the action (n, 2). An input X with an output `next_`X is
    memory: zeros when an episode begins, then that output of the previous step. A file for one robot (a first axis of
    1) is called n times.

    Attributes:
      observations: names of its observations, of `OBSERVATIONS`.
      size: (height, width) of its images; None if it has none, or takes any size.
      record: metadata of `urbanverse export-onnx`; None for files of other programs.

    Raises:
      ValidationError: the file does not exist, onnxruntime cannot load it, or no robot has its inputs.
    """

    def __init__(self, path: pathlib.Path) -> None:
        self._session = open_session(path)
        given = self._session.get_inputs()
        outputs = [o.name for o in self._session.get_outputs()]
        remembered = memories([i.name for i in given], outputs)
        self._inputs = [_Input.of(i, path) for i in given if i.name not in remembered]
        self._memory = [_Memory.of(i, path) for i in given if i.name in remembered]
        self.record = _record_of(self._session, path)
        self.observations = tuple({i.observation: None for i in self._inputs})
        self.size = next((i.size for i in self._inputs if i.observation == IMAGE), None)
        self._outputs = ["action" if "action" in outputs else outputs[0], *(NEXT + m.name for m in self._memory)]
        self._single = any(i.single for i in (*self._inputs, *self._memory))
        self._kept: dict[str, np.ndarray] = {}

    def begin(self, count: int) -> None:
        """Resets the memory of `count` robots."""
        self._kept = {m.name: np.zeros((count, *m.shape), m.dtype) for m in self._memory}

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        """Actions (n, 2) for observations with a leading axis n."""
        given = {i.name: i.prepared(obs) for i in self._inputs}
        count = len(next(iter(given.values())))
        if self._memory and len(next(iter(self._kept.values()), ())) != count:
            self.begin(count)
        given |= self._kept
        answers = run_rows(self._session, self._outputs, given, count if self._single else None)
        action, *kept = answers
        self._kept = {m.name: x for m, x in zip(self._memory, kept, strict=True)}
        return action


def run_rows(session: Any, outputs: Sequence[str], given: Mapping[str, np.ndarray], rows: int | None) -> list[Any]:
    """Outputs of a session; rows: number of robots for a file that takes one robot at a time, else None."""
    if rows is None:
        return session.run(list(outputs), dict(given))
    slices = [slice(n, n + 1) for n in range(rows)]
    answers = [session.run(list(outputs), {k: x[r] for k, x in given.items()}) for r in slices]
    return [np.concatenate(part) for part in zip(*answers, strict=True)]


@dataclasses.dataclass(frozen=True)
class _Input:
    """One input of an ONNX file; channels_first: images are (n, C, H, W); single: its first axis is 1."""

    name: str
    observation: str
    dtype: Any
    channels_first: bool
    single: bool
    size: tuple[int, int] | None

    @staticmethod
    def of(value: Any, path: pathlib.Path) -> "_Input":
        observation = ALIASES.get(value.name, value.name)
        if observation not in (*OBSERVATIONS, "privileged_map"):
            known = ", ".join([*OBSERVATIONS, *ALIASES])
            raise ValidationError(
                f"{path}: found the input {value.name!r}, needed one of {known}, or an output "
                f"{NEXT + value.name!r} for an input that is memory."
            )
        shape, size, first = list(value.shape), None, False
        if observation == IMAGE:
            if len(shape) != 4:
                raise ValidationError(f"{path}: found the input {value.name!r} of shape {shape}, needed 4 axes.")
            first = shape[1] in (3, 4) and shape[3] not in (3, 4)
            sides = shape[2:] if first else shape[1:3]
            size = (sides[0], sides[1]) if all(isinstance(n, int) for n in sides) else None
        return _Input(value.name, observation, _dtype(value, path), first, shape[0] == 1, size)

    def prepared(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        x = obs[self.observation]
        if self.observation == IMAGE:
            x = np.moveaxis(x, -1, 1) if self.channels_first else x
            x = x / np.float32(255.0) if self.dtype is not np.uint8 else x
        return np.ascontiguousarray(x, self.dtype)


@dataclasses.dataclass(frozen=True)
class _Memory:
    """An input that takes an output of the previous step; shape without the axis of robots."""

    name: str
    shape: tuple[int, ...]
    dtype: Any
    single: bool

    @staticmethod
    def of(value: Any, path: pathlib.Path) -> "_Memory":
        if not all(isinstance(n, int) for n in value.shape[1:]):
            raise ValidationError(
                f"{path}: found the memory {value.name!r} of shape {value.shape}, needed fixed sizes."
            )
        return _Memory(value.name, tuple(value.shape[1:]), _dtype(value, path), value.shape[0] == 1)


def _dtype(value: Any, path: pathlib.Path) -> Any:
    if value.type not in _DTYPES:
        raise ValidationError(f"{path}: found the input {value.name!r} of {value.type}, needed one of {list(_DTYPES)}.")
    return _DTYPES[value.type]
