"""`LabelPrior`: prior knowledge about objects of one label."""

import dataclasses

import numpy as np

from . import validation as v
from .ground import GROUND_KINDS


@dataclasses.dataclass(frozen=True)
class LabelPrior:
    """Sizes and possible positions of the objects of a label.

    Attributes:
      extents: (n, 3) m, sizes of known objects (along the heading, across, up); n may be 0.
      on_ground: whether it stands, lies or is parked on the ground, instead of hanging or flying.
      stands_on: kinds of ground on which it is usually found; empty = any.
      fixed: whether it cannot move by itself or be driven away.
      faces_road: whether its front is turned to the road, as that of a house.
      shapes: for each of `extents` (p, 3) m, points on its surface, +x its front; or none at all.
    """

    extents: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    on_ground: bool = True
    stands_on: tuple[str, ...] = ()
    fixed: bool = True
    faces_road: bool = False
    shapes: tuple[np.ndarray, ...] = ()

    def __post_init__(self) -> None:
        extents = np.asarray(self.extents, np.float64).reshape(-1, 3)
        if not (np.isfinite(extents).all() and (extents > 0).all()):
            raise v.fail("label prior.extents", v.show(extents), "positive sizes in m")
        object.__setattr__(self, "extents", extents)
        if self.shapes and len(self.shapes) != len(extents):
            raise v.fail("label prior.shapes", f"{len(self.shapes)}", f"{len(extents)}, one for each extent, or none")
        for i, kind in enumerate(self.stands_on):
            v.choice(kind, f"label prior.stands_on[{i}]", GROUND_KINDS[1:])
