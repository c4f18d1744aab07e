"""Episodes as files of single frames, from which the formats COCO, KITTI and MCAP are written."""

import dataclasses
import json
import pathlib
import shutil
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import validation as v
from . import features as f
from .annotations import Annotation
from .writer import require_new

#: s, least time between two versions of the files that list all frames, longer in proportion where writing them took
#: longer than `_USUAL_LIST`.
_LIST_EVERY, _USUAL_LIST = 1.0, 0.05
ORIGIN = "urbanverse.json"


@dataclasses.dataclass(frozen=True)
class Rig:
    """What is the same in all frames.

    Attributes:
      height, width: pixels. focal, centre: (2,) pixels, the camera's pinhole parameters.
      rate: frames a second.
      lidar: (3,) m, the LiDAR's origin in the frame of the robot's root body, whose axes it has.
      categories: of objects, all that may occur.
    """

    height: int
    width: int
    focal: tuple[float, float]
    centre: tuple[float, float]
    rate: int
    lidar: tuple[float, float, float]
    categories: Sequence[str]

    @property
    def matrix(self) -> np.ndarray:
        """(3, 3) K: points in the camera's frame (x right, y down, z ahead) -> pixels."""
        return np.array([[self.focal[0], 0, self.centre[0]], [0, self.focal[1], self.centre[1]], [0, 0, 1.0]])


@dataclasses.dataclass(frozen=True)
class FrameEpisode:
    """One episode of T frames.

    Attributes:
      colours: T files of the format's image type.
      columns: name -> (T, ...), as in the LeRobot format; `pose` (7,) and `pose.camera` (7,) always.
      annotations: T of them, or none.
      scans: T point clouds (n, 3) m in the LiDAR's frame, or none.
      record: scene, result and more.
    """

    colours: Sequence[bytes]
    columns: Mapping[str, np.ndarray]
    annotations: Sequence[Annotation]
    scans: Sequence[np.ndarray]
    record: Mapping[str, Any]

    def __len__(self) -> int:
        return len(self.colours)


class FrameFolder:
    """A new folder to which episodes are added; files of an episode are staged and moved into place together, and the
    list of frames is replaced after them, so that what it names is complete whenever the process is killed.

    Args:
      folder: new or empty.
      rig: see there.
      origin: JSON object for urbanverse.json.

    Raises:
      ValidationError: the folder is not empty.
    """

    #: "png" or "jpg".
    image_type = "png"

    def __init__(self, folder: pathlib.Path, rig: Rig, origin: Mapping[str, Any]) -> None:
        require_new(folder)
        self.folder, self.rig = folder, rig
        self.num_episodes = self.num_frames = 0
        self._listed, self._next_list = 0, -np.inf
        self._origin, self._made = dict(origin), not folder.exists()
        self._staging = folder / f.UNFINISHED
        self._staging.mkdir(parents=True)

    def __enter__(self) -> "FrameFolder":
        return self

    def __exit__(self, kind: Any, error: BaseException | None, at: Any) -> None:
        try:
            if not isinstance(error, OSError):
                self._list()
        finally:
            shutil.rmtree(self._staging, ignore_errors=True)
            if self._made and not any(self.folder.iterdir()):
                self.folder.rmdir()

    def add(self, episode: FrameEpisode) -> None:
        """Adds an episode; it is complete on disk when this returns, or within a second if episodes arrive faster (in
        a long list, within 20 times what writing the list takes).

        Raises:
          OSError: the episode cannot be written; earlier episodes stay complete.
        """
        for name, body in self.files(episode).items():
            self._place(name, body)
        self.take(episode)
        self.num_episodes, self.num_frames = self.num_episodes + 1, self.num_frames + len(episode)
        if time.monotonic() >= self._next_list:
            self._list()

    def _list(self) -> None:
        if self.num_episodes == self._listed:
            return
        began = time.monotonic()
        if not self._listed:
            self._place(ORIGIN, json.dumps(self._origin, indent=1, ensure_ascii=False).encode() + b"\n")
        for name, body in self.lists().items():
            self._place(name, body)
            v.sync(self.folder / name)
        self._listed, now = self.num_episodes, time.monotonic()
        self._next_list = now + _LIST_EVERY * max(1.0, (now - began) / _USUAL_LIST)

    def _place(self, name: str, body: bytes) -> None:
        part, path = self._staging / "part", self.folder / name
        part.write_bytes(body)
        path.parent.mkdir(parents=True, exist_ok=True)
        part.replace(path)

    def files(self, episode: FrameEpisode) -> dict[str, bytes]:
        """The files of an episode that is about to be added: path in the folder -> contents."""
        raise NotImplementedError

    def take(self, episode: FrameEpisode) -> None:
        """Notes what the lists say of an episode whose files are all in place."""

    def lists(self) -> dict[str, bytes]:
        """The files that list all frames so far."""
        return {}
