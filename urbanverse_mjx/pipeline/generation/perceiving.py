"""Video or pictures -> frames -> recording: the stages in front of the distillation."""

import pathlib
from collections.abc import Callable

from ...datatypes import Recording, Source
from ...distillation.perception import Perception, SamplingOptions, blur_by_name, perceive, sample
from ...distillation.perception.frames import load as load_frames
from .predictors import make_predictor
from .tours import TourOptions

Report = Callable[[int, int], None]


def sample_to(source: pathlib.Path, folder: pathlib.Path, tour: TourOptions, report: Report) -> None:
    """Writes the usable frames of a video or folder of pictures.

    Raises:
      ValidationError: see `sample`.
    """
    blur = None if tour.blur is None else blur_by_name(tour.blur)
    sample(source, folder, SamplingOptions(rate=tour.rate), blur, report)


def perceive_to(
    frames: pathlib.Path, folder: pathlib.Path, video: pathlib.Path, tour: TourOptions, report: Report
) -> Recording:
    """Makes a recording of frames, poses from the pictures, objects and surfaces by the model that the options name.

    Raises:
      ValidationError: see `perceive` and `make_predictor`.
    """
    perception = Perception(make_predictor(tour, frames), camera_height=tour.camera_height)
    source = Source(video.name, tour.licence, tour.city, tour.country)
    return perceive(load_frames(frames), folder, perception, source, video.stem, report)
