"""Chooses an engine by name."""

import dataclasses
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import jax

from ..datatypes import AgentShapes, PlacedBank, RobotSpec, SceneBank, ValidationError
from ..datatypes import validation as v
from ..datatypes.bank_reach import with_reach
from .collision_slots.body_slots import Sizes

if TYPE_CHECKING:
    from .jax_engine import JaxEngine
    from .warp_engine import WarpEngine

IMPLS = ("auto", "jax", "warp", "warp-fused")
#: Platforms of JAX that Warp has too.
_OF_WARP = ("cpu", "gpu", "cuda")


def make_engine(
    bank: SceneBank,
    robot: RobotSpec,
    impl: str = "auto",
    control_dt: float = 0.2,
    physics_dt: float | None = None,
    num_slots: int = 16,
    agents: AgentShapes | None = None,
    movable: Sizes | None = None,
    friction: str = "uniform",
    **sizes: Any,
) -> "JaxEngine | WarpEngine":
    """Makes an engine for a bank.

    Args:
      bank, robot: what to simulate.
      impl: "jax" (MJX, any device), "warp" (MuJoCo Warp, CUDA and CPU), "warp-fused" (the same physics in one launch
        per control step, CUDA and CPU, for robots of at most 32 velocities without movable objects), or "auto":
        "warp-fused" where it serves, else "warp" on CUDA and "jax" on a CPU.
      control_dt: s, one control step.
      physics_dt: s, one physics step, default the robot's.
      num_slots: least number of object hulls streamed per control step, increased if the bank's streets need more; 0 =
        none.
      agents: shapes of moving agents; None = none.
      movable: sizes for objects that can be pushed; None = none.
      friction: "uniform" (that of the bank's ground, 1 in streets; the larger of two surfaces counts) or "materials"
        (that of the ground's materials; the smaller counts).
      sizes: other sizes of the engine, such as num_prism_slots, num_contacts, iterations, line_steps.

    Raises:
      ValidationError: unknown engine, steps that do not divide, or a robot that reaches farther in a control step than
        the grids of a bank can be made to, or the jax engine without MJX.
    """
    if impl not in IMPLS:
        raise ValidationError(f"impl: found {impl!r}, needed one of {', '.join(IMPLS)}.")
    reach = robot.circumradius + robot.max_speed * control_dt
    if isinstance(bank, PlacedBank):
        _check_places(bank, robot, reach)
    bank = with_reach(bank, reach)
    if physics_dt is not None and physics_dt != robot.physics_timestep:
        robot = with_timestep(robot, physics_dt)
    same: dict[str, Any] = {"control_dt": control_dt, "num_slots": num_slots, "agents": agents, "movable": movable}
    same["friction"] = friction
    # Warp takes a second to import and prints a message, so it is imported on first use.
    if impl == "warp-fused" or (impl == "auto" and jax.default_backend() in _OF_WARP):
        from .warp_engine import NotFusible, WarpEngine

        try:
            return WarpEngine(bank, robot, **same, fused=True, **sizes)
        except NotFusible:
            if impl != "auto" or isinstance(bank, PlacedBank):
                raise
    if isinstance(bank, PlacedBank):
        raise v.fail(
            "impl", f"{impl!r} with scenes that come and go", "'warp-fused'", "set config.schedule.places to 0"
        )
    if general_impl(impl) == "warp":
        from .warp_engine import WarpEngine

        return WarpEngine(bank, robot, **same, **sizes)
    try:
        from .jax_engine import JaxEngine
    except ImportError as error:
        found = f"{impl!r} without MJX ({error})"
        raise v.fail("impl", found, "the package mujoco-mjx for the jax engine", "try impl='warp'") from error

    return JaxEngine(bank, robot, **same, **sizes)


def _check_places(bank: PlacedBank, robot: RobotSpec, reach: float) -> None:
    """Refuses a robot for which the grids of scenes that come and go would have to be made anew."""
    has = float(bank.meta["grid_reach"])
    if reach > has + 1e-6:
        raise v.fail(
            f"config.schedule.places with the robot {robot.name!r}",
            f"a reach of {reach:.2f} m in a control step",
            f"at most the {has:.2f} m of the folder's grids",
            "set it to 0",
        )


def load_kernels(engines: Sequence[Any], threads: int) -> None:
    """Compiles the kernels of several engines' fused steps on the default device at the same time; the first step of
    each engine would do so while no other one can step. Other engines have nothing to load here."""
    fused = [engine for engine in engines if getattr(engine, "fused", False)]
    if fused:
        from .warp_engine import load_fused_steps

        load_fused_steps(fused, threads)


def general_impl(impl: str) -> str:
    """The engine, "jax" or "warp", that serves all robots: `impl` itself, or the one that "auto" takes here."""
    if impl != "auto":
        return impl
    platform = jax.default_backend()
    return "warp" if platform in _OF_WARP and platform != "cpu" else "jax"


def with_timestep(robot: RobotSpec, timestep: float) -> RobotSpec:
    """The robot with another physics step (s), also in its MJCF."""
    root = ET.fromstring(robot.mjcf)
    option = root.find("option")
    if option is None:
        option = ET.SubElement(root, "option")
    option.set("timestep", repr(float(timestep)))
    return dataclasses.replace(robot, physics_timestep=timestep, mjcf=ET.tostring(root, encoding="unicode"))
