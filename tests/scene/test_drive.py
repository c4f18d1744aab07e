"""C MuJoCo drives of COCO over the compiled ground."""

import mujoco
import numpy as np
import pytest

from tests.support.toy_assets import TOY_SOURCE, toy_index, toy_layout
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import GroundRegion, RobotSpec, SceneGraph, Source
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.robots.coco import Drive
from urbanverse_mjx.scene.compiler import scene_geometry
from urbanverse_mjx.scene.drive import ARRIVAL_DISTANCE, drive_all, ground_model
from urbanverse_mjx.scene.planner import FreeSpace, RobotSize, free_space

GRAPHS = sorted(settings.scene_root().glob("*/graph.json"))


def _ground(regions: tuple[GroundRegion, ...], robot: RobotSpec) -> tuple[mujoco.MjModel, FreeSpace]:
    graph = SceneGraph("ground", Source("hand", "Apache-2.0", "none", "none"), (), regions)
    scene = scene_geometry(toy_layout(graph), toy_index(), TOY_SOURCE)
    return ground_model(scene, robot), free_space(scene.map, RobotSize())


def _straight(model: mujoco.MjModel, robot: RobotSpec, start: np.ndarray, speed: float, seconds: float) -> np.ndarray:
    """(n, 3) positions of the root, one per physics step, at constant speed from (x, y, z, yaw)."""
    data = mujoco.MjData(model)
    x, y, z, yaw = start
    data.qpos[:7] = [x, y, z + robot.spawn_height, *rotations.from_yaw(yaw)]
    command = np.asarray(robot.command(np.array([speed, 0.0])))
    route = []
    for _ in range(round(seconds / model.opt.timestep)):
        data.ctrl[:] = command
        mujoco.mj_step(model, data)
        route.append(data.qpos[:3].copy())
    return np.array(route)


def _skewed_strips() -> tuple[GroundRegion, ...]:
    """30 m of pavement cut every 0.7-1.3 m, each seam askew another way."""
    rng = np.random.default_rng(0)
    x = np.concatenate([[0.0], np.cumsum(rng.uniform(0.7, 1.3, 29))])
    lean = np.concatenate([[0.0], rng.uniform(-0.3, 0.3, 28), [0.0]])
    return tuple(
        GroundRegion(
            f"strip_{i}",
            "sidewalk",
            (
                (x[i] - lean[i], 0.0),
                (x[i + 1] - lean[i + 1], 0.0),
                (x[i + 1] + lean[i + 1], 3.0),
                (x[i] + lean[i], 3.0),
            ),
            (0.0, 0.0, 0.15),
        )
        for i in range(29)
    )


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
def test_seams_are_not_felt(drive: Drive) -> None:
    """20 m over prism seams at 1.5 m/s move the body less than 2 mm."""
    robot = make_coco(drive)
    model, _ = _ground(_skewed_strips(), robot)
    route = _straight(model, robot, np.array([1.5, 1.5, 0.15, 0.0]), 1.5, 15.5)
    rolling = route[route[:, 0] > 3.0]
    assert rolling[-1, 0] - rolling[0, 0] > 20.0
    assert np.ptp(rolling[:, 2]) < 0.002
    # Without steering: at a skewed seam a wheel touches two prisms and is pushed aside, by 1 % of the distance in all.
    assert np.ptp(rolling[:, 1]) < 0.01 * np.ptp(rolling[:, 0])


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
def test_kerb_stops_the_robot(drive: Drive) -> None:
    robot = make_coco(drive)
    road = GroundRegion("road", "road", ((0, 0), (6, 0), (6, 4), (0, 4)), (0.0, 0.0, 0.0))
    walk = GroundRegion("walk", "sidewalk", ((6, 0), (10, 0), (10, 4), (6, 4)), (0.0, 0.0, 0.15))
    model, _ = _ground((road, walk), robot)
    route = _straight(model, robot, np.array([3.0, 2.0, 0.0, 0.0]), 0.5, 15.0)
    assert route[-1, 0] < 6.0
    assert route[:, 2].max() < robot.spawn_height + 0.05


@pytest.mark.parametrize("path", GRAPHS, ids=lambda p: p.parent.name)
def test_every_ramp_is_taken_up_and_down(path) -> None:
    """From the crosswalk onto the pavement and back, through every region with a tilted top that is wide enough."""
    controller = make_controller()
    regions = SceneGraph.load(path).ground
    model, space = _ground(regions, controller.robot)
    starts, routes = [], []
    for region in regions:
        slope = np.array(region.plane[:2])
        ring = np.array(region.polygon)
        if region.kind != "sidewalk" or len(ring) < 4 or not slope.any():
            continue
        up = slope / np.linalg.norm(slope)
        reach = np.ptp(ring @ up) / 2 + 1.0
        middle = (ring.min(0) + ring.max(0)) / 2
        for route in (
            np.array([middle - reach * up, middle + reach * up]),
            np.array([middle + reach * up, middle - reach * up]),
        ):
            heading = route[1] - route[0]
            starts.append([*route[0], space.map.height[space.cell(route[0])], np.arctan2(heading[1], heading[0])])
            routes.append(route)
    assert len(routes) >= 8
    drives = drive_all(model, controller, space, np.array(starts), routes)
    assert [d.reason for d in drives] == [""] * len(routes)


def test_a_kerb_in_the_way_fails_the_drive() -> None:
    controller = make_controller()
    low = GroundRegion("low", "sidewalk", ((0, 0), (6, 0), (6, 4), (0, 4)), (0.0, 0.0, 0.0))
    high = GroundRegion("high", "sidewalk", ((6, 0), (12, 0), (12, 4), (6, 4)), (0.0, 0.0, 0.15))
    road = GroundRegion("road", "road", ((0, 4), (12, 4), (12, 8), (0, 8)), (0.0, 0.0, 0.0))
    model, space = _ground((low, high, road), controller.robot)
    places = ((3.0, 0.0), (3.0, 1.5), (1.0, 0.0), (1.03, 0.0), (1.03, 0.0))
    starts = np.array([[x, 2.0, 0.0, yaw] for x, yaw in places])
    routes = [
        np.array([[3.0, 2.0], [9.0, 2.0]]),
        np.array([[3.0, 2.0], [3.0, 6.0]]),
        np.array([[1.0, 2.0], [4.5, 2.0]]),
        np.array([[1.0, 2.0], [1.0 + ARRIVAL_DISTANCE + 0.04, 2.0]]),
        np.array([[1.0, 2.0], [1.0 + ARRIVAL_DISTANCE - 0.04, 2.0]]),
    ]
    drives = drive_all(model, controller, space, starts, routes)
    assert [d.reason for d in drives] == ["stuck", "off the traversable area", "", "", ""]
    assert [d.seconds for d in drives[:2]] == [-1.0, -1.0], "no time of arrival"
    assert drives[2].seconds == pytest.approx(3.0 / 2.0, abs=1.2)
    assert drives[3].seconds > 0.0, "a centimetre too far away to be there already"
    assert drives[4].seconds == 0.0


def test_robots_that_drive_together_drive_as_if_alone() -> None:
    """Those that arrive early, on short paths, leave the others their own paths."""
    controller = make_controller()
    walk = GroundRegion("walk", "sidewalk", ((0, 0), (16, 0), (16, 8), (0, 8)), (0.0, 0.0, 0.0))
    model, space = _ground((walk,), controller.robot)
    starts = np.array([[2.0, 2.0, 0.0, 0.0], [2.0, 4.0, 0.0, 0.0], [2.0, 6.0, 0.0, 0.0]])
    routes = [
        np.array([[2.0, 2.0], [4.0, 2.0]]),
        np.array([[2.0, 4.0], [8.0, 4.0], [8.0, 6.0], [12.0, 6.0]]),
        np.array([[2.0, 6.0], [6.0, 6.0]]),
    ]
    alone = [drive_all(model, controller, space, starts[k : k + 1], [routes[k]])[0] for k in range(3)]
    assert alone[0].seconds < alone[2].seconds < alone[1].seconds
    assert [d.reason for d in alone] == [""] * 3
    assert drive_all(model, controller, space, starts, routes) == alone
