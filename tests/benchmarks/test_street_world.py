"""The robots of benchmarks.transfer in C MuJoCo: the same drives as elsewhere, and shifts against mechanics."""

import math

import numpy as np
import pytest

from benchmarks.lib import shifts as s
from benchmarks.lib.street_world import FINE_STEP, GRAVITY, TICK, World
from tests.support.standing_objects import CUBE, scene_of
from urbanverse_mjx.evaluation.gait_walks import walk
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import coco_body
from urbanverse_mjx.robots.go2 import load_gait, make_go2
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import region_scene, strips_regions
from urbanverse_mjx.simulation.parity.c_mujoco import Drives, drive_reference, reference_model

FLAT = region_scene("flat", strips_regions(iter([(40.0, 0.0, 0.0)]), 40.0))
START = np.array([-10.0, 0.0, 0.0, 0.3])


def _under(**fields: object) -> s.Conditions:
    calm = s.Shifts().draw((0,))
    return s.Conditions(**{**calm.__dict__, **fields})  # type: ignore[arg-type]


def _driven(world: World, conditions: s.Conditions, seconds: float, velocity=(2.0, 0.0), start=START) -> np.ndarray:
    """(T, 3) poses after every tick."""
    world.begin(start, conditions)
    poses = []
    for _ in range(round(seconds / TICK)):
        world.drive(velocity)
        poses.append(world.pose)
    return np.array(poses)


@pytest.fixture(scope="module")
def coco() -> World:
    return World(FLAT, "coco", s.Shifts())


def test_without_shifts_coco_drives_as_in_the_parity_reference(coco: World) -> None:
    world, commands = coco, [(2.0, 0.3), (1.0, -0.8), (0.0, 1.0)]
    world.begin(START, _under())
    begin, found = world.data.qpos.copy(), []
    for velocity in commands:
        for _ in range(10):
            world.drive(velocity)
        found.append(world.data.qpos.copy())
    ctrl = np.array([np.asarray(world.robot.command(np.array(c, np.float32))) for c in commands])[:, None]
    drives = Drives(np.zeros(1, np.int32), begin[None], ctrl)
    trace = drive_reference([reference_model(scene_spec(FLAT), world.robot)], world.robot, drives, 0.2)
    np.testing.assert_allclose(found, trace.qpos[0, 19::20], atol=1e-9)
    assert abs(found[-1][0] - begin[0]) > 0.3


def test_without_shifts_the_go2_walks_as_in_the_evaluation_of_gaits() -> None:
    world, gait, robot = World(FLAT, "go2", s.Shifts()), load_gait(), make_go2()
    poses = _driven(world, _under(), 2.0, (0.8, 0.2))
    qpos = np.zeros((1, world.model.nq))
    qpos[0, :3], qpos[0, 3:7], qpos[0, 7:] = START[:3], rotations.from_yaw(np.float64(START[3])), gait.stand
    qpos[0, 2] += robot.spawn_height

    def commander(places: np.ndarray, yaws: np.ndarray, time: float) -> np.ndarray:
        del places, yaws, time
        return np.array([[0.8, 0.0, 0.2]])

    model = reference_model(scene_spec(FLAT), robot)
    walked = walk([model], np.zeros(1, int), robot, gait, qpos, commander, 100, np.full(12, 30.0))
    # The history of a gait begins with a standing robot here, with its first frame there.
    np.testing.assert_allclose(poses[:, :2], walked.position[0, :, :2], atol=0.08)
    assert np.linalg.norm(poses[-1, :2] - START[:2]) > 1.0


def test_a_tilted_place_is_a_slope(coco: World) -> None:
    """Gravity that is turned about a level place, and a slope under gravity that is not, are the same drive."""
    slope = math.radians(4.0)
    rise = 40.0 * math.tan(slope)
    ramp = World(region_scene("ramp", strips_regions(iter([(40.0, 0.0, rise)]), 40.0)), "coco", s.Shifts())
    east = np.array([-10.0, 0.0, 0.0, 0.0])
    tilted = _driven(coco, _under(gravity=(-math.sin(slope), 0.0, -math.cos(slope))), 3.0, (1.5, 0.0), east)
    ramp.begin(np.array([-10.0, 0.0, 10.0 * math.tan(slope), 0.0]), _under())
    # Standing along the slope from the beginning, as the other does.
    half = -slope / 2
    ramp.data.qpos[3:7] = math.cos(half), 0.0, math.sin(half), 0.0
    height = ramp.robot.spawn_height
    ramp.data.qpos[:3] += height * np.array([-math.sin(slope), 0.0, math.cos(slope) - 1.0])
    first = ramp.data.qpos[:3].copy()
    for _ in range(150):
        ramp.drive((1.5, 0.0))
    along = float(np.linalg.norm(ramp.data.qpos[:3] - first))
    assert along == pytest.approx(tilted[-1, 0] - east[0], abs=0.01)
    level = _driven(coco, _under(), 3.0, (1.5, 0.0), east)
    # docs of the servo: 1:8 costs 0.3 m/s, so 4 degrees cost 0.17 m/s.
    assert (level[-1, 0] - level[-51, 0]) - (tilted[-1, 0] - tilted[-51, 0]) == pytest.approx(0.17, abs=0.05)


def test_slipping_wheels_accelerate_by_coulomb_s_law(coco: World) -> None:
    """Two of four tyres drive and carry half of the weight, so the robot gains at most friction x g / 2."""
    friction = 0.06
    poses = _driven(coco, _under(grip=friction), 1.0, start=np.array([-10.0, 0.0, 0.0, 0.0]))
    speed = np.diff(poses[:, 0]) / TICK
    gained = (speed[45] - speed[10]) / (35 * TICK)
    # Friction on the ground of 1.0: the larger of the two surfaces' counts without the shift.
    assert gained == pytest.approx(friction * GRAVITY / 2, rel=0.15)
    spin = coco.data.qvel[coco.model.jnt_dofadr[coco.model.actuator_trnid[2, 0]]] * coco_body.WHEEL_RADIUS
    assert spin > 2.0 * speed[-1]
    gripping = _driven(coco, _under(), 1.0, start=np.array([-10.0, 0.0, 0.0, 0.0]))
    assert gripping[-1, 0] > poses[-1, 0] + 0.4


def test_a_weak_battery_has_a_lower_top_speed_and_less_torque(coco: World) -> None:
    for share in (1.0, 0.6):
        poses = _driven(coco, _under(battery=share), 5.0, start=np.array([-10.0, 0.0, 0.0, 0.0]))
        speed = np.diff(poses[:, 0]) / TICK
        assert speed[-1] == pytest.approx(2.0 * share, rel=0.02)
        # A servo of first order: the lag grows as its gain falls.
        lag = TICK * int(np.argmax(speed > (1 - math.exp(-1)) * speed[-1]))
        assert lag == pytest.approx(coco_body.SPEED_TIME_CONSTANT / share, rel=0.2)
    # Slower than the lower top speed, the robot still follows its command.
    slow = _driven(coco, _under(battery=0.6), 5.0, (0.5, 0.0), np.array([-10.0, 0.0, 0.0, 0.0]))
    assert (slow[-1, 0] - slow[-2, 0]) / TICK == pytest.approx(0.5, rel=0.02)


def test_conditions_of_one_episode_leave_nothing_behind(coco: World) -> None:
    before = _driven(coco, _under(), 1.0)
    _driven(coco, _under(grip=0.1, battery=0.5, gravity=(0.1, 0.0, -0.99)), 0.5)
    assert np.array_equal(_driven(coco, _under(), 1.0), before)


def test_a_weak_battery_limits_the_torque_of_legs() -> None:
    world = World(FLAT, "go2", s.Shifts())
    world.begin(START, _under())
    limit = world.model.actuator_forcerange.copy()
    world.begin(START, _under(battery=0.5))
    np.testing.assert_allclose(world.model.actuator_forcerange, 0.5 * limit)
    assert limit.max() > 20.0


@pytest.mark.parametrize("robot", ["coco", "go2"])
def test_the_other_contact_model_is_another_one_and_still_drives(robot: str) -> None:
    nominal, other = (World(FLAT, robot, s.Shifts(contact=c)) for c in (False, True))
    assert other.model.opt.timestep == FINE_STEP
    assert other.model.opt.cone != nominal.model.opt.cone
    assert other.model.opt.integrator != nominal.model.opt.integrator
    # Three quarters of full speed ahead.
    told = 0.75 * nominal.robot.max_speed
    a, b = (_driven(w, _under(), 3.0, (told, 0.2)) for w in (nominal, other))
    apart = np.linalg.norm(a[-1, :2] - b[-1, :2])
    assert 1e-4 < apart < 0.2 * np.linalg.norm(a[-1, :2] - START[:2])
    # Softer contacts: the robot sinks deeper.
    assert other.data.qpos[2] < nominal.data.qpos[2] + 0.02


def test_touching_an_object_counts_and_standing_on_wheels_does_not() -> None:
    scene = scene_of(CUBE, movable=False)
    x, y, z = scene.object_position[0]
    world = World(scene, "coco", s.Shifts())
    world.begin(np.array([x - 2.0, y, z, 0.0]), _under())
    for _ in range(120):
        world.drive((1.0, 0.0))
        if world.hit:
            break
    assert world.hit == scene.object_ids[0]
    # The cube's side is 0.2 m from its middle, the robot's shell 0.35 m from its own.
    assert x - world.pose[0] == pytest.approx(0.2 + 0.35, abs=0.05)
    world.begin(np.array([x - 2.0, y, z, math.pi]), _under())
    for _ in range(20):
        world.drive((0.5, 0.0))
    assert world.hit is None
    assert not world.fallen


def test_a_road_is_off_the_traversable_ground_and_a_robot_on_its_side_has_fallen() -> None:
    scene = scene_of(CUBE, movable=False)
    x, y, z = scene.object_position[0]
    world = World(scene, "coco", s.Shifts())
    world.begin(np.array([x - 2.0, y, z, 0.0]), _under())
    assert not world.off_traversable
    assert not world.fallen
    world.begin(np.array([10.0, 0.0, 0.0, 0.0]), _under())
    assert world.off_traversable
    world.begin(np.array([1000.0, 0.0, 0.0, 0.0]), _under())
    assert world.off_traversable
    world.data.qpos[3:7] = rotations.unit(np.array([1.0, 0.8, 0.0, 0.0]))
    assert world.fallen
    world.data.qpos[0] = np.nan
    assert world.fallen
