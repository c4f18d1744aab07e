"""Renders four images of an asset, from its front and the other three sides, with the gallery's scene and light."""

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import AssetMesh

from ...geometry import rotations
from ..previews.gallery import scene_of

VIEWS = 4
ELEVATION = -14.0  # degrees, a little from above
MARGIN = 1.1  # air round the asset's bounding sphere


def render_views(mesh: AssetMesh, size: tuple[int, int]) -> list[np.ndarray]:
    """Renders four views; view k is rotated by k quarters counter-clockwise from the front (+x), together with the
    light.

    Args:
      size: (width, height), pixels.

    Returns:
      four images (height, width, 3) uint8.
    """
    model, bounds = scene_of([mesh])
    width, height = size
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.global_.fovy = 20.0
    model.vis.quality.shadowsize, model.vis.quality.offsamples = 1024, 4
    camera = mujoco.MjvCamera()
    camera.elevation, camera.lookat = ELEVATION, bounds.mean(0)
    reach = float(np.linalg.norm(bounds[1] - bounds[0])) / 2
    camera.distance = MARGIN * reach / np.sin(np.radians(model.vis.global_.fovy / 2))
    model.vis.map.znear = 0.02 / max(model.stat.extent, 1e-3)
    model.vis.map.zfar = 10 * (camera.distance + 10) / model.stat.extent
    light, data = model.light_dir[0].copy(), mujoco.MjData(model)
    views = []
    with mujoco.Renderer(model, height, width) as renderer:
        for k in range(VIEWS):
            model.light_dir[0] = rotations.about_z(np.pi / 2 * k) @ light
            mujoco.mj_forward(model, data)
            camera.azimuth = 180.0 + 90.0 * k
            renderer.update_scene(data, camera)
            views.append(renderer.render().copy())
    return views
