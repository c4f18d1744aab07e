"""`Recording`: posed frames with depth, instance masks and ground kinds. A folder with `recording.json` and images.

Camera frame (OpenCV): x right, y down, z forward; pixel (u, v) = (fx x / z + cx, fy y / z + cy), where the centre of
the top left pixel is (0.5, 0.5). World frame: z up, metres.
"""

import dataclasses
import itertools
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image

from . import ground
from . import validation as v
from .scene_graph import Source

SCHEMA = "urbanverse.recording/1"
FILE = "recording.json"
#: How the names of images end that frames are read from, in lower case.
IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")
#: What Pillow raises for files that are no image, cut off, or said to have hundreds of millions of pixels.
UNREADABLE = (OSError, SyntaxError, Image.DecompressionBombError)
#: Value of a surface image where the sky is seen; 0 is anything else, others index `ground.GROUND_KINDS`.
SKY = 255
#: Steps of a depth image (m) unless its recording gives another: 16 bits then reach 327 m.
DEPTH_UNIT = 0.005
MAX_FRAMES = 100_000
MAX_DETECTIONS = 65_535  # per frame: masks are 16-bit and 0 is "none"
MAX_SIDE = 16_384  # pixels
_ROTATION_TOLERANCE = 1e-3
_BELIEF_TOLERANCE = 0.01  # probabilities are rounded
_KINDS = ("rgb", "depth", "masks", "surfaces")


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole: width, height, focal lengths fx, fy and principal point cx, cy, all in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            v.integer(getattr(self, name), f"camera.{name}", 1, MAX_SIDE)
        for name in ("fx", "fy"):
            object.__setattr__(self, name, v.number(getattr(self, name), f"camera.{name}", above=0.0, maximum=1e6))
        for name in ("cx", "cy"):
            object.__setattr__(self, name, v.number(getattr(self, name), f"camera.{name}", -1e6, 1e6))

    @staticmethod
    def from_fov(width: int, height: int, fovy: float) -> "Camera":
        """Square pixels, principal point in the middle, vertical field of view `fovy` in rad."""
        f = height / (2.0 * float(np.tan(fovy / 2.0)))
        return Camera(width, height, f, f, width / 2.0, height / 2.0)

    def rays(self) -> np.ndarray:
        """(height, width, 3) f64: for every pixel's centre the point at z = 1 m, camera frame."""
        u, w = np.meshgrid(np.arange(self.width) + 0.5, np.arange(self.height) + 0.5)
        return np.stack([(u - self.cx) / self.fx, (w - self.cy) / self.fy, np.ones_like(u)], -1)


@dataclasses.dataclass(frozen=True)
class Detection:
    """One object found in one frame.

    Attributes:
      label: free text.
      score: in [0, 1], probability that it is right.
      track: id of its track, or None.
      beliefs: labels that it may have, with their probabilities in (0, 1], which add up to at most 1; empty where the
        detector gives only one label.
    """

    label: str
    score: float = 1.0
    track: str | None = None
    beliefs: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        v.text(self.label, "detection.label")
        object.__setattr__(self, "score", v.number(self.score, "detection.score", 0.0, 1.0))
        if self.track is not None:
            v.text(self.track, "detection.track")
        if self.beliefs:
            object.__setattr__(self, "beliefs", _beliefs(self.beliefs))

    def to_json(self) -> dict[str, Any]:
        body: dict[str, Any] = {"label": self.label, "score": self.score, "track": self.track}
        return {**body, "beliefs": dict(self.beliefs)} if self.beliefs else body

    @staticmethod
    def from_json(value: Any, where: str) -> "Detection":
        m = dict(v.mapping(value, where, ("label", "score", "track"), ("beliefs",)))
        beliefs = m.pop("beliefs", {})
        if not isinstance(beliefs, Mapping):
            raise v.fail(f"{where}.beliefs", v.show(beliefs), "an object of labels and probabilities")
        return Detection(**m, beliefs=tuple(beliefs.items()))


def _beliefs(beliefs: Sequence[tuple[str, float]]) -> tuple[tuple[str, float], ...]:
    where = "detection.beliefs"
    found = tuple(
        (v.text(label, where), v.number(p, f"{where}.{label}", above=0.0, maximum=1.0)) for label, p in beliefs
    )
    v.unique([label for label, _ in found], where)
    total = sum(p for _, p in found)
    if total > 1.0 + _BELIEF_TOLERANCE:
        raise v.fail(where, f"probabilities that add up to {total:.4g}", "at most 1", "normalise them")
    return found


@dataclasses.dataclass(frozen=True)
class Frame:
    """One image and its data.

    Attributes:
      time_s: s since the first frame of the video.
      rgb: file of the image (PNG or JPEG), relative to the recording's folder like the others.
      depth: 16-bit PNG, planar depth (along the camera's z) in the recording's `depth_unit_m`, 0 = unknown; or None.
      masks: 16-bit PNG, 0 = no object, k = `detections[k - 1]`; or None.
      surfaces: 8-bit PNG, codes of `ground.GROUND_KINDS`, 0 = anything else, 255 = sky; or None.
      T_world_camera: 4 rows of 4, rigid; None where the frame could not be registered.
      detections: in the numbering of `masks`.
    """

    time_s: float
    rgb: str
    depth: str | None = None
    masks: str | None = None
    surfaces: str | None = None
    T_world_camera: tuple[tuple[float, float, float, float], ...] | None = None
    detections: tuple[Detection, ...] = ()

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "time_s", v.number(self.time_s, "frame.time_s", 0.0))
        for name in _KINDS:
            if name == "rgb" or getattr(self, name) is not None:
                _relative(getattr(self, name), f"frame.{name}")
        if self.T_world_camera is not None:
            set_(self, "T_world_camera", _rigid(self.T_world_camera, f"frame {self.rgb!r}.T_world_camera"))
        found = v.instances(self.detections, f"frame {self.rgb!r}.detections", Detection, maximum=MAX_DETECTIONS)
        set_(self, "detections", found)

    @property
    def pose(self) -> np.ndarray | None:
        """(4, 4) f64 T_world_camera, or None."""
        return None if self.T_world_camera is None else np.array(self.T_world_camera)

    def to_json(self) -> dict[str, Any]:
        body = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        pose = self.T_world_camera
        return {
            **body,
            "T_world_camera": None if pose is None else [x for row in pose for x in row],
            "detections": [d.to_json() for d in self.detections],
        }

    @staticmethod
    def from_json(value: Any, where: str) -> "Frame":
        m = dict(v.mapping(value, where, [f.name for f in dataclasses.fields(Frame)]))
        flat = m["T_world_camera"]
        if flat is not None:
            numbers = v.vector(flat, f"{where}.T_world_camera", 16)
            m["T_world_camera"] = tuple(numbers[i : i + 4] for i in range(0, 16, 4))
        rows = v.items(m["detections"], f"{where}.detections", maximum=MAX_DETECTIONS)
        m["detections"] = tuple(Detection.from_json(d, f"{where}.detections[{i}]") for i, d in enumerate(rows))
        return Frame(**m)


@dataclasses.dataclass(frozen=True)
class Recording:
    """A capture through a street, frame by frame. The images stay on disk and are read one at a time.

    Attributes:
      id: letters, digits, "_" and "-".
      source: where the video comes from.
      camera: one pinhole for all frames.
      frames: in the order of their times, at least one.
      folder: where the images are.
      depth_unit_m: m, one step of the depth images.
    """

    id: str
    source: Source
    camera: Camera
    frames: tuple[Frame, ...]
    folder: pathlib.Path
    depth_unit_m: float = DEPTH_UNIT

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        v.identifier(self.id, "recording.id")
        if not isinstance(self.source, Source) or not isinstance(self.camera, Camera):
            raise v.fail("recording", v.show((self.source, self.camera)), "a Source and a Camera")
        set_(self, "frames", v.instances(self.frames, "recording.frames", Frame, minimum=1, maximum=MAX_FRAMES))
        set_(self, "folder", pathlib.Path(self.folder))
        set_(self, "depth_unit_m", v.number(self.depth_unit_m, "recording.depth_unit_m", above=0.0, maximum=1.0))
        times = [f.time_s for f in self.frames]
        for i, (a, b) in enumerate(itertools.pairwise(times)):
            if b <= a:
                raise v.fail(f"frames[{i + 1}].time_s", f"{b:g} after {a:g}", "times that grow", "sort the frames")

    def __len__(self) -> int:
        return len(self.frames)

    @property
    def registered(self) -> np.ndarray:
        """(m,) i32: numbers of the frames that have a pose."""
        return np.array([i for i, f in enumerate(self.frames) if f.T_world_camera is not None], np.int32)

    def poses(self) -> np.ndarray:
        """(m, 4, 4) f64 T_world_camera of the `registered` frames."""
        return np.array([self.frames[i].T_world_camera for i in self.registered]).reshape(-1, 4, 4)

    def rgb(self, index: int) -> np.ndarray:
        """(H, W, 3) u8 sRGB."""
        return self._read(index, "rgb", ("RGB", "L", "RGBA", "P"), np.uint8)

    def depth(self, index: int) -> np.ndarray | None:
        """(H, W) f32 m along the camera's z, 0 where unknown; None where the frame has no depth."""
        if self.frames[index].depth is None:
            return None
        return self._read(index, "depth", ("I;16", "I"), np.uint16).astype(np.float32) * np.float32(self.depth_unit_m)

    def masks(self, index: int) -> np.ndarray | None:
        """(H, W) i32: index of the frame's detection, -1 where there is none; None where the frame has no masks."""
        frame = self.frames[index]
        if frame.masks is None:
            return None
        codes = self._read(index, "masks", ("I;16", "I"), np.uint16).astype(np.int32) - 1
        if codes.max() >= len(frame.detections):
            where = f"{self.folder / frame.masks}"
            raise v.fail(where, f"detection {codes.max() + 1}", f"at most {len(frame.detections)}", "write it again")
        return codes

    def surfaces(self, index: int) -> np.ndarray | None:
        """(H, W) u8: codes of `ground.GROUND_KINDS`, 0 = anything else, 255 = sky; None where there are none."""
        name = self.frames[index].surfaces
        if name is None:
            return None
        codes = self._read(index, "surfaces", ("L",), np.uint8)
        wrong = codes[(codes >= len(ground.GROUND_KINDS)) & (codes != SKY)]
        if wrong.size:
            needed = f"0 to {len(ground.GROUND_KINDS) - 1}, or {SKY} for the sky"
            raise v.fail(str(self.folder / name), f"the value {wrong[0]}", needed, "write it again")
        return codes

    def _read(self, index: int, kind: str, modes: Sequence[str], dtype: Any) -> np.ndarray:
        path = self.folder / getattr(self.frames[index], kind)
        try:
            with Image.open(path) as image:
                self._check_header(image, path, kind, modes)
                return np.asarray(image.convert("RGB") if kind == "rgb" else image).astype(dtype)
        except FileNotFoundError as error:
            raise v.fail(str(path), "no such file", f"the {kind} image of frame {index}", "record again") from error
        except UNREADABLE as error:
            raise v.fail(str(path), f"an unreadable image ({error})", "a whole PNG or JPEG", "record again") from error

    def _check_header(self, image: Image.Image, path: pathlib.Path, kind: str, modes: Sequence[str]) -> None:
        size = self.camera.width, self.camera.height
        if image.size != size:
            found, needed = f"{image.size[0]}x{image.size[1]} pixels", f"the camera's {size[0]}x{size[1]}"
            raise v.fail(str(path), found, needed, "scale the image or fix the camera")
        if image.mode not in modes:
            raise v.fail(str(path), f"pixels of mode {image.mode}", f"mode {modes[0]} for a {kind} image")

    def to_json(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "id": self.id,
            "source": dataclasses.asdict(self.source),
            "camera": dataclasses.asdict(self.camera),
            "depth_unit_m": self.depth_unit_m,
            "frames": [f.to_json() for f in self.frames],
        }

    def save(self) -> pathlib.Path:
        """Writes `recording.json` into the folder; the images must be there already.

        Raises:
          ValidationError: an image is missing.
        """
        self._check_files()
        return v.write_json(self.folder / FILE, self.to_json())

    def _check_files(self) -> None:
        for frame in self.frames:
            for kind in _KINDS:
                name = getattr(frame, kind)
                if name is not None and not (self.folder / name).is_file():
                    raise v.fail(str(self.folder / name), "no such file", f"the {kind} image", "record again")

    @staticmethod
    def load(folder: str | os.PathLike[str]) -> "Recording":
        """Reads a recording's folder; every image must be there, and is checked when it is read."""
        folder = pathlib.Path(folder)
        m = v.mapping(
            v.read_json(folder / FILE, "recording"),
            "recording",
            ("schema", "id", "source", "camera", "depth_unit_m", "frames"),
        )
        v.choice(m["schema"], "recording.schema", (SCHEMA,))
        source = v.mapping(m["source"], "source", [f.name for f in dataclasses.fields(Source)])
        camera = v.mapping(m["camera"], "camera", [f.name for f in dataclasses.fields(Camera)])
        rows = v.items(m["frames"], "frames", minimum=1, maximum=MAX_FRAMES)
        recording = Recording(
            id=m["id"],
            source=Source(**source),
            camera=Camera(**camera),
            frames=tuple(Frame.from_json(f, f"frames[{i}]") for i, f in enumerate(rows)),
            folder=folder,
            depth_unit_m=m["depth_unit_m"],
        )
        recording._check_files()
        return recording


def _relative(value: Any, where: str) -> None:
    v.text(value, where)
    path = pathlib.PurePosixPath(value)
    if path.is_absolute() or ".." in path.parts or "\\" in value:
        raise v.fail(where, v.show(value), "a file inside the recording's folder", "use a relative path with '/'")


def _rigid(value: Any, where: str) -> tuple[tuple[float, ...], ...]:
    """Four rows of a rigid transform; rotation checked to `_ROTATION_TOLERANCE`."""
    rows = v.items(value, where, minimum=4, maximum=4)
    matrix = tuple(v.vector(row, f"{where}[{i}]", 4, minimum=-1e5, maximum=1e5) for i, row in enumerate(rows))
    array = np.array(matrix)
    rotation = array[:3, :3]
    off = np.abs(rotation @ rotation.T - np.eye(3)).max()
    if off > _ROTATION_TOLERANCE or np.linalg.det(rotation) < 0 or (array[3] != [0.0, 0.0, 0.0, 1.0]).any():
        raise v.fail(where, v.show(matrix), "a rotation and a shift, last row 0 0 0 1", "poses are T_world_camera")
    return matrix
