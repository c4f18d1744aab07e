"""Splits scenes into halves (paper, "spatial horizon": each scene is truncated to about 100 m, which gives two)."""

import dataclasses

import numpy as np
import shapely

from ..datatypes import PlacedGround, SceneLayout
from ..datatypes import validation as v

#: m; closer corners are merged. Corners are not rounded, so that neighbours still touch after the cut.
_MERGE_DISTANCE = 1e-4
#: m²; smaller pieces of ground are left out.
_MIN_AREA = 0.05


def half_layouts(layout: SceneLayout) -> tuple[SceneLayout, SceneLayout]:
    """Cuts a layout across its longer direction, with half of the ground on either side.

    Objects belong to the half that contains their origin; ground is cut. Ids end in `_Half_01` and `_Half_02`.

    Raises:
      ValidationError: a half has no ground.
    """
    origin, along = _axis(layout)
    place = np.array([g for r in layout.ground for g in r.polygon])
    span = float(np.linalg.norm(place - origin, axis=1).max()) + 1.0
    return _half(layout, origin, -along, span, 1), _half(layout, origin, along, span, 2)


def _axis(layout: SceneLayout) -> tuple[np.ndarray, np.ndarray]:
    """(2,) m, a point of the cut, and (2,) its unit normal, towards positive x or y."""
    ground = [shapely.Polygon(r.polygon) for r in layout.ground]
    # The centres of the ground's triangles, weighted by area, give the distribution of the ground.
    pieces = [t for g in ground for t in shapely.get_parts(shapely.constrained_delaunay_triangles(g))]
    middle, area = np.array([[t.centroid.x, t.centroid.y] for t in pieces]), np.array([t.area for t in pieces])
    mean = (middle * area[:, None]).sum(0) / area.sum()
    away = middle - mean
    along = np.linalg.eigh((away * area[:, None]).T @ away)[1][:, 1]
    along = along if along[np.abs(along).argmax()] > 0 else -along
    order = np.argsort(away @ along, kind="stable")
    half = np.searchsorted(np.cumsum(area[order]), area.sum() / 2)
    at = float((away @ along)[order[min(half, len(order) - 1)]])
    return mean + at * along, along


def _half(layout: SceneLayout, origin: np.ndarray, out: np.ndarray, span: float, number: int) -> SceneLayout:
    """The half on the side of the cut that `out` points to."""
    across = np.array([-out[1], out[0]]) * span
    far = out * span
    side = shapely.Polygon([origin - across, origin + across, origin + across + far, origin - across + far])
    ground: list[PlacedGround] = []
    for region in layout.ground:
        cut = shapely.intersection(shapely.Polygon(region.polygon), side)
        pieces = [p for p in shapely.get_parts(cut) if isinstance(p, shapely.Polygon) and p.area >= _MIN_AREA]
        for k, piece in enumerate(pieces):
            ring = tuple((x, y) for x, y in shapely.remove_repeated_points(piece, _MERGE_DISTANCE).exterior.coords[:-1])
            name = region.id if len(pieces) == 1 else f"{region.id}_{k}"
            ground.append(dataclasses.replace(region, id=name, polygon=ring))
    if not ground:
        raise v.fail(f"layout {layout.id!r}", "ground on one side of its middle alone", "ground on both sides")
    objects = tuple(o for o in layout.objects if (np.array(o.position[:2]) - origin) @ out >= 0)
    hashes = {**layout.hashes, "half_of": layout.content_hash()}
    name = f"{layout.id}_Half_{number:02d}"
    return dataclasses.replace(layout, id=name, objects=objects, ground=tuple(ground), hashes=hashes)
