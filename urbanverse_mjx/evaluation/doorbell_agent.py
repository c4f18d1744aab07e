"""`DoorbellPresser` and `ParcelDropper`: the scripted controllers of `Deliver` and `DropOff`, by the route, the place
of the button or the box, and inverse kinematics.

In:   the env's complete state.
Out:  an action: the base's waypoint, the targets of the arm's joints, and whether the hand opens.
When: every control step, inside jit, per env.
"""

from typing import Any

import jax.numpy as jnp

from ..crowds.motion import wrapped
from ..datatypes import ValidationError
from ..envs import NavEnv, NavState
from ..envs.navigation.tasks.boxes import HALF_SIDE, INNER
from ..envs.navigation.tasks.deliver import Deliver
from ..envs.navigation.tasks.doorbells import APPROACH, STANDOFF
from ..envs.navigation.tasks.drop_off import CLEARANCE, DropOff
from ..geometry import rotations
from .planner import motion_of, waypoint_of

#: m/s towards the approach and along the last line, per m that is left, and at most.
GAIN, LAST_SPEED = 1.0, 0.4
#: rad/s per rad of error, and rad beyond which the robot turns on the spot.
TURN_GAIN, TURN_FIRST = 1.2, 0.35
#: rad per m beside the last line.
LINE_GAIN = 1.5
#: m beside the last line and before its begin within which the robot drives along it.
LINE_WIDTH = 0.15
#: m and rad within which it stands where it should, and m/s below which it stands.
THERE, FACING, STANDING = 0.04, 0.1, 0.05
#: m and rad within which an arm that is out stays out.
STAYS, STAYS_FACING = 0.25, 0.4
#: m from the button along its axis to which the fingertip is brought, the farthest first, and by which it may be
#: farther for the next one; m that it may be beside the axis.
STAGES, REACHED, ASIDE = (0.2, 0.05), 0.05, 0.02
#: N of a press.
PRESS_FORCE = 12.0
#: rad, arm in front of the robot, from which inverse kinematics start: elbow up.
READY = (0.0, -0.3, 0.0, 0.3, 0.0)
#: m below the place of the release from which on the arm goes there; m across and up from it within which the hand
#: opens, and m/s of the robot up to which.
RAISED, OVER, SLOW = 0.05, 0.04, 0.1
#: N/kg.
GRAVITY = 9.81


class ArmDriver:
    """What both controllers do with the base: they drive the two lines of the route and stand there.

    Args:
      env: environment of `Deliver` or `DropOff` with `action_mode="waypoint"`.

    Raises:
      ValidationError: the action mode is another one.
    """

    def __init__(self, env: NavEnv) -> None:
        assert isinstance(env.task, Deliver | DropOff)
        if env.config.action_mode != "waypoint":
            raise ValidationError(
                f"scripted arm: found action_mode {env.config.action_mode!r}, needed 'waypoint'; leave it as it is."
            )
        self._env, self._task = env, env.task
        self._reach, self._root = env.task.reach, env.mj_model.body(env.robot.root_body).id
        assert env.robot.arm is not None
        self._folded, self._pivot = jnp.array(env.robot.arm.folded), motion_of(env.robot).pivot

    def prepare(self, scenes: Any, rows: Any) -> None:
        """Returns no data, because the state contains the route."""

    def _target(self, nav: NavState) -> tuple[Any, Any]:
        """(3,) m, the middle of the button or between the rims, and the direction (3,) from which it is reached."""
        raise NotImplementedError

    def _reaching(self, nav: NavState, angles: Any, middle: Any, facing: Any) -> Any:
        """(J,) rad, targets of the arm while the base stands."""
        raise NotImplementedError

    def act(self, nav: NavState, known: Any = None) -> Any:
        """(2 + J,) action in [-1, 1]."""
        robot = self._task.pose(nav.sim)
        middle, facing = self._target(nav)
        # Of the axle that is not steered, which stays where it is while the robot turns on the spot.
        ahead = jnp.stack([jnp.cos(robot.yaw), jnp.sin(robot.yaw)])
        axle, stand = robot.xy - self._pivot * ahead, nav.goal[:2] + self._pivot * facing[:2]
        approach = nav.goal[:2] + (APPROACH - STANDOFF) * facing[:2]
        before = (axle - stand) @ facing[:2]
        beside = (axle - stand) @ jnp.stack([-facing[1], facing[0]])
        turn = wrapped(jnp.arctan2(-facing[1], -facing[0]) - robot.yaw)
        angles = nav.sim.qpos[self._reach.addresses]
        out = jnp.abs(angles - self._folded).max() > 0.3
        arrived = (before < THERE) & (jnp.abs(turn) < FACING) & (jnp.linalg.norm(robot.velocity) < STANDING)
        stays = out & (jnp.abs(before) < STAYS) & (jnp.abs(turn) < STAYS_FACING)
        reaching = arrived | stays
        # The base.
        line = (approach - stand) @ facing[:2]
        on_line = (jnp.abs(beside) < LINE_WIDTH) & (before < line + LINE_WIDTH)
        offset = approach - axle
        to_approach = wrapped(jnp.arctan2(offset[1], offset[0]) - robot.yaw)
        # Left of the line as seen from the button is right of it for the robot that faces it.
        on_course = turn + jnp.clip(LINE_GAIN * beside, -0.3, 0.3) * (before > THERE)
        error = jnp.where(on_line, on_course, to_approach)
        speed = jnp.where(on_line, jnp.clip(GAIN * before, 0.0, LAST_SPEED), GAIN * jnp.linalg.norm(offset) + 0.1)
        speed = jnp.where(on_line & (before < 0.5 * THERE), 0.0, speed)
        speed = jnp.where(jnp.abs(error) > TURN_FIRST, 0.0, speed * jnp.cos(error))
        omega = jnp.clip(TURN_GAIN * error, -1.0, 1.0) * self._env.robot.max_yaw_rate
        speed, omega = (jnp.where(reaching, 0.0, x) for x in (speed, omega))
        base = waypoint_of(
            jnp.minimum(speed, self._env.robot.max_speed), omega, self._env.robot.max_speed, self._env.dt
        )
        target = jnp.where(reaching, self._reaching(nav, angles, middle, facing), self._folded)
        return jnp.clip(jnp.concatenate([base, self._reach.shares(target)]), -1.0, 1.0)

    def _into(self, nav: NavState) -> Any:
        """(4,) the rotation from the world into the robot's frame."""
        return nav.sim.xquat[self._root] * jnp.array([1.0, -1.0, -1.0, -1.0])


class DoorbellPresser(ArmDriver):
    """The controller of `Deliver`: brings the fingertip before the button, and presses.

    Args:
      env: environment of `Deliver` with `action_mode="waypoint"`.
      height: m above the ground at which it takes the button to be; None where it knows.
    """

    def __init__(self, env: NavEnv, height: float | None = None) -> None:
        super().__init__(env)
        assert isinstance(env.task, Deliver)
        self._bell, self._height = env.task, height

    def _target(self, nav: NavState) -> tuple[Any, Any]:
        """See `ArmDriver`."""
        middle, facing = self._bell.button(nav)
        return middle if self._height is None else middle.at[2].set(nav.start[2] + self._height), facing

    def _reaching(self, nav: NavState, angles: Any, middle: Any, facing: Any) -> Any:
        """(J,) rad, targets that bring the fingertip to the button (3,) m that faces (3,), and press it."""
        place, back = nav.sim.xpos[self._root], self._into(nav)
        away = nav.task.tip - middle - self._bell.radius * facing
        out = away @ facing
        aside = jnp.linalg.norm(away - out * facing)
        first, second = STAGES
        near = (aside < ASIDE) & (out < second + REACHED)
        ahead = jnp.where(aside + jnp.abs(out - first) < REACHED, second, jnp.where(out < first, second, first))
        ahead = jnp.where(near, 0.0, ahead)
        wanted = rotations.rotate(back, middle + (self._bell.radius + ahead) * facing - place)
        pose = self._reach.pose(angles)
        level = (wanted - pose.anchor[0]) * jnp.array([1.0, 1.0, 0.0])
        found, _ = self._reach.solve(jnp.array(READY), wanted, level / jnp.maximum(jnp.linalg.norm(level), 1e-6))
        push = jnp.where(near, PRESS_FORCE, 0.0) * rotations.rotate(back, -facing)
        return found + self._reach.holding(pose, push) / self._reach.gain


class ParcelDropper(ArmDriver):
    """The controller of `DropOff`: raises the parcel, brings it over the box, and opens the hand.

    Args:
      env: environment of `DropOff` with `action_mode="waypoint"`.
      straight: whether it knows no more than the goal, and takes the box to stand straight behind it, as seen from the
        start, with a rim at the greatest height.
    """

    def __init__(self, env: NavEnv, straight: bool = False) -> None:
        super().__init__(env)
        assert isinstance(env.task, DropOff)
        self._straight, self._highest = straight, float(env.config.task.height[1])
        self._carried, self._weight = env.task, GRAVITY * float(env.mj_model.body_mass[env.task.body])

    def act(self, nav: NavState, known: Any = None) -> Any:
        """(3 + J,) action in [-1, 1]."""
        task = self._carried
        middle, _ = self._target(nav)
        away = jnp.abs(nav.task.parcel - middle - jnp.array([0.0, 0.0, CLEARANCE + task.half_side]))
        still = jnp.linalg.norm(nav.sim.qvel[:2]) < SLOW
        opens = (away.max() < OVER) & still | (nav.task.opening > 0.0) | nav.task.released
        return jnp.append(super().act(nav, known), jnp.where(opens, 1.0, -1.0))

    def _target(self, nav: NavState) -> tuple[Any, Any]:
        """See `ArmDriver`."""
        if not self._straight:
            return self._carried.box(nav)
        back = jnp.append(nav.start[:2] - nav.goal[:2], 0.0)
        facing = back / jnp.maximum(jnp.linalg.norm(back), 1e-6)
        middle = jnp.append(nav.goal[:2], nav.start[2] + self._highest)
        return middle - (STANDOFF + HALF_SIDE) * facing, facing

    def _reaching(self, nav: NavState, angles: Any, middle: Any, facing: Any) -> Any:
        """(J,) rad, targets that bring the parcel over the box, whose middle is (3,) m, by way of `READY`."""
        del facing
        place, back, ready = nav.sim.xpos[self._root], self._into(nav), jnp.array(READY)
        above = middle + jnp.array([0.0, 0.0, CLEARANCE + self._carried.half_side])
        wanted = rotations.rotate(back, above - place)
        pose = self._reach.pose(angles)
        level = (wanted - pose.anchor[0]) * jnp.array([1.0, 1.0, 0.0])
        found, _ = self._reach.solve(ready, wanted, level / jnp.maximum(jnp.linalg.norm(level), 1e-6))
        # Out of the pose for driving towards one above all boxes, until the parcel is above the rim.
        inside = jnp.linalg.norm((pose.tip - wanted)[:2]) < INNER - self._carried.half_side
        raised = inside | (pose.tip[2] > wanted[2] - RAISED)
        load = jnp.where(nav.task.released, 0.0, self._weight) * rotations.rotate(back, jnp.array([0.0, 0.0, 1.0]))
        return jnp.where(raised, found, ready) + self._reach.holding(pose, load) / self._reach.gain
