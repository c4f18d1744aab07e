"""Determines the support of an object: the ground, another object, or none if it hangs."""

import dataclasses
from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from ..assets.categories.priors import prior
from ..datatypes import GraphObject
from . import overlap

#: m; a box stands on the surface below if its lower end is within this distance of it.
SUPPORT_DISTANCE = 0.3
#: m; distance from ground up to which its height is used (house fronts stand behind the pavement).
GROUND_DISTANCE = 10.0
#: Categories that never hang; if their box ends above the ground, the lower part was hidden.
GROUNDED = frozenset({"parked", "rolls", "alive"})
#: Largest ratio of the completed height to the greatest known height of a leaf for which a high lower end is explained
#: by a hidden part.
MAX_HIDDEN_RATIO = 1.1


@dataclasses.dataclass(frozen=True)
class Placement:
    """Vertical placement of an object's asset.

    Attributes:
      z: m, height of the asset's origin.
      height: m, height of the box that the asset fills; more than the graph's if a lower part was hidden.
      on: id of the object that supports it, or None.
    """

    z: float
    height: float
    on: str | None = None


@dataclasses.dataclass(frozen=True)
class Top:
    """A level top on which objects may stand: id of its object, outline, height (m)."""

    id: str
    outline: BaseGeometry
    z: float


def place_on_support(obj: GraphObject, leaf: str, support: overlap.Support, tops: Sequence[Top] = ()) -> Placement:
    """Places an object on its support.

    The support is the ground if the object's lower end is within `SUPPORT_DISTANCE` of it; otherwise another object's
    top within `SUPPORT_DISTANCE`. Otherwise an object that cannot hang, or whose leaf is tall enough to reach the
    ground, stands on the ground and keeps its upper end. All others hang at their height (signs and awnings on walls).
    """
    middle, size = obj.center, obj.size
    foot, head = middle[2] - size[2] / 2, middle[2] + size[2] / 2
    below = min(support.under(obj) or support.near(obj, GROUND_DISTANCE), key=lambda z: abs(z - foot), default=None)
    if below is not None and abs(below - foot) <= SUPPORT_DISTANCE:
        return Placement(below, size[2])
    here = shapely.Point(middle[:2])
    carrying = [t for t in tops if t.id != obj.id and abs(t.z - foot) <= SUPPORT_DISTANCE and t.outline.covers(here)]
    if carrying:
        top = min(carrying, key=lambda t: abs(t.z - foot))
        return Placement(top.z, size[2], top.id)
    if below is None:
        return Placement(foot, size[2])
    row = prior(leaf)
    reaches = row.rest != "hangs" and 0.0 < head - below <= MAX_HIDDEN_RATIO * row.height[2]
    if foot < below:  # below ground by an error of depth: no object is placed below the ground
        return Placement(below, size[2])
    if reaches:
        return Placement(below, head - below)
    return Placement(below if row.rest in GROUNDED else foot, size[2])
