"""`DatasetWriter`: writes episodes into a LeRobotDataset v3 that is valid at any time.

Files hold several episodes and are replaced by longer versions, each with a rename. meta/info.json is replaced last, so
its counts cover complete episodes only. If the process is killed between two renames, rows beyond those counts remain,
which readers ignore.
"""

import dataclasses
import functools
import json
import pathlib
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from .. import __version__
from ..datatypes import validation as v
from . import features as f
from . import statistics, video
from .annotations import SCHEMA as ANNOTATIONS
from .annotations import WITHOUT_VISIBLE, annotations_table
from .claims import Claim, continued, has_episodes
from .reading import StoredDataset, read_table

#: A new file begins after this many episodes, or bytes of one camera. Each new episode rewrites the current file, so
#: this bounds the cost per episode.
_FILE_EPISODES, _FILE_BYTES = 500, 64 * 2**20
#: s, least time between two writes, longer in proportion where the last one took longer than `_USUAL_WRITE`; episodes
#: that end within it are written together.
_WRITE_EVERY, _USUAL_WRITE = 1.0, 0.1


@dataclasses.dataclass
class _File:
    """Episodes in the current file; `number` is the file's index in the dataset."""

    number: int
    first_row: int
    tables: list[pa.Table] = dataclasses.field(default_factory=list)
    annotations: list[pa.Table] = dataclasses.field(default_factory=list)
    rows: list[dict[str, Any]] = dataclasses.field(default_factory=list)
    videos: dict[str, list[bytes]] = dataclasses.field(default_factory=dict)
    image_bytes: int = 0

    @classmethod
    def read(
        cls, folder: pathlib.Path, number: int, rows: list[dict[str, Any]], schema: pa.Schema, cameras: list[str]
    ) -> "_File":
        """The complete episodes of a file on disk.

        Args:
          number: of the file.
          rows: of these episodes in meta/episodes.
          schema: of the data, as it was written: files name the items of lists otherwise.
          cameras: names of the videos.

        Raises:
          ValidationError: an earlier version recorded it, with less.
        """
        own = cls(number, rows[0]["dataset_from_index"], rows=rows)
        data = pq.ParquetFile(folder / f.DATA_PATH.format(**own.place))
        own.tables = [data.read_row_group(k).cast(schema) for k in range(len(rows))]
        seen = folder / f.ANNOTATIONS_PATH.format(**own.place)
        if seen.is_file():
            stored = pq.ParquetFile(seen)
            if stored.schema_arrow == WITHOUT_VISIBLE:
                said = "objects without `visible`, as earlier versions recorded them"
                raise v.fail(f"--resume: {seen}", said, "those of this version", "record into another folder")
            own.annotations = [stored.read_row_group(k).cast(ANNOTATIONS) for k in range(len(rows))]
        frames = sum(row["length"] for row in rows)
        for name in cameras:
            path = folder / f.VIDEO_PATH.format(video_key=name, **own.place)
            own.videos[name] = [video.read_encoded(path, frames)]
        for field in schema:
            if pa.types.is_struct(field.type):
                sizes = (pc.binary_length(pc.struct_field(table[field.name], "bytes")) for table in own.tables)
                own.image_bytes += sum(pc.sum(size).as_py() for size in sizes)
        return own

    @property
    def place(self) -> dict[str, int]:
        return {"chunk_index": self.number // f.CHUNK_SIZE, "file_index": self.number % f.CHUNK_SIZE}

    @property
    def full(self) -> bool:
        largest = max((sum(map(len, parts)) for parts in self.videos.values()), default=0)
        return len(self.rows) >= _FILE_EPISODES or max(largest, self.image_bytes) >= _FILE_BYTES


class DatasetWriter:
    """Writes a dataset, episode by episode; as a context manager it writes pending episodes when the block ends.

    Args:
      folder: new or empty.
      features: name -> `Feature`, without those that every dataset has.
      frames_per_second: of all cameras and rows.
      robot: name of the robot.
      origin: JSON object for meta/urbanverse.json.
      resume: whether the folder may hold a dataset of this class with the same arguments, to which episodes are added:
        its files are then those of one uninterrupted writing.

    Attributes:
      records: of the episodes that a resumed dataset has, their rows in meta/episodes.

    Raises:
      ValidationError: the folder is not empty or in use; with `resume`, it holds something else or differs.
    """

    def __init__(
        self,
        folder: pathlib.Path,
        features: Mapping[str, f.Feature],
        frames_per_second: int,
        robot: str,
        origin: Mapping[str, Any] | None = None,
        resume: bool = False,
    ) -> None:
        begun = resume and has_episodes(folder, f.INFO_PATH)
        self.folder, self.features = folder, {**features, **f.INDEX_FEATURES}
        self._rate, self._robot, self._origin = frames_per_second, robot, dict(origin or {})
        self._tasks: dict[str, int] = {}
        self._stats: dict[str, statistics.Stats] = {}
        self._file = _File(0, 0)
        self._unwritten, self._next_write = 0, -np.inf
        self.num_episodes = self.num_frames = 0
        self.records: list[dict[str, Any]] = []
        self._claim = Claim(folder, resume)
        self._staging = self._claim.staging
        if begun:
            try:
                self._restore(StoredDataset.open(folder))
            except BaseException:
                self._claim.release()
                raise

    def _restore(self, dataset: StoredDataset) -> None:
        """Takes over the complete episodes of a dataset; what is behind them is removed or written anew."""
        had = {name: feature.to_json() for name, feature in dataset.features.items()}
        own = json.loads(json.dumps({name: feature.to_json() for name, feature in self.features.items()}))
        if had != own:
            differing = sorted(name for name in {*had, *own} if had.get(name) != own.get(name))
            raise v.fail(
                "--resume", f"another {', '.join(differing)}", f"the features of {self.folder}", "repeat its command"
            )
        if (dataset.rate, dataset.info.get("robot_type")) != (self._rate, self._robot):
            said = f"{self._robot} at {self._rate} Hz"
            raise v.fail("--resume", said, f"{dataset.info.get('robot_type')} at {dataset.rate} Hz")
        self._origin = continued(self.folder / f.ORIGIN_PATH, self._origin, len(dataset.episodes))
        tasks = read_table(self.folder / f.TASKS_PATH).to_pylist()
        self._tasks = {row["task"]: row["task_index"] for row in tasks[: dataset.info["total_tasks"]]}
        self.records = dataset.episodes
        rows: list[dict[str, Any]] = []
        last = 0
        for path in sorted((self.folder / "meta/episodes").glob("*/*.parquet")):
            stored = [row for row in read_table(path).to_pylist() if row["episode_index"] < len(dataset.episodes)]
            for row in stored:
                self._take_stats(_stats_of(row))
            if stored:
                rows = stored
                last = rows[0]["data/chunk_index"] * f.CHUNK_SIZE + rows[0]["data/file_index"]
        self.num_episodes, self.num_frames = len(dataset.episodes), dataset.info["total_frames"]
        if not rows:
            return
        try:
            self._file = _File.read(self.folder, last, rows, self._schema, dataset.cameras)
        except (OSError, pa.ArrowException) as error:
            reason = " ".join(str(error).split())
            raise v.fail(str(self.folder), f"a file that cannot be read ({reason})", "a sound dataset") from error
        if self._file.full:
            self._file = _File(last + 1, self.num_frames)
        else:
            # Rows of an interrupted write are left out.
            self._unwritten = 1
        self._remove_file(last + 1)

    def _remove_file(self, number: int) -> None:
        """Removes the file of each kind with this number, which has no complete episode. No later ones exist: a file
        begins after an episode of the one before it is complete."""
        place = _File(number, 0).place
        names = [name.format(**place) for name in (f.DATA_PATH, f.ANNOTATIONS_PATH, f.EPISODES_PATH)]
        cameras = [name for name, feature in self.features.items() if feature.dtype == "video"]
        names += [f.VIDEO_PATH.format(video_key=name, **place) for name in cameras]
        for name in names:
            (self.folder / name).unlink(missing_ok=True)

    def __enter__(self) -> "DatasetWriter":
        return self

    def __exit__(self, kind: Any, error: BaseException | None, at: Any) -> None:
        try:
            # If the disk is full, nothing more is written.
            if not isinstance(error, OSError):
                self.write()
        finally:
            self._claim.release()

    def add(self, episode: f.Episode) -> None:
        """Adds an episode. It is on disk when this returns, or with those of the next second if episodes arrive faster
        (of the next seconds, where writing a file takes more than a tenth of one).

        Raises:
          ValidationError: columns or images differ from the features, or their lengths differ.
          OSError: the episode cannot be written; earlier episodes stay complete.
        """
        columns = self._columns(episode)
        file, length = self._file, len(episode)
        own = statistics.of_columns(columns)
        own |= {name: dict(stats) for name, stats in episode.image_stats.items()}
        file.tables.append(self._table(columns, episode))
        if episode.annotations:
            file.annotations.append(annotations_table(episode.annotations, self.num_frames))
        file.rows.append(self._row(episode, own))
        for name, encoded in episode.videos.items():
            file.videos.setdefault(name, []).append(encoded)
        file.image_bytes += sum(len(image) for images in episode.images.values() for image in images)
        self._take_stats(own)
        self.num_episodes, self.num_frames = self.num_episodes + 1, self.num_frames + length
        self._unwritten += 1
        if file.full or time.monotonic() >= self._next_write:
            self.write()
        if file.full:
            self._file = _File(file.number + 1, self.num_frames)

    def _take_stats(self, own: Mapping[str, statistics.Stats]) -> None:
        """Merges an episode's statistics into those of the dataset."""
        for name, stats in own.items():
            self._stats[name] = statistics.merged(self._stats[name], stats) if name in self._stats else stats

    def _columns(self, episode: f.Episode) -> dict[str, np.ndarray]:
        """Returns the episode's numbers by feature, in the features' order."""
        length, first = len(episode), self.num_frames
        frame = np.arange(length)
        task = self._tasks.setdefault(episode.task, len(self._tasks))
        given = {
            **episode.columns,
            "timestamp": frame / self._rate,
            "frame_index": frame,
            "episode_index": np.full(length, self.num_episodes),
            "index": first + frame,
            "task_index": np.full(length, task),
        }
        lengths = {name: len(images) for name, images in episode.images.items()}
        numbers = {name for name, feature in self.features.items() if not feature.is_image}
        wanted = {
            form: {name for name, feature in self.features.items() if feature.dtype == form}
            for form in ("image", "video")
        }
        if (set(given), set(lengths), set(episode.videos)) != (numbers, wanted["image"], wanted["video"]):
            found = sorted({*given, *lengths, *episode.videos} ^ set(self.features))
            raise v.fail("episode", f"columns and images that differ from the features ({', '.join(found)})", "these")
        columns = {
            name: np.asarray(given[name], feature.dtype)
            for name, feature in self.features.items()
            if not feature.is_image
        }
        for name, column in columns.items():
            shape = self.features[name].shape
            if column.shape != (length, *(() if shape == (1,) else shape)):
                raise v.fail(f"episode.{name}", f"shape {column.shape}", f"{length} rows of {shape}")
        lengths |= {"annotations": len(episode.annotations)} if episode.annotations else {}
        if not length or any(n != length for n in lengths.values()):
            raise v.fail("episode", f"{length} rows and images {lengths}", "one image a row, at least one")
        return columns

    @functools.cached_property
    def _schema(self) -> pa.Schema:
        """Of the data files."""
        stored = {name: feature.arrow_type for name, feature in self.features.items() if feature.dtype != "video"}
        return pa.schema(list(stored.items()))

    def _table(self, columns: Mapping[str, np.ndarray], episode: f.Episode) -> pa.Table:
        arrays = []
        for field in self._schema:
            name, feature = field.name, self.features[field.name]
            if feature.dtype == "image":
                rows: Any = [{"bytes": image, "path": None} for image in episode.images[name]]
                arrays.append(pa.array(rows, field.type))
            elif feature.shape == (1,):
                arrays.append(pa.array(columns[name], field.type))
            else:
                arrays.append(pa.FixedSizeListArray.from_arrays(pa.array(columns[name].ravel()), feature.shape[0]))
        return pa.Table.from_arrays(arrays, schema=self._schema)

    def _row(self, episode: f.Episode, stats: Mapping[str, statistics.Stats]) -> dict[str, Any]:
        """Returns the episode's row in meta/episodes."""
        file, first, length = self._file, self.num_frames, len(episode)
        row: dict[str, Any] = {"episode_index": self.num_episodes, "tasks": [episode.task], "length": length}
        row |= {f"data/{name}": number for name, number in file.place.items()}
        row |= {"dataset_from_index": first, "dataset_to_index": first + length}
        for name in episode.videos:
            row |= {f"videos/{name}/{key}": number for key, number in file.place.items()}
            row[f"videos/{name}/from_timestamp"] = (first - file.first_row) / self._rate
            row[f"videos/{name}/to_timestamp"] = (first + length - file.first_row) / self._rate
        row |= episode.record
        row |= {f"stats/{name}/{key}": x.tolist() for name, body in stats.items() for key, x in body.items()}
        return row | {f"meta/episodes/{name}": number for name, number in file.place.items()}

    def write(self) -> None:
        """Writes all pending episodes to disk.

        Raises:
          OSError: the files cannot be written; existing files are unchanged.
        """
        if not self._unwritten:
            return
        began = time.monotonic()
        staged = self._stage()
        for part, path in staged:
            path.parent.mkdir(parents=True, exist_ok=True)
            part.replace(path)
        for folder in {path.parent for _, path in staged}:
            v.sync(folder)
        self._unwritten, now = 0, time.monotonic()
        self._next_write = now + _WRITE_EVERY * max(1.0, (now - began) / _USUAL_WRITE)

    def _stage(self) -> list[tuple[pathlib.Path, pathlib.Path]]:
        """Writes new versions of all files that change; returns them and their destinations, meta/info.json last."""
        file, staged = self._file, []

        def stage(name: str, write: Callable[[pathlib.Path], Any]) -> None:
            part = self._staging / f"{len(staged)}{pathlib.Path(name).suffix}"
            write(part)
            v.sync(part)
            staged.append((part, self.folder / name))

        def text(value: Any) -> Callable[[pathlib.Path], Any]:
            body = json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
            return lambda part: part.write_text(body, encoding="utf-8")

        for name, parts in file.videos.items():
            stage(
                f.VIDEO_PATH.format(video_key=name, **file.place),
                lambda part, parts=parts: video.write_mp4(part, parts, self._rate),
            )
        stage(f.DATA_PATH.format(**file.place), lambda part: _write_by_episode(part, file.tables))
        if file.annotations:
            stage(f.ANNOTATIONS_PATH.format(**file.place), lambda part: _write_by_episode(part, file.annotations))
        rows = pa.Table.from_pylist(file.rows)
        stage(f.EPISODES_PATH.format(**file.place), lambda part: _write_by_episode(part, [rows]))
        stage(f.TASKS_PATH, lambda part: _write_by_episode(part, [_tasks_table(self._tasks)]))
        stage(f.STATS_PATH, text({n: {k: x.tolist() for k, x in body.items()} for n, body in self._stats.items()}))
        stage(f.ORIGIN_PATH, text(self._origin))
        stage(f.INFO_PATH, text(self._info()))
        return staged

    def _info(self) -> dict[str, Any]:
        has_video = any(feature.dtype == "video" for feature in self.features.values())
        return {
            "codebase_version": f.CODEBASE_VERSION,
            "fps": self._rate,
            "features": {name: feature.to_json() for name, feature in self.features.items()},
            "total_episodes": self.num_episodes,
            "total_frames": self.num_frames,
            "total_tasks": len(self._tasks),
            "chunks_size": f.CHUNK_SIZE,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "data_path": f.DATA_PATH,
            "video_path": f.VIDEO_PATH if has_video else None,
            "robot_type": self._robot,
            "splits": {"train": f"0:{self.num_episodes}"},
        }


def _write_by_episode(path: pathlib.Path, tables: list[pa.Table]) -> None:
    """Writes a parquet file with one row group for each table."""
    with pq.ParquetWriter(path, tables[0].schema, compression="snappy", use_dictionary=True) as writer:
        for table in tables:
            writer.write_table(table)


def _stats_of(row: Mapping[str, Any]) -> dict[str, statistics.Stats]:
    """The statistics by feature in a row of meta/episodes."""
    found: dict[str, statistics.Stats] = {}
    for column, value in row.items():
        if column.startswith("stats/"):
            name, _, key = column.removeprefix("stats/").rpartition("/")
            found.setdefault(name, {})[key] = np.array(value)
    return found


def _tasks_table(tasks: Mapping[str, int]) -> pa.Table:
    """Returns the tasks as pandas stores a frame indexed by the sentence, which LeRobot uses for look-ups."""
    table = pa.table({"task_index": pa.array(tasks.values(), pa.int64()), "task": pa.array(tasks, pa.string())})
    columns = [
        {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": stored, "metadata": None}
        for name, kind, stored in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ]
    described = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": columns,
        "creator": {"library": "urbanverse_mjx", "version": __version__},
        "pandas_version": "2.0.0",
    }
    return table.replace_schema_metadata({"pandas": json.dumps(described)})
