"""Collision hulls: enclosed volume, open passages, and storage."""

from collections.abc import Iterable

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from tests.support.kept_tables import hull_keys
from tests.support.leaves import always, leaf_params
from urbanverse_mjx.assets import build_mesh, hull_loader, load_hulls, load_index
from urbanverse_mjx.assets.collision import hulls as hulls_module
from urbanverse_mjx.assets.collision.decompose import (
    OPTIONS,
    convex_piece,
    decompose,
    merge_pieces,
    simplified,
)
from urbanverse_mjx.assets.collision.hulls import HullStore, hull_budget, mesh_key, store_path
from urbanverse_mjx.assets.meshes.mesh_builder import MeshBuilder
from urbanverse_mjx.assets.meshes.recipe import all_recipes, get_recipe
from urbanverse_mjx.datatypes import AssetRecord, ValidationError, array_file

INDEX = load_index()
#: The leaves of the shipped and the benchmark streets: their recipes have physical priors of their own.
STREET = sorted({r.leaf for r in all_recipes() if r.physics is not None})
REACH = 0.85  # m, distance within which the simulator streams hulls
FEW = 12  # hulls of one asset within reach, of the 16 slots


def outside(points: np.ndarray, hulls) -> np.ndarray:
    """(n,) m by which points lie outside the nearest hull (its planes), 0 inside."""
    gaps = []
    for hull in hulls:
        planes = ConvexHull(hull).equations
        gaps.append((points @ planes[:, :3].T + planes[:, 3]).max(1))
    return np.maximum(np.min(gaps, 0), 0.0)


@pytest.mark.parametrize("leaf", leaf_params(INDEX.leaves))
def test_hulls_of_a_leaf(leaf: str) -> None:
    """They enclose the surface within 6 cm (25 cm overhead) but for foot plates, and little more than its hull.

    For assets larger than a house: within 1 % of its longest side, 3 % overhead (32 corners in a sphere leave a tenth
    of its radius out; grown halfway, 2.5 % of the width stays out: a balloon).
    """
    for record in INDEX.by_leaf(leaf):
        mesh, hulls = build_mesh(record), load_hulls(record).hulls
        surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        points = np.asarray(trimesh.sample.sample_surface(surface, 1500, seed=0)[0])
        missed = outside(points, hulls)
        missed[points[:, 2] <= OPTIONS.foot_plate + 1e-3] = 0.0
        low = points[:, 2] < 2.0
        share = 0.01 * max(record.extent_xyz)
        assert missed[low].max(initial=0.0) <= max(0.06, share), record.uid
        assert missed.max() <= max(0.25, 3 * share), record.uid
        if record.height > OPTIONS.flush_height:
            filled = sum(ConvexHull(h).volume for h in hulls)
            shell = ConvexHull(mesh.vertices + np.zeros(3)).volume
            # Hulls may overlap and are grown by millimetres; thin plates have hardly any volume of their own.
            assert filled <= 1.35 * shell + 0.02, record.uid
            assert all(h[:, 2].min() >= -0.002 for h in hulls), record.uid


def test_every_base_shape_has_hulls_and_none_are_left_over() -> None:
    """Of all, not of the sampled leaves: two branches that each made some once lost 18 shapes of the other."""
    keys = hull_keys()
    needed = {keys[record.uid]: record.uid for record in INDEX.records}
    stored = HullStore.load(store_path()).hulls
    assert [uid for key, uid in needed.items() if key not in stored] == []
    assert set(stored) <= set(needed)


@pytest.mark.parametrize("leaf", leaf_params(STREET))
def test_a_robot_beside_an_asset_meets_few_of_its_hulls(leaf: str) -> None:
    for record in INDEX.by_leaf(leaf):
        hulls = load_hulls(record).hulls
        if len(hulls) <= FEW:
            continue
        boxes = np.array([(h.min(0), h.max(0)) for h in hulls])
        x, y = record.extent_xyz[0] / 2 + 0.4, record.extent_xyz[1] / 2 + 0.4
        ground = np.array([(px, py, 0.3) for px in np.linspace(-x, x, 25) for py in np.linspace(-y, y, 25)])
        gap = np.maximum(np.maximum(boxes[None, :, 0] - ground[:, None], ground[:, None] - boxes[None, :, 1]), 0)
        free = outside(ground, hulls) > 0.3
        near = (np.linalg.norm(gap, axis=-1) <= REACH).sum(1)[free]
        assert near.max(initial=0) <= FEW, record.uid


def find(leaf: str, style: str) -> AssetRecord:
    return next(r for r in INDEX.by_leaf(leaf) if r.params.get("style") == style)


@pytest.mark.parametrize(
    ("leaf", "style", "point"),
    [
        ("table", "dining", (0.0, 0.0, 0.4)),  # under the table top
        ("bus shelter", "flat", (0.1, -0.8, 1.0)),  # where people stand
        ("sunshade", "octagonal", (0.7, 0.0, 1.2)),  # under the cloth
        ("street light", "curved arm", (0.0, 0.0, 1.5)),  # under the arm: the pole stands at -x
        ("awning", "terrace on posts", (0.0, 0.0, 1.5)),
        ("utility pole", "wooden", (0.14, 0.7, 2.0)),  # under the crossarm
    ],
)
def test_room_a_robot_can_use_stays_open(leaf: str, style: str, point: tuple[float, float, float]) -> None:
    assert outside(np.array([point]), load_hulls(find(leaf, style)).hulls)[0] > 0.05


def test_a_manhole_cover_is_never_touched() -> None:
    for record in INDEX.by_leaf("manhole cover"):
        assert all(h[:, 2].max() < -0.01 for h in load_hulls(record).hulls)


def test_small_convex_objects_have_one_hull() -> None:
    for leaf in ("bollard", "guard stone", "rock", "street cabinet", "vending machine", "plant pot"):
        assert all(len(load_hulls(r).hulls) == 1 for r in INDEX.by_leaf(leaf) if "posts" in r.recipe), leaf


def keys(records: Iterable[AssetRecord]) -> set[str]:
    found = set()
    for record in records:
        mesh = build_mesh(record)
        found.add(mesh_key(mesh, hull_budget(mesh, get_recipe(record.recipe, record.leaf).hulls)))
    return found


def test_the_store_is_small_and_holds_sampled_assets() -> None:
    assert store_path().stat().st_size < 4 * 2**20
    store = HullStore.load(store_path()).hulls
    assert keys(r for leaf in always(INDEX.leaves) for r in INDEX.by_leaf(leaf)) <= set(store)
    assert 0.9 * len(INDEX.records) <= len(store) <= len(INDEX.records)


@pytest.mark.slow
def test_the_store_holds_every_asset_but_nothing_else() -> None:
    assert set(HullStore.load(store_path()).hulls) == keys(INDEX.records)


def test_the_store_survives_its_file(tmp_path) -> None:
    store = HullStore.load(store_path())
    again = HullStore.load(store.save(tmp_path / "hulls.npz"))
    assert list(again.hulls) == sorted(store.hulls)
    for key, hulls in store.hulls.items():
        assert all(np.array_equal(a, b) for a, b in zip(hulls, again.hulls[key], strict=True))


def test_a_damaged_store_is_one_sentence(tmp_path) -> None:
    rng = np.random.default_rng(0)
    parts = tuple(rng.integers(0, 1000, (n, 3), dtype=np.int32) for n in (8, 5, 12))
    path = HullStore({"ab" * 16: parts[:2], "cd" * 16: parts[2:]}).save(tmp_path / "hulls.npz")
    whole = array_file.load(path, "", "")
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(ValidationError, match="damaged"):
        HullStore.load(path)
    for name in ("keys", "hulls_per_key", "corners_per_hull", "corners_mm"):
        for wrong in ({**whole, name: whole[name][:-1]}, {k: x for k, x in whole.items() if k != name}):
            array_file.save(path, wrong)
            with pytest.raises(ValidationError, match=r"needed (counts that add up|hulls)"):
                HullStore.load(path)


def test_missing_hulls_name_the_command(monkeypatch) -> None:
    monkeypatch.setattr(hulls_module, "_store", lambda: HullStore({}))
    with pytest.raises(ValidationError, match=r"python -m urbanverse_mjx\.assets hulls"):
        load_hulls(INDEX.records[0])


def test_closer_hulls_are_read_on_request_where_there_are_some(monkeypatch) -> None:
    known, unknown = INDEX.by_leaf("bakery")[0], INDEX.by_leaf("bollard")[0]
    (key,) = keys([known])
    closer = np.array([(0, 0, 0), (1000, 0, 0), (0, 1000, 0), (0, 0, 1000)], np.int32)
    monkeypatch.setattr(hulls_module, "close_store", lambda kind: HullStore({key: (closer,)}))
    for record in (known, unknown):
        first = load_hulls(record).hulls
        assert [h.tolist() for h in hull_loader("")(record).hulls] == [h.tolist() for h in first]
        assert first[0].shape != closer.shape
    assert [h.tolist() for h in hull_loader("close")(known).hulls] == [(closer / 1000).tolist()]
    fallen_back = hull_loader("close")(unknown).hulls
    assert [h.tolist() for h in fallen_back] == [h.tolist() for h in load_hulls(unknown).hulls]


def test_the_key_follows_the_shape_and_not_the_last_bit() -> None:
    b = MeshBuilder()
    b.box((0.4, 0.5, 0.123))
    mesh = b.build("a test").mesh
    moved = type(mesh)(mesh.vertices + np.float32(1e-6), mesh.faces, mesh.uv, mesh.texture)
    other = type(mesh)(mesh.vertices * np.float32(1.02), mesh.faces, mesh.uv, mesh.texture)
    assert mesh_key(mesh, 4) == mesh_key(moved, 4)
    assert len({mesh_key(mesh, 4), mesh_key(other, 4), mesh_key(mesh, 5)}) == 3


def test_decomposition_of_an_arch_leaves_its_opening() -> None:
    """Two posts and a lintel, hulls known by hand."""
    b = MeshBuilder()
    for y in (-0.9, 0.9):
        b.box((0.2, 0.2, 2.0), (0, y, 0))
    b.box((0.2, 2.0, 0.3), (0, 0, 2.0))
    built = b.build("a gate")
    hulls = [h / 1000 for h in decompose(built.mesh, 4, built.part_faces)]
    assert len(hulls) == 3
    assert sum(ConvexHull(h).volume for h in hulls) == pytest.approx(0.08 + 0.08 + 0.12, rel=1e-3)
    assert outside(np.array([(0.0, 0.0, 1.0)]), hulls)[0] == pytest.approx(0.8, abs=0.01)


def test_coacd_cuts_one_concave_part() -> None:
    b = MeshBuilder()
    b.profile([(0, 0), (2, 0), (2, 0.4), (0.4, 0.4), (0.4, 2), (0, 2)], 0.5)
    built = b.build("an L")
    hulls = [h / 1000 for h in decompose(built.mesh, 4, built.part_faces)]
    assert 2 <= len(hulls) <= 4
    solid = 0.5 * (2 * 0.4 + 0.4 * 1.6)
    assert sum(ConvexHull(h).volume for h in hulls) == pytest.approx(solid, rel=0.1)
    assert decompose(built.mesh, 4, built.part_faces)[0].tolist() == (hulls[0] * 1000).round().astype(int).tolist()


def test_merging_keeps_to_the_budget_and_covers() -> None:
    rng = np.random.default_rng(0)
    pieces = [convex_piece(rng.normal(size=(12, 3)) * 0.1 + rng.normal(size=3)) for _ in range(20)]
    merged = merge_pieces(pieces, 5)
    assert len(merged) <= 5
    corners = np.concatenate([p.corners for p in pieces])
    assert outside(corners, [p.corners for p in merged]).max() < 0.01


def test_simplified_hulls_stay_close() -> None:
    points = np.random.default_rng(1).normal(size=(400, 3))
    ball = 0.5 * points / np.linalg.norm(points, axis=1, keepdims=True)
    kept = simplified(ball, 32)
    assert len(kept) <= 32
    assert outside(ball, [kept]).max() < 0.04
    assert np.linalg.norm(kept, axis=1).max() < 0.56
