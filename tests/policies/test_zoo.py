"""Adapters of published models, on graphs with the signatures of their exports that compute what a hand can check."""

import pathlib
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.evaluation.goal_images import at_goal, goal_images
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.policies.zoo import CONTRACTS, ZooAgent, zoo_agent
from urbanverse_mjx.policies.zoo.adapters import cosine_alphas, ddpm_previous
from urbanverse_mjx.policies.zoo.contracts import IMAGENET
from urbanverse_mjx.robots.waypoint import pd_velocity

SPEED, TURN = 2.0, 1.0
F, WHOLE = TensorProto.FLOAT, TensorProto.INT64
Node = tuple[str, list[str], list[str], dict[str, Any]]


def graph(
    path: pathlib.Path,
    inputs: Mapping[str, tuple[Any, list[Any]]],
    outputs: dict[str, list[Any]],
    nodes: list[Node],
    constants: Mapping[str, Any],
) -> pathlib.Path:
    model = helper.make_model(
        helper.make_graph(
            [helper.make_node(kind, given, out, **attributes) for kind, given, out, attributes in nodes],
            "model",
            [helper.make_tensor_value_info(k, t, shape) for k, (t, shape) in inputs.items()],
            [helper.make_tensor_value_info(k, F, shape) for k, shape in outputs.items()],
            [numpy_helper.from_array(np.asarray(x), k) for k, x in constants.items()],
        ),
        opset_imports=[helper.make_opsetid("", 18)],
        ir_version=9,
    )
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())
    return path


def mean(given: str, axes: str, out: str) -> Node:
    return ("ReduceMean", [given, axes], [out], {"keepdims": 0})


def goal_image_graph(path: pathlib.Path, batch: Any = "n") -> pathlib.Path:
    """GNM and ViNT: each waypoint is (mean of the newest minus the oldest image, mean of the goal image, 1, 0)."""
    nodes: list[Node] = [
        ("Slice", ["obs_img", "c15", "c18", "one"], ["newest"], {}),
        ("Slice", ["obs_img", "c0", "c3", "one"], ["oldest"], {}),
        mean("newest", "pixels", "a"),
        mean("oldest", "pixels", "b"),
        mean("goal_img", "pixels", "y"),
        ("Sub", ["a", "b"], ["x"], {}),
        ("Unsqueeze", ["x", "last"], ["x1"], {}),
        ("Unsqueeze", ["y", "last"], ["y1"], {}),
        ("Mul", ["x1", "zero"], ["none"], {}),
        ("Add", ["none", "unit"], ["full"], {}),
        ("Concat", ["x1", "y1", "full", "none"], ["point"], {"axis": 1}),
        ("Unsqueeze", ["point", "one"], ["point1"], {}),
        ("Tile", ["point1", "five"], ["action_pred"], {}),
        ("Identity", ["x1"], ["dist_pred"], {}),
    ]
    integers = {"c0": [0], "c3": [3], "c15": [15], "c18": [18], "one": [1], "last": [1], "pixels": [1, 2, 3]}
    constants: dict[str, Any] = {k: np.array(x, np.int64) for k, x in integers.items()}
    constants |= {
        "five": np.array([1, 5, 1]),
        "zero": np.zeros((1, 1), np.float32),
        "unit": np.ones((1, 1), np.float32),
    }
    inputs = {"obs_img": (F, [batch, 18, 64, 85]), "goal_img": (F, [batch, 3, 64, 85])}
    return graph(path, inputs, {"dist_pred": [batch, 1], "action_pred": [batch, 5, 4]}, nodes, constants)


def observation(size: tuple[int, int], grey: list[int], goal: Any, proprio: Any = None) -> dict[str, np.ndarray]:
    """Grey images, goals and proprioception of robots."""
    image = np.broadcast_to(np.array(grey, np.uint8)[:, None, None, None], (len(grey), *size, 3))
    rest = np.zeros((len(grey), 5)) if proprio is None else np.asarray(proprio)
    return {"pixels/front": image, "goal": np.asarray(goal, np.float32), "proprio": rest.astype(np.float32)}


def driven(agent: ZooAgent, obs: dict[str, np.ndarray]) -> np.ndarray:
    """(n, 2) velocities that the environment's controller makes of the actions."""
    actions = agent(obs)
    assert actions.shape == (len(obs["goal"]), 2)
    assert np.abs(actions).max() <= 1.0
    velocities = [pd_velocity(jnp.asarray(a), agent.period, SPEED, TURN) for a in actions]
    return np.array([[float(v), float(w)] for v, w in velocities])


def make(name: str, weights: pathlib.Path) -> ZooAgent:
    return zoo_agent(name, weights, SPEED, TURN, 1.0 / CONTRACTS[name].rate_hz)


def normalised(grey: float) -> float:
    return float(np.mean((grey / 255.0 - np.array(IMAGENET[0])) / np.array(IMAGENET[1])))


@pytest.mark.parametrize("name", ["gnm", "vint"])
@pytest.mark.parametrize("batch", ["n", 1])
def test_image_goals_and_six_images_in_order(name: str, batch: Any, tmp_path: pathlib.Path) -> None:
    agent = make(name, goal_image_graph(tmp_path / "model.onnx", batch))
    size = CONTRACTS[name].size
    agent.see_goal(observation(size, [124, 110], np.zeros((2, 2)))["pixels/front"])
    agent.begin(2)
    first = driven(agent, observation(size, [100, 100], np.zeros((2, 2))))
    np.testing.assert_allclose(first[:, 0], 0.0, atol=0.03)  # the first image stands for those before it
    for grey in (102, 104, 106, 108):
        agent(observation(size, [grey, 100], np.zeros((2, 2))))
    found = driven(agent, observation(size, [110, 150], np.zeros((2, 2))))
    for row, (newest, goal) in enumerate([(110, 124), (150, 110)]):
        x, y = normalised(newest) - normalised(100), normalised(goal)
        expected = [min(x, 1.0) * SPEED, np.clip(np.arctan2(y, x) * 5.0, -TURN, TURN)]
        np.testing.assert_allclose(found[row], expected, atol=2e-3)
    # The seventh image pushes the first one out.
    x = normalised(110) - normalised(102)
    assert driven(agent, observation(size, [110, 150], np.zeros((2, 2))))[0, 0] == pytest.approx(x * SPEED, abs=2e-3)
    # The next episodes know nothing of these.
    agent.begin(2)
    np.testing.assert_allclose(driven(agent, observation(size, [100, 100], np.zeros((2, 2)))), first, atol=1e-6)


def citywalker_graph(path: pathlib.Path) -> pathlib.Path:
    """Its waypoints are: the goal's row over 10, then the oldest position's row, then zeros."""
    nodes: list[Node] = [
        ("Slice", ["cord", "c5", "c6", "one"], ["goal"], {}),
        ("Mul", ["goal", "tenth"], ["near"], {}),
        ("Slice", ["cord", "c0", "one", "one"], ["oldest"], {}),
        ("Slice", ["cord", "c0", "c3", "one"], ["three"], {}),
        ("Mul", ["three", "nothing"], ["rest"], {}),
        ("Concat", ["near", "oldest", "rest"], ["wp_pred"], {"axis": 1}),
        mean("obs", "pixels", "light"),
        ("Unsqueeze", ["light", "one"], ["arrive_pred"], {}),
    ]
    integers = {"c0": [0], "c3": [3], "c5": [5], "c6": [6], "one": [1], "pixels": [1, 2, 3, 4]}
    constants: dict[str, Any] = {k: np.array(x, np.int64) for k, x in integers.items()}
    constants |= {"tenth": np.float32(0.1), "nothing": np.float32(0.0)}
    inputs = {"obs": (F, ["n", 5, 3, 350, 630]), "cord": (F, ["n", 6, 2])}
    return graph(path, inputs, {"wp_pred": ["n", 5, 2], "arrive_pred": ["n", 1]}, nodes, constants)


def test_citywalker_is_told_goal_and_past_in_steps_to_the_right_and_ahead(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    agent = make("citywalker", citywalker_graph(tmp_path / "citywalker.onnx"))
    agent.begin(1)
    outputs: list[np.ndarray] = []
    read = agent._output
    monkeypatch.setattr(agent, "_output", lambda x, n: outputs.append(read(x, n)) or outputs[-1])
    size, step = CONTRACTS["citywalker"].size, 0.5 * SPEED
    ahead = driven(agent, observation(size, [9], [[8.0, 0.0]]))
    np.testing.assert_allclose(ahead, [[0.8, 0.0]], atol=1e-3)  # a tenth of 8 m in 1 s
    np.testing.assert_allclose(outputs[-1][0, 1], 0.0, atol=1e-6)  # no past yet
    agent.begin(1)
    # A quarter circle to the left with 1 m/s in 20 steps of 0.2 s: 4 s, radius 8 / pi.
    rate = np.pi / 2 / 4.0
    for _ in range(20):
        agent(observation(size, [9], [[8.0, 0.0]], [[1.0, 0.0, rate, 0.0, 0.0]]))
    left = driven(agent, observation(size, [9], [[0.0, 5.0]]))
    radius = 1.0 / rate
    # The beginning lies that far behind and to the left of where the robot is now: (right, ahead).
    np.testing.assert_allclose(outputs[-1][0, 1] * step, [-radius, -radius], atol=0.01)
    np.testing.assert_allclose(outputs[-1][0, 0] * step, [-0.5, 0.0], atol=1e-6)
    assert left[0, 1] == pytest.approx(TURN, abs=1e-3)
    assert left[0, 0] < 0.05


def s2e_graph(path: pathlib.Path) -> pathlib.Path:
    """Its waypoints all are (200 · distance · cos, 200 · distance · sin, mean of the oldest image)."""
    nodes: list[Node] = [
        ("Slice", ["goal", "c0", "c1", "one"], ["distance"], {}),
        ("Slice", ["goal", "c1", "c3", "one"], ["direction"], {}),
        ("Mul", ["distance", "many"], ["metres"], {}),
        ("Mul", ["direction", "metres"], ["xy"], {}),
        ("Slice", ["obs_images", "c0", "c1", "one"], ["oldest"], {}),
        mean("oldest", "pixels", "light"),
        ("Unsqueeze", ["light", "one"], ["z"], {}),
        ("Concat", ["xy", "z"], ["point"], {"axis": 1}),
        ("Unsqueeze", ["point", "one"], ["point1"], {}),
        ("Tile", ["point1", "ten"], ["wp_pred"], {}),
        ("Identity", ["z"], ["wp_pred_score"], {}),
    ]
    integers = {"c0": [0], "c1": [1], "c3": [3], "one": [1], "pixels": [1, 2, 3, 4], "ten": [1, 10, 1]}
    constants: dict[str, Any] = {k: np.array(x, np.int64) for k, x in integers.items()} | {"many": np.float32(200.0)}
    inputs = {"obs_images": (F, ["n", 11, 3, 256, 256]), "goal": (F, ["n", 3])}
    return graph(path, inputs, {"wp_pred": ["n", 10, 3], "wp_pred_score": ["n", 1]}, nodes, constants)


def test_s2e_drives_the_arc_to_a_quarter_of_its_output(tmp_path: pathlib.Path) -> None:
    agent = make("s2e", s2e_graph(tmp_path / "s2e.onnx"))
    agent.begin(3)
    goals = [[4.0, 0.0], [3.0, 0.6], [900.0, 0.0]]
    found = driven(agent, observation(CONTRACTS["s2e"].size, [0, 90, 255], goals))
    np.testing.assert_allclose(found[0], [1.0, 0.0], atol=1e-3)
    bearing, chord = np.arctan2(0.6, 3.0), np.hypot(3.0, 0.6) / 4
    # Turning by twice the bearing in 1 s along an arc whose chord leads to the waypoint.
    radius = chord / 2 / np.sin(bearing)
    np.testing.assert_allclose(found[1], [radius * 2 * bearing, 2 * bearing], atol=2e-3)
    np.testing.assert_allclose(found[2], [SPEED, 0.0], atol=1e-3)  # 200 m are the most it is told


def mimic_graph(path: pathlib.Path) -> pathlib.Path:
    """One robot; waypoint k is (k · mean of the newest image, 0, mean of the oldest one)."""
    nodes: list[Node] = [
        ("Slice", ["obs", "c15", "c16", "one"], ["newest"], {}),
        ("ReduceMean", ["newest", "pixels"], ["light"], {"keepdims": 1}),
        ("Reshape", ["light", "shape"], ["light1"], {}),
        ("Mul", ["light1", "ramp"], ["output"], {}),
    ]
    integers = {"c15": [15], "c16": [16], "one": [1], "pixels": [1, 2, 3, 4], "shape": [1, 1, 1]}
    constants: dict[str, Any] = {k: np.array(x, np.int64) for k, x in integers.items()}
    constants["ramp"] = np.stack([np.arange(15), np.zeros(15), np.zeros(15)], -1)[None].astype(np.float32)
    return graph(path, {"obs": (F, [1, 16, 3, 288, 512])}, {"output": [1, 15, 3]}, nodes, constants)


def test_mimic_takes_one_robot_at_a_time_and_no_goal(tmp_path: pathlib.Path) -> None:
    agent = make("mimic", mimic_graph(tmp_path / "mimic.onnx"))
    agent.begin(2)
    size = CONTRACTS["mimic"].size
    found = driven(agent, observation(size, [51, 102], [[9.0, 0.0], [9.0, 0.0]]))
    np.testing.assert_allclose(found, [[3 * 0.2 / 1.2, 0.0], [3 * 0.4 / 1.2, 0.0]], atol=1e-3)
    other = driven(agent, observation(size, [51, 102], [[-9.0, 3.0], [0.0, 0.0]]))
    np.testing.assert_array_equal(other, found)


CLEAN = np.stack([np.linspace(-0.2, 0.1, 8), np.linspace(0.3, -0.3, 8)], -1).astype(np.float32)


def nomad_graphs(folder: pathlib.Path) -> pathlib.Path:
    """An encoder whose first number is the mean of all images, and a denoiser that knows the clean sample: `CLEAN` plus
    that number."""
    nodes: list[Node] = [
        mean("obs_img", "pixels", "a"),
        mean("goal_img", "pixels", "b"),
        ("Add", ["a", "b"], ["c"], {}),
        ("Cast", ["goal_mask"], ["mask"], {"to": F}),
        ("Add", ["c", "mask"], ["d"], {}),
        ("Unsqueeze", ["d", "one"], ["e"], {}),
        ("Mul", ["e", "spread"], ["condition"], {}),
    ]
    spread = np.zeros((1, 256), np.float32)
    spread[0, 0] = 0.1
    constants: dict[str, Any] = {"pixels": np.array([1, 2, 3]), "one": np.array([1]), "spread": spread}
    inputs = {"obs_img": (F, ["n", 12, 96, 96]), "goal_img": (F, ["n", 3, 96, 96]), "goal_mask": (WHOLE, ["n"])}
    graph(folder / "nomad_vision_encoder.onnx", inputs, {"condition": ["n", 256]}, nodes, constants)
    nodes = [
        ("Slice", ["global_cond", "c0", "one", "one"], ["shift"], {}),
        ("Unsqueeze", ["shift", "one"], ["shift1"], {}),
        ("Add", ["clean", "shift1"], ["target"], {}),
        ("Gather", ["alphas", "timestep"], ["alpha"], {}),
        ("Sqrt", ["alpha"], ["root"], {}),
        ("Mul", ["target", "root"], ["signal"], {}),
        ("Sub", ["sample", "signal"], ["rest"], {}),
        ("Sub", ["unit", "alpha"], ["variance"], {}),
        ("Sqrt", ["variance"], ["deviation"], {}),
        ("Div", ["rest", "deviation"], ["noise"], {}),
    ]
    constants = {"c0": np.array([0]), "one": np.array([1]), "clean": CLEAN[None], "unit": np.float32(1.0)}
    constants["alphas"] = cosine_alphas().astype(np.float32)
    inputs = {"sample": (F, ["m", 8, 2]), "timestep": (WHOLE, []), "global_cond": (F, ["m", 256])}
    graph(folder / "nomad_noise_pred.onnx", inputs, {"noise": ["m", 8, 2]}, nodes, constants)
    return folder


def test_nomad_denoises_to_what_its_denoiser_knows(tmp_path: pathlib.Path) -> None:
    agent = make("nomad", nomad_graphs(tmp_path))
    size = CONTRACTS["nomad"].size
    agent.see_goal(observation(size, [124, 140], np.zeros((2, 2)))["pixels/front"])
    agent.begin(2)
    found = driven(agent, observation(size, [116, 116], np.zeros((2, 2))))
    for row, goal in enumerate((124, 140)):
        clean = CLEAN + 0.1 * (normalised(116) + normalised(goal))
        steps = np.cumsum((clean + 1) / 2 * [7.5, 8.0] + [-2.5, -4.0], 0)
        x, y = steps[2]
        expected = [np.clip(x, 0.0, 1.0) * SPEED, np.clip(np.arctan2(y, x) * 5.0, -TURN, TURN)]
        np.testing.assert_allclose(found[row], expected, atol=5e-3)


def test_the_diffusion_is_that_of_its_papers() -> None:
    """The cosine schedule in closed form, and the posterior of a Gaussian by Bayes' rule."""
    alphas = cosine_alphas(10)
    f = [np.cos((t / 10 + 0.008) / 1.008 * np.pi / 2) ** 2 for t in range(11)]
    np.testing.assert_allclose(alphas[:9], np.array(f[1:10]) / f[0], rtol=1e-12)
    assert alphas[9] == pytest.approx(alphas[8] * 1e-3)  # beta is at most 0.999
    sample, clean, step = 0.37, -0.2, 6
    now, before = alphas[step], alphas[step - 1]
    noise = (sample - np.sqrt(now) * clean) / np.sqrt(1 - now)
    # p(x_before | x_now, clean) from the prior N(sqrt(before) clean, 1 - before) and x_now = sqrt(a) x_before + noise.
    a = now / before
    precision = 1 / (1 - before) + a / (1 - a)
    mean_of = (np.sqrt(before) * clean / (1 - before) + np.sqrt(a) * sample / (1 - a)) / precision
    assert ddpm_previous(sample, noise, step, alphas, 0.0) == pytest.approx(mean_of)  # type: ignore[arg-type]
    drawn = ddpm_previous(sample, noise, step, alphas, 1.0)  # type: ignore[arg-type]
    assert drawn - mean_of == pytest.approx(np.sqrt(1 / precision))
    assert ddpm_previous(sample, noise, 0, alphas, 9.0) == pytest.approx(  # type: ignore[arg-type]
        np.clip((sample - np.sqrt(1 - alphas[0]) * noise) / np.sqrt(alphas[0]), -1, 1)
    )


def test_a_graph_of_another_model_is_refused_with_both_signatures(tmp_path: pathlib.Path) -> None:
    path = s2e_graph(tmp_path / "s2e.onnx")
    with pytest.raises(ValidationError, match=r"found the inputs .*obs_images.*, needed .*cord"):
        make("citywalker", path)
    with pytest.raises(ValidationError, match=r"nomad_noise_pred\.onnx, needed an ONNX file"):
        make("nomad", path)
    agent = make("vint", goal_image_graph(tmp_path / "vint.onnx"))
    with pytest.raises(ValidationError, match="found goal images of shape None"):
        agent.begin(1)
    with pytest.raises(ValidationError, match=r"found images of \(12, 16\), needed \(64, 85\)"):
        agent(observation((12, 16), [0], [[1.0, 0.0]]))


def test_a_robot_of_several_bodies_is_turned_and_moved_as_a_whole(small_bank: SceneBank) -> None:
    """Leaning, with wheels that are turned, and from a start that is not at height 0."""
    env = unicycle_env(small_bank, vision=True)
    nav = jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(1))
    rng = np.random.default_rng(0)
    xpos = np.asarray([[0, 0, 0], [4.0, -3.0, 0.9], [4.4, -2.8, 0.5], [3.7, -3.3, 0.4]], np.float32)
    xquat = rng.normal(size=(4, 4)).astype(np.float32)
    xquat[1] = [1.0, 0.1, -0.2, 2.0]
    xquat /= np.linalg.norm(xquat, axis=1, keepdims=True)
    start = jnp.float32([4.0, -3.0, 0.35, 1.7])
    sim = nav.sim._replace(xpos=jnp.asarray(xpos), xquat=jnp.asarray(xquat))
    there = at_goal(nav._replace(sim=sim, start=start), 1).sim
    moved = np.asarray(there.xpos)
    np.testing.assert_allclose(moved[1], [*nav.goal[:2], nav.goal[2] + 0.9 - 0.35], atol=1e-5)
    np.testing.assert_array_equal(moved[0], xpos[0])
    np.testing.assert_array_equal(there.xquat[0], xquat[0])
    turn = np.asarray(jax.vmap(rotations.matrix)(there.xquat)) @ np.asarray(
        jax.vmap(rotations.matrix)(xquat)
    ).transpose(0, 2, 1)
    np.testing.assert_allclose(turn[1:, 2], np.tile([0.0, 0.0, 1.0], (3, 1)), atol=1e-5, err_msg="about the vertical")
    np.testing.assert_allclose(turn[2:], turn[1:-1], atol=1e-5, err_msg="all bodies alike")
    np.testing.assert_allclose(moved[2:] - moved[1], (xpos[2:] - xpos[1]) @ turn[1].T, atol=1e-5)


def test_the_goal_is_seen_from_the_goal_in_the_direction_of_arrival(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, vision=True)
    begin = jax.vmap(env.begin_at)
    rows = jnp.arange(4)
    nav = begin(jax.random.split(jax.random.key(0), 4), jnp.zeros(4, jnp.int32), rows)
    there = jax.vmap(lambda one: at_goal(one, 1))(nav)
    goals, points = np.asarray(nav.goal), np.asarray(small_bank.episode_waypoints[0, :4])
    for i in range(4):
        np.testing.assert_allclose(there.sim.xpos[i, 1, :2], goals[i, :2], atol=1e-5)
        last = int(nav.num_waypoints[i]) - 1
        before = points[i, last - 1, :2] if last else np.asarray(nav.start)[i, :2]
        dx, dy = goals[i, :2] - before
        assert float(rotations.yaw_of(there.sim.xquat[i, 1])) == pytest.approx(np.arctan2(dy, dx), abs=1e-4)
        above = np.asarray(nav.sim.xpos)[i, 1, 2] - np.asarray(nav.start)[i, 2]
        assert float(there.sim.xpos[i, 1, 2]) == pytest.approx(goals[i, 2] + above, abs=1e-5)
    images = goal_images(env, nav)
    np.testing.assert_array_equal(images, jax.vmap(env.observe)(there)["pixels/front"])
    assert (images != np.asarray(jax.vmap(env.observe)(nav)["pixels/front"])).any()
