"""Robots as other robots see them: their geoms' surfaces as one mesh, against C MuJoCo's places and boxes."""

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.robots import load, make_coco
from urbanverse_mjx.simulation.rendering.model import VISUAL_GROUP
from urbanverse_mjx.simulation.rendering.robot_appearance import with_robot_appearance

ROBOT = "robot"


@pytest.mark.parametrize("name", ["coco", "go2", "husky"])
def test_a_robots_appearance_is_the_surface_of_its_geoms(small_bank: SceneBank, name: str) -> None:
    """Each geom's triangles where C MuJoCo has it, with its area, and in its colour by the image; nothing else of the
    bank changes."""
    robot = make_coco() if name == "coco" else load(name)
    middle = 0.1
    bank = with_robot_appearance(small_bank, robot, ROBOT, middle)
    mesh = bank.agents["mesh"][bank.agents["kind"].index(ROBOT)]
    assert mesh == small_bank.num_meshes
    first, last = bank.mesh_vertex_start[mesh : mesh + 2]
    corners = bank.mesh_vertices[first:last]
    faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
    assert sorted(faces.ravel().tolist()) == list(range(last - first)), "corners of their own for each triangle"
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0] if model.nkey else model.qpos0
    data.qpos[:7] = -middle, 0.0, robot.spawn_height, 1, 0, 0, 0
    mujoco.mj_forward(model, data)
    texture = bank.material_texture[bank.mesh_material[mesh]]
    height, width, channels = bank.texture_shape[texture]
    image = bank.texture_data[bank.texture_start[texture] : bank.texture_start[texture + 1]]
    image = image.reshape(height, width, channels)
    shown = [g for g in range(model.ngeom) if model.geom_group[g] == VISUAL_GROUP]
    column = np.floor(bank.mesh_uv[first:last, 0] * len(shown)).astype(int)
    for k, g in enumerate(shown):
        own = corners[column == k]
        local = (own - data.geom_xpos[g]) @ data.geom_xmat[g].reshape(3, 3)
        # The box around a geom, which of facets of round forms may be smaller by a few per cent.
        box, half = model.geom_aabb[g, :3], model.geom_aabb[g, 3:]
        assert (np.abs(local - box) <= half + 1e-4).all()
        np.testing.assert_allclose(np.ptp(local, axis=0), 2.0 * half, rtol=0.05, atol=2e-3)
        pixel = image[height // 2, int((k + 0.5) / len(shown) * width)]
        material = model.geom_matid[g]
        if material < 0 or model.mat_texid[material].max() < 0:
            wanted = model.geom_rgba[g] if material < 0 else model.mat_rgba[material]
            np.testing.assert_allclose(pixel, 255.0 * wanted[:3], atol=1.0)
    for field in ("mesh_vertices", "mesh_faces", "mesh_uv", "texture_data", "material_rgba", "mesh_material"):
        before = getattr(small_bank, field)
        np.testing.assert_array_equal(getattr(bank, field)[: len(before)], before)
