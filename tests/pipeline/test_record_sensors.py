"""Sensors of a recording against C MuJoCo's rays and sensors."""

import json
import pathlib
from typing import Any, Literal, cast

import cv2
import jax
import mujoco
import numpy as np
import pytest

from tests.pipeline.test_recording import OPTIONS, drawn_env, table_of, use
from tests.support import render_reference
from urbanverse_mjx import pipeline
from urbanverse_mjx.datasets import own_checks
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.pipeline.recording.driving import Steps
from urbanverse_mjx.pipeline.recording.lidar import Lidar, LidarOptions
from urbanverse_mjx.pipeline.recording.readings import CAMERA_POSE, FORCE, IMU, ODOMETRY, Readings, integrated
from urbanverse_mjx.robots import make_coco, make_go2

DT = 0.02


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return drawn_env(small_bank, {"episode_length": 6})


@pytest.mark.extended
@pytest.mark.parametrize(
    "options",
    [
        LidarOptions(rings=8, azimuths=48, upper=20.0, lower=-40.0, range=12.0),
        LidarOptions(azimuths=64, elevations=(21.0, 3.0, 2.0, -7.0, -8.5, -40.0), range=12.0),
    ],
    ids=["even", "uneven"],
)
def test_ranges_are_those_of_mujocos_rays(env: NavEnv, options: LidarOptions) -> None:
    """Two robots in different streets, turned and tilted, in one batch; -1 and its own body are no range."""
    lidar, robot = Lidar(env, options), env.robot
    scenes, xpos, xquat, wanted = [0, 1], [], [], []
    for scene, tilt in zip(scenes, (0.3, -0.2), strict=True):
        street = render_reference.build_street(env.bank, scene, robot)
        render_reference.place(street, robot, env.bank.episode_start[scene, 3].astype(float))
        street.data.qpos[3:7] = rotations.product(street.data.qpos[3:7], np.array([np.cos(tilt), np.sin(tilt), 0, 0]))
        mujoco.mj_kinematics(street.model, street.data)
        wanted.append(_cast(street, robot, lidar))
        xpos.append(street.data.xpos.copy())
        xquat.append(street.data.xquat.copy())
    draw = jax.jit(jax.vmap(lambda z, p, q: lidar(z, p, q, None, None)))
    found = np.asarray(draw(np.array(scenes), np.array(xpos, np.float32), np.array(xquat, np.float32)))
    hit = np.array(wanted) > 0
    assert 0.3 < hit.mean() < 0.95
    # Rays along the edge of an object, or of the robot itself, may pass on either side.
    assert ((found > 0) == hit).mean() > 0.99
    both = hit & (found > 0)
    assert (np.abs(found - wanted)[both] < 2e-3).mean() > 0.995


def _cast(street: render_reference.Street, robot: RobotSpec, lidar: Lidar) -> np.ndarray:
    root, model, data = street.model.body(robot.root_body).id, street.model, street.data
    turn = data.xmat[root].reshape(3, 3)
    at = data.xpos[root] + turn @ lidar.position
    rays = (lidar.options.directions() @ turn.T).reshape(-1, 3)
    geom, distance = np.zeros(len(rays), np.int32), np.zeros(len(rays))
    seen = np.array([1, 0, 1, 0, 0, 0], np.uint8)
    mujoco.mj_multiRay(model, data, at, rays.ravel(), seen, 1, -1, geom, distance, None, len(rays), lidar.options.range)
    own = np.where(geom >= 0, street.slot[np.maximum(geom, 0)], -1) == -2
    return np.where((distance < 0) | own | (distance > lidar.options.range), 0.0, distance).reshape(
        len(lidar.options.angles), lidar.options.azimuths
    )


def test_the_first_column_looks_back_and_the_middle_one_ahead() -> None:
    options = LidarOptions(rings=3, azimuths=4, upper=10.0, lower=-10.0)
    rays = options.directions()
    np.testing.assert_allclose(np.sign(rays[1, :, :2]), [[-1, 1], [1, 1], [1, -1], [-1, -1]])
    np.testing.assert_allclose(rays[:, 0, 2], np.sin(np.radians([10.0, 0.0, -10.0])), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=-1), 1.0)
    pattern = LidarOptions(azimuths=4, elevations=(5.0, 4.0, -30.0))
    np.testing.assert_allclose(pattern.directions()[:, 0, 2], np.sin(np.radians([5.0, 4.0, -30.0])), atol=1e-12)
    assert pattern.feature.shape == (3, 4, 1)


@pytest.mark.parametrize("elevations", [(1.0, 2.0), (95.0, 0.0), (0.0,) * 300])
def test_a_wrong_pattern_is_one_sentence(elevations: tuple[float, ...]) -> None:
    with pytest.raises(ValidationError, match=r"--lidar.elevations: found"):
        LidarOptions(elevations=elevations).check()


@pytest.mark.parametrize("other", [{"rings": 8}, {"upper": 20.0}, {"lower": -40.0}])
def test_elevations_beside_an_even_pattern_are_refused(other: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match=f"--lidar.{next(iter(other))}: found .* beside --lidar.elevations"):
        LidarOptions(elevations=(5.0, 4.0, -30.0), **other).check()


def test_the_record_of_a_dataset_has_the_pattern_that_is_cast() -> None:
    even = {"rings": 4, "azimuths": 360, "upper": 15.0, "lower": -15.0, "range": 50.0, "height": None}
    assert LidarOptions(rings=4).described() == even
    pattern = {"rings": 3, "azimuths": 360, "elevations": (5.0, 4.0, -30.0), "range": 50.0, "height": None}
    assert LidarOptions(elevations=(5.0, 4.0, -30.0)).described() == pattern


def simulated(robot: RobotSpec, control: Any, seconds: float) -> tuple[mujoco.MjModel, Steps, np.ndarray]:
    """The robot on a plane in C MuJoCo: steps, and the means of gyro and accelerometer between them."""
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50, 50, 1], friction=[1.0, 0.005, 0.0001])
    root = spec.body(robot.root_body)
    root.add_site(name="imu")
    for kind in (mujoco.mjtSensor.mjSENS_GYRO, mujoco.mjtSensor.mjSENS_ACCELEROMETER):
        spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu")
    spec.option.timestep = 0.002
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0) if model.nkey else None
    data.qpos[2] = robot.spawn_height
    rows: list[tuple[np.ndarray, ...]] = []
    per_step = round(DT / model.opt.timestep)
    for step in range(round(seconds / DT)):
        control(model, data, step * DT)
        felt = np.zeros(6)
        # What the sensors measure in the world's frame, so that turning in between does not blur the mean.
        for _ in range(per_step):
            mujoco.mj_step(model, data)
            felt += data.sensordata / per_step
        mujoco.mj_forward(model, data)
        felt[:3] = data.sensordata[:3]
        rows.append((data.qvel.copy(), data.xpos.copy(), data.xquat.copy(), felt))
    qvel, xpos, xquat, felt = (np.array(column) for column in zip(*rows, strict=True))
    steps = Steps(*[None] * len(Steps._fields))._replace(qvel=qvel, xpos=xpos, xquat=xquat)
    return model, steps, felt


def push(model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
    """A smooth push and turn of the whole robot, its actuators at rest."""
    body = 1
    lift = 1.3 * 9.81 * min(time / 0.2, 1.0)
    mass = float(model.body_subtreemass[body])
    data.xfrc_applied[body] = [mass * np.sin(3 * time), mass, mass * lift, 1.0, 2.0 * np.sin(5 * time), 3.0]


def test_the_imu_is_mujocos_gyro_and_accelerometer() -> None:
    robot = make_coco()
    model, steps, felt = simulated(robot, push, 1.2)
    found = Readings(robot, model, DT, ["imu"]).columns(steps)[IMU]
    np.testing.assert_allclose(found[1:, :3], felt[1:, :3], atol=1e-3)
    flight = slice(20, None)
    assert np.abs(felt[flight, 3:] - [0, 0, 9.81]).max() > 2.0
    np.testing.assert_allclose(found[flight, 3:], felt[flight, 3:], atol=0.35)


def test_a_robot_at_rest_feels_gravity_upwards() -> None:
    robot = make_coco()
    model, steps, _ = simulated(robot, lambda *_: None, 1.5)
    found = Readings(robot, model, DT, ["imu", "odometry"]).columns(steps)
    np.testing.assert_allclose(found[IMU][-1], [0, 0, 0, 0, 0, 9.81], atol=0.02)
    np.testing.assert_allclose(found[ODOMETRY][-1], 0.0, atol=0.03)


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
def test_odometry_of_wheels_follows_the_driven_path(drive: Literal["differential", "ackermann"]) -> None:
    """A bend at about 1 m/s for 3 s, without walls: within a tenth of the path."""
    robot = make_coco(drive=drive)

    def control(model: mujoco.MjModel, data: mujoco.MjData, time: float) -> None:
        data.ctrl[:] = np.asarray(robot.command(np.array([1.0, 0.3]))) * min(time, 1.0)

    model, steps, _ = simulated(robot, control, 3.0)
    found = Readings(robot, model, DT, ["odometry"]).columns(steps)[ODOMETRY]
    root = model.body(robot.root_body).id
    path = rotations.rotate(steps.xquat[:1, root] * [1, -1, -1, -1], steps.xpos[:, root] - steps.xpos[0, root])
    driven = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1).sum()
    assert driven > 1.5
    np.testing.assert_allclose(found[-1, :2], path[-1, :2], atol=0.1 * driven)
    assert found[-1, 2] == pytest.approx(float(rotations.yaw_of(steps.xquat[-1, root])), abs=0.15)
    assert found[-1, 2] > 0.3


def test_odometry_of_legs_is_the_velocity_of_the_body() -> None:
    robot = make_go2()
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    qvel, quaternion = np.zeros((40, model.nv)), np.zeros((40, model.nbody, 4))
    yaw = 0.4 + 0.5 * DT * np.arange(40)
    root = model.body(robot.root_body).id
    quaternion[:, root] = rotations.from_yaw(yaw)
    qvel[:, 0], qvel[:, 1], qvel[:, 5] = 0.8 * np.cos(yaw), 0.8 * np.sin(yaw), 0.5
    steps = Steps(*[None] * len(Steps._fields))._replace(qvel=qvel, xquat=quaternion)
    found = Readings(robot, model, DT, ["odometry"]).columns(cast(Steps, steps))[ODOMETRY]
    np.testing.assert_allclose(found[:, 3:], np.tile([0.8, 0.0, 0.5], (40, 1)), atol=1e-9)
    angle = 0.5 * DT * 39
    np.testing.assert_allclose(
        found[-1, :3], [0.8 / 0.5 * np.sin(angle), 0.8 / 0.5 * (1 - np.cos(angle)), angle], atol=1e-4
    )


def test_integration_begins_at_zero() -> None:
    np.testing.assert_array_equal(integrated(np.ones((3, 3)), 0.1)[0], 0.0)


def test_the_check_knows_what_the_sensors_can_measure() -> None:
    pose = np.array([[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]] * 3)
    assert not [*own_checks.check_column("pose", pose, "f")]
    pose[1, 4] = 0.5
    assert "row 1" in next(own_checks.check_column(CAMERA_POSE, pose, "f"))
    assert "negative" in next(own_checks.check_column(FORCE, np.array([1.0, -2.0]), "f"))
    assert not [*own_checks.check_column("next.contact_object", np.array([-1, 2, 9]), "f")]
    assert "label" in next(own_checks.check_column("next.contact_object", np.array([-1, 1]), "f"))
    image = np.full((2, 2, 3), 128, np.uint8)
    assert not [*own_checks.check_image(own_checks.NORMALS, image, "f")]
    assert "unit" in next(own_checks.check_image(own_checks.NORMALS, image + np.uint8(20), "f"))


@pytest.mark.extended
def test_all_sensors_make_a_sound_dataset(env: NavEnv, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    use(env, monkeypatch)
    lidar = LidarOptions(rings=4, azimuths=32)
    options = pipeline.RecordOptions(**{**vars(OPTIONS), "sensors": ("all",), "num_episodes": 3, "lidar": lidar})
    pipeline.record(tmp_path / "new", options)
    assert pipeline.check_dataset(tmp_path / "new").problems == ()
    rows = table_of(tmp_path / "new")
    scan = cv2.imdecode(np.frombuffer(rows["observation.images.lidar"][0]["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)
    assert scan is not None
    assert scan.shape == (4, 32)
    assert 0 < scan[scan > 0].min() < scan.max() <= 50_000
    np.testing.assert_allclose(np.array(rows[IMU])[0, 3:], [0.0, 0.0, 9.81], atol=1e-3)
    pose = np.array(rows[CAMERA_POSE])[0]
    assert np.linalg.norm(pose[3:]) == pytest.approx(1.0, abs=1e-5)
    # The optical axis leads ahead of the robot, and slightly down or level.
    ahead = rotations.matrix_f64(pose[3:])[:, 2]
    heading = rotations.matrix_f64(np.array(rows["pose"])[0, 3:])[:, 0]
    assert ahead @ heading > 0.9
    assert np.array(rows[FORCE]).shape == (len(rows["pose"]),)
    origin = json.loads((tmp_path / "new/meta/urbanverse.json").read_text())
    assert origin["camera"]["cx"] == OPTIONS.size[1] / 2
    assert origin["lidar"]["rings"] == 4
    assert origin["lidar"]["height"] > 0.1
