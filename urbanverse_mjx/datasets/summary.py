"""`summarise_dataset`: summary statistics of a dataset."""

import collections
import dataclasses
import pathlib
from typing import Any

import numpy as np

from ..datatypes import validation as v
from . import features as f
from .reading import StoredDataset


@dataclasses.dataclass(frozen=True)
class DatasetSummary:
    """Summary of a dataset.

    Attributes:
      folder: of the dataset.
      robot: name of the robot.
      frames_per_second: of rows and videos.
      episodes, frames: their numbers.
      hours: duration of all episodes.
      megabytes: size of all files, in 10^6 bytes.
      length: min, median and max of an episode's frames, by these names.
      results: result -> number of episodes.
      scenes: name -> number of episodes.
      tasks: task sentences.
      features: name -> dtype, shape and, for numbers, min, mean, max and std by component.
    """

    folder: str
    robot: str | None
    frames_per_second: int
    episodes: int
    frames: int
    hours: float
    megabytes: float
    length: dict[str, float]
    results: dict[str, int]
    scenes: dict[str, int]
    tasks: list[str]
    features: dict[str, dict[str, Any]]


def summarise_dataset(folder: str | pathlib.Path) -> DatasetSummary:
    """Reads a dataset's metadata, without its rows and videos.

    Raises:
      ValidationError: the folder is no LeRobotDataset v3.
    """
    dataset = StoredDataset.open(folder)
    stats = v.read_json(dataset.folder / f.STATS_PATH, "statistics")
    lengths = [row["length"] for row in dataset.episodes]
    spread = {"min": np.min, "median": np.median, "max": np.max}
    features = {}
    for name, feature in dataset.features.items():
        features[name] = {"dtype": feature.dtype, "shape": list(feature.shape)}
        if feature.names and not feature.is_image:
            features[name]["names"] = list(feature.names)
        body = stats.get(name) or {}
        features[name] |= {k: np.ravel(body[k]).tolist() for k in ("min", "mean", "max", "std") if k in body}
    return DatasetSummary(
        folder=str(dataset.folder),
        robot=dataset.info.get("robot_type"),
        frames_per_second=dataset.rate,
        episodes=len(lengths),
        frames=sum(lengths),
        hours=sum(lengths) / dataset.rate / 3600.0,
        megabytes=sum(p.stat().st_size for p in dataset.folder.rglob("*") if p.is_file()) / 1e6,
        length={name: float(of(lengths)) for name, of in spread.items()} if lengths else {},
        results=_counted(dataset, "result"),
        scenes=_counted(dataset, "scene"),
        tasks=sorted({task for row in dataset.episodes for task in row.get("tasks") or []}),
        features=features,
    )


def _counted(dataset: StoredDataset, name: str) -> dict[str, int]:
    """Returns how often each value of a column of meta/episodes occurs; empty for other tools' datasets without it."""
    return dict(sorted(collections.Counter(row[name] for row in dataset.episodes if name in row).items()))
