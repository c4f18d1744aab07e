import dataclasses
import json
import pathlib
import shutil
import subprocess
import sys

import mujoco
import numpy as np
import pytest

from tests.support.box_bank import street_regions
from tests.support.toy_assets import TOY_SOURCE, UNIT_BOX, few_episodes, toy_index, toy_layout
from urbanverse_mjx.datatypes import GraphObject, SceneBank, SceneGraph, SceneLayout, Source, ValidationError
from urbanverse_mjx.datatypes.ground import GROUND_KINDS, KIND_INDEX, TRAVERSABLE_KINDS
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.scene import CompiledScene, compile_scene, pack_bank
from urbanverse_mjx.scene.episodes import MIN_ROWS
from urbanverse_mjx.scene.planner import RobotSize, free_space
from urbanverse_mjx.work_folder import MADE


def _layout(seed: int = 3) -> SceneLayout:
    rng = np.random.default_rng(7)
    objects = []
    for k in range(24):
        size = rng.uniform([0.2, 0.2, 0.4], [0.9, 0.7, 1.8])
        side = rng.choice([-1, 1])
        x, y = rng.uniform(1, 59), side * rng.uniform(4.4, 7.6)
        if abs(x - 30) > 3:
            z = 0.15 + size[2] / 2
            objects.append(GraphObject(f"o{k}", "bollard", (x, y, z), tuple(size), rng.uniform(-3, 3)))
    source = Source("hand", "Apache-2.0", "none", "none")
    return toy_layout(SceneGraph("toy_street", source, tuple(objects), tuple(street_regions())), seed)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> CompiledScene:
    out = tmp_path_factory.mktemp("scene") / "toy"
    return compile_scene(_layout(), toy_index(), out, make_controller(), source=TOY_SOURCE)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> CompiledScene:
    """The same street with few episodes."""
    out = tmp_path_factory.mktemp("small") / "toy"
    with few_episodes():
        return compile_scene(_layout(), toy_index(), out, make_controller(), source=TOY_SOURCE)


@pytest.mark.extended
def test_folder_is_whole_and_loads_in_stock_mujoco(compiled: CompiledScene) -> None:
    names = {p.name for p in compiled.folder.iterdir()}
    files = {"scene.xml", "episodes.npz", "layout.json", "metadata.json", "geometry.npz"}
    exchange = {"map.json", "layers.npz", "annotations.json", "routes.json", "routes.txt"}
    waypoints = {f"r{i:03d}.npy" for i in range(1, 13)}
    assert names == files | exchange | waypoints | {"meshes", "textures", MADE}
    code = """import mujoco, sys
model = mujoco.MjModel.from_xml_path(sys.argv[1])
print(model.ngeom, 'urbanverse_mjx' in sys.modules)"""
    run = subprocess.run(
        [sys.executable, "-c", code, compiled.folder / "scene.xml"], capture_output=True, text=True, check=True
    )
    counts = compiled.metadata["counts"]
    assert run.stdout.split() == [str(sum(counts[k] for k in ("objects", "hulls", "prisms", "regions"))), "False"]
    assert not list(compiled.folder.parent.glob(".toy-*"))


def test_the_mjcf_file_is_static_and_says_how_many_movable_objects_it_fixed(compiled: CompiledScene) -> None:
    number = len(compiled.layout.objects)
    assert compiled.metadata["bodies"] == {"free": 0, "laid": 0, "movable_fixed": number, "unstable_fixed": 0}
    head = (compiled.folder / "scene.xml").read_text().splitlines()[1]
    assert f"All {number} objects are fixed, {number} of them movable; 0 do not stay" in head
    assert mujoco.MjModel.from_xml_path(str(compiled.folder / "scene.xml")).nv == 0


def test_objects_stand_at_the_layouts_poses(compiled: CompiledScene) -> None:
    model = mujoco.MjModel.from_xml_path(str(compiled.folder / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bank = pack_bank([compiled.folder], ["test"])
    slots = {name: slot for slot, name in enumerate(bank.meta["object_ids"][0]) if name}
    for placed in compiled.layout.objects:
        body = model.body(placed.id).id
        np.testing.assert_allclose(data.xpos[body], placed.position, atol=1e-5)
        forward = data.xmat[body].reshape(3, 3)[:, 0]
        np.testing.assert_allclose(forward, [np.cos(placed.yaw), np.sin(placed.yaw), 0], atol=1e-6)
        assert model.body_mass[body] == pytest.approx(placed.mass, rel=1e-4)
        (q,) = np.flatnonzero(bank.inst_object[0] == slots[placed.id])
        corners = bank.hull_vertices[bank.inst_hull[0, q], :8]
        np.testing.assert_allclose(
            sorted(map(tuple, corners)), sorted(map(tuple, UNIT_BOX * np.array(placed.scale, np.float32)))
        )


def test_episodes_keep_every_rule(compiled: CompiledScene) -> None:
    table = compiled.geometry.episodes
    size = RobotSize(height=1.0)
    space = free_space(compiled.geometry.map, size)
    assert len(table) >= MIN_ROWS
    assert len(np.unique(table.goal, axis=0)) >= 32
    straight = np.linalg.norm(table.goal[:, :2] - table.start[:, :2], axis=1)
    assert straight.min() >= 10.0
    assert straight.max() <= 30.0
    assert (table.length >= straight - 1e-6).all()
    for ends in (table.start[:, :2], table.goal[:, :2]):
        assert (space.distance[space.cell(ends)] >= size.radius + size.end_margin - 1e-6).all()
        kinds = compiled.geometry.map.kind[space.cell(ends)]
        assert np.isin(kinds, [KIND_INDEX[k] for k in TRAVERSABLE_KINDS]).all()
    assert (table.drive_time > straight / 2.0 - 1.0).all()
    first = table.waypoints[:, 0, :2] - table.start[:, :2]
    off = np.angle(np.exp(1j * (np.arctan2(first[:, 1], first[:, 0]) - table.start[:, 3])))
    assert np.abs(off).max() <= np.pi / 6 + 1e-6
    assert np.abs(off).max() > np.pi / 8
    for e in range(len(table)):
        number = table.num_waypoints[e]
        assert number == int(np.ceil(table.length[e] / 5.0 - 1e-6))
        np.testing.assert_array_equal(
            table.waypoints[e, number - 1 :], np.broadcast_to(table.goal[e], (table.waypoints.shape[1] - number + 1, 3))
        )
        gaps = np.linalg.norm(
            np.diff(np.concatenate([table.start[e : e + 1, :2], table.waypoints[e, :number, :2]]), axis=0), axis=1
        )
        assert gaps.max() <= 5.0 + 1e-6
    np.testing.assert_array_equal(table.line_free, space.lines_free(table.start[:, :2], table.goal[:, :2]))
    assert table.crosses_road.mean() >= 0.15
    assert 0.2 <= table.line_free.mean() <= 0.5
    heights = compiled.geometry.map.height[space.cell(table.goal[:, :2])]
    np.testing.assert_allclose(table.goal[:, 2], heights)


@pytest.mark.extended
def test_same_layout_same_files(small: CompiledScene, tmp_path: pathlib.Path) -> None:
    with few_episodes():
        again = compile_scene(_layout(), toy_index(), tmp_path / "again", make_controller(), source=TOY_SOURCE)
    for path in sorted(p for p in small.folder.rglob("*") if p.is_file()):
        twin = again.folder / path.relative_to(small.folder)
        if path.suffix == ".npz":
            with np.load(path) as a, np.load(twin) as b:
                assert a.files == b.files
                for name in a.files:
                    np.testing.assert_array_equal(a[name], b[name])
        else:
            assert path.read_bytes() == twin.read_bytes()
    loaded = CompiledScene.load(again.folder)
    assert loaded.layout == small.layout
    assert loaded.metadata == small.metadata
    # Not in the file: it follows from the layout.
    friction = loaded.geometry.prism_material_friction
    np.testing.assert_array_equal(friction, small.geometry.prism_material_friction)
    kinds = {GROUND_KINDS[k]: f for k, f in zip(loaded.geometry.prism_kind, friction.tolist(), strict=True)}
    assert kinds["road"] == 0.7
    assert kinds["sidewalk"] == 0.65
    assert (loaded.geometry.prism_friction == 1.0).all(), "frozen benchmarks pin it"


def test_routes_are_in_the_exchange_format(compiled: CompiledScene) -> None:
    body = json.loads((compiled.folder / "routes.json").read_text())
    assert (body["format"], body["scene"]) == (1, "toy_street")
    assert body["robot"] == {"name": "delivery", "radius": 0.35, "height": 1.0, "step": 0.22}
    assert len(body["routes"]) == 12
    for route in body["routes"]:
        points = np.load(compiled.folder / route["waypoints"])
        facts = route["facts"]
        assert points.shape[1] == 4
        assert np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1).max() <= 0.5 + 1e-3
        assert route["start"] == dict(zip(("x", "y", "z", "yaw"), points[0], strict=True))
        assert [route["goal"][k] for k in "xyz"] == points[-1, :3].tolist()
        assert facts["min_clearance_m"] >= 0.34
        assert sum(facts["by_kind_m"].values()) == pytest.approx(facts["length_m"], abs=0.05)
        assert facts["detour"] >= 1.0
        assert (facts["road_crossings"] > 0) >= (facts["curbs"] > 0)
    longest = max(r["facts"]["length_m"] for r in body["routes"])
    assert compiled.metadata["route_length_m"] == longest >= 50.0


def test_metadata_tells_what_the_scene_is_like(compiled: CompiledScene) -> None:
    """The toy street: two pavements of 60 m by 4 m, a road of 60 m by 8 m with a 4 m crosswalk; kerbs but at ramps."""
    facts = compiled.metadata
    assert (facts["city"], facts["country"]) == ("none", "none")
    facts = facts["statistics"]
    assert facts["categories"] == {"bollard": facts["objects"]}
    assert facts["houses"] == 0
    assert facts["ground_area_m2"]["sidewalk"] == pytest.approx(2 * 60 * 4, rel=0.01)
    assert facts["ground_area_m2"]["road"] + facts["ground_area_m2"]["crosswalk"] == pytest.approx(60 * 8, rel=0.01)
    assert facts["kerbs"]["length_m"] == pytest.approx(2 * 56, abs=3)
    assert facts["kerbs"]["height_m"] == pytest.approx(0.15, abs=0.01)
    assert facts["pavement"]["width_m"]["p50"] == pytest.approx(4.0, abs=0.15)
    assert facts["pavement"]["clear_width_m"]["p10"] < 3.95
    assert 90 <= facts["pavement"]["length_m"] <= 125


def test_bank_of_the_folder_has_the_scene(compiled: CompiledScene) -> None:
    bank = pack_bank([compiled.folder], ["train"])
    assert isinstance(bank, SceneBank)
    table = compiled.geometry.episodes
    assert bank.num_episodes[0] == len(table)
    np.testing.assert_allclose(bank.episode_start[0], table.start, atol=1e-5)
    np.testing.assert_array_equal(bank.map_kind[0], compiled.geometry.map.kind)
    assert bank.meta["hashes"] == {"toy_street": compiled.layout.content_hash()}
    with pytest.raises(ValidationError, match="one for each scene"):
        pack_bank([compiled.folder], [])


def test_failure_leaves_nothing_and_keeps_what_was_there(compiled: CompiledScene, tmp_path: pathlib.Path) -> None:
    layout = _layout()
    broken = dataclasses.replace(layout, objects=(dataclasses.replace(layout.objects[0], asset_uid="no/such"),))
    with pytest.raises(ValidationError, match="no/such"):
        compile_scene(broken, toy_index(), tmp_path / "new", make_controller(), source=TOY_SOURCE)
    assert not list(tmp_path.iterdir())
    before = {p: p.stat().st_mtime_ns for p in compiled.folder.rglob("*")}
    with pytest.raises(ValidationError, match="no/such"):
        compile_scene(broken, toy_index(), compiled.folder, make_controller(), source=TOY_SOURCE)
    assert {p: p.stat().st_mtime_ns for p in compiled.folder.rglob("*")} == before
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "diary.txt").write_text("mine")
    with pytest.raises(ValidationError, match="folder with other files"):
        compile_scene(layout, toy_index(), tmp_path / "notes", make_controller(), source=TOY_SOURCE)
    assert [p.name for p in (tmp_path / "notes").iterdir()] == ["diary.txt"]


@pytest.mark.extended
def test_a_scene_that_is_compiled_again_keeps_the_users_files(small: CompiledScene, tmp_path: pathlib.Path) -> None:
    folder = shutil.copytree(small.folder, tmp_path / "scene")
    for name in ("notes.md", ".git/config", "map/notes.md"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text("mine")
    (folder / "metadata.json").write_text("damaged")
    with few_episodes():
        compile_scene(_layout(), toy_index(), folder, make_controller(), source=TOY_SOURCE)
    assert [(folder / name).read_text() for name in ("notes.md", ".git/config", "map/notes.md")] == ["mine"] * 3
    assert CompiledScene.load(folder).metadata == small.metadata


def test_no_room_for_episodes_is_refused(tmp_path: pathlib.Path) -> None:
    layout = _layout()
    road = tuple(g for g in layout.ground if g.kind == "road")
    with pytest.raises(ValidationError, match="walkable ground"):
        compile_scene(
            dataclasses.replace(layout, ground=road), toy_index(), tmp_path / "x", make_controller(), source=TOY_SOURCE
        )
    small = tuple(g for g in layout.ground if g.id == "ramp_left")
    with pytest.raises(ValidationError, match="walkable ground"):
        compile_scene(
            dataclasses.replace(layout, ground=small), toy_index(), tmp_path / "x", make_controller(), source=TOY_SOURCE
        )
    assert not list(tmp_path.iterdir())
