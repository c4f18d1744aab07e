"""Builders of synthetic scenes, procedural and hand-made; each returns a `SceneGraph` like one distilled from a video.

Each set of scenes has its own folder: `shipped_streets`, `procedural_streets`, `procedural_places`, `city_blocks` (the
streets of which videos are rendered for UrbanVerse-160 and AutoBench), `craftbench` and `validation_streets`.
`craftbench`, `validation_streets` and `procedural_places` are built with `canvas`; streets with a single cross-section
use `composer`, `section` and `pieces`.
"""

from ..datatypes import SceneGraph
from ..datatypes import validation as v
from .shipped_streets import BUILDERS, SPLITS

__all__ = ["BUILDERS", "SPLITS", "build"]


def build(scene_id: str) -> SceneGraph:
    """Returns the graph of one of the shipped streets; it is identical on every machine.

    Raises:
      ValidationError: no street has this id.
    """
    v.choice(scene_id, "scene id", BUILDERS)
    return BUILDERS[scene_id]().graph()
