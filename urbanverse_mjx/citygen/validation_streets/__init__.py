"""Validation streets: eight scenes composed by hand, one module `vNN_...` each with a `build() -> Canvas`.

Checkpoints, presets and ablations are chosen on them (with the other scenes of `scenes/validation.json`), so that
CraftBench and AutoBench serve for final tables alone. No plan of CraftBench is used again.
"""

from ...datatypes import SceneGraph
from ..canvas import discovery

__all__ = ["BUILDERS", "build"]

BUILDERS = discovery.builders(__name__, __path__, "v")


def build(scene_id: str) -> SceneGraph:
    """The graph of one validation street, the same on every machine.

    Raises:
      ValidationError: no scene has this id.
    """
    return discovery.build(BUILDERS, scene_id)
