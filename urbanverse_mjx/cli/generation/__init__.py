"""`urbanverse gen`: from a tour, or a scene graph, to compiled digital cousins, stage by stage."""

from .pipeline import GenerationOptions, generate

__all__ = ["GenerationOptions", "generate"]
