"""`Predictor` implemented by foundation models, whose weights are needed: OWLv2, SAM 2, Mask2Former, metric depth."""

from .predictor import FoundationPredictor

__all__ = ["FoundationPredictor"]
