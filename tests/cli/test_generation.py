"""`urbanverse gen`: sources, resuming, refused input; and batches with retries and a journal."""

import contextlib
import json
import os
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
import pytest

from tests.support import drawn_street
from urbanverse_mjx.datatypes import SceneBank, SceneGraph, ValidationError
from urbanverse_mjx.pipeline.generation import batch, compiling, one_source, stages
from urbanverse_mjx.pipeline.generation.executors import EXECUTORS, Job, Outcome
from urbanverse_mjx.pipeline.generation.run_folder import RunFolder, key_of
from urbanverse_mjx.pipeline.generation.sources import recognise
from urbanverse_mjx.pipeline.generation.stages import GenerationOptions, generate
from urbanverse_mjx.scene import CompiledScene, displacements

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
GRAPH = SCENES / "residential_bins" / "graph.json"


# Sources ------------------------------------------------------------------------------------------------------------


def test_sources_are_told_apart(tmp_path: pathlib.Path) -> None:
    assert recognise(GRAPH).kind == "graph"
    assert recognise(GRAPH).key == SceneGraph.load(GRAPH).content_hash()[:16]
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames" / "1.png").write_bytes(b"x")
    assert recognise(tmp_path / "frames").kind == "frames"
    video = tmp_path / "walk.mp4"
    video.write_bytes(b"x" * 100)
    assert recognise(video).kind == "video"


def test_sources_are_known_by_their_content(tmp_path: pathlib.Path) -> None:
    """Neither names, sizes nor times of files decide whether a stage is done again."""
    folder = tmp_path / "frames"
    folder.mkdir()
    for name in ("1.png", "2.png"):
        (folder / name).write_bytes(name.encode())
    key = recognise(folder).key
    os.utime(folder / "1.png", (0, 0))
    folder = folder.rename(tmp_path / "moved")
    (folder / "2.png").rename(folder / "5.png")
    assert recognise(folder).key == key
    (folder / "5.png").write_bytes(b"3.png")
    assert recognise(folder).key != key, "another image of the same size under the same name"
    (folder / "1.png").write_bytes(b"2.png")
    (folder / "5.png").write_bytes(b"1.png")
    assert recognise(folder).key != key, "the same images in another order"
    video = tmp_path / "walk.mp4"
    video.write_bytes(bytes(2**20 + 10))
    key = recognise(video).key
    video.write_bytes(bytes(2**20 + 9) + b"x")
    assert recognise(video).key != key, "another end of the same length"


def test_a_recording_is_known_by_the_content_of_its_pictures(tmp_path: pathlib.Path) -> None:
    for name in ("a", "b"):
        recording = drawn_street.record(tmp_path / name, [], np.eye(4)[None])
    key = recognise(tmp_path / "a").key
    assert recognise(tmp_path / "b").key == key
    image = tmp_path / "a" / recording.frames[0].rgb
    image.write_bytes(image.read_bytes()[:-1] + b"x")
    assert recognise(tmp_path / "a").key != key


def test_a_folder_with_other_objects_or_of_another_run_is_not_touched(tmp_path: pathlib.Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ValidationError, match="other files"):
        generate(GRAPH, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]
    other = tmp_path / "run"
    with RunFolder.open(other, "a video") as run:
        run.finish("graph", "k", 1.0)
    with pytest.raises(ValidationError, match="a run of a video"):
        generate(GRAPH, other)


# Resuming -----------------------------------------------------------------------------------------------------------


def test_a_stage_is_done_once_until_its_key_or_files_change(tmp_path: pathlib.Path) -> None:
    with RunFolder.open(tmp_path / "run", "s") as run:
        with run.replacing("part") as folder:
            (folder / "a").write_text("1")
        run.finish("one", key_of("cousins", x=1), 2.0)
    with RunFolder.open(tmp_path / "run", "s") as run:
        assert run.done("one", key_of("cousins", x=1), "part/a")
        assert not run.done("one", key_of("cousins", x=2), "part/a")
        assert not run.done("one", key_of("cousins", x=1), "part/b")
        assert not run.done("two", key_of("cousins", x=1))
        assert run.seconds == {"one": 2.0}


def test_half_a_stage_leaves_the_old_one_whole(tmp_path: pathlib.Path) -> None:
    with RunFolder.open(tmp_path / "run", "s") as run:
        with run.replacing("part") as folder:
            (folder / "a").write_text("old")
        with contextlib.suppress(KeyboardInterrupt), run.replacing("part") as folder:
            (folder / "a").write_text("new")
            raise KeyboardInterrupt
        assert (run.path / "part" / "a").read_text() == "old"
        assert sorted(p.name for p in run.path.iterdir()) == [".lock", "part", "run.json"]


def test_what_a_killed_run_left_half_made_is_swept_out(tmp_path: pathlib.Path) -> None:
    """A run that dies in its first stage, as by SIGKILL, leaves its record and work in progress."""
    code = (
        "import os, sys; from urbanverse_mjx.pipeline.generation.run_folder import RunFolder\n"
        "with RunFolder.open(sys.argv[1], 's') as run, run.replacing('part') as folder:\n"
        "    (folder / 'a').write_text('half'); os.kill(os.getpid(), 9)"
    )
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path / "run")], check=False).returncode == -9
    assert any(p.name.startswith(".part-") for p in (tmp_path / "run").iterdir())
    with RunFolder.open(tmp_path / "run", "s") as run:
        assert sorted(p.name for p in run.path.iterdir()) == [".lock", "run.json"]
        run.finish("one", "key", 1.0)


def test_the_sweep_leaves_what_the_user_put_into_the_folder(tmp_path: pathlib.Path) -> None:
    """Hidden files and folders that no run made, and names that are nearly those of a run's parts."""
    with RunFolder.open(tmp_path / "run", "s") as run:
        with run.replacing("part") as folder:
            (folder / ".env").write_text("mine")
        run.finish("one", "key", 1.0)
    mine = [".git/config", ".notes.md", "sub/.env", ".run-12345678.json.txt", ".part-12345678/a", "cousins/0/.mine"]
    for name in mine:
        path = tmp_path / "run" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("mine")
    halves = [".run-abcd_123.json", "cousins/0/.check-abcd_123.json"]
    for name in halves:
        (tmp_path / "run" / name).write_text("{")
    with RunFolder.open(tmp_path / "run", "s") as run:
        assert [name for name in [*mine, "part/.env"] if (run.path / name).read_text() != "mine"] == []
        assert [name for name in halves if (run.path / name).exists()] == []


def test_one_run_at_a_time(tmp_path: pathlib.Path) -> None:
    with (
        RunFolder.open(tmp_path, "s"),
        pytest.raises(ValidationError, match="another run"),
        RunFolder.open(tmp_path, "s"),
    ):
        pass


class Killed(BaseException):
    """Simulates a kill inside the process."""


def test_a_killed_run_goes_on_where_it_stopped(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cousin 1 dies while compiling; the next run makes it and not cousin 0, nor the graph and the layouts again."""
    made: list[str] = []

    def cousins(*_: object) -> list:
        made.append("cousins")
        return []

    def compiled(folder: pathlib.Path, with_usd: bool) -> dict:
        made.append(f"scene {folder.name}")
        if folder.name == "1" and made.count("scene 1") == 1:
            raise Killed
        (folder / compiling.SCENE).mkdir()
        (folder / compiling.CHECK).write_text("{}")
        return {"seconds": 1.0}

    def layouts(run: RunFolder, *_: object) -> str:
        if not run.done("cousins", "k", "cousins"):
            cousins()
            for k in range(3):
                (run.path / "cousins" / str(k)).mkdir(parents=True)
            run.finish("cousins", "k", 1.0)
        return "k"

    monkeypatch.setattr(stages, "_cousins", layouts)
    monkeypatch.setattr(compiling, "compile_cousin", compiled)
    monkeypatch.setattr(stages, "_bank", lambda *_: "b")
    monkeypatch.setattr(stages, "_report", lambda *_: None)
    monkeypatch.setattr(stages, "_summary", lambda *_: {"folder": "x"})
    options = GenerationOptions(cousins=3, workers=1)
    with pytest.raises(Killed):
        generate(GRAPH, tmp_path / "run", options)
    graph = (tmp_path / "run" / "graph" / "graph.json").stat().st_mtime_ns
    generate(GRAPH, tmp_path / "run", options)
    assert made == ["cousins", "scene 0", "scene 1", "scene 1", "scene 2"]
    assert (tmp_path / "run" / "graph" / "graph.json").stat().st_mtime_ns == graph
    generate(GRAPH, tmp_path / "run", options)
    assert len(made) == 5


# Batches ------------------------------------------------------------------------------------------------------------


def sources_of(tmp_path: pathlib.Path, *names: str) -> pathlib.Path:
    path = tmp_path / "list.txt"
    path.write_text("# captures\n" + "\n".join(names) + "\n\n")
    return path


def fake_work(fail: dict[str, list[int]]):
    """Work that ends with the statuses given by source, then 0; a done run leaves its report."""

    def work(job: Job) -> Outcome:
        status = fail.get(job.source.name, []).pop(0) if fail.get(job.source.name) else 0
        if status == 0:
            job.out.mkdir(parents=True, exist_ok=True)
            (job.out / "report.html").write_text("done")
        return Outcome(status, "some words", 0.1)

    return work


def test_a_failing_source_never_stops_the_rest_and_is_tried_again(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    statuses = {"crash.mp4": [139], "hopeless.mp4": [1, 1, 1], "wrong.mp4": [2, 2]}
    monkeypatch.setattr(batch, "run_source", fake_work(statuses))
    listed = sources_of(tmp_path, "a.mp4", "crash.mp4", "wrong.mp4  # not a video", "hopeless.mp4", "b.mp4", "a.mp4")
    done = batch.run_batch(listed, tmp_path / "out", GenerationOptions(), workers=2, retries=1)
    assert done["sources"] == 5
    assert done["done"] == 3
    assert {pathlib.Path(s).name for s in done["failed"]} == {"wrong.mp4", "hopeless.mp4"}
    events = [json.loads(line) for line in (tmp_path / "out" / "journal.jsonl").read_text().splitlines()]
    started = [pathlib.Path(e["source"]).name for e in events if e["event"] == "started"]
    assert [started.count(n) for n in ("a.mp4", "b.mp4", "crash.mp4", "wrong.mp4", "hopeless.mp4")] == [1, 1, 2, 1, 2]


def test_a_killed_batch_goes_on_with_what_is_not_done(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "run_source", fake_work({}))
    listed = sources_of(tmp_path, "a.mp4", "b.mp4")
    batch.run_batch(listed, tmp_path / "out", GenerationOptions())
    journal = tmp_path / "out" / "journal.jsonl"
    lines = journal.read_text().splitlines(keepends=True)
    last = max(k for k, line in enumerate(lines) if '"done"' in line)
    journal.write_text("".join(lines[:last]) + lines[last][:20])  # the kill came while a line was written
    assert batch.run_batch(listed, tmp_path / "out", GenerationOptions())["done"] == 2
    again = journal.read_text()[len("".join(lines[:last])) :]
    assert again.count('"started"') == 1
    before = journal.read_text()
    batch.run_batch(listed, tmp_path / "out", GenerationOptions())
    assert journal.read_text() == before
    batch.run_batch(listed, tmp_path / "out", GenerationOptions(seed=1))
    assert journal.read_text().count('"started"') == before.count('"started"') + 2


@pytest.mark.extended
def test_a_source_runs_in_a_process_of_its_own(tmp_path: pathlib.Path) -> None:
    outcome = batch.run_source(batch.job_of(tmp_path / "none.mp4", tmp_path / "out", GenerationOptions()))
    assert outcome.status == batch.WRONG_INPUT
    assert outcome.words.startswith("error: ")
    assert "none.mp4" in outcome.words


@pytest.mark.extended
def test_a_source_ends_with_its_batch(tmp_path: pathlib.Path) -> None:
    """Started for a batch whose process has ended, it exits before it makes any file."""
    job = batch.job_of(GRAPH, tmp_path, GenerationOptions())
    command = [sys.executable, "-m", one_source.__name__, one_source.argument(job, parent=1)]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 1
    assert not (job.out / "report.html").exists()


def test_lists_that_cannot_be_used(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="no such file"):
        batch.read_list(tmp_path / "none.txt")
    with pytest.raises(ValidationError, match="no source"):
        batch.read_list(sources_of(tmp_path, "# nothing"))
    with pytest.raises(ValidationError, match="--executor"):
        batch.run_batch(sources_of(tmp_path, "a.mp4"), tmp_path / "out", GenerationOptions(), executor="cloud")


def _status(job: Job) -> Outcome:
    return Outcome(job.options.seed, "said", 0.0)


@pytest.mark.slow
def test_two_ray_workers(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("ray")
    with EXECUTORS["ray"](2) as pool:
        assert pool.size == 2
        tickets = {pool.submit(_status, Job(tmp_path, tmp_path, GenerationOptions(seed=k))): k for k in range(4)}
        found = {}
        while tickets:
            ticket, outcome = pool.next(list(tickets))
            found[tickets.pop(ticket)] = outcome.status
    assert found == {0: 0, 1: 1, 2: 2, 3: 3}


@pytest.mark.slow
def test_a_batch_on_two_ray_workers(tmp_path: pathlib.Path) -> None:
    """Real processes on a real local cluster, with sources that are refused at once."""
    pytest.importorskip("ray")
    listed = sources_of(tmp_path, "a.mp4", "b.mp4", "c.mp4")
    done = batch.run_batch(listed, tmp_path / "out", GenerationOptions(), executor="ray", workers=2)
    assert len(done["failed"]) == 3
    assert all("error: " in words for words in done["failed"].values())


# The whole way ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_graph_becomes_scenes_that_stand_still(tmp_path: pathlib.Path) -> None:
    """Two cousins of a shipped street, compiled in processes; stock MuJoCo loads them; a second call does no work."""
    out = tmp_path / "run"
    options = GenerationOptions(cousins=2, pictures=False)
    done = generate(GRAPH, out, options)
    graph = SceneGraph.load(GRAPH)
    assert done["nodes"] == len(graph.objects)
    assert [p + n for p, n in zip(done["placed"], done["left_out"], strict=True)] == [len(graph.objects)] * 2
    for k in range(2):  # movable objects of the compiled scene keep their places
        assert displacements(CompiledScene.load(out / "cousins" / str(k) / "scene").geometry) == []
    for k in range(2):
        folder = out / "cousins" / str(k)
        model = mujoco.MjModel.from_xml_path(str(folder / "scene" / "scene.xml"))
        assert model.nbody == done["placed"][k] + 1
        assert (folder / "usd" / "scene.usdc").is_file()
    assert SceneBank.load(out / "bank.npz").scene_ids == ("residential_bins", "residential_bins_cousin1")
    assert "cousin1" in (out / "report.html").read_text()
    before = {p: p.stat().st_mtime_ns for p in out.rglob("*") if p.is_file()}
    assert generate(GRAPH, out, options) == done
    assert {p: p.stat().st_mtime_ns for p in out.rglob("*") if p.is_file()} == before
