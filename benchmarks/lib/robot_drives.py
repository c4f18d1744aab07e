"""Drives robots of the catalogue in C MuJoCo on level ground, compares engines with it, and draws the robots."""

import functools
import math
import pathlib
from typing import Any

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.robots import catalogue, gait_of, legged, load, make_coco
from urbanverse_mjx.robots.gait import Gait, felt_gravity, sensor_frame

#: Friction of the ground: streets of uniform friction, and the tyres' own, as on streets of materials.
FRICTIONS = (1.0, 0.7)
#: Shares of the top speed and of the top yaw rate in bends, and on the spot.
BENDS, SPOT = ((0.5, 0.3), (0.8, -0.6)), (0.0, 0.8)
#: s of a drive, and of its end that counts.
_SECONDS, _END = 5.0, 3.0
#: Robots on the sheet before those of the catalogue.
_BEFORE = {"COCO": make_coco, "wheelchair": lambda: load("wheelchair")}
#: Robots that drive on wheels: rows of `robots.catalogue`, and of `robots.legged` whose legs are held.
DRIVEN = (*catalogue.NAMES, *(name for name in legged.NAMES if legged.row(name).drive != "gait"))
#: Pixels of an image on the sheet, and images in a row.
_HEIGHT, _WIDTH, _ROW = 200, 240, 7


@functools.cache
def _robot(name: str) -> RobotSpec:
    return load(name)


def _balances(name: str) -> bool:
    return name in catalogue.NAMES and catalogue.row(name).drive == "balance"


class LevelGround:
    """A robot in C MuJoCo on a plane."""

    def __init__(self, name: str, friction: float = 1.0) -> None:
        self.robot = _robot(name)
        self.gait: Gait | None = gait_of(self.robot) if _balances(name) else None
        spec = mujoco.MjSpec.from_string(self.robot.mjcf)
        plane = spec.worldbody.add_geom(name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[60.0, 60.0, 1.0])
        plane.friction[0], plane.contype, plane.conaffinity = friction, 1, 0
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        if self.model.nkey:
            mujoco.mj_resetDataKeyframe(self.model, self.data, 0)
        self.data.qpos[2] = self.robot.spawn_height
        self._feet = {self.model.geom(foot).id for foot in self.robot.foot_geoms} | {self.model.geom("ground").id}
        #: Names of other parts that touched the ground.
        self.touched: set[str] = set()

    def drive(self, speed: float, yaw_rate: float, seconds: float) -> tuple[np.ndarray, np.ndarray]:
        """Drives by a command; returns the speed ahead (m/s) and the yaw rate (rad/s) after each physics step."""
        command = np.asarray(self.robot.command(np.array([speed, yaw_rate], np.float32)), np.float64)
        step, data, found = float(self.model.opt.timestep), self.data, []
        for k in range(round(seconds / step)):
            if self.gait is None:
                data.ctrl[:] = command
            elif k % round(self.gait.control_dt / step) == 0:
                data.ctrl[:] = self._balance(command)
            mujoco.mj_step(self.model, data)
            self.touched |= {self.model.geom(g).name for g in set(data.contact.geom.ravel().tolist()) - self._feet}
            forward = data.xmat[1].reshape(3, 3)[:, 0]
            found.append((float(forward @ data.qvel[:3]), float(data.qvel[5])))
        return np.array(found)[:, 0], np.array(found)[:, 1]

    def _balance(self, command: np.ndarray) -> np.ndarray:
        assert self.gait is not None
        data, still = self.data, np.zeros(self.model.nu)
        gravity = felt_gravity(np, data.qpos[3:7])
        frame = sensor_frame(np, data.qvel[3:6], gravity, data.qpos[7:], data.qvel[6:], command, still)
        return self.gait.target(self.gait.action(np, frame))


def turning_radius(name: str) -> float | None:
    """m, smallest radius of the middle of the axle that is not steered, by kinematics; None on the spot."""
    response = _robot(name).response
    return None if response is None or not math.isfinite(response.curvature) else 1.0 / response.curvature


def drive_figures(name: str) -> dict[str, Any]:
    """Figures of a robot on level ground, at both frictions; ratios are of the commands.

    Returns:
      speed (m/s) and drift (m aside) after 4 s at full speed, seconds to 63 % of it, brake_distance (m), the least and
      largest mean yaw rate by the one that kinematics ask for in bends and on the spot, turning_radius (m, measured and
      by kinematics; None where it turns on the spot), and parts other than wheels that touched the ground.
    """
    robot = _robot(name)
    curvature = robot.response.curvature if robot.response else math.inf
    speeds, drifts, lags, brakes, ratios, radii, touched = [], [], [], [], [], [], set()
    for friction in FRICTIONS:
        ground = LevelGround(name, friction)
        step, tail = float(ground.model.opt.timestep), round(_END / float(ground.model.opt.timestep))
        speed, _ = ground.drive(robot.max_speed, 0.0, 4.0)
        speeds.append(float(speed[-1]))
        drifts.append(abs(float(ground.data.qpos[1])))
        lags.append(float(np.argmax(speed > 0.632 * robot.max_speed)) * step)
        before = float(ground.data.qpos[0])
        ground.drive(0.0, 0.0, 3.0)
        brakes.append(float(ground.data.qpos[0]) - before)
        touched |= ground.touched
        tight = math.isfinite(curvature)
        for share, turn in (*BENDS, (0.4, 1.0)) if tight else (*BENDS, SPOT):
            ground, v, omega = LevelGround(name, friction), share * robot.max_speed, turn * robot.max_yaw_rate
            wanted = float(np.clip(omega, -curvature * v, curvature * v)) if tight else omega
            speed, turned = ground.drive(v, omega, _SECONDS)
            ratios.append(float(turned[-tail:].mean()) / wanted)
            if tight and turn == 1.0:
                radii.append(float(speed[-tail:].mean() / turned[-tail:].mean()))
            touched |= ground.touched
    return {
        "speed": round(min(speeds, key=lambda x: x), 3),
        "drift": round(max(drifts), 3),
        "lag": round(max(lags), 3),
        "brake_distance": round(max(brakes), 3),
        "yaw_ratio": [round(min(ratios), 3), round(max(ratios), 3)],
        "turning_radius": [round(max(radii), 3), round(1.0 / curvature, 3)] if radii else None,
        "touched": sorted(touched),
    }


def parity_figures(name: str, impl: str, count: int = 14) -> dict[str, Any]:
    """Differences of an engine from C MuJoCo in box streets: those of `benchmarks.parity`."""
    from tests.support.box_bank import box_bank, box_scenes
    from urbanverse_mjx.scene.mjcf import scene_spec
    from urbanverse_mjx.simulation.engines import make_engine
    from urbanverse_mjx.simulation.parity import c_mujoco

    robot, scenes = _robot(name), 2
    models = [c_mujoco.reference_model(scene_spec(scene), robot) for scene in box_scenes(scenes)]
    bank = box_bank(scenes)
    if _balances(name):
        control_dt, drives = gait_of(robot).control_dt, _balanced(name, scenes)
    else:
        control_dt = 0.2
        drives = c_mujoco.mixed_drives(bank, robot, count, 12, control_dt, seed=1)
    expected = c_mujoco.drive_reference(models, robot, drives, control_dt)
    engine = make_engine(bank, robot, impl=impl, control_dt=control_dt)
    summary = c_mujoco.compare(expected, c_mujoco.drive_engine(engine, bank, drives), robot).summary()
    wanted = ("before_contact_max_mm", "onset_max_steps", "after_1s_median_mm", "hit_flags_differ", "ends_differ")
    return {"drives": len(drives.scene)} | {key: summary[key] for key in wanted}


def _balanced(name: str, scenes: int) -> Any:
    """Drives of half a second by torques that keep the balancer upright, recorded on a plane."""
    from urbanverse_mjx.simulation.parity.drives import Drives

    torques, steps = [], 50
    for speed, turn in ((0.5, 0.0), (0.3, 0.5), (0.0, -0.8)):
        ground, one = LevelGround(name), []
        for _ in range(steps):
            ground.drive(speed, turn, 0.01)
            one.append(ground.data.ctrl.copy())
        torques.append(one)
    count = len(torques)
    start = ground.model.qpos0.copy()
    start[:3] = 5.0, 0.0, ground.robot.spawn_height
    ctrl = np.array(torques, np.float32).swapaxes(0, 1)
    return Drives(np.arange(count, dtype=np.int32) % scenes, np.tile(start, (count, 1)).astype(np.float32), ctrl)


def image_of(robot: RobotSpec, height: int = _HEIGHT, width: int = _WIDTH) -> np.ndarray:
    """(height, width, 3) u8, a robot on grey ground, from the front left."""
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    scene = getattr(spec.visual, "global")
    scene.offwidth, scene.offheight = width, height
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.35] * 3, [0.35] * 3
    sky = spec.add_texture(name="_sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384)
    sky.builtin, sky.rgb1, sky.rgb2 = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, [0.8, 0.87, 0.95], [0.95, 0.97, 1.0]
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[20.0, 20.0, 1.0], rgba=[0.62, 0.62, 0.6, 1.0])
    sun = spec.worldbody.add_light(pos=[2.0, 2.0, 5.0], dir=[-0.4, -0.45, -1.0], diffuse=[0.7, 0.7, 0.65])
    sun.type, sun.castshadow = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, True
    model = spec.compile()
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[:3] = 0.0, 0.0, robot.spawn_height
    mujoco.mj_forward(model, data)
    shown = np.flatnonzero((model.geom_group == 2) & (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE))
    top = float((data.geom_xpos[shown, 2] + 0.5 * model.geom_rbound[shown]).max())
    long = float((np.abs(data.geom_xpos[shown, 0]) + 0.5 * model.geom_rbound[shown]).max())
    camera, seen = mujoco.MjvCamera(), mujoco.MjvOption()
    camera.lookat[:] = 0.0, 0.0, 0.46 * top
    camera.distance, camera.azimuth, camera.elevation = 1.85 * max(top, 1.3 * long) + 0.2, 215.0, -16.0
    seen.geomgroup[:] = [1, 1, 1, 0, 0, 0]
    with mujoco.Renderer(model, height, width) as renderer:
        renderer.update_scene(data, camera, seen)
        return renderer.render()


def write_sheet(path: pathlib.Path) -> None:
    """Writes an image of all robots with their names."""
    from PIL import Image, ImageDraw

    robots = {name: make() for name, make in _BEFORE.items()}
    robots |= {name: _robot(name) for name in (*legged.NAMES, *catalogue.NAMES)}
    tiles = []
    for name, robot in robots.items():
        tile = Image.fromarray(image_of(robot))
        ImageDraw.Draw(tile).text((6, 4), name, fill=(0, 0, 0), font_size=16)
        tiles.append(np.asarray(tile))
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % _ROW)
    rows = [np.concatenate(tiles[k : k + _ROW], 1) for k in range(0, len(tiles), _ROW)]
    Image.fromarray(np.concatenate(rows)).save(path, quality=58)
