"""A small index of boxes: three sizes of every object in the street catalogue, so that materialisation is tested on its
own."""

import functools
import itertools

import numpy as np

from urbanverse_mjx.assets import AssetIndex, category_of
from urbanverse_mjx.citygen.catalogue import SIZES, STEMS
from urbanverse_mjx.datatypes import AssetRecord, HullSet

MOVABLE = {"chair", "garbage bag", "traffic cone", "scooter", "storage box", "parcels", "advertising board"}


def record(leaf: str, variant: int, extent: tuple[float, float, float], movable: bool) -> AssetRecord:
    volume = float(np.prod(extent))
    return AssetRecord(
        uid=f"{leaf.replace(' ', '-')}/box/{variant:03d}",
        category=category_of(leaf),
        description=f"a box as large as a {leaf}",
        recipe="box",
        params={"variant": variant},
        extent_xyz=extent,
        length=max(extent[:2]),
        width=min(extent[:2]),
        height=extent[2],
        volume=volume,
        mass=100.0 * volume,
        materials=("wood",),
        friction_coefficient=0.6,
        movable=movable,
        required_force=10.0,
        licence="Apache-2.0",
        provenance="test",
    )


@functools.cache
def fake_index() -> AssetIndex:
    """Three boxes per leaf: the catalogue's size, 2 % smaller all over, and 40 % longer."""
    records = []
    for leaf, (size, *_) in SIZES.items():
        for k, factors in enumerate(((1.0, 1.0, 1.0), (0.98, 0.98, 0.98), (1.4, 1.0, 1.0))):
            if leaf in STEMS and k == 2:
                continue  # a longer crown or arm would need streets planned for it
            x, y, z = (round(s * f, 4) for s, f in zip(size, factors, strict=True))
            records.append(record(leaf, k, (x, y, z), leaf in MOVABLE))
    return AssetIndex(records)


def box(x: float, y: float, low: float, high: float) -> np.ndarray:
    """(8, 3) corners of a box around the asset's upright axis."""
    return np.array(list(itertools.product((-x / 2, x / 2), (-y / 2, y / 2), (low, high))), np.float32)


def round_prism(x: float, y: float, low: float, high: float) -> np.ndarray:
    """(24, 3) corners of an upright prism over an ellipse."""
    angles = np.arange(12) * np.pi / 6
    ring = np.stack([x / 2 * np.cos(angles), y / 2 * np.sin(angles)], 1)
    return np.concatenate([np.column_stack([ring, np.full(12, z)]) for z in (low, high)]).astype(np.float32)


def box_hulls(asset: AssetRecord) -> HullSet:
    """The asset's box as one hull; slender objects are a stem and an overhang above 2.2 m."""
    x, y, z = asset.extent_xyz
    stem = STEMS.get(asset.leaf)
    if stem is None:
        return HullSet((box(x, y, 0.0, z),))
    pole = box(stem.side, stem.side, 0.0, z) + np.array([stem.offset * x / 2, 0.0, 0.0], np.float32)
    over_heads = min(2.2, 0.9 * z)
    crown = round_prism(x, y, over_heads, z) if asset.leaf == "tree" else box(x, y, over_heads, z)
    return HullSet((pole, crown))
