"""Computes statistics of a compiled scene: objects, ground, kerbs, and the free width of pavements."""

import collections
import dataclasses
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from skimage.measure import find_contours
from skimage.morphology import skeletonize

from ..assets.categories import ontology
from ..datatypes.ground import GROUND_KINDS, KIND_INDEX
from ..geometry import rotations
from ..geometry.grids import closed, pooled
from .geometry import SceneGeometry, SceneMap
from .maps import tops
from .planner import MIN_KERB_STEP

#: m, least horizontal sides and height of houses (vegetation and vehicles are excluded).
HOUSE_SIDE, HOUSE_HEIGHT = 4.0, 3.0
_NO_HOUSES = ("nature", "vehicle", "street user")
#: Widths (m) below which a pavement is counted as narrow: a delivery robot (twice 0.35 m), the 36 inches of the U.S.
#: accessible route (ADA Standards 403.5.1), the 48 inches of the U.S. pedestrian access route (PROWAG R302.2).
NARROW = {"robot": 0.70, "ada": 0.915, "prowag": 1.22}
#: m, widths between kerb and house for which national surveys report shares.
WIDTHS = (2.0, 3.0)
#: m; objects below this height above the ground narrow a pavement (height of a delivery robot).
HEAD_HEIGHT = 1.0
#: m; narrower strips are not counted as pavement (remainders in corners and before steps), nor are gaps between houses
#: up to the second width.
MIN_PAVEMENT_WIDTH, _MAX_HOUSE_GAP = 0.9, 1.5


@dataclasses.dataclass(frozen=True)
class SectionOptions:
    """Options of the cross-sections of pavements; chosen manually.

    Attributes:
      spacing: m between cross-sections.
      pooled_cells: cells of the map along a side of a cell of the grid on which centre lines are computed.
      direction_radius: m around the centre of a cross-section within which the centre line's direction is computed.
      max_width_ratio: a cross-section wider than twice the distance to the nearest border by this factor extends into a
        corner and is not used.
    """

    spacing: float = 0.5
    pooled_cells: int = 2
    direction_radius: float = 1.0
    max_width_ratio: float = 1.3


_OPTIONS = SectionOptions()


@dataclasses.dataclass(frozen=True)
class PavementWidths:
    """Cross-sections of all pavements of a scene, one in each square of half a metre that their middle lines cross:
    every half metre along x or y, at 45 degrees every 0.71 m.

    Attributes:
      full: (n,) m between kerb and house.
      clear: (n,) m, the widest gap between the objects there.
    """

    full: np.ndarray
    clear: np.ndarray


def scene_statistics(geometry: SceneGeometry) -> dict[str, Any]:
    """The scene's statistics for `metadata.json`; lengths in m, areas in m²."""
    houses = house_mask(geometry)
    categories = collections.Counter(geometry.object_categories)
    widths = pavement_widths(geometry, houses)
    places = geometry.object_position[~houses, :2]
    return {
        "objects": len(geometry.object_ids),
        "houses": int(houses.sum()),
        "categories": dict(sorted(categories.items())),
        "ground_area_m2": ground_areas(geometry.map),
        "kerbs": kerbs(geometry.map),
        "spacing_m": _quantiles(_nearest(places)),
        "pavement": {
            "length_m": round(len(widths.full) * _OPTIONS.spacing, 1),
            "width_m": _quantiles(widths.full),
            "clear_width_m": _quantiles(widths.clear),
            "width_under": {f"{width:g}": _share(widths.full < width) for width in WIDTHS},
            "narrower_than": {name: _share(widths.clear < width) for name, width in NARROW.items()},
        },
    }


def house_mask(geometry: SceneGeometry) -> np.ndarray:
    """(O,) bool, which objects are houses, whose ground is not walkable."""
    sizes = np.array([mesh.extent for mesh in geometry.meshes])[geometry.object_mesh].reshape(-1, 3)
    tall = (sizes[:, :2].min(1, initial=np.inf) >= HOUSE_SIDE) & (sizes[:, 2] >= HOUSE_HEIGHT)
    known = ontology.categories()
    built = np.array([known.get(c, ("",))[0] not in _NO_HOUSES for c in geometry.object_categories], bool)
    return tall & built


def ground_areas(scene_map: SceneMap) -> dict[str, float]:
    """Area in m² of each kind of ground in the scene."""
    cells = np.bincount(scene_map.kind.ravel(), minlength=len(GROUND_KINDS))
    named = zip(GROUND_KINDS[1:], cells[1:], strict=True)
    return {name: round(float(n) * scene_map.resolution**2, 1) for name, n in named if n}


def kerbs(scene_map: SceneMap) -> dict[str, float]:
    """Length (m) of the road's border at which the adjacent ground is over 3 cm higher or lower, and the median of
    these steps."""
    road = np.isin(scene_map.kind, [KIND_INDEX[k] for k in ("road", "road_marking", "crosswalk")])
    known = np.isfinite(scene_map.height)
    step = ndimage.maximum_filter(np.where(known, scene_map.height, -np.inf), 3)
    step = step - ndimage.minimum_filter(np.where(known, scene_map.height, np.inf), 3)
    total, steps = 0.0, [np.zeros(0)]
    for line in find_contours(road.astype(np.float32), 0.5):
        legs = np.linalg.norm(np.diff(line, axis=0), axis=1) * scene_map.resolution
        middle = ((line[1:] + line[:-1]) / 2).round().astype(int)
        high = step[middle[:, 0], middle[:, 1]]
        is_kerb = np.isfinite(high) & (high > MIN_KERB_STEP)
        total += float(legs[is_kerb].sum())
        steps.append(high[is_kerb])
    found = np.concatenate(steps)
    return {"length_m": round(total, 1), "height_m": round(float(np.median(found)), 3) if len(found) else 0.0}


def pavement_widths(geometry: SceneGeometry, houses: np.ndarray | None = None) -> PavementWidths:
    """Widths of the pavements up to the houses, and of the free gaps between the objects on them."""
    m = geometry.map
    houses = house_mask(geometry) if houses is None else houses
    of_house = np.flatnonzero(houses[geometry.inst_object])
    objects = geometry.inst_object[of_house]
    roofs = tops(
        m,
        [geometry.hulls[h] for h in geometry.inst_hull[of_house]],
        rotations.matrix(geometry.object_quaternion)[objects],
        geometry.object_position[objects],
    )
    built = closed(roofs > m.height + HEAD_HEIGHT, _MAX_HOUSE_GAP / 2, m.resolution)
    pavement = (m.kind == KIND_INDEX["sidewalk"]) & ~built
    pavement = ndimage.binary_opening(pavement, np.ones((3, 3)))
    clear = pavement & (m.clearance >= HEAD_HEIGHT)
    spots, directions = _middle_lines(pavement, m.resolution)
    rim = ndimage.distance_transform_edt(pavement) * m.resolution
    full, gaps = [np.zeros(0)], [np.zeros(0)]
    reach = rim[tuple(spots.T)] if len(spots) else np.zeros(0)
    # Cross-sections of similar length are processed in one batch.
    for start in range(0, len(spots), 512):
        part = slice(start, start + 512)
        width, gap = _cross(pavement, clear, spots[part], directions[part], reach[part], m.resolution)
        straight = (width <= 2 * _OPTIONS.max_width_ratio * reach[part]) & (width >= MIN_PAVEMENT_WIDTH)
        full.append(width[straight])
        gaps.append(gap[straight])
    return PavementWidths(np.concatenate(full), np.concatenate(gaps))


def _middle_lines(pavement: np.ndarray, resolution: float) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) cells on the centre lines of a mask, one every `spacing` metres, and (n, 2) directions along them."""
    line = np.argwhere(skeletonize(pooled(pavement, _OPTIONS.pooled_cells, np.all)))
    if not len(line):
        return np.zeros((0, 2), int), np.zeros((0, 2))
    pitch = _OPTIONS.pooled_cells * resolution
    _, first = np.unique(np.floor(line * pitch / _OPTIONS.spacing).astype(int), axis=0, return_index=True)
    chosen = line[first]
    near = cKDTree(line).query_ball_point(chosen, _OPTIONS.direction_radius / pitch)
    directions = np.array([_main_axis(line[n]) for n in near])
    return chosen * _OPTIONS.pooled_cells + _OPTIONS.pooled_cells // 2, directions


def _main_axis(points: np.ndarray) -> np.ndarray:
    """(2,) unit vector along which points (n, 2) spread most."""
    away = points - points.mean(0)
    return np.linalg.eigh(away.T @ away)[1][:, 1]


def _cross(
    pavement: np.ndarray, clear: np.ndarray, spots: np.ndarray, along: np.ndarray, reach: np.ndarray, resolution: float
) -> tuple[np.ndarray, np.ndarray]:
    """Width (m) of the pavement and of its widest clear gap across each spot."""
    half = max(2, int(np.ceil(_OPTIONS.max_width_ratio * reach.max(initial=0.0) / resolution)) + 1)
    across = np.stack([-along[:, 1], along[:, 0]], -1)
    steps = np.arange(-half, half + 1)
    cells = np.rint(spots[:, None] + steps[None, :, None] * across[:, None]).astype(int)
    inside = np.all((cells >= 0) & (cells < np.array(pavement.shape)), axis=-1)
    i, j = np.where(inside[..., None], cells, 0).transpose(2, 0, 1)
    on = pavement[i, j] & inside
    # Only the part connected to the centre counts; a pavement beyond a road is another one.
    outward = np.logical_and.accumulate(on[:, half:], axis=1)
    inward = np.logical_and.accumulate(on[:, half::-1], axis=1)
    own = np.concatenate([inward[:, :0:-1], outward], axis=1)
    return own.sum(1) * resolution, _longest_runs(own & clear[i, j]) * resolution


def _longest_runs(rows: np.ndarray) -> np.ndarray:
    """(n,) length of the longest run of True in each row (n, k)."""
    length = np.zeros(len(rows), int)
    best = length.copy()
    for column in rows.T:
        length = np.where(column, length + 1, 0)
        best = np.maximum(best, length)
    return best


def _nearest(places: np.ndarray) -> np.ndarray:
    """(n,) m from each place (n, 2) to the nearest other one."""
    if len(places) < 2:
        return np.zeros(0)
    return cKDTree(places).query(places, 2)[0][:, 1]


def _share(rows: np.ndarray) -> float:
    """Share of True in (n,) bool, 0 for n = 0."""
    return round(float(rows.mean()), 4) if len(rows) else 0.0


def _quantiles(values: np.ndarray) -> dict[str, float]:
    """The 10th, 50th and 90th percentile, empty for no values."""
    if not len(values):
        return {}
    return {f"p{q}": round(float(np.percentile(values, q)), 3) for q in (10, 50, 90)}
