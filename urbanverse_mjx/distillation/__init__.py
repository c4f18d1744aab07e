"""A `Recording` becomes a `SceneGraph`: lifting, fusion over frames, ground, sky, placement."""

from .distil import Describe, Distillation, DistilOptions, Evidence, distil

__all__ = ["Describe", "DistilOptions", "Distillation", "Evidence", "distil"]
