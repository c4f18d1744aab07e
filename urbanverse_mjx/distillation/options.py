"""Options of the distillation."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class DistilOptions:
    """Options for making a scene graph from a recording.

    Attributes:
      min_pixels: smaller views are not used; 24 is a bollard of 5 x 5 pixels.
      max_range: m; points farther away are not used.
      min_score: objects with less confidence are left out.
      depth_scale: whether to make depth consistent over frames from the ground.
      close_loops: whether to correct poses where the trajectory revisits a place.
      single_view: whether to use only one view of each object, that of median size (an ablation of the fusion).
      place: whether to move objects to ground on which their kind can stand.
    """

    min_pixels: int = 24
    max_range: float = 60.0
    min_score: float = 0.3
    depth_scale: bool = True
    close_loops: bool = True
    single_view: bool = False
    place: bool = True
