"""The support of an object: the ground, another object, or none, because it hangs."""

import dataclasses
from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from ..assets.categories.priors import prior
from ..datatypes import GraphObject
from . import overlap

#: m: a box whose lower end is this near to the surface below stands on it.
SNAP = 0.3
#: m: how far off any ground the ground's height still counts (house fronts stand behind the pavement).
REACH = 10.0
#: Categories that never hang, whatever their box: the lower part was hidden.
GROUNDED = frozenset({"parked", "rolls", "alive"})
#: Factor over the greatest height that is known of a leaf up to which a hidden lower part explains a high foot.
HIDDEN = 1.1


@dataclasses.dataclass(frozen=True)
class Placement:
    """Where an object's asset is put.

    Attributes:
      z: m, height of the asset's origin.
      height: m, of the box that the asset fills: more than the graph's where a lower part was hidden.
      on: id of the object that carries it, or None.
    """

    z: float
    height: float
    on: str | None = None


@dataclasses.dataclass(frozen=True)
class Top:
    """An even top that objects may stand on: id of its owner, outline from above, height (m)."""

    id: str
    outline: BaseGeometry
    z: float


def place_on_support(obj: GraphObject, leaf: str, support: overlap.Support, tops: Sequence[Top] = ()) -> Placement:
    """Puts an object on what carries it.

    On the ground where its foot is within `SNAP` of it. Else on another object's top that is as near; else, where it
    cannot hang or where its leaf grows tall enough to reach down, on the ground with its upper end where it was seen;
    else where it is: signs and awnings hang on walls.
    """
    middle, size = obj.center, obj.size
    foot, head = middle[2] - size[2] / 2, middle[2] + size[2] / 2
    below = min(support.under(obj) or support.near(obj, REACH), key=lambda z: abs(z - foot), default=None)
    if below is not None and abs(below - foot) <= SNAP:
        return Placement(below, size[2])
    here = shapely.Point(middle[:2])
    carrying = [t for t in tops if t.id != obj.id and abs(t.z - foot) <= SNAP and t.outline.covers(here)]
    if carrying:
        top = min(carrying, key=lambda t: abs(t.z - foot))
        return Placement(top.z, size[2], top.id)
    if below is None:
        return Placement(foot, size[2])
    row = prior(leaf)
    reaches = row.rest != "hangs" and 0.0 < head - below <= HIDDEN * row.height[2]
    if foot < below:  # sunk, or from a wrong depth: no object is placed below the ground
        return Placement(below, size[2])
    if reaches:
        return Placement(below, head - below)
    return Placement(below if row.rest in GROUNDED else foot, size[2])
