"""Converts external data to recordings, for `urbanverse gen import`."""

import pathlib
from collections.abc import Callable

from ...datatypes import Recording, Source
from ...datatypes import validation as v
from ...distillation.readers import Kitti360Options, read_authors_tree, read_colmap, read_kitti360
from .predictors import make_predictor
from .video_options import VideoOptions

Report = Callable[[int, int], None]


def import_kitti360(root: pathlib.Path, folder: pathlib.Path, options: Kitti360Options, report: Report) -> Recording:
    """Converts a section of a KITTI-360 sequence with its labels.

    Raises:
      ValidationError: see `read_kitti360`; or the folder is not empty.
    """
    _free(folder)
    return read_kitti360(root, folder, options, report)


def import_authors_tree(root: pathlib.Path, folder: pathlib.Path, video: VideoOptions, report: Report) -> Recording:
    """Converts a folder documented by UrbanVerse-Gen's authors; objects and surfaces are detected again.

    Raises:
      ValidationError: see `read_authors_tree` and `make_predictor`; or the folder is not empty.
    """
    _free(folder)
    source = Source(root.absolute().name, video.licence, video.city, video.country)
    return read_authors_tree(root, folder, make_predictor(video), source, video.rate, progress=report)


def import_colmap(root: pathlib.Path, folder: pathlib.Path, video: VideoOptions, report: Report) -> Recording:
    """Converts a COLMAP model with its images; objects, surfaces and depth are detected.

    Raises:
      ValidationError: see `read_colmap` and `make_predictor`; or the folder is not empty.
    """
    _free(folder)
    source = Source(root.absolute().name, video.licence, video.city, video.country)
    return read_colmap(root, folder, make_predictor(video), source, video.camera_height, video.rate, report)


def _free(folder: pathlib.Path) -> None:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise v.fail(str(folder), "something there already", "a new or empty folder", "choose another")
