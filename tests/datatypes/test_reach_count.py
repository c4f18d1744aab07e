"""The bound on what comes within a robot's reach, against counts at many points."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from tests.support.box_bank import box_scene, box_skies, ragged_regions
from urbanverse_mjx.datatypes import SceneBank, traversable
from urbanverse_mjx.datatypes.reach_count import most_objects_in_reach, most_prisms_in_reach
from urbanverse_mjx.scene.bank import pack

REACH = 0.88
Count = Callable[..., int]


@pytest.fixture(scope="module")
def ragged() -> SceneBank:
    """Two streets: on crooked pieces of ground, and on large ones."""
    scenes = [box_scene(0, num_objects=100, regions=ragged_regions(0)), box_scene(1, num_objects=100)]
    return pack(scenes, ["train", "train"], box_skies())


def counted(bank: SceneBank, kind: str, scene: int, reach: float) -> int:
    """The most boxes seen from above within `reach` of one of 4,000 points, without the grids."""
    rng = np.random.default_rng(0)
    cells = np.argwhere(traversable(bank.map_kind[scene]))
    chosen = cells[rng.integers(0, len(cells), 4_000)] + rng.random((4_000, 2))
    points = bank.map_origin[scene] + chosen * float(bank.map_resolution)
    hull = bank.inst_hull[scene] if kind == "objects" else bank.prism_hull[scene]
    count = np.zeros(len(points), int)
    for q in np.flatnonzero(hull >= 0):
        place, turn = (bank.prism_position[scene, q], np.eye(3))
        if kind == "objects":
            place, turn = bank.inst_position[scene, q], bank.inst_rotation[scene, q]
        box = bank.hull_box[hull[q]]
        local = (points - place[:2]) @ turn[:2, :2] - box[0, :2]
        count += np.linalg.norm(np.maximum(np.abs(local) - box[1, :2], 0.0), axis=1) <= reach
    return int(count.max())


@pytest.mark.parametrize(("kind", "most"), [("objects", most_objects_in_reach), ("prisms", most_prisms_in_reach)])
@pytest.mark.parametrize("scene", [0, 1])
def test_no_point_has_more_in_reach_and_one_has_nearly_as_many(
    ragged: SceneBank, kind: str, most: Count, scene: int
) -> None:
    found = most(ragged, scene, REACH)
    assert counted(ragged, kind, scene, REACH) <= found <= counted(ragged, kind, scene, REACH + 0.05) + 1
    assert most(ragged, scene, REACH, found) == found
    assert most(ragged, scene, REACH, found - 1) == found
    assert most(ragged, scene, REACH, found + 5) == found + 5


def test_ragged_ground_brings_more_prisms_into_reach_than_eight(ragged: SceneBank) -> None:
    assert most_prisms_in_reach(ragged, 0, REACH) > 20 > 8 > most_prisms_in_reach(ragged, 1, REACH)


def test_only_traversable_ground_counts(ragged: SceneBank) -> None:
    none = dataclasses.replace(ragged, map_kind=np.ones_like(ragged.map_kind))
    assert most_prisms_in_reach(none, 0, REACH) == 0
    assert most_objects_in_reach(none, 0, REACH, 3) == 3
