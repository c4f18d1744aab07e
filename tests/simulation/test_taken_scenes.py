"""Scenes that are read alone from a folder are the same streets: simulation and images equal to the bit."""

import functools
import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.engine_runs import CONTROL_DT, NUM_ENVS, assert_equal, starts
from urbanverse_mjx.datatypes import BankShards, SceneBank
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.rendering.renderer import Renderer

#: In another order than in the whole bank, and not all.
TAKEN = (2, 0)


@pytest.fixture
def taken(small_bank: SceneBank, tmp_path: pathlib.Path) -> SceneBank:
    small_bank.save(tmp_path / "streets.bank")
    return SceneBank.take(BankShards(tmp_path / "streets.bank"), TAKEN)


@pytest.mark.extended
@pytest.mark.parametrize("impl", ["warp-fused", "jax"])
def test_robots_drive_alike(small_bank: SceneBank, taken: SceneBank, impl: str, request: pytest.FixtureRequest) -> None:
    jax_engine, jax_step = (request.getfixturevalue(n) if impl == "jax" else None for n in ("jax_engine", "jax_step"))
    robot = make_coco("differential")
    whole: Any = jax_engine or make_engine(small_bank, robot, impl, CONTROL_DT)
    alone = make_engine(taken, robot, impl, CONTROL_DT)
    state, ctrl = starts(whole, small_bank, number=24)
    # As many as `jax_step` is compiled for.
    rows = np.flatnonzero(np.isin(np.asarray(state.scene), TAKEN))[:NUM_ENVS]
    assert len({int(state.scene[row]) for row in rows}) == 2
    state, ctrl = jax.tree.map(lambda x: x[rows], (state, ctrl))
    place = np.array([TAKEN.index(int(scene)) for scene in state.scene], np.int32)
    step = [jax_step or jax.jit(jax.vmap(whole.step)), jax.jit(jax.vmap(alone.step))]
    first, second, hits = state, state._replace(scene=jnp.asarray(place)), 0
    for _ in range(20):
        first, second = step[0](first, ctrl), step[1](second, ctrl)
        hits += int(first.contacts.hit.sum())
    assert hits > 0, "some touch an object"
    assert_equal(first._replace(scene=0), second._replace(scene=0))


@pytest.mark.extended
@pytest.mark.parametrize(("shading", "light"), [("pbr", "baked"), ("matte", "direct")])
def test_images_are_alike(small_bank: SceneBank, taken: SceneBank, shading: str, light: str) -> None:
    outputs = ("rgb", "depth", "category", "object")
    whole, alone = (Renderer(bank, None, 36, 64, outputs, shading=shading, light=light) for bank in (small_bank, taken))
    for row, scene in enumerate(TAKEN):
        start = small_bank.episode_start[scene, 0]
        camera = start[:3] + np.array([0.0, 0.0, 1.2], np.float32)
        turn = np.array([0.5, 0.5, -0.5, -0.5], np.float32)  # level, along +x
        look = functools.partial(dict, position=camera, quaternion=turn, fovy=1.2)
        first, second = whole.view(scene, **look()), alone.view(row, **look())
        for name in outputs:
            assert len(np.unique(np.asarray(first[name]))) > 3, name
        assert_equal(first, second)
