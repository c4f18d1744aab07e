"""Digests of the parts of scenes and robots on which a frozen benchmark depends, to detect and name changes.

In:   a scene of a `SceneBank`, or a `RobotSpec`. Out:  digests of the scene's map and physics, figures of its light and
of its surfaces, the digest of the robot. When: once when a benchmark is frozen, and before every run.

The hash of a scene's layout covers which assets stand where, but not the shape of the assets, the map, the sky or the
robot. Lengths are compared in whole millimetres. Light and surfaces are compared within 2 %, because float32 functions
differ in the last digits between processors.
"""

import hashlib
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from ..datatypes import RobotSpec, SceneBank
from ..datatypes import validation as v
from ..datatypes.hashing import content_hash

#: Parts of a scene, in the order in which they are compared.
PARTS = ("map", "physics", "light", "surfaces")
#: Quantisation step of digests: m for lengths, no unit for other values.
_QUANTUM = 1e-3
#: Quantisation step of rotations, large enough to hide rounding errors of float32.
_ROTATION_QUANTUM = 1e-2
#: Relative and absolute tolerance of figures.
_TOLERANCE = (0.02, 0.002)
#: Arrays of a MuJoCo model that affect its motion.
_MODEL = (
    *("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_pos", "body_quat", "body_parentid"),
    *("jnt_type", "jnt_pos", "jnt_axis", "jnt_range", "jnt_stiffness", "jnt_limited", "qpos0"),
    *("dof_damping", "dof_armature", "dof_frictionloss"),
    *("geom_type", "geom_size", "geom_pos", "geom_quat", "geom_friction", "geom_solref", "geom_solimp", "geom_condim"),
    *("actuator_gainprm", "actuator_biasprm", "actuator_ctrlrange", "actuator_forcerange", "actuator_gear"),
    *("cam_pos", "cam_quat", "cam_fovy"),
)
_OPTION = ("timestep", "gravity", "integrator", "cone", "impratio")


def scene_pins(bank: SceneBank, scene: int, materials: bool = False) -> dict[str, Any]:
    """Digests (64 hexadecimal digits) of the parts "map" and "physics" of row `scene`, and figures (lists of floats) of
    "light" and "surfaces"; materials: "physics" covers the friction of the ground's materials."""
    return {
        "map": _map(bank, scene),
        "physics": _physics(bank, scene, materials),
        "light": _light(bank, scene),
        "surfaces": _surfaces(bank, scene),
    }


def robot_pin(robot: RobotSpec) -> str:
    """Digest of 64 hexadecimal digits over a robot's MuJoCo model, rounded to six digits, and its limits."""
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    values = {name: getattr(model, name) for name in _MODEL} | {name: getattr(model.opt, name) for name in _OPTION}
    arrays = {name: [f"{x:.6g}" for x in np.ravel(value)] for name, value in values.items()}
    limits = ("max_speed", "max_yaw_rate", "physics_timestep", "spawn_height", "foot_geoms", "camera")
    return content_hash({**arrays, **{name: f"{getattr(robot, name)}" for name in limits}})


def checked(value: Any, where: str) -> dict[str, Any]:
    """Checks the pins of a file.

    Raises:
      ValidationError: the parts are not the four of `PARTS`, or have other types.
    """
    pins = v.mapping(value, where, PARTS)
    return {
        "map": v.text(pins["map"], f"{where}.map"),
        "physics": v.text(pins["physics"], f"{where}.physics"),
        "light": list(v.vector(pins["light"], f"{where}.light", 14)),
        "surfaces": list(v.vector(pins["surfaces"], f"{where}.surfaces", 4)),
    }


def changed_part(frozen: Mapping[str, Any], found: Mapping[str, Any]) -> str | None:
    """The first part in which a scene differs from its frozen pins; None if there is none."""
    for part in PARTS:
        if isinstance(found[part], str):
            same = frozen[part] == found[part]
        else:
            same = np.allclose(frozen[part], found[part], *_TOLERANCE)
        if not same:
            return part
    return None


def _digest(*arrays: np.ndarray) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(repr((array.dtype.str, array.shape)).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _steps(values: np.ndarray, quantum: float = _QUANTUM) -> np.ndarray:
    return np.round(np.asarray(values, np.float64) / quantum).astype(np.int32)


def _map(bank: SceneBank, scene: int) -> str:
    """Digest of the map without the padding of the bank."""
    kind = bank.map_kind[scene]
    rows, columns = (np.flatnonzero(kind.any(axis)) for axis in (1, 0))
    if not len(rows):
        return _digest(kind[:0, :0])
    first = np.array([rows[0], columns[0]])
    place = bank.map_origin[scene] + first * float(bank.map_resolution)
    return _digest(_steps(place), kind[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])


def _physics(bank: SceneBank, scene: int, materials: bool) -> str:
    """Hulls and ground prisms: their corners, places, rotations and friction."""
    hulls = np.flatnonzero(bank.inst_hull[scene] >= 0)
    prisms = np.flatnonzero(bank.prism_hull[scene] >= 0)
    shapes = [hashlib.sha256(_corners(bank, row)).digest() for row in bank.inst_hull[scene, hulls]]
    shapes += [hashlib.sha256(_corners(bank, row)).digest() for row in bank.prism_hull[scene, prisms]]
    more = [_steps(bank.prism_material_friction[scene, prisms])] if materials else []
    return _digest(
        np.frombuffer(b"".join(shapes), np.uint8),
        _steps(bank.inst_position[scene, hulls]),
        _steps(bank.inst_rotation[scene, hulls], _ROTATION_QUANTUM),
        _steps(bank.inst_friction[scene, hulls]),
        _steps(bank.prism_position[scene, prisms]),
        _steps(bank.prism_friction[scene, prisms]),
        bank.prism_kind[scene, prisms].astype(np.int32),
        *more,
    )


def _corners(bank: SceneBank, hull: int) -> bytes:
    return _steps(bank.hull_vertices[hull, : bank.hull_num_vertices[hull]]).tobytes()


def _light(bank: SceneBank, scene: int) -> list[float]:
    """The sun's direction in the scene and irradiance, the yaw of the sky, and its mean radiance above and below the
    horizon: 3 + 3 + 2 + 6 figures."""
    sky, yaw = int(bank.scene_sky[scene]), float(bank.scene_sky_yaw[scene])
    radiance = np.asarray(bank.sky_radiance[sky], np.float64)
    half = len(radiance) // 2
    figures = [
        *bank.sky_sun_direction[sky],
        *bank.sky_sun_irradiance[sky],
        np.cos(yaw),
        np.sin(yaw),
        *radiance[:half].mean((0, 1)),
        *radiance[half:].mean((0, 1)),
    ]
    return [round(float(x), 4) for x in figures]


def _surfaces(bank: SceneBank, scene: int) -> list[float]:
    """The number of faces of all slots, and the mean colour of their surfaces: 1 + 3 figures in 0 to 1, the first in
    thousands."""
    meshes = bank.slot_mesh[scene][bank.slot_mesh[scene] >= 0]
    faces = np.diff(bank.mesh_face_start)[meshes]
    materials = bank.mesh_material[meshes]
    colors = {row: _color(bank, int(row)) for row in np.unique(materials)}
    mean = np.mean([colors[row] for row in materials], axis=0) if len(materials) else np.zeros(3)
    return [round(float(x), 4) for x in (faces.sum() / 1000.0, *mean)]


def _color(bank: SceneBank, material: int) -> np.ndarray:
    """(3,) mean of a material's texture in 0 to 1, times its colour."""
    tint, texture = bank.material_rgba[material, :3], int(bank.material_texture[material])
    if texture < 0:
        return tint
    first, last = bank.texture_start[texture : texture + 2]
    return tint * bank.texture_data[first:last].reshape(-1, int(bank.texture_shape[texture, 2])).mean(0)[:3] / 255.0
