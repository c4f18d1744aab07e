"""Streets and robots as glTF: read back by trimesh and held against the bank, MuJoCo and the renderer's own tables."""

import io
import json
import struct

import mujoco
import numpy as np
import pytest
import trimesh

from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.robots import make_coco, make_go2
from urbanverse_mjx.simulation.rendering.scenes import scene_sun, sky_ambient, slot_boxes
from urbanverse_mjx.viewer.gltf import Part, Surface, glb, merged, with_normals
from urbanverse_mjx.viewer.robot import robot_files
from urbanverse_mjx.viewer.street import StreetMeshes


def read(body: bytes) -> trimesh.Scene:
    return trimesh.load_scene(io.BytesIO(body), file_type="glb", process=False)


def tree(body: bytes) -> dict:
    length = struct.unpack("<I", body[12:16])[0]
    return json.loads(body[20 : 20 + length])


def test_smooth_and_sharp_normals() -> None:
    ball = trimesh.creation.icosphere(3)
    source, faces, normals = with_normals(ball.vertices, ball.faces)
    assert len(source) == len(ball.vertices)
    np.testing.assert_allclose(normals, ball.vertices, atol=0.02)
    np.testing.assert_array_equal(faces, ball.faces)


def test_both_sides_of_a_sheet_are_lit_as_they_face() -> None:
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]])
    source, new, normals = with_normals(vertices, faces)
    np.testing.assert_allclose(normals[new[:2]], np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3)))
    np.testing.assert_allclose(normals[new[2:]], np.broadcast_to([0.0, 0.0, -1.0], (2, 3, 3)))
    np.testing.assert_array_equal(vertices[source][new], vertices[faces])


def test_no_part_is_refused() -> None:
    with pytest.raises(ValueError, match="found no part"):
        glb([])


def test_copies_share_a_mesh_and_equal_surfaces_a_material() -> None:
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = [0.0, 5.0, 9.0]
    box, red = trimesh.creation.box((1, 2, 4)), Surface((1.0, 0.0, 0.0, 1.0))
    body = tree(glb([Part(box.vertices, box.faces, red, poses=poses), Part(box.vertices, box.faces, red)]))
    assert (len(body["meshes"]), len(body["materials"])) == (2, 1)
    assert sum("mesh" in node for node in body["nodes"]) == 4
    assert body["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [1.0, 0.0, 0.0, 1.0]
    assert "extensionsUsed" not in body


def test_merged_parts_look_as_before() -> None:
    """Triangles, normals and texture coordinates of every copy where it was, and one drawing call for a surface."""
    poses = np.tile(np.identity(4), (2, 1, 1))
    poses[1, :3, :3] = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])[:3, :3]
    poses[1, :3, 3] = [4.0, -1.0, 2.0]
    box, ball = trimesh.creation.box((1, 2, 4)), trimesh.creation.icosphere(1)
    red, blue, other_red = (Surface((r, 0.0, 1.0 - r, 1.0)) for r in (1.0, 0.0, 1.0))
    marks = np.random.default_rng(0).uniform(size=(len(ball.vertices), 2))
    parts = [
        Part(box.vertices, box.faces, red, poses=poses),
        Part(ball.vertices, ball.faces, blue),
        Part(ball.vertices, ball.faces, red, marks, ball.vertices, poses[1:]),
        Part(box.vertices, box.faces, other_red),
    ]
    found = merged(parts)
    assert [part.surface for part in found] == [red, blue, other_red]
    assert sum("mesh" in node for node in tree(glb(found))["nodes"]) == 3

    def rows(body: bytes) -> np.ndarray:
        """(corners of triangles, 8) position, normal, texture coordinates."""
        scene = read(body)
        corners = []
        for name in scene.graph.nodes_geometry:
            pose, geometry = scene.graph[name]
            mesh = scene.geometry[geometry]
            at = mesh.faces.reshape(-1)
            places = trimesh.transform_points(mesh.vertices, pose)[at]
            corners.append(np.hstack([places, mesh.vertex_normals[at] @ pose[:3, :3].T, mesh.visual.uv[at]]))
        return np.concatenate(corners)

    together, apart = rows(glb(found)), rows(glb(parts))
    assert together.shape == apart.shape
    away = np.abs(together[:, None] - apart).max(-1)
    assert away.min(0).max() < 1e-5
    assert away.min(1).max() < 1e-5


@pytest.mark.parametrize("scene", [0, 2])
def test_a_street_stands_where_the_bank_has_it(small_bank: SceneBank, scene: int) -> None:
    """Every slot once, and the corners of each where the renderer's table has them."""
    found = read(StreetMeshes(small_bank, scene).fixed())
    slots = np.flatnonzero(small_bank.slot_mesh[scene] >= 0)
    assert len(found.graph.nodes_geometry) == len(slots)
    assert len(found.geometry) == len(np.unique(small_bank.slot_mesh[scene, slots]))
    lower, upper = (x[scene, slots] for x in slot_boxes(small_bank))
    boxes = []
    for name in found.graph.nodes_geometry:
        pose, geometry = found.graph[name]
        corners = trimesh.transform_points(found.geometry[geometry].vertices, pose)
        boxes.append([*corners.min(0), *corners.max(0)])
    np.testing.assert_allclose(
        sorted(np.round(boxes, 3).tolist()), sorted(np.round(np.hstack([lower, upper]), 3).tolist()), atol=2e-3
    )
    np.testing.assert_allclose(StreetMeshes(small_bank, scene).extent, [lower.min(0), upper.max(0)], atol=1e-5)


def test_textures_lie_as_in_the_bank(bank: SceneBank) -> None:
    """A corner's texel in the file is that of the bank: v counts from the bottom there and from the top in glTF."""
    street = StreetMeshes(bank, 4)
    mesh = max(
        {int(m) for m in bank.slot_mesh[4, street.slots]},
        key=lambda m: bank.texture_shape[bank.material_texture[bank.mesh_material[m]]].prod(),
    )
    slot = int(np.flatnonzero(bank.slot_mesh[4] == mesh)[0])
    solid = next(iter(read(street.object(slot)).geometry.values()))
    image = np.asarray(solid.visual.material.baseColorTexture.convert("RGB"), np.float64)
    own = bank.texture(int(bank.material_texture[bank.mesh_material[mesh]])).astype(np.float64)
    assert image.shape == own.shape
    assert np.abs(image - own).mean() < 4.0  # JPEG
    assert np.abs(image - own).mean() < 0.3 * np.abs(image[::-1] - own).mean()
    corners = slice(bank.mesh_vertex_start[mesh], bank.mesh_vertex_start[mesh + 1])
    number = corners.stop - corners.start
    np.testing.assert_allclose(solid.visual.uv[:number], bank.mesh_uv[corners], atol=1e-5)


def test_movable_objects_are_apart_where_they_are_loose(bank: SceneBank) -> None:
    street = StreetMeshes(bank, 0)
    fixed = sum(len(part.poses) for part in street.fixed_parts(loose=True))
    assert len(street.movable) == int((bank.slot_movable[0] > 0).sum()) > 10
    assert fixed == len(street.slots) - len(street.movable)


def test_the_sun_is_where_the_renderer_has_it(bank: SceneBank) -> None:
    for scene in range(bank.num_scenes):
        light = StreetMeshes(bank, scene).light()
        direction, irradiance = scene_sun(bank)
        np.testing.assert_allclose(light.sun, direction[scene], atol=1e-6)
        assert light.sun_intensity == pytest.approx(max(float(irradiance[scene].max()), 1e-9))


def test_a_grey_sky_lights_from_above_by_pi_times_its_radiance(small_bank: SceneBank) -> None:
    scene = next(z for z in range(3) if small_bank.sky_sun_irradiance[small_bank.scene_sky[z]].max() == 0)
    light = StreetMeshes(small_bank, scene).light()
    assert light.sky_intensity == pytest.approx(np.pi * 0.8, rel=0.02)
    assert light.sky_colour == (255, 255, 255)
    # 0.15 / 0.8 of it comes from below, as sRGB.
    assert light.ground_colour[0] == pytest.approx(120, abs=2)
    assert sky_ambient(small_bank)[scene].max() < 0.8


def test_the_dome_shows_the_sky_by_direction(bank: SceneBank) -> None:
    """A corner of the dome has the colour that the bank's sky has in its direction, turned by the scene's yaw."""
    scene = 0
    body = StreetMeshes(bank, scene).sky()
    assert tree(body)["extensionsUsed"] == ["KHR_materials_unlit"]
    dome = next(iter(read(body).geometry.values()))
    radiance = bank.sky_radiance[bank.scene_sky[scene]]
    rng = np.random.default_rng(0)
    towards = dome.vertices / np.linalg.norm(dome.vertices, axis=1, keepdims=True)
    inside = np.flatnonzero(
        (np.abs(towards[:, 2]) < 0.9) & (dome.visual.uv[:, 0] > 0.05) & (dome.visual.uv[:, 0] < 0.95)
    )
    image = np.asarray(dome.visual.material.baseColorTexture.convert("RGB"), np.float64)
    for corner in rng.choice(inside, 50):
        x, y, z = towards[corner]
        yaw = np.arctan2(y, x) - float(bank.scene_sky_yaw[scene])
        column = int(((yaw + np.pi) / (2 * np.pi) % 1.0) * radiance.shape[1])
        row = int(np.arccos(z) / np.pi * radiance.shape[0])
        u, v = dome.visual.uv[corner]
        shown = image[int((1 - v) * image.shape[0]), int(u * image.shape[1])]
        near = radiance[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].reshape(-1, 3)
        low, high = near.min(0) ** (1 / 2.4) * 1.055 - 0.055, near.max(0) ** (1 / 2.4) * 1.055 - 0.055
        assert (shown >= 255 * np.clip(low, 0, 1) - 24).all()
        assert (shown <= 255 * np.clip(high, 0, 1) + 24).all()
    # The view is from inside.
    inwards = np.einsum("fi,fi->f", dome.face_normals, dome.triangles_center)
    assert inwards[dome.area_faces > 1.0].max() < 0.0
    assert (dome.area_faces > 1.0).mean() > 0.9


@pytest.mark.parametrize("make", [make_coco, make_go2])
def test_a_robot_is_light(make) -> None:
    """Up to eight of them are shown, and each of their triangles is drawn for the image and for its shadows."""
    files = robot_files(make())
    trees = [tree(file) for file in files.values()]
    triangles = sum(
        body["accessors"][primitive["indices"]]["count"] // 3
        for body in trees
        for mesh in body["meshes"]
        for primitive in mesh["primitives"]
    )
    assert triangles < 40_000
    assert sum(map(len, files.values())) < 2_000_000
    # One part for each material of a body.
    assert all(len(body["meshes"]) == len(body["materials"]) for body in trees)


@pytest.mark.parametrize("make", [make_coco, make_go2])
def test_a_robot_is_as_large_as_mujoco_says(make) -> None:
    robot: RobotSpec = make()
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    points = []
    for body, file in robot_files(robot).items():
        found = read(file)
        for name in found.graph.nodes_geometry:
            pose, geometry = found.graph[name]
            local = trimesh.transform_points(found.geometry[geometry].vertices, pose)
            points.append(local @ data.xmat[body].reshape(3, 3).T + data.xpos[body])
    seen = np.concatenate(points)
    wanted = []
    for geom in np.flatnonzero(model.geom_group == 2):
        centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
        wanted.append((centre + signs * half) @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
    corners = np.concatenate(wanted)
    # Boxes around turned geoms are larger than the geoms.
    assert (seen.min(0) >= corners.min(0) - 1e-3).all()
    assert (seen.max(0) <= corners.max(0) + 1e-3).all()
    np.testing.assert_allclose(np.ptp(seen, axis=0), np.ptp(corners, axis=0), rtol=0.15)
