"""Areas of a grid become polygons: every border once, straight where the street is, and nothing lost on the way."""

import itertools

import numpy as np
import pytest
import scipy.ndimage
import shapely

from urbanverse_mjx.distillation import coverage
from urbanverse_mjx.distillation.borders import strokes
from urbanverse_mjx.distillation.straight_pieces import FitOptions, straight_pieces

CELL = 0.25
ROAD, CROSSING, PAVEMENT = 1, 2, 3
#: 0 with the outside, 2 along the carriageway, 1 any other.
SORTS = np.array([[0, 0, 0, 0], [0, 1, 1, 2], [0, 1, 1, 2], [0, 2, 2, 1]])


def random_labels(seed: int, side: int = 64, blur: float = 5.0) -> np.ndarray:
    """Blobs of four labels, 0 among them."""
    rng = np.random.default_rng(seed)
    fields = [scipy.ndimage.gaussian_filter(rng.normal(size=(side, side)), blur) for _ in range(4)]
    return np.argmax(fields, 0).astype(np.uint8)


def areas(labels: np.ndarray, known: np.ndarray | None = None, min_area: float = 3.0) -> list[coverage.Area]:
    sure = labels > 0 if known is None else known
    return coverage.areas(labels, sure, SORTS, np.zeros(2), CELL, min_area)


def middles(shape: tuple[int, ...]) -> np.ndarray:
    return (np.moveaxis(np.indices(shape), 0, -1) + 0.5) * CELL


def across(shape: tuple[int, int], slope: float, at: float) -> np.ndarray:
    """(X, Y) m: how far cells lie left of the line y = at + slope x."""
    xy = middles(shape)
    return (xy[..., 1] - at - slope * xy[..., 0]) / np.hypot(1.0, slope)


@pytest.mark.parametrize("seed", range(6))
def test_every_border_is_in_one_stroke_once(seed: int) -> None:
    labels = random_labels(seed, 16, 1.0 if seed % 2 else 0.3)
    padded = np.pad(labels, 1)
    edges = [
        frozenset(map(tuple, pair)) for s in strokes(labels, SORTS) for pair in itertools.pairwise(s.corners.tolist())
    ]
    assert len(set(edges)) == len(edges)
    assert len(edges) == (padded[1:] != padded[:-1]).sum() + (padded[:, 1:] != padded[:, :-1]).sum()
    for stroke in strokes(labels, SORTS):
        one, other = padded.ravel()[stroke.sides].T
        assert (one != other).all()


@pytest.mark.parametrize("seed", range(8))
def test_any_grid_becomes_a_coverage_that_keeps_its_areas(seed: int) -> None:
    labels = random_labels(seed)
    made = areas(labels)
    polygons = [a.polygon for a in made]
    assert all(p.is_valid for p in polygons)
    # No two overlap, and where two touch both have all corners.
    assert shapely.coverage_is_valid(polygons)
    total = sum(p.area for p in polygons)
    assert total == pytest.approx(shapely.union_all(polygons).area, abs=1e-6)
    assert total == pytest.approx((labels > 0).sum() * CELL**2, rel=0.03)
    points = middles(labels.shape)
    for label in (1, 2, 3):
        inside = np.zeros(labels.shape, bool)
        for area in made:
            if area.label == label:
                inside |= shapely.contains_xy(area.polygon, points[..., 0], points[..., 1])
        # What is more than three cells inside an area (and of more than `min_area`) stays of its label.
        deep = scipy.ndimage.binary_erosion(labels == label, iterations=4)
        assert inside[deep].mean() > 0.95


def test_corners_lie_on_whole_millimetres() -> None:
    corners = shapely.get_coordinates([a.polygon for a in areas(random_labels(1))])
    assert np.abs(corners * 1000 - np.round(corners * 1000)).max() < 1e-6


def street(slope: float, seed: int = 0) -> np.ndarray:
    """80 m of road, 7 m wide between two pavements, with a crossing; cells at borders are wrong as votes are."""
    rng = np.random.default_rng(seed)
    shape = (320, 100)
    noise = scipy.ndimage.gaussian_filter(rng.normal(size=shape), 1.0) * 0.3
    low, high = (across(shape, slope, at) + noise for at in (6.0, 13.0))
    labels = np.where((low > 0) & (high < 0), ROAD, PAVEMENT)
    xy = middles(shape)
    labels[(labels == ROAD) & (abs(xy[..., 0] + slope * xy[..., 1] - 40.0) < 2.0)] = CROSSING
    labels[(across(shape, slope, 3.0) < 0) | (across(shape, slope, 17.0) > 0)] = 0
    return labels.astype(np.uint8)


def kerb_errors(made: list[coverage.Area], slope: float, *at: float) -> np.ndarray:
    """m: how far points every 5 cm of the borders between carriageway and pavement lie from the true kerbs."""
    driven = shapely.union_all([a.polygon for a in made if a.label in (ROAD, CROSSING)])
    walked = shapely.union_all([a.polygon for a in made if a.label == PAVEMENT])
    kerb = shapely.get_parts(shapely.line_merge(driven.boundary.intersection(walked.boundary)))
    points = np.concatenate([shapely.get_coordinates(p.segmentize(0.05)) for p in kerb])
    return np.abs([(points[:, 1] - y - slope * points[:, 0]) / np.hypot(1.0, slope) for y in at]).min(0)


@pytest.mark.parametrize("slope", [0.0, 0.03, 0.12])
def test_noisy_stairs_of_a_street_are_straight_to_5_cm(slope: float) -> None:
    labels = street(slope)
    made = areas(labels)
    errors = kerb_errors(made, slope, 6.0, 13.0)
    assert errors.max() < 0.05
    assert len(errors) * 0.05 > 150.0
    # Road, crossing, road and two pavements: corners of plain strips, and those where the crossing ends.
    assert len(made) == 5
    plain = [shapely.Polygon(a.polygon.exterior).simplify(0.002) for a in made]
    assert sum(shapely.get_num_coordinates(p) - 1 for p in plain) <= 24


def test_what_stands_at_a_kerb_leaves_no_bulge() -> None:
    labels, known = street(0.05), np.ones((320, 100), bool)
    xy = middles(labels.shape)
    # One van of 3 m that was voted wrongly, and 8 m that nobody saw.
    for x, long, seen in ((20.0, 3.0, True), (60.0, 8.0, False)):
        bulge = (abs(xy[..., 0] - x) < long / 2) & (abs(across(labels.shape, 0.05, 13.0)) < 1.2)
        labels[bulge] = ROAD
        known[bulge] = seen
    assert kerb_errors(areas(labels, known), 0.05, 6.0, 13.0).max() < 0.06


def test_a_bay_that_was_seen_stays() -> None:
    labels = street(0.0)
    bay = np.abs(middles(labels.shape)[..., 0] - 60.0) < 6.0
    labels[bay & (np.abs(across(labels.shape, 0.0, 14.0)) < 1.0)] = ROAD
    road = shapely.union_all([a.polygon for a in areas(labels) if a.label == ROAD])
    true = shapely.box(54.0, 13.0, 66.0, 15.0)
    assert road.intersection(true).area > 0.93 * true.area


def test_a_round_kerb_stays_within_its_tolerance() -> None:
    xy = middles((200, 200))
    away = np.hypot(xy[..., 0], xy[..., 1])
    labels = np.where(away < 12.0, PAVEMENT, np.where(away < 40.0, ROAD, 0)).astype(np.uint8)
    (pavement,) = (a.polygon for a in areas(labels) if a.label == PAVEMENT)
    outline = shapely.get_coordinates(pavement.exterior.segmentize(0.1))
    round_part = outline[(outline > 0.5).all(1)]
    assert np.abs(np.hypot(*round_part.T) - 12.0).max() < 0.25
    assert len(pavement.exterior.coords) < 14


@pytest.mark.parametrize("width", [0.75, 1.0])
def test_thin_strips_survive(width: float) -> None:
    shape = (200, 60)
    kerb = across(shape, 0.04, 5.0)
    labels = np.select([kerb < 0, kerb < width], [ROAD, CROSSING], PAVEMENT).astype(np.uint8)
    (strip,) = (a.polygon for a in areas(labels) if a.label == CROSSING)
    assert strip.area == pytest.approx(50.0 * width, rel=0.1)
    assert shapely.minimum_clearance(strip) > 0.5 * width


def test_small_areas_join_the_neighbour_round_them() -> None:
    labels = np.full((40, 40), ROAD, np.uint8)
    labels[10:14, 10:14] = PAVEMENT
    (road,) = areas(labels)
    assert road.polygon.area == pytest.approx(100.0, rel=0.005)
    assert not road.polygon.interiors


def test_what_is_enclosed_is_a_hole_of_what_is_round_it() -> None:
    labels = np.full((80, 80), ROAD, np.uint8)
    labels[30:50, 30:50] = PAVEMENT
    labels[5:20, 5:20] = 0
    made = {a.label: a.polygon for a in areas(labels)}
    assert made[PAVEMENT].area == pytest.approx(25.0, rel=0.02)
    assert len(made[ROAD].interiors) == 2
    assert made[ROAD].area == pytest.approx(400.0 - 25.0 - 14.06, rel=0.01)


@pytest.mark.parametrize(
    "labels",
    [
        np.zeros((5, 5), np.uint8),
        np.zeros((0, 0), np.uint8),
        np.ones((1, 1), np.uint8),
        np.indices((9, 9)).sum(0).astype(np.uint8) % 2,
        np.eye(8, dtype=np.uint8),
    ],
)
def test_degenerate_grids_give_few_or_no_areas(labels: np.ndarray) -> None:
    made = areas(labels, min_area=0.0)
    assert sum(a.polygon.area for a in made) <= labels.size * CELL**2 + 1e-6
    assert all(a.polygon.is_valid for a in made)


def test_a_corner_of_two_lines_is_found_between_the_points() -> None:
    rng = np.random.default_rng(0)
    along = np.arange(0.0, 20.0, 0.25)
    points = np.concatenate([np.c_[along, 0.1 * along], np.c_[20.0 + 0 * along, 2.0 + along]])
    noisy = points + rng.normal(0.0, 0.05, points.shape)
    corners = straight_pieces(noisy, np.ones(len(noisy)), False, FitOptions())
    assert np.linalg.norm(corners - [[0.0, 0.0], [20.0, 2.0], [20.0, 21.75]], axis=1).max() < 0.15
    assert np.linalg.norm(corners[1] - [20.0, 2.0]) < 0.05


def test_too_few_points_come_back() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0]])
    assert (straight_pieces(points, np.ones(2), False, FitOptions()) == points).all()
