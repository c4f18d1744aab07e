"""Renders an environment's states for display: street, robot, moving agents and objects."""

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np

from ..datatypes import AgentMotion, RobotSpec, SceneBank, ValidationError
from .types import State

#: m; a larger movement between two states means that another episode has begun.
_MAX_STEP = 2.0


@runtime_checkable
class RenderableEnv(Protocol):
    """The part of an environment that rendering of its states needs, see `StagedBase`."""

    bank: SceneBank
    num_bodies: int

    @property
    def dt(self) -> float: ...
    @property
    def robot(self) -> RobotSpec: ...
    @property
    def agent_appearances(self) -> tuple[int, ...]: ...
    def agents_of(self, carried: Any, /) -> AgentMotion | None: ...


class StateRenderer:
    """Renders states of one environment with sun shadows and four rays per pixel.

    Args:
      env: the environment.
      height, width: pixels.
      camera: name of a camera in the robot's MJCF; None follows the robot from behind.

    Raises:
      ValidationError: the robot has no such camera, or a size is below one.
    """

    def __init__(self, env: RenderableEnv, height: int, width: int, camera: str | None) -> None:
        from ..simulation.rendering.cameras import FOLLOWING_FOV
        from ..simulation.rendering.renderer import Renderer

        self._follows = camera is None
        self._frames_per_second, self._height = 1.0 / env.dt, env.robot.planner_height
        renderer = Renderer(
            env.bank,
            env.robot,
            height,
            width,
            shadows=True,
            samples=2,
            camera=camera,
            agents=env.agent_appearances,
            bodies=env.num_bodies,
        )

        def through_robot(carried: Any) -> jax.Array:
            sim = carried.sim
            return renderer(sim.scene, sim.xpos, sim.xquat, 0, env.agents_of(carried), sim.bodies)["rgb"]

        def following(carried: Any, camera_position: jax.Array, turn: jax.Array) -> jax.Array:
            sim, agents = carried.sim, env.agents_of(carried)
            view = renderer.view(
                sim.scene, camera_position, turn, FOLLOWING_FOV, sim.xpos, sim.xquat, 0, agents, sim.bodies
            )
            return view["rgb"]

        self._draw = jax.jit(jax.vmap(following if self._follows else through_robot))

    def __call__(self, states: Sequence[State[Any]]) -> list[np.ndarray]:
        """(height, width, 3) uint8 for each state of one env, in their order.

        Raises:
          ValidationError: states are batched, or lack the state of the simulation.
        """
        from ..simulation.rendering.cameras import in_batches

        if not states:
            return []
        for state in states:
            scene = getattr(getattr(state.data, "sim", None), "scene", None)
            if scene is None:
                raise ValidationError(
                    "trajectory: found a state without its sim, needed whole states as step returns them."
                )
            if jnp.ndim(scene):
                raise ValidationError(
                    f"trajectory: found a state of {len(scene)} envs, needed one env's; take "
                    "jax.tree.map(lambda x: x[i], state)."
                )
        carried = jax.tree.map(lambda *x: jnp.stack(x), *[state.data for state in states])
        cameras = self._following(carried) if self._follows else ()
        return list(in_batches(self._draw, carried, *cameras))

    def _following(self, carried: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions (T, 3) and rotations (T, 4) of the camera, which follows smoothly within an episode."""
        from ..simulation.rendering.cameras import following_cameras

        scene, xpos, xquat = (np.asarray(x) for x in (carried.sim.scene, carried.sim.xpos, carried.sim.xquat))
        apart = np.linalg.norm(np.diff(xpos[:, 1], axis=0), axis=-1) > _MAX_STEP
        starts = np.flatnonzero((np.diff(scene) != 0) | apart) + 1
        parts = zip(np.split(xpos, starts), np.split(xquat, starts), strict=True)
        found = [following_cameras(p, q, self._frames_per_second, self._height) for p, q in parts]
        camera_position, turn = (np.concatenate(x) for x in zip(*found, strict=True))
        return camera_position, turn
