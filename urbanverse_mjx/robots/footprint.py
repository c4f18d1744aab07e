"""The shape of a robot on the ground, from its collision spheres."""

import dataclasses

import mujoco
import numpy as np

from ..datatypes import RobotSpec
from .description import at_rest

#: m, height of the highest kerbs, over which a part of the robot may be anywhere.
LOW = 0.2


@dataclasses.dataclass(frozen=True)
class Footprint:
    """Shape of a robot on the ground in its heading frame.

    Attributes:
      discs: (D, 3) x, y, radius (m) of the outer collision spheres.
      feet: (F, 2) m, ground contacts.
      low: (L, 2) m, outer ones of the trunk's spheres that end less than `LOW` above the ground, and their middle: they
        touch a kerb that is between the wheels, and at full speed none is between two predictions unnoticed.
      half_width: m, largest distance from its heading line.
      reach: m, farthest point.
    """

    discs: np.ndarray
    feet: np.ndarray
    low: np.ndarray
    half_width: float
    reach: float


def footprint(robot: RobotSpec) -> Footprint:
    """Footprint of a robot in its initial pose."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = at_rest(model, (0, 0, 0))
    solid = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
    spheres = np.array([(*data.geom_xpos[g, :2], model.geom_size[g, 0]) for g in solid])
    angle = np.linspace(-np.pi, np.pi, 128, endpoint=False)
    directions = np.stack([np.cos(angle), np.sin(angle)])
    discs = spheres[np.unique((spheres[:, :2] @ directions + spheres[:, 2:]).argmax(0))]
    on_ground = [model.geom(name).id for name in robot.foot_geoms]
    feet, ends = data.geom_xpos[on_ground, :2], data.geom_xpos[:, 2] - model.geom_size[:, 0]
    root = model.body(robot.root_body).id
    rigid = model.body_weldid[model.geom_bodyid] == root
    low = data.geom_xpos[[g for g in solid if rigid[g] and ends[g] - ends[on_ground].min() < LOW], :2]
    if len(low):
        low = np.concatenate([low[np.unique((low @ directions).argmax(0))], low.mean(0, keepdims=True)])
    half_width = float((np.abs(spheres[:, 1]) + spheres[:, 2]).max())
    return Footprint(discs, feet, low, half_width, float((np.hypot(*spheres[:, :2].T) + spheres[:, 2]).max()))
