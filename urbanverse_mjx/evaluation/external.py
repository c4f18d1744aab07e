"""External policies: any Python callable; `onnx_policy` reads ONNX files.

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
from ..policies.onnx_agent import IMAGE, OBSERVATIONS, PRIVILEGED
from .agents import BatchAgent, Beginning, SeesGoal

#: Observations of a callable that names none: those of the robot's sensors.
SENSED = (IMAGE, "goal")


@dataclasses.dataclass(frozen=True)
class ExternalPolicy:
    """A policy outside JAX: a `BatchAgent` that receives only the observations it declares.

    Attributes:
      agent: observations of n envs -> actions (n, 2).
      observations: names of its observations, of `OBSERVATIONS`.
      size: (height, width) of its images; None for that of the preset.
      record: metadata of an ONNX file; None without metadata of this package.
    """

    agent: BatchAgent
    observations: tuple[str, ...]
    size: tuple[int, int] | None = None
    record: PolicyRecord | None = None

    def begin(self, count: int) -> None:
        """Notifies a recurrent policy that `count` episodes begin."""
        if isinstance(self.agent, Beginning):
            self.agent.begin(count)

    @property
    def sees_goal(self) -> bool:
        """Whether the policy takes camera images at the goals."""
        return isinstance(self.agent, SeesGoal) and self.agent.sees_goal

    def see_goal(self, images: np.ndarray) -> None:
        """Passes on (n, H, W, 3) u8, camera images at the goals of the episodes that begin next."""
        if isinstance(self.agent, SeesGoal):
            self.agent.see_goal(images)

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
        """Whether the policy uses images."""
        return IMAGE in self.observations

    @property
    def privileged(self) -> bool:
        """Whether the policy requests data that no sensor of the robot measures."""
        return any(name.startswith(PRIVILEGED) for name in self.observations)


def load_callable(name: str) -> ExternalPolicy:
    """Loads the callable `module:name`; a class is instantiated.

    It is called with observations by name, each with a leading axis of n envs that begin together and keep their order,
    and returns (n, 2) actions in [-1, 1]. An instance may have memory: its method `begin(n)`, if it has one, is called
    before n episodes begin. Its attribute `observations` lists the observations it receives, of `OBSERVATIONS`; the
    default is image and goal. Images are rendered only if "pixels/front" is listed; "privileged" is recorded in the
    report.

    Raises:
      ValidationError: the module or name does not exist, the object is not callable, or no environment has its
        observations.
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
