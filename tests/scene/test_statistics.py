"""A simple street with known statistics: two pavements of 60 m by 4 m."""

import numpy as np
import pytest

from tests.support.box_bank import street_regions
from tests.support.toy_assets import TOY_SOURCE, toy_index, toy_layout
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, Source
from urbanverse_mjx.scene import statistics
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.maps import ground_map
from urbanverse_mjx.scene.statistics import ground_areas, house_mask, kerbs, pavement_widths, scene_statistics


def _street(*graph_objects: tuple[float, float, tuple[float, float, float]]) -> SceneGeometry:
    """Boxes of (x, y, size) on the left pavement (y 4 to 8), or wherever."""
    objects = [
        GraphObject(f"o{i}", "bollard", (x, y, 0.15 + size[2] / 2), size, 0.0)
        for i, (x, y, size) in enumerate(graph_objects)
    ]
    source = Source("hand", "Apache-2.0", "none", "none")
    graph = SceneGraph("toy", source, tuple(objects), tuple(street_regions()))
    return scene_geometry(toy_layout(graph, 0), toy_index(), TOY_SOURCE)


def test_a_long_box_in_the_middle_leaves_a_gap_on_either_side() -> None:
    """20 m of a box 1 m wide, 4.5 to 5.5: of 4 m, 2.5 m are left behind it; elsewhere all."""
    widths = pavement_widths(_street((48.0, 5.0, (20.0, 1.0, 1.0))))
    assert np.median(widths.full) == pytest.approx(4.0, abs=0.1)
    narrow = widths.clear < 3.0
    assert widths.clear[narrow] == pytest.approx(2.5, abs=0.2)
    assert widths.clear[~narrow].min() > 3.7
    assert narrow.sum() * 0.5 == pytest.approx(20.0, abs=2.5)


def test_what_hangs_above_heads_is_not_in_the_way() -> None:
    high = GraphObject("sign", "bollard", (48.0, 6.0, 3.5), (4.0, 3.0, 0.5), 0.0)
    graph = SceneGraph("toy", Source("hand", "Apache-2.0", "none", "none"), (high,), tuple(street_regions()))
    widths = pavement_widths(scene_geometry(toy_layout(graph, 0), toy_index(), TOY_SOURCE))
    assert widths.clear.min() > 3.5


def test_a_house_is_the_pavements_rim() -> None:
    """A block of 20 m by 5 m by 6 m on the outer metre of the pavement: 3 m are left, and they are the full width."""
    geometry = _street((45.0, 9.5, (20.0, 5.0, 6.0)))
    assert house_mask(geometry).tolist() == [True]
    widths = pavement_widths(geometry)
    narrow = widths.full < 3.5
    assert widths.full[narrow] == pytest.approx(3.0, abs=0.2)
    np.testing.assert_array_equal(widths.clear[narrow], widths.full[narrow])
    assert scene_statistics(geometry)["houses"] == 1


@pytest.mark.parametrize(
    ("size", "house"),
    [
        ((9.0, 5.0, 6.0), True),
        ((9.0, 5.0, 1.0), False),  # a platform
        ((1.0, 1.0, 6.0), False),  # a post
        ((9.0, 0.5, 6.0), False),  # a wall
    ],
)
def test_a_house_is_wide_and_tall(size: tuple[float, float, float], house: bool) -> None:
    assert house_mask(_street((45.0, 9.5, size))).tolist() == [house]


def test_blockage_is_the_share_of_the_way() -> None:
    """6 m of 120 m of pavement with 0.5 m left on one side and 0 m on the other."""
    pavement = scene_statistics(_street((40.0, 6.3, (6.0, 3.4, 1.5))))["pavement"]
    assert pavement["narrower_than"]["robot"] == pytest.approx(6 / pavement["length_m"], abs=0.02)
    assert pavement["narrower_than"]["robot"] <= pavement["narrower_than"]["ada"] <= pavement["narrower_than"]["prowag"]


def test_spacing_is_to_the_nearest_other_object() -> None:
    pavement = scene_statistics(_street(*((x, 6.0, (0.2, 0.2, 1.0)) for x in (40.0, 42.0, 44.0, 50.0))))
    assert pavement["spacing_m"] == {"p10": 2.0, "p50": 2.0, "p90": pytest.approx(4.8)}
    assert scene_statistics(_street())["spacing_m"] == {}


def rectangle(name: str, kind: str, low: tuple[float, float], high: tuple[float, float], height: float) -> GroundRegion:
    corners = (low, (high[0], low[1]), high, (low[0], high[1]))
    return GroundRegion(name, kind, corners, (0.0, 0.0, height))


def test_kerbs_and_areas_are_those_of_a_plan() -> None:
    """A road of 30 m by 6 m: a pavement 15 cm above it along 20 m of one side, flush ground along the other 10 m, a
    pavement 6 cm below along 12 m of the other side, and nothing at its ends."""
    plan = ground_map(
        [
            rectangle("road", "road", (0.0, 0.0), (25.0, 6.0), 0.0),
            rectangle("crossing", "crosswalk", (25.0, 0.0), (30.0, 6.0), 0.0),
            rectangle("high", "sidewalk", (0.0, 6.0), (20.0, 9.0), 0.15),
            rectangle("flush", "sidewalk", (20.0, 6.0), (30.0, 9.0), 0.02),
            rectangle("low", "ground", (4.0, -3.0), (16.0, 0.0), -0.06),
        ]
    )
    areas = {"road": 150.0, "crosswalk": 30.0, "sidewalk": 90.0, "ground": 36.0}
    found = ground_areas(plan)
    assert found == {kind: pytest.approx(area, rel=0.02) for kind, area in areas.items()}
    assert kerbs(plan) == {"length_m": pytest.approx(32.0, abs=0.6), "height_m": pytest.approx(0.15, abs=1e-3)}
    lower = ground_map(
        [
            rectangle("road", "road", (0.0, 0.0), (30.0, 6.0), 0.0),
            rectangle("high", "sidewalk", (0.0, 6.0), (8.0, 9.0), 0.15),
            rectangle("low", "sidewalk", (0.0, -3.0), (24.0, 0.0), -0.06),
        ]
    )
    # Three quarters of the kerb are 6 cm high.
    assert kerbs(lower) == {"length_m": pytest.approx(32.0, abs=0.6), "height_m": pytest.approx(0.06, abs=1e-3)}
    assert kerbs(ground_map([rectangle("road", "road", (0.0, 0.0), (9.0, 9.0), 0.0)])) == {
        "length_m": 0.0,
        "height_m": 0.0,
    }


@pytest.mark.parametrize("degrees", [0.0, 25.0, 90.0, 135.0])
def test_a_pavement_in_any_direction_has_its_width(degrees: float) -> None:
    """30 m by 3 m in a map of cells of 5 cm, of which a post takes 0.6 m of a side for 1 m."""
    resolution, size = 0.05, 800
    x, y = (np.indices((size, size)) - size / 2 + 0.5) * resolution
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    along, across = c * x + s * y, c * y - s * x
    pavement = (np.abs(along) < 15.0) & (np.abs(across) < 1.5)
    clear = pavement & ~((np.abs(along) < 0.5) & (across > 0.9))
    spots, directions = statistics._middle_lines(pavement, resolution)
    inner = np.abs(along[tuple(spots.T)]) < 12.0
    spots, directions = spots[inner], directions[inner]
    assert np.abs(across[tuple(spots.T)]).max() < 0.15
    np.testing.assert_allclose(np.abs(directions @ [c, s]), 1.0, atol=0.01)
    # One in each square of half a metre that the line crosses: exactly diagonal, every 0.71 m.
    assert 24.0 / 0.71 - 2 <= len(spots) <= 1.45 * 24.0 / 0.5
    if degrees in (0.0, 90.0):
        assert len(spots) == pytest.approx(48, abs=2)
    reach = np.full(len(spots), 1.5)
    width, gap = statistics._cross(pavement, clear, spots, directions, reach, resolution)
    np.testing.assert_allclose(width, 3.0, atol=0.11)
    beside = np.abs(along[tuple(spots.T)]) < 0.4
    assert beside.any()
    np.testing.assert_allclose(gap[beside], 2.4, atol=0.11)
    free = np.abs(along[tuple(spots.T)]) > 0.6
    np.testing.assert_array_equal(gap[free], width[free])


def test_runs_quantiles_and_shares() -> None:
    rows = np.array([[1, 1, 0, 1, 1, 1], [0, 0, 0, 0, 0, 0], [1, 1, 1, 1, 1, 1], [1, 0, 1, 0, 0, 1]], bool)
    assert statistics._longest_runs(rows).tolist() == [3, 0, 6, 1]
    assert statistics._quantiles(np.arange(11.0)) == {"p10": 1.0, "p50": 5.0, "p90": 9.0}
    assert statistics._quantiles(np.zeros(0)) == {}
    assert statistics._share(np.array([True, False, False])) == 0.3333
    assert statistics._share(np.zeros(0, bool)) == 0.0
    two = np.array([[0.0, 0.0], [3.0, 4.0]])
    np.testing.assert_allclose(statistics._nearest(two), [5.0, 5.0])
    assert len(statistics._nearest(two[:1])) == 0
