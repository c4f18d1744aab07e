"""Streets made by rule and by hand: each builder returns a `SceneGraph` like one distilled from a video.

One folder for each set of scenes: `shipped_streets`, `procedural_streets`, `procedural_places`, `city_blocks` (the
streets that are filmed for UrbanVerse-160 and AutoBench), `craftbench` and `validation_streets`. `canvas` is what the
last two and the places are composed with; streets of one section use `composer`, `section` and `pieces`.
"""

from ..datatypes import SceneGraph
from ..datatypes import validation as v
from .shipped_streets import BUILDERS, SPLITS

__all__ = ["BUILDERS", "SPLITS", "build"]


def build(scene_id: str) -> SceneGraph:
    """The graph of one of the shipped streets, the same on every machine.

    Raises:
      ValidationError: no street has this id.
    """
    v.choice(scene_id, "scene id", BUILDERS)
    return BUILDERS[scene_id]().graph()
