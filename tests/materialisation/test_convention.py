"""The pose convention on real assets: a bench, a car and a shop front stand in the box that the graph drew for them."""

import math

import numpy as np
import pytest

from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, Source
from urbanverse_mjx.materialisation import materialise_cousin

from .catalogue_part import few_objects

FLOOR = GroundRegion("floor", "sidewalk", ((-30, -30), (30, -30), (30, 30), (-30, 30)), (0.0, 0.0, 0.15))
SOUTH, WEST, NORTH = -math.pi / 2, math.pi, math.pi / 2


def placed_mesh(label: str, yaw: float) -> tuple[np.ndarray, GraphObject]:
    """(V, 3) world vertices of the asset chosen for a box of its own size at (4, -3), and the box."""
    x, y, z = load_index().by_leaf(label)[0].extent_xyz
    box = GraphObject("it", label, (4.0, -3.0, 0.15 + z / 2), (x, y, z), yaw)
    graph = SceneGraph("little", Source("hand", "Apache-2.0", "none", "none"), (box,), (FLOOR,))
    cousin = materialise_cousin(graph, objects=few_objects())
    (placed,) = cousin.layout.objects
    local = build_mesh(cousin.chosen["it"].record).vertices * np.array(placed.scale)
    c, s = math.cos(placed.yaw), math.sin(placed.yaw)
    return local @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + placed.position, box


@pytest.mark.parametrize(("label", "yaw"), [("bench", SOUTH), ("sedan", WEST), ("bakery", NORTH), ("bench", 0.7)])
def test_the_asset_fills_the_box(label, yaw):
    world, box = placed_mesh(label, yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    in_box = (world - box.center) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    low, high = in_box.min(0), in_box.max(0)
    # another asset of nearly the same proportions may be chosen
    np.testing.assert_allclose(high - low, box.size, rtol=0.055)
    np.testing.assert_allclose((high + low)[:2] / 2, 0.0, atol=0.01)
    assert world[:, 2].min() == pytest.approx(0.15, abs=0.005)


def test_a_bench_that_faces_south_has_its_back_in_the_north():
    world, _ = placed_mesh("bench", SOUTH)
    back = world[world[:, 2] > 0.15 + 0.85 * np.ptp(world[:, 2])]
    assert back[:, 1].mean() > world[:, 1].mean() + 0.1
    assert np.ptp(world[:, 0]) > 2 * np.ptp(world[:, 1])


def test_a_car_that_heads_west_has_its_mirrors_west_of_its_middle():
    world, _ = placed_mesh("sedan", WEST)
    widest = world[np.abs(world[:, 1] + 3.0) > 0.47 * np.ptp(world[:, 1])]
    assert widest[:, 0].mean() < 4.0 - 0.2
    assert np.ptp(world[:, 0]) > 2 * np.ptp(world[:, 1])


def test_a_shop_that_faces_north_has_its_window_and_door_in_the_north():
    """A front has reveals, an awning and a sign; the back is a bare wall."""
    world, _ = placed_mesh("bakery", NORTH)
    depth = np.ptp(world[:, 1])
    front = (world[:, 1] > -3.0 + 0.2 * depth).sum()
    back = (world[:, 1] < -3.0 - 0.2 * depth).sum()
    assert front > 2 * back
