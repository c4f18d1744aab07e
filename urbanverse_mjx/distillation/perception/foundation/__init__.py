"""Foundation models behind `Sees`, for who has the weights: OWLv2, SAM 2, Mask2Former, metric depth."""

from .sees import FoundationSees

__all__ = ["FoundationSees"]
