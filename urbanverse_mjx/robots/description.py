"""Loads robots from an MJCF and a description file.

In: a folder with robot.json, or that file; or the name of a robot that ships with the package in this form, or of one
of `catalogue` or `legged`. Out: `RobotSpec`. When: once, at construction.

docs/tutorials/own_robot.md describes the file and the requirements on the MJCF.
"""

import functools
import math
import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from ..datatypes import Response, RobotSpec
from ..datatypes import validation as v
from . import catalogue, legged
from .coco import make_coco
from .collision import Fit, is_fitted_sphere, replace_by_spheres
from .gait import Gait
from .go2 import load_gait, make_go2
from .model_limits import check_size
from .sphere_fit import FitOptions
from .waypoint import gait_command, pd_velocity
from .wheel_drive import Wheel, WheelDrive, WheelTable, largest_curvature

SCHEMA = "urbanverse.robot/1"
FILE = "robot.json"
#: Robots in this form that ship with the package, each a folder beside this file.
SHIPPED = ("wheelchair",)
_REQUIRED = ("schema", "name", "mjcf", "root_body", "camera", "feet", "max_speed", "max_yaw_rate", "drive", "planner")
_OPTIONAL = ("spawn_height", "circumradius", "fit", "response")
Command = Callable[[Any], Any]


def load(source: str | os.PathLike[str]) -> RobotSpec:
    """Loads a robot from its description.

    Args:
      source: folder of the robot, its robot.json, "coco" (with differential drive), one of `SHIPPED`, or a name of
        `catalogue.NAMES` or `legged.NAMES`.

    Raises:
      ValidationError: the description or its MJCF is incomplete or invalid.
    """
    return load_with_fits(source)[0]


def load_with_fits(source: str | os.PathLike[str]) -> tuple[RobotSpec, tuple[Fit, ...]]:
    """`load`, and the sphere fits of the collision shapes that are not spheres.

    Raises:
      ValidationError: see `load`.
    """
    built = {"coco": make_coco, "go2": make_go2}
    if isinstance(source, str) and source in built:
        return built[source](), ()
    if isinstance(source, str) and source in (*catalogue.NAMES, *legged.NAMES):
        if source in legged.NAMES:
            described = legged.describe(legged.row(source))
        else:
            described = catalogue.describe(catalogue.row(source))
        spec = mujoco.MjSpec.from_string(described["mjcf"])
        return _make(described, spec, spec.compile(), f"robot {source!r}")
    path = _file_of(source)
    body = v.mapping(v.read_json(path, "robot"), str(path), _REQUIRED, _OPTIONAL)
    v.choice(body["schema"], f"{path}: schema", (SCHEMA,))
    where = f"robot {v.identifier(body['name'], f'{path}: name')!r}"
    spec, model = _read_mjcf(path.parent / v.text(body["mjcf"], f"{where}.mjcf"), where)
    return _make(body, spec, model, where)


def _make(
    body: Mapping[str, Any], spec: mujoco.MjSpec, model: mujoco.MjModel, where: str
) -> tuple[RobotSpec, tuple[Fit, ...]]:
    """The robot of a description and its MJCF."""
    feet = tuple(v.text(foot, f"{where}.feet[{i}]") for i, foot in enumerate(v.items(body["feet"], f"{where}.feet", 1)))
    fit = FitOptions(**v.mapping(body.get("fit", {}), f"{where}.fit", (), ("tolerance", "spheres")))
    feet, fits = _only_spheres(spec, model, feet, fit, where)
    model = spec.compile()
    root = _named(model, mujoco.mjtObj.mjOBJ_BODY, body["root_body"], f"{where}.root_body")
    _named(model, mujoco.mjtObj.mjOBJ_CAMERA, body["camera"], f"{where}.camera")
    geoms = [_named(model, mujoco.mjtObj.mjOBJ_GEOM, foot, f"{where}.feet[{i}]") for i, foot in enumerate(feet)]
    limits = {key: v.number(body[key], f"{where}.{key}", above=0.0) for key in ("max_speed", "max_yaw_rate")}
    planner = v.mapping(body["planner"], f"{where}.planner", ("radius", "height", "step"))
    drive = _drive(body["drive"], model, limits, f"{where}.drive")
    robot = RobotSpec(
        name=body["name"],
        mjcf=spec.to_xml(),
        root_body=body["root_body"],
        foot_geoms=feet,
        camera=body["camera"],
        circumradius=_or(body, "circumradius", where, lambda: reach(model, root)),
        spawn_height=_or(body, "spawn_height", where, lambda: standing_height(model, root, geoms)),
        physics_timestep=float(model.opt.timestep),
        command=drive,
        waypoint_to_velocity=functools.partial(_waypoint_to_velocity, **limits),
        planner_radius=planner["radius"],
        planner_height=planner["height"],
        step_height=planner["step"],
        response=_response(body.get("response"), drive, f"{where}.response"),
        drive=_kind(body["drive"]["kind"], drive),
        max_speed=limits["max_speed"],
        max_yaw_rate=limits["max_yaw_rate"],
    )
    return robot, fits


def gait_of(robot: RobotSpec, path: str | pathlib.Path | None = None) -> Gait:
    """The gait of a robot: that of a file, the controller of a balancer of `catalogue`, the shipped one of a robot of
    `legged`, or else the Go2's.

    Raises:
      ValidationError: the file does not exist or is not a gait, or none is shipped for this robot.
    """
    if path is None and robot.name in catalogue.NAMES:
        return catalogue.balance_gait(catalogue.row(robot.name))
    if path is None and robot.name in legged.NAMES:
        path = legged.gait_path(robot.name)
        if not path.is_file():
            where, needed = f"robot {robot.name!r}", "the file of one"
            task = legged.joystick_name(robot.name)
            raise v.fail(where, "no shipped gait", needed, f"train {task}, then run `urbanverse export-gait`")
    return load_gait(path)


def _file_of(source: str | os.PathLike[str]) -> pathlib.Path:
    if isinstance(source, str) and source in SHIPPED:
        return pathlib.Path(__file__).parent / source / FILE
    path = pathlib.Path(source).expanduser()
    path = path / FILE if path.is_dir() else path
    if not path.is_file():
        legs = (name for name in legged.NAMES if name != "go2")
        known = f"coco, go2, {', '.join((*SHIPPED, *catalogue.NAMES, *legs))}"
        needed = f"{known}, or a {FILE} or its folder"
        raise v.fail("robot", v.show(os.fspath(source)), needed, "see docs/robots.md and docs/tutorials/own_robot.md")
    return path.absolute()


def _or(body: Mapping[str, Any], key: str, where: str, otherwise: Callable[[], float]) -> float:
    return v.number(body[key], f"{where}.{key}", above=0.0) if key in body else otherwise()


def _waypoint_to_velocity(waypoint: Any, control_period: float, max_speed: float, max_yaw_rate: float) -> Any:
    return pd_velocity(waypoint, control_period, max_speed, max_yaw_rate)


# The MJCF.


def _read_mjcf(path: pathlib.Path, where: str) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    """Reads the robot's MJCF, with absolute paths of files."""
    if not path.is_file():
        raise v.fail(f"{where}.mjcf", f"no file {path}", "the robot's MJCF, named relative to the description")
    check_size(path, f"{where}.mjcf")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        model = spec.compile()
    except ValueError as error:
        raise v.fail(f"{where}.mjcf", f"{path}, which MuJoCo does not read ({error})", "an MJCF model") from error
    if spec.worldbody.geoms:
        raise v.fail(
            f"{where}.mjcf", "geoms of the world (a floor?)", "the robot alone: streets bring their own ground"
        )
    for objects, folder in ((spec.meshes, spec.meshdir), (spec.textures, spec.texturedir)):
        for obj in objects:
            if obj.file:
                obj.file = str((path.parent / folder / obj.file).absolute())
    spec.meshdir = spec.texturedir = ""
    return spec, model


def _only_spheres(
    spec: mujoco.MjSpec, model: mujoco.MjModel, feet: tuple[str, ...], options: FitOptions, where: str
) -> tuple[tuple[str, ...], tuple[Fit, ...]]:
    """Changes a robot's MJCF so that it has no lights, and spheres that collide with the world, not with each other.

    Returns:
      the feet, and the fits, see `replace_by_spheres`.
    """
    for light in list(spec.lights):
        spec.delete(light)
    feet, fits = replace_by_spheres(spec, model, feet, options, where)
    for geom in spec.geoms:
        if geom.contype or geom.conaffinity:
            geom.contype, geom.conaffinity = 0, 1
    # Engines remove visual geoms, but their mass must be kept.
    for link in list(spec.bodies)[1:]:
        same = model.body(link.name) if link.name else model.body(link.id)
        link.explicitinertial = True
        link.mass, link.ipos, link.iquat, link.inertia = float(same.mass[0]), same.ipos, same.iquat, same.inertia
        link.fullinertia = np.full(6, np.nan)
    return feet, fits


def _named(model: mujoco.MjModel, kind: mujoco.mjtObj, name: Any, where: str) -> int:
    """Id of the element with that name."""
    number = mujoco.mj_name2id(model, kind, v.text(name, where))
    if number < 0:
        what = kind.name.removeprefix("mjOBJ_").lower()
        count = {"body": model.nbody, "camera": model.ncam, "geom": model.ngeom, "actuator": model.nu}[what]
        named = filter(None, (mujoco.mj_id2name(model, kind, i) for i in range(count)))
        # Fitted spheres are not of the MJCF.
        known = [n for n in named if kind != mujoco.mjtObj.mjOBJ_GEOM or not is_fitted_sphere(n)]
        raise v.fail(where, v.show(name), f"a {what} of the MJCF", f"it has {', '.join(known) or 'none'}")
    return number


def at_rest(model: mujoco.MjModel, place: Sequence[float] | None = None) -> mujoco.MjData:
    """The first keyframe, or the initial pose of the MJCF; place: (3,) m of the root instead, which then is upright and
    heads along x."""
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0] if model.nkey else model.qpos0
    if place is not None:
        data.qpos[:7] = *place, 1, 0, 0, 0
    mujoco.mj_kinematics(model, data)
    return data


def standing_height(model: mujoco.MjModel, root: int, feet: Sequence[int]) -> float:
    """m, height of the root's origin when the lowest foot just touches level ground."""
    data = at_rest(model)
    return float(data.xpos[root, 2] - min(data.geom_xpos[g, 2] - model.geom_size[g, 0] for g in feet))


def reach(model: mujoco.MjModel, root: int) -> float:
    """m, upper bound on the distance of any collision point from the root's origin over all joint positions."""
    farthest = 0.0
    for g in np.flatnonzero(model.geom_conaffinity):
        length, point, body = float(model.geom_size[g, 0]), model.geom_pos[g].copy(), int(model.geom_bodyid[g])
        while body not in (root, 0):
            joints = range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
            if joints:
                length += float(np.linalg.norm(point))
                point = model.body_pos[body].copy()
                for j in joints:
                    slides = model.jnt_type[j] == mujoco.mjtJoint.mjJNT_SLIDE
                    ends = np.abs(model.jnt_range[j]).max() if slides else 2.0 * np.linalg.norm(model.jnt_pos[j])
                    length += float(ends)
            else:  # fixed to its parent
                turned = np.zeros(3)
                mujoco.mju_rotVecQuat(turned, point, model.body_quat[body])
                point = model.body_pos[body] + turned
            body = int(model.body_parentid[body])
        farthest = max(farthest, length + float(np.linalg.norm(point)))
    return farthest


# Body velocity to actuator commands.


def _drive(body: Any, model: mujoco.MjModel, limits: dict[str, float], where: str) -> Command:
    """(v, omega) -> the robot's command, see `RobotSpec.command`."""
    kinds = {
        "differential": ("left", "right", "wheel_radius", "track"),
        "ackermann": ("left", "right", "wheel_radius", "track", "steer", "wheelbase"),
        "wheels": ("wheels",),
        "gait": (),
    }
    kind = v.choice(body.get("kind") if isinstance(body, Mapping) else None, f"{where}.kind", kinds)
    m = v.mapping(
        body,
        where,
        ("kind", *kinds[kind]),
        ("axle", "skid", "lateral", "bend", "slide", "held") if kind == "wheels" else (),
    )
    if kind == "gait":
        return functools.partial(gait_command, **limits)
    if kind == "wheels":
        return _wheel_table(m, model, limits, where)
    sizes = {k: v.number(m[k], f"{where}.{k}", above=0.0) for k in ("wheel_radius", "track", "wheelbase") if k in m}
    sides = {
        side: tuple(
            _named(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name, f"{where}.{side}[{i}]")
            for i, name in enumerate(v.items(m[side], f"{where}.{side}", 1))
        )
        for side in ("left", "right")
    }
    named = [*sides["left"], *sides["right"]]
    steering: dict[str, Any] = {}
    if kind == "ackermann":
        steer = _named(model, mujoco.mjtObj.mjOBJ_ACTUATOR, m["steer"], f"{where}.steer")
        end = float(model.actuator_ctrlrange[steer, 1])
        v.number(end, f"{where}.steer: upper end of the ctrlrange of {m['steer']!r}", above=0.0, maximum=1.5)
        steering = {"steer": steer, "max_steer": end}
        named.append(steer)
    if sorted(named) != list(range(model.nu)):
        raise v.fail(where, f"{len(set(named))} actuators named", f"each of the {model.nu} of the MJCF once")
    return WheelDrive(**sides, size=model.nu, **sizes, **limits, **steering)


def _wheel_table(m: Mapping[str, Any], model: mujoco.MjModel, limits: dict[str, float], where: str) -> WheelTable:
    wheels, named = [], []
    for i, item in enumerate(v.items(m["wheels"], f"{where}.wheels", 1)):
        at = f"{where}.wheels[{i}]"
        one = v.mapping(item, at, ("x", "y", "radius"), ("motor", "steer"))
        actuators = {
            key: _named(model, mujoco.mjtObj.mjOBJ_ACTUATOR, one[key], f"{at}.{key}")
            for key in ("motor", "steer")
            if key in one
        }
        if not actuators:
            raise v.fail(at, "neither a motor nor a steer", "one of them; leave out wheels that roll freely")
        end = math.inf
        if "steer" in actuators:
            high = float(model.actuator_ctrlrange[actuators["steer"], 1])
            where_end = f"{at}.steer: upper end of the ctrlrange of {one['steer']!r}"
            end = v.number(high, where_end, above=0.0, maximum=math.pi)
        place = {key: v.number(one[key], f"{at}.{key}") for key in ("x", "y")}
        radius = v.number(one["radius"], f"{at}.radius", above=0.0)
        motor, steer = actuators.get("motor"), actuators.get("steer")
        wheels.append(Wheel(**place, radius=radius, motor=motor, steer=steer, max_steer=end))
        named += actuators.values()
    held = v.mapping(m.get("held", {}), f"{where}.held", (), m.get("held", {}))
    kept = tuple(
        (_named(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name, f"{where}.held"), v.number(angle, f"{where}.held.{name}"))
        for name, angle in held.items()
    )
    named += [actuator for actuator, _ in kept]
    if sorted(named) != list(range(model.nu)):
        raise v.fail(where, f"{len(set(named))} actuators named", f"each of the {model.nu} of the MJCF once")
    if not any(wheel.motor is not None for wheel in wheels):
        raise v.fail(f"{where}.wheels", "no motor", "at least one driven wheel")
    axle = v.number(m.get("axle", 0.0), f"{where}.axle")
    turns = [(w.x, w.y, w.max_steer) for w in wheels if w.steer is not None]
    # Wheels that are steered by 90 degrees, or wheels of two sides, turn the robot on the spot.
    spot = not turns or min(angle for _, _, angle in turns) >= 0.5 * math.pi - 1e-6
    return WheelTable(
        wheels=tuple(wheels),
        axle=axle,
        skid=v.number(m.get("skid", 1.0), f"{where}.skid", minimum=1.0, maximum=10.0),
        size=model.nu,
        bend=v.number(m.get("bend", 0.0), f"{where}.bend"),
        slide=v.number(m.get("slide", 0.0), f"{where}.slide", minimum=0.0),
        curvature=math.inf if spot else largest_curvature(turns, axle),
        lateral=v.number(m["lateral"], f"{where}.lateral", above=0.0) if "lateral" in m else math.inf,
        held=kept,
        **limits,
    )


def _kind(described: str, drive: Command) -> str:
    """One of `datatypes.robot.DRIVES`; described: the kind in the description."""
    if not isinstance(drive, WheelTable):
        return described
    if drive.skid > 1.0:
        return "skid"
    if not any(wheel.steer is not None for wheel in drive.wheels):
        return "differential"
    return "swerve" if math.isinf(drive.curvature) else "ackermann"


def _response(body: Any, drive: Command, where: str) -> Response | None:
    """What is described, or what is known of wheels."""
    known: dict[str, float] = {}
    if isinstance(drive, WheelTable):
        known = {"pivot": -drive.axle, "curvature": drive.curvature, "lateral": drive.lateral}
    if body is None:
        return Response(**known) if known else None
    names = [field for field in ("speed_lag", "turn_lag", "pivot", "curvature", "lateral") if field not in known]
    m = v.mapping(body, where, (), tuple(names))
    return Response(**known, **{key: v.number(m[key], f"{where}.{key}") for key in m})
