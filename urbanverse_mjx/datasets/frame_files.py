"""Episodes as files of single frames, from which the formats COCO, KITTI and MCAP are written."""

import dataclasses
import json
import pathlib
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import validation as v
from .annotations import Annotation
from .claims import Claim, continued, has_episodes

#: s, least time between two versions of the files that list all frames, longer in proportion where writing them took
#: longer than `_USUAL_LIST`.
_LIST_EVERY, _USUAL_LIST = 1.0, 0.05
ORIGIN = "urbanverse.json"
#: The complete episodes, written last.
EPISODES = "episodes.json"


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
    """A folder to which episodes are added; files of an episode are staged and moved into place together, and the lists
    of frames and episodes are replaced after them, so that what they name is complete whenever the process is killed.

    Args:
      folder: new or empty.
      rig: see there.
      origin: JSON object for urbanverse.json.
      resume: whether the folder may hold a recording of this class with the same arguments, to which episodes are
        added: its files are then those of one uninterrupted recording.

    Attributes:
      records: of all episodes, those of a resumed recording first: number, first frame, frames, and their own records.

    Raises:
      ValidationError: the folder is not empty or in use; with `resume`, it holds something else or differs.
    """

    #: "png" or "jpg".
    image_type = "png"

    def __init__(self, folder: pathlib.Path, rig: Rig, origin: Mapping[str, Any], resume: bool = False) -> None:
        begun = resume and has_episodes(folder, EPISODES)
        self.folder, self.rig = folder, rig
        self.num_frames = 0
        self.records: list[dict[str, Any]] = []
        self._listed, self._next_list = 0, -np.inf
        self._origin = dict(origin)
        self._claim = Claim(folder, resume)
        if begun:
            try:
                self._restore()
            except BaseException:
                self._claim.release()
                raise

    @property
    def num_episodes(self) -> int:
        """Episodes so far."""
        return len(self.records)

    def _restore(self) -> None:
        where = self.folder / EPISODES
        records = read_list(where, "episodes")
        frames = 0
        for number, record in enumerate(records):
            begins = v.integer(record.get("first_frame"), f"{where}: episodes[{number}].first_frame", frames, frames)
            frames = begins + v.integer(record.get("frames"), f"{where}: episodes[{number}].frames", 1)
        origin = continued(self.folder / ORIGIN, self._origin, len(records))
        if origin != v.read_json(self.folder / ORIGIN, "origin of a recording"):
            self._place(ORIGIN, _json(origin))
        self._origin, self.num_frames, self.records = origin, frames, records
        self._listed = len(records)
        self.read_lists()

    def __enter__(self) -> "FrameFolder":
        return self

    def __exit__(self, kind: Any, error: BaseException | None, at: Any) -> None:
        try:
            if not isinstance(error, OSError):
                self._list()
        finally:
            self._claim.release()

    def add(self, episode: FrameEpisode) -> None:
        """Adds an episode; it is complete on disk when this returns, or within a second if episodes arrive faster (in
        a long list, within 20 times what writing the list takes).

        Raises:
          OSError: the episode cannot be written; earlier episodes stay complete.
        """
        for name, body in self.files(episode).items():
            self._place(name, body)
        self.take(episode)
        place = {"episode": self.num_episodes, "first_frame": self.num_frames, "frames": len(episode)}
        self.records.append({**place, **episode.record})
        self.num_frames += len(episode)
        if time.monotonic() >= self._next_list:
            self._list()

    def _list(self) -> None:
        if self.num_episodes == self._listed:
            return
        began = time.monotonic()
        if not self._listed:
            self._place(ORIGIN, _json(self._origin))
        rows = ",\n".join(json.dumps(record, ensure_ascii=False) for record in self.records)
        episodes = f'{{"episodes": [\n{rows}\n]}}\n'.encode()
        for name, body in (self.lists() | {EPISODES: episodes}).items():
            self._place(name, body)
            v.sync(self.folder / name)
        self._listed, now = self.num_episodes, time.monotonic()
        self._next_list = now + _LIST_EVERY * max(1.0, (now - began) / _USUAL_LIST)

    def _place(self, name: str, body: bytes) -> None:
        part, path = self._claim.staging / "part", self.folder / name
        part.write_bytes(body)
        path.parent.mkdir(parents=True, exist_ok=True)
        part.replace(path)

    def files(self, episode: FrameEpisode) -> dict[str, bytes]:
        """The files of an episode that is about to be added: path in the folder -> contents."""
        raise NotImplementedError

    def take(self, episode: FrameEpisode) -> None:
        """Notes what the lists say of an episode whose files are all in place."""

    def read_lists(self) -> None:
        """Takes over what the lists say of the first `num_frames` frames, of a recording that is continued.

        Raises:
          ValidationError: a list cannot be read.
        """

    def lists(self) -> dict[str, bytes]:
        """The files that list all frames so far."""
        return {}


def _json(value: Any) -> bytes:
    return json.dumps(value, indent=1, ensure_ascii=False).encode() + b"\n"


def read_list(path: pathlib.Path, key: str) -> list[dict[str, Any]]:
    """A list of objects under a key of a JSON file of any size.

    Raises:
      ValidationError: there is none.
    """
    try:
        body = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise v.fail(str(path), f"a file that cannot be read ({error})", "JSON of a recording") from error
    rows = body.get(key) if isinstance(body, dict) else None
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise v.fail(str(path), f"no list of objects {key!r}", "a file of a recording")
    return rows
