"""Inputs and outputs of Warp's kernels for an env's movable bodies: `Awake` as one array."""

import itertools
from typing import Any

import jax
import jax.numpy as jnp

from ...datatypes import Bodies
from ..collision_slots.body_slots import Awake

#: Numbers of a body's state: place, quaternion, velocity, spin, warm start.
STATE = 19
#: In place of the object of a slot without one: no owner of any slot (-1 is the ground, agents are from -2 down).
_NONE = -(1 << 30)


def inputs(bodies: Bodies, awake: Awake) -> tuple[jax.Array, ...]:
    """Objects that are bodies (M,); rows and objects (W,) and states (W, `STATE`) of those awake."""
    state = jnp.concatenate([awake.place, awake.quaternion, awake.velocity, awake.spin, awake.warm], axis=-1)
    return jnp.where(bodies.object_index >= 0, bodies.object_index, _NONE), awake.row, awake.object_index, state


def nobody() -> tuple[jax.Array, ...]:
    """`AgentMotion` of no agent."""
    none, flat = jnp.zeros((0, 3)), jnp.zeros(0)
    return none, flat, none, flat, jnp.zeros(0, jnp.int32)


def read(awake: Awake, state: Any) -> Awake:
    """The bodies with the states (W, `STATE`) that came back."""
    ends = (0, 3, 7, 10, 13, STATE)
    parts = (state[:, a:b] for a, b in itertools.pairwise(ends))
    return Awake(awake.row, awake.object_index, *parts)
