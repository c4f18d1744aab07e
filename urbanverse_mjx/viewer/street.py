"""Converts a street of a bank to glTF: the static part, each movable object, the sky, the light.

It uses the same data as the project's renderer: the bank's meshes, textures, poses and skies.
"""

import dataclasses
import functools

import numpy as np

from .. import srgb
from ..datatypes import SceneBank
from ..geometry import rotations
from .gltf import Part, Surface, glb

#: m, of the dome that shows the sky, around the middle of the street: larger than every street, within the page's far
#: plane.
_DOME = 600.0
_DOME_ROWS, _DOME_COLUMNS = 32, 64


@dataclasses.dataclass(frozen=True)
class Light:
    """Light of a scene in three.js's parameters.

    Attributes:
      sun: (3,) unit, towards the sun.
      sun_colour, sky_colour, ground_colour: (3,) u8 sRGB.
      sun_intensity: irradiance.
      sky_intensity: of a white surface that faces up, from the sky alone.
    """

    sun: np.ndarray
    sun_colour: tuple[int, int, int]
    sun_intensity: float
    sky_colour: tuple[int, int, int]
    ground_colour: tuple[int, int, int]
    sky_intensity: float


class StreetMeshes:
    """Meshes of one scene of a bank.

    Args:
      bank: the scenes.
      scene: a row of it.
    """

    def __init__(self, bank: SceneBank, scene: int) -> None:
        self.bank, self.scene = bank, scene

    @functools.cached_property
    def slots(self) -> np.ndarray:
        """Returns (n,) i32, the occupied slots."""
        return np.flatnonzero(self.bank.slot_mesh[self.scene] >= 0)

    @functools.cached_property
    def movable(self) -> np.ndarray:
        """(m,) i32, the slots of objects that may be pushed."""
        return np.flatnonzero((self.bank.slot_mesh[self.scene] >= 0) & (self.bank.slot_movable[self.scene] > 0))

    def fixed_parts(self, loose: bool) -> list[Part]:
        """Returns one part for each static mesh, without the movable objects if they are `loose`."""
        kept = np.setdiff1d(self.slots, self.movable) if loose else self.slots
        meshes = self.bank.slot_mesh[self.scene, kept]
        return [
            self._part(int(mesh), np.stack([self.pose(int(slot)) for slot in kept[meshes == mesh]]))
            for mesh in np.unique(meshes)
        ]

    def fixed(self, loose: bool = False) -> bytes:
        """`fixed_parts` as one file, in the world's frame."""
        return glb(self.fixed_parts(loose))

    def object(self, slot: int) -> bytes:
        """The object of a slot, in its own frame."""
        return glb([self._part(int(self.bank.slot_mesh[self.scene, slot]))])

    def agent(self, appearance: int) -> bytes:
        """A moving agent of a row of the bank's agents, in its own frame: front along x."""
        return glb([self._part(int(self.bank.agents["mesh"][appearance]))])

    def pose(self, slot: int) -> np.ndarray:
        """(4, 4) T_world_object of a slot."""
        pose = np.eye(4)
        pose[:3, :3] = rotations.matrix_f64(self.bank.slot_quaternion[self.scene, slot])
        pose[:3, 3] = self.bank.slot_position[self.scene, slot]
        return pose

    @functools.cached_property
    def extent(self) -> np.ndarray:
        """Returns (2, 3) m, the lower and upper corner of all objects in the scene."""
        points = np.concatenate(
            [
                part.vertices @ pose[:3, :3].T + pose[:3, 3]
                for part in self.fixed_parts(loose=False)
                for pose in part.poses
            ]
        )
        return np.stack([points.min(0), points.max(0)])

    def sky(self) -> bytes:
        """Returns a dome with the scene's sky on its inside, around the origin."""
        bank, row = self.bank, int(self.bank.scene_sky[self.scene])
        image = _displayed(bank.sky_radiance[row])
        around = np.linspace(0.0, 2 * np.pi, _DOME_COLUMNS + 1)
        down = np.linspace(0.0, np.pi, _DOME_ROWS + 1)
        polar, azimuth = np.meshgrid(down, around, indexing="ij")
        # Column 0 of the image is at yaw -pi of the sky, which the scene turns.
        yaw = azimuth - np.pi + float(bank.scene_sky_yaw[self.scene])
        towards = np.stack([np.sin(polar) * np.cos(yaw), np.sin(polar) * np.sin(yaw), np.cos(polar)], -1)
        uv = np.stack([azimuth / (2 * np.pi), 1.0 - polar / np.pi], -1)
        number = np.arange(polar.size).reshape(polar.shape)
        a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        # Faces point inward.
        faces = np.concatenate([np.stack(x, -1).reshape(-1, 3) for x in ((a, c, b), (a, d, c))])
        vertices = towards.reshape(-1, 3) * _DOME
        return glb(
            [Part(vertices, faces, Surface(texture=image, unlit=True), uv.reshape(-1, 2), -towards.reshape(-1, 3))]
        )

    def light(self) -> Light:
        """The sun and the sky of the scene."""
        bank, row = self.bank, int(self.bank.scene_sky[self.scene])
        yaw = float(bank.scene_sky_yaw[self.scene])
        sun = rotations.about_z(yaw) @ bank.sky_sun_direction[row].astype(np.float64)
        up, down = _irradiance(bank.sky_radiance[row].astype(np.float64))
        sun_colour, sun_intensity = _colour(bank.sky_sun_irradiance[row])
        sky_colour, sky_intensity = _colour(up)
        ground_colour, _ = _colour(down, sky_intensity)
        return Light(sun, sun_colour, sun_intensity, sky_colour, ground_colour, sky_intensity)

    @functools.cached_property
    def _surfaces(self) -> dict[int, Surface]:
        return {}

    def _surface(self, material: int) -> Surface:
        bank = self.bank
        if material not in self._surfaces:
            texture = int(bank.material_texture[material])
            self._surfaces[material] = Surface(
                rgba=tuple(float(x) for x in bank.material_rgba[material]),  # type: ignore[arg-type]
                texture=None if texture < 0 else bank.texture(texture),
                roughness=float(bank.material_roughness[material]),
                metallic=float(bank.material_metallic[material]),
            )
        return self._surfaces[material]

    def _part(self, mesh: int, poses: np.ndarray | None = None) -> Part:
        bank = self.bank
        corners = slice(bank.mesh_vertex_start[mesh], bank.mesh_vertex_start[mesh + 1])
        faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
        return Part(
            bank.mesh_vertices[corners],
            faces,
            self._surface(int(bank.mesh_material[mesh])),
            bank.mesh_uv[corners],
            poses=np.eye(4)[None] if poses is None else poses,
        )


def _irradiance(radiance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(3,) light of a sky (H, W, 3) on a surface that faces up, and on one that faces down."""
    height, width = radiance.shape[:2]
    polar = (np.arange(height) + 0.5) / height * np.pi
    patch = np.sin(polar) * (np.pi / height) * (2 * np.pi / width)
    rows = radiance.sum(1) * (patch * np.abs(np.cos(polar)))[:, None]
    return rows[: height // 2].sum(0), rows[height // 2 :].sum(0)


def _colour(light: np.ndarray, intensity: float | None = None) -> tuple[tuple[int, int, int], float]:
    """sRGB colour and intensity whose product is (3,) linear `light`; the intensity may be given."""
    intensity = float(max(light.max(), 1e-9)) if intensity is None else intensity
    red, green, blue = (int(x) for x in np.rint(255 * srgb.encoded(np.asarray(light, np.float64) / intensity)))
    return (red, green, blue), intensity


def _displayed(radiance: np.ndarray) -> np.ndarray:
    """A sky as an image (H, W, 3) u8."""
    return np.rint(255 * srgb.encoded(radiance.astype(np.float64))).astype(np.uint8)
