"""How a graph is distilled."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class DistilOptions:
    """How a graph is made.

    Attributes:
      min_pixels: smaller views are not used; 24 is a bollard of 5 x 5 pixels.
      max_range: m, points farther away are not used.
      min_score: objects of less confidence are left out.
      depth_scale: whether depth is made consistent over frames from the ground.
      close_loops: whether poses are made consistent where the trajectory comes by again.
      single_view: take each object from one view alone, that of median size (to measure what fusion is worth).
      place: whether objects are pulled to where their kind can stand.
    """

    min_pixels: int = 24
    max_range: float = 60.0
    min_score: float = 0.3
    depth_scale: bool = True
    close_loops: bool = True
    single_view: bool = False
    place: bool = True
