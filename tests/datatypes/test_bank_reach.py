"""Grids with a longer reach list every box within it, and no other."""

import dataclasses

import numpy as np
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.bank_reach import with_reach
from urbanverse_mjx.datatypes.reach_count import object_boxes, prism_boxes


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(2, num_objects=40)


@pytest.mark.parametrize("reach", [1.1, 1.6])
def test_every_box_within_reach_is_listed(bank: SceneBank, reach: float) -> None:
    wider, side = with_reach(bank, reach), float(bank.grid_cell)
    assert wider.meta["grid_reach"] == reach
    assert bank.meta["grid_reach"] == pytest.approx(0.95)
    rng = np.random.default_rng(0)
    for scene in range(bank.num_scenes):
        for boxes, grid in ((object_boxes(bank, scene), wider.hull_grid), (prism_boxes(bank, scene), wider.prism_grid)):
            shape = np.array(grid.shape[1:3])
            points = bank.grid_origin[scene] + rng.uniform(0.0, 1.0, (400, 2)) * shape * side
            every = np.arange(len(boxes.centre))
            distance = boxes.distance(points, np.tile(every, (len(points), 1)))
            cells = np.floor((points - bank.grid_origin[scene]) / side).astype(int)
            for at, (i, j) in enumerate(cells):
                listed = grid[scene, i, j]
                kept = listed[listed >= 0]
                assert len(set(kept.tolist())) == len(kept), "none twice"
                assert (np.diff((listed >= 0).astype(int)) <= 0).all(), "-1 at the end"
                # Empty rows of a padded table lie nowhere.
                rows = bank.inst_hull if grid is wider.hull_grid else bank.prism_hull
                near = {int(q) for q in np.flatnonzero((distance[at] <= reach - 1e-6) & (rows[scene] >= 0))}
                assert near <= set(kept.tolist())
                assert (distance[at][kept] <= reach + side * np.sqrt(2.0) + 1e-6).all(), "no box far away"


def test_a_bank_that_reaches_far_enough_stays(bank: SceneBank) -> None:
    assert with_reach(bank, 0.95) is bank
    with pytest.raises(ValidationError, match=r"robot's reach: found 3 m, needed at most 1\.95 m"):
        with_reach(bank, 3.0)


def test_a_cell_at_the_border_has_neighbours_on_one_side(bank: SceneBank) -> None:
    """Lists do not wrap around the grid."""
    one = np.full_like(bank.hull_grid, -1)
    one[:, 0, 0, 0] = 0
    lonely = with_reach(dataclasses.replace(bank, hull_grid=one), 1.9)
    cells = np.argwhere(lonely.hull_grid[0, :, :, 0] >= 0)
    assert (cells <= 1).all()
