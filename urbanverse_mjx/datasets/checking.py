"""`check_dataset`: checks that the files of a dataset are consistent, and lists every problem with its location."""

import dataclasses
import pathlib
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pyarrow as pa

from ..datatypes import ValidationError
from ..datatypes import validation as v
from . import features as f
from . import own_checks, video
from .annotations import WITHOUT_VISIBLE, check_annotations
from .reading import StoredDataset, read_table

#: Tolerances for rounding: s between a row's timestamp and its index, and relative differences of statistics.
_TIME_ERROR, _STATS_ERROR = 1e-4, 1e-5


@dataclasses.dataclass(frozen=True)
class Findings:
    """Result of a check.

    Attributes:
      episodes, frames: number of complete ones.
      problems: one sentence each; empty for a valid dataset.
      notes: remains of an interrupted recording, which readers ignore, and what earlier versions did not record.
    """

    episodes: int
    frames: int
    problems: tuple[str, ...]
    notes: tuple[str, ...]


def check_dataset(folder: str | pathlib.Path) -> Findings:
    """Compares counts, rows, timestamps, numbers and videos of a dataset with its metadata; changes nothing.

    Raises:
      ValidationError: the folder is no LeRobotDataset v3.
    """
    dataset = StoredDataset.open(folder)
    problems, notes = [*_counts(dataset), *_tasks(dataset)], []
    found: dict[str, list[np.ndarray]] = {}
    if not problems:
        problems += [*_data(dataset, found), *_videos(dataset, notes), *_annotations(dataset, notes)]
    if not problems and not dataset.unfinished:
        problems += _stats(dataset, found)
    if dataset.unfinished:
        notes.append(
            f"{v.counted(dataset.unfinished, 'episodes')} behind the last complete one, of an interrupted writing"
        )
    if (dataset.folder / f.UNFINISHED).is_dir():
        notes.append(f"{f.UNFINISHED}: files of a recording that is under way or was interrupted")
    if not dataset.episodes:
        problems.append("no complete episode")
    return Findings(len(dataset.episodes), dataset.info["total_frames"], tuple(problems), tuple(notes))


def _counts(dataset: StoredDataset) -> Iterator[str]:
    """Returns the numbers of episodes and frames."""
    total = dataset.info["total_episodes"]
    if len(dataset.episodes) != total:
        yield f"meta/episodes: found {len(dataset.episodes)} episodes, needed {total}, as meta/info.json counts"
    keys = ["episode_index", "length", "dataset_from_index", "dataset_to_index", "data/chunk_index", "data/file_index"]
    for name in dataset.cameras:
        keys += [f"videos/{name}/{k}" for k in ("chunk_index", "file_index", "from_timestamp", "to_timestamp")]
    first = 0
    for number, row in enumerate(dataset.episodes):
        absent = [key for key in keys if not isinstance(row.get(key), int | float)]
        if absent:
            yield f"meta/episodes: episode {number}: found no number in {', '.join(absent)}"
            return
        place = row["episode_index"], row["dataset_from_index"], row["dataset_to_index"]
        if place != (number, first, first + row["length"]) or row["length"] < 1:
            yield (
                f"meta/episodes: found episode {place[0]} with rows {place[1]} to {place[2]} and length "
                f"{row['length']}, needed episode {number} from row {first} on"
            )
            return
        first += row["length"]
    if first != dataset.info["total_frames"]:
        yield f"meta/episodes: found {first} frames, needed {dataset.info['total_frames']}, as meta/info.json counts"


def _tasks(dataset: StoredDataset) -> Iterator[str]:
    try:
        table = read_table(dataset.folder / f.TASKS_PATH)
    except ValidationError as error:
        yield str(error)
        return
    if not {"task", "task_index"} <= set(table.column_names):
        yield f"{f.TASKS_PATH}: found columns {', '.join(table.column_names)}, needed task and task_index"
    elif sorted(table["task_index"].to_pylist())[: dataset.info["total_tasks"]] != [
        *range(dataset.info["total_tasks"])
    ]:
        yield f"{f.TASKS_PATH}: found {table.num_rows} tasks, needed those of 0 to {dataset.info['total_tasks'] - 1}"


def _files(dataset: StoredDataset) -> dict[pathlib.Path, list[dict[str, Any]]]:
    """Returns the episodes by data file."""
    files: dict[pathlib.Path, list[dict[str, Any]]] = {}
    for row in dataset.episodes:
        files.setdefault(dataset.data_path(row), []).append(row)
    return files


def _data(dataset: StoredDataset, found: dict[str, list[np.ndarray]]) -> Iterator[str]:
    """Checks rows, timestamps and numbers; collects the columns in `found`."""
    stored = {name: feature for name, feature in dataset.features.items() if feature.dtype != "video"}
    # In datasets from elsewhere features of the same names may have other meanings.
    own = (dataset.folder / f.ORIGIN_PATH).is_file()
    for path, rows in _files(dataset).items():
        where = str(path.relative_to(dataset.folder))
        try:
            table = read_table(path)
        except ValidationError as error:
            yield str(error)
            continue
        if set(table.column_names) != set(stored):
            differing = sorted(set(table.column_names) ^ set(stored))
            yield f"{where}: found columns that differ from the features: {', '.join(differing)}"
            continue
        wanted = sum(row["length"] for row in rows)
        if table.num_rows < wanted:
            yield f"{where}: found {table.num_rows} rows, needed {wanted} of {len(rows)} episodes"
            continue
        table = table.slice(0, wanted)
        columns = {}
        for name, feature in stored.items():
            if feature.dtype == "image":
                yield from _images(name, table[name], rows, feature, where, own)
                continue
            columns[name] = _numbers(table[name], feature)
            if columns[name] is None:
                yield f"{where}: {name}: found {table[name].type}, needed {feature.dtype} of shape {feature.shape}"
        if any(column is None for column in columns.values()):
            continue
        yield from _values(columns, rows, dataset.rate, dataset.info["total_tasks"], where)
        for name, column in columns.items() if own else ():
            yield from own_checks.check_column(name, column, where)
        for name, column in columns.items():
            found.setdefault(name, []).append(column.reshape(len(column), -1))


def _annotations(dataset: StoredDataset, notes: list[str]) -> Iterator[str]:
    """Checks the files of annotations, of which there is one for each data file or none; notes those of earlier
    versions."""
    front = next((feature for feature in dataset.features.values() if feature.is_image), None)
    if front is None or not (dataset.folder / "annotations").is_dir():
        return
    for rows in _files(dataset).values():
        place = {key: rows[0][f"data/{key}"] for key in ("chunk_index", "file_index")}
        name = f.ANNOTATIONS_PATH.format(**place)
        try:
            table = read_table(dataset.folder / name)
        except ValidationError as error:
            yield str(error)
            continue
        wanted = sum(row["length"] for row in rows)
        if table.schema == WITHOUT_VISIBLE:
            notes.append(f"{name}: objects without `visible`, as earlier versions recorded them")
        yield from check_annotations(
            table, rows[0]["dataset_from_index"], wanted, (front.shape[0], front.shape[1]), name
        )


def _numbers(column: pa.ChunkedArray, feature: f.Feature) -> Any:
    """Returns a column (T, ...) as an array, or None if it has another type or missing values."""
    wanted, kind = feature.arrow_type, column.type
    as_list = pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind)
    if column.null_count or (
        kind.value_type != wanted.value_type if as_list and feature.shape != (1,) else kind != wanted
    ):
        return None
    if feature.shape == (1,):
        return column.to_numpy()
    flat = np.concatenate([chunk.flatten().to_numpy(zero_copy_only=False) for chunk in column.chunks] or [np.zeros(0)])
    return flat.reshape(-1, feature.shape[0]) if len(flat) == len(column) * feature.shape[0] else None


def _values(
    columns: dict[str, np.ndarray], rows: list[dict[str, Any]], rate: int, tasks: int, where: str
) -> Iterator[str]:
    lengths = [row["length"] for row in rows]
    frame = np.concatenate([np.arange(n) for n in lengths])
    first = rows[0]["dataset_from_index"]
    expected = {
        "frame_index": frame,
        "episode_index": np.repeat([row["episode_index"] for row in rows], lengths),
        "index": first + np.arange(len(frame)),
    }
    for name, numbers in expected.items():
        wrong = np.flatnonzero(columns[name] != numbers)
        if len(wrong):
            k = wrong[0]
            yield f"{where}: row {k}: found {name} {columns[name][k]}, needed {numbers[k]}"
    late = np.abs(columns["timestamp"] - frame / rate)
    if not (late <= _TIME_ERROR).all():
        k = int(np.argmax(~(late <= _TIME_ERROR)))
        yield f"{where}: row {k}: found timestamp {columns['timestamp'][k]:g} s, needed {frame[k] / rate:g} s"
    if (columns["task_index"] < 0).any() or (columns["task_index"] >= tasks).any():
        yield f"{where}: found a task_index outside 0 to {tasks - 1}"
    for name, column in columns.items():
        if not np.isfinite(column).all():
            k = int(np.argmax(~np.isfinite(column.reshape(len(column), -1)).all(1)))
            yield f"{where}: row {k}: {name}: found a number that is not finite"
    for name in ("action", "applied_action"):
        if name in columns and not (np.abs(columns[name]) <= 1.0).all():
            yield f"{where}: {name}: found an action outside [-1, 1]"


def _images(
    name: str, column: pa.ChunkedArray, rows: list[dict[str, Any]], feature: f.Feature, where: str, own: bool
) -> Iterator[str]:
    """Checks the first and the last image of every episode."""
    end = 0
    for row in rows:
        begin, end = end, end + row["length"]
        for k in (begin, end - 1):
            stored = column[k].as_py()
            body = (stored or {}).get("bytes") or b""
            image = cv2.imdecode(np.frombuffer(body, np.uint8), cv2.IMREAD_UNCHANGED) if body else None
            shape = None if image is None else (*image.shape, 1)[:3]
            if shape != feature.shape:
                yield f"{where}: {name}: row {k}: found an image of shape {shape}, needed {feature.shape}"
            elif image is not None and own:
                yield from own_checks.check_image(name, image, f"{where}: {name}: row {k}")


def _videos(dataset: StoredDataset, notes: list[str]) -> Iterator[str]:
    """Compares length and size of videos with the rows of their episodes; notes frames that readers ignore."""
    for name in dataset.cameras:
        files: dict[pathlib.Path, list[dict[str, Any]]] = {}
        for row in dataset.episodes:
            files.setdefault(dataset.video_path(row, name), []).append(row)
        for path, rows in files.items():
            where, needed = str(path.relative_to(dataset.folder)), sum(row["length"] for row in rows)
            if not path.is_file():
                yield f"{where}: found no such file, needed a video of {needed} frames"
                continue
            try:
                frames = video.count_frames(path)
            except ValidationError as error:
                yield str(error)
                continue
            if frames > needed and rows[-1] is dataset.episodes[-1]:
                notes.append(f"{where}: {v.counted(frames - needed, 'frames')} behind the last complete episode")
            elif frames != needed:
                yield f"{where}: found {frames} frames, needed {needed} of {len(rows)} episodes"
            yield from _form(path, dataset.features[name], dataset.rate, where)
            begin = 0
            for row in rows:
                times = [row[f"videos/{name}/{key}"] * dataset.rate for key in ("from_timestamp", "to_timestamp")]
                if np.abs(np.subtract(times, (begin, begin + row["length"]))).max() > _TIME_ERROR * dataset.rate:
                    yield (
                        f"meta/episodes: episode {row['episode_index']}: found frames {times[0]:g} to {times[1]:g} of "
                        f"{where}, needed {begin} to {begin + row['length']}"
                    )
                begin += row["length"]


def _form(path: pathlib.Path, feature: f.Feature, rate: int, where: str) -> Iterator[str]:
    capture = cv2.VideoCapture(str(path))
    try:
        wanted = {"height": (cv2.CAP_PROP_FRAME_HEIGHT, feature.shape[0])}
        wanted |= {"width": (cv2.CAP_PROP_FRAME_WIDTH, feature.shape[1])}
        wanted |= {"frames a second": (cv2.CAP_PROP_FPS, rate)}
        for name, (key, value) in wanted.items():
            if abs(capture.get(key) - value) > 1e-3:
                yield f"{where}: found {name} {capture.get(key):g}, needed {value}"
    finally:
        capture.release()


def _stats(dataset: StoredDataset, found: dict[str, list[np.ndarray]]) -> Iterator[str]:
    """Compares meta/stats.json with the columns."""
    try:
        stats = v.read_json(dataset.folder / f.STATS_PATH, "statistics")
    except ValidationError as error:
        yield str(error)
        return
    for name, parts in found.items():
        rows = np.concatenate(parts).astype(np.float64)
        own = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0), "count": [len(rows)]}
        body = stats.get(name) if isinstance(stats, dict) else None
        for key, value in own.items():
            try:
                close = np.allclose(np.asarray((body or {})[key], float), value, rtol=_STATS_ERROR, atol=1e-6)
            except (KeyError, TypeError, ValueError):
                close = False
            if not close:
                yield f"{f.STATS_PATH}: {name}: found another {key} than that of the rows, {np.asarray(value).tolist()}"
