"""Policies from outside: any Python callable; `onnx_policy` reads ONNX files.

In:   `module:name`. Out:  `ExternalPolicy`: a `BatchAgent`, and its observations. When: once per run; called every
control step, outside jit.
"""

import dataclasses
import importlib
import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from ..datatypes.policy_file import PolicyRecord
from .agents import BatchAgent, Beginning

IMAGE, PROPRIO, PRIVILEGED = "pixels/front", "proprio", "privileged"
#: Observations that a policy may request, and the default: those of the robot's sensors.
OBSERVATIONS = (IMAGE, "goal", PROPRIO, PRIVILEGED)
SENSED = (IMAGE, "goal")


@dataclasses.dataclass(frozen=True)
class ExternalPolicy:
    """A policy outside JAX: a `BatchAgent` that passes on the declared observations only.

    Attributes:
      agent: observations of n envs -> actions (n, 2).
      observations: their names, of `OBSERVATIONS`.
      size: (height, width) of its images, None = that of the preset.
      record: metadata of an ONNX file, None without metadata in our format.
    """

    agent: BatchAgent
    observations: tuple[str, ...]
    size: tuple[int, int] | None = None
    record: PolicyRecord | None = None

    def begin(self, count: int) -> None:
        """Tells a policy that remembers that `count` episodes begin."""
        if isinstance(self.agent, Beginning):
            self.agent.begin(count)

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        """Actions (n, 2).

        Raises:
          ValidationError: the environment lacks an observation that the policy declares.
        """
        for name in self.observations:
            if name not in obs:
                raise ValidationError(
                    f"policy: found no observation {name!r} in the environment, needed it; it declares it."
                )
        return self.agent({name: obs[name] for name in self.observations})

    @property
    def sees(self) -> bool:
        """Whether it takes images."""
        return IMAGE in self.observations

    @property
    def privileged(self) -> bool:
        """Whether it requests data that no sensor of the robot measures."""
        return any(name.startswith(PRIVILEGED) for name in self.observations)


def load_callable(name: str) -> ExternalPolicy:
    """The callable that `module:name` names, or an instance of it where it is a class.

    It is given observations by name, each with a leading axis of n envs that begin together and keep their places, and
    returns (n, 2) actions in [-1, 1]. An instance may remember: its method `begin(n)`, where it has one, is called
    before n episodes begin. Its attribute `observations` names those that it is given, of `OBSERVATIONS`; without one
    it is given the image and the goal. Images are drawn only where "pixels/front" is among them; "privileged" is
    recorded in the report.

    Raises:
      ValidationError: no such module or name, an object that cannot be called, or observations that no environment has.
    """
    module_name, _, attribute = name.partition(":")
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module_name}.".startswith(f"{error.name}."):
            raise
        raise ValidationError(f"--policy: found no module {module_name!r}, needed one on the PYTHONPATH.") from error
    found = module
    for part in attribute.split("."):
        if not hasattr(found, part):
            raise ValidationError(
                f"--policy: found no {attribute!r} in {module_name!r}, needed a function or class there."
            )
        found = getattr(found, part)
    found = found() if inspect.isclass(found) else found
    if not callable(found):
        raise ValidationError(f"--policy: found {name!r} to be a {type(found).__name__}, needed something to call.")
    wanted = getattr(found, "observations", SENSED)
    wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    for observation in wanted:
        if observation not in OBSERVATIONS:
            raise ValidationError(
                f"--policy: found the observation {observation!r} in {name!r}, needed some of "
                f"{', '.join(OBSERVATIONS)}."
            )
    agent: Any = found
    return ExternalPolicy(agent, wanted)
