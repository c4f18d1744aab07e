"""`env.render`: Playground's call, the street of each state with the robot in it."""

import copy
import dataclasses
import pathlib
import sys
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from mujoco_playground import MjxEnv, locomotion

from tests.support.agent_appearances import with_box_agents
from tests.support.playground_page import run_block
from urbanverse_mjx.datatypes import AgentMotion, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, State, registry
from urbanverse_mjx.envs.playground import register_with_playground
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering.renderer import Renderer

HEIGHT, WIDTH = 90, 160


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    overrides = {"preset": "cpu", "impl": "jax", "scenes": "all"}
    return registry.load("CocoNav", config_overrides=overrides, bank=small_bank)


@pytest.fixture(scope="module")
def states(env: NavEnv) -> list[State[Any]]:
    """One in each of the three streets."""
    begin = jax.jit(lambda key, scene: env.begin_at(key, scene, jnp.int32(0)))
    zero = jnp.float32(0.0)
    return [State(begin(jax.random.key(0), jnp.int32(i)), {}, zero, zero, {}, {}) for i in range(3)]


def ahead(state: State[Any], metres: float) -> State[Any]:
    """The state with the robot pushed along its heading."""
    w, _, _, z = np.asarray(state.data.xquat[1])
    yaw = 2.0 * np.arctan2(z, w)
    step = metres * jnp.array([np.cos(yaw), np.sin(yaw), 0.0])
    return state.tree_replace({"data.xpos": state.data.xpos + step})


def differ(a: np.ndarray, b: np.ndarray) -> float:
    """Mean difference of two images, of 255."""
    return float(np.abs(a.astype(np.float32) - b).mean())


def shell(image: np.ndarray) -> np.ndarray:
    """(H, W) bool: pixels as pink as COCO's shell."""
    red, green, blue = np.moveaxis(image.astype(np.int32), -1, 0)
    return (red > 120) & (red - green > 40) & (blue > green) & (red > blue)


@pytest.mark.extended
def test_a_trajectory_becomes_images_of_its_street_around_the_robot(env: NavEnv, states: list[State[Any]]) -> None:
    drive = [ahead(states[0], d) for d in (0.0, 1.0, 2.0)]
    frames = env.render(drive, HEIGHT, WIDTH)
    assert isinstance(frames, list)
    assert [(f.shape, f.dtype) for f in frames] == [((HEIGHT, WIDTH, 3), np.uint8)] * 3
    assert differ(frames[0], frames[1]) > 2.0
    assert differ(frames[1], frames[2]) > 2.0
    others = env.render(states, HEIGHT, WIDTH)
    np.testing.assert_array_equal(others[0], frames[0])
    assert min(differ(others[0], others[1]), differ(others[0], others[2]), differ(others[1], others[2])) > 4.0
    # The camera follows: the robot stays in the middle of the lower half while the street passes.
    for frame in [*frames, *others]:
        assert shell(frame)[HEIGHT // 2 : HEIGHT * 3 // 4, WIDTH * 2 // 5 : WIDTH * 3 // 5].sum() > 60
    alone = env.render(drive[1], HEIGHT, WIDTH)
    assert isinstance(alone, np.ndarray)
    np.testing.assert_array_equal(alone, frames[1])
    assert env.render([], HEIGHT, WIDTH) == []


@pytest.mark.extended
def test_the_robots_camera_shows_what_the_policy_sees(env: NavEnv, states: list[State[Any]]) -> None:
    observe = jax.jit(env.observe)
    view = env.config.vision_config
    seen = [np.asarray(observe(s.data)["pixels/front"]) for s in states]
    shown = env.render(states, view.height, view.width, camera="front_cam")
    away = np.array([[differ(a, b) for b in seen] for a in shown])
    # Rendered images have shadows and four rays a pixel.
    assert away.diagonal().max() < 20.0
    assert (away + 1e3 * np.eye(3)).min() > 1.3 * away.diagonal().max()


@pytest.mark.extended
def test_moving_agents_are_drawn(env: NavEnv, states: list[State[Any]], monkeypatch: pytest.MonkeyPatch) -> None:
    """A person two metres ahead, as a crowd would put them there."""
    without = env.render(states[0], HEIGHT, WIDTH)
    place = ahead(states[0], 2.0).data.xpos[1].at[2].set(0.15)
    person = AgentMotion(place[None], jnp.zeros(1), jnp.zeros((1, 3)), jnp.zeros(1), jnp.ones(1, bool))
    monkeypatch.setattr(NavEnv, "agent_appearances", (0,))
    monkeypatch.setattr(NavEnv, "agents_of", lambda *_: person)
    env = copy.copy(env)
    env._state_renderers, env.bank = {}, with_box_agents(env.bank)
    assert differ(np.asarray(env.render(states[0], HEIGHT, WIDTH)), np.asarray(without)) > 0.5


def test_errors_are_sentences(env: NavEnv, states: list[State[Any]]) -> None:
    batch = jax.tree.map(lambda x: jnp.stack([x, x]), states[0])
    with pytest.raises(ValidationError, match="a state of 2 envs"):
        env.render([batch], HEIGHT, WIDTH)
    with pytest.raises(ValidationError, match="front_cam"):
        env.render(states, HEIGHT, WIDTH, camera="track")
    with pytest.raises(ValidationError, match="modify_scene_fns"):
        env.render(states, HEIGHT, WIDTH, modify_scene_fns=[lambda _: None])
    with pytest.raises(ValidationError, match="whole states"):
        env.render([dataclasses.replace(states[0], data=None)], HEIGHT, WIDTH)


def test_environments_are_playgrounds(env: NavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(env, MjxEnv)
    assert issubclass(NavEnv, MjxEnv)
    monkeypatch.setattr(locomotion.mjx_env, "ensure_menagerie_exists", lambda: None)
    monkeypatch.setattr(locomotion, "_envs", dict(locomotion._envs))
    monkeypatch.setattr(locomotion, "_cfgs", dict(locomotion._cfgs))

    def make(config: Any, config_overrides: Any) -> Any:
        return registry.load("CocoNav", config, config_overrides, bank=env.bank)

    locomotion.register_environment("UrbanCoco", make, lambda: registry.get_default_config("CocoNav", "cpu"))
    loaded = locomotion.load("UrbanCoco", config_overrides={"vision": False, "impl": "jax"})
    assert isinstance(loaded, NavEnv)
    assert (loaded.config.preset, loaded.config.vision) == ("cpu", False)


def test_playground_need_not_be_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_playground", None)

    class Alone: ...

    register_with_playground(Alone)
    assert not issubclass(Alone, MjxEnv)


def test_stock_mujoco_takes_a_state_as_playgrounds_own_drawing_does(env: NavEnv, states: list[State[Any]]) -> None:
    """The fields that `mjx_env.render_array` copies from a state give the bodies' poses."""
    data = mujoco.MjData(env.mj_model)
    carried = states[1].data
    data.qpos, data.qvel = carried.qpos, carried.qvel
    data.mocap_pos, data.mocap_quat, data.xfrc_applied = carried.mocap_pos, carried.mocap_quat, carried.xfrc_applied
    mujoco.mj_forward(env.mj_model, data)
    np.testing.assert_allclose(data.xpos, carried.xpos, atol=1e-4)


@pytest.mark.extended
def test_the_page_about_playground_runs(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    small_bank.save(tmp_path / "bank.npz")
    monkeypatch.setenv("URBANVERSE_BANK", str(tmp_path / "bank.npz"))
    found = run_block("env.render(")
    assert capsys.readouterr().out.startswith("3 (120, 160, 3) [")
    moved = found["trajectory"][2].data.qpos[:2] - found["trajectory"][0].data.qpos[:2]
    assert float(jnp.linalg.norm(moved)) > 0.02
    assert differ(found["frames"][0], found["frames"][2]) > 0.5


@pytest.mark.extended
def test_depth_is_a_fourth_channel_in_tenths_of_a_metre_and_the_sky_is_farthest(small_bank: SceneBank) -> None:
    overrides = {
        "preset": "cpu",
        "impl": "jax",
        "scenes": "all",
        "vision_config.depth": True,
        "vision_config.height": 54,
    }
    env = registry.load("CocoNav", config_overrides={**overrides, "vision_config.width": 96}, bank=small_bank)
    nav = jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))
    image = np.asarray(jax.jit(env.observe)(nav)["pixels/front"])
    assert image.shape == (54, 96, 4)
    assert env.renderer is not None
    robot = make_coco()
    plain = Renderer(small_bank, robot, 54, 96, outputs=("depth",))
    metres = np.asarray(plain(nav.sim.scene, nav.sim.xpos, nav.sim.xquat)["depth"])
    sky = metres == 0.0
    assert 0.05 < sky.mean() < 0.9
    assert (image[..., 3][sky] == 255).all()
    np.testing.assert_allclose(image[..., 3][~sky], np.minimum(np.floor(10.0 * metres[~sky]), 255.0), atol=1.0)
    assert image[..., 3][~sky].min() < 30, "the ground before the robot"
