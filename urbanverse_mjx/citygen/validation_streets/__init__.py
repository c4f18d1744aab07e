"""Validation streets: eight hand-made scenes, one module `vNN_...` each with a `build() -> Canvas`.

Checkpoints, presets and ablations are chosen on them (with the other scenes of `scenes/validation.json`), so that
CraftBench and AutoBench are used for final tables only. Their layouts differ from CraftBench's.
"""

from ...datatypes import SceneGraph
from ..canvas import discovery

__all__ = ["BUILDERS", "build"]

BUILDERS = discovery.builders(__name__, __path__, "v")


def build(scene_id: str) -> SceneGraph:
    """Returns the graph of one validation street; it is identical on every machine.

    Raises:
      ValidationError: no scene has this id.
    """
    return discovery.build(BUILDERS, scene_id)
