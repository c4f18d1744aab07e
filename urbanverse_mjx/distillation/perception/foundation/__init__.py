"""Foundation models behind `Predictor`, which need their weights: OWLv2, SAM 2, Mask2Former, metric depth."""

from .predictor import FoundationPredictor

__all__ = ["FoundationPredictor"]
