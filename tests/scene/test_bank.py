import dataclasses

import numpy as np
import pytest

from tests.support.box_bank import box_bank, box_scenes, box_skies
from urbanverse_mjx.datatypes import SceneBank, ValidationError, bank_join
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene import grids
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.simulation.engines import make_engine


def _box_distance(points: np.ndarray, bank: SceneBank, z: int, q: int) -> np.ndarray:
    """Distance (m) in three dimensions from points (n, 3) to the oriented box of an instance."""
    centre, half = bank.hull_box[bank.inst_hull[z, q]]
    local = (points - bank.inst_position[z, q]) @ bank.inst_rotation[z, q] - centre
    return np.linalg.norm(np.maximum(np.abs(local) - half, 0.0), axis=1)


def test_same_seed_same_bank_and_file_round_trip(tmp_path, small_bank: SceneBank) -> None:
    again = box_bank(3, seed=0)
    other = box_bank(3, seed=1)
    small_bank.save(tmp_path / "bank.npz")
    loaded = SceneBank.load(tmp_path / "bank.npz")
    for name, array in small_bank.arrays().items():
        np.testing.assert_array_equal(array, again.arrays()[name])
        np.testing.assert_array_equal(array, loaded.arrays()[name])
        assert array.dtype == loaded.arrays()[name].dtype
    assert not np.array_equal(other.inst_position, small_bank.inst_position)
    assert loaded.meta["scene_ids"] == small_bank.meta["scene_ids"]


def test_instances_stand_where_the_scene_has_them(small_bank: SceneBank) -> None:
    for z, scene in enumerate(box_scenes(3, 0)):
        for q, (hull, obj) in enumerate(zip(scene.inst_hull, scene.inst_object, strict=True)):
            world = scene.hulls[hull] @ rotations.matrix(scene.object_quaternion[obj]).T + scene.object_position[obj]
            t = small_bank.inst_hull[z, q]
            mine = small_bank.hull_vertices[t, : small_bank.hull_num_vertices[t]]
            mine = mine @ small_bank.inst_rotation[z, q].T + small_bank.inst_position[z, q]
            assert np.abs(mine[:, None] - world[None]).max(-1).min(1).max() < 1e-5
            slot = small_bank.inst_object[z, q]
            assert small_bank.meta["object_ids"][z][slot] == scene.object_ids[obj]
            np.testing.assert_allclose(small_bank.slot_position[z, slot], scene.object_position[obj], atol=1e-5)


def test_grid_lists_everything_within_reach(small_bank: SceneBank) -> None:
    rng = np.random.default_rng(0)
    for z in range(small_bank.num_scenes):
        points = np.column_stack([rng.uniform(-1, 61, 1500), rng.uniform(-9, 9, 1500), rng.uniform(0, 0.6, 1500)])
        cells = np.floor((points[:, :2] - small_bank.grid_origin[z]) / small_bank.grid_cell).astype(int)
        listed = small_bank.hull_grid[z, cells[:, 0], cells[:, 1]]
        for q in map(int, np.flatnonzero(small_bank.inst_hull[z] >= 0)):
            near = _box_distance(points, small_bank, z, q) <= small_bank.meta["grid_reach"]
            assert (listed[near] == q).any(1).all()
        assert (listed >= 0).any(1).mean() > 0.1


def test_prism_grid_finds_the_ground_everywhere(small_bank: SceneBank) -> None:
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(0, 60, 500), rng.uniform(-8, 8, 500)])
    for z in range(small_bank.num_scenes):
        cells = np.floor((points - small_bank.grid_origin[z]) / small_bank.grid_cell).astype(int)
        for point, (i, j) in zip(points, cells, strict=True):
            hits = 0
            for p in small_bank.prism_grid[z, i, j]:
                plane = small_bank.hull_planes[small_bank.prism_hull[z, p]]
                local = np.append(point, -0.2) - small_bank.prism_position[z, p]
                hits += p >= 0 and (plane[:, :3] @ local - plane[:, 3] <= 1e-5).all()
            assert hits >= 1


def test_reach_covers_the_fastest_step() -> None:
    origin, half = np.zeros(2), np.array([[0.1, 0.1, 0.5]])
    centre, eye = np.array([[5.5, 5.5, 0.5]]), np.eye(3)[None]
    table = grids.build_grid(origin, (11, 11), centre, eye, half)
    listed = np.array([[bool(c) for c in row] for row in table])
    x = (np.arange(11) + 0.5)[:, None, None]
    middle = np.broadcast_to(np.concatenate(np.broadcast_arrays(x, x.transpose(1, 0, 2)), -1), (11, 11, 2))
    gap = np.linalg.norm(np.maximum(np.abs(middle - 5.5) - 0.1, 0), axis=-1)
    np.testing.assert_array_equal(listed, gap <= grids.REACH + np.sqrt(0.5))
    assert not any(grids.build_grid(origin, (11, 11), centre, eye, half, ceiling=-0.1)[5])


def test_slots_keep_one_order_and_ground_comes_last(small_bank: SceneBank) -> None:
    kinds = np.array([name.startswith("ground:") for name in small_bank.meta["categories"]])
    for z in range(small_bank.num_scenes):
        used = small_bank.slot_mesh[z] >= 0
        ground = np.zeros(len(used), bool)
        ground[used] = kinds[small_bank.slot_category[z, used]]
        assert not ground[:40].any()
        assert ground[used][40:].all()
        assert (np.diff(small_bank.slot_position[z, used & ~ground, 0]) >= 0).all()


def test_scenes_of_different_size_share_a_bank() -> None:
    scenes = [*box_scenes(1, 0, 10), *box_scenes(2, 0, 25)[1:]]
    bank = pack(scenes, ["train", "test"], box_skies())
    assert (bank.inst_hull[0] >= 0).sum() == 10
    assert (bank.inst_hull[1] >= 0).sum() == 25
    x = bank.slot_position[:, :25, 0]
    used = bank.slot_mesh[:, :25] >= 0
    assert used[0].sum() == 10
    assert np.diff(np.flatnonzero(used[0])).max() <= 3
    assert np.abs(x[0][used[0]] - x[1][used[0]]).max() < 25


def test_equal_objects_are_stored_once() -> None:
    scene = box_scenes(1, 0, 12)[0]
    twin = dataclasses.replace(scene, scene_id="twin")
    one, two = pack([scene], ["train"], box_skies()), pack([scene, twin], ["train", "test"], box_skies())
    assert one.num_hulls == two.num_hulls
    assert one.num_meshes == two.num_meshes
    assert len(one.texture_start) == len(two.texture_start)


def test_what_cannot_be_packed_is_refused() -> None:
    scene = box_scenes(1, 0, 3)[0]
    with pytest.raises(ValidationError, match="no scene"):
        pack([], [], box_skies())
    with pytest.raises(ValidationError, match="twice"):
        pack([scene, scene], ["train", "test"], box_skies())
    with pytest.raises(ValidationError, match="sky"):
        pack([scene], ["train"], {})
    with pytest.raises(ValidationError, match="split"):
        pack([scene], ["dev"], box_skies())


@pytest.mark.mjx
def test_a_bank_from_before_has_uniform_ground_and_says_so(tmp_path, small_bank: SceneBank) -> None:
    rows = small_bank.prism_hull >= 0
    assert set(small_bank.prism_material_friction[rows].astype(float).round(2).tolist()) == {0.35, 0.65, 0.75}
    small_bank.save(tmp_path / "new.npz")
    new = SceneBank.load(tmp_path / "new.npz")
    assert new.knows_materials
    with np.load(tmp_path / "new.npz") as file:
        arrays = {name: file[name] for name in file.files if name != "prism_material_friction"}
    np.savez(tmp_path / "old.npz", **arrays)
    old = SceneBank.load(tmp_path / "old.npz")
    np.testing.assert_array_equal(old.prism_material_friction, old.prism_friction)
    assert not old.knows_materials
    twin = dataclasses.replace(new, meta={**new.meta, "scene_ids": [f"{name}_b" for name in new.scene_ids]})
    joined = bank_join.join([twin, old])
    joined.save(tmp_path / "joined.npz")
    assert not SceneBank.load(tmp_path / "joined.npz").knows_materials
    with pytest.warns(UserWarning, match="build it again"):
        make_engine(old, make_coco(), impl="jax", friction="materials")


def test_bank_says_what_can_be_pushed_and_one_written_before_says_nothing(tmp_path, small_bank: SceneBank) -> None:
    for z, scene in enumerate(box_scenes(3, 0)):
        for o, name in enumerate(scene.object_ids):
            slot = small_bank.meta["object_ids"][z].index(name)
            assert small_bank.slot_movable[z, slot] == scene.object_movable[o]
            assert small_bank.slot_mass[z, slot] == np.float32(scene.object_mass[o])
    assert 0 < small_bank.slot_movable.sum() == sum(s.object_movable.sum() for s in box_scenes(3, 0))
    small_bank.save(tmp_path / "new.npz")
    with np.load(tmp_path / "new.npz") as file:
        arrays = {name: file[name] for name in file.files if name not in ("slot_movable", "slot_mass")}
    np.savez(tmp_path / "old.npz", **arrays)
    old = SceneBank.load(tmp_path / "old.npz")
    assert old.slot_movable.shape == old.slot_mass.shape == old.slot_mesh.shape
    assert not old.slot_movable.any()
    assert not old.slot_mass.any()
