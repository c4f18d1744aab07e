"""Stages before the distillation: video or images to frames, and frames to a recording."""

import pathlib
from collections.abc import Callable

from ...datatypes import Recording, Source
from ...datatypes import validation as v
from ...distillation.perception import (
    Frames,
    Perception,
    Photograph,
    SamplingOptions,
    StructureOptions,
    blur_by_name,
    perceive,
    perceive_photograph,
    photograph,
    sample,
)
from ...distillation.perception.frames import FOCAL_RANGE, focal_pixels
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
    sampled = load_frames(frames)
    perception = Perception(
        make_predictor(options, frames),
        camera_height=options.camera_height,
        structure=structure_options(sampled, options),
    )
    source = Source(video.name, options.licence, options.city, options.country)
    return perceive(sampled, folder, perception, source, video.stem, report)


def photograph_to(source: pathlib.Path, folder: pathlib.Path, options: VideoOptions) -> None:
    """Writes a photograph as the only frame.

    Raises:
      ValidationError: see `photograph`.
    """
    blur = None if options.blur is None else blur_by_name(options.blur)
    photograph(source, folder, SamplingOptions(), blur)


def perceive_photograph_to(
    frames: pathlib.Path, folder: pathlib.Path, image: pathlib.Path, options: VideoOptions
) -> Recording:
    """Makes a recording of a photograph.

    Raises:
      ValidationError: see `perceive_photograph` and `make_predictor`.
    """
    taken = load_frames(frames)
    known = Photograph(options.camera_height, structure_options(taken, options).focal)
    source = Source(image.name, options.licence, options.city, options.country)
    return perceive_photograph(taken, folder, make_predictor(options, frames), known, source, image.stem)


def structure_options(frames: Frames, options: VideoOptions) -> StructureOptions:
    """The focal length that the reconstruction keeps, if the user gave one, or from which it starts, if EXIF data have
    one.

    Raises:
      ValidationError: the focal length is not one of a camera for streets.
    """
    if options.focal is not None:
        v.number(options.focal, "--focal (mm, 35-mm equivalent)", *FOCAL_RANGE)
        return StructureOptions(focal=focal_pixels(options.focal, frames.width, frames.height))
    return StructureOptions(focal=frames.focal, exact=False)
