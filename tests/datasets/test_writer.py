"""The files of a LeRobotDataset v3, against the layout of huggingface/lerobot and the episodes that were added."""

import errno
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import time

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.support import recorded
from tests.support.recorded import DEPTH, FEATURES, FRONT, RATE, episode, write_dataset
from urbanverse_mjx.datasets import DatasetWriter, Episode, check_dataset, statistics, video, writer
from urbanverse_mjx.datatypes import ValidationError

#: Fields of `DatasetInfo` in lerobot's `datasets/utils.py`; a reader warns of others.
INFO = {
    *("codebase_version", "fps", "features", "total_episodes", "total_frames", "total_tasks", "chunks_size"),
    *("data_files_size_in_mb", "video_files_size_in_mb", "data_path", "video_path", "robot_type", "splits"),
}


def frames_of(path: pathlib.Path) -> list[tuple[float, np.ndarray]]:
    """(s, image) of each frame of a video."""
    capture, frames = cv2.VideoCapture(str(path)), []
    while True:
        done, image = capture.read()
        if not done:
            return frames
        frames.append((capture.get(cv2.CAP_PROP_POS_MSEC) / 1000, image))


def test_descriptions_are_those_that_lerobot_reads(tmp_path: pathlib.Path) -> None:
    folder = write_dataset(tmp_path / "new")
    info = json.loads((folder / "meta/info.json").read_text())
    assert set(info) == INFO
    assert (info["codebase_version"], info["fps"], info["splits"]) == ("v3.0", RATE, {"train": "0:3"})
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (3, 15, 1)
    assert info["features"]["timestamp"] == {"dtype": "float32", "shape": [1], "names": None}
    assert info["features"][DEPTH]["info"] == {"is_depth_map": True, "depth_unit": "mm"}
    tasks = pq.read_table(folder / "meta/tasks.parquet")
    assert tasks.to_pydict() == {"task_index": [0], "task": ["go"]}
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["task"]
    stats = json.loads((folder / "meta/stats.json").read_text())
    assert set(stats) == set(info["features"])
    keys = {"min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"}
    assert all(set(body) == keys for body in stats.values())
    assert np.shape(stats[FRONT]["mean"]) == (3, 1, 1)
    assert np.shape(stats[DEPTH]["mean"]) == (1, 1, 1)
    assert np.shape(stats["action"]["mean"]) == (2,)
    assert np.shape(stats["next.reward"]["q50"]) == np.shape(stats[FRONT]["count"]) == (1,)


def test_rows_are_the_episodes(tmp_path: pathlib.Path) -> None:
    folder = write_dataset(tmp_path / "new")
    table = pq.read_table(folder / "data/chunk-000/file-000.parquet")
    assert pq.ParquetFile(folder / "data/chunk-000/file-000.parquet").num_row_groups == 3
    assert set(table.column_names) == {
        *FEATURES,
        "timestamp",
        "frame_index",
        "episode_index",
        "index",
        "task_index",
    } - {FRONT}
    assert table.schema.field("action").type == pa.list_(pa.float32(), 2)
    assert table.schema.field("next.reward").type == pa.float32()
    assert table["index"].to_pylist() == list(range(15))
    assert table["frame_index"].to_pylist() == [*range(4), *range(5), *range(6)]
    np.testing.assert_allclose(table["timestamp"].to_numpy(), np.array(table["frame_index"]) / RATE, atol=1e-6)
    row = 0
    for number in range(3):
        own = episode(number, 4 + number)
        for step in range(len(own)):
            np.testing.assert_array_equal(table["action"][row].as_py(), own.columns["action"][step].astype(np.float32))
            image = cv2.imdecode(np.frombuffer(table[DEPTH][row].as_py()["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)
            np.testing.assert_array_equal(image, recorded.depth_image(number, step))
            row += 1


def test_videos_show_the_episodes_one_after_the_other(tmp_path: pathlib.Path) -> None:
    folder = write_dataset(tmp_path / "new")
    frames = frames_of(folder / f"videos/{FRONT}/chunk-000/file-000.mp4")
    assert len(frames) == 15
    rows = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    for number, row in enumerate(rows):
        first = round(row[f"videos/{FRONT}/from_timestamp"] * RATE)
        assert (row["dataset_from_index"], row["length"], row["result"]) == (
            first,
            4 + number,
            ("hit", "goal", "goal")[number],
        )
        assert row[f"videos/{FRONT}/to_timestamp"] == pytest.approx((first + 4 + number) / RATE)
        for step in range(4 + number):
            seconds, image = frames[first + step]
            assert seconds == pytest.approx((first + step) / RATE, abs=1e-4)
            assert abs(float(image.mean()) - recorded.level(number, step)) < 3


def test_full_files_are_followed_by_new_ones(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "_FILE_EPISODES", 2)
    monkeypatch.setattr("urbanverse_mjx.datasets.features.CHUNK_SIZE", 2)
    folder = write_dataset(tmp_path / "new", 5)
    names = [f"chunk-{c:03d}/file-{n:03d}" for c, n in ((0, 0), (0, 1), (1, 0))]
    for place, ending in (("data", "parquet"), ("meta/episodes", "parquet"), (f"videos/{FRONT}", "mp4")):
        assert sorted(p.relative_to(folder).as_posix() for p in (folder / place).rglob("*.*")) == [
            f"{place}/{name}.{ending}" for name in names
        ]
    rows = pq.read_table(folder / "meta/episodes/chunk-001/file-000.parquet").to_pylist()
    assert [(r["data/chunk_index"], r["data/file_index"], r[f"videos/{FRONT}/from_timestamp"]) for r in rows] == [
        (1, 0, 0)
    ]
    assert check_dataset(folder).problems == ()


def test_the_same_episodes_give_the_same_bytes(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However often files were written in between."""
    first = write_dataset(tmp_path / "a")
    monkeypatch.setattr(writer, "_WRITE_EVERY", 0.0)
    second = write_dataset(tmp_path / "b")
    names = sorted(p.relative_to(first) for p in first.rglob("*") if p.is_file())
    assert len(names) == 7
    assert names == sorted(p.relative_to(second) for p in second.rglob("*") if p.is_file())
    assert [n for n in names if (first / n).read_bytes() != (second / n).read_bytes()] == []


@pytest.mark.parametrize("renamed", range(8))
def test_killed_between_two_renames_the_written_episodes_are_complete(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, renamed: int
) -> None:
    class Killed(BaseException):
        pass

    monkeypatch.setattr(writer, "_WRITE_EVERY", 0.0)
    out = DatasetWriter(tmp_path / "new", FEATURES, RATE, "box")
    out.add(episode(0))
    rename, left = pathlib.Path.replace, [renamed]

    def replace(self: pathlib.Path, target: pathlib.Path) -> pathlib.Path:
        if not left[0]:
            raise Killed
        left[0] -= 1
        return rename(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(pathlib.Path, "replace", replace)
        if renamed < 7:
            with pytest.raises(Killed):
                out.add(episode(1))
        else:
            out.add(episode(1))
    found = check_dataset(tmp_path / "new")
    assert found.problems == ()
    assert (found.episodes, found.frames) == ((2, 8) if renamed == 7 else (1, 4))
    # The video is the first file, the table of episodes the third.
    assert any("4 frames behind" in note for note in found.notes) == (1 <= renamed < 7)
    assert any("1 episode behind" in note for note in found.notes) == (3 <= renamed < 7)


WRITES = """
import pathlib, sys
from tests.support.recorded import FEATURES, RATE, episode
from urbanverse_mjx.datasets import DatasetWriter, writer
writer._WRITE_EVERY, writer._FILE_EPISODES = 0.0, 3
episodes = [episode(k) for k in range(3)]
with DatasetWriter(pathlib.Path(sys.argv[1]), FEATURES, RATE, "box") as out:
    for k in range(10_000):
        out.add(episodes[k % 3])
        print(out.num_episodes, flush=True)
"""


@pytest.mark.extended
def test_killed_at_any_moment_nothing_written_is_lost(tmp_path: pathlib.Path) -> None:
    draw = random.Random(0)
    for attempt in range(3):
        folder = tmp_path / str(attempt)
        with subprocess.Popen(
            [sys.executable, "-c", WRITES, str(folder)], stdout=subprocess.PIPE, text=True
        ) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(draw.uniform(0.0, 1.0))
            os.kill(process.pid, signal.SIGKILL)
            said = [1, *map(int, process.stdout.read().split())]
        found = check_dataset(folder)
        assert found.problems == ()
        # The last line may not have been printed.
        assert said[-1] <= found.episodes <= said[-1] + 1


@pytest.mark.parametrize("error", [errno.ENOSPC, errno.EFBIG])
def test_a_full_disk_loses_nothing_that_was_written(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, error: int
) -> None:
    folder = tmp_path / "new"

    def full(*_: object) -> None:
        raise OSError(error, os.strerror(error))

    def record() -> None:
        with DatasetWriter(folder, FEATURES, RATE, "box") as out:
            out.add(episode(0))
            before.update({p: p.read_bytes() for p in folder.rglob("*.*") if p.is_file()})
            monkeypatch.setattr(writer, "_write_by_episode", full)
            out.add(episode(1))

    before: dict[pathlib.Path, bytes] = {}
    monkeypatch.setattr(writer, "_WRITE_EVERY", 0.0)
    with pytest.raises(OSError, match=os.strerror(error)):
        record()
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before
    assert len(before) == 7
    assert check_dataset(folder).problems == ()


def test_ffmpeg_says_that_files_may_not_grow(tmp_path: pathlib.Path) -> None:
    """With the limit of a user's `ulimit -f`, in a process of its own."""
    code = (
        "import pathlib, resource, sys\n"
        "from tests.support.recorded import FRONT, RATE, episode\n"
        "from urbanverse_mjx.datasets.video import write_mp4\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
        "try:\n    write_mp4(pathlib.Path(sys.argv[1]), [episode(0).videos[FRONT]], RATE)\n"
        "except OSError as error:\n    print(error.errno)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.mp4")], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == str(errno.EFBIG), done.stderr


def test_a_folder_in_use_is_refused_and_an_unused_one_removed(tmp_path: pathlib.Path) -> None:
    (tmp_path / "file").write_text("mine")
    for used in (tmp_path, tmp_path / "file"):
        with pytest.raises(ValidationError, match="needed a new or empty folder"):
            DatasetWriter(used, FEATURES, RATE, "box")
    with DatasetWriter(tmp_path / "new", FEATURES, RATE, "box"):
        pass
    (tmp_path / "empty").mkdir()
    with DatasetWriter(tmp_path / "empty", FEATURES, RATE, "box"):
        pass
    assert sorted(p.name for p in tmp_path.iterdir()) == ["empty", "file"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"columns": {"action": np.zeros((4, 2))}}, "observation.state"),
        ({"columns": {**episode(0).columns, "action": np.zeros((4, 3))}}, r"episode.action: found shape \(4, 3\)"),
        ({"images": {DEPTH: episode(0).images[DEPTH][:3]}}, "needed one image a row"),
        ({"videos": {}}, FRONT),
    ],
)
def test_an_episode_that_does_not_fit_is_refused_and_not_written(
    tmp_path: pathlib.Path, change: dict[str, object], message: str
) -> None:
    good = episode(0)
    body = {name: getattr(good, name) for name in ("task", "columns", "images", "videos", "image_stats", "record")}
    with DatasetWriter(tmp_path / "new", FEATURES, RATE, "box") as out:
        out.add(good)
        with pytest.raises(ValidationError, match=message):
            out.add(Episode(**{**body, **change}))
        out.add(episode(1))
    found = check_dataset(tmp_path / "new")
    assert (found.episodes, found.problems) == (2, ())


def test_statistics_of_numbers_and_of_parts() -> None:
    rows = np.random.default_rng(0).normal(size=(50, 3)) * [1, 5, 0.1]
    whole, parts = (
        statistics.of_numbers(rows),
        statistics.merged(statistics.of_numbers(rows[:13]), statistics.of_numbers(rows[13:])),
    )
    np.testing.assert_allclose(whole["q10"], np.percentile(rows, 10, axis=0))
    for name in ("min", "max", "mean", "std", "count"):
        np.testing.assert_allclose(parts[name], whole[name])
    first, second = statistics.of_numbers(rows[:13]), statistics.of_numbers(rows[13:])
    np.testing.assert_array_equal(parts["q01"], np.minimum(first["q01"], second["q01"]))
    np.testing.assert_array_equal(parts["q99"], np.maximum(first["q99"], second["q99"]))


def test_statistics_of_columns_are_those_of_each() -> None:
    draw = np.random.default_rng(0)
    columns = {"a": draw.normal(size=(9, 3)), "b": draw.integers(-5, 5, 9), "c": draw.random((9, 2)) > 0.5}
    found = statistics.of_columns(columns)
    assert list(found) == list(columns)
    for name, column in columns.items():
        wanted = statistics.of_numbers(column)
        assert set(found[name]) == set(wanted)
        for key, value in wanted.items():
            np.testing.assert_array_equal(found[name][key], value)


def test_statistics_of_pixels() -> None:
    _check_pixels(np.random.default_rng(0).integers(3, 200, (5, 6, 7, 2), np.uint8), 256)
    _check_pixels(np.random.default_rng(0).choice([0, 7, 40_000, 65_535], (5, 6, 7, 1)).astype(np.uint16), 65536)


def _check_pixels(images: np.ndarray, values_of_pixels: int) -> None:
    channels = images.shape[-1]
    counts = statistics.PixelCounts(channels, values_of_pixels)
    for image in images:
        counts.add(image)
    found, values = counts.stats(255.0), images.reshape(-1, channels) / 255
    wanted = {"min": values.min(0), "max": values.max(0), "mean": values.mean(0), "std": values.std(0)}
    wanted["q50"] = np.quantile(values, 0.5, axis=0, method="inverted_cdf")
    for name, value in wanted.items():
        np.testing.assert_allclose(found[name], value.reshape(channels, 1, 1), atol=1e-12)
    assert found["count"] == [5]


def test_sizes_with_odd_sides_keep_their_colours() -> None:
    assert [video.pixel_format(*size) for size in ((135, 240), (136, 240), (136, 241))] == [
        "yuv444p",
        "yuv420p",
        "yuv444p",
    ]
