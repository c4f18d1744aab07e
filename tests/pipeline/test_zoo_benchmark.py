"""`urbanverse benchmark --policy zoo:NAME --weights FILE`: published models and ours by the same options."""

import dataclasses
import pathlib
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from tests.policies.test_zoo import goal_image_graph, s2e_graph
from tests.support.robot_policy import robot_policy
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.cli import main
from urbanverse_mjx.datatypes import BenchmarkReport, SceneBank
from urbanverse_mjx.envs import registry
from urbanverse_mjx.evaluation.frozen import freeze
from urbanverse_mjx.pipeline import BenchmarkOptions, benchmark


class Grey:
    """A renderer of grey images of a config's size, darker as the robot drives on."""

    def __init__(self, size: tuple[int, int]) -> None:
        self._size = size

    def __call__(self, scene: Any, xpos: Any, *_: Any, **__: Any) -> dict[str, Any]:
        return {"rgb": jnp.full((*self._size, 3), 200.0 - 2.0 * xpos[1, 0]).astype(jnp.uint8)}


@pytest.fixture
def files(small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A frozen list of five episodes and its bank; environments are kinematic, their configs are kept."""
    hashes = {name: f"{i}" * 64 for i, name in enumerate(small_bank.scene_ids)}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "hashes": hashes})
    freeze("boxes", bank, 5, seed=0).save(tmp_path / "boxes.json")
    bank.save(tmp_path / "bank.npz")
    configs: list[Any] = []

    def kinematic(name: str, config: Any, bank: SceneBank) -> Any:
        configs.append(config)
        task = {"ctrl_dt": config.ctrl_dt, "episode_length": config.episode_length, "scenes": config.scenes}
        ends = {"terminate_off_traversable": False, "observations.proprio": True}
        env = unicycle_env(bank, {**task, **ends}, vision=True)
        env.renderer = Grey((config.vision_config.height, config.vision_config.width))  # type: ignore[assignment]
        return env

    monkeypatch.setattr(registry, "load", kinematic)
    return {"protocol": str(tmp_path / "boxes.json"), "bank": tmp_path / "bank.npz", "configs": configs}


def run(files: dict[str, Any], out: pathlib.Path, policy: str, weights: pathlib.Path) -> BenchmarkReport:
    options = BenchmarkOptions(policy=policy, weights=weights, contact="ends", pictures=False, scenes=1)
    page = benchmark(files["protocol"], out, options, files["bank"]).page
    assert policy in page
    return BenchmarkReport.load(out / "ends" / "report.json")


@pytest.mark.extended
def test_a_point_goal_model_reaches_its_goals_at_its_own_rate(files: dict[str, Any], tmp_path: pathlib.Path) -> None:
    report = run(files, tmp_path / "out", "zoo:s2e", s2e_graph(tmp_path / "s2e.onnx"))
    (config,) = files["configs"]
    assert (config.ctrl_dt, config.episode_length) == (0.2, 300)
    assert (config.vision_config.height, config.vision_config.width, config.vision_config.depth) == (256, 256, False)
    # The graph answers with the goal.
    assert {r.result for r in report.episodes} == {"goal"}
    assert report.record["policy"]["contract"]["goal"] == "point"  # type: ignore[index]
    assert report.record["policy"]["privileged"] is False  # type: ignore[index]


@pytest.mark.extended
def test_an_image_goal_model_is_shown_the_goal(files: dict[str, Any], tmp_path: pathlib.Path) -> None:
    report = run(files, tmp_path / "out", "zoo:vint", goal_image_graph(tmp_path / "vint.onnx"))
    (config,) = files["configs"]
    assert (config.ctrl_dt, config.episode_length) == (0.2, 300)
    assert (config.vision_config.height, config.vision_config.width) == (64, 85)
    assert "image at the goal" in report.record["policy"]["observations"]  # type: ignore[index]
    assert len(report.episodes) == 5


@pytest.mark.extended
def test_ours_is_driven_by_the_same_options(files: dict[str, Any], tmp_path: pathlib.Path, monkeypatch: Any) -> None:
    path = robot_policy(tmp_path / "ours.onnx")
    monkeypatch.setattr(
        "urbanverse_mjx.pipeline.benchmarking._trained_env",
        lambda options, runs, *_: _ours(runs.bank, runs.scenes),
    )
    through = run(files, tmp_path / "zoo", "zoo:urbanverse", path)
    options = BenchmarkOptions(policy=str(path), contact="ends", pictures=False, scenes=1)
    benchmark(files["protocol"], tmp_path / "file", options, files["bank"])
    direct = BenchmarkReport.load(tmp_path / "file" / "ends" / "report.json")
    assert {r.agent for r in through.episodes} == {"zoo:urbanverse"}
    assert [dataclasses.replace(r, agent="ours") for r in through.episodes] == [
        dataclasses.replace(r, agent="ours") for r in direct.episodes
    ]
    assert len({r.path_length for r in direct.episodes}) > 1


def _ours(bank: SceneBank, scenes: Any) -> Any:
    task = {"episode_length": 20, "scenes": ",".join(scenes), "observations.proprio": True}
    env = unicycle_env(bank, task, vision=True)
    assert np.asarray(env.observation_size["pixels/front"]).tolist() == [12, 16, 3]
    return env


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["zoo:vint"], "--weights: found nothing, needed the ONNX file of zoo:vint"),
        (["zoo:navdp", "--weights", "x.onnx"], "needed one of gnm, vint, nomad, citywalker, s2e, mimic, urbanverse"),
        (["planner", "--weights", "x.onnx"], "needed --policy zoo:NAME"),
        (["zoo:urbanverse", "--weights", "x.bin"], "needed a .onnx file of `urbanverse export-onnx`"),
        (["zoo:gnm", "--weights", "x.onnx"], "found no file x.onnx"),
    ],
)
def test_wrong_use_is_one_sentence(
    words: list[str], said: str, files: dict[str, Any], tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rest = ["--bank", str(files["bank"]), "--quiet", "--no-pictures", "--out", str(tmp_path / "out")]
    assert main.main(["benchmark", files["protocol"], "--policy", *words, *rest]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1


def test_the_page_names_what_each_contract_says() -> None:
    from urbanverse_mjx.policies.zoo import CONTRACTS

    page = (pathlib.Path(__file__).parents[2] / "docs" / "zoo.md").read_text(encoding="utf-8")
    for name, contract in CONTRACTS.items():
        row = next(line for line in page.splitlines() if line.startswith(f"| `{name}`"))
        height, width = contract.size
        said = (f"{height}x{width}", f"{contract.frames}", f"{contract.rate_hz:g} Hz", contract.goal, *contract.files)
        assert all(text in row for text in said), (name, said)
