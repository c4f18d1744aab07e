"""Planned drives: heights and clearances of a street as C MuJoCo has them, and paths that meet what they aim at."""

import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank, box_scenes
from urbanverse_mjx.datatypes import RobotSpec
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.parity import drives
from urbanverse_mjx.simulation.parity.drives import _Plan, _Street


@pytest.fixture(scope="module")
def street() -> _Street:
    return drives._street(box_bank(1, seed=3), 0)


@pytest.fixture(scope="module")
def world() -> tuple[mujoco.MjModel, mujoco.MjData]:
    (scene,) = box_scenes(1, seed=3)
    model = scene_spec(scene).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco("differential")


def test_heights_and_clearances_are_those_of_c_mujoco(
    street: _Street, world: tuple[mujoco.MjModel, mujoco.MjData]
) -> None:
    """Rays down to the ground alone, and distances of a point to every hull, which are boxes in this street."""
    model, data = world
    rng, geom = np.random.default_rng(0), np.zeros(1, np.int32)
    points = rng.uniform(street.low - 1.0, street.high + 1.0, (300, 2))
    ground = np.array([model.geom(g).bodyid[0] == 0 for g in range(model.ngeom)])
    names = [model.geom(g).name for g in range(model.ngeom)]
    is_ground = np.array([name.startswith("prism") or "ground" in name for name in names]) & ground
    assert is_ground.any()
    assert not is_ground.all()
    model.geom_group[:] = np.where(is_ground, 0, 1)
    groups = np.array([1, 0, 0, 0, 0, 0], np.uint8)
    expected = []
    for point in points:
        down = mujoco.mj_ray(model, data, np.array([*point, 5.0]), np.array([0.0, 0.0, -1.0]), groups, 1, -1, geom)
        expected.append(np.nan if down < 0 else 5.0 - down)
    inside = ~np.isnan(expected)
    assert 20 < inside.sum() < 290
    np.testing.assert_allclose(street.height(points), expected, atol=1e-5)

    high = np.column_stack([points, rng.uniform(0.0, 1.5, len(points))])
    boxes = [(data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3), g) for g in range(model.ngeom) if not is_ground[g]]
    nearest = np.full(len(high), np.inf)
    for position, rotation, g in boxes:
        mesh = int(model.geom_dataid[g])
        first = model.mesh_vertadr[mesh]
        corners = model.mesh_vert[first : first + model.mesh_vertnum[mesh]].astype(float)
        local = (high - position) @ rotation
        away = np.maximum(np.maximum(corners.min(0) - local, local - corners.max(0)), 0.0)
        nearest = np.minimum(nearest, np.linalg.norm(away, axis=1))
    np.testing.assert_allclose(street.clearance(high), nearest, atol=1e-4)


def test_a_path_is_that_of_its_speed_and_yaw_rate() -> None:
    """A straight one, and one whose heading is the integral of a sine: yaw + swing (1 - cos(pulse t)) / pulse."""
    plan = _Plan(
        np.array([[1.0, 2.0], [0.0, 0.0]]), np.array([0.5, -1.0]), np.array([1.5, 0.8]), np.array([0.0, 0.6]),
        np.array([1.0, 2.0]),
    )  # fmt: skip
    seconds = 3.0
    path = plan.path(seconds)
    np.testing.assert_allclose(path[:, 0], plan.place, atol=1e-9)
    dt = seconds / path.shape[1]
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(path, axis=1), axis=-1),
        np.array([[1.5], [0.8]]) * dt * np.ones(path.shape[1] - 1),
        rtol=1e-3,
    )
    assert 1.5 * dt <= 2.0 * drives._GROUND_SPACING
    time = np.linspace(0.0, seconds - dt, 30001)
    yaw = -1.0 + 0.6 * (1.0 - np.cos(2.0 * time)) / 2.0
    end = 0.8 * np.trapezoid(np.stack([np.cos(yaw), np.sin(yaw)], -1), time, axis=0)
    np.testing.assert_allclose(path[1, -1], end, atol=0.02)
    straight = np.array([1.0, 2.0]) + 1.5 * (seconds - dt) * np.array([np.cos(0.5), np.sin(0.5)])
    np.testing.assert_allclose(path[0, -1], straight, atol=1e-6)
    one = plan.row(1)
    np.testing.assert_array_equal(one.path(seconds)[0], path[1])


def test_drives_towards_a_place_pass_it_on_the_asked_side(street: _Street, robot: RobotSpec) -> None:
    rng = np.random.default_rng(0)
    target, aside = rng.uniform(-3, 3, (50, 2)), rng.uniform(-0.5, 0.5, 50)
    yaw = rng.uniform(-np.pi, np.pi, 50)
    plan = drives._towards(street, robot, rng, target, aside, yaw)
    to = target - plan.place
    ahead = np.cos(yaw) * to[:, 0] + np.sin(yaw) * to[:, 1]
    left = np.cos(yaw) * to[:, 1] - np.sin(yaw) * to[:, 0]
    np.testing.assert_allclose(-left, aside, atol=1e-9, err_msg="the path lies to the left by so much")
    assert (robot.circumradius + 0.9 <= ahead).all()
    assert (ahead <= robot.circumradius + 2.2).all()
    assert (plan.speed <= robot.max_speed).all()


def test_gaps_are_between_two_hulls_and_narrower_than_the_robot(street: _Street, robot: RobotSpec) -> None:
    """Two boxes 0.5 m apart: the only gap; a drive leads to its middle at a right angle."""
    half = np.array([0.4, 0.3, 0.5])
    turn = np.identity(3)
    two = _Street(
        np.array([[0.0, 0.0, 0.5], [0.1, 1.1, 0.5]]), np.stack([turn, turn]), np.stack([half, half]), street.planes,
        street.low, street.high,
    )  # fmt: skip
    plan = drives._between_objects(two, robot, np.random.default_rng(0))
    assert plan is not None
    assert (np.abs(np.abs(plan.yaw % np.pi) - 0.0) < 0.01).mean() + (
        np.abs(plan.yaw % np.pi - np.pi) < 0.01
    ).mean() > 0.99
    np.testing.assert_allclose(plan.place[:, 1], 0.55, atol=0.01)
    apart = _Street(np.array([[0.0, 0.0, 0.5], [0.1, 3.0, 0.5]]), two.rotation, two.half, *(
        (street.planes, street.low, street.high)
    ))  # fmt: skip
    assert drives._between_objects(apart, robot, np.random.default_rng(0)) is None


@pytest.mark.parametrize(
    ("kind", "asked"),
    [
        ("wedge", ("between",)),
        ("graze", ("at", True)),
        ("head_on", ("at", False)),
        ("free", ("anywhere", 0.5)),
        ("kerb", ("anywhere", 0.1)),
        ("ramp", ("anywhere", 0.1)),
    ],
)
def test_each_kind_of_drive_is_planned_as_such(
    kind: str, asked: tuple[object, ...], street: _Street, robot: RobotSpec, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first plan that begins well and is of its kind is taken, and where there is none, none."""
    calls: list[tuple[object, ...]] = []
    plan = _Plan(np.array([[30.0, 0.0], [31.0, 0.0]]), *(np.array([x, x]) for x in (0.0, 1.0, 0.0, 2.0)))

    def planned(name: str) -> object:
        def make(there: object, of: object, rng: object, *options: object) -> _Plan | None:
            assert there is street
            assert of is robot
            calls.append((name, *options))
            return plan if len(calls) < 3 else None

        return make

    for name, function in (("between", "_between_objects"), ("at", "_at_objects"), ("anywhere", "_anywhere")):
        monkeypatch.setattr(drives, function, planned(name))
    monkeypatch.setattr(drives, "_good_starts", lambda *_: [1])
    suits: list[str] = []
    monkeypatch.setattr(drives, "_suits", lambda kind, *_: suits.append(kind) or len(suits) == 2)
    found = drives._find(kind, street, robot, 2.0, np.random.default_rng(0))
    assert calls == [asked] * 2
    assert suits == [kind] * 2
    assert found is not None
    np.testing.assert_array_equal(found[0].place, [[31.0, 0.0]])
    assert found[1] == pytest.approx(float(street.height(np.array([[31.0, 0.0]]))[0]))
    assert drives._find(kind, street, robot, 2.0, np.random.default_rng(0)) is None


def test_an_aim_is_an_object_near_a_start() -> None:
    bank = box_bank(1, seed=3)
    present = bank.inst_hull[0] >= 0
    for seed in range(20):
        start, yaw = drives._aim(bank, 0, np.random.default_rng(seed))
        starts = bank.episode_start[0, : bank.num_episodes[0], :3]
        assert np.isclose(starts, start).all(1).any()
        away = bank.inst_position[0, present, :2] - start[:2]
        distance = np.hypot(*away.T)
        off = np.angle(np.exp(1j * (np.arctan2(away[:, 1], away[:, 0]) - yaw)))
        near = (distance > 1.5) & (distance < 4.0)
        assert start.shape == (3,)
        assert np.abs(off[near]).min() < 0.151
