"""Costs: read from the records of runs and of the library, and estimated for an endpoint."""

import json
import pathlib
import subprocess
import sys
import time
from typing import Any

import pytest

from benchmarks import costs
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.importing import vision
from urbanverse_mjx.datatypes import ValidationError


def written(path: pathlib.Path, body: Any) -> pathlib.Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(body), encoding="utf-8")
    return path


#: A process of its own, because one that tests ran in has freed memory that a large array takes anew.
CLOCK = """
import json
import numpy as np
from urbanverse_mjx.pipeline.generation.run_folder import Clock
clock = Clock()
before = clock.resources
large = np.ones(8 * 2**20)  # 64 MB
while clock.resources["processor_s"] < before["processor_s"] + 0.05:
    large.sum()
after = clock.resources
del large
print(json.dumps([before, after, Clock().resources]))
"""


def test_a_clock_tells_processor_time_and_the_largest_memory_since_it_was_made() -> None:
    said = subprocess.run([sys.executable, "-c", CLOCK], capture_output=True, text=True, check=True).stdout
    before, after, new = (found["memory_mb"] for found in json.loads(said))
    assert after >= before + 40.0
    assert new < after - 30.0, "a new clock forgets"


def test_stages_of_a_run(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match=r"no run\.json"):
        costs.run_costs(tmp_path)
    stage = {"key": "k", "seconds": 9.0}
    written(tmp_path / "run.json", {"stages": {"graph": stage}})
    with pytest.raises(ValidationError, match=r"no processor time.*run `urbanverse gen` again"):
        costs.run_costs(tmp_path)
    taken = {**stage, "processor_s": 4.0, "memory_mb": 300.0}
    written(
        tmp_path / "run.json", {"stages": {"graph": taken, "scenes": stage, "scenes/0": {**taken, "processor_s": 6.0}}}
    )
    found = costs.run_costs(tmp_path)
    assert found["stages"] == {
        "graph": {"processor_s": 4.0, "memory_mb": 300.0},
        "scenes/0": {"processor_s": 6.0, "memory_mb": 300.0},
    }


def test_scenes_an_hour_are_core_hours_over_the_mean(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    with pytest.raises(ValidationError, match="urbanverse scene library places"):
        costs.library_costs("places")
    for k, spent in enumerate((10.0, 20.0, 30.0)):
        written(tmp_path / f"library/places/records/{k}.json", {"processor_s": spent, "objects": 100 + k})
    found = costs.library_costs("places")
    assert (found["processor_s"], found["most_s"], found["objects"]) == (20.0, 30.0, 101)
    assert (found["scenes_an_hour_2_cores"], found["scenes_an_hour_16_cores_estimated"]) == (360, 2880)


def test_tokens_of_an_annotation() -> None:
    """Four images of at most 765 tokens, the letters of the prompt by four, and the prices."""
    found = costs.endpoint_costs()["asset"]
    letters = len(vision.PROMPT.format(name='""', leaves=", ".join(ontology.categories())))
    assert found["sent"] == 4 * 765 + letters // 4
    assert found["dollars"] == pytest.approx((found["sent"] * 1.0 + 500 * 4.0) / 1e6, abs=1e-4)


def test_the_page_has_every_stage_and_a_sum(tmp_path: pathlib.Path) -> None:
    stages = {"graph": {"processor_s": 4.0, "memory_mb": 300.0}, "frames": {"processor_s": 2.0, "memory_mb": None}}
    path = tmp_path / "costs.csv"
    costs.keep("walk", "run", {"frames": 8, "perceived": True, "stages": stages}, path)
    costs.keep("walk", "run", {"frames": 4, "perceived": True, "stages": stages}, path)
    text = costs.page_text(path)
    assert text.index("| frames | 2.0 | 0.50 |") < text.index("| graph | 4.0 | 1.00 | 300 |")
    assert "| all | 6.0 |" in text
    assert "8 frames" not in text, "a later run replaces an earlier one"


def test_batches_are_told_by_executor(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "costs.csv"
    for executor, seconds in (("local", 60.0), ("ray", 80.0)):
        row = {"executor": executor, "workers": 2, "scenes": 30, "seconds": seconds, "processor_s": 3.0}
        costs.keep(f"{executor}, 2", "batch", {**row, "scenes_an_hour": round(30 * 3600 / seconds)}, path)
    text = costs.page_text(path)
    assert "| local | 2 | 30 | 60.0 | 1800 | 3.0 |\n| ray | 2 | 30 | 80.0 | 1350 | 3.0 |" in text


def test_a_batch_that_fails_is_no_figure(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of the sources would look like twice the speed."""
    from urbanverse_mjx.pipeline.generation import batch

    monkeypatch.setattr(
        batch, "run_source", lambda job: batch.Outcome(job.source.parent.name == "park_edge", "no", 0.1)
    )
    with pytest.raises(ValidationError, match=r"found .*park_edge.*needed cousins of all shipped graphs"):
        costs.batch_costs("local", 2)

    def made(job: batch.Job) -> batch.Outcome:
        time.sleep(0.1)
        return batch.Outcome(0, "", 0.1)

    monkeypatch.setattr(batch, "run_source", made)
    found = costs.batch_costs("local", 2)
    assert found["scenes"] == 30
    assert found["seconds"] >= 0.3, "six sources, two at a time"
    assert found["scenes_an_hour"] == pytest.approx(3600 * 30 / found["seconds"], rel=0.2)
