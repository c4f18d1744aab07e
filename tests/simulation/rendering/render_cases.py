"""Places and banks that the renderer's tests share."""

import dataclasses
from typing import Any

import mujoco
import numpy as np

from tests.support import render_reference
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.simulation.rendering.renderer import Renderer

HEIGHT, WIDTH = 36, 64
#: Slots of a box street that are objects; the ground follows.
OBJECTS = 40
#: View along +x with +z up.
AHEAD = np.array([0.5, 0.5, -0.5, -0.5])
#: View straight down, +y up in the image.
DOWN = np.array([1.0, 0.0, 0.0, 0.0])


@dataclasses.dataclass(frozen=True)
class Places:
    """Robots in scenes: scene (n,), xpos (n, nbody, 3), xquat (n, nbody, 4), and the hits of `mj_ray` there."""

    scene: np.ndarray
    xpos: np.ndarray
    xquat: np.ndarray
    depth: np.ndarray
    slot: np.ndarray

    @property
    def inputs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.scene, self.xpos, self.xquat

    def first(self, number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`inputs` of the first robots."""
        return self.scene[:number], self.xpos[:number], self.xquat[:number]


def make_places(bank: SceneBank, robot: RobotSpec, number: int, seed: int = 0) -> Places:
    """Robots at `number` starts of episodes, spread over all scenes, heading anywhere."""
    rng = np.random.default_rng(seed)
    rows: list[tuple[Any, ...]] = []
    streets: dict[int, render_reference.Street] = {}
    for i in range(number):
        scene = i % bank.num_scenes
        street = streets.setdefault(scene, render_reference.build_street(bank, scene, robot))
        start = bank.episode_start[scene, rng.integers(bank.num_episodes[scene])].astype(float)
        start[3] += rng.uniform(-np.pi, np.pi)
        render_reference.place(street, robot, start)
        seen = render_reference.cast(street, robot.camera, HEIGHT, WIDTH)
        rows.append((scene, street.data.xpos.copy(), street.data.xquat.copy(), *seen))
    return Places(*(np.array(column) for column in zip(*rows, strict=True)))


def with_light(bank: SceneBank, radiance: np.ndarray, direction: Any, irradiance: Any, yaw: float = 0.0) -> SceneBank:
    """The bank with one sky over all scenes: panorama (H, W, 3), sun direction (3,) and irradiance (3,)."""
    direction = np.asarray(direction, np.float32)
    return dataclasses.replace(
        bank,
        sky_radiance=np.asarray(radiance, np.float32)[None],
        sky_sun_direction=(direction / np.linalg.norm(direction))[None],
        sky_sun_irradiance=np.asarray(irradiance, np.float32)[None],
        scene_sky=np.zeros_like(bank.scene_sky),
        scene_sky_yaw=np.full_like(bank.scene_sky_yaw, yaw),
        meta={**bank.meta, "skies": ["one"]},
    )


def plain_bank(bank: SceneBank, albedo: float) -> SceneBank:
    """The bank with everything in one matte grey of linear reflectance `albedo`, without textures."""
    return dataclasses.replace(
        bank,
        material_texture=np.full_like(bank.material_texture, -1),
        material_rgba=np.tile(np.array([albedo, albedo, albedo, 1.0], np.float32), (len(bank.material_rgba), 1)),
        material_roughness=np.ones_like(bank.material_roughness),
        material_metallic=np.zeros_like(bank.material_metallic),
    )


def to_linear(rgb: Any) -> np.ndarray:
    """sRGB bytes to linear light (IEC 61966-2-1)."""
    x = np.asarray(rgb, np.float64) / 255
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def bodies(robot: RobotSpec, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """xpos and xquat of a robot alone at (x, y, z of the ground, yaw)."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    street = render_reference.Street(model, mujoco.MjData(model), np.zeros(model.ngeom))
    render_reference.place(street, robot, start)
    return street.data.xpos.copy(), street.data.xquat.copy()


def make_renderer(bank: SceneBank, robot: RobotSpec | None, **kwargs: Any) -> Renderer:
    return Renderer(bank, robot, HEIGHT, WIDTH, **{"shading": "matte", "threads": 2, **kwargs})


def uv_at(bank: SceneBank, scene: int, slot: int, point: np.ndarray) -> np.ndarray:
    """(2,) texture coordinates of a slot's mesh where a point in the world lies on it, triangle by triangle."""
    mesh = bank.slot_mesh[scene, slot]
    first = bank.mesh_vertex_start[mesh]
    faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]] + first
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, bank.slot_quaternion[scene, slot].astype(float))
    local = turn.reshape(3, 3).T @ (point - bank.slot_position[scene, slot])
    corners = bank.mesh_vertices[faces].astype(float)
    e1, e2, p = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], local - corners[:, 0]
    normal = np.cross(e1, e2)
    area = (normal**2).sum(1)
    a = (np.cross(p, e2) * normal).sum(1) / area
    b = (np.cross(e1, p) * normal).sum(1) / area
    inside = np.minimum(np.minimum(a, b), 1 - a - b)
    distance = np.abs((p * normal).sum(1)) / np.sqrt(area) - np.minimum(inside, 0.0)
    best = distance.argmin()
    uv = bank.mesh_uv[faces[best]].astype(float)
    return uv[0] + a[best] * (uv[1] - uv[0]) + b[best] * (uv[2] - uv[0])
