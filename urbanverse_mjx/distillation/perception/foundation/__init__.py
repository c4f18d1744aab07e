"""Foundation models behind `Predictor`, for who has the weights: OWLv2, SAM 2, Mask2Former, metric depth."""

from .predictor import FoundationPredictor

__all__ = ["FoundationPredictor"]
