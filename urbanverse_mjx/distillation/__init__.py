"""Converts a `Recording` to a `SceneGraph`: lifting, fusion over frames, ground, sky, placement."""

from .distil import Describe, Distillation, Evidence, distil
from .options import DistilOptions

__all__ = ["Describe", "DistilOptions", "Distillation", "Evidence", "distil"]
