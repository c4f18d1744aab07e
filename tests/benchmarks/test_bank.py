"""Benchmark banks: they have the requested contents, equal seeds give equal banks, and hulls are the shipped ones."""

import collections
import dataclasses
import json
import pathlib

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from benchmarks import bank as bank_script
from benchmarks.lib import banks, cutting, streets
from urbanverse_mjx.assets import load_hulls, load_index
from urbanverse_mjx.datatypes import GROUND_KINDS, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.hulls import convex_part
from urbanverse_mjx.simulation.engines import make_engine

OPTIONS = bank_script.Options(layouts=2, seed=3)


@pytest.fixture(scope="module")
def bench_bank() -> SceneBank:
    return bank_script.build(OPTIONS)


def inside(points: np.ndarray, hulls: tuple[np.ndarray, ...], slack: float = 1e-5) -> np.ndarray:
    """(n,) bool: points in any of the hulls, by their planes."""
    planes = [convex_part(h).planes for h in hulls]
    return np.any([(points @ p[:, :3].T <= p[:, 3] + slack).all(1) for p in planes], axis=0)


@pytest.mark.parametrize("leaf", ["sedan", "rock", "bench", "cafe"])
def test_a_cut_solid_is_the_same_solid(leaf: str) -> None:
    """Points of the box around it are inside before and after alike; rounded hulls of 32 corners may lose slivers."""
    hulls = load_hulls(load_index().by_leaf(leaf)[0]).hulls
    pieces = cutting.cut(hulls, 10)
    assert len(pieces) == 10
    corners = np.concatenate(hulls)
    points = np.random.default_rng(0).uniform(corners.min(0), corners.max(0), (4000, 3))
    before, after = inside(points, hulls), inside(points, pieces)
    assert not (after & ~inside(points, hulls, 1e-4)).any()
    assert (before & ~after).sum() <= 0.001 * before.sum()
    volume = [sum(convex_part(h).volume for h in part) for part in (hulls, pieces)]
    assert volume[1] == pytest.approx(volume[0], rel=1e-3)


def test_pieces_of_a_box_are_exact_and_do_not_overlap() -> None:
    corners = np.array([[x, y, z] for x in (0, 4) for y in (0, 2) for z in (0, 1)], np.float32)
    pieces = [convex_part(p) for p in cutting.cut([corners], 8)]
    assert len(pieces) == 8
    assert sum(p.volume for p in pieces) == pytest.approx(8.0, rel=1e-6)
    assert [p.volume for p in pieces] == pytest.approx([1.0] * 8, rel=1e-6)


def test_nothing_is_cut_where_enough_is_there() -> None:
    hulls = load_hulls(load_index().by_leaf("bus shelter")[0]).hulls
    assert len(cutting.cut(hulls, 6)) == len(hulls) == 10


@pytest.mark.extended
def test_it_holds_what_was_asked_for(bench_bank: SceneBank) -> None:
    for scene in range(2):
        owners = bench_bank.inst_object[scene]
        counts = collections.Counter(owners[owners >= 0].tolist())
        assert 200 <= len(counts) <= 300
        assert min(counts.values()) >= 6
        assert max(counts.values()) <= 10
        kinds = np.bincount(bench_bank.map_kind[scene].ravel(), minlength=len(GROUND_KINDS))
        assert (kinds[[GROUND_KINDS.index(k) for k in ("road", "crosswalk", "sidewalk")]] > 0).all()
        places = bench_bank.slot_position[scene][bench_bank.slot_mesh[scene] >= 0]
        assert np.ptp(places[:, 0]) > 195.0
    assert bench_bank.num_episodes.min() >= 256
    figures = bank_script.summary(bench_bank)
    assert figures["layouts"] == 2
    assert 200 <= figures["objects"][0] <= figures["objects"][1] <= 300
    assert figures["objects"] == figures["objects_with_hulls"]


def test_ramps_lead_from_the_kerb_to_the_road(bench_bank: SceneBank) -> None:
    """Some prism tops are tilted as a dropped kerb is, and tops lie at the road's and at the pavement's height."""
    normals = [bench_bank.hull_planes[h, :, :3] for h in bench_bank.prism_hull[0] if h >= 0]
    tilted = [n for n in np.concatenate(normals) if 0.9 < n[2] < 0.9999]
    assert len(tilted) >= 16  # two flares and a ramp on both sides of four crosswalks
    heights = bench_bank.episode_start[..., 2]
    assert heights.min() < 0.16
    assert heights.max() == pytest.approx(0.15, abs=1e-3)


def test_every_layout_differs_and_objects_stand_apart(bench_bank: SceneBank) -> None:
    index = load_index()
    layouts = [streets.make_layout(3, i, index, OPTIONS.objects) for i in range(2)]
    assert layouts[0].content_hash() != layouts[1].content_hash()
    for layout in layouts:
        parked = [o for o in layout.objects if o.label in ("sedan", "suv", "van")]
        for i, one in enumerate(parked):
            for other in parked[:i]:
                assert np.hypot(*np.subtract(one.position[:2], other.position[:2])) > 2.0


@pytest.mark.extended
def test_the_same_seed_makes_the_same_street(bench_bank: SceneBank) -> None:
    """Built again, alone: bit-equal to that in the larger bank."""
    again = bank_script.build(dataclasses.replace(OPTIONS, layouts=1, first=1))
    rows = again.inst_hull[0] >= 0
    np.testing.assert_array_equal(rows, (bench_bank.inst_hull[1] >= 0)[: len(rows)])
    # Which hulls are one object's; the slots are numbered with all streets of a bank in view.
    apart = [np.diff(b.inst_object[i, : len(rows)]) != 0 for b, i in ((again, 0), (bench_bank, 1))]
    np.testing.assert_array_equal(*apart)
    for name in ("inst_position", "inst_rotation", "inst_friction"):
        np.testing.assert_array_equal(getattr(again, name)[0], getattr(bench_bank, name)[1, : len(rows)])
    for name in ("hull_vertices", "hull_planes", "hull_triangles"):
        corners = [getattr(b, name)[b.inst_hull[i, : len(rows)][rows]] for b, i in ((again, 0), (bench_bank, 1))]
        np.testing.assert_array_equal(*corners)
    for name in ("episode_start", "episode_goal", "episode_length", "scene_sky_yaw"):
        np.testing.assert_array_equal(getattr(again, name)[0], getattr(bench_bank, name)[1])
    kinds = again.map_kind[0]
    np.testing.assert_array_equal(kinds, bench_bank.map_kind[1, : kinds.shape[0], : kinds.shape[1]])
    assert again.meta["hashes"]["bench_s3_001"] == bench_bank.meta["hashes"]["bench_s3_001"]
    assert again.meta["hashes"]["bank"] != bench_bank.meta["hashes"]["bank"]


@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp"])
def test_robots_drive_in_it(bench_bank: SceneBank, impl: str) -> None:
    """On the real engine: placed at its first start a robot rests on the ground, and it drives on command."""
    robot = make_coco()
    engine = make_engine(bench_bank, robot, impl=impl)
    start = bench_bank.episode_start[:, 0]
    qpos = np.zeros((2, engine.physics.model.nq))
    qpos[:, :3] = start[:, :3] + (0.0, 0.0, robot.spawn_height)
    qpos[:, 3], qpos[:, 6] = np.cos(start[:, 3] / 2), np.sin(start[:, 3] / 2)
    state = jax.jit(jax.vmap(engine.init))(jnp.arange(2), qpos, np.zeros((2, engine.physics.model.nv)))
    ahead = jnp.tile(robot.command(jnp.array([1.0, 0.0])), (2, 1))
    step = jax.jit(jax.vmap(engine.step))
    for _ in range(5):
        state = step(state, ahead)
    moved = np.asarray(state.qpos[:, :3]) - qpos[:, :3]
    assert (np.linalg.norm(moved[:, :2], axis=1) > 0.4).all()
    assert np.abs(moved[:, 2]).max() < 0.2
    assert not np.asarray(state.contacts.hit).any()


def test_fewer_scenes_are_the_first_of_the_larger_bank(bench_bank: SceneBank) -> None:
    part = banks.first_scenes(bench_bank, 1)
    assert part.scene_ids == bench_bank.scene_ids[:1]
    assert part.num_meshes < bench_bank.num_meshes
    shown = np.flatnonzero(bench_bank.slot_mesh[0] >= 0)
    for slot in shown[:: max(1, len(shown) // 20)]:
        old, new = bench_bank.slot_mesh[0, slot], part.slot_mesh[0, slot]
        for name, start in (("vertices", "vertex_start"), ("uv", "vertex_start"), ("faces", "face_start")):
            bounds, kept = getattr(bench_bank, f"mesh_{start}"), getattr(part, f"mesh_{start}")
            np.testing.assert_array_equal(
                getattr(bench_bank, f"mesh_{name}")[bounds[old] : bounds[old + 1]],
                getattr(part, f"mesh_{name}")[kept[new] : kept[new + 1]],
            )
        assert part.mesh_material[new] == bench_bank.mesh_material[old]
    rows = [part.agents[name] for name in ("kind", "mesh")]
    for kind, new, old in zip(*rows, bench_bank.agents["mesh"], strict=True):
        sizes = [np.diff(b.mesh_vertex_start)[m] for b, m in ((part, new), (bench_bank, old))]
        assert sizes[0] == sizes[1], f"the rows of a {kind} are kept"
    assert len(set(rows[0])) == 5
    with pytest.raises(ValidationError, match="needed 1 to 2"):
        banks.first_scenes(bench_bank, 3)


@pytest.mark.parametrize("count", [50, 400])
def test_thinned_hulls_are_whole_objects_and_the_grid_names_them_alone(bench_bank: SceneBank, count: int) -> None:
    thin = banks.with_hulls(bench_bank, count)
    np.testing.assert_array_equal((thin.inst_hull >= 0).sum(1), [count, count])
    np.testing.assert_array_equal(thin.slot_mesh, bench_bank.slot_mesh)
    for scene in range(2):
        listed = [set(cell[cell >= 0].tolist()) for cell in thin.hull_grid[scene].reshape(-1, thin.hull_grid.shape[-1])]
        full = bench_bank.hull_grid[scene].reshape(-1, bench_bank.hull_grid.shape[-1])
        present = set(np.flatnonzero(thin.inst_hull[scene] >= 0).tolist())
        assert all(kept == set(cell[cell >= 0].tolist()) & present for kept, cell in zip(listed, full, strict=True))
        owners = thin.inst_object[scene]
        before = collections.Counter(bench_bank.inst_object[scene].tolist())
        cut_short = [o for o, n in collections.Counter(owners[owners >= 0].tolist()).items() if n < before[o]]
        assert len(cut_short) <= 1  # the last one is cut where the count is reached
    assert (np.diff((thin.hull_grid >= 0).astype(int), axis=-1) <= 0).all()  # empty places come last


@pytest.mark.extended
def test_the_command_writes_a_bank_and_says_what_is_in_it(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bank.npz"
    options = [
        "--layouts",
        "1",
        "--seed",
        "3",
        "--objects",
        "120",
        "--hulls",
        "1-2",
        "--hulls-per-scene",
        "50",
        "--quiet",
    ]
    assert bank_script.main([*options, "--out", str(out)]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    figures = json.loads(line)
    assert figures["objects"] == [120, 120]
    assert figures["hulls"] == [50, 50]
    assert SceneBank.load(out).meta["hashes"]["bank"] == figures["hash"]
    assert out.stat().st_size == pytest.approx(figures["mib"] * 2**20, rel=0.01)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--objects", "20"], "--objects: found 20, needed at least"),
        (["--objects", "2000"], "no free place for another object"),
        (["--map-cell", "0.07"], "needed a multiple of 0.05 m"),
    ],
)
def test_what_fits_no_street_is_one_sentence(
    options: list[str],
    said: str,
    tmp_path: pathlib.Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(streets, "_TRIES", 5)  # a full street is found to be full sooner
    out = tmp_path / "bank.npz"
    assert bank_script.main(["--layouts", "1", *options, "--out", str(out), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert said in error
    assert not out.exists()


def test_all_160_layouts_find_room_and_differ() -> None:
    """The dearest ones: 300 objects each; one in ten of them."""
    index = load_index()
    layouts = [streets.make_layout(0, i, index, (300, 300)) for i in range(3, 160, 10)]
    assert {len(layout.objects) for layout in layouts} == {300}
    assert len({layout.content_hash() for layout in layouts}) == len(layouts)
    sections = [json.dumps([g.to_json() for g in layout.ground]) for layout in layouts]
    assert len(set(sections)) > 4


@pytest.mark.parametrize("text", ["300-200", "0", "a-b"])
def test_ranges_must_be_ranges(text: str) -> None:
    with pytest.raises(SystemExit):
        bank_script.parse(["--out", "x.npz", "--hulls", text])
