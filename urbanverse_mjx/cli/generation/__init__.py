"""`urbanverse gen`: from a tour, or a scene graph, to compiled digital cousins, stage by stage."""

from .pipeline import GenerationOptions, generate
from .tours import TourOptions

__all__ = ["GenerationOptions", "TourOptions", "generate"]
