"""Writes and checks datasets of episodes in the LeRobotDataset v3 format with pyarrow and ffmpeg, without torch."""

from .checking import Findings, check_dataset
from .features import Episode, Feature
from .page import dataset_page
from .reading import StoredDataset
from .summary import DatasetSummary, summarise_dataset
from .writer import DatasetWriter

__all__ = [
    "DatasetSummary",
    "DatasetWriter",
    "Episode",
    "Feature",
    "Findings",
    "StoredDataset",
    "check_dataset",
    "dataset_page",
    "summarise_dataset",
]
