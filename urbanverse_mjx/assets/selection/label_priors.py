"""Makes the `LabelPrior`s that the distillation uses from the ontology, the priors and the index."""

import functools

import numpy as np

from urbanverse_mjx.datatypes import AssetRecord, LabelPrior

from ..categories.ontology import UnknownLabelError, category_of, nearest_leaves
from ..categories.priors import prior
from ..records.index import AssetIndex, build_mesh

#: Categories of objects that drive or park on the carriageway; all others stand beside it.
_ON_ROAD = ("private vehicle", "public vehicle", "construction vehicle", "emergency vehicle")
#: Categories that move by themselves and may be anywhere.
_ANYWHERE = ("person", "animal", "robot")
#: Light vehicles, which are parked on the pavement as well as on the road.
_LIGHT = ("bicycle", "scooter", "motorcycle", "cyclist", "moped", "e-scooter", "handcart", "stroller", "wheelchair")
_BESIDE = ("sidewalk", "ground")
#: Objects that are also placed on carriageways, for example by road works.
_BOTH = ("access control barrier", "obstacle barrier", "street trash", "terrain")
_SURFACE = 1500  # points on a known shape


def stands_on(leaf: str) -> tuple[str, ...]:
    """Kinds of ground on which a leaf is usually found; empty = any."""
    top, middle, _ = category_of(leaf)
    if middle in _ON_ROAD and leaf not in _LIGHT:
        return ("road", "crosswalk")
    if middle in (*_ANYWHERE, *_BOTH) or top == "road" or leaf in _LIGHT:
        return ()
    return _BESIDE


class LabelPriors:
    """Callable label -> `LabelPrior`; labels that are not leaves get the prior of their nearest leaf.

    Args:
      index: index whose records define the known sizes.
    """

    def __init__(self, index: AssetIndex) -> None:
        self._index = index
        self._find = functools.cache(self._look_up)

    def __call__(self, label: str) -> LabelPrior:
        return self._find(label)

    def _look_up(self, label: str) -> LabelPrior:
        try:
            records = self._index.by_label(label)
            leaf = records[0].leaf if records else nearest_leaves(label)[0]
        except UnknownLabelError as error:
            records, leaf = (), error.nearest[0]
        known, house = prior(leaf), category_of(leaf)[0] == "building"
        return LabelPrior(
            extents=[r.extent_xyz for r in records],  # type: ignore[arg-type]
            on_ground=known.rest != "hangs",
            stands_on=stands_on(leaf),
            fixed=known.rest not in ("alive", "rolls"),
            faces_road=house,
            # A capture shows only one side of a house, so the shape adds no information to the size.
            shapes=() if house else tuple(_surface(r) for r in records),
        )


def _surface(record: AssetRecord) -> np.ndarray:
    """(`_SURFACE`, 3) m, points distributed uniformly over a record's mesh."""
    mesh = build_mesh(record)
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(0)
    face = rng.choice(len(corners), _SURFACE, p=area / area.sum())
    weight = rng.dirichlet((1.0, 1.0, 1.0), _SURFACE)
    return np.einsum("pk,pki->pi", weight, corners[face])
