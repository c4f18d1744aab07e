"""`DropOff`: drive up to a parcel box beside the pavement and drop a parcel into it.

Rewards have the form of MuJoCo Playground's and ManiSkill's tasks of placing (Zakka et al., "MuJoCo Playground", 2025;
Gu et al., "ManiSkill2", 2023): how much nearer the parcel comes to the place of its release, and the release there.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int32
from ml_collections import ConfigDict

from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ....robots.arm_reach import ArmReach
from ...types import NavState, Result
from .. import terms
from ..scenarios import select_scenes
from .boxes import DEPTH, HALF_SIDE, INNER
from .deliver import HAND_UNIT, LEAST_FORCE, SPEED_UNIT
from .doorbells import Fixtures, checked_options, with_parcel_boxes
from .task import Parts, Task

#: m between the rim of a box and the parcel's lower side at the place of its release.
CLEARANCE = 0.08
#: m above that up to which a release is rewarded.
HIGHEST = 0.3
#: Value of the action's last number above which it opens the hand. Beyond the middle, because a policy that explores
#: would let go at once.
OPENING = 0.5
#: m around the middle of a box within which a parcel at the hand may touch it.
NEAR = 0.5
#: m below the ground of the start at which a parcel is beside every surface.
BELOW = 0.3


class DropState(NamedTuple):
    """Attributes:
    parcel: (3,) m, its middle.
    apart: () m from there to the place of its release; kept from the release on.
    opening: () s for which the hand has been told to open.
    released: () bool, whether it has opened, for good.
    lain: () s for which the parcel has been in the box since.
    fell: () bool, whether it has come down elsewhere.
    strayed: () bool, whether the fingertip touches anything, or a parcel at the hand something else than the box.
    height: () m, of its lower side above the box's floor at the release; 0 before.
    best: () the largest share of `release_time` for which the hand has been told to open above the box.
    spilt: () bool, whether it has been told so elsewhere in the last step.
    """

    parcel: Float[Array, "3"]
    apart: Float[Array, ""]
    opening: Float[Array, ""]
    released: Bool[Array, ""]
    lain: Float[Array, ""]
    fell: Bool[Array, ""]
    strayed: Bool[Array, ""]
    height: Float[Array, ""]
    best: Float[Array, ""]
    spilt: Bool[Array, ""]


class DropOff(Task):
    """Dropping a parcel into a box.

    Up to `config.task.posts` boxes, open at the top, stand at walls and kerbs of every scene, with rims at a height of
    `config.task.height` m (least and greatest). An episode begins `config.task.distance` m from one of them, with a
    parcel at the hand. The goal is the point on the ground from which the arm reaches over the box, and the route leads
    there by two straight lines. The action has the targets of the arm's joints after the two of the base, see `NavEnv`,
    and at its end a number that opens the hand where it is above 0.5 for `config.task.release_time` s. An open hand
    does not close again.

    Ends: as point goals, without arriving; GOAL when the parcel has lain in the box for `config.task.lie_time` s, with
    its middle between the walls and all of it below the rim, and the hand is open; DROPPED when it has come down
    elsewhere; HIT also when the fingertip touches anything, or a parcel at the hand something else than the box. What
    else the arm touches is a hit as of any part of the robot, and so is a parcel at an object. Scores of an episode:
    score: 1 if the parcel lies in the box, weighted by the length of the route over that driven (as SPL), else 0.
    parcel_distance: m across from the parcel to the middle of the box at the end. release_height: m from the box's
    floor to the parcel's lower side when it was released, 0 if it was not. Additional terms of reward: carry (m by
    which the parcel at the hand came nearer to the place of its release, `CLEARANCE` above the middle of the box), open
    (share of `release_time` for which the hand has been told to open above the box's inside, in so far as it is more
    than ever before: at most 1 in an episode), spilt (1 in a step in which it is told so elsewhere) and dropped (1 at
    the end DROPPED).

    `proprio` has the joint angles (in pi rad) and speeds of the arm, whether the parcel is at the hand, and for what
    share of the time it has been told to open. `privileged` has these, and in the heading frame the middle between the
    box's rims (in units of 5 m, at most 2), the offset from the parcel to the place of its release (in units of 0.5 m,
    at most 2), the direction from which the box is reached, and the share of `lie_time` for which the parcel has lain.

    Raises:
      ValidationError: a value is out of its range, the robot has no parcel, or actions are joints'.
    """

    SCORES = ("score", "parcel_distance", "release_height")
    GOAL_NAME = "parcel box"

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options, robot = parts.config.task, parts.robot
        for name in ("release_time", "lie_time"):
            if not options[name] > 0.0:
                raise ValidationError(f"config.task.{name}: found {options[name]:g} s, needed a time above 0.")
        if parts.config.action_mode == "joint":
            raise ValidationError(
                "config.action_mode: found 'joint' for a robot with a parcel, needed 'waypoint' or 'velocity'."
            )
        self.release_time, self.lie_time = float(options.release_time), float(options.lie_time)
        assert robot.arm is not None
        assert robot.parcel is not None
        #: The arm's kinematics with the parcel's middle in place of the fingertip.
        self.reach = ArmReach(robot, robot.parcel.ahead)
        self.half_side, self.body = robot.parcel.half_side, parts.model.body(robot.parcel.body).id
        self._finger = robot.foot_geoms.index(robot.arm.tip)
        self._spheres = np.array([robot.foot_geoms.index(name) for name in robot.parcel.spheres])
        self.boxes = Fixtures.of(parts.bank, "boxes")

    @classmethod
    def furnished(cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec) -> SceneBank:
        """See `Task.furnished`.

        Raises:
          ValidationError: see the class, or no scene has space for a box.
        """
        options = checked_options(config.task, 0.4, 0.9)
        if robot.parcel is None:
            raise ValidationError(
                f"robot {robot.name!r}: found no parcel, needed an arm that holds one, such as that of 'coco_parcel'."
            )
        return with_parcel_boxes(bank, select_scenes(bank, config.scenes).tolist(), robot, options)

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`: `furnished` wrote them; scenes without a box have none."""
        del config, robot
        return bank, np.array([z for z in scenes if bank.meta["boxes"][z]], np.int32), None

    def box(self, nav: NavState) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
        """(3,) m, the middle between the rims of an episode's box, and the direction (3,) from which it is reached."""
        return self.boxes.of_episode(nav.sim.scene, nav.episode)

    def drop(self, nav: NavState) -> Float[Array, "3"]:
        """(3,) m, where the parcel's middle is to be at its release."""
        return self.box(nav)[0] + jnp.array([0.0, 0.0, CLEARANCE + self.half_side])

    def begin(self, key: Any, nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        zero, no = jnp.float32(0.0), jnp.zeros((), bool)
        parcel = nav.sim.xpos[self.body]
        apart = jnp.linalg.norm(parcel - self.drop(nav))
        return nav._replace(task=DropState(parcel, apart, zero, no, zero, no, no, zero, zero, no))

    def holds(self, nav: NavState) -> Float[Array, ""]:
        """See `Task.holds`."""
        return 1.0 - nav.task.released.astype(jnp.float32)

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`. The hand opens in the step after that for which it has been told for long enough."""
        del crowd
        old: DropState = nav.task
        parcel, held = sim.xpos[self.body], ~old.released
        away, above = self._within(nav, parcel)
        force, touch = sim.contacts.foot_force[self._spheres].sum(), sim.contacts.foot_force[self._finger]
        lies = old.released & (away < INNER) & (above < -self.half_side) & (above > -DEPTH)
        down = (force > LEAST_FORCE) | (parcel[2] < nav.start[2] - BELOW)
        told = nav.last_action[-1] > OPENING
        opening = jnp.where(told, old.opening + self.dt, 0.0)
        # Half a step of tolerance, because the time is a sum of steps.
        opens = held & (opening > self.release_time - 0.5 * self.dt)
        lower = above - self.half_side + DEPTH
        over = (away < INNER - self.half_side) & (above > 0.0) & (above < self.half_side + CLEARANCE + HIGHEST)
        share = jnp.minimum(opening / self.release_time, 1.0)
        state = DropState(
            parcel=parcel,
            apart=jnp.where(held, jnp.linalg.norm(parcel - self.drop(nav)), old.apart),
            opening=opening,
            released=old.released | opens,
            lain=jnp.where(lies, old.lain + self.dt, 0.0),
            fell=old.fell | (old.released & down & ((away > HALF_SIDE) | (above < -DEPTH))),
            strayed=(touch > LEAST_FORCE) | (held & (force > LEAST_FORCE) & (away > NEAR)),
            height=jnp.where(opens, lower, old.height),
            best=jnp.where(held & over, jnp.maximum(old.best, share), old.best),
            spilt=held & told & ~over,
        )
        return {"task": state}

    def _within(self, nav: NavState, place: Any) -> tuple[Any, Any]:
        """m of a place (3,) from the middle of the box, the larger of across and along it, and above its rim."""
        middle, facing = self.box(nav)
        offset = place - middle
        across, along = offset[0] * facing[1] - offset[1] * facing[0], offset @ facing
        return jnp.maximum(jnp.abs(across), jnp.abs(along)), offset[2]

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        state: DropState = nav.task
        ended = (result != Result.RUNNING) & (result != Result.TIMEOUT)
        lies = state.lain > self.lie_time - 0.5 * self.dt
        result = jnp.where(state.fell & ~ended, Result.DROPPED, result)
        result = jnp.where(lies & ~ended & ~state.fell, Result.GOAL, result)
        # A touch of the hand elsewhere ends an episode as other hits do.
        stops = state.strayed & ~ended & bool(self.parts.config.terminate_on_hit)
        return jnp.where(stops, Result.HIT, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        state: DropState = new.task
        return {
            "carry": old.task.apart - state.apart,
            "open": state.best - old.task.best,
            "spilt": jnp.float32(state.spilt),
            "dropped": jnp.float32(new.result == Result.DROPPED),
        }

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: DropState = nav.task
        spl = nav.route_length / jnp.maximum(jnp.maximum(nav.driven, nav.route_length), 1e-6)
        return {
            "score": jnp.where(nav.result == Result.GOAL, spl, 0.0),
            "parcel_distance": jnp.linalg.norm((state.parcel - self.box(nav)[0])[:2]),
            "release_height": state.height,
        }

    def shown(self, nav: NavState) -> dict[str, Array]:
        """See `Task.shown`."""
        state: DropState = nav.task
        return {"released": state.released.astype(jnp.float32), "lain": state.lain}

    def note(self, values: Mapping[str, float]) -> str:
        """See `Task.note`."""
        if not values["released"]:
            return "holds the parcel"
        return "let go of the parcel" if not values["lain"] else "the parcel is in the box"

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        sim, state = nav.sim, nav.task
        angles, speeds = sim.qpos[self.reach.addresses], sim.qvel[self.reach.speeds]
        hand = jnp.stack([self.holds(nav), jnp.minimum(state.opening / self.release_time, 1.0)])
        return angles / jnp.pi, jnp.clip(speeds / SPEED_UNIT, -2.0, 2.0), hand

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        state: DropState = nav.task
        robot, root = self.pose(nav.sim), nav.sim.xpos[self.parts.root]
        middle, facing = self.box(nav)

        def ahead(offset: Any, unit: float) -> Any:
            level = terms.to_body(offset[:2], robot.yaw)
            return jnp.clip(jnp.append(level, offset[2]) / unit, -2.0, 2.0)

        told = ahead(middle - root, 5.0), ahead(self.drop(nav) - state.parcel, HAND_UNIT)
        lain = jnp.minimum(state.lain / self.lie_time, 1.0)
        return *self.proprio(nav), *told, terms.to_body(facing[:2], robot.yaw), lain[None]
