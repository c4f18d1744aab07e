"""Starts and short runs that the tests of both engines share."""

from typing import Any

import jax
import numpy as np

from urbanverse_mjx.datatypes import SceneBank, SimState
from urbanverse_mjx.simulation.parity import c_mujoco

NUM_ENVS = 6
CONTROL_DT = 0.1


def starts(engine: Any, bank: SceneBank, seed: int = 0, number: int = NUM_ENVS) -> tuple[SimState, np.ndarray]:
    """Some robots near objects and a command for each."""
    drives = c_mujoco.aimed_drives(bank, engine.robot, number, 1, CONTROL_DT, seed)
    velocity = np.zeros((number, engine.physics.model.nv), np.float32)
    return jax.jit(jax.vmap(engine.init))(drives.scene, drives.qpos, velocity), drives.ctrl[0]


def roll(step: Any, state: SimState, ctrl: Any, steps: int) -> SimState:
    """The state after `steps` control steps with one command."""
    for _ in range(steps):
        state = step(state, ctrl)
    return state


def assert_equal(a: Any, b: Any) -> None:
    """Equal to the bit in every leaf."""
    jax.tree.map(lambda x, y: np.testing.assert_array_equal(np.array(x), np.array(y)), a, b)
