"""The call from JAX into the renderer: pure, the same under every transformation, and no context before it runs."""

import concurrent.futures
import gc
import weakref
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.robots.coco import make_coco
from urbanverse_mjx.simulation.rendering.renderer import Renderer

from . import render_cases as cases

NUMBER = 12
#: scene (n,), xpos (n, nbody, 3), xquat (n, nbody, 4)
Inputs = tuple[np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(4, seed=1)


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco()


@pytest.fixture(scope="module")
def inputs(bank: SceneBank, robot: RobotSpec) -> Inputs:
    rng = np.random.default_rng(0)
    scene = rng.permutation(np.arange(NUMBER) % bank.num_scenes)
    poses = [cases.bodies(robot, bank.episode_start[z, i].astype(float)) for i, z in enumerate(scene)]
    return scene, np.array([p for p, _ in poses]), np.array([q for _, q in poses])


@pytest.fixture(scope="module")
def renderer(bank: SceneBank, robot: RobotSpec) -> Renderer:
    return cases.make_renderer(bank, robot)


@pytest.fixture(scope="module")
def alone(renderer: Renderer, inputs: Inputs) -> np.ndarray:
    """Every frame drawn by itself."""
    return np.stack([renderer(*(x[i] for x in inputs))["rgb"] for i in range(NUMBER)])


@pytest.mark.extended
def test_frames_differ(alone: np.ndarray) -> None:
    assert len(np.unique(alone.reshape(NUMBER, -1), axis=0)) == NUMBER


def _scan_of_vmap(call: Callable[..., Any], scene: Any, xpos: Any, xquat: Any) -> Any:
    split = [x.reshape(3, 4, *x.shape[1:]) for x in (scene, xpos, xquat)]
    frames = jax.lax.scan(lambda c, x: (c, jax.vmap(call)(*x)), 0, tuple(map(jnp.asarray, split)))[1]
    return frames.reshape(NUMBER, *frames.shape[2:])


def _nested(call: Callable[..., Any], *arrays: Any) -> Any:
    frames = jax.vmap(jax.vmap(call))(*(x.reshape(2, 6, *x.shape[1:]) for x in arrays))
    return frames.reshape(NUMBER, *frames.shape[2:])


CALLS: dict[str, Callable[..., Any]] = {
    "vmap": lambda call, *x: jax.vmap(call)(*x),
    "jit(vmap)": lambda call, *x: jax.jit(jax.vmap(call))(*x),
    "vmap(vmap)": _nested,
    "scan(vmap)": _scan_of_vmap,
    "vmap(jit)": lambda call, *x: jax.vmap(jax.jit(call))(*x),
    "lax.map": lambda call, *x: jax.lax.map(lambda y: call(*y), tuple(map(jnp.asarray, x))),
    "vmap over axis 1": lambda call, s, p, q: jax.vmap(call, in_axes=(0, 1, 0))(s, np.moveaxis(p, 0, 1), q),
}


@pytest.mark.parametrize("call", CALLS)
def test_every_transformation_gives_the_same_bytes(
    renderer: Renderer, inputs: Inputs, alone: np.ndarray, call: str
) -> None:
    frames = CALLS[call](lambda *x: renderer(*x)["rgb"], *inputs)
    np.testing.assert_array_equal(np.asarray(frames), alone)


def test_one_scene_for_all(renderer: Renderer, inputs: Inputs, alone: np.ndarray) -> None:
    """An argument that is not batched is the same for all worlds."""
    scene, xpos, xquat = inputs
    frames = jax.vmap(renderer, in_axes=(None, 0, 0))(scene[0], xpos, xquat)["rgb"]
    np.testing.assert_array_equal(np.asarray(frames[0]), alone[0])
    assert not np.array_equal(np.asarray(frames[1]), alone[1])


def test_a_world_does_not_see_the_others(renderer: Renderer, inputs: Inputs, alone: np.ndarray) -> None:
    """Permuted, next to other scenes, and beside a robot whose state is not a number."""
    call = jax.jit(jax.vmap(renderer))
    order = np.random.default_rng(1).permutation(NUMBER)
    np.testing.assert_array_equal(np.asarray(call(*(x[order] for x in inputs))["rgb"]), alone[order])
    scene, xpos, xquat = (x.copy() for x in inputs)
    scene[1::2] = 0
    xpos[1::2], xquat[1::2] = np.nan, np.nan
    np.testing.assert_array_equal(np.asarray(call(scene, xpos, xquat)["rgb"])[::2], alone[::2])
    np.testing.assert_array_equal(np.asarray(call(*inputs)["rgb"]), alone)


def test_scenes_change_without_a_trace_and_as_if_they_had_always_stood_there(
    bank: SceneBank, robot: RobotSpec, inputs: Inputs, alone: np.ndarray
) -> None:
    renderer = cases.make_renderer(bank, robot)
    traces = []

    @jax.jit
    def call(*arrays: Any) -> Any:
        traces.append(1)
        return jax.vmap(renderer)(*arrays)["rgb"]

    scene, xpos, xquat = inputs
    for shift in (1, 2, 3):
        call((scene + shift) % bank.num_scenes, xpos[::-1], xquat[::-1])
    np.testing.assert_array_equal(np.asarray(call(*inputs)), alone)
    some = np.where(np.arange(NUMBER) % 3 == 0, (scene + 1) % bank.num_scenes, scene)
    call(some, xpos, xquat)
    np.testing.assert_array_equal(np.asarray(call(*inputs)), alone)
    assert len(traces) == 1


def test_it_draws_without_threads_while_the_process_ends(
    bank: SceneBank, robot: RobotSpec, inputs: Inputs, alone: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = []

    def submit(*job: object) -> None:
        refused.append(job)
        raise RuntimeError("cannot schedule new futures after shutdown")

    monkeypatch.setattr(concurrent.futures.ThreadPoolExecutor, "submit", submit)
    frames = jax.vmap(cases.make_renderer(bank, robot, threads=3))(*inputs)["rgb"]
    np.testing.assert_array_equal(frames, alone)
    assert refused


@pytest.mark.extended
def test_threads_change_nothing(bank: SceneBank, robot: RobotSpec, inputs: Inputs, alone: np.ndarray) -> None:
    for threads in (1, 5):
        frames = jax.vmap(cases.make_renderer(bank, robot, threads=threads))(*inputs)["rgb"]
        np.testing.assert_array_equal(np.asarray(frames), alone)


def test_out_of_range_scenes_stay_inside_the_bank(renderer: Renderer, inputs: Inputs, bank: SceneBank) -> None:
    """As JAX's own gathers do, a row beyond the bank is taken as its nearest row."""
    _, xpos, xquat = (x[0] for x in inputs)
    for wrong, right in ((99, bank.num_scenes - 1), (-3, 0)):
        np.testing.assert_array_equal(
            np.asarray(renderer(wrong, xpos, xquat)["rgb"]), np.asarray(renderer(right, xpos, xquat)["rgb"])
        )


def test_shapes_alone_build_no_context(bank: SceneBank, robot: RobotSpec, inputs: Inputs) -> None:
    renderer = cases.make_renderer(bank, robot, outputs=("rgb", "depth"))
    shapes = jax.eval_shape(jax.vmap(renderer), *inputs)
    assert shapes["rgb"].shape == (NUMBER, cases.HEIGHT, cases.WIDTH, 3)
    assert shapes["rgb"].dtype == jnp.uint8
    assert shapes["depth"].shape == (NUMBER, cases.HEIGHT, cases.WIDTH)
    assert renderer.num_contexts == 0
    jax.block_until_ready(jax.jit(jax.vmap(jax.vmap(renderer)))(*(x.reshape(2, 6, *x.shape[1:]) for x in inputs)))
    assert renderer.num_contexts == 1


def test_frames_nobody_looks_at_are_not_drawn(bank: SceneBank, robot: RobotSpec, inputs: Inputs) -> None:
    renderer = cases.make_renderer(bank, robot)
    total = jax.jit(lambda *x: (jax.vmap(renderer)(*x), x[1].sum())[1])(*inputs)
    assert np.isfinite(total)
    assert renderer.num_contexts == 0


@pytest.mark.extended
def test_a_deleted_renderer_is_freed_and_its_compiled_calls_say_so(
    bank: SceneBank, robot: RobotSpec, inputs: Inputs
) -> None:
    renderer = cases.make_renderer(bank, robot)
    draw: Any = jax.jit(jax.vmap(renderer))
    compiled = draw.lower(*inputs).compile()
    compiled(*(jnp.asarray(x) for x in inputs))
    gone = weakref.ref(renderer)
    draw.clear_cache()
    del renderer, draw
    gc.collect()
    assert gone() is None
    with pytest.raises(Exception, match="engine that was deleted"):
        jax.block_until_ready(compiled(*(jnp.asarray(x) for x in inputs)))
