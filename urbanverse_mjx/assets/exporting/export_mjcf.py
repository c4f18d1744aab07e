"""An asset as an MJCF model that stock MuJoCo loads: visual meshes, convex collision hulls, mass and inertia."""

from collections.abc import Sequence
from xml.etree import ElementTree as ET

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord

from ..collision.rigid_body import rigid_body

# MuJoCo's defaults of torsional (m) and rolling (m) friction; a record has only sliding friction.
TORSIONAL, ROLLING = 0.005, 0.0001


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    return " ".join(f"{float(x):.9g}" for x in np.ravel(values))


def mjcf_text(
    record: AssetRecord, mesh: AssetMesh, hulls: Sequence[np.ndarray], mesh_file: str, texture_file: str
) -> str:
    """The model's XML. It names two files beside itself: the visual mesh (OBJ) and its texture (PNG).

    The asset is one body called `asset`. An asset that one person can move has a free joint; others are fixed to the
    world and keep their mass.
    """
    root = ET.Element("mujoco", model=record.uid.replace("/", "-"))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    asset, world = ET.SubElement(root, "asset"), ET.SubElement(root, "worldbody")
    shine = 1.0 - mesh.roughness
    ET.SubElement(asset, "texture", name="visual", type="2d", file=texture_file)
    appearance = {"roughness": _numbers([mesh.roughness]), "metallic": _numbers([mesh.metallic])}
    appearance |= {"specular": _numbers([0.5 * shine]), "shininess": _numbers([shine])}
    ET.SubElement(asset, "material", {"name": "visual", "texture": "visual"} | appearance)
    ET.SubElement(asset, "mesh", name="visual", file=mesh_file, inertia="shell")
    body = ET.SubElement(world, "body", name="asset")
    if record.movable:
        ET.SubElement(body, "freejoint", name="asset")
    solid = rigid_body(record, mesh, hulls)
    i = solid.inertia
    full = _numbers([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])
    ET.SubElement(body, "inertial", pos=_numbers(solid.centre), mass=_numbers([solid.mass]), fullinertia=full)
    seen = {"name": "visual", "type": "mesh", "mesh": "visual", "material": "visual", "group": "2"}
    ET.SubElement(body, "geom", seen | {"contype": "0", "conaffinity": "0", "mass": "0"})
    friction = _numbers([record.friction_coefficient, TORSIONAL, ROLLING])
    for k, corners in enumerate(hulls):
        ET.SubElement(asset, "mesh", name=f"hull_{k}", vertex=_numbers(corners), inertia="convex")
        # The record's mass is in <inertial>, so hulls have no mass.
        hull = {"name": f"hull_{k}", "type": "mesh", "mesh": f"hull_{k}", "group": "3", "mass": "0"}
        ET.SubElement(body, "geom", hull | {"friction": friction})
    ET.indent(root, " ")
    return ET.tostring(root, encoding="unicode") + "\n"
