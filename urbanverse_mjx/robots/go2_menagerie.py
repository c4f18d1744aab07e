"""Builds the Go2 with the parameters and shapes of MuJoCo Menagerie from a local copy.

In:   a folder `unitree_go2` of mujoco_menagerie, with go2.xml and assets/.
Out:  MJCF text like `go2_body.make_mjcf`.
When: once, at construction.

Menagerie provides masses, inertias and positions of all links, joint ranges, torque limits, rotor inertias and visual
meshes. Collision spheres, servos, standing pose and camera are the built-in ones, because engines support only spheres,
and the gait was trained with these servos. Joints have no dry friction (menagerie 0.2 N m), which the engines do not
support.
"""

import pathlib

import mujoco
import numpy as np

from ..datatypes import ValidationError
from . import go2_body as body

FILE = "go2.xml"


def make_menagerie_mjcf(folder: str | pathlib.Path) -> str:
    """MJCF text of the robot, with absolute paths of mesh files.

    Raises:
      ValidationError: there is no go2.xml, or it lacks the Go2's links and joints.
    """
    path = pathlib.Path(folder).absolute() / FILE
    if not path.is_file():
        raise ValidationError(
            f"Menagerie: found no {FILE} in {folder}, needed the folder unitree_go2 of mujoco_menagerie."
        )
    try:
        theirs = mujoco.MjSpec.from_file(str(path))
        model = theirs.compile()
    except ValueError as error:
        raise ValidationError(
            f"Menagerie: found {path}, which MuJoCo does not read ({error}), needed its Go2."
        ) from error
    ours = mujoco.MjSpec.from_string(body.make_mjcf())
    _copy_assets(theirs, ours, path.parent)
    for link in list(ours.bodies)[1:]:
        _check(model, mujoco.mjtObj.mjOBJ_BODY, link.name, path)
        _copy_link(model.body(link.name), link)
        for geom in [g for g in link.geoms if g.contype == 0 and g.conaffinity == 0]:
            ours.delete(geom)
        for geom in theirs.body(link.name).geoms:
            if geom.contype == 0 and geom.conaffinity == 0:
                _copy_geom(geom, link)
    for joint in list(ours.joints)[1:]:
        _check(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name, path)
        number = model.joint(joint.name).id
        joint.range, joint.armature = model.jnt_range[number], float(model.dof_armature[model.jnt_dofadr[number]])
    for actuator in ours.actuators:
        number = model.joint(actuator.target).id
        motors = np.flatnonzero(model.actuator_trnid[:, 0] == number)
        if len(motors) != 1:
            raise ValidationError(f"Menagerie: found {len(motors)} motors of {actuator.target} in {path}, needed one.")
        actuator.forcerange = model.actuator_ctrlrange[motors[0]]
        actuator.ctrlrange = model.jnt_range[number]
    return ours.to_xml()


def _check(model: mujoco.MjModel, kind: mujoco.mjtObj, name: str, path: pathlib.Path) -> None:
    if mujoco.mj_name2id(model, kind, name) < 0:
        raise ValidationError(f"Menagerie: found no {name!r} in {path}, needed the links and joints of its Go2.")


def _copy_assets(theirs: mujoco.MjSpec, ours: mujoco.MjSpec, folder: pathlib.Path) -> None:
    for mesh in theirs.meshes:
        ours.add_mesh(name=mesh.name, file=str(folder / theirs.meshdir / mesh.file), scale=mesh.scale)
    known = {m.name for m in ours.materials}
    for material in theirs.materials:
        if material.name not in known:
            ours.add_material(name=material.name, rgba=material.rgba, specular=material.specular)


def _copy_link(link: "mujoco._structs._MjModelBodyViews", mine: mujoco.MjsBody) -> None:
    mine.mass, mine.ipos, mine.iquat, mine.inertia = float(link.mass[0]), link.ipos, link.iquat, link.inertia
    mine.fullinertia = np.full(6, np.nan)
    if link.name != "base":  # which is put where the robot stands
        mine.pos, mine.quat = link.pos, link.quat


def _copy_geom(geom: mujoco.MjsGeom, link: mujoco.MjsBody) -> None:
    link.add_geom(
        type=geom.type,
        size=geom.size,
        pos=geom.pos,
        quat=geom.quat,
        meshname=geom.meshname,
        material=geom.material,
        rgba=geom.rgba,
        group=2,
        contype=0,
        conaffinity=0,
        mass=0.0,
    )
