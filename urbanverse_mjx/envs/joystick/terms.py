"""Reward terms of the locomotion task: pure functions of the motion in one control step.

Their forms are those of public tasks, see docs/decisions/go2.md.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float
from ml_collections import ConfigDict

#: N, contact force below which a foot is in the air.
CONTACT_FORCE = 1.0
#: m/s and rad/s; smaller commands mean to stand.
STANDING_COMMAND = 0.1
#: s; shorter steps than the first are penalised, longer ones than the second have no additional reward.
MIN_STEP_TIME, MAX_STEP_TIME = 0.2, 0.5
#: Weights of a leg's deviations from the standing pose (Playground: 1, 1, 0.1; the thigh's is lower here, for kerbs),
#: unless the config has others.
POSE_WEIGHTS = (1.0, 0.2, 0.1)
#: Share of a joint's range without a penalty.
SOFT_RANGE_SHARE = 0.95
#: Share of a motor's speed limit without a penalty.
SOFT_SPEED_SHARE = 0.9


class Motion(NamedTuple):
    """Motion of the robot in a control step; J joints, F feet.

    Attributes:
      linear: (3,) m/s of the trunk, heading frame.
      angular: (3,) rad/s, body frame.
      up: (3,) the world's up in the body frame.
      height: () m, trunk above the ground under the feet.
      joints: (J,) rad.
      joint_speed: (J,) rad/s.
      joint_acceleration: (J,) rad/s².
      torque: (J,) N m.
      foot_height: (F,) m of the soles above the ground.
      foot_speed: (F,) m/s over ground.
      contact: (F,) bool.
      air_time: (F,) s that each foot was in the air before this step.
      landed: (F,) bool.
      touch: () share of the step with contact of a part other than a foot.
      action, last_action: (J,).
      fell: () bool.
      command: (3,).
    """

    linear: Float[Array, "3"]
    angular: Float[Array, "3"]
    up: Float[Array, "3"]
    height: Float[Array, ""]
    joints: Float[Array, " J"]
    joint_speed: Float[Array, " J"]
    joint_acceleration: Float[Array, " J"]
    torque: Float[Array, " J"]
    foot_height: Float[Array, " F"]
    foot_speed: Float[Array, " F"]
    contact: Bool[Array, " F"]
    air_time: Float[Array, " F"]
    landed: Bool[Array, " F"]
    touch: Float[Array, ""]
    action: Float[Array, " J"]
    last_action: Float[Array, " J"]
    fell: Bool[Array, ""]
    command: Float[Array, "3"]


def is_moving(command: Float[Array, "3"]) -> Float[Array, ""]:
    """() f32, 1 if a command (3,) is to move, 0 if it is to stand."""
    return (jnp.linalg.norm(command) > STANDING_COMMAND).astype(jnp.float32)


def terms(
    m: Motion, config: ConfigDict, stand: Float[Array, " J"], limits: Float[Array, "J 2"]
) -> dict[str, Float[Array, ""]]:
    """The unweighted terms by name; stand (J,) rad, limits (J, 2) rad, `config` is the env's reward_config."""
    moving = is_moving(m.command)
    deviation = m.joints - stand
    pose_weights = config.get("pose_weights", POSE_WEIGHTS)
    weights = jnp.tile(jnp.array(pose_weights), len(stand) // len(pose_weights))
    middle, half = limits.mean(1), 0.5 * (limits[:, 1] - limits[:, 0])
    beyond = jnp.maximum(jnp.abs(m.joints - middle) - SOFT_RANGE_SHARE * half, 0.0)
    fastest = jnp.tile(jnp.array(config.motor_speed), len(stand) // len(config.motor_speed))
    too_fast = jnp.maximum(jnp.abs(m.joint_speed) - SOFT_SPEED_SHARE * fastest, 0.0)
    error = m.command[:2] - m.linear[:2]
    low = jnp.maximum(config.foot_clearance - m.foot_height, 0.0)
    step = jnp.minimum(m.air_time, MAX_STEP_TIME) - MIN_STEP_TIME
    contact = m.contact.astype(jnp.float32)
    lifted = jnp.minimum(jnp.max(m.air_time * (1.0 - contact)), MAX_STEP_TIME)
    return {
        "track_linear": jnp.exp(-jnp.sum(error**2) / config.tracking_width),
        "track_angular": jnp.exp(-((m.command[2] - m.angular[2]) ** 2) / config.tracking_width),
        "vertical_speed": m.linear[2] ** 2,
        "roll_pitch_rate": jnp.sum(m.angular[:2] ** 2),
        "tilt": jnp.sum(m.up[:2] ** 2),
        "trunk_height": (m.height - config.trunk_height) ** 2,
        "torque": jnp.sum(m.torque**2),
        "acceleration": jnp.sum(m.joint_acceleration**2),
        "action_rate": jnp.sum((m.action - m.last_action) ** 2),
        "pose": jnp.exp(-jnp.sum(weights * deviation**2)),
        "stand_still": jnp.sum(jnp.abs(deviation)) * (1.0 - moving),
        "joint_limits": jnp.sum(beyond),
        "joint_speed": jnp.sum(too_fast),
        "foot_clearance": jnp.sum(low * m.foot_speed) * moving,
        "foot_slip": jnp.sum(contact * m.foot_speed**2),
        "air_time": jnp.sum(step * m.landed) * moving,
        # Of two feet: time of a step on the other one (isaaclab's biped term, without the time of the stance).
        "single_stance": lifted * (jnp.sum(contact) == 1.0) * moving,
        "touch": m.touch,
        "fall": m.fell.astype(jnp.float32),
    }
