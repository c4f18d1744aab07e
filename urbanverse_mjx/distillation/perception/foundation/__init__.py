"""`Predictor` implemented by foundation models, whose weights are needed: OWLv2 and SAM 2 or SAM 3, Mask2Former, metric
depth."""

from .detectors import DETECTORS
from .predictor import FoundationPredictor

__all__ = ["DETECTORS", "FoundationPredictor"]
