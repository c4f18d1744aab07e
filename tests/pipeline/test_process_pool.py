"""Worker processes end with the process that started them; the next run removes the remains of a killed one."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import psutil
import pytest

from tests.support.pool_tasks import platform_and_square, square
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.pipeline.generation.run_folder import RunFolder
from urbanverse_mjx.process_pool import results_as_completed, results_in_order
from urbanverse_mjx.scene import metadata
from urbanverse_mjx.scene.compiler import CompiledScene, check_out_dir
from urbanverse_mjx.scene.folders import scene_folders
from urbanverse_mjx.work_folder import MADE, OWNER, replacing_folder, sweep, work_folder

ROOT = pathlib.Path(__file__).parents[2]
#: Starts two workers that sleep for two minutes; every one leaves a file with its process id.
POOL = """
import pathlib, sys
from urbanverse_mjx.process_pool import results_as_completed
from tests.support.pool_tasks import sleep
if __name__ == "__main__":
    for _ in results_as_completed(sleep, [(sys.argv[1], k) for k in range(2)], 2):
        pass
"""
#: The same without the guard that a script with workers needs.
UNGUARDED = """
from urbanverse_mjx.process_pool import results_as_completed
from tests.support.pool_tasks import square
list(results_as_completed(square, [(1,), (2,)], 2))
"""
#: The same in the process in which an asset is imported.
CONTAINED = """
import sys
from urbanverse_mjx.assets.importing.containment import contained
from tests.support.pool_tasks import sleep
if __name__ == "__main__":
    contained(sleep, sys.argv[1], 0)
"""
#: The same in a process that was started by its command line.
COMMAND = """
import os, subprocess, sys
code = (
    "import sys; from urbanverse_mjx.process_pool import end_with_parent; end_with_parent(int(sys.argv[2]));"
    "from tests.support.pool_tasks import sleep; sleep(sys.argv[1], 0)"
)
subprocess.run([sys.executable, "-c", code, sys.argv[1], str(os.getpid())])
"""


@pytest.fixture
def killed() -> Iterator[list[psutil.Process]]:
    """Processes that a test waits for; those that did not end are ended, or a failing test leaves them behind."""
    processes: list[psutil.Process] = []
    yield processes
    for process in processes:
        if process.is_running():
            process.kill()


@pytest.mark.parametrize(
    ("code", "count"), [(POOL, 2), (CONTAINED, 1), (COMMAND, 1)], ids=["pool", "contained", "command"]
)
def test_workers_end_with_a_killed_parent(
    code: str, count: int, tmp_path: pathlib.Path, killed: list[psutil.Process]
) -> None:
    script, folder = tmp_path / "script.py", tmp_path / "ids"
    folder.mkdir()
    script.write_text(code)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    parent = subprocess.Popen([sys.executable, str(script), str(folder)], env=environment, cwd=ROOT)
    for number in range(count):
        deadline = time.monotonic() + 60
        while not (folder / str(number)).is_file():
            assert parent.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        killed.append(psutil.Process(int((folder / str(number)).read_text())))
    assert psutil.wait_procs(killed, timeout=1.0)[0] == [], "they live as long as their parent does"
    # With them the fork server and the process that watches over semaphores, where there are any.
    killed += [p for p in psutil.Process(parent.pid).children(recursive=True) if p not in killed]
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    assert psutil.wait_procs(killed, timeout=10)[1] == []


@pytest.mark.parametrize("workers", [1, 2])
def test_every_result_comes_once_with_its_number(workers: int) -> None:
    found = dict(results_as_completed(square, [(k,) for k in range(5)], workers))
    assert {number: square for number, (square, _) in found.items()} == {k: k * k for k in range(5)}
    assert (os.getpid() in {process for _, process in found.values()}) == (workers == 1)


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_in_a_worker_is_raised_here(workers: int) -> None:
    with pytest.raises(ValueError, match="found -1"):
        list(results_as_completed(square, [(1,), (-1,), (2,)], workers))


def test_a_script_without_a_guard_is_told_of_it(tmp_path: pathlib.Path) -> None:
    (tmp_path / "script.py").write_text(UNGUARDED)
    command = [sys.executable, str(tmp_path / "script.py")]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    # Python's resource tracker, a process of its own, may write after it.
    said = [line for line in ended.stderr.splitlines() if "ValidationError: worker processes" in line]
    assert "found that one of 2 ended by itself" in said[-1]
    assert 'put the calls below `if __name__ == "__main__":`' in said[-1]


def test_the_next_run_removes_the_folder_of_a_killed_one_and_nothing_else(tmp_path: pathlib.Path) -> None:
    code = (
        "import os, pathlib, sys; from urbanverse_mjx.work_folder import work_folder\n"
        "with work_folder('scenes-', pathlib.Path(sys.argv[1])) as folder:\n"
        "    (folder / 'half.npz').write_text('half'); os.kill(os.getpid(), 9)"
    )
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False, cwd=ROOT).returncode == -9
    (left,) = tmp_path.iterdir()
    assert (left / "half.npz").is_file()
    others = [tmp_path / "scenes-minemine", tmp_path / "other-1"]
    for path in others:
        path.mkdir()
        (path / "diary.txt").write_text("mine")
    (tmp_path / "scenes-link").symlink_to(others[0])
    (others[1] / OWNER).touch()
    with work_folder("scenes-", tmp_path) as first:
        assert not left.exists()
        # Neither a second run, nor a sweep in the same process, takes a folder that is in use.
        with work_folder("scenes-", tmp_path) as second:
            sweep(tmp_path, "scenes-")
            assert first.is_dir()
            assert second.is_dir()
            assert first != second
        assert not second.exists()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["other-1", "scenes-link", "scenes-minemine"]
    assert all((path / "diary.txt").is_file() for path in others)


def test_a_folder_put_aside_comes_back_after_a_kill_between_the_renames(tmp_path: pathlib.Path) -> None:
    code = (
        "import os, pathlib, sys; from urbanverse_mjx.work_folder import replacing_folder\n"
        "rename = pathlib.Path.rename\n"
        "def dies(path, target): rename(path, target); os.kill(os.getpid(), 9)\n"
        "pathlib.Path.rename = dies\n"
        "with replacing_folder(pathlib.Path(sys.argv[1])) as folder: (folder / 'a').write_text('new')"
    )
    scene = tmp_path / "g"
    scene.mkdir()
    (scene / "a").write_text("good")
    assert subprocess.run([sys.executable, "-c", code, str(scene)], check=False, cwd=ROOT).returncode == -9
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(".g-")
    # The folder of another scene whose name only begins alike takes no notice of it.
    with replacing_folder(tmp_path / "g-2") as folder:
        (folder / "a").write_text("other")
    assert left.is_dir()
    with pytest.raises(KeyError), replacing_folder(scene):
        raise KeyError
    assert (scene / "a").read_text() == "good"
    with replacing_folder(scene) as folder:
        (folder / "a").write_text("new")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["g", "g-2"]
    assert (scene / "a").read_text() == "new"
    assert sorted(p.name for p in scene.iterdir()) == [MADE, "a"]


def files(folder: pathlib.Path) -> dict[str, str]:
    """Path -> text of the files in a folder, lists of what was made left out."""
    found = (p for p in folder.rglob("*") if not p.is_dir() and p.name != MADE)
    return {p.relative_to(folder).as_posix(): p.read_text() for p in found}


MINE = (".git/config", "notes.md", "sub/.env", "0/own.txt", "0/scene/diary.txt", "7/scene/deep/diary.txt", "x.txt")


def test_a_folder_that_is_replaced_keeps_what_the_user_put_into_it(tmp_path: pathlib.Path) -> None:
    """As `cousins` of a run: folders in it were replaced too since, and files written that only a pattern names."""
    run = tmp_path / "run"
    with replacing_folder(run) as folder:
        for k in (0, 7):
            (folder / str(k)).mkdir()
            (folder / str(k) / "layout.json").write_text("old")
    for k in (0, 7):
        with replacing_folder(run / str(k) / "scene") as folder:
            (folder / "a").write_text("old")
        (run / str(k) / "check.json").write_text("old")
    for name in MINE:
        (run / name).parent.mkdir(parents=True, exist_ok=True)
        (run / name).write_text("mine")
    (run / "link").symlink_to("nowhere")
    (run / ".git" / "refs").mkdir()
    for again in range(2):  # what was kept is the user's the next time too
        with replacing_folder(run, ["*/check.json"]) as folder:
            (folder / "0").mkdir()
            (folder / "0" / "layout.json").write_text("new")
            (folder / "x.txt").write_text("ours, now")
        assert (run / ".git" / "refs").is_dir()
        assert (run / "link").readlink() == pathlib.Path("nowhere")
        (run / "link").unlink()
        mine = {name: "mine" for name in MINE if name != "x.txt"} | {"x.txt.before": "mine"}
        assert files(run) == mine | {"0/layout.json": "new", "x.txt": "ours, now"}, again
        (run / "link").symlink_to("nowhere")
    check_out_dir(run / "0" / "scene")  # it may be compiled into again, and keeps the user's file then too
    with replacing_folder(run / "0" / "scene") as folder:
        (folder / "a").write_text("new")
    assert files(run / "0" / "scene") == {"a": "new", "diary.txt": "mine"}


def test_a_kill_at_any_moment_of_a_replacement_loses_nothing_of_the_users(tmp_path: pathlib.Path) -> None:
    """Killed at each link, copy and rename in turn, until none is left."""
    code = (
        "import os, pathlib, shutil, sys; from urbanverse_mjx.work_folder import replacing_folder\n"
        "left = int(sys.argv[2])\n"
        "def dying(call):\n"
        "    def changed(*given, **named):\n"
        "        global left\n"
        "        done = call(*given, **named); left -= 1\n"
        "        if left < 0: os.kill(os.getpid(), 9)\n"
        "        return done\n"
        "    return changed\n"
        "os.link, pathlib.Path.rename = dying(os.link), dying(pathlib.Path.rename)\n"
        "with replacing_folder(pathlib.Path(sys.argv[1])) as folder: (folder / 'a').write_text('new')"
    )
    for number in range(9):
        scene = tmp_path / str(number) / "g"
        with replacing_folder(scene) as folder:
            (folder / "a").write_text("old")
        for name in ("notes.md", "sub/notes.md"):
            (scene / name).parent.mkdir(exist_ok=True)
            (scene / name).write_text("mine")
        done = subprocess.run([sys.executable, "-c", code, str(scene), str(number)], check=False, cwd=ROOT)
        sweep(scene.parent)
        found = files(scene)
        assert found.pop("a") in ("old", "new")
        assert found == {"notes.md": "mine", "sub/notes.md": "mine"}
        assert [p.name for p in scene.parent.iterdir()] == ["g"]
        if done.returncode == 0:
            break
        assert done.returncode == -9
    assert number == 4, "two links, two renames, and one run that none disturbs"


def left_behind(parent: pathlib.Path, name: str) -> pathlib.Path:
    """State after a kill between the renames that replace a folder: the old one under its temporary name."""
    left = parent / f".{name}-abcd1234"
    for part in ("old", "new"):
        (left / part).mkdir(parents=True)
        (left / part / "metadata.json").write_text(
            json.dumps({"schema": metadata.SCHEMA, "id": name, "statistics": part})
        )
    (left / OWNER).touch()
    return left


def test_whoever_opens_scenes_finds_the_one_that_was_put_aside(tmp_path: pathlib.Path) -> None:
    for place in (tmp_path / "a" / "g", tmp_path / "a"):
        left = left_behind(tmp_path / "a", "g")
        assert scene_folders([place]) == [tmp_path / "a" / "g"]
        assert json.loads((tmp_path / "a" / "g" / "metadata.json").read_text())["statistics"] == "old"
        assert not left.exists()
        shutil.rmtree(tmp_path / "a" / "g")
    left = left_behind(tmp_path, "g")
    with pytest.raises(ValidationError, match="layout"):
        CompiledScene.load(tmp_path / "g")
    assert (tmp_path / "g").is_dir()
    assert not left.exists()
    # The scene is restored, and the remains next to it are removed.
    left = left_behind(tmp_path, "g")
    assert scene_folders([tmp_path]) == [tmp_path / "g"]
    assert not left.exists()


def test_a_scene_that_is_being_compiled_is_left_alone(tmp_path: pathlib.Path) -> None:
    left_behind(tmp_path, "g")
    with replacing_folder(tmp_path / "h") as half, replacing_folder(tmp_path / "g"):
        shutil.copy(tmp_path / "g" / "metadata.json", half)
        assert scene_folders([tmp_path]) == [tmp_path / "g"]
        assert half.is_dir()


def test_a_run_gets_back_the_stage_that_was_put_aside(tmp_path: pathlib.Path) -> None:
    with RunFolder.open(tmp_path, "walk.mp4") as run:
        run.finish("graph", "key", 1.0)
    left_behind(tmp_path, "cousins")
    with RunFolder.open(tmp_path, "walk.mp4"):
        assert json.loads((tmp_path / "cousins" / "metadata.json").read_text())["statistics"] == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == [".lock", "cousins", "run.json"]


@pytest.mark.extended
def test_results_in_order_make_tasks_as_they_are_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two for each worker; JAX has the processor alone there, whatever the variable says."""
    monkeypatch.setenv("JAX_PLATFORMS", "cuda")
    made: list[int] = []

    def tasks() -> Iterator[tuple[int]]:
        for number in range(9):
            made.append(number)
            yield (number,)

    found = []
    for number, (platform, result) in enumerate(
        results_in_order(platform_and_square, tasks(), 2, settings.use_processor_alone)
    ):
        assert len(made) <= number + 4
        assert platform == "cpu"
        found.append(result)
    assert found == [number * number for number in range(9)]


def test_results_in_order_of_one_worker_are_made_here() -> None:
    here = lambda number: (os.getpid(), number)  # noqa: E731  # no worker could be sent it
    assert list(results_in_order(here, ((k,) for k in range(3)), 1)) == [(os.getpid(), k) for k in range(3)]
