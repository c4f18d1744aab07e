"""Options that several commands read alike."""

import pathlib
from typing import Any

import pytest
import tyro

from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import capture, gen, list_envs, play
from urbanverse_mjx.cli._options import image_size
from urbanverse_mjx.cli.benchmark import BenchmarkArgs
from urbanverse_mjx.cli.evaluate import EvaluateArgs
from urbanverse_mjx.cli.play import PlayArgs
from urbanverse_mjx.cli.record import RecordArgs
from urbanverse_mjx.cli.train import TrainArgs
from urbanverse_mjx.cli.view import ViewArgs
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.training.config import default_ppo_config

OVERRIDES = {"robot": "/robots/tug", "sim_dt": 0.005}
WORDS = ["--bank", "a/bank.npz", "--playground-config-overrides", '{"robot": "/robots/tug", "sim_dt": 0.005}']
PRESETS = ("paper", "urbansim_v0_1", "fast", "cpu")


def test_a_size_is_height_by_width() -> None:
    assert image_size("180x320", "--size") == (180, 320)


def test_both_commands_hand_on_height_and_width(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given = []
    monkeypatch.setattr(pipeline, "play", lambda _, options: given.append(options.size) or {"results": []})
    monkeypatch.setattr(pipeline, "capture", lambda _, options, __: given.append(options.size) or {})
    for command in (play, capture):
        for words in ([], ["--size", "90x161"]):
            assert command.main(["--out", str(tmp_path / "out"), *words]) == 0
    assert given == [(180, 320), (90, 161), (360, 640), (90, 161)]


def test_a_batch_knows_the_lens_and_the_country_of_its_films(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: list[pipeline.GenerationOptions] = []

    def run(sources: Any, out: Any, options: pipeline.GenerationOptions, *_: Any) -> dict[str, int]:
        given.append(options)
        return {"failed": 0}

    monkeypatch.setattr(pipeline, "run_batch", run)
    words = ["--focal", "26", "--country", "Japan", "--city", "Tokyo", "--licence", "CC-BY-4.0", "--rate", "4"]
    assert gen.main(["batch", "films.txt", "--out", "runs"]) == 0
    assert gen.main(["batch", "films.txt", "--out", "runs", *words]) == 0
    assert given[0].video == pipeline.VideoOptions()
    named = {"focal": 26.0, "country": "Japan", "city": "Tokyo", "licence": "CC-BY-4.0", "rate": 4.0}
    assert given[1].video == pipeline.VideoOptions(**named)
    capsys.readouterr()


@pytest.mark.parametrize(("hits", "said"), [([False, True], "1 of 2 episodes ended because"), ([False, False], "")])
def test_play_leads_from_contacts_with_the_ground_to_their_cause(
    hits: list[bool], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pipeline, "play", lambda *_: {"results": [{"hit_ground": hit} for hit in hits]})
    assert play.main([]) == 0
    err = capsys.readouterr().err
    assert err.startswith(said)
    assert ("`urbanverse robot` reports" in err) == bool(said)
    assert play.main(["--quiet"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("text", ["180", "180 320", "180X320", "0x320", "180x-1", "180x320x3", "1e3x10", ""])
def test_another_form_of_a_size_is_refused(text: str) -> None:
    with pytest.raises(ValidationError, match=r"--size: found .* needed HEIGHTxWIDTH in pixels"):
        image_size(text, "--size")


@pytest.mark.parametrize("command", [play, capture])
def test_two_numbers_as_they_once_were_are_refused_before_anything_is_drawn(
    command: object, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`play --size 180 320` and `capture --size 640 360` meant different orders."""
    monkeypatch.chdir(tmp_path)
    out = ["--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit) as ended:
        command.main([*out, "--size", "360", "640"])  # type: ignore[attr-defined]
    assert ended.value.code == 2
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        command.main([*out, "--size", "360"])  # type: ignore[attr-defined]
    assert ended.value.code == 2
    assert "found '360', needed HEIGHTxWIDTH" in " ".join(capsys.readouterr().err.replace("│", " ").split())
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["CocoNav", "Go2Nav", "Go2Joystick"])
def test_the_presets_that_are_listed_are_those_that_train_takes(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    list_envs.main([])
    (line,) = [x for x in capsys.readouterr().out.splitlines() if x.startswith(f"{name} ")]
    listed = line.partition("presets: ")[2].rstrip(")").split(", ")
    assert listed
    for preset in PRESETS:
        if preset in listed:
            assert registry.get_default_config(name, preset).preset == preset
            default_ppo_config(preset, name)
            continue
        with pytest.raises(ValidationError, match="preset: found"):
            default_ppo_config(preset, name)


@pytest.mark.parametrize(
    ("kind", "first"),
    [
        (TrainArgs, []),
        (EvaluateArgs, ["zero"]),
        (PlayArgs, []),
        (BenchmarkArgs, ["shipped"]),
        (RecordArgs, ["--out", "x"]),
    ],
)
def test_every_command_reads_them(kind: Any, first: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    args = tyro.cli(kind, args=[*first, *WORDS])
    assert args.bank == pathlib.Path("a/bank.npz")
    assert args.env_overrides == OVERRIDES
    assert tyro.cli(kind, args=first).env_overrides == {}
    with pytest.raises(SystemExit):
        tyro.cli(kind, args=[*first, "--playground-config-overrides", "{"])
    assert "which is not JSON" in capsys.readouterr().err


def test_the_former_option_of_play_works_and_is_not_in_its_help(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: list[Any] = []
    monkeypatch.setattr(pipeline, "play", lambda _, options: given.append(options) or {"results": []})
    assert play.main(["--agent", "zero", "--scenes", "all"]) == 0
    assert play.main(["--policy", "planner"]) == 0
    assert [(o.agent, o.policy, o.scenes) for o in given] == [("zero", None, "all"), (None, "planner", "test")]
    capsys.readouterr()
    with pytest.raises(SystemExit):
        play.main(["--help"])
    said = capsys.readouterr().out
    assert "--policy" in said
    assert "--agent" not in said
    assert "{None}" not in said


def test_people_and_a_robot_of_ones_own_in_a_page_and_a_dataset() -> None:
    """`view` has no --bank: its scene may be one; what evaluate calls --dynamic is there, too."""
    for kind, first in ((ViewArgs, []), (RecordArgs, ["--out", "x"])):
        args = tyro.cli(kind, args=[*first, *WORDS[2:], "--dynamic"])
        assert (args.env_overrides, args.people) == (OVERRIDES, True)
        assert tyro.cli(kind, args=[*first, "--people"]).people
        assert not tyro.cli(kind, args=[*first, "--no-people"]).people
    for kind, first in ((PlayArgs, []), (EvaluateArgs, ["zero"])):
        assert not tyro.cli(kind, args=first).dynamic
        for word in ("--people", "--dynamic"):
            assert tyro.cli(kind, args=[*first, word]).dynamic


def test_overrides_of_a_training_are_json_whose_error_names_the_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert tyro.cli(TrainArgs, args=[]).ppo_overrides == {}
    given = tyro.cli(TrainArgs, args=["--ppo-overrides", '{"learning_rate": 1e-3}'])
    assert given.ppo_overrides == {"learning_rate": 1e-3}
    with pytest.raises(SystemExit):
        tyro.cli(TrainArgs, args=["--ppo-overrides", "learning_rate=1e-3"])
    said = " ".join(capsys.readouterr().err.replace("│", " ").split())
    assert "--ppo-overrides: found 'learning_rate=1e-3', which is not JSON" in said
