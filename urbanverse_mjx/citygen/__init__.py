"""Streets made by rule and by hand: each builder returns a `SceneGraph` like one distilled from a video."""

from ..datatypes import SceneGraph
from ..datatypes import validation as v
from .streets import BUILDERS, SPLITS

__all__ = ["BUILDERS", "SPLITS", "build"]


def build(scene_id: str) -> SceneGraph:
    """The graph of one of the shipped streets, the same on every machine.

    Raises:
      ValidationError: no street has this id.
    """
    v.choice(scene_id, "scene id", BUILDERS)
    return BUILDERS[scene_id]().graph()
