"""`SocialNav`: point goals in a dense crowd, judged by the comfort of the people, too.

The measures are those of the literature on social navigation:

* Hall, "The Hidden Dimension" (1966): intimate (0.45 m) and personal (1.2 m) distance.
* Francis et al., "Principles and Guidelines for Evaluating Social Robot Navigation Algorithms" (2023): least distance
  to a human, space compliance, least time to collision, jerk.
* Biswas et al., "SocNavBench" (2021), and Tsoi et al., "SEAN 2.0" (2022): distances and times to collision of
  pedestrians, intrusions into the intimate and the personal space, jerk.
* Guzzi et al., "Human-friendly robot navigation in dynamic environments" (2013): turning per metre (there without the
  least turning that a path needs).
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Key

from ....crowds.behaviours import STAY
from ....crowds.crowd import Crowd
from ....datatypes import SimState, ValidationError
from ....geometry import rotations
from ...types import NavState, Result
from ..dynamic import INTIMATE_DISTANCE, MAX_PEOPLE_DISTANCE, PERSONAL_DISTANCE
from .people import MAX_TIME_TO_COLLISION, PeopleTask
from .task import Parts

#: m between bodies within which people that walk slower than they prefer count as delayed by the robot.
DELAY_DISTANCE = 2.0
#: Number of agents in `privileged`.
OBSERVED = 6


def reward_personal_space(gap: Float[Array, ""]) -> Float[Array, ""]:
    """0 at Hall's personal distance (m between bodies), 1 at the intimate distance and within it."""
    return jnp.clip((PERSONAL_DISTANCE - gap) / (PERSONAL_DISTANCE - INTIMATE_DISTANCE), 0.0, 1.0)


def reward_time_to_collision(seconds: Float[Array, ""], horizon: float) -> Float[Array, ""]:
    """0 from `horizon` s on, 1 at contact."""
    return jnp.clip(1.0 - seconds / horizon, 0.0, 1.0)


class SocialState(NamedTuple):
    """Attributes:
    intimate, personal: () steps with a person within these distances.
    nearest: () m, least distance between the disc around the robot and a person's body; gap: () m, that of the last
      step.
    least_time: () s, least time to a collision with an agent; time: () s, that of the last step.
    velocity, acceleration: (2,) m/s and m/s² of the last step.
    jerk: () m/s³, of the last step; jerks: () its sum over the steps.
    turning: () rad, sum of all turns.
    delay: () s, time that people near the robot lost.
    """

    intimate: Float[Array, ""]
    personal: Float[Array, ""]
    nearest: Float[Array, ""]
    gap: Float[Array, ""]
    least_time: Float[Array, ""]
    time: Float[Array, ""]
    velocity: Float[Array, "2"]
    acceleration: Float[Array, "2"]
    jerk: Float[Array, ""]
    jerks: Float[Array, ""]
    turning: Float[Array, ""]
    delay: Float[Array, ""]


class SocialNav(PeopleTask):
    """Point goals in a dense crowd.

    Ends: those of point goals. Scores of an episode: score: 1 minus intimate_time if the episode succeeds, else 0:
    success weighted by space compliance. intimate_time, personal_time: share of the time with a person within 0.45 and
    1.2 m. least_distance: m to a person, at most 30. time_to_collision: s, least one with an agent at constant
    velocities, at most 10. jerk: m/s³, mean of its absolute value at the control rate. turning: rad/m. people_delay: s
    that people within 2 m of the robot lose by walking slower than they prefer, per minute; what other people cause
    there is in it, so it compares robots in the same crowd. Additional terms of reward: personal_space,
    time_to_collision (each 0 to 1) and jerk (its share of `config.task.jerk_limit`). `privileged` has the `OBSERVED`
    nearest agents, see `people_observed`, and the time to a collision in units of 10 s.

    Raises:
      ValidationError: the horizon or the limit is not positive, or there is no crowd.
    """

    SCORES = (
        "score",
        "intimate_time",
        "personal_time",
        "least_distance",
        "time_to_collision",
        "jerk",
        "turning",
        "people_delay",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        options = parts.config.task
        for name in ("horizon", "jerk_limit"):
            if not options[name] > 0.0:
                raise ValidationError(f"config.task.{name}: found {options[name]}, needed a number above 0.")
        self.horizon, self.jerk_limit = float(options.horizon), float(options.jerk_limit)
        self._people = jnp.array([kind != "car" for kind in self.dynamic.kinds])

    def begin(self, key: Key[Array, ""], nav: NavState) -> NavState:
        """The first state of an episode."""
        del key
        zero, far = jnp.float32(0.0), jnp.float32(MAX_PEOPLE_DISTANCE)
        late = jnp.float32(MAX_TIME_TO_COLLISION)
        still = jnp.zeros(2)
        return nav._replace(task=SocialState(zero, zero, far, far, late, late, still, still, zero, zero, zero, zero))

    def advance(self, nav: NavState, sim: SimState, crowd: Crowd | None) -> dict[str, Any]:
        """See `Task.advance`."""
        assert crowd is not None
        before: SocialState = nav.task
        robot = self.pose(sim)
        gaps = jnp.where(self._people, self.dynamic.gaps(crowd, robot.xy), jnp.inf) - self.radius
        gap = jnp.clip(jnp.min(gaps), 0.0, MAX_PEOPLE_DISTANCE)
        time = self.time_to_collision(crowd, robot, crowd.present)
        acceleration = (robot.velocity - before.velocity) / self.dt
        jerk = jnp.linalg.norm(acceleration - before.acceleration) / self.dt
        turned = rotations.yaw_of(sim.xquat[self.parts.root]) - rotations.yaw_of(nav.sim.xquat[self.parts.root])
        state = SocialState(
            intimate=before.intimate + (gap < INTIMATE_DISTANCE),
            personal=before.personal + (gap < PERSONAL_DISTANCE),
            nearest=jnp.minimum(before.nearest, gap),
            gap=gap,
            least_time=jnp.minimum(before.least_time, time),
            time=time,
            velocity=robot.velocity,
            acceleration=acceleration,
            jerk=jerk,
            jerks=before.jerks + jerk,
            turning=before.turning + jnp.abs(jnp.arctan2(jnp.sin(turned), jnp.cos(turned))),
            delay=before.delay + self.dt * self._delayed(crowd, gaps < DELAY_DISTANCE),
        )
        return {"task": state}

    def _delayed(self, crowd: Crowd, near: Bool[Array, " A"]) -> Float[Array, ""]:
        """() sum over the walking people that are near of the share by which they are slower than they prefer."""
        walks = crowd.present & near & (crowd.mode != STAY)
        pace = jnp.hypot(crowd.bodies.vx, crowd.bodies.vy) / jnp.maximum(crowd.speed, 0.1)
        return jnp.where(walks, jnp.clip(1.0 - pace, 0.0, 1.0), 0.0).sum()

    def rewards(self, old: NavState, new: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.rewards`."""
        del old
        state: SocialState = new.task
        return {
            "personal_space": reward_personal_space(state.gap),
            "time_to_collision": reward_time_to_collision(state.time, self.horizon),
            "jerk": jnp.clip(state.jerk / self.jerk_limit, 0.0, 1.0),
        }

    def scores(self, nav: NavState) -> dict[str, Float[Array, ""]]:
        """See `Task.scores`."""
        state: SocialState = nav.task
        steps = jnp.maximum(nav.steps, 1).astype(jnp.float32)
        intimate = state.intimate / steps
        values = (
            (nav.result == Result.GOAL) * (1.0 - intimate),
            intimate,
            state.personal / steps,
            state.nearest,
            state.least_time,
            state.jerks / steps,
            state.turning / jnp.maximum(nav.driven, 1.0),
            60.0 * state.delay / (steps * self.dt),
        )
        return {name: jnp.float32(x) for name, x in zip(self.SCORES, values, strict=True)}

    def privileged(self, nav: NavState) -> tuple[Float[Array, " n"], ...]:
        """See `Task.privileged`."""
        assert nav.crowd is not None
        people = self.people_observed(nav.crowd, self.pose(nav.sim), OBSERVED)
        return people, nav.task.time[None] / MAX_TIME_TO_COLLISION
