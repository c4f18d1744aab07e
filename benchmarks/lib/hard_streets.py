"""Test streets of the perception model at dusk, at night, and on a slope with steps.

The street keeps its objects and its plan, so that a camera at the same place sees the same objects.
"""

import dataclasses
import math
from collections.abc import Callable

from urbanverse_mjx.assets import AssetIndex
from urbanverse_mjx.datatypes import PlacedGround, PlacedObject, SceneLayout
from urbanverse_mjx.distillation.perception_model.classes import HOUSE, class_of_leaf

#: Skies by condition (`assets.appearances.sky_maps`); a street takes one by its number.
SKIES = {
    "dusk": ("winter_dusk-clear", "winter_dusk-scattered_cumulus", "winter_dusk-overcast"),
    "night": ("night-clear", "night-scattered_cumulus", "night-overcast"),
}
GRADE = 0.12  # rise of the street along x; 8 to 12 % is usual for steep streets
TREAD = 1.0  # m; the pavements left of the street climb in steps of TREAD * GRADE

Corner = tuple[float, float]


def under_sky(layout: SceneLayout, condition: str, number: int) -> SceneLayout:
    """The street with the sky of a condition of `SKIES`."""
    skies = SKIES[condition]
    return dataclasses.replace(layout, sky=skies[number % len(skies)])


def rise(x: float, y: float, half: float) -> float:
    """Height (m) by which the ground of the sloping street lies above that of the flat one.

    Off by up to half a step (6 cm) where the ground left of the street is no pavement, which has no steps.

    Args:
      half: m, half of the carriageway; the left pavement (y > half) has steps.
    """
    return GRADE * (math.floor(x / TREAD) + 0.5) * TREAD if y > half else GRADE * x


def steep(layout: SceneLayout, half: float, index: AssetIndex) -> SceneLayout:
    """The street on a slope of `GRADE` along x, with steps for a pavement on the left.

    Houses stand upright with their lowest corner on the ground, as houses are set into a slope.

    Args:
      half: m, half of the carriageway.
    """
    ground: list[PlacedGround] = []
    for region in layout.ground:
        if region.kind == "sidewalk" and min(y for _, y in region.polygon) > half - 1e-6:
            ground += _treads(region)
        else:
            a, b, c = region.plane
            ground.append(dataclasses.replace(region, plane=(a + GRADE, b, c)))
    return dataclasses.replace(
        layout,
        id=f"{layout.id}_steep",
        objects=tuple(_raised(x, half, index) for x in layout.objects),
        ground=tuple(ground),
    )


def _raised(placed: PlacedObject, half: float, index: AssetIndex) -> PlacedObject:
    x, y, z = placed.position
    lift = rise(x, y, half)
    if class_of_leaf(placed.category) == HOUSE:
        depth, width, _ = index.get(placed.asset_uid).extent_xyz
        across = abs(math.sin(placed.yaw)) * width + abs(math.cos(placed.yaw)) * depth
        lift = GRADE * (x - across * placed.scale[0] / 2.0)
    return dataclasses.replace(placed, position=(x, y, round(z + lift, 6)))


def _treads(region: PlacedGround) -> list[PlacedGround]:
    """A region cut along x into treads: each keeps its own plane and is raised as a whole."""
    a, b, c = region.plane
    first = math.floor(min(x for x, _ in region.polygon) / TREAD)
    last = math.ceil(max(x for x, _ in region.polygon) / TREAD)
    out = []
    for k in range(first, last):
        ring = _clip(region.polygon, lambda p, k=k: p[0] - k * TREAD)
        ring = _clip(ring, lambda p, k=k: (k + 1) * TREAD - p[0])
        if _area(ring) > 1e-3:
            plane = (a, b, c + GRADE * (k + 0.5) * TREAD)
            out.append(
                dataclasses.replace(region, id=f"{region.id}_tread_{k - first}", polygon=tuple(ring), plane=plane)
            )
    return out


def _clip(ring: tuple[Corner, ...] | list[Corner], side: Callable[[Corner], float]) -> list[Corner]:
    """The part of a convex ring on which `side` is positive (Sutherland and Hodgman, 1974)."""
    out: list[Corner] = []
    for p, q in zip(ring, [*ring[1:], *ring[:1]], strict=True):
        at, after = side(p), side(q)
        if at >= 0.0:
            out.append(p)
        if (at > 0.0 > after) or (at < 0.0 < after):
            t = at / (at - after)
            out.append((round(p[0] + t * (q[0] - p[0]), 6), round(p[1] + t * (q[1] - p[1]), 6)))
    return out


def _area(ring: list[Corner]) -> float:
    return abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(ring, [*ring[1:], *ring[:1]], strict=True))) / 2.0
