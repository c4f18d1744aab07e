"""Dynamic streets: the crowd of an env, its encounters near the route, and the robot's distances to people.

In:   the bank, `config.crowd`, the robot's pose.
Out:  `Crowd` states, `AgentMotion` for engines and renderer, distances to people.
When: tables at construction; the rest every control step, inside jit, per env.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, Key
from ml_collections import ConfigDict

from ...crowds import KINDS
from ...crowds.behaviours import Script
from ...crowds.crossings import Precedence
from ...crowds.crowd import Crowd, CrowdModel
from ...crowds.crowd import Robot as RobotBody
from ...crowds.free_space import CELL
from ...crowds.motion import wrapped
from ...crowds.spawning import Observer
from ...datatypes import AgentMotion, AgentShapes, RobotSpec, SceneBank, ValidationError
from ...geometry import rotations
from ...geometry.grids import cell_of
from ..types import NavState, Result
from . import encounters
from .dynamic_tables import POOL, kept_tables

#: s, largest time step of a crowd, for which `crowds` is validated.
_CROWD_DT = 0.1
#: m/s, upper limit of the speed of agents; an agent that moves farther in a control step was placed elsewhere.
_MAX_AGENT_SPEED = 12.0
#: m between bodies, intimate and personal distance (Hall, The Hidden Dimension, 1966).
INTIMATE_DISTANCE, PERSONAL_DISTANCE = 0.45, 1.2
#: m, upper limit of reported distances to people.
MAX_PEOPLE_DISTANCE = 30.0
#: Numbers folded into a key, so that these draws do not change any others.
_BEGIN, _STEP = 201, 1000


#: Metrics of a control step: whether the episode ended by touching an agent; m from the disc around the robot to the
#: nearest person (all agents but cars), at most `MAX_PEOPLE_DISTANCE` and 0 on overlap; whether that is within intimate
#: or personal distance; the robot's speed (m/s) if within personal distance.
PEOPLE_METRICS = (
    "hit_agent",
    "people_distance",
    "intimate_time_per_step",
    "personal_time_per_step",
    "personal_speed_per_step",
)


def slot_kinds(config: ConfigDict) -> tuple[str, ...]:
    """The kind of every agent slot of `config.crowd.slots`, pedestrians first.

    Raises:
      ValidationError: a kind is unknown, a number is negative, or there is no agent.
    """
    for name, number in config.slots.items():
        if name not in KINDS or number < 0:
            raise ValidationError(
                f"config.crowd.slots: found {name!r}: {number}, needed numbers from 0 on of {list(KINDS)}."
            )
    names = [name for name in KINDS for _ in range(config.slots.get(name, 0))]
    if not names:
        raise ValidationError(
            "config.crowd.slots: found no agent, needed at least one; set scenario to 'static' for none."
        )
    return tuple(sorted(names, key=lambda name: KINDS[name].wheeled))


def slot_shapes(kinds: tuple[str, ...]) -> AgentShapes:
    """Collision bodies of slots of these kinds."""
    fields = AgentShapes._fields
    return AgentShapes(*(np.array([getattr(KINDS[k], f) for k in kinds], np.float32) for f in fields))


def slot_appearances(kinds: tuple[str, ...], bank: SceneBank) -> tuple[int, ...]:
    """Row of the bank's agents for each slot's appearance, cycling through those of a kind.

    Raises:
      ValidationError: the bank has no appearance of a kind.
    """
    rows = []
    for i, kind in enumerate(kinds):
        known = [row for row, name in enumerate(bank.agents["kind"]) if name == kind]
        if not known:
            raise ValidationError(
                f"bank.meta.agents: found no appearance of a {kind}, needed one for scenario 'dynamic'; "
                "build the bank again with `urbanverse scene bank`."
            )
        rows.append(known[kinds[:i].count(kind) % len(known)])
    return tuple(rows)


class DynamicStreet:
    """The crowd of every env.

    Args:
      bank: the scenes.
      scenes: (n,) rows of it in use.
      config: `config.crowd` of an environment.
      ctrl_dt: s, the control step.
      robot: robot that the agents avoid.

    Raises:
      ValidationError: see `slot_kinds`; or a share is outside [0, 1].
    """

    def __init__(self, bank: SceneBank, scenes: np.ndarray, config: ConfigDict, ctrl_dt: float, robot: RobotSpec):
        self.kinds = slot_kinds(config)
        self.shapes = slot_shapes(self.kinds)
        self._dt, self._crowd_steps = ctrl_dt, max(1, round(ctrl_dt / _CROWD_DT))
        tables = kept_tables(bank, scenes.tolist())
        self._height, self._origin, self._row = tables.height, tables.origin, tables.row
        self._robot_radius = robot.planner_radius
        seen = RobotBody(robot.planner_radius, config.yielding)
        dt = ctrl_dt / self._crowd_steps
        self.model = CrowdModel(tables.crowd, self.kinds, dt, robot=seen, reach=config.reach)
        self._filled = jnp.asarray([_filled(config.filled, name) for name in bank.scene_ids], jnp.float32)
        self._people = jnp.array([kind != "car" for kind in self.kinds])
        self._encounters = encounters.Encounters(config.encounters, self.kinds.count("pedestrian"))

    def begin(
        self,
        key: Key[Array, ""],
        scene: Int[Array, ""],
        start: Float[Array, "4"],
        waypoints: Float[Array, "W 3"],
        clearance: Callable[[Int[Array, ""], Float[Array, "n 2"]], Float[Array, "n 2"]],
    ) -> Crowd:
        """Makes the crowd of a new episode.

        Args:
          key: typed key, which can be reused.
          start: (4,) x, y, z, yaw.
          waypoints: (W, 3) m.
          clearance: function (scene, (n, 2) m) -> (n, 2) m to the nearest hull and the walkable edge.
        """
        keys = jax.random.split(jax.random.fold_in(key, _BEGIN), 3)
        observer = Observer(start[0], start[1], start[3], jnp.array(True))
        number = self.model.num_agents
        share = jnp.clip(self._filled[scene] + jax.random.uniform(keys[0], (), minval=-0.15, maxval=0.15), 0.0, 1.0)
        script: Script | None = self._encounters.draw(keys[1], start, waypoints, lambda p: clearance(scene, p))
        count = jnp.round(share * number).astype(jnp.int32)
        return self.model.init(keys[2], self.row(scene), observer, count, script)

    def row(self, scene: Int[Array, ""] | int) -> Int[Array, ""]:
        """() i32, the row of a scene of the bank in the tables of `model`."""
        return self._row[scene]

    def advance(self, nav: NavState, root: int, rights: Precedence | None = None) -> tuple[Crowd, AgentMotion]:
        """Advances the crowd of `nav` by one control step; returns it and the motion of its agents.

        Args:
          root: the robot's body.
          rights: see `CrowdModel.step`.
        """
        sim, before = nav.sim, nav.crowd
        assert before is not None
        x, y = sim.xpos[root, :2]
        vx, vy = sim.qvel[:2]
        observer = Observer(x, y, rotations.yaw_of(sim.xquat[root]), jnp.array(True))
        key, row = jax.random.fold_in(nav.key, _STEP + nav.steps), self.row(sim.scene)

        def step(k: Int[Array, ""], crowd: Crowd) -> Crowd:
            return self.model.step(crowd, row, observer, (vx, vy), jax.random.fold_in(key, k), rights)

        crowd = jax.lax.fori_loop(0, self._crowd_steps, step, before)
        return crowd, self.motion(before, crowd, sim.scene)

    def places(self, crowd: Crowd, scene: Int[Array, ""]) -> AgentMotion:
        """Poses of all agents, at rest."""
        body = crowd.bodies
        places = jnp.stack([body.x, body.y], -1)
        row = self.row(scene)
        cell = cell_of(places, self._origin[row], POOL * CELL, self._height.shape[1:])
        z = self._height[row, cell[:, 0], cell[:, 1]]
        zero = jnp.zeros_like(body.x)
        return AgentMotion(
            jnp.stack([body.x, body.y, z], -1), body.heading, jnp.zeros((len(z), 3)), zero, crowd.present
        )

    def motion(self, before: Crowd, after: Crowd, scene: Int[Array, ""]) -> AgentMotion:
        """Motion of all agents from one state to the next; an agent that was placed elsewhere is absent during the
        step."""
        start, end = self.places(before, scene), self.places(after, scene)
        velocity = (end.position - start.position) / self._dt
        there = jnp.sum(velocity * velocity, -1) < _MAX_AGENT_SPEED**2
        return start._replace(
            velocity=jnp.where(there[:, None], velocity, 0.0),
            turn_rate=wrapped(end.heading - start.heading) / self._dt,
            present=start.present & end.present & there,
        )

    def gaps(
        self, crowd: Crowd, p_xy: Float[Array, "*n 2"], after: Float[Array, "*n"] | float = 0.0
    ) -> Float[Array, "*n A"]:
        """(..., A) m from points (..., 2) m to the bodies of present agents, negative inside; infinite for absent ones.

        Args:
          after: (...) s from now, for which agents go on at their velocities.
        """
        body, half = crowd.bodies, jnp.asarray(self.shapes.half_length)
        later = jnp.asarray(after)[..., None]
        dx, dy = p_xy[..., :1] - (body.x + later * body.vx), p_xy[..., 1:] - (body.y + later * body.vy)
        cos, sin = jnp.cos(body.heading), jnp.sin(body.heading)
        along = jnp.clip(cos * dx + sin * dy, -half, half)
        distance = jnp.sqrt((dx - along * cos) ** 2 + (dy - along * sin) ** 2) - jnp.asarray(self.shapes.radius)
        return jnp.where(crowd.present, distance, jnp.inf)

    def nearer(self, found: Float[Array, "*n 2"], crowd: Crowd, p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n 2"]:
        """Distances (..., 2) m to hulls and edges from points (..., 2), in which agents count as hulls."""
        return found.at[..., 0].min(jnp.maximum(self.gaps(crowd, p_xy).min(-1), 0.0))

    def metrics(
        self, crowd: Crowd, result: Int[Array, ""], p_xy: Float[Array, "2"], velocity: Float[Array, "2"]
    ) -> dict[str, Float[Array, ""]]:
        """`PEOPLE_METRICS` of a robot at (2,) m with velocity (2,) m/s; result: () i32."""
        gap = jnp.min(jnp.where(self._people, self.gaps(crowd, p_xy), jnp.inf)) - self._robot_radius
        gap = jnp.clip(gap, 0.0, MAX_PEOPLE_DISTANCE)
        near = gap < PERSONAL_DISTANCE
        values = (result == Result.HIT_AGENT, gap, gap < INTIMATE_DISTANCE, near, near * jnp.linalg.norm(velocity))
        return {name: jnp.asarray(x, jnp.float32) for name, x in zip(PEOPLE_METRICS, values, strict=True)}


def _filled(table: ConfigDict, scene: str) -> float:
    """The share of a scene: that of the longest family name that is a prefix of its id."""
    known = [name for name in table if scene.startswith(name)]
    share = float(table[max(known, key=len)] if known else table["default"])
    if not 0.0 <= share <= 1.0:
        raise ValidationError(f"config.crowd.filled: found {share} for {scene!r}, needed a share in [0, 1].")
    return share
