"""Requirements on the six shipped streets, checked on the bank that environments load."""

import json

import numpy as np
import pytest
from scipy import ndimage

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.datatypes.ground import GROUND_KINDS, KIND_INDEX, TRAVERSABLE_KINDS

#: Hull slots of the physics model (design, section 3).
SLOTS = 16


def _walkable(bank: SceneBank) -> np.ndarray:
    return np.isin(bank.map_kind, [KIND_INDEX[k] for k in TRAVERSABLE_KINDS])


def test_splits_are_the_shipped_ones(bank: SceneBank) -> None:
    table = json.loads((settings.scene_root() / "splits.json").read_text())
    assert [bank.scene_ids[z] for z in bank.scenes_of("train")] == table["train"]
    assert [bank.scene_ids[z] for z in bank.scenes_of("test")] == table["test"]
    assert bank.num_scenes == 6


def test_streets_are_long_and_full(bank: SceneBank) -> None:
    for z in range(bank.num_scenes):
        names = [bank.meta["categories"][c] if c >= 0 else "" for c in bank.slot_category[z]]
        objects = [n for n in names if n and not n.startswith("ground:")]
        assert len(objects) >= 40
        i, _ = np.nonzero(bank.map_kind[z] == KIND_INDEX["sidewalk"])
        assert np.ptp(i) * bank.map_resolution >= 60.0
        kinds = {GROUND_KINDS[k] for k in np.unique(bank.map_kind[z])}
        assert kinds >= {"road", "sidewalk", "crosswalk"}


def test_episode_tables(bank: SceneBank) -> None:
    for z in range(bank.num_scenes):
        n = bank.num_episodes[z]
        start, goal = bank.episode_start[z, :n], bank.episode_goal[z, :n]
        assert n >= 256
        assert len(np.unique(goal, axis=0)) >= 32
        straight = np.linalg.norm(goal[:, :2] - start[:, :2], axis=1)
        assert straight.min() >= 10.0 - 1e-4
        assert straight.max() <= 30.0 + 1e-4
        assert (bank.episode_length[z, :n] >= straight - 1e-3).all()
        for ends in (start, goal):
            cells = np.floor((ends[:, :2] - bank.map_origin[z]) / bank.map_resolution).astype(int)
            assert _walkable(bank)[z, cells[:, 0], cells[:, 1]].all()


def test_no_pose_on_walkable_ground_has_more_hulls_in_reach_than_slots(bank: SceneBank) -> None:
    """10,000 random poses: every instance whose box is within reach is counted, from the box table, not the grid."""
    rng = np.random.default_rng(0)
    reach, resolution = bank.meta["grid_reach"], float(bank.map_resolution)
    worst = 0
    for z in range(bank.num_scenes):
        cells = np.argwhere(_walkable(bank)[z])
        chosen = cells[rng.integers(0, len(cells), 10_000 // bank.num_scenes + 1)]
        points = bank.map_origin[z] + (chosen + rng.random(chosen.shape)) * resolution
        points = np.column_stack([points, np.full(len(points), 0.45)])  # COCO's root above a 15 cm pavement
        count = np.zeros(len(points), int)
        for q in np.flatnonzero(bank.inst_hull[z] >= 0):
            centre, half = bank.hull_box[bank.inst_hull[z, q]]
            local = (points - bank.inst_position[z, q]) @ bank.inst_rotation[z, q] - centre
            count += np.linalg.norm(np.maximum(np.abs(local) - half, 0.0), axis=1) <= reach
        worst = max(worst, int(count.max()))
    assert worst <= SLOTS


def test_starts_are_clear_of_every_hull(bank: SceneBank) -> None:
    """At starts and goals a disc of 0.45 m, up to 1 m high, holds no corner of a hull."""
    for z in range(bank.num_scenes):
        rows = np.flatnonzero(bank.inst_hull[z] >= 0)
        hull = bank.inst_hull[z, rows]
        corners = np.einsum("nij,nkj->nki", bank.inst_rotation[z, rows], bank.hull_vertices[hull])
        corners = (corners + bank.inst_position[z, rows][:, None]).reshape(-1, 3)
        for ends in (bank.episode_start[z], bank.episode_goal[z]):
            for x, y, ground in np.unique(ends[:, :3], axis=0):
                low = corners[(corners[:, 2] > ground) & (corners[:, 2] < ground + 1.0), :2]
                assert np.linalg.norm(low - [x, y], axis=1).min() > 0.45


@pytest.mark.parametrize("kind", ["road", "sidewalk"])
def test_map_has_no_holes(bank: SceneBank, kind: str) -> None:
    """A cell without ground inside the street would drop a robot into the void."""
    for z in range(bank.num_scenes):
        solid = bank.map_kind[z] > 0
        assert (ndimage.binary_fill_holes(solid) == solid).all()
        assert (bank.map_kind[z] == KIND_INDEX[kind]).any()
