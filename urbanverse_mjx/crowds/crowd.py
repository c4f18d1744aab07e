"""A dynamic street: goals, preferred velocities and motion of all agents in one env.

In:   a bank's tables, the scene, the robot.
Out:  `Crowd`, the state of all agents, step by step.
When: `CrowdModel` once; `init` at reset and `step` every crowd step, inside jit, per env, alone or under `jax.vmap`.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .. import settings
from ..datatypes import SceneBank
from ..datatypes import validation as v
from ..process_pool import results_in_order, workers_for
from . import (
    behaviours,
    crossings,
    deadlock,
    flats,
    free_space,
    goal_fields,
    lanes,
    open_ground,
    resolve_collisions,
    spawning,
)
from .behaviours import GO, ROAM, Script
from .bodies import Bodies, PreferredVelocity, Traits, num_long, num_wheeled, traits_of
from .goal_fields import RULE_OF_KIND, RULES
from .kinds import KINDS, SURFACES, AgentKind
from .orca import Options, disturbed, make_step
from .spawning import Observer
from .traversability import Traversability

#: m from a goal (plus half a vehicle's length) at which an agent has arrived.
_GOAL_DISTANCE = 1.0
#: s after which a blocked agent drops its script.
_BLOCKED_TIME = 8.0
#: s until an agent brakes for another one that appears (three steps).
_REACTION_TIME = 0.5
#: s, preview time at which a vehicle looks up its route ahead of its front.
_PREVIEW_TIME = 0.4


class Crowd(NamedTuple):
    """State of the A agents of one env.

    Attributes:
      bodies: `Bodies` (A,).
      present: (A,) bool.
      speed: (A,) m/s, preferred speed.
      goal: (A,) i32, goal of its route.
      mode, anchor_x, anchor_y, face: (A,), see `behaviours.Script`.
      blocked, side: (A,), see `deadlock`.
      still: (A,) s for which an agent with a preferred velocity has hardly moved.
      backing: (A,) s, remaining time for which a vehicle drives backwards.
      arrived: (A,) i32, number of goals reached.
    """

    bodies: Bodies
    present: Any
    speed: Any
    goal: Any
    mode: Any
    anchor_x: Any
    anchor_y: Any
    face: Any
    blocked: Any
    side: Any
    still: Any
    backing: Any
    arrived: Any


class CrowdTables(NamedTuple):
    """A crowd's tables of a bank's scenes: flats and free ground by surface, routes by group, crosswalks."""

    flats: dict[str, flats.Flats]
    ground: dict[str, open_ground.OpenGround]
    routes: dict[str, goal_fields.GoalRoutes]
    crossings: crossings.Crossings


def make_tables(bank: SceneBank, scenes: Sequence[int] | None = None) -> CrowdTables:
    """Makes the tables of the given scenes (default: all) in their order; takes a few seconds of a processor per scene,
    in several processes where there are many scenes."""
    numbers = range(bank.num_scenes) if scenes is None else scenes
    workers = workers_for(len(numbers), settings.num_threads())
    made = list(
        results_in_order(
            _spaces_and_fields, ((bank.geometry_of(z),) for z in numbers), workers, settings.use_processor_alone
        )
    )
    by_surface = {name: [spaces[name] for spaces, _ in made] for name in SURFACES}
    return CrowdTables(
        flats={name: flats.make_flats(by_surface[name], flats.REACH[name]) for name in SURFACES},
        ground={name: open_ground.make_open_ground(by_surface[name]) for name in SURFACES},
        routes={
            name: goal_fields.make_routes(by_surface[rules.surface], [fields[name] for _, fields in made])
            for name, rules in RULES.items()
        },
        crossings=crossings.make_crossings(by_surface["foot"]),
    )


def _spaces_and_fields(
    bank: SceneBank,
) -> tuple[dict[str, free_space.FreeSpace], dict[str, tuple[np.ndarray, ...]]]:
    """Free space by surface and fields of goals by group, of a bank of one scene."""
    spaces = free_space.free_spaces(bank, 0)
    return spaces, {name: goal_fields.fields_of(spaces[rules.surface], rules) for name, rules in RULES.items()}


@dataclasses.dataclass(frozen=True)
class Robot:
    """The robot as agents model it: a disc that takes a share of the avoidance.

    Attributes:
      radius: m.
      yielding: see `AgentKind`; 0 if people expect it to keep its course.
    """

    radius: float = 0.45
    yielding: float = 0.5


class CrowdModel:
    """A fixed set of agent slots over the scenes of a bank."""

    def __init__(
        self,
        tables: CrowdTables,
        kinds: Sequence[str],
        dt: float = 0.1,
        num_neighbours: int = 8,
        robot: Robot | None = None,
        reach: float | None = None,
    ) -> None:
        """Makes the model of a crowd.

        Args:
          kinds: names in `KINDS`, one per slot; pedestrians first.
          reach: m; agents are placed within this distance of the robot if possible, and an agent farther than 1.5 times
            this distance and out of the robot's sight is placed elsewhere, so that few agents suffice to fill the
            street around the robot. None for the whole scene.

        Raises:
          ValidationError: a kind is unknown, or pedestrians come after vehicles.
        """
        for i, name in enumerate(kinds):
            v.choice(name, f"crowd kinds[{i}]", KINDS)
        self.tables, self.dt = tables, dt
        self.kinds: tuple[AgentKind, ...] = tuple(KINDS[name] for name in kinds)
        self.robot, self.reach = robot or Robot(), reach
        options = Options(
            dt, num_neighbours, num_wheeled(self.kinds), discs_only=all(k.half_length == 0 for k in self.kinds)
        )
        self._step, self._resolve_collisions = (
            make_step(options),
            resolve_collisions.make_resolve_collisions(num_long(self.kinds)),
        )
        self._traits: Traits = jax.tree.map(lambda a: a[:, 0], traits_of(self.kinds))
        self._groups = {g: self._rows(lambda k, g=g: RULE_OF_KIND[k.name] == g) for g in RULES}
        self._traversability = Traversability(tables.flats, tables.ground, self.kinds, self._traits)
        self._on_foot = jnp.array([k.surface == "foot" for k in self.kinds])
        self._sidesteps = jnp.array([0.0 if k.wheeled else 1.0 for k in self.kinds])
        self._headroom = jnp.array([k.headroom for k in self.kinds])

    def _rows(self, chosen: Any) -> np.ndarray:
        return np.array([i for i, kind in enumerate(self.kinds) if chosen(kind)], np.int32)

    @property
    def num_agents(self) -> int:
        return len(self.kinds)

    def init(self, key: Any, scene: Any, observer: Observer, count: Any = None, script: Script | None = None) -> Crowd:
        """Makes a crowd at rest.

        Args:
          scene: () i32, row of the tables.
          observer: pose of the robot.
          count: () i32 or None, number of randomly chosen slots that are filled; agents of other slots are absent.
          script: rows for the first slots; rows whose mode is `ROAM` have no effect.
        """
        keys = jax.random.split(key, 5)
        number = self.num_agents
        zero = jnp.zeros(number)
        kinds = [np.array([getattr(k, name) for k in self.kinds], np.float32) for name in ("speed", "spread")]
        noise = jax.random.truncated_normal(keys[0], -2.0, 2.0, (number,))
        speed = jnp.clip(kinds[0] + kinds[1] * noise, 0.3 * kinds[0], self._traits.limit)
        priority = jax.random.uniform(keys[1], (number,))
        wanted = jnp.ones(number, bool) if count is None else jnp.argsort(jnp.argsort(priority)) < count
        integer = jnp.zeros(number, jnp.int32)
        crowd = Crowd(
            bodies=Bodies(zero, zero, zero, zero, zero),
            present=jnp.zeros(number, bool),
            speed=speed,
            goal=integer,
            mode=integer,
            anchor_x=zero,
            anchor_y=zero,
            face=zero,
            blocked=zero,
            side=deadlock.habitual_side(keys[2], number) * self._sidesteps,
            still=zero,
            backing=zero,
            arrived=integer,
        )
        if script is not None:
            crowd = _follow(crowd, script)
            rows = script.mode.shape[0]
            wanted = wanted.at[:rows].set(wanted[:rows] & (script.mode == ROAM))
        for group, rows in self._groups.items():
            if not len(rows):
                continue
            rows = jnp.asarray(rows)

            def one(n: Any, crowd: Crowd, group: str = group, rows: Any = rows) -> Crowd:
                return self._appear(
                    crowd, rows[n], wanted[rows[n]], jax.random.fold_in(keys[3], rows[n]), group, scene, observer, False
                )

            crowd = jax.lax.fori_loop(0, len(rows), one, crowd)
        return crowd

    def _appear(
        self, crowd: Crowd, who: Any, wanted: Any, key: Any, group: str, scene: Any, observer: Observer, hidden: bool
    ) -> Crowd:
        """Places agent `who` () i32 of a group on one of its routes if `wanted` () bool and a position is free."""
        keys, routes = jax.random.split(key, 2), self.tables.routes[group]
        size = self._traits.radius + self._traits.half_length
        others = crowd.present & (jnp.arange(self.num_agents) != who)
        bodies = crowd.bodies
        # Braking distances of the other agents, because they cannot brake for an agent that appears too close.
        square = bodies.vx * bodies.vx + bodies.vy * bodies.vy
        braking = size + _REACTION_TIME * jnp.sqrt(square) + 0.5 * square / self._traits.braking
        place, found = spawning.choose(
            keys[0], routes.place[scene], size[who], bodies.x, bodies.y, braking, others, observer, hidden, self.reach
        )
        found &= wanted & (routes.num_goals[scene] > 0)
        x, y = routes.place[scene, place]
        free_goal = jax.random.randint(keys[1], (), 0, jnp.maximum(routes.num_goals[scene], 1))
        goal = jnp.where(routes.place_goal[scene, place] >= 0, routes.place_goal[scene, place], free_goal)
        heading = goal_fields.heading_at(routes, RULES[group].node, scene, goal[None], x[None], y[None])[0]

        def put(column: Any, value: Any) -> Any:
            return column.at[who].set(jnp.where(found, value, column[who]))

        values = (x, y, 0.0, 0.0, heading)
        return crowd._replace(
            bodies=Bodies(*(put(column, value) for column, value in zip(bodies, values, strict=True))),
            present=put(crowd.present, True),
            goal=put(crowd.goal, goal),
            mode=put(crowd.mode, ROAM),
            blocked=put(crowd.blocked, 0.0),
            still=put(crowd.still, 0.0),
        )

    def step(
        self,
        crowd: Crowd,
        scene: Any,
        observer: Observer,
        robot_velocity: tuple[Any, Any],
        key: Any,
        rights: crossings.Precedence | None = None,
    ) -> Crowd:
        """Advances the crowd by `dt` s.

        Args:
          scene: () i32.
          observer: the robot.
          robot_velocity: () m/s, x and y.
          rights: signals of crosswalks and the robot's right of way; None for neither.
        """
        keys = jax.random.split(key, 4)
        crowd = self._next_errands(crowd, scene, observer, keys[0])
        course = self._courses(crowd, scene)
        preferred_velocity = self._preferred_velocities(crowd, scene, course, rights)
        aside = deadlock.step_aside(preferred_velocity, crowd.blocked, crowd.side)
        aside = deadlock.back_up(aside, crowd.backing, crowd.bodies.heading)
        robot = self._robot_body(observer, robot_velocity)
        joined = Bodies(*(jnp.append(a, b) for a, b in zip(crowd.bodies, robot[0], strict=True)))
        traits = self._traits._replace(
            present=crowd.present, limit=jnp.minimum(self._traits.limit, crowd.speed * self._headroom)
        )
        everybody = Traits(*(jnp.append(a, b) for a, b in zip(traits, robot[1], strict=True)))
        aside = lanes.stop_in_time(aside, joined, everybody, self.num_agents - num_wheeled(self.kinds))
        walls = self._traversability.walls(crowd.bodies, scene)
        bodies, _ = self._step(joined, everybody, disturbed(aside, keys[1], crowd.side), *walls)
        free = resolve_collisions.keeps_off(*walls, crowd.bodies, bodies, traits) & self._traversability.stays(
            crowd.bodies, bodies, scene
        )
        bodies = self._resolve_collisions(joined, bodies, everybody, free)
        blocked = deadlock.held_up(crowd.blocked, aside, (bodies.vx, bodies.vy), self.dt)
        wants = preferred_velocity.x * preferred_velocity.x + preferred_velocity.y * preferred_velocity.y > 0.09
        moves = bodies.vx * bodies.vx + bodies.vy * bodies.vy > 0.01
        backing = deadlock.backing_time(crowd.backing, crowd.still, keys[3], self.dt)
        return crowd._replace(
            bodies=bodies,
            blocked=blocked,
            backing=jnp.where(self._sidesteps > 0.0, 0.0, backing),
            side=deadlock.reconsider(crowd.side, blocked, keys[2], self.dt),
            still=jnp.where(wants & ~moves & crowd.present, crowd.still + self.dt, 0.0),
        )

    def _next_errands(self, crowd: Crowd, scene: Any, observer: Observer, key: Any) -> Crowd:
        """Assigns a new goal to agents that arrived. Vehicles that arrived, and with `reach` agents far from the robot,
        are placed elsewhere once they are out of sight. An agent at the end of its script roams from there."""
        at_anchor = (crowd.bodies.x - crowd.anchor_x) ** 2 + (crowd.bodies.y - crowd.anchor_y) ** 2 < 0.5**2
        given_up = (crowd.mode == GO) & (at_anchor | (crowd.still > _BLOCKED_TIME))
        crowd = crowd._replace(mode=jnp.where(given_up, ROAM, crowd.mode))
        for group, rows in self._groups.items():
            if not len(rows):
                continue
            routes, some = self.tables.routes[group], jnp.asarray(rows)
            goal = routes.goal[scene, crowd.goal[some]]
            x, y = crowd.bodies.x[some], crowd.bodies.y[some]
            near = _GOAL_DISTANCE + self._traits.half_length[some]
            there = (x - goal[:, 0]) ** 2 + (y - goal[:, 1]) ** 2 < near * near
            there &= crowd.present[some] & (crowd.mode[some] == ROAM)
            far = jnp.zeros(some.shape, bool)
            if self.reach is not None:
                away = (x - observer.x) ** 2 + (y - observer.y) ** 2
                far = crowd.present[some] & observer.present & (away > (1.5 * self.reach) ** 2)
            keys = jax.random.split(jax.random.fold_in(key, int(rows[0])), 2)
            if RULES[group].from_middle is None:
                other = jax.random.randint(keys[0], some.shape, 0, jnp.maximum(routes.num_goals[scene], 1))
                chosen = jnp.where(there, other, crowd.goal[some])
                crowd = crowd._replace(
                    goal=crowd.goal.at[some].set(chosen), arrived=crowd.arrived.at[some].add(there.astype(jnp.int32))
                )
                gone = far
            else:
                gone = there | far
            if RULES[group].from_middle is None and self.reach is None:
                continue
            gone &= ~spawning.visible(observer, x, y)
            who = some[jnp.argmax(gone)]
            appear_key = keys[1]
            if RULES[group].from_middle is not None:
                appear_key = keys[0]
                crowd = crowd._replace(arrived=crowd.arrived.at[who].add(gone.any().astype(jnp.int32)))
            crowd = self._appear(crowd, who, gone.any(), appear_key, group, scene, observer, True)
        return crowd

    def _courses(self, crowd: Crowd, scene: Any) -> Any:
        """(A,) rad, direction of each agent's route."""
        course = jnp.zeros(self.num_agents)
        for group, rows in self._groups.items():
            if len(rows):
                some = jnp.asarray(rows)
                place = crowd.bodies.x[some], crowd.bodies.y[some]
                # A vehicle looks up its route ahead of its front, so that it turns in time.
                if RULES[group].from_middle is not None:
                    reach, heading = self._traits.half_length[some], crowd.bodies.heading[some]
                    place = (
                        place[0] + reach * jnp.cos(heading) + _PREVIEW_TIME * crowd.bodies.vx[some],
                        place[1] + reach * jnp.sin(heading) + _PREVIEW_TIME * crowd.bodies.vy[some],
                    )
                heading = goal_fields.heading_at(
                    self.tables.routes[group], RULES[group].node, scene, crowd.goal[some], *place
                )
                course = course.at[some].set(heading)
        return course

    def _preferred_velocities(
        self, crowd: Crowd, scene: Any, course: Any, rights: crossings.Precedence | None
    ) -> PreferredVelocity:
        """Preferred velocities of all agents: by route or script, at the speed that crossings and goals allow."""
        order = crossings.give_way(
            self.tables.crossings,
            scene,
            crowd.bodies,
            course,
            crowd.speed,
            self._on_foot,
            self._traits.radius + self._traits.half_length,
            crowd.present,
            rights,
        )
        pace = jnp.where(order.wait, 0.0, jnp.minimum(crowd.speed, order.limit))
        for group, rows in self._groups.items():
            if len(rows) and RULES[group].from_middle is not None:
                some = jnp.asarray(rows)
                goal = self.tables.routes[group].goal[scene, crowd.goal[some]]
                left = jnp.hypot(goal[:, 0] - crowd.bodies.x[some], goal[:, 1] - crowd.bodies.y[some])
                stop = jnp.sqrt(self._traits.braking[some] * jnp.maximum(left - 0.5 * _GOAL_DISTANCE, 0.0))
                pace = pace.at[some].min(stop)
        roam = PreferredVelocity(pace * jnp.cos(course), pace * jnp.sin(course), course)
        script = behaviours.scripted_velocity(
            crowd.mode, (crowd.anchor_x, crowd.anchor_y), crowd.face, crowd.speed, crowd.bodies
        )
        return PreferredVelocity(*(jnp.where(crowd.mode == ROAM, a, b) for a, b in zip(roam, script, strict=True)))

    def _robot_body(self, observer: Observer, velocity: tuple[Any, Any]) -> tuple[Bodies, Traits]:
        body = Bodies(observer.x, observer.y, *velocity, observer.heading)
        one = jnp.ones(())
        like = Traits(*(one for _ in Traits._fields))._replace(
            present=observer.present,
            radius=one * self.robot.radius,
            half_length=0.0 * one,
            margin=0.1 * one,
            yielding=one * self.robot.yielding,
        )
        return body, like


def _follow(crowd: Crowd, script: Script) -> Crowd:
    """Assigns a script to the first slots."""
    rows = script.mode.shape[0]
    zero = jnp.zeros(rows)

    acts = script.mode != ROAM

    def put(column: Any, value: Any) -> Any:
        return column.at[:rows].set(jnp.where(acts, value, column[:rows]))

    places = (script.x, script.y, zero, zero, script.heading)
    return crowd._replace(
        bodies=Bodies(*(put(c, a) for c, a in zip(crowd.bodies, places, strict=True))),
        present=put(crowd.present, True),
        mode=put(crowd.mode, script.mode),
        anchor_x=put(crowd.anchor_x, script.anchor_x),
        anchor_y=put(crowd.anchor_y, script.anchor_y),
        face=put(crowd.face, script.face),
        speed=put(crowd.speed, jnp.where(script.speed > 0.0, script.speed, crowd.speed[:rows])),
    )
