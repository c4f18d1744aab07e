"""The robots with legs that are rows of a table: every row as its sources have it, how it stands, engines."""

import functools
import hashlib
import os
import pathlib
import re

import mujoco
import numpy as np
import pytest

from benchmarks.lib.robot_drives import LevelGround, drive_figures, image_of, parity_figures
from benchmarks.robots import LEGGED, PAGE, legged_text
from urbanverse_mjx.datatypes import GroundRegion, RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import gait_of, legged, load
from urbanverse_mjx.robots.legged.rows import FILE, read_rows
from urbanverse_mjx.robots.stance import stance
from urbanverse_mjx.robots.start import start
from urbanverse_mjx.robots.wheel_drive import WheelTable
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import pack_regions, region_scene
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco

#: Of the Go2's MJCF as it was before it was a row, with which its gait and policies were trained.
GO2_MJCF = "76056e7da26ac30363467c152d2e4487cd6184f6626233c29b3af5686926f770"
#: kg: sums over the links of the sources, with rotors (twelve of 0.055 kg of the Mini Cheetah) and feet.
MASSES = {"go2": 15.206408, "mini_cheetah": 3.3 + 4 * 1.238 + 0.66, "b2": 74.5803, "go2w": 19.523, "g1": 32.1069}
#: unitree_rl_gym's g1_12dof.xml has principal moments of the same links, in descending order.
G1_MOMENTS = {
    "base": (0.552723, 0.454092, 0.211762),
    "L_hip_pitch": (0.00181517, 0.00153422, 0.00116212),
    "R_hip_roll": (0.00254986, 0.00241169, 0.00148755),
    "L_hip_yaw": (0.00776166, 0.00717575, 0.00160139),
    "R_knee": (0.011374, 0.0112843, 0.00146452),
    "L_ankle_pitch": (1.89e-05, 1.40805e-05, 6.9195e-06),
    "L_ankle_roll": (0.00167218, 0.0016161, 0.000217621),
}
#: As MuJoCo Warp solves fastest, and the Go2's number of spheres.
MOST_VELOCITIES, MOST_SPHERES = 32, 43
WALKERS = tuple(name for name in legged.NAMES if legged.row(name).drive == "gait")


@functools.cache
def robot(name: str) -> RobotSpec:
    return load(name)


@functools.cache
def model_of(name: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(robot(name).mjcf)


def at_rest(name: str) -> mujoco.MjData:
    data = mujoco.MjData(model_of(name))
    mujoco.mj_resetDataKeyframe(model_of(name), data, 0)
    data.qpos[2] = robot(name).spawn_height
    mujoco.mj_forward(model_of(name), data)
    return data


def test_the_go2_is_what_its_gait_was_trained_with() -> None:
    assert hashlib.sha256(load("go2").mjcf.encode()).hexdigest() == GO2_MJCF


@pytest.mark.parametrize("name", legged.NAMES)
def test_a_row_makes_the_robot_of_its_numbers(name: str) -> None:
    row, model, data = legged.row(name), model_of(name), at_rest(name)
    assert model.body_mass.sum() == pytest.approx(MASSES[name], rel=2e-4)
    assert row.mass == pytest.approx(MASSES[name], rel=2e-4)
    wheels = len(row.legs) if row.wheel else 0
    assert model.nv == 6 + len(row.joint_names) + wheels <= MOST_VELOCITIES
    for joint, angle, speed in zip(row.joint_names, row.stand_pose, row.motor_speeds, strict=True):
        leg, _, link = joint.removesuffix("_joint").partition("_")
        part = next(x for x in row.links if x.name == link)
        number, servo = model.joint(joint).id, model.actuator(f"{leg}_{link}")
        span = part.range if not leg.startswith("R") or len(leg) == 1 else part.rear_range
        mirrored = leg.endswith("R") and part.axis != "y"
        np.testing.assert_allclose(model.jnt_range[number], sorted(-x for x in span) if mirrored else span)
        np.testing.assert_allclose(servo.ctrlrange, model.jnt_range[number])
        np.testing.assert_allclose(servo.forcerange, (-part.torque, part.torque))
        dof = model.jnt_dofadr[number]
        assert (servo.gainprm[0], -servo.biasprm[1], model.dof_damping[dof]) == (
            part.stiffness,
            part.stiffness,
            part.damping,
        )
        assert model.dof_armature[dof] == part.armature
        assert data.qpos[model.jnt_qposadr[number]] == pytest.approx(angle, abs=1e-6)
        assert servo.trnid[0] == number
        assert speed == part.speed
    solid = np.flatnonzero(model.geom_conaffinity)
    assert (model.geom_type[solid] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
    assert len(solid) <= MOST_SPHERES
    # At rest the lowest feet touch the ground; the Go2's front feet hang 8 mm below its place between both.
    low = (data.geom_xpos[solid, 2] - model.geom_size[solid, 0]).min()
    assert low == pytest.approx(0.0, abs=1e-3 if name != "go2" else 0.01)
    assert (stance(robot(name)).clearance or 0.0) > 0.03
    assert stance(robot(name)).margin > 0.05, "the centre of mass stands above the feet"
    # Spheres reach as far as the robot; a wheel's are wider than the wheel.
    ends = np.concatenate([data.geom_xpos[solid] + side * model.geom_size[solid, :1] for side in (1, -1)])
    spread = ends.max(0) - ends.min(0)
    np.testing.assert_allclose(spread, row.size, atol=0.13 if wheels else 0.09)


@pytest.mark.parametrize("name", legged.NAMES)
def test_legs_mirror_each_other(name: str) -> None:
    """Left and right by y: places, masses and inertias of all links in the standing pose."""
    model, data = model_of(name), at_rest(name)
    mirror = np.diag([1.0, -1.0, 1.0])
    for body in range(2, model.nbody):
        label = model.body(body).name
        leg, _, rest = label.partition("_")
        if not leg.endswith("L"):
            continue
        other = model.body(f"{leg[:-1]}R_{rest}").id
        np.testing.assert_allclose(data.xipos[other], mirror @ data.xipos[body], atol=1e-6, err_msg=label)
        turn, theirs = data.ximat[body].reshape(3, 3), data.ximat[other].reshape(3, 3)
        inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
        expected = mirror @ inertia @ mirror
        np.testing.assert_allclose(
            theirs @ np.diag(model.body_inertia[other]) @ theirs.T, expected, atol=1e-7, err_msg=label
        )


@pytest.mark.parametrize("link", G1_MOMENTS)
def test_the_g1s_moments_are_those_of_its_source(link: str) -> None:
    found = np.sort(model_of("g1").body_inertia[model_of("g1").body(link).id])[::-1]
    np.testing.assert_allclose(found, G1_MOMENTS[link], rtol=2e-3)


@pytest.mark.parametrize("name", legged.NAMES)
def test_the_circumradius_bounds_every_pose(name: str) -> None:
    model, rng, worst = model_of(name), np.random.default_rng(0), 0.0
    data, solid = mujoco.MjData(model), np.flatnonzero(model.geom_conaffinity)
    low, high = np.where(model.jnt_limited[1:, None], model.jnt_range[1:], (-np.pi, np.pi)).T
    for _ in range(300):
        data.qpos[7:] = rng.uniform(low, high)
        mujoco.mj_kinematics(model, data)
        far = np.linalg.norm(data.geom_xpos[solid] - data.xpos[1], axis=1) + model.geom_size[solid, 0]
        worst = max(worst, far.max())
    assert 0.75 * robot(name).circumradius < worst <= robot(name).circumradius + 1e-6


@pytest.mark.parametrize("name", legged.NAMES)
def test_nothing_of_itself_stands_before_its_camera(name: str) -> None:
    model, data = model_of(name), at_rest(name)
    camera = model.camera(legged.CAMERA).id
    turn, high = data.cam_xmat[camera].reshape(3, 3), np.tan(np.radians(model.cam_fovy[camera]) / 2)
    for up in np.linspace(-high, high, 9):
        for right in np.linspace(-high, high, 15) * 16 / 9:
            hit = np.full(1, -1, np.int32)
            ray = turn @ np.array([right, up, -1.0])
            away = mujoco.mj_ray(model, data, data.cam_xpos[camera], ray, None, 1, -1, hit)
            assert away < 0.0, model.geom(hit[0]).name


@pytest.mark.parametrize("name", ["mini_cheetah", "b2", "go2w"])
def test_it_stands(name: str) -> None:
    """In C MuJoCo, 2 s on level ground in its pose: upright, on its feet alone. A humanoid needs its gait for that."""
    spec = mujoco.MjSpec.from_string(robot(name).mjcf)
    floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 0.1])
    floor.contype, floor.conaffinity = 1, 0
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for _ in range(400):
        mujoco.mj_step(model, data)
    # Servos give way.
    assert 0.85 * robot(name).spawn_height < data.qpos[2] < robot(name).spawn_height
    assert data.xmat[1, 8] > 0.99
    touching = {model.geom(g).name for g in data.contact.geom.ravel()} - {"floor"}
    assert touching == set(robot(name).foot_geoms)


def test_every_row_has_its_line_and_source_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert legged_text() in page.split(LEGGED[0])[1], "run python -m benchmarks.robots --page"
    for name in legged.NAMES:
        assert re.search(r"\.(urdf|xml|h|py|yaml)\b", legged.row(name).source), name


def test_a_robot_without_a_shipped_gait_says_how_to_get_one() -> None:
    for name in WALKERS:
        if legged.gait_path(name).is_file():
            assert len(gait_of(robot(name)).stand) == model_of(name).nu
        else:
            with pytest.raises(ValidationError, match=f"no shipped gait.*train {legged.joystick_name(name)}"):
                gait_of(robot(name))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('drive = "skid"', 'drive = "gait"', "wheel for the drive 'gait', needed a foot alone"),
        ("stand = -1.62", "stand = -0.1", "needed an angle within the range -2.7227 to -0.4"),
        ('axis = "z"', 'axis = "w"', "one of x, y, z"),
        ("inertia = [8.4e-06, 1.89e-05", "inertia = [8.4e-06, 9.89e-05", "none larger than the sum of the others"),
        ('style = "biped"', 'style = "bird"', "one of go2, quadruped, biped"),
        ("acceleration = 1.5", "acceleration = 0.0", "greater than 0"),
    ],
)
def test_a_wrong_row_is_refused(tmp_path: pathlib.Path, old: str, new: str, words: str) -> None:
    text = FILE.read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "legged.toml").write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ValidationError, match=re.escape(words)):
        read_rows(tmp_path / "legged.toml")


# The wheeled quadruped.


def test_its_legs_are_held_and_its_wheels_drive() -> None:
    drive, row = robot("go2w").command, legged.row("go2w")
    assert isinstance(drive, WheelTable)
    for command in ((0.0, 0.0), (1.0, 0.0), (0.5, -0.8)):
        found = np.asarray(drive(np.array(command)))
        np.testing.assert_allclose(found[:12], row.stand_pose, atol=1e-6)
    assert row.wheel is not None
    np.testing.assert_allclose(np.asarray(drive(np.array([1.0, 0.0])))[12:], 1.0 / row.wheel.radius, rtol=1e-5)
    left, right = np.asarray(drive(np.array([0.0, 0.8])))[12:14]
    assert left == pytest.approx(-right)
    assert right > 0.8 * 0.1928 / row.wheel.radius, "skidding tyres turn more than rolling ones"
    for wheel, place in zip(drive.wheels, row.ends(), strict=True):
        np.testing.assert_allclose((wheel.x, wheel.y), place[:2], atol=1e-3)


def test_it_drives_turns_and_brakes_on_its_wheels_alone() -> None:
    found, response = drive_figures("go2w"), robot("go2w").response
    assert found["speed"] == pytest.approx(robot("go2w").max_speed, rel=0.03)
    assert found["drift"] < 0.05
    assert found["touched"] == []
    assert response is not None
    assert found["lag"] == pytest.approx(response.speed_lag, abs=0.08)
    low, high = found["yaw_ratio"]
    assert 0.7 < low < high < 1.4
    assert start(robot("go2w")) is not None


def test_its_acceleration_keeps_it_on_all_wheels() -> None:
    """With the torque for a rover's acceleration its legs give way and it rears up at a start."""
    least = {}
    for factor in (1.0, 3.0):
        ground = LevelGround("go2w")
        ground.model.actuator_forcerange[list(robot("go2w").command.motors)] *= factor
        ground.drive(0.0, 0.0, 0.5)
        upright = []
        for _ in range(20):
            ground.drive(2.0, 0.0, 0.05)
            upright.append(ground.data.xmat[1, 8])
        least[factor] = np.degrees(np.arccos(min(upright)))
    assert least[1.0] < 6.0
    assert least[3.0] > 15.0


@pytest.mark.extended
def test_an_engine_drives_it_as_c_mujoco_does() -> None:
    found = parity_figures("go2w", "warp", 6)
    assert found["before_contact_max_mm"] <= 2.0, found
    assert (found["onset_max_steps"] or 0) <= 1, found
    assert found["ends_differ"] == 0, found


# Those that walk, in engines.

CONTROL_DT, STEPS = 0.02, 15


@functools.cache
def _falls(name: str) -> tuple[SceneBank, c_mujoco.Drives, c_mujoco.Trace]:
    """Robots that land on level ground and beside a kerb, in their pose and with moving joints."""
    regions = [
        [GroundRegion("g", "road", ((-8.0, -8.0), (8.0, -8.0), (8.0, 8.0), (-8.0, 8.0)), (0.0, 0.0, 0.0))],
        [
            GroundRegion("low", "road", ((-8.0, -8.0), (0.02, -8.0), (0.02, 8.0), (-8.0, 8.0)), (0.0, 0.0, 0.0)),
            GroundRegion("high", "sidewalk", ((0.02, -8.0), (8.0, -8.0), (8.0, 8.0), (0.02, 8.0)), (0.0, 0.0, 0.03)),
        ],
    ]
    scenes = [region_scene(label, region) for label, region in zip(("level", "kerb"), regions, strict=True)]
    models = [c_mujoco.reference_model(scene_spec(scene), robot(name)) for scene in scenes]
    stand = np.array(legged.row(name).stand_pose, np.float32)
    qpos = np.tile(models[0].qpos0, (4, 1)).astype(np.float32)
    qpos[:, 7:] = stand
    qpos[:, 2] = robot(name).spawn_height + 0.02 + np.array([0.0, 0.03, 0.0, 0.03])
    time = CONTROL_DT * np.arange(STEPS)
    sway = 0.15 * np.sin(2 * np.pi * 2.0 * time[:, None] + np.arange(len(stand)))
    ctrl = np.tile(stand, (STEPS, 4, 1)).astype(np.float32)
    ctrl[:, 2:] += sway[:, None].astype(np.float32)
    drives = c_mujoco.Drives(np.array([0, 1, 0, 1], np.int32), qpos, ctrl)
    return pack_regions(scenes), drives, c_mujoco.drive_reference(models, robot(name), drives, CONTROL_DT)


@pytest.mark.parametrize(
    ("name", "impl"),
    [
        ("mini_cheetah", "warp-fused"),
        ("b2", "warp-fused"),
        ("g1", "warp-fused"),
        pytest.param("g1", "warp", marks=pytest.mark.slow),
        pytest.param("g1", "jax", marks=pytest.mark.slow),
        pytest.param("b2", "jax", marks=pytest.mark.slow),
    ],
)
def test_steps_are_those_of_c_mujoco(name: str, impl: str) -> None:
    bank, drives, expected = _falls(name)
    engine = make_engine(bank, robot(name), impl=impl, control_dt=CONTROL_DT, num_slots=0)
    found = c_mujoco.drive_engine(engine, bank, drives)
    apart = np.abs(found.qpos - expected.qpos).max(-1)
    assert apart[:, :3].max() < 2e-5, "before a foot has touched"
    assert apart.max() < 5e-3
    np.testing.assert_array_equal(found.hit, expected.hit)


# Pictures.


@pytest.mark.skipif(os.environ.get("MUJOCO_GL") not in ("egl", "osmesa"), reason="needs off-screen OpenGL")
def test_pictures_show_legs_of_their_own() -> None:
    """A wheel, a lidar or a second pair of legs that is not drawn changes no number of the tests above."""
    images = {name: image_of(robot(name), 120, 160) for name in ("go2", "go2w", "mini_cheetah", "b2", "g1")}
    for name, image in images.items():
        for other in images.keys() - {name}:
            assert (np.abs(image.astype(int) - images[other]).max(-1) > 40).mean() > 0.01, (name, other)
