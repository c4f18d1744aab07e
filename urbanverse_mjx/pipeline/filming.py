"""Renders a walk through a street of a bank as a recording with ground truth, and as a video."""

import dataclasses
import os
import pathlib
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from ..progress import Progress


@dataclasses.dataclass(frozen=True)
class CaptureOptions:
    """Options of a capture."""

    scene: str | None = None
    """Name of the street in the bank; default: its first."""
    bank: pathlib.Path | None = None
    """Scene bank; default: the shipped streets."""
    frames: int | None = None
    """Number of frames; default: once along both sides."""
    rate: float = 1.0
    """Frames per second, of the recording and of the video."""
    speed: float = 1.4
    """Walking speed in m/s."""
    height: float = 1.5
    """Height of the camera above the ground in m."""
    size: tuple[int, int] = (360, 640)
    """Height and width in pixels."""
    fov: float = 50.0
    """Vertical field of view in degrees."""
    samples: int = 2
    """Rays per pixel along each side."""
    video: pathlib.Path | None = None
    """Also write the images as an mp4, which plays in real time and needs even sizes."""


def capture(out: str | os.PathLike[str], options: CaptureOptions | None = None, quiet: bool = True) -> dict[str, Any]:
    """Films a street.

    The camera walks along one side, over the road and back along the other, looking ahead and a little to both sides.

    Args:
      out: folder of the recording (recording.json, rgb/, depth/, masks/, surfaces/, truth.json).
      quiet: whether to show no progress bar on standard error.

    Returns:
      recording: the folder; scene: its name; frames: their number; video: the file, if requested.

    Raises:
      ValidationError: the scene does not exist, sizes are odd for a video, or the folder is in use.
    """
    from ..capture import FilmOptions, PathOptions, film_scene
    from ..datatypes import SceneBank
    from .banks import ensure_default_bank

    options = options or CaptureOptions()
    height, width = options.size
    if options.video and (height % 2 or width % 2):
        raise ValidationError(f"--size: found {height}x{width}, needed even numbers for a video.")
    bank = ensure_default_bank(quiet) if options.bank is None else SceneBank.load(options.bank)
    name = options.scene or bank.scene_ids[0]
    if name not in bank.scene_ids:
        raise ValidationError(f"--scene: found {name!r}, needed one of {', '.join(bank.scene_ids)}.")
    path = PathOptions(speed=options.speed, rate=options.rate, height=options.height, frames=options.frames)
    camera = FilmOptions(width, height, fovy=float(np.radians(options.fov)), samples=options.samples)
    with Progress(quiet) as progress:
        recording = film_scene(
            bank,
            bank.scene_ids.index(name),
            pathlib.Path(out),
            path,
            camera,
            progress.task(f"filming {name}", unit="frames"),
        )
    if options.video:
        from ..viz.video import write_video

        write_video(options.video, [recording.rgb(i) for i in range(len(recording))], options.rate)
    body = {"recording": str(out), "scene": name, "frames": len(recording)}
    return body | ({"video": str(options.video)} if options.video else {})
