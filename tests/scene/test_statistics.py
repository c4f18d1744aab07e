"""A simple street with known statistics: two pavements of 60 m by 4 m."""

import numpy as np
import pytest

from tests.support.box_bank import street_regions
from tests.support.toy_assets import TOY_SOURCE, toy_index, toy_layout
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, Source
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.statistics import house_mask, pavement_widths, scene_statistics


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


def test_blockage_is_the_share_of_the_way() -> None:
    """6 m of 120 m of pavement with 0.5 m left on one side and 0 m on the other."""
    pavement = scene_statistics(_street((40.0, 6.3, (6.0, 3.4, 1.5))))["pavement"]
    assert pavement["narrower_than"]["robot"] == pytest.approx(6 / pavement["length_m"], abs=0.02)
    assert pavement["narrower_than"]["robot"] <= pavement["narrower_than"]["ada"] <= pavement["narrower_than"]["prowag"]


def test_spacing_is_to_the_nearest_other_object() -> None:
    pavement = scene_statistics(_street(*((x, 6.0, (0.2, 0.2, 1.0)) for x in (40.0, 42.0, 44.0, 50.0))))
    assert pavement["spacing_m"] == {"p10": 2.0, "p50": 2.0, "p90": pytest.approx(4.8)}
    assert scene_statistics(_street())["spacing_m"] == {}
