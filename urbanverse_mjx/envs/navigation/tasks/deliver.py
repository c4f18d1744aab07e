"""`Deliver`: drive up to a post beside the pavement and press its doorbell with the arm.

Forces and heights are those that people need: operable parts take at most 22.2 N (2010 ADA Standards for Accessible
Design, 309.4) and stand at most 1.22 m high (308). Rewards have the form of MuJoCo Playground's and ManiSkill's tasks
of reaching (Zakka et al., "MuJoCo Playground", 2025; Gu et al., "ManiSkill2", 2023): how much nearer the hand comes to
the target, and contact.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int32
from ml_collections import ConfigDict

from ....crowds.crowd import Crowd
from ....datatypes import RobotSpec, SceneBank, SimState, ValidationError
from ....geometry import rotations
from ....robots.arm_reach import ArmReach
from ...types import NavState, Result
from .. import terms
from ..scenarios import select_scenes
from .doorbells import Fixtures, checked_options, with_doorbells
from .task import Parts, Task

#: m from the button within which the fingertip can touch nothing but its cap without a hit. Wide, because a force is
#: the mean of a control step, in which the arm moves by some centimetres.
NEAR = 0.15
#: N above which the fingertip counts as touching something.
LEAST_FORCE = 0.5
#: m and rad/s, units of observed distances of the hand and of the joints' speeds.
HAND_UNIT, SPEED_UNIT = 0.5, 2.0


class PressState(NamedTuple):
    """Attributes:
    tip: (3,) m, centre of the fingertip.
    apart: () m from there to where it would be on the middle of the button.
    force: () N with which the fingertip pressed the button, the mean over the last control step; 0 where it or another
      part hit anything else.
    held: () s for which it has pressed hard enough.
    strayed: () bool, whether the fingertip touches another button or the ground.
    greatest: () N, the largest such force of the episode.
    """

    tip: Float[Array, "3"]
    apart: Float[Array, ""]
    force: Float[Array, ""]
    held: Float[Array, ""]
    strayed: Bool[Array, ""]
    greatest: Float[Array, ""]


class Deliver(Task):
    """Pressing a doorbell.

    Up to `config.task.posts` posts stand at walls and kerbs of every scene, each with a button at a height of
    `config.task.height` m (least and greatest). An episode begins `config.task.distance` m from one of them. The goal
    is the point on the ground from which the arm reaches the button, and the route leads there by two straight lines.
    The action has the targets of the arm's joints after the two of the base, see `NavEnv`.

    Ends: as point goals, without arriving; GOAL when the fingertip has pressed the button with at least
    `config.task.force` N, the mean of each control step, for `config.task.hold_time` s; HIT also when it touches
    another button or the ground. What else the arm touches is a hit as of any part of the robot. Scores of an episode:
    score: 1 if the doorbell rang, weighted by the length of the route over that driven (as SPL), else 0.
    press_force: N, the largest mean force of a control step on the button. tip_distance: m from the fingertip to the
    button at the end. Additional terms of reward: reach (m by which the fingertip came nearer to the button) and press
    (the force on the button as a share of the one that is needed, at most 1).

    `proprio` has the joint angles (in pi rad) and speeds of the arm and the force of the fingertip (as a share of what
    is needed, at most 2). `privileged` has these, and in the heading frame the button's middle (in units of 5 m, at
    most 2), the offset from the fingertip to it (in units of 0.5 m, at most 2), the direction in which it faces, and
    the share of `hold_time` for which it has been pressed.

    Raises:
      ValidationError: a value is out of its range, or the robot has no arm.
    """

    SCORES = ("score", "press_force", "tip_distance")
    GOAL_NAME = "doorbell"

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options = parts.config.task
        if not 0.0 < options.force <= 50.0:
            raise ValidationError(f"config.task.force: found {options.force:g} N, needed more than 0 and at most 50.")
        if not options.hold_time > 0.0:
            raise ValidationError(f"config.task.hold_time: found {options.hold_time:g} s, needed a time above 0.")
        self.needed, self.hold_time = float(options.force), float(options.hold_time)
        self.reach = ArmReach(parts.robot)
        assert parts.robot.arm is not None
        self._finger = parts.robot.foot_geoms.index(parts.robot.arm.tip)
        radius = float(parts.model.geom(parts.robot.arm.tip).size[0])
        self.buttons, self.radius = Fixtures.of(parts.bank, "buttons"), radius

    @classmethod
    def furnished(cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec) -> SceneBank:
        """See `Task.furnished`.

        Raises:
          ValidationError: see the class, or no scene has space for a post.
        """
        options = checked_options(config.task, 0.3, 1.22)
        ArmReach(robot)
        scenes = select_scenes(bank, config.scenes).tolist()
        return with_doorbells(bank, scenes, robot, options)

    @classmethod
    def episodes(
        cls, config: ConfigDict, bank: SceneBank, robot: RobotSpec, scenes: Int32[np.ndarray, " n"]
    ) -> tuple[SceneBank, Int32[np.ndarray, " n"], Any]:
        """See `Task.episodes`: `furnished` wrote them; scenes without a post have none."""
        del config, robot
        return bank, np.array([z for z in scenes if bank.meta["buttons"][z]], np.int32), None

    def button(self, nav: NavState) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
        """(3,) m, the middle of the surface of an episode's button, and the direction (3,) in which it faces."""
        return self.buttons.of_episode(nav.sim.scene, nav.episode)

    def begin(self, key: Any, nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        zero = jnp.float32(0.0)
        return nav._replace(task=self._state(nav, nav.sim, zero, zero))

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        del crowd
        return {"task": self._state(nav, sim, nav.task.held, nav.task.greatest)}

    def _state(self, nav: NavState, sim: SimState, held: Any, greatest: Any) -> PressState:
        hand = self.reach.hand
        tip = sim.xpos[hand] + rotations.rotate(sim.xquat[hand], self.reach.tip)
        middle, facing = self.button(nav)
        apart = jnp.linalg.norm(tip - middle - self.radius * facing)
        force = sim.contacts.foot_force[self._finger]
        near = apart < NEAR
        pressed = jnp.where(near & ~sim.contacts.hit, force, 0.0)
        held = jnp.where(pressed >= self.needed, held + self.dt, 0.0)
        strayed = (force > LEAST_FORCE) & ~near
        return PressState(tip, apart, pressed, held, strayed, jnp.maximum(greatest, pressed))

    def result(self, nav: NavState, result: Int[Array, ""]) -> Int[Array, ""]:
        """See `Task.result`."""
        state: PressState = nav.task
        ended = (result != Result.RUNNING) & (result != Result.TIMEOUT)
        # Half a step of tolerance, because the time is a sum of steps.
        rang = state.held > self.hold_time - 0.5 * self.dt
        result = jnp.where(rang & ~ended, Result.GOAL, result)
        # A touch of the finger elsewhere ends an episode as other hits do.
        stops = state.strayed & ~ended & bool(self.parts.config.terminate_on_hit)
        return jnp.where(stops, Result.HIT, result).astype(jnp.int32)

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        state: PressState = new.task
        share = jnp.minimum(state.force / self.needed, 1.0)
        return {"reach": old.task.apart - state.apart, "press": share}

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: PressState = nav.task
        spl = nav.route_length / jnp.maximum(jnp.maximum(nav.driven, nav.route_length), 1e-6)
        return {
            "score": jnp.where(nav.result == Result.GOAL, spl, 0.0),
            "press_force": state.greatest,
            "tip_distance": state.apart,
        }

    def proprio(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.proprio`."""
        sim = nav.sim
        angles, speeds = sim.qpos[self.reach.addresses], sim.qvel[self.reach.speeds]
        felt = sim.contacts.foot_force[self._finger] / self.needed
        return angles / jnp.pi, jnp.clip(speeds / SPEED_UNIT, -2.0, 2.0), jnp.minimum(felt, 2.0)[None]

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        state: PressState = nav.task
        robot, root = self.pose(nav.sim), nav.sim.xpos[self.parts.root]
        middle, facing = self.button(nav)

        def ahead(offset: Any, unit: float) -> Any:
            level = terms.to_body(offset[:2], robot.yaw)
            return jnp.clip(jnp.append(level, offset[2]) / unit, -2.0, 2.0)

        target = middle + self.radius * facing
        told = ahead(middle - root, 5.0), ahead(target - state.tip, HAND_UNIT), terms.to_body(facing[:2], robot.yaw)
        return *self.proprio(nav), *told, jnp.minimum(state.held / self.hold_time, 1.0)[None]
