"""Numbers that no run can have are refused in one sentence, before anything is compiled or written."""

import pathlib
from typing import Any

import jax
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import gen, train
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import PRESETS, registry
from urbanverse_mjx.envs.joystick.config import JOYSTICK_PRESETS
from urbanverse_mjx.training.config import check_numbers, default_ppo_config


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *[("sim_dt", 0.0), ("sim_dt", -0.01), ("ctrl_dt", 0.0), ("ctrl_dt", float("nan")), ("episode_length", 0)],
        *[("reward_config.scales.hit", float("nan")), ("success_radius", float("inf"))],
        ("randomization.friction_scale", (0.5, float("nan"))),
    ],
)
def test_an_environment_refuses_them(key: str, value: Any) -> None:
    with pytest.raises(ValidationError, match=rf"config\.{key}.*: found"):
        registry.load("CocoNav", config_overrides={"preset": "cpu", key: value}, bank=box_bank(1, num_objects=1))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--seed", "-1"], r"ppo\.seed: found -1, needed a number of at least 0"),
        (["--seed", str(2**32)], r"ppo\.seed: found 4294967296, needed a number of at most"),
        (["--num-envs", "0"], r"num_envs: found 0, needed a number of at least 1"),
        (["--num-timesteps", "-1"], r"num_timesteps: found -1"),
        (["--num-episodes", "-1"], r"--num-episodes: found -1"),
        (["--ppo-overrides", '{"learning_rate": NaN}'], r"learning_rate: found nan, needed a finite number"),
        (["--playground-config-overrides", '{"sim_dt": 0}'], r"config\.sim_dt: found 0"),
        (["--suffix", "../../x"], r"--suffix: found '\.\./\.\./x', needed a part of a folder's name"),
    ],
)
def test_train_refuses_them_before_streets_are_compiled(
    words: list[str], said: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("urbanverse_mjx.pipeline.training_run.bank_of", lambda *_: pytest.fail("it came too far"))
    for preset in ("cpu", "quick"):
        if preset == "quick" and "learning_rate" in said:
            continue
        with pytest.raises(ValidationError, match=said):
            train.main(["--logdir", str(tmp_path), "--preset", preset, *words])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [
        *[["--cousins", "0"], ["--seed", "-1"], ["--workers", "0"], ["--workers", "-3"], ["--rate", "nan"]],
        *[["--rate", "0"], ["--camera-height", "0"], ["--camera-height", "inf"], ["--kerb", "-0.1"], ["--kerb", "nan"]],
    ],
)
def test_gen_refuses_them_before_its_folder_is_made(words: list[str], tmp_path: pathlib.Path) -> None:
    source, out = tmp_path / "graph.json", tmp_path / "out"
    source.write_text("{}")
    with pytest.raises(ValidationError, match=rf"^{words[0]}: found"):
        gen.main([str(source), "--out", str(out), *words])
    (tmp_path / "list.txt").write_text("graph.json\n")
    if words[0] != "--kerb":
        with pytest.raises(ValidationError, match=rf"^{words[0]}: found"):
            gen.main(["batch", str(tmp_path / "list.txt"), "--out", str(out), *words])
    assert not out.exists()


def test_the_presets_and_the_last_seed_have_none_of_them() -> None:
    for name, presets in (("CocoNav", PRESETS), ("Go2Nav", PRESETS), ("Go2Joystick", JOYSTICK_PRESETS)):
        for preset in presets:
            registry.check_numbers(registry.get_default_config(name, preset))
            check_numbers(default_ppo_config(preset, name))
    last = registry.with_overrides(default_ppo_config("cpu"), {"seed": 2**32 - 1})
    check_numbers(last)
    jax.random.key(int(last.seed))
    assert pipeline.GenerationOptions().cousins >= 1
