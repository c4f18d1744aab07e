"""Appearances of moving agents as plain boxes, their front marked by a lower half, for banks of box streets."""

import numpy as np

from urbanverse_mjx.datatypes import AgentAppearance, AssetMesh, SceneBank
from urbanverse_mjx.scene.bank import with_agents
from urbanverse_mjx.scene.hulls import convex_part

#: Kind -> length, width, height (m).
BOXES = {"pedestrian": (0.4, 0.5, 1.7), "car": (4.7, 1.8, 1.5)}


def _box(size: tuple[float, float, float]) -> AssetMesh:
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)]) * size
    part = convex_part(corners.astype(np.float32))
    vertices = part.corners[part.triangles].reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    return AssetMesh(vertices, faces, np.full((len(vertices), 2), 0.5), np.full((4, 4, 3), 200, np.uint8))


def with_box_agents(bank: SceneBank) -> SceneBank:
    """The bank with a box for each kind in `BOXES`, category "agent:kind"."""
    return with_agents(bank, [AgentAppearance(kind, f"agent:{kind}", _box(size)) for kind, size in BOXES.items()])
