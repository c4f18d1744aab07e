"""ONNX files of policies: their outputs, metadata, and results in the environment."""

import csv
import dataclasses
import json
import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.policy_file import PolicyRecord, RobotRecord
from urbanverse_mjx.envs import NavEnv, registry
from urbanverse_mjx.evaluation.frozen import freeze
from urbanverse_mjx.evaluation.onnx_policy import load_onnx
from urbanverse_mjx.pipeline import BenchmarkOptions, benchmark
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.training import export_onnx
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.dagger import default_dagger_config, make_student
from urbanverse_mjx.training.policy import PolicySpec, initial_params, load_policy, save_policy, save_student
from urbanverse_mjx.training.student import StudentPolicy, initial_student

LAYERS = [[4, 4, 4], [4, 2, 2]]
OVERRIDES = {"scenes": "all", "episode_length": 12, "observations.proprio": True}
IMAGE = {"vision_config.height": 12, "vision_config.width": 16}


def _louder(params: Any) -> Any:
    """Parameters whose actions are far from 0, so that missing connections are detected."""
    rng = np.random.default_rng(0)
    return jax.tree.map(lambda x: np.asarray(x + 0.08 * rng.normal(size=np.shape(x)), np.float32), params)


def _env(bank: SceneBank) -> NavEnv:
    return unicycle_env(bank, {**OVERRIDES, **IMAGE}, vision=True)


@pytest.fixture(scope="module")
def folders(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> dict[str, pathlib.Path]:
    """A feed-forward and a recurrent policy, by kind."""
    env, made = _env(small_bank), {}
    shapes = {name: tuple(shape) for name, shape in env.observation_size.items()}
    for kind in ("ppo", "student"):
        config = ConfigDict((default_dagger_config() if kind == "student" else default_ppo_config("fast")).to_dict())
        config.network.layers, config.network.bfloat16 = LAYERS, False
        spec = PolicySpec.of("CocoNav", env, config, 1000)
        folder = tmp_path_factory.mktemp(kind)
        if kind == "ppo":
            _, actor, critic = initial_params(dict(shapes), env.action_size, config, 0)
            made[kind] = save_policy(folder, (_normaliser(), _louder(actor), critic), spec)
        else:
            config.network.last_action = False  # the part of the network that no other test exports
            network = make_student(config, env.action_size)
            made[kind] = save_student(folder, _louder(initial_student(network, shapes, 0)), spec)
    return made


def _normaliser() -> Any:
    from brax.training.acme import running_statistics, specs

    return running_statistics.init_state(specs.Array((1,), jnp.dtype("float32")))


@pytest.fixture(scope="module")
def files(folders: dict[str, pathlib.Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, pathlib.Path]:
    out = tmp_path_factory.mktemp("onnx")
    for kind, folder in folders.items():
        export_onnx.export_onnx(folder, out / f"{kind}.onnx")
    return {kind: out / f"{kind}.onnx" for kind in folders}


def _observations(count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 256, (count, 12, 16, 3), np.uint8)
    goal, proprio = (rng.normal(size=(count, n)).astype(np.float32) for n in (2, 5))
    goal[0] = 0.0  # at the goal the direction is no number in a careless conversion
    return {"pixels/front": pixels, "goal": 8.0 * goal, "proprio": proprio}


@pytest.mark.extended
def test_a_feed_forward_policy_answers_as_in_jax(folders, files) -> None:
    act, _ = load_policy(folders["ppo"])
    obs = _observations(1000)
    expected = np.asarray(jax.jit(act)({k: jnp.asarray(x) for k, x in obs.items()}, jax.random.key(0)))
    found = load_onnx(files["ppo"]).agent(obs)
    assert np.ptp(expected, axis=0).min() > 0.1
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_a_recurrent_policy_answers_as_in_jax_and_forgets_where_episodes_begin(folders, files) -> None:
    policy, _ = load_policy(folders["student"])
    assert isinstance(policy, StudentPolicy)
    act = jax.jit(jax.vmap(policy.act, (0, 0, None)))
    steps, n = 50, 20
    obs = {k: x.reshape(steps, n, *x.shape[1:]) for k, x in _observations(steps * n).items()}
    controller = load_onnx(files["student"])
    first = []
    for _ in range(2):
        controller.begin(n)
        memory = jnp.broadcast_to(policy.first_memory(), (n, *policy.first_memory().shape))
        for t in range(steps):
            one = {k: x[t] for k, x in obs.items()}
            expected, memory = act({k: jnp.asarray(x) for k, x in one.items()}, memory, jax.random.key(0))
            found = controller.agent(one)
            np.testing.assert_allclose(found, expected, atol=1e-5)
            if t == 0:
                first.append(found)
    np.testing.assert_array_equal(*first)
    # Its output depends on earlier inputs.
    assert np.abs(controller.agent({k: x[0] for k, x in obs.items()}) - first[0]).max() > 1e-3


def test_the_metadata_say_how_the_file_is_driven(files) -> None:
    import onnxruntime

    session = onnxruntime.InferenceSession(files["student"])
    record = PolicyRecord.from_json(session.get_modelmeta().custom_metadata_map["urbanverse"], "file")
    for side, values in (("inputs", session.get_inputs()), ("outputs", session.get_outputs())):
        assert [(t.name, list(t.shape)) for t in getattr(record, side)] == [(x.name, x.shape) for x in values]
    by_name = {t.name: t for t in (*record.inputs, *record.outputs)}
    assert list(by_name) == ["pixels/front", "goal", "proprio", "memory", "action", "next_memory"]
    assert by_name["pixels/front"].dtype == "uint8"
    assert (by_name["goal"].unit, by_name["action"].unit) == ("m", "m")
    assert all(t.normalisation for t in by_name.values()), "what the caller scales, or none"
    assert by_name["pixels/front"].normalisation == "none: the network scales it"
    assert record.rate_hz == 5.0
    assert record.env_config["observations"]["proprio"] is True
    coco = make_coco()
    fovy = mujoco.MjModel.from_xml_string(coco.mjcf).camera(coco.camera).fovy[0]
    expected = RobotRecord(coco.name, coco.max_speed, coco.max_yaw_rate, round(float(np.radians(fovy)), 6))
    assert record.robot == expected
    assert f"a vertical field of view of {np.radians(fovy):.3f} rad" in by_name["pixels/front"].meaning
    limit = record.env_config.get("goal_observation_limit", 0.0)
    assert by_name["goal"].normalisation == (
        f"shortened to at most {limit:g} m" if limit else "none: the network scales it"
    )
    before = {k: x for k, x in json.loads(record.to_json()).items() if k != "robot"} | {"schema": "urbanverse.onnx/1"}
    assert PolicyRecord.from_json(json.dumps(before), "old") == dataclasses.replace(record, robot=None)
    assert 0.0 < record.largest_difference <= 1e-5
    assert record.observations == 1000
    assert [t.name for t in load_onnx(files["ppo"]).record.inputs] == ["pixels/front", "goal"]  # type: ignore[union-attr]


@pytest.mark.extended
@pytest.mark.parametrize("kind", ["ppo", "student"])
def test_a_benchmark_drives_the_file_as_the_checkpoint(
    kind: str, folders, files, small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    freeze("boxes", bank, 5, seed=0).save(tmp_path / "boxes.json")
    bank.save(tmp_path / "bank.npz")
    configs = []

    def kinematic(name: str, config: Any, bank: SceneBank) -> NavEnv:
        configs.append(config.to_dict())
        return _env(bank)

    monkeypatch.setattr(registry, "load", kinematic)
    rows = {}
    for name, policy in (("checkpoint", folders[kind]), ("onnx", files[kind])):
        # Two batches: the memory of the first does not enter the second.
        options = BenchmarkOptions(policy=str(policy), contact="ends", pictures=False, at_once=8)
        benchmark(str(tmp_path / "boxes.json"), tmp_path / name, options, tmp_path / "bank.npz")
        with (tmp_path / name / "ends" / "episodes.csv").open() as file:
            rows[name] = [{k: x for k, x in row.items() if k != "agent"} for row in csv.DictReader(file)]
    assert configs[0] == configs[1]
    assert len(rows["onnx"]) == len(rows["checkpoint"]) > 3
    for mine, theirs in zip(rows["onnx"], rows["checkpoint"], strict=True):
        for key in ("scene", "episode", "result", "steps"):
            assert mine[key] == theirs[key]
        for key in ("path_length", "distance_to_goal"):
            assert float(mine[key]) == pytest.approx(float(theirs[key]), abs=1e-3)


def test_the_page_drives_a_file_by_onnxruntime_alone(files, tmp_path: pathlib.Path, monkeypatch, capsys) -> None:
    page = pathlib.Path(__file__).parents[2] / "docs" / "onnx.md"
    (code,) = [part.split("```")[0] for part in page.read_text(encoding="utf-8").split("```python\n")[1:]]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "policy.onnx").write_bytes(files["student"].read_bytes())
    exec(compile(code, str(page), "exec"), {})
    actions = capsys.readouterr().out.splitlines()
    # The same observation three times, and another answer each time: it remembers.
    assert len(set(actions)) == 3


def test_what_differs_from_jax_is_not_written(folders, tmp_path: pathlib.Path, monkeypatch) -> None:
    monkeypatch.setattr(export_onnx, "_converted", lambda step: pytest.fail("converted"))
    with pytest.raises(ValidationError, match=r"needed a name that ends in \.onnx"):
        export_onnx.export_onnx(folders["ppo"], tmp_path / "policy.bin")
    monkeypatch.undo()
    monkeypatch.setattr(export_onnx, "largest_difference", lambda model, step: 0.5)
    with pytest.raises(ValidationError, match=r"found answers that differ from JAX's by 0\.5,"):
        export_onnx.export_onnx(folders["ppo"], tmp_path / "policy.onnx")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "said"), [("no json", "no JSON"), ('{"schema": "urbanverse.onnx/1"}', "inputs"), ("[]", "needed")]
)
def test_broken_metadata_are_one_sentence(text: str, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        PolicyRecord.from_json(text, "x.onnx")
