"""Chooses assets that stay where they are put: one that stands, otherwise the lying form of one that does not.

Only objects on the ground that nothing holds are concerned (`assets.categories.priors.is_held`). Whether an asset
stands follows from its collision hulls (`assets.collision.rest_poses`), without simulation.
"""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from ..assets.categories.priors import is_held
from ..assets.collision import lying, rest_poses
from ..datatypes import AssetRecord, GraphObject, HullSet
from . import choice, overlap, standing
from .choice import Vector
from .shortlists import Candidate


class Steady:
    """Replaces candidates that do not stand.

    Args:
      hulls_of: function that returns the collision hulls of a record.
      support: the ground.
    """

    def __init__(self, hulls_of: Callable[[AssetRecord], HullSet], support: overlap.Support) -> None:
        self._hulls_of, self._support = hulls_of, support
        self._known: dict[tuple[str, Vector], bool] = {}

    def concerns(self, obj: GraphObject, leaf: str) -> bool:
        """Whether an object whose asset has this leaf is put on the ground and could fall there."""
        foot = obj.center[2] - obj.size[2] / 2
        floor = max(self._support.under(obj) or self._support.near(obj, standing.GROUND_DISTANCE), default=np.inf)
        return not is_held(leaf) and foot <= floor + standing.SUPPORT_DISTANCE

    def stands(self, candidate: Candidate) -> bool:
        """Whether a candidate stands on level ground, scaled to its box."""
        record = candidate.record
        if lying.is_lying(record.uid):
            return True
        scale = choice.scale_to(candidate.box, record)
        key = (record.uid, scale)
        if key not in self._known:
            factor = np.array(scale)
            self._known[key] = rest_poses.stands([h * factor for h in self._hulls_of(record).hulls])
        return self._known[key]

    def serves(self, obj: GraphObject, candidate: Candidate) -> bool:
        """Whether a candidate stays where it is put for an object."""
        return self.stands(candidate) or not self.concerns(obj, candidate.match.leaf)

    def choose(
        self, obj: GraphObject, drawn: list[Candidate], found: Sequence[Candidate], draw: Callable[..., list[Candidate]]
    ) -> list[Candidate]:
        """The candidates drawn for an object's cousins, with others in the places of those that do not stand.

        Args:
          drawn: one candidate for each cousin.
          found: all candidates of the object.
          draw: function that draws one for each cousin among candidates, at least one.
        """
        if not self.concerns(obj, drawn[0].match.leaf) or all(self.stands(c) for c in drawn):
            return drawn
        firm = [c for c in found if self.stands(c)]
        others = draw(firm) if firm else [self._laid(c) for c in drawn]
        return [c if self.stands(c) else other for c, other in zip(drawn, others, strict=True)]

    @staticmethod
    def _laid(candidate: Candidate) -> Candidate:
        """The lying form of a candidate that a person can move, in its own size; else the candidate."""
        record = lying.lying(candidate.record) if candidate.record.movable else None
        return candidate if record is None else dataclasses.replace(candidate, record=record, box=record.extent_xyz)
