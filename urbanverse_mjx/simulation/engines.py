"""Chooses an engine by name."""

import dataclasses
from typing import Any

from ..datatypes import NounError, RobotSpec, SceneBank

IMPLS = ("auto", "jax")


def make_engine(
    bank: SceneBank,
    robot: RobotSpec,
    impl: str = "auto",
    control_dt: float = 0.2,
    physics_dt: float | None = None,
    num_slots: int = 16,
) -> Any:
    """A `Simulator` over a bank.

    Args:
      bank, robot: what to simulate.
      impl: "jax" (MJX, any device) or "auto", which is "jax" as long as there is no other engine.
      control_dt: s, one control step; physics_dt: s, one physics step, default the robot's.
      num_slots: object hulls streamed per control step.

    Raises:
      NounError: unknown engine or steps that do not divide.
    """
    if impl not in IMPLS:
        raise NounError(f"impl: found {impl!r}, needed one of {', '.join(IMPLS)}.")
    from .jax_engine import JaxEngine

    if physics_dt is not None:
        robot = dataclasses.replace(robot, physics_timestep=physics_dt)
    return JaxEngine(bank, robot, control_dt=control_dt, num_slots=num_slots)
