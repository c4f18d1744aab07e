import os
import pathlib
import subprocess
import sys

import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_scene, box_skies
from urbanverse_mjx import srgb
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.mjcf import _SKY_FACES, TIMESTEP, _sky_face, png_bytes, scene_mjcf, scene_spec


@pytest.fixture(scope="module")
def scene() -> SceneGeometry:
    return box_scene(0)


@pytest.fixture(scope="module")
def loaded(scene: SceneGeometry) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = scene_spec(scene, box_skies()["clear"], visuals=True).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def _world_vertices(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> np.ndarray:
    mesh = model.geom_dataid[geom]
    start, number = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    vertices = model.mesh_vert[start : start + number]
    return vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


def test_every_hull_and_prism_stands_where_the_scene_has_it(scene: SceneGeometry, loaded) -> None:
    model, data = loaded
    for o, name in enumerate(scene.object_ids):
        rotation = rotations.matrix(scene.object_quaternion[o])
        for number, q in enumerate(np.flatnonzero(scene.inst_object == o)):
            world = scene.hulls[scene.inst_hull[q]] @ rotation.T + scene.object_position[o]
            mine = _world_vertices(model, data, model.geom(f"{name}/hull_{number}").id)
            assert np.abs(mine[:, None] - world[None]).max(-1).min(1).max() < 1e-5
        assert model.body(name).mass[0] == pytest.approx(scene.object_mass[o], rel=1e-4)
        assert model.geom(f"{name}/hull_0").friction[0] == pytest.approx(scene.object_friction[o], rel=1e-6)
    assert model.njnt == 0, "objects stand where they are, unless they are asked to be free"
    prisms = [g for g in range(model.ngeom) if model.geom_group[g] == 3 and model.geom_bodyid[g] == 0]
    assert len(prisms) == len(scene.prism_hull)
    parts = [list(scene.prism_region[:n]).count(region) for n, region in enumerate(scene.prism_region)]
    names = [f"ground/{scene.region_ids[r]}/{n}" for r, n in zip(scene.prism_region, parts, strict=True)]
    assert [model.geom(g).name for g in prisms] == names, "parts of a region are counted"
    for g, hull, position in zip(prisms, scene.prism_hull, scene.prism_position, strict=True):
        world = scene.hulls[hull] + position
        assert np.abs(_world_vertices(model, data, g)[:, None] - world[None]).max(-1).min(1).max() < 1e-5


def test_what_is_seen_is_not_touched_and_lies_in_the_right_place(scene: SceneGeometry, loaded) -> None:
    model, data = loaded
    seen = model.geom_group == 2
    assert seen.sum() == len(scene.object_ids) + len(scene.region_ids)
    assert not model.geom_contype[seen].any()
    assert not model.geom_conaffinity[seen].any()
    for o in (0, 7, 23):
        mesh = scene.meshes[scene.object_mesh[o]]
        world = mesh.vertices @ rotations.matrix(scene.object_quaternion[o]).T + scene.object_position[o]
        mine = _world_vertices(model, data, model.geom(f"{scene.object_ids[o]}/visual").id)
        assert np.abs(mine[:, None] - world[None]).max(-1).min(1).max() < 1e-5
    assert model.opt.timestep == TIMESTEP
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    assert model.light("sun").type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL


def test_the_sun_shades_the_whole_street_and_near_things_are_drawn(scene: SceneGeometry, loaded) -> None:
    """MuJoCo draws the shadows of a directional light between the clipping planes in front of its position, within
    `shadowclip` extents of the line through it."""
    model, _ = loaded
    sun, extent = model.light("sun"), model.stat.extent
    rotation = rotations.matrix(scene.object_quaternion)[scene.inst_object]
    on_ground = [scene.hulls[h] + p for h, p in zip(scene.prism_hull, scene.prism_position, strict=True)]
    on_objects = [
        scene.hulls[h] @ r.T + p
        for h, r, p in zip(scene.inst_hull, rotation, scene.object_position[scene.inst_object], strict=True)
    ]
    corners = np.concatenate(on_ground + on_objects) - sun.pos
    ahead = corners @ sun.dir
    aside = np.linalg.norm(corners - ahead[:, None] * sun.dir, axis=1)
    assert ahead.min() > model.vis.map.znear * extent
    assert ahead.max() < model.vis.map.zfar * extent
    assert aside.max() < model.vis.map.shadowclip * extent
    assert model.vis.map.znear * extent == pytest.approx(0.02, rel=1e-3)


def test_map_agrees_with_rays(scene: SceneGeometry, loaded) -> None:
    model, data = loaded
    groups, geom = np.array([0, 0, 0, 1, 0, 0], np.uint8), np.zeros(1, np.int32)
    cells = np.random.default_rng(0).integers(0, scene.map.kind.shape, (3000, 2))
    compared = 0
    for i, j in cells:
        x, y = scene.map.origin + (np.array([i, j]) + 0.5) * scene.map.resolution
        distance = mujoco.mj_ray(model, data, np.array([x, y, 5.0]), np.array([0.0, 0, -1]), groups, 1, -1, geom)
        height = scene.map.height[i, j]
        if geom[0] >= 0 and model.geom_bodyid[geom[0]] > 0:
            continue
        if np.isnan(height):
            assert distance < 0
            assert scene.map.kind[i, j] == 0
        else:
            assert 5.0 - distance == pytest.approx(height, abs=1e-5)
            compared += 1
    assert compared > 2000


def test_texture_is_the_right_way_up(scene: SceneGeometry) -> None:
    """A texture with one red corner, uv (0, 0), must come out at that corner in MuJoCo."""
    _, files = scene_mjcf(scene, visuals=True)
    mesh = scene.meshes[scene.object_mesh[0]]
    body = files[f"meshes/visual_{scene.object_mesh[0]}.msh"]
    n = len(mesh.vertices)
    uv = np.frombuffer(body, "<f4", 2 * n, offset=16 + 12 * n).reshape(-1, 2)
    spec = mujoco.MjSpec()
    corners = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]
    spec.add_mesh(name="m", file="m.obj", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    rows = [f"v {corners[i]} {corners[i + 1]} {corners[i + 2]}" for i in range(0, 12, 3)]
    obj = "\n".join([*rows, "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"])
    spec.assets = {"m.obj": obj.encode()}
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="m", contype=0, conaffinity=0)
    stock = spec.compile().mesh_texcoord[0]  # how MuJoCo itself stores the lower left corner (0, 0) of an OBJ
    np.testing.assert_allclose(stock, [0.0, 1.0])
    np.testing.assert_allclose(uv[:, 1], 1.0 - mesh.uv[:, 1], atol=1e-6)


def test_mujoco_shows_the_sky_where_it_is(tmp_path: pathlib.Path) -> None:
    """Each direction of the sky has a colour of its own; MuJoCo's images of it are decoded to directions, in views all
    around, up and down. A process of its own, because MuJoCo chooses its OpenGL when it is imported."""
    polar, azimuth = (np.arange(64) + 0.5) / 64 * np.pi, (np.arange(128) + 0.5) / 128 * 2 * np.pi - np.pi
    around = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(128)], -1)
    radiance = (0.5 + 0.5 * (np.sin(polar)[:, None, None] * around + np.cos(polar)[:, None, None] * [0, 0, 1])) ** 2
    names = {}
    for face, axes in _SKY_FACES.items():
        names[f"file{face}"] = str(tmp_path / f"{face}.png")
        (tmp_path / f"{face}.png").write_bytes(png_bytes(_sky_face(radiance, 0.0, axes)))
    forward = np.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0.6, 0, 0.8), (0, 0.6, 0.8), (0.6, 0, -0.8)])
    right = np.cross(forward, [0, 0, 1]) / np.linalg.norm(np.cross(forward, [0, 0, 1]), axis=-1, keepdims=True)
    axes = np.concatenate([right, np.cross(right, forward)], -1)
    cameras = "".join(f'<camera fovy="60" xyaxes="{" ".join(map(str, row))}"/>' for row in axes)
    files = " ".join(f'{name}="{path}"' for name, path in names.items())
    (tmp_path / "sky.xml").write_text(
        f'<mujoco><asset><texture name="sky" type="skybox" {files}/></asset><worldbody>{cameras}</worldbody></mujoco>'
    )
    code = (
        "import sys, mujoco, numpy as np\n"
        "model = mujoco.MjModel.from_xml_path(sys.argv[1] + '/sky.xml')\n"
        "data = mujoco.MjData(model)\n"
        "mujoco.mj_forward(model, data)\n"
        "try:\n    renderer = mujoco.Renderer(model, 24, 24)\n"
        "except Exception as error:\n    sys.exit(f'no OpenGL: {error}')\n"
        "images = [(renderer.update_scene(data, i), renderer.render())[1] for i in range(model.ncam)]\n"
        "np.save(sys.argv[1] + '/images.npy', images)\n"
    )
    env = {"MUJOCO_GL": "egl", **os.environ}
    ran = subprocess.run([sys.executable, "-c", code, str(tmp_path)], env=env, capture_output=True, text=True)
    if "no OpenGL" in ran.stderr:
        pytest.skip(f"needs off-screen OpenGL: {ran.stderr.strip()[-200:]}")
    assert ran.returncode == 0, ran.stderr
    shown = 2.0 * np.sqrt(np.clip(srgb.linear(np.load(tmp_path / "images.npy") / 255.0), 0.0, 1.0)) - 1.0
    step = ((np.arange(24) + 0.5) / 12 - 1) * np.tan(np.radians(30))
    rays = (
        forward[:, None, None]
        + step[None, None, :, None] * axes[:, None, None, :3]
        - step[None, :, None, None] * axes[:, None, None, 3:]
    )
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    np.testing.assert_allclose(shown, rays, atol=0.1)
    assert np.abs(shown - rays).mean() < 0.03


def test_a_turned_sky_turns_its_faces() -> None:
    radiance = np.zeros((32, 64, 3), np.float32)
    radiance[14:18, 46:50] = 1.0  # azimuth +pi/2 (column 48 of 64 from -pi), level: +y, which MuJoCo calls "back"
    bright = {
        (name, yaw): int(_sky_face(radiance, yaw, axes)[32, 32].min())
        for name, axes in _SKY_FACES.items()
        for yaw in (0.0, -np.pi / 2)
    }
    assert {key for key, value in bright.items() if value} == {("back", 0.0), ("right", -np.pi / 2)}


def test_geometry_file_round_trip(tmp_path, scene: SceneGeometry) -> None:
    scene.save(tmp_path / "geometry.npz")
    loaded = SceneGeometry.load(tmp_path / "geometry.npz")
    assert scene_mjcf(loaded, box_skies()["clear"]) == scene_mjcf(scene, box_skies()["clear"])
    np.testing.assert_array_equal(loaded.map.height, scene.map.height)
    np.testing.assert_array_equal(loaded.episodes.waypoints, scene.episodes.waypoints)
