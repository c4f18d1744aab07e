"""Makes the perception model: the built-in network, with or without a published detector, or foundation models."""

import pathlib

from ... import settings
from ...assets.categories import ontology
from ...datatypes import ValidationError
from ...distillation.perception import Predictor
from ...distillation.perception.foundation import FoundationPredictor
from ...distillation.perception.published.opinion import second_opinion
from ...distillation.perception_model.inference import PerceptionModel
from .listing import list_categories
from .video_options import VideoOptions

PERCEPTIONS = ("eye", "foundation")


def make_predictor(video: VideoOptions, frames: pathlib.Path | None = None) -> Predictor:
    """Makes the model of the options.

    Args:
      frames: folder of the capture's images. If an endpoint is configured and frames were blurred, it determines the
        labels to search for from some of them; otherwise all leaves of the ontology are used.

    Raises:
      ValidationError: weights or a package are missing, or the perception model is unknown.
    """
    if video.perception == "eye":
        model = PerceptionModel.load()
        return model if video.second_opinion is None else second_opinion(model, video.second_opinion)
    if video.second_opinion is not None:
        raise ValidationError(
            f"--second-opinion: found --perception {video.perception}, needed the built-in network; leave one out."
        )
    if video.perception != "foundation":
        raise ValidationError(f"--perception: found {video.perception!r}, needed one of {', '.join(PERCEPTIONS)}.")
    labels = list(ontology.categories())
    endpoint = settings.vision_endpoint()
    if endpoint is not None and frames is not None:
        if video.blur is None:
            raise ValidationError(
                "URBANVERSE_VISION_URL: found an endpoint and no detector of faces and plates, needed --blur: frames "
                "that are not blurred never leave this machine; name a detector or unset the address."
            )
        images = sorted(p for p in frames.iterdir() if p.suffix == ".png")
        labels = list_categories(endpoint, images)
    models = None if video.models is None else pathlib.Path(video.models)
    return FoundationPredictor.load(labels, models, video.detector)
