"""CraftBench: twelve hand-made scenes, one module `sNN_...` each with a `build() -> Canvas`.

Their ids and themes are those of the authors' release (docs/sources/reference_systems.md b.1).
"""

from ...datatypes import SceneGraph
from ..canvas import discovery
from ..canvas.canvas import Canvas
from ..canvas.graph_file import write

__all__ = ["BUILDERS", "Canvas", "build", "write"]

BUILDERS = discovery.builders(__name__, __path__, "s")


def build(scene_id: str) -> SceneGraph:
    """Returns the graph of one hand-made scene; it is identical on every machine.

    Raises:
      ValidationError: no scene has this id.
    """
    return discovery.build(BUILDERS, scene_id)
