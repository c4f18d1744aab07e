"""Policies from outside: any Python callable, any ONNX file.

In:   `module:name`, or a file.
Out:  `ForeignPolicy`: a `BatchAgent`, and what it looks at.
When: once per run; asked every control step, outside jit.
"""

import dataclasses
import importlib
import inspect
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..datatypes import NounError, optional
from .agents import BatchAgent

PICTURE, PRIVILEGED = "pixels/front", "privileged"
#: Observations that a policy may ask for, and what one is given that names none: what the robot senses.
OBSERVATIONS = (PICTURE, "goal", PRIVILEGED)
SENSED = (PICTURE, "goal")
#: Names that others give to observations (facts/reference_systems.md b.7: `rgb`, `goal_vector`).
ALIASES = {"rgb": PICTURE, "image": PICTURE, "pixels": PICTURE, "goal_vector": "goal"}


@dataclasses.dataclass(frozen=True)
class ForeignPolicy:
    """A policy that lives outside JAX; a `BatchAgent` that hands over the declared observations and no others.

    Attributes:
      agent: observations of n envs -> actions (n, 2).
      observations: names of what it is given, of `OBSERVATIONS`.
      size: (height, width) of the pictures it looks at, None = whatever the preset draws.
    """

    agent: BatchAgent
    observations: tuple[str, ...]
    size: tuple[int, int] | None = None

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        """Actions (n, 2).

        Raises:
          NounError: the environment does not give what the policy declares.
        """
        for name in self.observations:
            if name not in obs:
                raise NounError(f"policy: found no observation {name!r} in the environment, needed it; it declares it.")
        return self.agent({name: obs[name] for name in self.observations})

    @property
    def sees(self) -> bool:
        """Whether it looks at pictures."""
        return PICTURE in self.observations

    @property
    def privileged(self) -> bool:
        """Whether it asks for what no sensor of the robot measures."""
        return PRIVILEGED in self.observations


def load_callable(name: str) -> ForeignPolicy:
    """The callable that `module:name` names, or an instance of it where it is a class.

    It is given observations by name, each with a leading axis of n envs that begin together and keep their places, and
    returns (n, 2) actions in [-1, 1]: an instance may remember. Its attribute `observations` names those that it is
    given, of `OBSERVATIONS`; without one it is given the picture and the goal. Pictures are drawn only where
    "pixels/front" is among them; "privileged" is recorded in the report.

    Raises:
      NounError: no such module or name, nothing that can be called, or observations that no environment has.
    """
    module_name, _, attribute = name.partition(":")
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module_name}.".startswith(f"{error.name}."):
            raise
        raise NounError(f"--policy: found no module {module_name!r}, needed one on the PYTHONPATH.") from error
    found = module
    for part in attribute.split("."):
        if not hasattr(found, part):
            raise NounError(f"--policy: found no {attribute!r} in {module_name!r}, needed a function or class there.")
        found = getattr(found, part)
    found = found() if inspect.isclass(found) else found
    if not callable(found):
        raise NounError(f"--policy: found {name!r} to be a {type(found).__name__}, needed something to call.")
    wanted = getattr(found, "observations", SENSED)
    wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    for observation in wanted:
        if observation not in OBSERVATIONS:
            raise NounError(
                f"--policy: found the observation {observation!r} in {name!r}, needed some of "
                f"{', '.join(OBSERVATIONS)}."
            )
    agent: Any = found
    return ForeignPolicy(agent, wanted)


def load_onnx(path: pathlib.Path) -> ForeignPolicy:
    """A policy from an ONNX file, run by onnxruntime on the CPU.

    Its inputs are observations by name (see `ALIASES`): pictures (n, H, W, C) or (n, C, H, W), as uint8 or as floats in
    [0, 1]; its first output is the action (n, 2). A file made for one env (a first axis of 1) is asked n times.

    Raises:
      NounError: no such file, onnxruntime is not installed, or inputs that no robot has.
    """
    if not path.is_file():
        raise NounError(f"--policy: found no file {path}, needed an ONNX file.")
    onnxruntime = optional.package("onnxruntime", f"--policy {path.name}", "onnx")
    options = onnxruntime.SessionOptions()
    # One thread adds up in one order: the same numbers every time.
    options.intra_op_num_threads = 1
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's own classes of errors differ between versions
        reason = str(error).splitlines()[0]
        raise NounError(
            f"{path}: found a file that onnxruntime cannot load ({reason}), needed an ONNX file."
        ) from error
    inputs = [_Input.of(i, path) for i in session.get_inputs()]
    output = session.get_outputs()[0].name

    def ask(obs: Mapping[str, np.ndarray]) -> np.ndarray:
        given = {i.name: i.prepared(obs) for i in inputs}
        if any(i.single for i in inputs):
            number = len(next(iter(given.values())))
            rows = [{k: x[n : n + 1] for k, x in given.items()} for n in range(number)]
            return np.concatenate([session.run([output], row)[0] for row in rows])
        return session.run([output], given)[0]

    pictures = [i for i in inputs if i.observation == PICTURE]
    return ForeignPolicy(ask, tuple({i.observation: None for i in inputs}), pictures[0].size if pictures else None)


@dataclasses.dataclass(frozen=True)
class _Input:
    """One input of an ONNX file; channels_first: pictures are (n, C, H, W); single: its first axis is 1."""

    name: str
    observation: str
    dtype: Any
    channels_first: bool
    single: bool
    size: tuple[int, int] | None

    @staticmethod
    def of(value: Any, path: pathlib.Path) -> "_Input":
        observation = ALIASES.get(value.name, value.name)
        if observation not in (PICTURE, "goal"):
            known = ", ".join([PICTURE, "goal", *ALIASES])
            raise NounError(f"{path}: found the input {value.name!r}, needed one of {known}.")
        dtypes = {"tensor(float)": np.float32, "tensor(double)": np.float64, "tensor(uint8)": np.uint8}
        if value.type not in dtypes:
            raise NounError(f"{path}: found the input {value.name!r} of {value.type}, needed one of {list(dtypes)}.")
        shape, size, first = list(value.shape), None, False
        if observation == PICTURE:
            if len(shape) != 4:
                raise NounError(f"{path}: found the input {value.name!r} of shape {shape}, needed 4 axes.")
            first = shape[1] in (3, 4) and shape[3] not in (3, 4)
            sides = shape[2:] if first else shape[1:3]
            size = (sides[0], sides[1]) if all(isinstance(n, int) for n in sides) else None
        return _Input(value.name, observation, dtypes[value.type], first, shape[0] == 1, size)

    def prepared(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        x = obs[self.observation]
        if self.observation == PICTURE:
            x = np.moveaxis(x, -1, 1) if self.channels_first else x
            x = x / np.float32(255.0) if self.dtype is not np.uint8 else x
        return np.ascontiguousarray(x, self.dtype)
