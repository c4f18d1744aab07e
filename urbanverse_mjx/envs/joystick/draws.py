"""Draws random values of the locomotion task: commands, robot parameters, pushes, sensor noise."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Key
from ml_collections import ConfigDict


class Body(NamedTuple):
    """Randomised parameters of a robot in an episode.

    Attributes:
      friction_scale, mass_scale: (), see `SimState`.
      strength: () factor on the servos' stiffness.
      joint_bias: (12,) rad, error of each encoder.
      delay: () f32, 1 if commands reach the servos one control step late, else 0.
    """

    friction_scale: Float[Array, ""]
    mass_scale: Float[Array, ""]
    strength: Float[Array, ""]
    joint_bias: Float[Array, " J"]
    delay: Float[Array, ""]


def draw_body(key: Key[Array, ""], config: ConfigDict, num_joints: int) -> Body:
    """Draws the parameters of a robot by `config.randomization`."""
    keys = jax.random.split(key, 5)

    def within(i: int, name: str) -> jax.Array:
        low, high = config[name]
        return jax.random.uniform(keys[i], (), jnp.float32, low, high)

    return Body(
        friction_scale=within(0, "friction_scale"),
        mass_scale=within(1, "mass_scale"),
        strength=within(2, "strength"),
        joint_bias=config.joint_bias * jax.random.uniform(keys[3], (num_joints,), jnp.float32, -1.0, 1.0),
        delay=(jax.random.uniform(keys[4]) < config.delay_share).astype(jnp.float32),
    )


def draw_command(key: Key[Array, ""], config: ConfigDict) -> tuple[Float[Array, "3"], Float[Array, ""]]:
    """Draws a command by `config.command`: (3,) forward and left speed (m/s) and yaw rate (rad/s), and its duration ()
    s.

    A share of the commands is to stand, another to walk forward in a slight curve; the others are uniform.
    """
    kind, any_, ahead, hold = jax.random.split(key, 4)
    spans = jnp.array([config.linear_x, config.linear_y, config.angular])
    free = jax.random.uniform(any_, (3,), jnp.float32, spans[:, 0], spans[:, 1])
    forward = jnp.array([config.forward_speed, (0.0, 0.0), config.forward_angular])
    straight = jax.random.uniform(ahead, (3,), jnp.float32, forward[:, 0], forward[:, 1])
    u = jax.random.uniform(kind)
    moving = jnp.where(u < config.stand_share + config.forward_share, straight, free)
    command = jnp.where(u < config.stand_share, 0.0, moving)
    return command, jax.random.uniform(hold, (), jnp.float32, *config.hold)


def draw_push(key: Key[Array, ""], config: ConfigDict, dt: float) -> Float[Array, "6"]:
    """Draws a push by `config.randomization`: (6,) change of the trunk's velocity (m/s, rad/s), 0 in most steps."""
    when, how, turn = jax.random.split(key, 3)
    heading, speed = jax.random.uniform(how, (2,)) * jnp.array([2.0 * jnp.pi, config.push_speed])
    spin = jax.random.uniform(turn, (), jnp.float32, -1.0, 1.0) * config.push_turn
    zero = jnp.float32(0.0)
    kick = jnp.stack([speed * jnp.cos(heading), speed * jnp.sin(heading), zero, zero, zero, spin])
    return jnp.where(jax.random.uniform(when) < dt / config.push_every, kick, 0.0)


def draw_noise(key: Key[Array, ""], config: ConfigDict, num_joints: int) -> Float[Array, " n"]:
    """Draws uniform sensor noise by `config.noise`: (6 + 2 joints,) for angular velocity, gravity, joint angles and
    speeds."""
    width = jnp.concatenate(
        [
            jnp.full(3, config.angular_velocity),
            jnp.full(3, config.gravity),
            jnp.full(num_joints, config.joint_position),
            jnp.full(num_joints, config.joint_velocity),
        ]
    )
    return config.scale * width * jax.random.uniform(key, width.shape, jnp.float32, -1.0, 1.0)
