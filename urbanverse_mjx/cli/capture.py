"""`urbanverse capture`: films a street of a bank as a recording with ground truth, and as a video."""

import dataclasses
import json
import pathlib
from collections.abc import Sequence

from .. import pipeline
from ..pipeline.filming import CaptureOptions
from ._options import ImageSize, parse


@dataclasses.dataclass(frozen=True, kw_only=True)
class CaptureArgs(CaptureOptions):
    """Film a street; prints one JSON line.

    The camera walks along one side, over the road and back along the other, looking ahead and a little to both sides.
    """

    out: pathlib.Path
    """Folder of the recording (recording.json, rgb/, depth/, masks/, surfaces/, truth.json)."""
    size: ImageSize = (360, 640)
    """Of the images, in pixels."""
    quiet: bool = False
    """No progress bars."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse capture`."""
    args = parse(CaptureArgs, argv, "urbanverse capture")
    print(json.dumps(pipeline.capture(args.out, args, args.quiet)))
    return 0
