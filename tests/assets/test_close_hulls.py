"""Closer collision hulls: they keep out of where a robot can be, cover the surface, and are made again bit-equal."""

import dataclasses
import functools
import hashlib
import itertools
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from tests.support.kept_tables import hull_keys
from tests.support.leaves import always, leaf_params
from urbanverse_mjx.assets import build_mesh, hull_loader, load_hulls, load_index
from urbanverse_mjx.assets.collision import close_hulls as c
from urbanverse_mjx.assets.collision import hulls as stores
from urbanverse_mjx.assets.collision.decompose import convex_piece
from urbanverse_mjx.assets.collision.hulls import REVISIONS, HullStore, close_store, close_store_path, hull_key
from urbanverse_mjx.assets.collision.overshoot import overshoot
from urbanverse_mjx.assets.collision.within_reach import layouts_in, shape_of, shapes_of
from urbanverse_mjx.assets.meshes.mesh_builder import MeshBuilder
from urbanverse_mjx.assets.records.regional import load_regional
from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, PlacedGround, PlacedObject, SceneLayout, ValidationError
from urbanverse_mjx.datatypes.asset import MAX_HULL_VERTICES
from urbanverse_mjx.datatypes.scene_layout import HULL_KINDS

INDEX = load_index()
NEWEST = [*REVISIONS][-1]
STORE = close_store(NEWEST).hulls
CLOSER = {r.uid: r for r in INDEX.records if STORE.get(hull_keys()[r.uid])}
LEAVES = sorted({r.leaf for r in CLOSER.values()})


@functools.cache
def made_by(kind: str) -> frozenset[str]:
    """Keys of the meshes whose hulls the newest revision of a kind has."""
    return frozenset(key for key, hulls in HullStore.load(close_store_path(kind)).hulls.items() if hulls)


def kind_of(record: AssetRecord) -> str:
    """The revision that made a record's closer hulls."""
    return next(kind for kind in REVISIONS[NEWEST] if hull_keys()[record.uid] in made_by(kind))


def outside(points: np.ndarray, hulls) -> np.ndarray:
    """(n,) m by which points lie outside the nearest hull (its planes), 0 inside."""
    planes = [ConvexHull(h).equations for h in hulls]
    return np.maximum(np.min([(points @ p[:, :3].T + p[:, 3]).max(1) for p in planes], 0), 0.0)


def made_of(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> AssetMesh:
    b = MeshBuilder()
    for size, at in boxes:
        b.box(size, at)
    return b.build("a test", recenter=False).mesh


def shell(mesh: AssetMesh) -> np.ndarray:
    return mesh.vertices[ConvexHull(mesh.vertices).vertices].astype(float)


#: Shapes whose convex hull closes what a robot of 31 cm can enter, and the least number of hulls that do not.
ENTERED = {
    # A wall 1 m thick with a recess of a door, 1 m wide and 0.4 m deep.
    "recess": ([((1, 4, 3), (-0.5, 0, 0)), ((0.4, 1.5, 3), (0.2, -1.25, 0)), ((0.4, 1.5, 3), (0.2, 1.25, 0))], 3),
    # Two posts 1 m apart under a lintel.
    "gate": ([((0.2, 0.2, 1), (0, -0.6, 0)), ((0.2, 0.2, 1), (0, 0.6, 0)), ((0.2, 1.4, 0.15), (0, 0, 1.0))], 3),
    # A body over four wheels with 0.3 m of air below and 1.6 m between the axles.
    "vehicle": (
        [((4, 1.6, 0.9), (0, 0, 0.3)), *(((0.6, 0.2, 0.6), (x, y, 0)) for x in (-1.1, 1.1) for y in (-0.7, 0.7))],
        3,
    ),
}


@pytest.mark.parametrize("kind", REVISIONS)
@pytest.mark.parametrize("name", ENTERED)
def test_what_a_robot_can_enter_stays_open(name: str, kind: str) -> None:
    mesh, least = made_of(*ENTERED[name][0]), ENTERED[name][1]
    first = [shell(mesh)]
    assert overshoot(mesh.vertices, mesh.faces, first).worst > 0.1
    hulls = [h / 1000 for h in c.close_hulls(mesh, first, kind)]
    assert least <= len(hulls) <= c.close_budget(mesh, kind)
    assert kind == "close" or min(h[:, 2].min() for h in hulls) == 0.0
    assert overshoot(mesh.vertices, mesh.faces, hulls).worst <= 0.05
    sides = np.concatenate([mesh.vertices[mesh.faces] @ np.diag((1, 1, 0)) + [0, 0, z] for z in (0.1, 0.5, 1.0)])
    low, high = mesh.vertices[mesh.faces][..., 2].min(1), mesh.vertices[mesh.faces][..., 2].max(1)
    upright = np.concatenate([(low < z) & (high > z) for z in (0.1, 0.5, 1.0)])
    assert upright.sum() > 20
    assert outside(sides[upright].reshape(-1, 3), hulls).max() <= c.OPTIONS.most_missed


def test_a_closed_courtyard_may_be_filled() -> None:
    """No robot gets in, so that the hull of the whole, which closes it, is kept as it is."""
    walls = [((2.2, 0.1, 1.5), (0, y, 0)) for y in (-1.05, 1.05)]
    mesh = made_of(*walls, *(((0.1, 2.0, 1.5), (x, 0, 0)) for x in (-1.05, 1.05)))
    (only,) = c.close_hulls(mesh, [shell(mesh)])
    assert ConvexHull(only / 1000).volume == pytest.approx(2.2 * 2.2 * 1.5, rel=1e-3)


def test_a_grown_polyhedron_holds_no_forbidden_point() -> None:
    rng = np.random.default_rng(0)
    obstacles = rng.integers(-1000, 1000, (4000, 3))
    obstacles = obstacles[np.linalg.norm(obstacles[:, :2], axis=1) > 60]
    seed = np.array([3.0, 5.0, 7.0])
    for metric in (np.eye(3), np.diag((1.0, 1.0, 0.06)), np.array([1.0, 6.0, 1.0])):
        grown = c._Polyhedron(seed, metric, np.zeros((0, 4))).cut(obstacles)
        assert len(grown.planes) >= 4
        assert not c._within(obstacles, grown.planes - [0, 0, 0, 1e-6]).any()
        assert c._within(seed[None], grown.planes).all()


def box(*bounds: float) -> np.ndarray:
    """Corners (8, 3) m of the box from bounds[:3] to bounds[3:]."""
    return np.array(list(itertools.product(*zip(bounds[:3], bounds[3:], strict=True))))


def test_hulls_whose_points_others_cover_are_left_out() -> None:
    """The middle one of three in a row, unless it has a point of its own."""
    row = [box(x, 0, 0, x + length, 1, 1) for x, length in ((0.0, 1.0), (0.9, 0.2), (1.0, 1.0))]
    points = (np.concatenate([row[0], row[2]]) * 1000).astype(np.int64)
    kept = c._pruned(points, row)
    assert [h[:, 0].min() for h in kept] == [0.0, 1.0]
    own = np.concatenate([points, [[1000, 500, 1200]]])
    tall = [row[0], row[1] * [1.0, 1.0, 1.2], row[2]]
    assert len(c._pruned(own, tall)) == 3


def test_a_lean_hull_keeps_what_stands_out_and_what_stands_on_the_ground() -> None:
    dents = np.array([(0.5, 0.5, 1.004), (0.5, -0.006, 0.5), (0.5, -0.006, 0.0), (1.03, 0.5, 0.5)])
    lean = c._lean(convex_piece(np.concatenate([box(0, 0, 0, 1, 1, 1), dents])), 0.01).corners
    assert {*map(tuple, lean.round(9) + 0.0)} == {*map(tuple, [*box(0, 0, 0, 1, 1, 1), *dents[2:]])}


def test_a_hull_above_the_ground_is_continued_to_the_foot_below_it() -> None:
    leg = made_of(((0.1, 0.1, 0.5), (0, 0, 0)), ((0.1, 0.1, 0.5), (1, 0, 0)))
    triangles = leg.vertices.astype(float)[leg.faces]
    piece = convex_piece(box(-0.05, -0.05, 0.04, 0.05, 0.05, 0.5))
    nothing = np.zeros((0, 3), np.int64)
    grown = c._grounded(piece, triangles, nothing, 0.08).corners
    assert grown.min(0) == pytest.approx([-0.05, -0.05, 0.0], abs=1e-6)
    assert grown.max(0) == pytest.approx([0.05, 0.05, 0.5], abs=1e-6)
    assert c._grounded(piece, triangles, np.array([[0, 0, 20]]), 0.08) is piece
    assert c._grounded(piece, triangles, nothing, 0.03) is piece


def test_a_hull_may_touch_a_floor_from_below() -> None:
    """Points are near a level face by their distance in space, although its edge is far in their own cut."""
    floor = made_of(((2.0, 1.0, 0.1), (0, 0, 0.3)))
    below = np.array([(0, 0, 280), (700, 300, 280), (0, 0, 250), (1060, 0, 280)])
    near = c._near_level(below, floor.vertices.astype(float)[floor.faces], 0.04, 0.02)
    assert near.tolist() == [True, True, False, False]
    wall = made_of(((0.2, 1.0, 2.0), (0, 0, 0)))
    upright = wall.vertices.astype(float)[wall.faces]
    assert not c._near_level(below + [300, 0, 1000], upright, 0.04, 0.02).any()


def test_the_store_is_small_and_of_known_meshes() -> None:
    known = set(hull_keys().values())
    assert close_store_path().is_file()
    for path in filter(pathlib.Path.is_file, map(close_store_path, REVISIONS)):
        assert path.stat().st_size < 3 * 2**20
        tried = HullStore.load(path).hulls
        assert any(tried.values())
        assert set(tried) <= known


@pytest.mark.extended
@pytest.mark.parametrize("leaf", leaf_params(LEAVES))
def test_closer_hulls_of_a_leaf(leaf: str) -> None:
    """Less overshoot than the first hulls, none missing much of the surface, few enough, none below the ground."""
    for record in (r for r in CLOSER.values() if r.leaf == leaf):
        mesh, hulls = build_mesh(record), hull_loader(NEWEST)(record).hulls
        before = overshoot(mesh.vertices, mesh.faces, load_hulls(record).hulls).worst
        after = overshoot(mesh.vertices, mesh.faces, hulls).worst
        kind = kind_of(record)
        assert after <= (0.05 if kind == "close-2" else max(0.05, c.OPTIONS.better * before)) + 1e-3, record.uid
        assert len(hulls) <= c.close_budget(mesh, kind), record.uid
        assert c.stands_as_well(record, load_hulls(record).hulls, hulls), record.uid
        assert all(len(h) <= MAX_HULL_VERTICES and h[:, 2].min() >= -0.002 for h in hulls), record.uid
        points = c.surface_points(mesh.vertices.astype(float)[mesh.faces]) / 1000
        missed = outside(points, hulls).max()
        assert missed <= max(c.OPTIONS.most_missed, 0.01 * max(record.extent_xyz)) + 1e-3, record.uid


@pytest.mark.parametrize("leaf", leaf_params(LEAVES))
def test_a_robot_beside_it_meets_few_of_the_closer_hulls(leaf: str) -> None:
    for record in (r for r in CLOSER.values() if r.leaf == leaf):
        assert most_in_reach(record.extent_xyz, hull_loader(NEWEST)(record).hulls) <= 12, record.uid


def most_in_reach(extent: tuple[float, float, float], hulls: tuple[np.ndarray, ...], reach: float = 0.85) -> int:
    """Largest number of boxes of hulls within reach of a robot beside an asset."""
    if len(hulls) <= 12:
        return len(hulls)
    boxes = np.array([(h.min(0), h.max(0)) for h in hulls])
    x, y = extent[0] / 2 + 0.4, extent[1] / 2 + 0.4
    ground = np.array([(px, py, 0.3) for px in np.linspace(-x, x, 25) for py in np.linspace(-y, y, 25)])
    gap = np.maximum(np.maximum(boxes[None, :, 0] - ground[:, None], ground[:, None] - boxes[None, :, 1]), 0)
    return int((np.linalg.norm(gap, axis=-1) <= reach).sum(1)[outside(ground, hulls) > 0.3].max(initial=0))


#: Making those of the first leaf takes as long as those of the next three.
FIRST, *NEXT = always(LEAVES)[:4]


@pytest.mark.extended
@pytest.mark.parametrize("leaves", [NEXT, pytest.param([FIRST], marks=pytest.mark.slow)], ids=lambda x: "+".join(x))
def test_the_store_is_made_again_bit_equal(leaves: list[str]) -> None:
    """In a process that begins as the workers of `build_close` do, with the same kernels on any processor."""
    kinds = {r.uid: kind_of(r) for r in (next(r for r in CLOSER.values() if r.leaf == leaf) for leaf in leaves)}
    uids = [*kinds]
    code = (
        "import json, sys\n"
        "from urbanverse_mjx.assets import load_index\n"
        "from urbanverse_mjx.assets.collision.close_hulls import closer\n"
        "wanted = json.loads(sys.argv[1])\n"
        "made = [closer(load_index().get(uid), kind=kind) for uid, kind in wanted.items()]\n"
        "print(json.dumps([[key, [h.tolist() for h in hulls]] for key, hulls in made]))\n"
    )
    env = {**os.environ, "OPENBLAS_CORETYPE": c.KERNEL}
    ran = subprocess.run(
        [sys.executable, "-c", code, json.dumps(kinds)], env=env, capture_output=True, text=True, check=True
    )
    made = json.loads(ran.stdout)
    assert [key for key, _ in made] == [hull_key(CLOSER[uid]) for uid in uids]
    for key, hulls in made:
        assert hulls == [h.tolist() for h in STORE[key]]


def test_the_workers_begin_with_the_named_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    kernels = []

    def pool(*_: object, **__: object) -> None:
        kernels.append(os.environ.get("OPENBLAS_CORETYPE"))
        raise InterruptedError

    monkeypatch.setenv("OPENBLAS_CORETYPE", "")
    monkeypatch.delenv("OPENBLAS_CORETYPE")
    monkeypatch.setattr(c, "worker_pool", pool)
    with pytest.raises(InterruptedError):
        c.build_close(LEAVES[0], again=True)
    assert kernels == [c.KERNEL]


def test_hulls_that_end_above_the_ground_are_for_what_never_moves() -> None:
    """A bin would fall by 2 cm, and over."""
    bin_, tree = (INDEX.by_leaf(leaf)[0] for leaf in ("trash bin", "tree"))
    foot = shell(made_of(((0.4, 0.4, 1.0), (0, 0, 0))))
    lifted, narrow = foot + [0.0, 0.0, 0.02], foot * [0.6, 0.6, 1.0]
    assert c.foot_area([foot]) == pytest.approx(0.16)
    assert c.foot_area([lifted]) == 0.0
    assert c.stands_as_well(bin_, [foot], [foot * [0.9, 0.9, 1.0], lifted])
    assert not c.stands_as_well(bin_, [foot], [lifted])
    assert not c.stands_as_well(bin_, [foot], [narrow])
    assert c.stands_as_well(tree, [foot], [lifted])


#: A pavement from y = -2 to 2 beside a road.
GROUND = tuple(
    PlacedGround(kind, kind, ((0.0, low), (40.0, low), (40.0, high), (0.0, high)), (0.0, 0.0, 0.0), "grey")
    for kind, low, high in (("sidewalk", -2.0, 2.0), ("road", 2.0, 10.0))
)


def at(name: str, uid: str, y: float, yaw: float = 0.0) -> PlacedObject:
    return PlacedObject(name, "x", "x", uid, (20.0, y, 0.0), yaw, (1.0, 1.0, 1.0), 1.0, 1.0, False)


def test_only_shapes_beside_ground_for_robots_are_made(tmp_path: pathlib.Path) -> None:
    """A house 15 m long reaches the pavement from y = 9 only if its long side points there."""
    long = max(INDEX.records, key=lambda r: r.extent_xyz[0] / r.extent_xyz[1] if 10 < r.extent_xyz[0] < 14 else 0.0)
    bin_, car, bench = (INDEX.by_leaf(leaf)[0] for leaf in ("trash bin", "sedan", "bench"))
    dressed = next(r for r in load_regional().records if r.params["variant"] == 4)
    objects = [at("bin", bin_.uid, 1.5), at("car", car.uid, 8.0), at("bench", bench.uid, -3.2), at("r", dressed.uid, 0)]
    y = 2.0 + long.extent_xyz[0] / 2
    layout = SceneLayout("s", "s", "0", 0, 0, (*objects, at("long", long.uid, y)), GROUND, "day", 0.0, {})
    near = {shape_of(bin_), shape_of(bench), (dressed.recipe, dressed.leaf, 3)}
    assert shapes_of([layout]) == near
    assert shapes_of([layout], in_reach=False) == near | {shape_of(car), shape_of(long)}
    turned = dataclasses.replace(layout, objects=(at("long", long.uid, y, np.pi / 2),))
    assert shapes_of([turned]) == {shape_of(long)}
    layout.save(tmp_path / "scenes" / "s" / "layout.json")
    assert layouts_in([tmp_path]) == [layout]
    with pytest.raises(ValidationError, match=r"found no layout\.json"):
        layouts_in([tmp_path / "nowhere"])


def trials(monkeypatch: pytest.MonkeyPatch, folder: pathlib.Path, *made: np.ndarray) -> list[AssetRecord]:
    """The records that `build_close` tries from now on, with stores in a folder; each gets the hulls `made`."""
    tried = []

    class Pool:
        def __init__(self, jobs: int, niceness: int) -> None: ...
        def __enter__(self) -> "Pool":
            return self

        def __exit__(self, *error: object) -> None: ...
        def map(self, function: object, records: list[AssetRecord]) -> list[tuple[str, tuple[np.ndarray, ...]]]:
            tried.extend(records)
            return [(hull_key(r), made) for r in records]

    monkeypatch.setattr(c, "worker_pool", Pool)
    monkeypatch.setattr(c, "hull_key", lambda record: hull_keys()[record.uid])
    for module in (c, stores):
        monkeypatch.setattr(module, "close_store_path", lambda revision: folder / f"{revision}.npz")
    monkeypatch.setattr(stores, "close_store", stores.close_store.__wrapped__)
    return tried


def test_a_shape_without_closer_hulls_is_tried_once(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    path, (bin_, other) = tmp_path / "close.npz", INDEX.by_leaf("trash bin")[:2]
    tried = trials(monkeypatch, tmp_path)
    objects = (at("a", bin_.uid, 0.0), at("b", other.uid, 0.0))
    layout = SceneLayout("s", "s", "0", 0, 0, objects, GROUND, "day", 0.0, {})
    c.build_close(layouts=[layout], report=str)
    c.build_close(layouts=[layout], report=str)
    assert {r.uid for r in tried} == {bin_.uid, other.uid}
    assert len(tried) == 2
    third = INDEX.by_leaf("trash bin")[2]
    layout = dataclasses.replace(layout, objects=(*objects, at("c", third.uid, 9.0)))
    c.build_close(layouts=[layout], report=str, keep_first=True)
    assert HullStore.load(path).hulls[hull_key(third)] == ()
    assert len(tried) == 2
    plain = load_hulls(bin_).hulls
    assert all((a == b).all() for a, b in zip(load_hulls(bin_, "close").hulls, plain, strict=True))


def test_a_revision_adds_shapes_and_leaves_the_frozen_store_as_it_is(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    corners = np.array([(0, 0, 0), (900, 0, 0), (0, 900, 0), (0, 0, 900)], np.int32)
    closer, kept, missing = INDEX.by_leaf("trash bin")[:3]
    path = HullStore({hull_key(closer): (corners,), hull_key(kept): ()}).save(tmp_path / "close.npz")
    frozen = path.read_bytes()
    tried = trials(monkeypatch, tmp_path, corners * 2)
    objects = tuple(at(str(k), r.uid, 0.0) for k, r in enumerate((closer, kept, missing)))
    layout = SceneLayout("s", "s", "0", 0, 0, objects, GROUND, "day", 0.0, {})
    for _ in range(2):
        c.build_close(layouts=[layout], report=str, kind="close-2")
    assert [r.uid for r in tried] == [r.uid for r in INDEX.by_leaf("trash bin") if r in (closer, kept, missing)]
    assert path.read_bytes() == frozen
    sizes = {kind: [float(load_hulls(r, kind).hulls[0].max()) for r in (closer, kept, missing)] for kind in REVISIONS}
    assert sizes["close"][0] == pytest.approx(0.9)
    assert sizes["close-2"] == pytest.approx([1.8, 1.8, 1.8])
    assert sizes["close"][1:] == [float(load_hulls(r).hulls[0].max()) for r in (kept, missing)]


def test_the_hash_of_a_revision_is_that_of_its_own_files(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    """Built scenes keep the hash of their store: another for `close` would build the frozen sets anew."""
    hash_of = stores.close_hash.__wrapped__
    assert hash_of("close") == hashlib.sha256(close_store_path().read_bytes()).hexdigest()
    monkeypatch.setattr(stores, "close_store_path", lambda revision: tmp_path / f"{revision}.npz")
    hashes = []
    for name, body in (("close", b"a"), ("close-2", b"b"), ("close-2", b"c"), ("close", b"d")):
        (tmp_path / f"{name}.npz").write_bytes(body)
        hashes.append((hash_of("close"), hash_of("close-2")))
    first, second = zip(*hashes, strict=True)
    assert len(set(first[:3])) == 1
    assert first[3] != first[0]
    assert len(set(second)) == 4


def test_every_kind_of_hulls_has_its_stores() -> None:
    assert ["", *REVISIONS] == list(HULL_KINDS)
    for kind, (newest, *earlier) in REVISIONS.items():
        assert newest == kind
        assert not earlier or REVISIONS[earlier[0]] == tuple(earlier)
