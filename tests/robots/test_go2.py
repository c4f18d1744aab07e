"""Every number of the Go2 on the compiled model, as its sources give them, and that it stands."""

import math

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.robots import go2_body, make_go2

LEGS = ("FL", "FR", "RL", "RR")
#: mujoco_menagerie unitree_go2/go2.xml at 2ffe3e3: mass, centre of mass of the front left link, principal inertias.
LINKS = {
    "base": (6.921, (0.021112, 0.0, -0.005366), (0.107027, 0.0980771, 0.0244531)),
    "hip": (0.678, (-0.0054, 0.00194, -0.000105), (0.00088403, 0.000596003, 0.000479967)),
    "thigh": (1.152, (-0.00374, -0.0223, -0.0327), (0.00594973, 0.00584149, 0.000878787)),
    "calf": (0.241352, (0.00629595, -0.000622121, -0.141417), (0.0014901, 0.00146356, 5.31397e-05)),
}
#: The same, quaternions (wxyz) of the principal axes of two legs that are mirrored along both axes.
AXES = {
    "base": (-0.000543471, 0.713435, -0.00173769, 0.700719),
    "FL_hip": (0.497014, 0.499245, 0.505462, 0.498237),
    "FR_hip": (0.498237, 0.505462, 0.499245, 0.497014),
    "RL_hip": (0.505462, 0.498237, 0.497014, 0.499245),
    "FL_thigh": (0.829533, 0.0847635, -0.0200632, 0.551623),
    "FR_thigh": (0.551623, -0.0200632, 0.0847635, 0.829533),
    "FL_calf": (0.710672, 0.00154099, -0.00450087, 0.703508),
    "FR_calf": (0.703508, -0.00450087, 0.00154099, 0.710672),
}
RANGES = {
    "hip": {"F": (-1.0472, 1.0472), "R": (-1.0472, 1.0472)},
    "thigh": {"F": (-1.5708, 3.4907), "R": (-0.5236, 4.5379)},
    "calf": {"F": (-2.7227, -0.83776), "R": (-2.7227, -0.83776)},
}
TORQUE = {"hip": 23.7, "thigh": 23.7, "calf": 45.43}


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(make_go2().mjcf)


def _matrix(quaternion: tuple[float, ...] | np.ndarray) -> np.ndarray:
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, np.asarray(quaternion, np.float64) / np.linalg.norm(quaternion))
    return out.reshape(3, 3)


def _inertia(model: mujoco.MjModel, body: str) -> np.ndarray:
    b = model.body(body)
    axes = _matrix(b.iquat)
    return axes @ np.diag(b.inertia) @ axes.T


def test_masses_and_centres(model: mujoco.MjModel) -> None:
    assert model.body_subtreemass[0] == pytest.approx(15.206408, abs=1e-6)
    for name in ("base", *(f"{leg}_{link}" for leg in LEGS for link in ("hip", "thigh", "calf"))):
        mass, centre, _ = LINKS[name.rpartition("_")[2]]
        mirror = np.array([-1.0 if name.startswith("R") and "hip" in name else 1.0, 1.0, 1.0])
        mirror[1] = -1.0 if name[1] == "R" else 1.0
        body = model.body(name)
        assert body.mass[0] == pytest.approx(mass, abs=1e-9), name
        np.testing.assert_allclose(body.ipos, np.array(centre) * mirror, atol=1e-9, err_msg=name)


def test_inertias_are_those_of_two_independent_sources(model: mujoco.MjModel) -> None:
    """Ours are urdf's products of inertia, mirrored; menagerie has principal axes of each leg."""
    for name in ("base", *(f"{leg}_{link}" for leg in LEGS for link in ("hip", "thigh", "calf"))):
        principal = LINKS[name.rpartition("_")[2]][2]
        found = np.linalg.eigvalsh(_inertia(model, name))
        np.testing.assert_allclose(found, np.sort(principal), rtol=2e-3, err_msg=name)
    for name, quaternion in AXES.items():
        axes = _matrix(quaternion)
        expected = axes @ np.diag(LINKS[name.rpartition("_")[2]][2]) @ axes.T
        np.testing.assert_allclose(_inertia(model, name), expected, atol=2e-5 * 10, rtol=2e-3, err_msg=name)


def test_joints_and_motors(model: mujoco.MjModel) -> None:
    assert (model.nq, model.nv, model.nu) == (19, 18, 12)
    for i, name in enumerate(go2_body.JOINT_NAMES):
        leg, joint, _ = name.split("_")
        found, motor = model.joint(name), model.actuator(f"{leg}_{joint}")
        assert found.id == i + 1
        assert motor.trnid[0] == found.id
        np.testing.assert_allclose(found.range, RANGES[joint][leg[0]], err_msg=name)
        np.testing.assert_allclose(found.axis, (1, 0, 0) if joint == "hip" else (0, 1, 0))
        assert found.damping[0] == 1.0
        assert found.armature[0] == (0.02 if joint == "calf" else 0.01)
        assert found.frictionloss[0] == 0.0
        np.testing.assert_allclose(motor.forcerange, (-TORQUE[joint], TORQUE[joint]))
        np.testing.assert_allclose(motor.ctrlrange, RANGES[joint][leg[0]])
        assert motor.gainprm[0] == 40.0
        np.testing.assert_allclose(motor.biasprm[:3], (0.0, -40.0, 0.0))
        assert go2_body.ROW.motor_speeds[i] == (15.7 if joint == "calf" else 30.1)


def test_legs_are_as_long_and_stand_where_they_should(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for leg in LEGS:
        front, left = (1 if leg[0] == "F" else -1), (1 if leg[1] == "L" else -1)
        np.testing.assert_allclose(model.body(f"{leg}_hip").pos, (front * 0.1934, left * 0.0465, 0.0))
        np.testing.assert_allclose(model.body(f"{leg}_thigh").pos, (0.0, left * 0.0955, 0.0))
        np.testing.assert_allclose(model.body(f"{leg}_calf").pos, (0.0, 0.0, -0.213))
        foot = model.geom(f"{leg}_foot")
        np.testing.assert_allclose(foot.pos, (-0.002, 0.0, -0.213))
        assert foot.size[0] == 0.022
        assert foot.friction[0] == 0.8
    others = [g for g in range(model.ngeom) if model.geom_contype[g] + model.geom_conaffinity[g] > 0]
    others = [g for g in others if not model.geom(g).name.endswith("_foot")]
    assert len(others) > 30
    assert (model.geom_friction[others, 0] == 0.6).all()
    # rl_lab's and isaaclab's standing pose: hips out by 0.1, thighs 0.8 in front and 1.0 behind, knees -1.5.
    pose = [(left * 0.1, 0.8 if front else 1.0, -1.5) for front in (1, 0) for left in (1, -1)]
    np.testing.assert_allclose(model.key_qpos[0, 7:], np.ravel(pose))


def _primitives() -> dict[str, np.ndarray]:
    """Points on menagerie's collision shapes, by link."""
    side = np.linspace(-1, 1, 9)
    cube = np.array([(x, y, z) for x in side for y in side for z in side if max(abs(x), abs(y), abs(z)) == 1])
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)

    def tube(
        radius: float, half: float, place: tuple[float, float, float], quaternion: tuple[float, ...]
    ) -> np.ndarray:
        ring = [(radius * math.cos(a), radius * math.sin(a), half * h) for a in angle for h in side]
        return np.array(ring) @ _matrix(quaternion).T + place

    return {
        "base": np.concatenate([cube * (0.1881, 0.04675, 0.057), tube(0.05, 0.045, (0.285, 0, 0.01), (1, 0, 0, 0))]),
        "FL_hip": tube(0.046, 0.02, (0, 0.08, 0), (0.707107, 0.707107, 0, 0)),
        "FL_thigh": (cube * (0.1065, 0.01225, 0.017)) @ _matrix((0.707107, 0, 0.707107, 0)).T + (0, 0, -0.1065),
        "FL_calf": np.concatenate(
            [
                tube(0.012, 0.06, (0.008, 0, -0.06), (0.994493, 0, -0.104807, 0)),
                tube(0.011, 0.0325, (0.02, 0, -0.148), (0.999688, 0, 0.024997, 0)),
            ]
        ),
    }


@pytest.mark.parametrize("link", ["base", "FL_hip", "FL_thigh", "FL_calf"])
def test_spheres_cover_the_body(model: mujoco.MjModel, link: str) -> None:
    """No point of menagerie's shapes is 3 cm outside all spheres of its link and of the links at its joints."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = model.body(link).id
    family = {body, model.body_parentid[body], *np.flatnonzero(model.body_parentid == body)}
    points = _primitives()[link] @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
    solid = [g for g in range(model.ngeom) if model.geom_conaffinity[g] and model.geom_bodyid[g] in family]
    apart = np.linalg.norm(points[:, None] - data.geom_xpos[solid], axis=-1) - model.geom_size[solid, 0]
    assert apart.min(1).max() < 0.03


def test_the_circumradius_bounds_every_pose(model: mujoco.MjModel) -> None:
    rng, data, worst = np.random.default_rng(0), mujoco.MjData(model), 0.0
    solid = np.flatnonzero(model.geom_conaffinity)
    for _ in range(400):
        data.qpos[7:] = rng.uniform(*model.jnt_range[1:].T)
        mujoco.mj_kinematics(model, data)
        far = np.linalg.norm(data.geom_xpos[solid] - data.xpos[1], axis=1) + model.geom_size[solid, 0]
        worst = max(worst, far.max())
    assert 0.9 * make_go2().circumradius < worst <= make_go2().circumradius


def test_it_stands() -> None:
    """In C MuJoCo, 2 s on level ground in its pose: upright, still, on its feet."""
    spec = mujoco.MjSpec.from_string(make_go2().mjcf)
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 0.1])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for _ in range(400):
        mujoco.mj_step(model, data)
    # The servos give way: 40 N m/rad under 15 kg.
    assert 0.26 < data.qpos[2] < make_go2().spawn_height
    assert data.xmat[1, 8] > 0.99
    # Soft contacts let the feet creep outwards by some mm/s under the splayed legs.
    assert np.abs(data.qvel).max() < 0.1
    touching = {model.geom(g).name for g in data.contact.geom.ravel()} - {"floor"}
    assert touching == set(go2_body.FOOT_NAMES)


def test_what_a_waypoint_means() -> None:
    """1 m ahead is full speed, as it is to COCO; beside it a turn, and never sideways."""
    go2 = make_go2()
    assert [float(x) for x in go2.waypoint_to_velocity(np.array([1.0, 0.0]), 0.2)] == [1.0, 0.0]
    assert [float(x) for x in go2.waypoint_to_velocity(np.array([0.0, 1.0]), 0.2)] == [0.0, 1.0]
    assert [float(x) for x in go2.waypoint_to_velocity(np.array([0.5, 0.0]), 0.2)] == [0.5, 0.0]
    np.testing.assert_array_equal(go2.command(np.array([3.0, -2.0])), [1.0, 0.0, -1.0])


def test_nothing_of_itself_stands_before_its_camera() -> None:
    """Rays through the whole of a 16:9 image meet none of its own geoms, seen or not."""
    model = mujoco.MjModel.from_xml_string(make_go2().mjcf)
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    mujoco.mj_forward(model, data)
    camera = model.camera("front_cam").id
    camera_position, turn = data.cam_xpos[camera], data.cam_xmat[camera].reshape(3, 3)
    high = np.tan(np.radians(model.cam_fovy[camera]) / 2)
    for up in np.linspace(-high, high, 15):
        for right in np.linspace(-high, high, 27) * 16 / 9:
            hit = np.full(1, -1, np.int32)
            away = mujoco.mj_ray(model, data, camera_position, turn @ np.array([right, up, -1.0]), None, 1, -1, hit)
            assert away < 0.0, model.geom(hit[0]).name
