"""`StoredDataset`: metadata and tables of a dataset on disk; rows of an interrupted write are kept separate."""

import dataclasses
import pathlib
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from ..datatypes import validation as v
from . import features as f


@dataclasses.dataclass(frozen=True)
class StoredDataset:
    """A dataset on disk.

    Attributes:
      folder: of the dataset.
      info: meta/info.json.
      features: of it.
      episodes: the rows of meta/episodes that `info` counts, without statistics.
      unfinished: later rows, left by an interrupted write.
    """

    folder: pathlib.Path
    info: dict[str, Any]
    features: dict[str, f.Feature]
    episodes: list[dict[str, Any]]
    unfinished: int

    @staticmethod
    def open(folder: str | pathlib.Path) -> "StoredDataset":
        """Reads the metadata of a dataset.

        Raises:
          ValidationError: the folder is no dataset, has another version, or its metadata cannot be read.
        """
        folder = pathlib.Path(folder)
        if (folder / f.UNFINISHED).is_dir() and not (folder / f.INFO_PATH).is_file():
            raise v.fail(str(folder), "a recording that ended before its first episode was written", "a dataset")
        info = v.read_json(folder / f.INFO_PATH, "LeRobotDataset v3")
        where = str(folder / f.INFO_PATH)
        if not isinstance(info, dict) or info.get("codebase_version") != f.CODEBASE_VERSION:
            version = info.get("codebase_version") if isinstance(info, dict) else info
            raise v.fail(where, f"codebase_version {v.show(version)}", repr(f.CODEBASE_VERSION))
        for name, minimum in (("fps", 1), ("total_episodes", 0), ("total_frames", 0), ("total_tasks", 0)):
            v.integer(info.get(name), f"{where}: {name}", minimum)
        features = info.get("features")
        if not isinstance(features, dict) or not set(f.INDEX_FEATURES) <= set(features):
            raise v.fail(
                f"{where}: features", v.show(features), f"those of LeRobot, with {', '.join(f.INDEX_FEATURES)}"
            )
        known = {name: f.Feature.from_json(body, f"{where}: {name}") for name, body in features.items()}
        rows: list[dict[str, Any]] = []
        for path in sorted((folder / "meta/episodes").glob("*/*.parquet")):
            rows += _without_stats(path).to_pylist()
        rows.sort(key=lambda row: row.get("episode_index", -1))
        total = info["total_episodes"]
        return StoredDataset(folder, info, known, rows[:total], max(len(rows) - total, 0))

    @property
    def rate(self) -> int:
        """Returns the frames per second."""
        return int(self.info["fps"])

    def data_path(self, episode: dict[str, Any]) -> pathlib.Path:
        """Returns the file of an episode's rows."""
        place = {key: episode[f"data/{key}"] for key in ("chunk_index", "file_index")}
        return self.folder / (self.info.get("data_path") or f.DATA_PATH).format(**place)

    def video_path(self, episode: dict[str, Any], name: str) -> pathlib.Path:
        """Returns the file of an episode's video of a camera."""
        place = {key: episode[f"videos/{name}/{key}"] for key in ("chunk_index", "file_index")}
        return self.folder / (self.info.get("video_path") or f.VIDEO_PATH).format(video_key=name, **place)

    @property
    def cameras(self) -> list[str]:
        """Returns the features that are videos."""
        return [name for name, feature in self.features.items() if feature.dtype == "video"]


def read_table(path: pathlib.Path, columns: list[str] | None = None) -> pa.Table:
    """Reads a parquet file.

    Raises:
      ValidationError: the file does not exist or pyarrow cannot read it.
    """
    try:
        return pq.read_table(path, columns=columns, partitioning=None)
    except (OSError, pa.ArrowException) as error:
        reason = " ".join(str(error).split())
        raise v.fail(str(path), f"a file that cannot be read ({reason})", "a parquet file") from error


def _without_stats(path: pathlib.Path) -> pa.Table:
    try:
        names = pq.read_schema(path).names
    except (OSError, pa.ArrowException) as error:
        raise v.fail(str(path), f"a file that cannot be read ({' '.join(str(error).split())})", "a table") from error
    return read_table(path, [name for name in names if not name.startswith("stats/")])
