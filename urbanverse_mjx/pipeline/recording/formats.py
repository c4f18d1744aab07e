"""The formats of a recording: which sensors each stores, and its writer."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ...datatypes import validation as v

if TYPE_CHECKING:
    import pathlib

    from ...datasets import DatasetWriter, Feature
    from ...datasets.frame_files import FrameEpisode, FrameFolder
    from ...envs import NavEnv
    from .encoding import Filmed
    from .lidar import LidarOptions

Format = Literal["lerobot", "coco", "kitti", "mcap"]
#: Format -> what it always stores, and what else `--with` may add.
_STORED: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "coco": (("boxes",), ()),
    "kitti": (("boxes", "lidar", "camera_pose"), ()),
    "mcap": (("camera_pose",), ("boxes", "lidar", "imu", "odometry", "contacts")),
}


def stored(form: str, wanted: tuple[str, ...]) -> tuple[str, ...]:
    """The sensors that a recording in a format reads, for those asked for.

    Raises:
      ValidationError: one that the format cannot store.
    """
    if form not in _STORED:
        return wanted
    always, others = _STORED[form]
    for name in wanted:
        if name not in (*always, *others):
            only = ", ".join((*always, *others))
            raise v.fail("--with", repr(name), f"one of {only} for --format {form}", "take --format lerobot")
    return tuple(dict.fromkeys((*always, *wanted)))


def check_folder(folder: "pathlib.Path", form: str, resume: bool) -> None:
    """Raises an error before anything is loaded if the folder is in use, or not one that can be continued.

    Raises:
      ValidationError: see there.
    """
    from ...datasets.claims import has_episodes, require_new
    from ...datasets.features import INFO_PATH
    from ...datasets.frame_files import EPISODES

    if not resume:
        require_new(folder)
    else:
        has_episodes(folder, INFO_PATH if form == "lerobot" else EPISODES)


def image_type(form: str) -> str:
    """How colours are encoded: "h264", "jpg" or "png"."""
    return {"lerobot": "h264", "kitti": "png"}.get(form, "jpg")


def open_writer(
    folder: "pathlib.Path",
    form: str,
    size: tuple[int, int],
    lidar: "LidarOptions",
    features: "Mapping[str, Feature]",
    env: "NavEnv",
    origin: Mapping[str, Any],
    resume: bool,
) -> "DatasetWriter | FrameFolder":
    """The writer of the format, for a new folder, or with `resume` one that it continues.

    Args:
      form: name of the format.
      size: (height, width) of the images in pixels.
      origin: how the dataset was made, for its record.

    Raises:
      ValidationError: the folder is not empty or not one to continue, or the format needs a package that is not
        installed.
    """
    from ...datasets import DatasetWriter
    from ...datasets.coco import CocoWriter
    from ...datasets.frame_files import Rig
    from ...datasets.kitti import KittiWriter
    from ...datasets.mcap_files import McapWriter
    from .lidar import lidar_height
    from .readings import intrinsics

    rate = round(1.0 / env.dt)
    if form == "lerobot":
        return DatasetWriter(folder, features, rate, env.robot.name, origin, resume)
    lens = intrinsics(env.mj_model, env.robot.camera, *size)
    rig = Rig(
        *size,
        focal=(lens["fx"], lens["fy"]),
        centre=(lens["cx"], lens["cy"]),
        rate=rate,
        lidar=(0.0, 0.0, lidar_height(env, lidar)),
        categories=[name for name in env.bank.meta["categories"] if not name.startswith("ground:")],
    )
    writer = {"coco": CocoWriter, "kitti": KittiWriter, "mcap": McapWriter}[form]
    return writer(folder, rig, origin, resume)


def frame_episode(filmed: "Filmed", columns: Mapping[str, np.ndarray], record: Mapping[str, Any]) -> "FrameEpisode":
    """A driven and filmed episode as the formats of single frames take it."""
    from ...datasets.frame_files import FrameEpisode

    return FrameEpisode(filmed.colours, columns, filmed.annotations, filmed.scans, record)
