"""Films: one of every shipped policy, of every scene of the benchmark and of every task, each made once."""

import json
import pathlib
import re
from typing import Any

import imageio.v2 as imageio
import pytest

from benchmarks import films
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.pipeline.playing import PlayOptions, _finest_step, _steps_held
from urbanverse_mjx.training.policy import PolicySpec, latest_policy

ROOT = pathlib.Path(__file__).parents[2]
PAGE = ROOT / "docs/films.md"


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> list[PlayOptions]:
    """The options of what is played; the films are a few bytes."""
    found: list[PlayOptions] = []

    def play(out: pathlib.Path, options: PlayOptions) -> None:
        found.append(options)
        out.write_bytes(b"film" * len(found))

    monkeypatch.setattr(pipeline, "play", play)
    return found


def test_there_is_a_film_of_every_policy_and_scene() -> None:
    names = [film.name for film in films.films()]
    policies = sorted(path.name for path in (ROOT / "benchmarks/policies").iterdir() if path.is_dir())
    body = json.loads((ROOT / "benchmarks/protocols/craftbench.json").read_text())
    assert names == [*policies, *(f"craftbench-{scene['id']}" for scene in body["scenes"]), *films.TASKS]
    assert len(set(names)) == len(names)
    for film in films.films():
        assert film.options.policy is not None
        if film.name not in films.TASKS:
            PolicySpec.load(latest_policy(pathlib.Path(film.options.policy)))


def test_there_is_a_film_of_every_task_that_has_a_page() -> None:
    assert set(films.TASKS) == {path.stem for path in (ROOT / "docs/tasks").glob("*.md")}
    for film in films.films():
        if film.name in films.TASKS:
            assert (film.options.policy, film.options.env_name) == ("planner", films.TASKS[film.name])
            assert film.options.env_name in registry.all_envs()


def test_the_page_of_films_names_those_in_the_repository_and_their_length() -> None:
    rows = re.findall(r"^\| \[[^]]+\]\(films/([^)]+)\.mp4\) .*\| ([\d.]+) \|", PAGE.read_text(), re.MULTILINE)
    kept = {path.stem: path for path in (ROOT / "docs/films").iterdir()}
    assert sorted(name for name, _ in rows) == sorted(kept)
    assert set(kept) <= {film.name for film in films.films()}
    for name, seconds in rows:
        reader: Any
        with imageio.get_reader(kept[name]) as reader:
            meta = reader.get_meta_data()
        assert (meta["codec"], meta["duration"]) == ("h264", pytest.approx(float(seconds), abs=0.06))


def test_films_have_a_rate_at_which_every_robot_can_be_drawn() -> None:
    """The time between two images is a whole number of a gait's steps of 0.02 s."""
    coco, go2 = (registry.get_default_config(name) for name in ("CocoNav", "Go2Nav"))
    for config in (coco, go2):
        for film in films.films():
            assert _steps_held(film.options.fps, config.ctrl_dt, _finest_step(config)) in (2, 5)
    assert _steps_held(20.0, coco.ctrl_dt, _finest_step(coco)) == 4
    for fps in (20.0, 7.0, 2.5):
        with pytest.raises(ValidationError, match=f"--fps: found {fps:g}, needed one of 5, 10, 25, 50, whose images"):
            _steps_held(fps, go2.ctrl_dt, _finest_step(go2))


def test_a_film_that_exists_is_kept_and_an_interrupted_one_made_again(
    played: list[PlayOptions], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = films.films()[:3]
    first = films.make(chosen[:1], tmp_path)
    assert first == {chosen[0].name: 4}

    def interrupted(out: pathlib.Path, _: PlayOptions) -> None:
        out.write_bytes(b"half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(pipeline, "play", interrupted)
        with pytest.raises(KeyboardInterrupt):
            films.make(chosen, tmp_path)
    assert not (tmp_path / f"{chosen[1].name}.mp4").exists()
    sizes = films.make(chosen, tmp_path)
    assert sizes == {chosen[0].name: 4, chosen[1].name: 8, chosen[2].name: 12}
    assert [options.policy for options in played] == [film.options.policy for film in chosen]
    page = (tmp_path / "index.html").read_text()
    assert all(f'src="{film.name}.mp4"' in page for film in chosen)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".html", ".mp4", ".mp4", ".mp4"]


def test_missing_scenes_of_the_benchmark_are_one_sentence(
    played: list[PlayOptions],
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    scene = next(film.name for film in films.films() if film.options.bank is not None)
    assert films.main(["--out", str(tmp_path / "media"), "--only", "coco_best", scene]) == 2
    said = capsys.readouterr()
    assert "urbanverse scene library craftbench" in said.err.splitlines()[-1]
    assert (tmp_path / "media/coco_best.mp4").is_file()
    assert len(played) == 1
    assert films.main(["--out", str(tmp_path / "media"), "--only", "coco_best"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == {"coco_best": 4}
