"""Several robots in one street: each is an env of its own, and consecutive envs tell each other where they are.

In:   poses of the robots of a group, which are consecutive envs of a batch.
Out:  the others of the group as moving agents, for the engine, the renderer and distances.
When: at reset and twice in every control step, inside jit, under vmap.

An env knows nothing of its batch, so the exchange is a function with its own rule for vmap: alone a robot has the
street to itself, and under vmap the batch is cut into groups. Envs of a group that are in different scenes do not see
each other.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float, Int, Key

from ...crowds.bodies import Bodies
from ...crowds.crowd import Crowd
from ...datatypes import AgentMotion, AgentShapes, RobotSpec, SceneBank, SimState, ValidationError
from ...geometry import rotations
from ...robots.description import at_rest
from ..types import NavState, Result
from .dynamic import DynamicStreet
from .dynamic_tables import ground_tables

#: Kind of the agents that are robots, in `SceneBank.agents`.
ROBOT = "robot"
#: m between the starts of two robots of a group.
START_SPACING = 1.5
#: Number of rows of the table among which a robot that begins anew takes one that is free.
TRIES = 16


class Told(NamedTuple):
    """What a robot tells the others of its group.

    Attributes:
      scene: () i32; there: () bool, whether there is such a robot.
      xy: (2,) m, the middle of its footprint; yaw: () rad; velocity: (2,) m/s; turn: () rad/s.
    """

    scene: Int[Array, "*n"]
    there: Any
    xy: Float[Array, "*n 2"]
    yaw: Float[Array, "*n"]
    velocity: Float[Array, "*n 2"]
    turn: Float[Array, "*n"]


def fleet_size(config: Any) -> int:
    """Number of robots of a group; 0 where each robot has the street to itself.

    Raises:
      ValidationError: the number is out of its range, or the street has a crowd or clutter, which the envs of a group
        would not share.
    """
    section = config.get("task", None)
    size = 0 if section is None else section.get("robots", 0)
    if not size:
        return 0
    if not 2 <= size <= 8:
        raise ValidationError(f"config.task.robots: found {size}, needed 2 to 8.")
    if config.scenario == "dynamic" or config.randomization.clutter:
        found = "scenario 'dynamic'" if config.scenario == "dynamic" else "randomization.clutter"
        raise ValidationError(
            f"config: found {found} with several robots in a street, needed the scenario 'static' without clutter, "
            "because every env has people and movable objects of its own."
        )
    return int(size)


def grouped(size: int) -> Callable[[Any], Any]:
    """A function that returns the values of the other members of a group of `size` consecutive envs: arrays (...) of
    one env -> arrays (size - 1, ...), in the order of the envs. Alone they are zeros.

    Raises (when called under vmap):
      ValidationError: the batch is no multiple of `size`.
    """
    others = np.array([[j for j in range(size) if j != i] for i in range(size)])

    @jax.custom_batching.custom_vmap
    def exchange(values: Any) -> Any:
        return jax.tree.map(lambda x: jnp.zeros((size - 1, *jnp.shape(x)), jnp.result_type(x)), values)

    @exchange.def_vmap
    def _(number: int, batched: Any, values: Any) -> Any:
        def of_others(x: Any) -> Any:
            groups = x.reshape(number // size, size, *x.shape[1:])
            return groups[:, others].reshape(number, size - 1, *x.shape[1:])

        out = jax.tree.map(of_others, _whole(number, batched[0], values, size))
        return out, jax.tree.map(lambda _: True, out)

    return exchange


def first_of_group(size: int) -> Callable[[Any], Any]:
    """A function that returns the values of the first member of a group of consecutive envs, and () i32, one's own
    place in it; alone one's own and 0.

    Raises (when called under vmap):
      ValidationError: the batch is no multiple of `size`.
    """

    @jax.custom_batching.custom_vmap
    def lead(values: Any) -> Any:
        return values, jnp.int32(0)

    @lead.def_vmap
    def _(number: int, batched: Any, values: Any) -> Any:
        whole = _whole(number, batched[0], values, size)
        first = jax.tree.map(lambda x: x[np.arange(number) // size * size], whole)
        out = first, jnp.arange(number, dtype=jnp.int32) % size
        return out, jax.tree.map(lambda _: True, out)

    return lead


def _whole(number: int, batched: Any, values: Any, size: int) -> Any:
    if number % size:
        raise ValidationError(
            f"envs: found {number} side by side, needed a multiple of {size}, the robots of a street "
            "(config.task.robots); change the number of envs or episodes."
        )
    return jax.tree.map(lambda x, b: x if b else jnp.broadcast_to(x, (number, *jnp.shape(x))), values, batched)


def _extent(robot: RobotSpec) -> tuple[float, float, float, float]:
    """Of a robot's collision geoms the rear, front and half width (m) in the heading frame and the height (m)."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = at_rest(model, (0, 0, robot.spawn_height))
    solid = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
    place, reach = data.geom_xpos[solid], model.geom_size[solid, 0]
    half = float((np.abs(place[:, 1]) + reach).max())
    ends = (place[:, 0] - reach).min(), (place[:, 0] + reach).max()
    return float(ends[0]), float(ends[1]), half, float((place[:, 2] + reach).max())


def fleet_shapes(robot: RobotSpec, size: int) -> AgentShapes:
    """Collision bodies of the other robots of a group."""
    rear, front, half, height = _extent(robot)
    rows = half, max((front - rear) / 2 - half, 0.0), height
    return AgentShapes(*(np.full(size - 1, x, np.float32) for x in rows))


def fleet_middle(robot: RobotSpec) -> float:
    """m along the heading from the root body's origin to the middle of the footprint."""
    rear, front, *_ = _extent(robot)
    return 0.5 * (rear + front)


class Fleet(DynamicStreet):
    """The other robots of a group as the moving agents of a street.

    Args:
      bank: the scenes.
      scenes: (n,) rows of it in use.
      robot: of all members.
      root: id of its free body.
      size: of a group.
      ctrl_dt: s, the control step.
    """

    def __init__(
        self, bank: SceneBank, scenes: np.ndarray, robot: RobotSpec, root: int, size: int, ctrl_dt: float
    ) -> None:
        self.size, self._root, self._dt = size, root, ctrl_dt
        self.kinds = (ROBOT,) * (size - 1)
        self.shapes = fleet_shapes(robot, size)
        self._middle = fleet_middle(robot)
        self._robot_radius = robot.planner_radius
        self._people = jnp.ones(size - 1, bool)
        self._height, self._origin, self._row = ground_tables(bank, scenes)
        self._exchange, self._lead = grouped(size), first_of_group(size)
        self._starts = jnp.asarray(bank.episode_start[..., :2])
        self._count = jnp.asarray(bank.num_episodes, jnp.int32)

    # Beginning.

    def together(self, scene: Int[Array, ""], row: Int[Array, ""]) -> tuple[Int[Array, ""], Int[Array, ""]]:
        """Scene and row of a robot's first episode: all of a group in the scene of the first, in consecutive rows."""
        (scene, row), place = self._lead((scene, row))
        return scene, (row + place) % self._count[scene]

    def again(self, key: Key[Array, ""], nav: NavState) -> tuple[Int[Array, ""], Int[Array, ""]]:
        """Scene and row of a robot's next episode: in the same street, from a start where no other robot is."""
        assert nav.crowd is not None
        scene, body = nav.sim.scene, nav.crowd.bodies
        rows = jax.random.randint(key, (TRIES,), 0, self._count[scene])
        away = self._starts[scene, rows, None] - jnp.stack([body.x, body.y], -1)
        gap = jnp.where(nav.crowd.present, jnp.linalg.norm(away, axis=-1), jnp.inf).min(-1)
        return scene, rows[jnp.argmax(jnp.minimum(gap, 2.0 * START_SPACING))]

    def begin(
        self,
        key: Key[Array, ""],
        scene: Int[Array, ""],
        start: Float[Array, "4"],
        waypoints: Float[Array, "W 3"],
        clearance: Callable[[Int[Array, ""], Float[Array, "n 2"]], Float[Array, "n 2"]],
    ) -> Crowd:
        """The other robots at their starts."""
        del key, waypoints, clearance
        still = jnp.zeros(2)
        told = Told(scene, jnp.bool_(True), self._centre(start[:2], start[3]), start[3], still, jnp.float32(0.0))
        return self._crowd(scene, self._exchange(told))

    # In every step.

    def _centre(self, xy: Float[Array, "2"], yaw: Float[Array, ""]) -> Float[Array, "2"]:
        return xy + self._middle * jnp.stack([jnp.cos(yaw), jnp.sin(yaw)])

    def _told(self, sim: SimState, result: Int[Array, ""]) -> Told:
        """What a robot tells; one whose episode has ended stands."""
        yaw = rotations.yaw_of(sim.xquat[self._root])
        runs = (result == Result.RUNNING).astype(jnp.float32)
        centre = self._centre(sim.xpos[self._root, :2], yaw)
        return Told(sim.scene, jnp.bool_(True), centre, yaw, runs * sim.qvel[:2], runs * sim.qvel[5])

    def _crowd(self, scene: Int[Array, ""], others: Told) -> Crowd:
        """The others as agents, of which only `bodies`, `present` and `speed` (that of now) mean anything."""
        x, y = others.xy.T
        vx, vy = others.velocity.T
        zero, none = jnp.zeros(self.size - 1), jnp.zeros(self.size - 1, jnp.int32)
        return Crowd(
            bodies=Bodies(x, y, vx, vy, others.yaw),
            present=others.there & (others.scene == scene),
            speed=jnp.linalg.norm(others.velocity, axis=-1),
            goal=none,
            mode=none,
            anchor_x=zero,
            anchor_y=zero,
            face=zero,
            blocked=zero,
            side=zero,
            still=zero,
            backing=zero,
            arrived=none,
        )

    def advance(self, nav: NavState, root: int, *_: Any) -> tuple[Crowd, AgentMotion]:
        """The other robots where they are, and their motion in the next control step at constant velocity."""
        del root
        others = self._exchange(self._told(nav.sim, nav.result))
        crowd = self._crowd(nav.sim.scene, others)
        motion = self.places(crowd, nav.sim.scene)
        velocity = jnp.concatenate([others.velocity, jnp.zeros((self.size - 1, 1))], -1)
        return crowd, motion._replace(velocity=velocity, turn_rate=others.turn)

    def after(self, sim: SimState, result: Int[Array, ""]) -> Crowd:
        """The other robots after a step of all."""
        return self._crowd(sim.scene, self._exchange(self._told(sim, result)))
