"""What a user asks for, as one Python call each; the `urbanverse` command prints what these return.

    from urbanverse_mjx import pipeline

    pipeline.generate("walk.mp4", "runs/walk")
    bank = pipeline.build_bank(["graph.json"], ["test"])

Nothing heavy is imported before a name is used.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .banks import (
        build_bank,
        build_terrain_bank,
        cached_bank,
        ensure_default_bank,
        ensure_terrain_bank,
        join_banks,
        shipped_scenes,
    )
    from .evaluation import evaluate_policy
    from .generation.stages import GenerationOptions, generate
    from .generation.tours import TourOptions
    from .scenes import compile_graph, make_driver

#: Name -> the module below this package that defines it.
_HOMES = {
    "GenerationOptions": "generation.stages",
    "TourOptions": "generation.tours",
    "build_bank": "banks",
    "build_terrain_bank": "banks",
    "cached_bank": "banks",
    "compile_graph": "scenes",
    "ensure_default_bank": "banks",
    "ensure_terrain_bank": "banks",
    "evaluate_policy": "evaluation",
    "generate": "generation.stages",
    "join_banks": "banks",
    "make_driver": "scenes",
    "shipped_scenes": "banks",
}

__all__ = [
    "GenerationOptions",
    "TourOptions",
    "build_bank",
    "build_terrain_bank",
    "cached_bank",
    "compile_graph",
    "ensure_default_bank",
    "ensure_terrain_bank",
    "evaluate_policy",
    "generate",
    "join_banks",
    "make_driver",
    "shipped_scenes",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
