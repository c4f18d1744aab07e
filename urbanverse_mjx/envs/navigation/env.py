"""`NavEnv`: drive to a goal 10-30 m away on the pavement of a street, with a camera and without collisions."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray
from ml_collections import ConfigDict

from ...crowds import open_ground
from ...datatypes import (
    AgentMotion,
    PlacedBank,
    Renderer,
    RobotSpec,
    SceneBank,
    Simulator,
    ValidationError,
    traversable,
)
from ...geometry import rotations
from ...precision import full_precision
from ...robots.arm_reach import ArmReach
from ...robots.embodiment import describe
from ...robots.footprint import footprint
from ...table_arguments import Held
from .. import finite
from ..staged import StagedBase, typed_key
from ..types import NavState, Result
from . import terms
from .camera_noise import through_camera
from .clear_arcs import ClearArcs
from .clutter import Clutter
from .draws import Randomization
from .dynamic import PEOPLE_METRICS, DynamicStreet, slot_appearances
from .fleet import Fleet, fleet_size
from .learnability import Learnability
from .movables import MOVABLE_METRICS, Movables
from .scenarios import scenario_of, scenes_in_use
from .schedule import EpisodeSchedule
from .starts import RandomStarts
from .surroundings import Surroundings
from .tasks import Parts, Task, make_task, task_class

#: cos of the tilt at which a robot counts as fallen (60 degrees).
_MIN_UP = 0.5
#: (15, 2) m in the heading frame, points at which critics observe the distances to hulls and edges.
PROBES = np.array([(x, y) for x in (0.0, 0.6, 1.2, 1.8, 2.4) for y in (-0.6, 0.0, 0.6)], np.float32)
#: (20, 16, 2) m in the heading frame, 7.6 m along by 6 m across: points of the distances in `privileged_map`.
MAP_PROBES = np.stack(np.meshgrid(np.linspace(-1.4, 6.2, 20), np.linspace(-3.0, 3.0, 16), indexing="ij"), -1).astype(
    np.float32
)
ACTION_MODES = ("waypoint", "velocity", "joint")


def _command_range(robot: RobotSpec, model: mujoco.MjModel) -> jax.Array:
    """(nu, 2) commands for the actions -1 and 1 in the mode "joint"."""
    straight = np.abs(np.asarray(robot.command(jnp.array([robot.max_speed, 0.0]))))
    limited = np.asarray(model.actuator_ctrllimited, bool)[:, None]
    # Not the command of a turn, because both wheels at the outer wheel's speed would exceed `max_speed`.
    ends = np.where(limited, model.actuator_ctrlrange, np.stack([-straight, straight], axis=1))
    for i in np.flatnonzero(ends[:, 0] >= ends[:, 1]):
        raise ValidationError(
            f"robot {robot.name!r}: actuator {model.actuator(i).name!r}: found no control range, needed one for "
            "action_mode 'joint'; give it a ctrlrange."
        )
    return jnp.asarray(ends, jnp.float32)


class NavEnv(StagedBase[NavState]):
    """Navigation of one robot, each env in its own scene of a bank: to a point goal, or another task (`tasks`).

    Observation (dict): pixels/front: (H, W, 3) uint8; with vision_config.depth (H, W, 4), the fourth in 10 cm up to
    25.5 m; present when `config.vision`. goal: (2,) f32 m, the final goal (or the next 5 m waypoint with
    goal_mode="waypoint") in the heading frame; or what a task has in its place. privileged: (41 + action_size,) f32 for
    critics and tests only: goal, next waypoint, the one after (heading frame, m), forward and lateral speed (m/s), yaw
    rate (rad/s), share of time and of route left, distances (m) to the next hull and to the edge of the walkable ground
    at the 15 `PROBES` around the robot, last action. proprio: (3 + action_size,) f32, forward and lateral speed (m/s),
    yaw rate (rad/s), last action: what wheel odometry or a state estimator gives; with `config.observations.proprio`.
    privileged_map: (640,) u8 cm, the two distances of `privileged` at the (20, 16) `MAP_PROBES` around the robot, for
    teachers and auxiliary losses only; with `config.observations.privileged_map`. robot: (18,) f32, size and dynamics
    of the robot (`robots.embodiment.FIELDS`), the same at every step; with `config.observations.robot`. A task may add
    values to the ends of privileged and of proprio's speeds, see its class; with `config.observations.clear_arcs` the
    22 of `ClearArcs.observe` follow those of privileged, 44 where there is a crowd. Flat, because Brax keeps statistics
    of every observation except images and treats each as a vector. Action: in [-1, 1]; by `config.action_mode`:
    waypoint: (2,), (dx, dy) in the body frame, turned by the robot's ideal PD into (v, omega); velocity: (2,),
    ((a0 + 1) / 2 * max_speed, a1 * max_yaw_rate); joint: (nu,), one per actuator: -1 and 1 are the ends of its control
    range. Where it has none (wheels), they are its command at full speed straight ahead, backwards and forwards. Not
    for robots with a gait. Reward: sum of `reward_config.scales` times the terms of `terms`. Ends: see `Result`;
    TIMEOUT is a truncation. With terminate_on_hit=False hits are only measured.

        env = registry.load("CocoNav", config_overrides={"preset": "cpu"})
        state = jax.jit(env.reset)(jax.random.key(0))
        state = jax.jit(env.step)(state, jnp.array([1.0, 0.0]))
    """

    def __init__(
        self, config: ConfigDict, bank: SceneBank, robot: RobotSpec, engine: Simulator, renderer: Renderer | None
    ):
        if config.action_mode not in ACTION_MODES:
            raise ValidationError(f"config.action_mode: found {config.action_mode!r}, needed one of {ACTION_MODES}.")
        if config.goal_mode not in ("final", "waypoint"):
            raise ValidationError(f"config.goal_mode: found {config.goal_mode!r}, needed 'final' or 'waypoint'.")
        named = scenes_in_use(config, bank)
        bank, self.scenes, own = task_class(config).episodes(config, bank, robot, named)
        self._config = config
        self.bank = bank
        self.robot = robot
        self.engine = engine
        self.renderer = renderer
        model = mujoco.MjModel.from_xml_string(robot.mjcf)
        self._mj_model = model
        self._root = model.body(robot.root_body).id
        # A legged robot starts in its first keyframe.
        self.qpos0 = jnp.asarray(model.key_qpos[0] if model.nkey else model.qpos0, jnp.float32)
        self._nv = model.nv
        self._joint_range = _command_range(robot, model) if config.action_mode == "joint" else None
        #: The arm whose targets follow the base's two values in an action; None without.
        self._arm = ArmReach(robot) if robot.arm is not None and self._joint_range is None else None
        # Configurations of older policies do not have this field.
        chosen = config.get("observations", {})
        self._sees_proprio, self._sees_map = (bool(chosen.get(k, False)) for k in ("proprio", "privileged_map"))
        self._told = jnp.asarray(describe(robot)) if chosen.get("robot", False) else None
        self._schedule = EpisodeSchedule(config.schedule, bank, self.scenes)
        #: Weights of training episodes; None if all are equally likely.
        self.learnability = Learnability(bank, self.scenes) if self._schedule.learnable else None
        self._randomization = Randomization(config.randomization, float(config.ctrl_dt))
        self._episodes = {
            name: jnp.asarray(getattr(bank, name))
            for name in ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints")
        }
        self._walkable = open_ground.pack(map(traversable, bank.map_kind), bank.map_origin)
        self._map_resolution = float(bank.map_resolution)
        self._surroundings = Surroundings(bank, robot.planner_height)
        #: Free motions that teachers are told; None if they are not.
        self._arcs: ClearArcs | None = None
        if chosen.get("clear_arcs", False):
            self._arcs = ClearArcs(bank, footprint(robot).discs, robot.planner_height)
        share = self._randomization.starts
        self._starts = RandomStarts(share, self._surroundings, robot) if share else None
        #: The crowd of the scenario dynamic, or other robots; None where nobody moves.
        self.dynamic: DynamicStreet | None = None
        if scenario_of(config) == "dynamic":
            # Tables of all named scenes, so that tasks that leave out different ones share a file in the cache.
            self.dynamic = task_class(config).street(config, bank, named, robot, own)
        size = fleet_size(config)
        #: The other robots of the street, which are the moving agents then; None where there are none.
        self.fleet = Fleet(bank, self.scenes, robot, self._root, size, float(config.ctrl_dt)) if size else None
        if self.fleet is not None:
            self.dynamic = self.fleet
        #: Movable objects; None if the engine has no body slots.
        self.movables: Movables | None = None
        #: Objects placed beside the route in every episode; None if disabled.
        self.clutter: Clutter | None = None
        if engine.body_rows is not None:
            self.num_bodies = engine.num_bodies
            if self.dynamic is not None:
                self.movables = Movables(bank, engine.body_rows, engine.num_bodies)
            else:
                self.clutter = Clutter(bank, engine.body_rows, engine.num_bodies, robot, self._surroundings)
        parts = Parts(config, bank, self.scenes, robot, model, self._root, self._surroundings, self.dynamic, own)
        #: What the robot has to do.
        self.task: Task = make_task(parts)

    #: The `places.ScenePlaces` that exchange the scenes, while there are any.
    places: Any = None

    @functools.cached_property
    def held(self) -> Held | None:
        """Tables that those of other scenes replace where scenes come and go (`places`); else None."""
        if not isinstance(self.bank, PlacedBank):
            return None
        return Held((self, "_episodes"), (self, "_walkable"), *self._surroundings.held(), *self._schedule.held())

    # Properties in the interface of Playground and Brax.

    @property
    def action_size(self) -> int:
        if self._joint_range is not None:
            return len(self._joint_range)
        if self._arm is None:
            return 2
        return 2 + len(self._arm.addresses) + (self.robot.parcel is not None)

    @property
    def mj_model(self) -> mujoco.MjModel:
        """The robot's model without scene."""
        return self._mj_model

    # The three stages.

    def begin(self, key: PRNGKeyArray) -> NavState:
        """Begins the first episode of an env: a scene of `config.scenes` and a row of its table, see
        `EpisodeSchedule`."""
        key, draw = jax.random.split(typed_key(key))
        scene, row = self._schedule.draw(draw, jnp.int32(0), jnp.int32(0))
        if self.fleet is not None:
            scene, row = self.fleet.together(scene, row)
        return self.begin_at(key, scene, row)

    def reset_episode(self, nav: NavState, bounds: Float[Array, " ZE"] | None = None) -> NavState:
        """Begins the episode after that of `nav`; only the env's counts of steps and episodes are kept.

        Args:
          bounds: cumulative weights of the episodes (`Learnability.bounds`), for `schedule.learnable`.
        """
        key, draw = jax.random.split(nav.key)
        episodes = nav.episodes + 1
        if self.fleet is None:
            new = self.begin_at(key, *self._schedule.draw(draw, nav.age, episodes, bounds))
        else:
            # The others do not begin anew at the same time.
            new = self.begin_at(key, *self.fleet.again(draw, nav))._replace(crowd=nav.crowd)
        return new._replace(age=nav.age, episodes=episodes)

    @full_precision
    def begin_at(self, key: PRNGKeyArray, scene: Int[Array, ""], row: Int[Array, ""]) -> NavState:
        """Begins an episode from a given row of a given scene's episode table."""
        start = self._episodes["episode_start"][scene, row]
        goal = self._episodes["episode_goal"][scene, row]
        waypoints = self._episodes["episode_waypoints"][scene, row]
        num_waypoints = self._episodes["episode_num_waypoints"][scene, row]
        key = typed_key(key)
        if self._starts is not None:
            start, waypoints, num_waypoints = self._starts.draw(key, scene, start, waypoints, num_waypoints)
        place = jnp.stack([start[0], start[1], start[2] + self.robot.spawn_height])
        pose = jnp.concatenate([place, rotations.from_yaw(start[3])])
        objects = None if self.movables is None else self.movables.near(scene, start[:3], waypoints)
        if self.clutter is not None:
            objects = self.clutter.choose(key, scene, start[:3], waypoints)
        sim = self.engine.init(scene, self.qpos0.at[:7].set(pose), jnp.zeros(self._nv), objects)
        if self.clutter is not None and sim.bodies is not None:
            sim = sim._replace(bodies=self.clutter.place(key, scene, start[:3], goal, waypoints, sim.bodies))
        crowd = None
        if self.dynamic is not None:
            crowd = self.dynamic.begin(key, scene, start, waypoints, self._surroundings.distances)
        zero = jnp.float32(0.0)
        first = NavState(
            key=key,
            sim=self.with_model(self._randomization.scaled(key, sim)),
            episode=row.astype(jnp.int32),
            start=start[:3],
            goal=goal,
            waypoints=waypoints,
            num_waypoints=num_waypoints,
            waypoint=jnp.int32(0),
            route_length=terms.route_length(start[:3], waypoints),
            route_done=zero,
            driven=zero,
            goal_distance=jnp.linalg.norm(goal[:2] - start[:2]),
            steps=jnp.int32(0),
            age=jnp.int32(0),
            episodes=jnp.int32(0),
            last_action=self._still(),
            result=jnp.int32(Result.RUNNING),
            appearance_seed=self._randomization.appearance_seed(key),
            crowd=crowd,
        )
        return self.task.begin(key, first)

    @full_precision
    def advance(
        self, nav: NavState, action: Float[Array, " nu"]
    ) -> tuple[NavState, Float[Array, ""], Float[Array, ""], dict[str, Float[Array, ""]]]:
        """One control step: (next state, reward () f32, done () f32, metrics). The outputs are always finite.

        If inputs or simulation are not finite, the robot keeps its pose and the episode ends (`Result.NON_FINITE`).
        """
        if action.shape[-1] != self.action_size:
            raise ValidationError(
                f"action: found {action.shape[-1]} numbers, needed {self.action_size} for the robot "
                f"{self.robot.name!r} with action_mode {self._config.action_mode!r}; take an agent made for this task."
            )
        nav, given = finite.repaired(nav)
        action = jnp.clip(jnp.nan_to_num(action), -1.0, 1.0)
        crowd, agents = None, None
        if self.dynamic is not None:
            crowd, agents = self.dynamic.advance(nav, self._root, self.task.rights(nav))
        sim = self.engine.step(nav.sim, self._obeyed(nav, action), agents)
        sound = given & finite.is_sound((sim, crowd))
        sim, crowd = finite.choose(sound, (sim, crowd), (nav.sim, nav.crowd))
        if self.fleet is not None:
            crowd = self.fleet.after(sim, nav.result)
        quaternion, velocity = sim.xquat[self._root], jnp.where(sound, sim.qvel[:2], 0.0)
        p_xy = sim.xpos[self._root, :2]
        moved = nav._replace(**self.task.advance(nav, sim, crowd))
        distance = jnp.linalg.norm(moved.goal[:2] - p_xy)
        steps = nav.steps + 1
        hit = sim.contacts.hit & sound
        config = self._config
        agent = sim.contacts.hit_agent
        result = terms.result_of(
            finite=sound,
            fallen=rotations.up_of(quaternion) < _MIN_UP,
            hit=hit & config.terminate_on_hit,
            off_traversable=(~self.is_traversable(sim.scene, p_xy)) & config.terminate_off_traversable,
            at_goal=(distance < config.success_radius) & (steps > config.success_after_step),
            out_of_time=steps >= config.episode_length,
            hit_agent=False if agent is None else agent >= 0,
        )
        result = self.task.result(moved._replace(steps=steps), result)
        done = result != Result.RUNNING
        done_f = done.astype(jnp.float32)
        driven = nav.driven + jnp.linalg.norm(p_xy - nav.sim.xpos[self._root, :2])
        completed = self.task.completed(moved, p_xy, distance, driven)
        route_done = jnp.where(result == Result.GOAL, moved.route_length, jnp.maximum(moved.route_done, completed))
        new = moved._replace(
            sim=sim,
            waypoint=terms.next_waypoint(p_xy, moved.waypoint, moved.waypoints, moved.num_waypoints),
            route_done=route_done,
            driven=driven,
            goal_distance=distance,
            steps=steps,
            age=nav.age + 1,
            last_action=action,
            result=result,
            crowd=crowd,
        )
        rewards = self._rewards(nav, new, velocity, hit)
        reward = sum(rewards.values(), jnp.float32(0.0))
        metrics = self._metrics(new, done_f, rewards)
        if self.dynamic is not None and crowd is not None:
            metrics |= self.dynamic.metrics(crowd, result, p_xy, velocity)
        if self.movables is not None:
            metrics |= self.movables.metrics(sim, result == Result.HIT)
        metrics |= {f"task/{name}": done_f * x for name, x in self.task.scores(new).items()}
        return new, reward, done_f, metrics

    @full_precision
    def observe(self, nav: NavState) -> dict[str, Array]:
        """Observations of a state; the only stage that renders."""
        position, quaternion = nav.sim.xpos[self._root], nav.sim.xquat[self._root]
        yaw = rotations.yaw_of(quaternion)
        last = nav.num_waypoints - 1
        to = [
            terms.to_body(point[:2] - position[:2], yaw)
            for point in (nav.goal, nav.waypoints[nav.waypoint], nav.waypoints[jnp.minimum(nav.waypoint + 1, last)])
        ]
        config = self._config
        known = self.task.observed_goal(nav)
        final = to[0] if known is nav.goal else terms.to_body(known[:2] - position[:2], yaw)
        goal = final if config.goal_mode == "final" else to[1]
        if config.goal_observation_limit > 0.0:
            goal = terms.limit_norm(goal, config.goal_observation_limit)
        told = self.task.goal_observation(nav)
        goal = goal if told is None else told
        speed = terms.to_body(nav.sim.qvel[:2], yaw)
        left = jnp.stack(
            [
                1.0 - nav.steps / config.episode_length,
                1.0 - nav.route_done / jnp.maximum(nav.route_length, 1e-6),
            ]
        )
        probes = position[:2] + terms.to_world(jnp.asarray(PROBES), yaw)
        around = self.distances(nav, probes).reshape(-1)
        own = self.task.privileged(nav)
        if self._arcs is not None:
            crowd, dynamic = nav.crowd, self.dynamic
            gaps = None if crowd is None or dynamic is None else functools.partial(dynamic.gaps, crowd)
            own = (*own, self._arcs.observe(nav.sim.scene, position[:2], yaw, gaps))
        privileged = jnp.concatenate([*to, speed, nav.sim.qvel[5:6], left, around, nav.last_action, *own])
        obs = {"goal": goal.astype(jnp.float32), "privileged": privileged.astype(jnp.float32)}
        if self._sees_proprio:
            obs["proprio"] = self._proprio(nav)
        if self._sees_map:
            metres = self.distances(nav, position[:2] + terms.to_world(jnp.asarray(MAP_PROBES), yaw))
            obs["privileged_map"] = jnp.clip(jnp.rint(metres * 100.0), 0.0, 255.0).astype(jnp.uint8).reshape(-1)
        if self._told is not None:
            obs["robot"] = self._told
        if self.renderer is not None:
            obs["pixels/front"] = self._pixels(nav)
        return obs

    @full_precision
    def named_observations(self, nav: NavState, obs: dict[str, Array]) -> dict[str, Array]:
        """`state`, (5 + action_size,) f32: goal and `proprio`; `privileged_state`: `privileged`."""
        return {"state": jnp.concatenate([obs["goal"], self._proprio(nav)]), "privileged_state": obs["privileged"]}

    @property
    def agent_appearances(self) -> tuple[int, ...]:
        """Row of the bank's agents for each moving agent's appearance."""
        return () if self.dynamic is None else slot_appearances(self.dynamic.kinds, self.bank)

    def agents_of(self, nav: NavState) -> AgentMotion | None:
        """Poses of people and vehicles for rendering; None without a crowd."""
        if self.dynamic is None or nav.crowd is None:
            return None
        return self.dynamic.places(nav.crowd, nav.sim.scene)

    # The environment as a whole.

    def info_of(self, nav: NavState) -> dict[str, Array]:
        """Scene, episode and result of the env."""
        return self.episode_info(nav.sim.scene, nav.episode, nav.result, nav.steps)

    def zero_metrics(self) -> dict[str, Float[Array, ""]]:
        """The metrics of an initial state."""
        names = [f"reward/{name}" for name in self._config.reward_config.scales]
        names += [
            "success",
            "hit",
            "off_traversable",
            "fall",
            "timeout",
            "non_finite",
            "route_completion",
            "distance_to_goal",
            "hit_time_per_step",
            "slot_overflow",
        ]
        names += PEOPLE_METRICS if self.dynamic is not None else ()
        names += MOVABLE_METRICS if self.movables is not None else ()
        names += [f"task/{name}" for name in self.task.SCORES]
        return {name: jnp.float32(0.0) for name in names}

    def is_traversable(self, scene: Int[Array, ""] | int, p_xy: Float[Array, "2"]) -> Bool[Array, ""]:
        """() bool, whether the ground under (2,) m is of a kind on which the robot may be."""
        return open_ground.is_open(self._walkable, scene, p_xy[0], p_xy[1], self._map_resolution)

    def _proprio(self, nav: NavState) -> Float[Array, " n"]:
        speed = terms.to_body(nav.sim.qvel[:2], rotations.yaw_of(nav.sim.xquat[self._root]))
        own = self.task.proprio(nav)
        # The last action stays last (`training.student.Student.last_action`).
        return jnp.concatenate([speed, nav.sim.qvel[5:6], *own, nav.last_action]).astype(jnp.float32)

    def _obeyed(self, nav: NavState, action: jax.Array) -> jax.Array:
        """The command that the engine gets in a control step, of which latency leaves a share to the action before."""
        command, latency = self._control(nav, action), self._randomization.latency(nav.appearance_seed)
        if latency is None:
            return command
        share = latency / self.dt
        return share * self._control(nav, nav.last_action) + (1.0 - share) * command

    def _still(self) -> jax.Array:
        """(action_size,) the action before the first one: no speed, the arm where it is, and a closed hand."""
        if self._arm is None or self.robot.arm is None:
            return jnp.zeros(self.action_size)
        still = jnp.concatenate([jnp.zeros(2), self._arm.shares(jnp.array(self.robot.arm.folded))])
        return still if self.robot.parcel is None else jnp.append(still, -1.0)

    def _control(self, nav: NavState, action: jax.Array) -> jax.Array:
        robot = self.robot
        if self._joint_range is not None:
            low, high = self._joint_range[:, 0], self._joint_range[:, 1]
            return low + 0.5 * (action + 1.0) * (high - low)
        if self._config.action_mode == "waypoint":
            v, omega = robot.waypoint_to_velocity(action, self.dt)
        else:
            v, omega = 0.5 * (action[0] + 1.0) * robot.max_speed, action[1] * robot.max_yaw_rate
        command = robot.command(jnp.stack([v, omega]))
        if self._arm is None or robot.arm is None:
            return command
        now, most = nav.sim.qpos[self._arm.addresses], robot.arm.speed * self.dt
        wanted = self._arm.angles(action[2 : 2 + len(robot.arm.actuators)])
        command = command.at[np.array(robot.arm.actuators)].set(jnp.clip(wanted, now - most, now + most))
        if robot.parcel is None:
            return command
        return command.at[np.array(robot.parcel.actuators)].set(self.task.holds(nav))

    def _rewards(self, old: NavState, new: NavState, velocity: jax.Array, hit: jax.Array) -> dict[str, jax.Array]:
        p_xy = new.sim.xpos[self._root, :2]
        to_goal = new.goal[:2] - p_xy
        values = {
            "arrived": terms.reward_arrived(new.result),
            "hit": terms.reward_hit(hit),
            "off_traversable": terms.reward_off_traversable(new.result),
            "position": terms.reward_position(new.goal_distance, 5.0),
            "position_fine": terms.reward_position(new.goal_distance, 1.0),
            "velocity_cosine": terms.reward_velocity_cosine(velocity, to_goal),
            "velocity_dot": terms.reward_velocity_dot(velocity, to_goal),
            "progress": terms.reward_progress(old.goal_distance, new.goal_distance),
            "near_object": terms.reward_near_object(self.distances(new, p_xy)[0]),
            **self.task.rewards(old, new),
        }
        factor = self.dt if self._config.reward_config.multiply_by_dt else 1.0
        return {
            name: jnp.float32(factor * scale) * values[name]
            for name, scale in self._config.reward_config.scales.items()
        }

    def _metrics(self, nav: NavState, done: jax.Array, rewards: dict[str, jax.Array]) -> dict[str, jax.Array]:
        def ended(code: Result) -> jax.Array:
            return (nav.result == code).astype(jnp.float32)

        return {
            **{f"reward/{name}": value for name, value in rewards.items()},
            "success": ended(Result.GOAL),
            "hit": ended(Result.HIT),
            "off_traversable": ended(Result.OFF_TRAVERSABLE),
            "fall": ended(Result.FALL),
            "timeout": ended(Result.TIMEOUT),
            "non_finite": ended(Result.NON_FINITE),
            "route_completion": done * nav.route_done / jnp.maximum(nav.route_length, 1e-6),
            "distance_to_goal": done * nav.goal_distance,
            "hit_time_per_step": nav.sim.contacts.hit_fraction,
            "slot_overflow": nav.sim.slot_overflow.astype(jnp.float32),
        }

    def distances(self, nav: NavState, p_xy: Float[Array, "*n 2"]) -> Float[Array, "*n 2"]:
        """(..., 2) m from points (..., 2) to the nearest hull or agent and to the edge of the walkable ground."""
        found = self._surroundings.distances(nav.sim.scene, p_xy)
        if self.clutter is not None and nav.sim.bodies is not None:
            return self.clutter.nearer(found, nav.sim.scene, nav.sim.bodies, p_xy)
        if self.dynamic is None or nav.crowd is None:
            return found
        return self.dynamic.nearer(found, nav.crowd, p_xy)

    def _pixels(self, nav: NavState) -> jax.Array:
        assert self.renderer is not None
        sim, seed = nav.sim, nav.appearance_seed if self._randomization.varies_appearance else 0
        mount = self._randomization.camera_mount(nav.appearance_seed)
        frame = self.renderer(sim.scene, sim.xpos, sim.xquat, seed, self.agents_of(nav), sim.bodies, mount)
        rgb, camera = frame["rgb"], self._randomization.camera_noise(nav.appearance_seed)
        if camera is not None:
            key = self._randomization.image_key(nav.appearance_seed, nav.steps)
            rgb = through_camera(rgb, camera, key)
        if not self._config.vision_config.depth:
            return rgb
        # The renderer writes 0 where no ray hits, which becomes the largest depth.
        metres = jnp.where(frame["depth"] > 0.0, frame["depth"], jnp.inf)
        depth = jnp.clip(metres * 10.0, 0.0, 255.0).astype(jnp.uint8)
        return jnp.concatenate([rgb, depth[..., None]], axis=-1)
