"""`urbanverse capture`: a walk through a street of a bank as a recording with its truth, and as a video."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence

import numpy as np
import tyro

from ..datatypes import NounError


@dataclasses.dataclass(frozen=True)
class CaptureArgs:
    """Film a street; prints one JSON line.

    The camera walks along one side, over the road and back along the other, looking ahead and a little to both sides.
    """

    out: pathlib.Path
    """Folder of the recording (recording.json, rgb/, depth/, masks/, surfaces/, truth.json)."""
    scene: str | None = None
    """Name of the street in the bank; default: its first."""
    bank: pathlib.Path | None = None
    """Scene bank; default: the shipped streets."""
    frames: int | None = None
    """So many frames; default: once along both sides."""
    rate: float = 1.0
    """Frames per second, of the recording and of the video."""
    speed: float = 1.4
    """Walking speed in m/s."""
    height: float = 1.5
    """Height of the camera over the ground in m."""
    size: tuple[int, int] = (640, 360)
    """Width and height in pixels."""
    fov: float = 50.0
    """Vertical field of view in degrees."""
    samples: int = 2
    """Rays per pixel along each side."""
    video: pathlib.Path | None = None
    """Write the pictures as an mp4, too; it plays in real time and needs even sizes."""
    quiet: bool = False


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse capture`."""
    args = tyro.cli(CaptureArgs, args=list(argv), prog="urbanverse capture")
    from rich.console import Console
    from rich.progress import Progress

    from ..capture import PathOptions, TourOptions, tour
    from ..datatypes import SceneBank
    from ..pipeline import ensure_default_bank

    bank = ensure_default_bank(args.quiet) if args.bank is None else SceneBank.load(args.bank)
    name = args.scene or bank.scene_ids[0]
    if name not in bank.scene_ids:
        raise NounError(f"--scene: found {name!r}, needed one of {', '.join(bank.scene_ids)}.")
    if args.video and any(n % 2 for n in args.size):
        raise NounError(f"--size: found {args.size[0]} x {args.size[1]}, needed even numbers for a video.")
    path = PathOptions(speed=args.speed, rate=args.rate, height=args.height, frames=args.frames)
    options = TourOptions(*args.size, fovy=float(np.radians(args.fov)), samples=args.samples)
    with Progress(console=Console(file=sys.stderr), disable=args.quiet) as progress:
        task = progress.add_task(f"filming {name}")
        recording = tour(
            bank,
            bank.scene_ids.index(name),
            args.out,
            path,
            options,
            lambda done, total: progress.update(task, completed=done, total=total),
        )
    if args.video:
        from ..viz.video import write_video

        write_video(args.video, [recording.rgb(i) for i in range(len(recording))], args.rate)
    body = {"recording": str(args.out), "scene": name, "frames": len(recording)}
    print(json.dumps(body | ({"video": str(args.video)} if args.video else {})))
    return 0
