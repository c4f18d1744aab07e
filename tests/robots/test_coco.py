"""COCO as data: every published number on the compiled model, the shell and the spheres, the mappings."""

import itertools
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.datatypes import RobotSpec, ValidationError
from urbanverse_mjx.robots import coco, coco_body, make_coco

DRIVES = ("differential", "ackermann")
# docs/sources/coco.json, written here anew: geometry_from_model, mass_properties, friction, camera, steer.
WHEEL_CENTRE = {
    "front_left": (0.221, 0.236, -0.166),
    "front_right": (0.221, -0.236, -0.166),
    "rear_left": (-0.235, 0.236, -0.166),
    "rear_right": (-0.235, -0.236, -0.166),
}


@pytest.fixture(scope="module", params=DRIVES)
def robot(request: pytest.FixtureRequest) -> RobotSpec:
    return make_coco(request.param)


def compiled(robot: RobotSpec) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    data.qpos[:7] = 0, 0, 0, 1, 0, 0, 0
    mujoco.mj_forward(model, data)
    return model, data


def test_wheels_stand_where_the_source_says(robot: RobotSpec) -> None:
    model, data = compiled(robot)
    for name, centre in WHEEL_CENTRE.items():
        np.testing.assert_allclose(data.geom(f"{name}_wheel").xpos, centre, atol=1e-9)
        assert model.geom(f"{name}_wheel").type == mujoco.mjtGeom.mjGEOM_SPHERE
        np.testing.assert_allclose(model.geom(f"{name}_wheel").size[0], 0.11)
        np.testing.assert_allclose(model.joint(f"{name}_wheel_joint").axis, (0, 1, 0))
    wheels = [data.geom(f"{name}_wheel").xpos for name in WHEEL_CENTRE]
    np.testing.assert_allclose(wheels[0][0] - wheels[2][0], 0.456)  # wheelbase
    np.testing.assert_allclose(wheels[0][1] - wheels[1][1], 0.472)  # track


def test_masses_and_inertias(robot: RobotSpec) -> None:
    model, _ = compiled(robot)
    wheels = {f"{name}_wheel_link": (1.0, 0.1) for name in WHEEL_CENTRE}
    for name, (mass, inertia) in {"base_link": (50.0, 2.5), "body_link": (25.0, 2.5), **wheels}.items():
        np.testing.assert_allclose(model.body(name).mass, mass)
        np.testing.assert_allclose(model.body(name).inertia, inertia)
    np.testing.assert_allclose(model.body_subtreemass[0], 79.0, atol=1e-5)


def test_friction_and_who_touches_whom(robot: RobotSpec) -> None:
    model, data = compiled(robot)
    for i in range(len(coco_body.BODY_SPHERES)):
        np.testing.assert_allclose(model.geom(f"body_{i}").friction[0], 0.6)
    for name in WHEEL_CENTRE:
        geom = model.geom(f"{name}_wheel")
        if robot.name == "coco_differential" and name.startswith("front"):
            assert geom.condim == 1
            assert geom.priority == 1
        else:
            np.testing.assert_allclose(geom.friction[0], 0.7)
            assert geom.condim == 3
            assert geom.priority == 0
    # No part of the robot collides with another, in any position of its joints.
    rng = np.random.default_rng(0)
    for _ in range(50):
        data.qpos[7:] = rng.uniform(-np.pi, np.pi, model.nq - 7)
        mujoco.mj_forward(model, data)
        assert data.ncon == 0


def test_steering_is_the_published_range() -> None:
    model, _ = compiled(make_coco("ackermann"))
    joint = model.joint("base_to_front_axle_joint")
    np.testing.assert_allclose(np.rad2deg(joint.range), (-20.0535, 20.0535), atol=1e-4)
    np.testing.assert_allclose(joint.axis, (0, 0, 1))
    np.testing.assert_allclose(model.body("front_axle_link").pos, (0.221, 0.0, -0.095))
    np.testing.assert_allclose(model.actuator("steer").forcerange, (-64, 64))


def test_camera_looks_ahead_with_the_published_angle(robot: RobotSpec) -> None:
    model, data = compiled(robot)
    camera = model.camera("front_cam")
    np.testing.assert_allclose(data.camera("front_cam").xpos, (0.51, 0.0, 0.015), atol=1e-9)
    axes = data.camera("front_cam").xmat.reshape(3, 3)
    np.testing.assert_allclose(-axes[:, 2], (1, 0, 0), atol=1e-9)  # viewing direction
    np.testing.assert_allclose(axes[:, 1], (0, 0, 1), atol=1e-9)  # up
    # fx = fy = 531 at 1920 x 1080.
    np.testing.assert_allclose(camera.fovy, np.rad2deg(2 * np.arctan(540 / 531)), atol=0.01)
    across = 2 * np.arctan(np.tan(np.deg2rad(camera.fovy) / 2) * 16 / 9)
    np.testing.assert_allclose(np.rad2deg(across), 122.1, atol=0.05)


def test_options_are_those_all_engines_agree_on(robot: RobotSpec) -> None:
    model, _ = compiled(robot)
    assert model.opt.timestep == robot.physics_timestep <= 0.010
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    # Servo damping is joint damping: the actuators of the wheels have no bias of their own.
    for name in WHEEL_CENTRE:
        actuator, joint = model.actuator(f"{name}_wheel"), model.joint(f"{name}_wheel_joint")
        np.testing.assert_allclose(actuator.gainprm[0], joint.damping, rtol=1e-6)
        assert not actuator.biasprm.any()


def test_the_spheres_cover_the_shell_within_3_cm() -> None:
    vertices, faces = coco_body.shell_mesh()
    shell = trimesh.Trimesh(vertices, faces)  # merges equal corners
    assert shell.is_watertight
    assert shell.is_convex
    np.testing.assert_allclose(shell.extents, (0.7, 0.5, 0.4), atol=0.006)
    assert 6 <= len(coco_body.BODY_SPHERES) <= 12
    points = trimesh.sample.sample_surface(shell, 20_000, seed=0)[0]
    centres = np.array(coco_body.BODY_SPHERES)
    outside = np.linalg.norm(points[:, None] - centres, axis=-1).min(1) - coco_body.BODY_SPHERE_RADIUS
    assert outside.max() < 0.03
    # And no sphere sticks out of any face of the shell by more.
    offsets = np.einsum("fi,fi->f", shell.face_normals, shell.triangles[:, 0])
    out = (centres @ shell.face_normals.T - offsets).max() + coco_body.BODY_SPHERE_RADIUS
    assert out < 0.03


def test_circumradius_is_the_farthest_collision_point_in_any_position(robot: RobotSpec) -> None:
    model, data = compiled(robot)
    spheres = np.flatnonzero(model.geom_conaffinity)
    assert (model.geom_type[spheres] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
    farthest = 0.0
    for steer in np.linspace(-1, 1, 21):
        if robot.name == "coco_ackermann":
            data.joint("base_to_front_axle_joint").qpos = steer * model.joint("base_to_front_axle_joint").range[1]
        mujoco.mj_kinematics(model, data)
        reach = np.linalg.norm(data.geom_xpos[spheres], axis=1) + model.geom_size[spheres, 0]
        farthest = max(farthest, reach.max())
    np.testing.assert_allclose(robot.circumradius, farthest, atol=1e-6)


def test_differential_command_is_the_unicycle_without_slip() -> None:
    command = make_coco("differential").command
    # Straight on at 1.1 m/s with wheels of 0.11 m: 10 rad/s each.
    np.testing.assert_allclose(command(np.array([1.1, 0.0])), [10.0] * 4, rtol=1e-6)
    left, right, *_ = np.array(command(np.array([0.0, 1.0])))
    # On the spot the difference of the sides is track * omega / radius.
    np.testing.assert_allclose((right - left) * 0.11, 0.472, rtol=1e-6)
    # Clipped to 2 m/s and 1 rad/s, no reverse.
    np.testing.assert_array_equal(command(np.array([9.0, 0.0])), command(np.array([2.0, 0.0])))
    np.testing.assert_array_equal(command(np.array([0.0, -9.0])), command(np.array([0.0, -1.0])))
    np.testing.assert_array_equal(command(np.array([-1.0, 0.0])), np.zeros(4))


@pytest.mark.parametrize(("speed", "yaw_rate"), list(itertools.product((0.3, 1.0, 2.0), (-0.6, -0.1, 0.2, 0.5))))
def test_ackermann_wheels_roll_about_one_centre(speed: float, yaw_rate: float) -> None:
    fl, fr, rl, rr, angle = np.array(make_coco("ackermann").command(np.array([speed, yaw_rate])), np.float64)
    angle_range = np.deg2rad(20.053522)
    expected = np.clip(np.arctan(0.456 * yaw_rate / speed), -angle_range, angle_range)
    np.testing.assert_allclose(angle, expected, atol=1e-5)
    turn = speed * np.tan(expected) / 0.456
    # Each wheel's speed is the turn rate times its distance from the centre of the turn, which lies on the rear axle.
    centre = np.array([0.0, speed / turn])
    axle = np.array([0.456, 0.0])
    sideways = 0.236 * np.array([-np.sin(expected), np.cos(expected)])
    for wheel, place in ((fl, axle + sideways), (fr, axle - sideways), (rl, (0, 0.236)), (rr, (0, -0.236))):
        np.testing.assert_allclose(wheel * 0.11, abs(turn) * np.linalg.norm(place - centre), rtol=2e-4)


def test_ackermann_does_not_turn_on_the_spot() -> None:
    wheels = np.array(make_coco("ackermann").command(np.array([0.0, 1.0])))[:4]
    np.testing.assert_array_equal(wheels, 0.0)


def test_waypoint_by_hand() -> None:
    def velocity(x: float, y: float, period: float = 0.2) -> tuple[float, float]:
        v, w = coco.waypoint_to_velocity(jnp.array([x, y]), period)
        return float(v), float(w)

    assert velocity(1.0, 0.0) == (2.0, 0.0)  # 1 m within half a second
    np.testing.assert_allclose(velocity(0.25, 0.0), (0.5, 0.0))
    np.testing.assert_allclose(velocity(0.5, 0.1), (1.0, np.arctan2(0.1, 0.5) / 0.5), rtol=1e-6)
    assert velocity(0.0, 0.5) == (0.0, 1.0)  # beside: turn on the spot, to the left
    assert velocity(-1.0, -0.1) == (0.0, -1.0)  # behind to the right
    assert velocity(0.0, 0.0) == (0.0, 0.0)
    # With a period longer than the horizon the waypoint is reached within the period.
    np.testing.assert_allclose(velocity(0.5, 0.0, 1.0), (0.5, 0.0))


@jax.jit
def velocity_and_slope(x: Any, y: Any) -> tuple[Any, Any]:
    """(2,) the velocity for a waypoint (x, y), and its derivatives (2, 2)."""

    def velocity(point: Any) -> Any:
        return jnp.stack(coco.waypoint_to_velocity(point, 0.2))

    point = jnp.stack([x, y])
    return velocity(point), jax.jacobian(velocity)(point)


@settings(max_examples=100, deadline=None)
@given(st.floats(-1, 1, width=32), st.floats(-1, 1, width=32))
def test_waypoint_is_bounded_mirrored_and_differentiable(x: float, y: float) -> None:
    (v, w), slope = (np.asarray(a) for a in velocity_and_slope(np.float32(x), np.float32(y)))
    assert 0.0 <= v <= 2.0
    assert -1.0 <= w <= 1.0
    mirrored = np.asarray(velocity_and_slope(np.float32(x), np.float32(-y))[0])
    assert mirrored[0] == v
    if y != 0.0:
        assert mirrored[1] == -w
    assert np.isfinite(slope).all()


def test_unknown_drive_is_refused() -> None:
    with pytest.raises(ValidationError, match="differential, ackermann"):
        make_coco("tracks")  # pyright: ignore[reportArgumentType]
