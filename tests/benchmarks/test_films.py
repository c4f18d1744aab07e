"""Films: one of every shipped policy, of every scene of the benchmarks and of every task, each made once."""

import json
import pathlib
import re
from typing import Any

import imageio.v2 as imageio
import numpy as np
import pytest

from benchmarks import films
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.pipeline.playing import PlayOptions, _finest_step, _steps_held, _to_show
from urbanverse_mjx.training.policy import PolicySpec, latest_policy
from urbanverse_mjx.viz.video import write_video

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


@pytest.mark.extended
def test_there_is_a_film_of_every_policy_task_and_scene() -> None:
    names = [film.name for film in films.films()]
    policies = sorted(path.name for path in (ROOT / "benchmarks/policies").iterdir() if path.is_dir())
    scenes = []
    for benchmark in films.BENCHMARKS:
        body = json.loads((ROOT / f"benchmarks/protocols/{benchmark}.json").read_text())
        scenes += [f"{benchmark}-{scene['id']}" for scene in body["scenes"]]
    assert names == [*policies, *films.TASKS, *scenes]
    assert (len(scenes), len(set(names))) == (44, len(names))
    for film in films.films():
        assert film.options.policy is not None
        if film.name not in films.TASKS:
            PolicySpec.load(latest_policy(pathlib.Path(film.options.policy)))


def test_a_scene_is_filmed_in_its_own_bank_under_the_conditions_of_its_benchmark() -> None:
    for film in films.films():
        if not film.benchmark:
            assert film.options.bank is None
            continue
        assert film.options.bank is not None
        assert film.options.bank.parts[-2:] == (film.benchmark, "bank.npz")
        assert film.name == f"{film.benchmark}-{film.options.scenes}"
        friction = "materials" if film.benchmark.endswith("_v2") else "uniform"
        assert film.options.env_overrides == {"friction": friction}


def test_there_is_a_film_of_every_task_that_has_a_page() -> None:
    assert set(films.TASKS) == {path.stem for path in (ROOT / "docs/tasks").glob("*.md")}
    for film in films.films():
        if film.name in films.TASKS:
            assert (film.options.policy, film.options.env_name) == ("planner", films.TASKS[film.name])
            assert film.options.env_name in registry.all_envs()


def test_a_task_is_shown_by_a_success_of_several_episodes_in_a_street_of_its_own() -> None:
    shipped = [name for names in json.loads((ROOT / "scenes/splits.json").read_text()).values() for name in names]
    assert set(films.STREETS) == set(films.TASKS)
    assert set(films.STREETS.values()) <= set(shipped)
    assert len(set(films.STREETS.values())) >= 5
    for film in films.films():
        if film.name in films.TASKS:
            found = film.options
            assert (found.num_episodes, found.prefer_successes, found.shown) == (4, True, 1)
            assert found.scenes == films.STREETS[film.name]


def test_a_clip_is_small_plays_at_once_and_is_the_same_each_time(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Noise, which needs more bytes than any street, and at the end one shade, which stands for a second."""
    given: list[PlayOptions] = []

    def play(out: pathlib.Path, options: PlayOptions) -> None:
        given.append(options)
        noise = np.random.default_rng(0).integers(0, 256, (79, 96, 160, 3), np.uint8)
        write_video(out, [*noise, np.full((96, 160, 3), 90, np.uint8)], 10, options.quality, "ultrafast")

    monkeypatch.setattr(pipeline, "play", play)
    chosen = [film for film in films.films() if film.name == "deliver"]
    contents = []
    for name in ("a", "b"):
        sizes, _ = films.make(chosen, tmp_path / name, clips=True)
        contents.append((tmp_path / name / "deliver.mp4").read_bytes())
        assert sizes == {"deliver": len(contents[-1])}
        assert [path.name for path in (tmp_path / name).iterdir()] == ["deliver.mp4"]
    assert contents[0] == contents[1]
    assert len(contents[0]) <= films.CLIP_BYTES
    assert contents[0].index(b"moov") < contents[0].index(b"mdat"), "a browser can begin before it has all"
    assert (given[0].last, given[0].azimuth) == (8.0, 60.0)
    reader: Any
    with imageio.get_reader(tmp_path / "a/deliver.mp4") as reader:
        meta, frames = reader.get_meta_data(), [np.asarray(frame) for frame in reader]
    assert (meta["codec"], meta["pix_fmt"].split("(")[0], len(frames)) == ("h264", "yuv420p", 90)
    assert all(abs(float(frame.mean()) - 90.0) < 20.0 and frame.std() < 20.0 for frame in frames[-9:])


def test_the_page_of_every_task_that_has_a_clip_shows_it_and_says_how_it_is_made() -> None:
    clips = {path.stem for path in (ROOT / "docs/films").glob("*.mp4")} & set(films.TASKS)
    assert clips
    for name in films.TASKS:
        text = (ROOT / f"docs/tasks/{name}.md").read_text()
        assert (f'preload="metadata" width="640" src="../films/{name}.mp4"></video>' in text) == (name in clips)
        assert (f"[file](../films/{name}.mp4)" in text) == (name in clips)
        assert f'make docs-media ARGS="--only {name}"' in text
        if name in clips:
            assert f'make docs-media ARGS="--clip --out docs/films --only {name}"' in text
            assert (ROOT / f"docs/films/{name}.mp4").stat().st_size <= films.CLIP_BYTES


def test_the_page_of_films_names_those_in_the_repository_and_their_length() -> None:
    rows = re.findall(r"^\| \[[^]]+\]\(films/([^)]+)\.mp4\) .*\| ([\d.]+) \|", PAGE.read_text(), re.MULTILINE)
    kept = {path.stem: path for path in (ROOT / "docs/films").iterdir()}
    assert sorted(name for name, _ in rows) == sorted(kept)
    # A mission is filmed by benchmarks.missions.
    assert set(kept) <= {film.name for film in films.films()} | {"mission"}
    for name, seconds in rows:
        reader: Any
        with imageio.get_reader(kept[name]) as reader:
            meta = reader.get_meta_data()
        assert (meta["codec"], meta["duration"]) == ("h264", pytest.approx(float(seconds), abs=0.06))


def test_the_page_of_films_says_how_many_there_are_of_what() -> None:
    text, every = PAGE.read_text(), films.films()
    assert f"lists all {len(every)}." in text
    for benchmark in films.BENCHMARKS:
        number = sum(film.benchmark == benchmark for film in every)
        assert re.search(rf"^\| .*`{benchmark}-\.\.\.`.* \| {number} each \| ", text, re.MULTILINE)
    for film in every:
        assert film.benchmark or f"`{film.name}`" in text


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
    assert first == ({chosen[0].name: 4}, [])

    def interrupted(out: pathlib.Path, _: PlayOptions) -> None:
        out.write_bytes(b"half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(pipeline, "play", interrupted)
        with pytest.raises(KeyboardInterrupt):
            films.make(chosen, tmp_path)
    assert not (tmp_path / f"{chosen[1].name}.mp4").exists()
    sizes, _ = films.make(chosen, tmp_path)
    assert sizes == {chosen[0].name: 4, chosen[1].name: 8, chosen[2].name: 12}
    assert [options.policy for options in played] == [film.options.policy for film in chosen]
    page = (tmp_path / "index.html").read_text()
    assert all(f'src="{film.name}.mp4"' in page for film in chosen)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".html", ".mp4", ".mp4", ".mp4"]


def test_films_of_scenes_that_are_not_built_are_left_out_and_named_in_one_sentence(
    played: list[PlayOptions],
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    bank = tmp_path / "cache/library/autobench/bank.npz"
    bank.parent.mkdir(parents=True)
    bank.touch()
    chosen = ["--out", str(tmp_path / "media"), "--only", "craftbench", "autobench_v2", "coco_best", "autobench"]
    assert films.main(chosen) == 2
    said = capsys.readouterr()
    last = said.err.splitlines()[-1]
    assert "no scenes of craftbench and autobench_v2, needed them for 22 films; run `urbanverse scene library" in last
    sizes = json.loads(said.out.splitlines()[-1])
    assert len(played) == len(sizes) == 11  # coco_best and the ten scenes of AutoBench
    assert all((tmp_path / f"media/{name}.mp4").stat().st_size == size for name, size in sizes.items())
    assert films.main(["--out", str(tmp_path / "media"), "--only", "coco_best", "autobench"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == sizes
    assert len(played) == 11


def test_a_film_that_there_is_not_is_one_sentence(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert films.main(["--out", str(tmp_path), "--only", "coco_worst"]) == 2
    assert "--only: found 'coco_worst', needed some of craftbench_v2, " in capsys.readouterr().err


def test_episodes_that_reach_their_goal_are_preferred_and_not_required() -> None:
    every, only, prefer = PlayOptions(), PlayOptions(only_successes=True), PlayOptions(prefer_successes=True)
    for options, some, none in ((every, [0, 1, 2], [0, 1]), (only, [1], None), (prefer, [1], [0, 1])):
        assert _to_show([False, True, False], options) == some
        if none is not None:
            assert _to_show([False, False], options) == none
    with pytest.raises(ValidationError, match="--only-successes: found none among 2 episodes"):
        _to_show([False, False], only)
