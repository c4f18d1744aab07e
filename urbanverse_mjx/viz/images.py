"""High-quality images of scenes from eye level and from above.

They use nine rays per pixel and sun shadows. A `Studio` keeps the bank's meshes and textures for many images;
`render_view` and `birdseye` render one image each.
"""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from ..datatypes import RobotSpec, SceneBank, ValidationError
from ..simulation.rendering.cameras import look_at
from ..simulation.rendering.renderer import Renderer

VIEW_HEIGHT = 1.6
#: rad, vertical field of view.
FOV = np.radians(55.0)


def scene_extent(bank: SceneBank, scene: int) -> np.ndarray:
    """Returns the lower and upper corner (2, 3) m of all objects in a scene, from its slots' meshes."""
    corners = []
    for slot in np.flatnonzero(bank.slot_mesh[scene] >= 0):
        mesh = bank.slot_mesh[scene, slot]
        vertices = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1]]
        turn = Rotation.from_quat(bank.slot_quaternion[scene, slot], scalar_first=True)
        corners.append(turn.apply(vertices) + bank.slot_position[scene, slot])
    if not corners:
        raise ValidationError(f"scene {scene}: found no visual objects; needed at least one; rebuild the bank")
    points = np.concatenate(corners)
    return np.stack([points.min(0), points.max(0)])


class Studio:
    """Renders images of one bank at one size.

    Args:
      bank: the scenes.
      robot: robot to show in the images, or None.
      width, height: pixels.
      samples: rays per pixel along each side.
      shading: see `Renderer`.
    """

    def __init__(
        self,
        bank: SceneBank,
        width: int = 960,
        height: int = 540,
        robot: RobotSpec | None = None,
        samples: int = 3,
        shading: str = "matte",
    ) -> None:
        self.bank = bank
        self.renderer = Renderer(bank, robot, height, width, shadows=True, samples=samples, shading=shading)

    def view(
        self,
        scene: int,
        camera_position: Any,
        target: Any,
        fov: float = FOV,
        up: Any = (0.0, 0.0, 1.0),
        xpos: Any = None,
        xquat: Any = None,
    ) -> np.ndarray:
        """Renders (H, W, 3) uint8 from `camera_position` (3,) towards `target` (3,); fov: vertical, rad; xpos, xquat:
        poses of the robot's bodies."""
        image = self.renderer.view(scene, camera_position, look_at(camera_position, target, up), fov, xpos, xquat)
        return np.asarray(image["rgb"])

    def birdseye(self, scene: int, elevation: float = np.radians(55.0), margin: float = 1.02) -> np.ndarray:
        """Renders the whole scene (H, W, 3) uint8 from above its longer side, with a small field of view.

        Args:
          elevation: rad, of the camera over the ground; π/2 is straight down.
          margin: factor by which the visible area exceeds the scene's ground.
        """
        low, high = scene_extent(self.bank, scene)
        middle, size = (low + high) / 2, high - low
        along = np.array([1.0, 0.0, 0.0]) if size[0] >= size[1] else np.array([0.0, 1.0, 0.0])
        side = np.array([along[1], -along[0], 0.0])
        back = side * np.cos(elevation) + np.array([0.0, 0.0, np.sin(elevation)])
        up = np.array([0.0, 0.0, np.cos(elevation)]) - side * np.sin(elevation)
        fov = np.radians(14.0)
        aspect = self.renderer.settings.width / self.renderer.settings.height
        ground = np.sort(size[:2])
        needed = max(ground[1] / aspect, ground[0] * np.sin(elevation) + size[2] * np.cos(elevation)) * margin
        target = np.array([middle[0], middle[1], low[2] + size[2] * 0.25])
        return self.view(scene, target + back * needed / 2 / np.tan(fov / 2), target, fov, up)

    def eye_level(self, scene: int, row: int = 0, distance: float = 8.0) -> np.ndarray:
        """Renders (H, W, 3) uint8 as seen by a person at the start of episode `row`, along its route."""
        x, y, z, yaw = self.bank.episode_start[scene, row].astype(np.float64)
        camera_position = np.array([x, y, z + VIEW_HEIGHT])
        return self.view(
            scene,
            camera_position,
            camera_position + np.array([np.cos(yaw) * distance, np.sin(yaw) * distance, -0.08 * distance]),
        )


def render_view(
    bank: SceneBank,
    scene: int,
    camera_position: Any,
    target: Any,
    width: int = 960,
    height: int = 540,
    fov: float = FOV,
) -> np.ndarray:
    """Renders a scene (height, width, 3) uint8 from `camera_position` (3,) towards `target` (3,); fov: vertical,
    rad."""
    return Studio(bank, width, height).view(scene, camera_position, target, fov)


def birdseye(bank: SceneBank, scene: int, width: int = 1280, height: int = 480) -> np.ndarray:
    """Renders the whole scene (height, width, 3) uint8 from above."""
    return Studio(bank, width, height).birdseye(scene)
