"""Stages before the distillation: video or images to frames, and frames to a recording."""

import pathlib
from collections.abc import Callable

from ...datatypes import Recording, Source
from ...distillation.perception import Perception, SamplingOptions, blur_by_name, perceive, sample
from ...distillation.perception.frames import load as load_frames
from .predictors import make_predictor
from .video_options import VideoOptions

Report = Callable[[int, int], None]


def sample_to(source: pathlib.Path, folder: pathlib.Path, options: VideoOptions, report: Report) -> None:
    """Writes the usable frames of a video or folder of images.

    Raises:
      ValidationError: see `sample`.
    """
    blur = None if options.blur is None else blur_by_name(options.blur)
    sample(source, folder, SamplingOptions(rate=options.rate, allow_truncated=options.allow_truncated), blur, report)


def perceive_to(
    frames: pathlib.Path, folder: pathlib.Path, video: pathlib.Path, options: VideoOptions, report: Report
) -> Recording:
    """Makes a recording of frames, with poses from the images, and objects and surfaces by the model of the options.

    Raises:
      ValidationError: see `perceive` and `make_predictor`.
    """
    perception = Perception(make_predictor(options, frames), camera_height=options.camera_height)
    source = Source(video.name, options.licence, options.city, options.country)
    return perceive(load_frames(frames), folder, perception, source, video.stem, report)
