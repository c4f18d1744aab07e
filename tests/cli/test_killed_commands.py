"""`benchmark`, `record` and `view`, each killed at ten random moments (`deploy`: tests/deployment): what was written is
whole, no process is left, and the next run gives what an undisturbed one gives."""

import functools
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator

import numpy as np
import psutil
import pytest
from PIL import Image

from urbanverse_mjx.datasets import check_dataset
from urbanverse_mjx.datasets.claims import require_new
from urbanverse_mjx.datasets.features import UNFINISHED
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.settings import cache_dir

pytestmark = pytest.mark.slow
KILLS = 10
ROOT = pathlib.Path(__file__).parents[2]
BENCHMARK = "benchmark shipped --policy go_to_goal --scenes 1 --impl warp --contact ends --quiet --out"
RECORD = (
    "record --policy go_to_goal --num-episodes 6 --num-envs 2 --size 32x48 --quiet --playground-config-overrides "
    '{"impl":"warp","episode_length":20} --out'
)


class Commands:
    """Runs the command in a folder of its own, with a cache that holds little more than the bank of the streets."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder, self.cache = folder / "work", folder / "cache"
        self.folder.mkdir()
        for name in ("assets", "banks"):
            if cache_dir(name).is_dir():
                shutil.copytree(cache_dir(name), self.cache / name, ignore=shutil.ignore_patterns("*.bad*"))

    def start(self, *words: str) -> "subprocess.Popen[str]":
        environment = {**os.environ, "URBANVERSE_CACHE": str(self.cache), "PYTHONPATH": str(ROOT)}
        return subprocess.Popen(
            [sys.executable, "-m", "urbanverse_mjx.cli.main", *words],
            cwd=self.folder,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    def run(self, *words: str) -> float:
        """Runs it to its end; s."""
        begin = time.monotonic()
        with self.start(*words) as process:
            said = process.communicate(timeout=900.0)[1]
        assert process.returncode == 0, said
        assert "Traceback" not in said
        return time.monotonic() - begin

    def kill(self, process: "subprocess.Popen[str]") -> None:
        """Kills it, and waits until its processes have gone too."""
        try:
            children = psutil.Process(process.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            children = []
        process.send_signal(signal.SIGKILL)
        process.communicate()
        _, left = psutil.wait_procs(children, timeout=20.0)
        assert left == []

    def whole_caches(self) -> None:
        """No file was set aside but those that JAX writes in place."""
        bad = [path for path in self.cache.rglob("*.bad*") if path.parent.name != "jax"]
        assert bad == []
        for path in (self.cache / "banks").glob("*.npz"):
            SceneBank.load(path)


@pytest.fixture
def commands(bank: SceneBank, tmp_path: pathlib.Path) -> Commands:
    assert bank.num_scenes > 0  # it is in the cache
    return Commands(tmp_path)


def moments(seconds: float, begun: Callable[[], bool]) -> Iterator[Callable[[], None]]:
    """Waits until ten random moments of a run that takes so long (s): five of all of it, and five of the second after
    its first output, where most is written."""
    draw = random.Random(0)

    def wait(delay: float, after: Callable[[], bool]) -> None:
        end = time.monotonic() + 20.0 * seconds
        while not after() and time.monotonic() < end:
            time.sleep(0.005)
        time.sleep(delay)

    for k in range(KILLS):
        if k % 2:
            yield functools.partial(wait, draw.uniform(0.0, 1.0), begun)
        else:
            yield functools.partial(wait, draw.uniform(0.0, seconds), lambda: True)


def bytes_of(folder: pathlib.Path, *without: str) -> dict[str, bytes]:
    """Path -> content of the files of a folder, but for the commit of the code; hidden ones are what a killed run was
    writing."""
    found = sorted(path for path in folder.rglob("[!.]*") if path.is_file() and path.name not in without)
    return {str(p.relative_to(folder)): re.sub(rb'"commit": "[^"]*"', b"", p.read_bytes()) for p in found}


def check_whole(path: pathlib.Path) -> None:
    """Reads a file of a benchmark to its end."""
    if path.suffix == ".json":
        json.loads(path.read_text())
    elif path.suffix == ".jsonl":
        assert [json.loads(line) for line in path.read_text().splitlines()]
    elif path.suffix == ".png":
        with Image.open(path) as image:
            image.load()
    elif path.suffix == ".npz":
        with np.load(path) as arrays:
            assert {name: arrays[name].size for name in arrays.files}
    else:
        assert path.read_text().endswith("\n"), path


def test_a_benchmark_killed_at_any_moment_leaves_whole_files(commands: Commands) -> None:
    seconds = commands.run(*BENCHMARK.split(), "whole")
    whole, out = bytes_of(commands.folder / "whole", "timing.json"), commands.folder / "killed"
    seconds = commands.run(*BENCHMARK.split(), "whole")
    assert bytes_of(commands.folder / "whole", "timing.json") == whole
    for wait in moments(seconds, lambda: out.is_dir() and any(p.is_file() for p in out.rglob("[!.]*"))):
        shutil.rmtree(out, ignore_errors=True)
        process = commands.start(*BENCHMARK.split(), "killed")
        wait()
        commands.kill(process)
        for path in out.rglob("[!.]*"):
            if path.is_file():
                assert str(path.relative_to(out)) in {*whole, "timing.json"}
                check_whole(path)
    # In the folder that the last one left.
    commands.run(*BENCHMARK.split(), "killed")
    assert bytes_of(out, "timing.json") == whole
    commands.whole_caches()


def test_a_recording_killed_at_any_moment_is_complete_up_to_an_episode(commands: Commands) -> None:
    seconds = commands.run(*RECORD.split(), "whole")
    whole = check_dataset(commands.folder / "whole")
    seconds = commands.run(*RECORD.split(), "second")
    assert bytes_of(commands.folder / "second") == bytes_of(commands.folder / "whole")
    for k, wait in enumerate(moments(seconds, lambda: any(commands.folder.glob("killed-*/meta/info.json")))):
        for old in commands.folder.glob("killed-*"):
            shutil.rmtree(old)
        out = commands.folder / f"killed-{k}"
        process = commands.start(*RECORD.split(), out.name)
        wait()
        commands.kill(process)
        written = [p for p in out.rglob("*") if p.is_file() and UNFINISHED not in p.relative_to(out).parts]
        if written:
            found = check_dataset(out)
            assert found.problems == ()
            assert 0 < found.episodes <= whole.episodes
        if out.is_dir():
            with pytest.raises(ValidationError, match="a new or empty folder"):
                require_new(out)
    # Where the last one was killed.
    commands.run(*RECORD.split(), out.name, "--resume")
    assert bytes_of(out) == bytes_of(commands.folder / "whole")
    commands.whole_caches()


def test_a_viewer_killed_at_any_moment_frees_its_port(commands: Commands) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = ("view", "park_edge", "--policy", "go_to_goal", "--no-open", "--port", str(port))

    def served() -> bool:
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=2.0) as page:
                return bool(re.search(rb"<html|<!doctype", page.read(), re.IGNORECASE))
        except OSError:
            return False

    begin = time.monotonic()
    process = commands.start(*words)
    while not served():
        assert process.poll() is None
        assert time.monotonic() < begin + 900.0
        time.sleep(0.05)
    seconds = time.monotonic() - begin
    commands.kill(process)
    for wait in moments(seconds, served):
        process = commands.start(*words)
        wait()
        assert process.poll() is None
        commands.kill(process)
        assert not served()
    assert list(commands.folder.iterdir()) == []
    process = commands.start(*words)
    while not served():
        assert process.poll() is None
        time.sleep(0.05)
    commands.kill(process)
    commands.whole_caches()
