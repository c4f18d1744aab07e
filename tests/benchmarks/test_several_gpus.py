"""One and two GPUs: results become rows, and rows the table."""

import json
import pathlib

import pytest

from benchmarks import several_gpus

HEAD = "gpus,seed,num_envs,env_steps,teacher,imitation,finetune,scene,SR"


def result_of(folder: pathlib.Path, gpus: int, seed: int, rates: tuple[float, float], speed: float) -> pathlib.Path:
    scores = {"craftbench": {"by_scene": {scene: {"SR": x} for scene, x in zip("ab", rates, strict=True)}}}
    speeds = {"teacher": 10 * speed, "imitation": speed, "finetune": 2 * speed}
    body = {"gpus": gpus, "seed": seed, "num_envs": 4096, "steps": 9, "speed": speeds, "best": scores}
    path = folder / f"{gpus}-{seed}.json"
    path.write_text(json.dumps(body))
    return path


def test_rows_become_the_table(tmp_path: pathlib.Path) -> None:
    (tmp_path / "several_gpus.csv").write_text(HEAD + "\n")
    assert several_gpus.page_text(tmp_path).startswith("Not run yet: `gpus-1-0`, `gpus-1-1`, `gpus-2-0`, `gpus-2-1`;")
    for _ in range(2):  # replaces its own rows
        several_gpus.add(result_of(tmp_path, 1, 0, (80.0, 90.0), 1000.0), tmp_path)
    text = several_gpus.page_text(tmp_path)
    assert "| 1 | 1 | 85.0 [80.0, 90.0] | 10,000 | 1,000 | 2,000 |" in text
    assert "against" not in text
    assert "`gpus-1-0`" not in text
    several_gpus.add(result_of(tmp_path, 1, 1, (80.0, 90.0), 1000.0), tmp_path)
    several_gpus.add(result_of(tmp_path, 2, 0, (82.0, 92.0), 1800.0), tmp_path)
    several_gpus.add(result_of(tmp_path, 2, 1, (82.0, 92.0), 2000.0), tmp_path)
    text = several_gpus.page_text(tmp_path)
    assert "| 2 | 2 | 87.0 [82.0, 92.0] | 19,000 | 1,900 | 3,800 |" in text
    assert "| 2 against 1 |  | 2.0 [2.0, 2.0] | 1.90 times | 1.90 times | 1.90 times |" in text
    assert "Not run yet" not in text


def test_the_speed_is_the_median_of_a_log(tmp_path: pathlib.Path) -> None:
    log = tmp_path / "log.jsonl"
    rows = [{"step": 1}, *({"step": k, "steps_per_second": x} for k, x in enumerate((5.0, 90.0, 100.0, 110.0, 900.0)))]
    log.write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert several_gpus.speed(log) == 100.0
    log.write_text('{"step": 1}\n')
    with pytest.raises(SystemExit, match="found no speed, needed at least two iterations"):
        several_gpus.speed(log)
