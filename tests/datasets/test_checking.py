"""`check_dataset` names what is wrong by its place, in datasets that were damaged on purpose."""

import dataclasses
import json
import pathlib
import shutil
from collections.abc import Callable

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.support.recorded import DEPTH, FEATURES, FRONT, RATE, episode, write_dataset
from urbanverse_mjx.datasets import DatasetWriter, Feature, check_dataset, summarise_dataset
from urbanverse_mjx.datatypes import ValidationError

DATA = "data/chunk-000/file-000.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
VIDEO = f"videos/{FRONT}/chunk-000/file-000.mp4"
Damage = Callable[[pathlib.Path], None]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    return write_dataset(tmp_path_factory.mktemp("sound") / "new")


def changed(name: str, column: str, row: int, value: object) -> Damage:
    """Puts another value into a table."""

    def damage(folder: pathlib.Path) -> None:
        table = pq.read_table(folder / name)
        values = table[column].to_pylist()
        values[row] = value
        kind = table.schema.field(column).type
        table = table.set_column(table.column_names.index(column), column, pa.array(values, kind))
        pq.write_table(table, folder / name)

    return damage


def described(path: str, key: str, value: object) -> Damage:
    """Puts another value into a JSON file."""

    def damage(folder: pathlib.Path) -> None:
        body = json.loads((folder / path).read_text())
        *outer, last = key.split("/")
        inner = body
        for name in outer:
            inner = inner[name]
        inner[last] = value
        (folder / path).write_text(json.dumps(body))

    return damage


def cut(name: str, share: float) -> Damage:
    def damage(folder: pathlib.Path) -> None:
        body = (folder / name).read_bytes()
        (folder / name).write_bytes(body[: int(len(body) * share)])

    return damage


def removed(name: str) -> Damage:
    return lambda folder: (folder / name).unlink()


def shorter(folder: pathlib.Path) -> None:
    table = pq.read_table(folder / DATA)
    pq.write_table(table.slice(0, 14), folder / DATA)


DAMAGES: dict[str, tuple[Damage, str]] = {
    "video gone": (removed(VIDEO), f"{VIDEO}: found no such file, needed a video of 15 frames"),
    "video cut": (cut(VIDEO, 0.4), VIDEO),
    "video for more rows": (described("meta/info.json", "fps", 6), "timestamp"),
    "rows gone": (shorter, f"{DATA}: found 14 rows, needed 15 of 3 episodes"),
    "data gone": (removed(DATA), DATA),
    "data cut": (cut(DATA, 0.5), "needed a parquet file"),
    "not finite": (
        changed(DATA, "observation.state", 7, [0.0, np.nan, 0.0]),
        "row 7: observation.state: found a number",
    ),
    "action": (changed(DATA, "action", 3, [0.0, 1.5]), "action: found an action outside [-1, 1]"),
    "time": (changed(DATA, "timestamp", 5, 9.0), "row 5: found timestamp 9 s, needed 0.2 s"),
    "frame": (changed(DATA, "frame_index", 5, 7), "row 5: found frame_index 7, needed 1"),
    "episode": (changed(DATA, "episode_index", 2, 1), "row 2: found episode_index 1, needed 0"),
    "index": (changed(DATA, "index", 9, 3), "row 9: found index 3, needed 9"),
    "task": (changed(DATA, "task_index", 0, 4), "found a task_index outside 0 to 0"),
    "image": (changed(DATA, DEPTH, 8, {"bytes": b"no PNG", "path": None}), f"{DEPTH}: row 8: found an image"),
    "length": (changed(EPISODES, "length", 1, 6), "meta/episodes: found episode 1"),
    "place": (changed(EPISODES, f"videos/{FRONT}/from_timestamp", 2, 0.4), "episode 2: found frames 2 to 15"),
    "tasks gone": (removed("meta/tasks.parquet"), "meta/tasks.parquet"),
    "frames": (described("meta/info.json", "total_frames", 16), "found 15 frames, needed 16"),
    "episodes": (described("meta/info.json", "total_episodes", 4), "found 3 episodes, needed 4"),
    "size": (described("meta/info.json", f"features/{FRONT}/shape", [34, 48, 3]), "found height 33, needed 34"),
    "type": (described("meta/info.json", "features/action/dtype", "float64"), "action: found fixed_size_list"),
    "column": (
        described("meta/info.json", "features/more", {"dtype": "int64", "shape": [1]}),
        "differ from the features: more",
    ),
    "mean": (described("meta/stats.json", "action/mean", [0.0, 0.0]), "action: found another mean"),
    "stats gone": (removed("meta/stats.json"), "meta/stats.json"),
}


def test_a_sound_dataset_has_neither_problems_nor_notes(sound: pathlib.Path) -> None:
    found = check_dataset(sound)
    assert (found.episodes, found.frames, found.problems, found.notes) == (3, 15, (), ())


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_named(sound: pathlib.Path, tmp_path: pathlib.Path, name: str) -> None:
    folder = shutil.copytree(sound, tmp_path / "copy")
    damage, message = DAMAGES[name]
    damage(folder)
    problems = check_dataset(folder).problems
    assert problems
    assert message in "\n".join(problems)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (removed("meta/info.json"), "no such file"),
        (described("meta/info.json", "codebase_version", "v2.1"), "found codebase_version 'v2.1', needed 'v3.0'"),
        (described("meta/info.json", "features", {}), "needed those of LeRobot"),
        (described("meta/info.json", "fps", 0.5), "fps: found 0.5"),
        (described("meta/info.json", "features/action", {"dtype": "float32"}), "needed a feature with dtype and shape"),
        (cut(EPISODES, 0.5), "needed a table"),
    ],
)
def test_what_is_no_dataset_is_refused(
    sound: pathlib.Path, tmp_path: pathlib.Path, damage: Damage, message: str
) -> None:
    folder = shutil.copytree(sound, tmp_path / "copy")
    damage(folder)
    for read in (check_dataset, summarise_dataset):
        with pytest.raises(ValidationError) as caught:
            read(folder)
        assert message in str(caught.value)


def test_a_recording_that_ended_before_its_first_episode_is_said(tmp_path: pathlib.Path) -> None:
    (tmp_path / ".unfinished").mkdir()
    with pytest.raises(ValidationError, match="ended before its first episode"):
        check_dataset(tmp_path)


def test_names_of_other_datasets_may_mean_something_else(tmp_path: pathlib.Path) -> None:
    """Seven joints called a pose are no quaternion, unless `record` wrote them."""
    plain = episode(0)
    features = {**FEATURES, "pose": Feature("float32", (7,))}
    with DatasetWriter(tmp_path / "new", features, RATE, "arm", {}) as writer:
        writer.add(dataclasses.replace(plain, columns={**plain.columns, "pose": np.full((len(plain), 7), 0.7)}))
    assert "quaternion" in check_dataset(tmp_path / "new").problems[0]
    (tmp_path / "new/meta/urbanverse.json").unlink()
    assert check_dataset(tmp_path / "new").problems == ()


def test_the_summary_counts(sound: pathlib.Path) -> None:
    found = summarise_dataset(sound)
    assert (found.episodes, found.frames, found.robot, found.tasks) == (3, 15, "box", ["go"])
    assert found.results == {"goal": 2, "hit": 1}
    assert found.scenes == {"street_0": 2, "street_1": 1}
    assert found.length == {"min": 4, "median": 5, "max": 6}
    assert found.hours == pytest.approx(15 / 5 / 3600)
    table = pq.read_table(sound / DATA)
    rows = np.array(table["action"].to_pylist())
    np.testing.assert_allclose(found.features["action"]["mean"], rows.mean(0), atol=1e-6)
    assert found.features["action"]["names"] == ["x", "y"]
