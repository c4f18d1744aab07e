"""Writes a `Recording` frame by frame."""

import os
import pathlib
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from PIL import Image

from . import validation as v
from .recording import DEPTH_UNIT, FILE, Camera, Detection, Frame, Recording
from .scene_graph import Source

_JPEG_QUALITY = 92
_KINDS = ("rgb", "depth", "masks", "surfaces")
#: Names of the images in their folders.
_IMAGE = re.compile(r"\d{6,}\.(png|jpg)")
#: Marker file in the folder of an incomplete recording.
_UNFINISHED = ".unfinished-recording"


class RecordingWriter:
    """Writes images frame by frame; the folder is a recording only after `close` has written `recording.json`.

    Args:
      folder: output folder, which is created if needed; an existing recording is replaced.
      id, source, camera, depth_unit_m: see `Recording`.
      lossless: RGB as PNG instead of JPEG.

    Raises:
      ValidationError: the folder cannot be written, or holds files that do not belong to a recording.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        id: str,
        source: Source,
        camera: Camera,
        depth_unit_m: float = DEPTH_UNIT,
        lossless: bool = True,
    ) -> None:
        self.folder = pathlib.Path(folder)
        self._parts: dict[str, Any] = {
            "id": v.identifier(id, "recording.id"),
            "source": source,
            "camera": camera,
            "depth_unit_m": depth_unit_m,
        }
        self.camera = camera
        self._suffix = "png" if lossless else "jpg"
        self._frames: list[Frame] = []
        try:
            self._empty()
        except OSError as error:
            hint = "choose another folder"
            raise v.fail(
                str(self.folder), f"a folder that cannot be written ({error})", "write access", hint
            ) from error

    def _empty(self) -> None:
        """Makes the folder, and removes the images of an earlier or interrupted recording there."""
        ours = any((self.folder / name).is_file() for name in (FILE, _UNFINISHED))
        for kind in () if ours else _KINDS:
            if (self.folder / kind).exists():
                needed = "an empty folder, or one with a recording"
                raise v.fail(
                    str(self.folder / kind), "files that are not of a recording", needed, "choose another folder"
                )
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / _UNFINISHED).touch()
        (self.folder / FILE).unlink(missing_ok=True)
        for kind in _KINDS:
            (self.folder / kind).mkdir(exist_ok=True)
            for path in (self.folder / kind).iterdir():
                if _IMAGE.fullmatch(path.name):
                    path.unlink()

    def add(
        self,
        time_s: float,
        rgb: np.ndarray,
        depth: np.ndarray | None = None,
        masks: np.ndarray | None = None,
        surfaces: np.ndarray | None = None,
        T_world_camera: np.ndarray | None = None,
        detections: Sequence[Detection] = (),
    ) -> None:
        """Adds one frame.

        Args:
          time_s: s, later than the last frame's.
          rgb: (H, W, 3) u8.
          depth: (H, W) m along the camera's z; 0, NaN or beyond 65,535 units = unknown.
          masks: (H, W) index into `detections`, -1 = none.
          surfaces: (H, W) u8 codes, see `Frame`.
          T_world_camera: (4, 4) or None.
          detections: of this frame.
        """
        number = len(self._frames)
        files: dict[str, str | None] = {"rgb": self._write(rgb, "rgb", number, self._suffix)}
        if depth is not None:
            steps = np.nan_to_num(np.round(depth / self._parts["depth_unit_m"]), nan=0.0, posinf=0.0, neginf=0.0)
            steps[(steps < 0) | (steps > 65_535)] = 0
            files["depth"] = self._write(steps.astype(np.uint16), "depth", number)
        if masks is not None:
            if masks.min() < -1 or masks.max() >= len(detections):
                found = f"detections {masks.min()} to {masks.max()}"
                raise v.fail(f"masks of frame {number}", found, f"-1 to {len(detections) - 1}")
            files["masks"] = self._write((masks + 1).astype(np.uint16), "masks", number)
        if surfaces is not None:
            files["surfaces"] = self._write(surfaces.astype(np.uint8), "surfaces", number)
        pose = None if T_world_camera is None else np.asarray(T_world_camera, np.float64).tolist()
        self._frames.append(Frame(time_s, T_world_camera=pose, detections=tuple(detections), **files))  # type: ignore

    def _write(self, image: np.ndarray, kind: str, number: int, suffix: str = "png") -> str:
        size = self.camera.height, self.camera.width
        if image.shape[:2] != size:
            raise v.fail(f"{kind} of frame {number}", f"shape {image.shape}", f"{size[0]} rows of {size[1]} pixels")
        name = f"{kind}/{number:06d}.{suffix}"
        options: dict[str, Any] = {"quality": _JPEG_QUALITY} if suffix == "jpg" else {"compress_level": 3}
        try:
            Image.fromarray(image).save(self.folder / name, **options)
        except OSError as error:
            raise v.fail(str(self.folder / name), f"an error while writing ({error})", "write access") from error
        return name

    def close(self) -> Recording:
        """Writes `recording.json`; at least one frame must have been added."""
        recording = Recording(frames=tuple(self._frames), folder=self.folder, **self._parts)
        recording.save()
        (self.folder / _UNFINISHED).unlink()
        return recording
