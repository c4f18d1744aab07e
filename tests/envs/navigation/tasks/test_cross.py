"""`CrossStreet`: its routes, traffic, near misses, stops and scores, its planner, and configurations that are refused.

The box streets have a road of 8 m along x with a crosswalk at x 28 to 32; lanes are 1.75 m from its middle.
"""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from tests.support.task_figures import check_task
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import KIND_INDEX, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env
from urbanverse_mjx.envs.navigation.tasks import carriageways
from urbanverse_mjx.envs.navigation.tasks.config import cross_street_config
from urbanverse_mjx.envs.navigation.tasks.cross import CrossState, CrossStreet
from urbanverse_mjx.envs.navigation.tasks.traffic import HALF_LENGTH, OPTIONS, RobotOnRoad, Traffic, following
from urbanverse_mjx.evaluation.agents import go_to_goal
from urbanverse_mjx.evaluation.gap_agent import GapAcceptor
from urbanverse_mjx.evaluation.task_agents import baseline_of, planner_of

#: Three vehicles on each lane.
FEW = {"crowd.slots.car": 6}
#: m, half of a car's width (kinds.py), the radius of the disc around COCO, and how far the lanes are from the middle.
HALF_WIDTH, ROBOT, OFFSET = 0.88, 0.443, 1.75
#: m, far away.
FAR = 1e4


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():
        return unicycle_env(small_bank, {**FEW, "scenes": small_bank.scene_ids[0]}, config=cross_street_config())


@pytest.fixture(scope="module")
def task(env: NavEnv) -> CrossStreet:
    assert isinstance(env.task, CrossStreet)
    return env.task


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))


def test_figures_of_the_task(env: NavEnv, begun: Any) -> None:
    check_task(env, begun)


def lane_of(task: CrossStreet, side: int) -> int:
    """The lane on the south side (0), whose traffic goes east, or on the north side (1)."""
    return int(np.argsort(np.asarray(task.roads.points[0, 0, :, 0, 1]))[side])


def cars_of(task: CrossStreet, cars: list[tuple[int, float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Stations (6,) m and speeds (6,) m/s of cars (side, m of their middle before the crosswalk's, m/s); the others are
    far away."""
    station, speed = np.full(6, -FAR, np.float32), np.zeros(6, np.float32)
    for side in (0, 1):
        lane = lane_of(task, side)
        for k, (_, before, v) in enumerate([car for car in cars if car[0] == side]):
            station[3 * lane + k], speed[3 * lane + k] = float(task.roads.station[0, 0, lane]) - before, v
    return station, speed


def _placed(task: CrossStreet, crowd: Any, station: Any, speed: Any) -> Any:
    zero = jnp.zeros(6)
    placed = task.traffic._placed(crowd, jnp.int32(0), jnp.asarray(station), jnp.asarray(speed))
    return placed._replace(anchor_y=zero, blocked=zero, speed=jnp.full(6, 7.5))


def traffic_of(task: CrossStreet, crowd: Any, cars: list[tuple[int, float, float]]) -> Any:
    """The crowd with the cars of `cars_of`."""
    return _placed(task, crowd, *cars_of(task, cars))


def front_of(task: CrossStreet, crowd: Any) -> float:
    """m of the front of the first car on the south side behind the crosswalk's middle."""
    lane = lane_of(task, 0)
    return float(crowd.anchor_x[3 * lane] - task.roads.station[0, 0, lane]) + HALF_LENGTH


@functools.cache
def _functions(task: CrossStreet) -> tuple[Any, Any]:
    """Compiled, because there are dozens of states: a state of a robot and cars, and the one after a step to it."""

    def state(nav: Any, xy: Any, velocity: Any, station: Any, speed: Any) -> Any:
        sim = nav.sim._replace(xpos=nav.sim.xpos.at[1, :2].set(xy), qvel=nav.sim.qvel.at[:2].set(velocity))
        return nav._replace(sim=sim, crowd=_placed(task, nav.crowd, station, speed))

    def after(nav: Any, *place: Any) -> Any:
        new = state(nav, *place)
        return new._replace(**task.advance(nav, new.sim, new.crowd), steps=nav.steps + 1)

    return jax.jit(state), jax.jit(after)


def state_of(
    task: CrossStreet,
    nav: Any,
    xy: tuple[float, float],
    velocity: tuple[float, float] = (0.0, 0.0),
    cars: list[tuple[int, float, float]] | None = None,
    function: int = 0,
) -> Any:
    """A state with the robot at a point (m) with a velocity (m/s), and cars as in `cars_of`."""
    place = np.array(xy, np.float32), np.array(velocity, np.float32), *cars_of(task, cars or [])
    return _functions(task)[function](nav, *place)


def after(task: CrossStreet, nav: Any, *place: Any, **others: Any) -> Any:
    """The state after a step to `state_of`."""
    return state_of(task, nav, *place, **others, function=1)


# Roads.


def test_lanes_keep_right_and_lead_over_the_crosswalk(small_bank: SceneBank) -> None:
    (road,) = carriageways.roads_of(small_bank, 0)
    east, west = sorted(road.lanes, key=lambda lane: lane[0, 0])
    np.testing.assert_allclose(east[:, 1], -OFFSET, atol=0.06)
    np.testing.assert_allclose(west[:, 1], OFFSET, atol=0.06)
    for lane in (east, west[::-1]):
        np.testing.assert_allclose(np.diff(lane[:, 0]), carriageways.STEP, atol=1e-3)
        assert lane[0, 0] < 2.0
        assert lane[-1, 0] > 58.0
    np.testing.assert_allclose(np.abs(road.across), [0.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(road.half, [4.0, 2.0], atol=0.06)


def test_stations_and_places_are_each_others_inverse(task: CrossStreet) -> None:
    scene, road = jnp.int32(0), jnp.int32(0)
    for lane in (0, 1):
        station = jnp.array([3.3, 17.9, 29.0])
        places, heading = task.roads.at(scene, road, jnp.full(3, lane), station)
        for place, expected in zip(places, station, strict=True):
            found, aside = task.roads.along(scene, road, place)
            assert float(found[lane]) == pytest.approx(float(expected), abs=1e-3)
            assert float(aside[lane]) == pytest.approx(0.0, abs=1e-3)
            assert float(aside[1 - lane]) == pytest.approx(2.0 * OFFSET, abs=0.02)
        east = float(places[1, 0] - places[0, 0]) > 0.0
        np.testing.assert_allclose(np.cos(heading), 1.0 if east else -1.0, atol=1e-3)


def test_routes_lead_straight_over_the_crosswalk_from_pavement_to_pavement(env: NavEnv) -> None:
    bank, scene = env.bank, int(env.scenes[0])
    count = int(bank.num_episodes[scene])
    assert count >= 32
    start, goal = bank.episode_start[scene, :count], bank.episode_goal[scene, :count]
    for ends in (start, goal):
        beyond = np.abs(ends[:, 1]) - 4.0
        assert (beyond > 2.4).all()
        assert (beyond < 6.1).all()
        assert (np.abs(ends[:, 0] - 30.0) < 2.0).all()
    assert (start[:, 1] * goal[:, 1] < 0.0).all()
    assert len(np.unique(np.sign(start[:, 1]))) == 2, "both ways"
    along = goal[:, :2] - start[:, :2]
    np.testing.assert_allclose(start[:, 3], np.arctan2(along[:, 1], along[:, 0]), atol=1e-5)
    np.testing.assert_allclose(bank.episode_length[scene, :count], np.linalg.norm(along, axis=1), rtol=1e-5)


def test_lanes_end_with_the_map(small_bank: SceneBank) -> None:
    """Also where the road does not."""
    (road,) = carriageways.roads_of(small_bank, 0)
    low = np.min([lane.min(0) for lane in road.lanes], 0)
    axis = int(np.ptp(road.lanes[0], axis=0).argmax())
    cut = int((low[axis] + 3.0 - small_bank.map_origin[0, axis]) / small_bank.map_resolution)
    origin = np.array(small_bank.map_origin)
    origin[:, axis] += cut * small_bank.map_resolution
    kinds = small_bank.map_kind[:, cut:] if axis == 0 else small_bank.map_kind[:, :, cut:]
    (shorter,) = carriageways.roads_of(dataclasses.replace(small_bank, map_kind=kinds, map_origin=origin), 0)
    for lane, whole in zip(shorter.lanes, road.lanes, strict=True):
        assert origin[0, axis] <= lane[:, axis].min() < origin[0, axis] + 1.0
        assert lane[:, axis].max() == pytest.approx(whole[:, axis].max(), abs=0.5)


def test_what_stands_in_a_lane_is_taken_away_and_nothing_else(small_bank: SceneBank) -> None:
    roads = {0: carriageways.roads_of(small_bank, 0)}
    there = np.flatnonzero(small_bank.inst_hull[0] >= 0)
    # One object is moved into a lane and another to the middle of the pavement.
    place = np.array(small_bank.inst_position)
    moved, other = small_bank.inst_object[0, there[0]], small_bank.inst_object[0, there[-1]]
    assert moved != other
    place[0, small_bank.inst_object[0] == moved, :2] = (12.0, -OFFSET)
    place[0, small_bank.inst_object[0] == other, :2] = (50.0, 6.0)
    bank = dataclasses.replace(small_bank, inst_position=place)
    found = carriageways.cleared(bank, roads)
    assert moved not in found.inst_object[0]
    assert found.slot_mesh[0, moved] == -1
    assert other in found.inst_object[0]
    assert found.slot_mesh[0, other] == bank.slot_mesh[0, other]
    gone = np.flatnonzero((bank.inst_hull[0] >= 0) & (found.inst_hull[0] < 0))
    assert not np.isin(found.hull_grid[0], gone).any()
    # The others are in the same cells as before.
    for k in np.flatnonzero(found.inst_hull[0] >= 0):
        np.testing.assert_array_equal((found.hull_grid[0] == k).any(-1), (bank.hull_grid[0] == k).any(-1))
    np.testing.assert_array_equal(found.inst_hull[1:], bank.inst_hull[1:])


def test_stripes_vanish_at_the_share_of_the_crosswalks(small_bank: SceneBank) -> None:
    roads = {z: carriageways.roads_of(small_bank, z) for z in range(3)}
    assert [sum(carriageways.marked_roads(roads, share)[z][0] for z in roads) for share in (0.0, 0.4, 1.0)] == [0, 1, 3]
    marked = {0: [False], 1: [True], 2: [True]}
    found = carriageways.unmarked(small_bank, roads, marked)
    categories = [*small_bank.meta["categories"], ""]

    def shape(bank: SceneBank, mesh: int) -> list[np.ndarray]:
        rows = slice(*bank.mesh_vertex_start[mesh : mesh + 2])
        faces = slice(*bank.mesh_face_start[mesh : mesh + 2])
        return [bank.mesh_vertices[rows], bank.mesh_uv[rows], bank.mesh_faces[faces]]

    road = categories.index("ground:road")
    of_road = small_bank.mesh_material[small_bank.slot_mesh[0, small_bank.slot_category[0] == road]]
    for z in roads:
        for slot in np.flatnonzero(small_bank.slot_mesh[z] >= 0):
            old, new = small_bank.slot_mesh[z, slot], found.slot_mesh[z, slot]
            if z or categories[small_bank.slot_category[z, slot]] != "ground:crosswalk":
                assert new == old
                continue
            assert found.mesh_material[new] in of_road
            assert small_bank.mesh_material[old] not in of_road
            for a, b in zip(shape(found, new), shape(small_bank, old), strict=True):
                np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(found.mesh_material[: len(small_bank.mesh_material)], small_bank.mesh_material)


# Traffic.


def test_the_intelligent_driver_model_by_hand() -> None:
    """At its wanted speed on a free road nothing changes; at rest behind what stands 2 m ahead neither."""
    values = following(jnp.array([7.5, 0.0, 0.0]), jnp.full(3, 7.5), jnp.array([jnp.inf, 2.0, jnp.inf]), 0.0)
    np.testing.assert_allclose(values, [0.0, 0.0, 1.0], atol=1e-6)
    # 10 m behind a vehicle as fast: (2 + 5 * 1) / 10, squared, is taken from 1 - (5 / 7.5)^4.
    value = following(jnp.array([5.0]), jnp.array([7.5]), jnp.array([10.0]), 5.0)
    np.testing.assert_allclose(value, [1.0 - (5.0 / 7.5) ** 4 - 0.7**2], atol=1e-6)


def test_vehicles_come_in_the_flow_and_never_touch(task: CrossStreet, begun: Any) -> None:
    traffic, nobody = task.traffic, RobotOnRoad(jnp.full(2, FAR), jnp.full(2, FAR), jnp.bool_(False))

    def run(key: Any) -> Any:
        first = traffic.begin(key, jnp.int32(0), jnp.append(begun.start, 0.0), begun.waypoints, lambda _, p: p)

        def step(crowd: Any, k: Any) -> Any:
            new = traffic.step(crowd, jnp.int32(0), nobody, 0.1, k)
            return new, (new.anchor_x, new.arrived)

        return jax.lax.scan(step, first, jax.random.split(key, 1000))[1]

    station, left = (np.asarray(x) for x in jax.jit(jax.vmap(run))(jax.random.split(jax.random.key(0), 24)))
    for lane in (slice(0, 3), slice(3, 6)):
        gap = np.diff(np.sort(station[..., lane], -1), axis=-1) - 2.0 * HALF_LENGTH
        assert gap.min() > 1.0
    # 24 roads, 2 lanes, 100 s at 400 an hour; a vehicle is slower behind another.
    flow = left[:, -1].sum() / (24 * 2 * 100.0) * 3600.0
    assert 320.0 < flow < 440.0


@pytest.mark.parametrize("marked", [True, False])
def test_drivers_give_way_at_stripes_alone(task: CrossStreet, begun: Any, marked: bool) -> None:
    """A robot waits at the kerb; a car that could stop comes."""
    traffic = _with_marks(task, marked)
    robot = traffic.on_road(begun.crowd, jnp.int32(0), jnp.array([30.0, -6.0]), jnp.float32(np.pi / 2))
    assert bool(robot.crosses)
    assert not bool(traffic.on_road(begun.crowd, jnp.int32(0), jnp.array([30.0, -6.0]), jnp.float32(0.0)).crosses)
    crowd = traffic_of(task, begun.crowd, [(0, 26.0, 7.5)])
    step = jax.jit(lambda crowd: traffic.step(crowd, jnp.int32(0), robot, 0.1, jax.random.key(0)))
    for _ in range(120):
        crowd = step(crowd)
    row, front = 3 * lane_of(task, 0), front_of(task, crowd)
    if marked:
        assert -5.0 < front < -2.0
        assert float(jnp.hypot(crowd.bodies.vx, crowd.bodies.vy)[row]) < 0.3
    else:
        assert int(crowd.arrived[row]) == 1 or front > 20.0


def _with_marks(task: CrossStreet, marked: bool) -> Traffic:
    traffic = object.__new__(Traffic)
    traffic.__dict__ |= task.traffic.__dict__
    traffic.roads = task.roads._replace(marked=jnp.full_like(task.roads.marked, marked))
    return traffic


@pytest.mark.parametrize(("metres", "stops"), [(30.0, True), (10.0, False)])
def test_a_driver_brakes_after_the_reaction_time(task: CrossStreet, begun: Any, metres: float, stops: bool) -> None:
    """At 7.5 m/s a car needs 9.4 m of reaction and 8.3 m of braking for a robot that stands in its lane."""
    traffic = _with_marks(task, False)
    robot = traffic.on_road(begun.crowd, jnp.int32(0), jnp.array([30.0, -OFFSET]), jnp.float32(0.0))
    crowd = traffic_of(task, begun.crowd, [(0, metres + HALF_LENGTH + ROBOT, 7.5)])
    step = jax.jit(lambda crowd: traffic.step(crowd, jnp.int32(0), robot, 0.1, jax.random.key(0)))
    row, speeds, gaps = 3 * lane_of(task, 0), [], []
    for _ in range(60):
        crowd = step(crowd)
        speeds.append(float(jnp.hypot(crowd.bodies.vx, crowd.bodies.vy)[row]))
        gaps.append(-front_of(task, crowd) - ROBOT)
    before = round(OPTIONS.reaction / 0.1) - 1
    assert min(speeds[:before]) > 7.3
    assert speeds[before + 4] < 7.0
    assert (min(gaps) > 0.0) == stops
    assert (min(speeds) < 1.5) == stops


# Scores.


def test_near_misses_by_hand(task: CrossStreet, begun: Any) -> None:
    """A car comes to the robot, which stands in its lane."""
    reach = HALF_LENGTH + ROBOT
    for seconds, missed in ((1.6, 0.0), (1.4, 1.0)):
        nav = after(task, begun, (30.0, -OFFSET), cars=[(0, reach + 8.0 * seconds, 8.0)])
        assert float(nav.task.time) == pytest.approx(seconds, abs=0.02)
        assert float(nav.task.near_misses) == missed
        assert float(task.rewards(begun, nav)["near_miss"]) == missed
        penalty = float(task.rewards(begun, nav)["time_to_collision"])
        assert penalty == pytest.approx(1.0 - seconds / 3.0, abs=0.02)
    # Between the lanes nothing is missed, nor on the pavement, though the robot drives towards the car's way.
    assert float(after(task, begun, (30.0, 0.0), cars=[(0, reach + 8.0, 8.0)]).task.near_misses) == 0.0
    pavement = after(task, begun, (30.0, -4.6), (0.0, 2.0), cars=[(0, reach + 7.0, 8.0)])
    assert float(pavement.task.near_misses) == 0.0


@pytest.mark.parametrize(("steps", "missed"), [(2, 1.0), (6, 0.0)])
def test_post_encroachment_time_by_hand(task: CrossStreet, begun: Any, steps: int, missed: float) -> None:
    """The robot leaves the lane, and a vehicle is at its place some steps of 0.2 s later; or the other way round."""
    here, beside, far = [(0, 0.0, 8.0)], (30.0, 2.0 * OFFSET - 0.2), [(0, 40.0, 0.0)]
    nav = after(task, begun, (30.0, -OFFSET), (0.0, 2.0), cars=far)
    for _ in range(steps - 1):
        nav = after(task, nav, beside, (0.0, 2.0), cars=far)
    nav = after(task, nav, beside, (0.0, 2.0), cars=here)
    assert float(nav.task.post) == pytest.approx(0.2 * steps, abs=1e-5)
    assert float(nav.task.near_misses) == missed
    nav = after(task, begun, beside, (0.0, -2.0), cars=here)
    for _ in range(steps - 1):
        nav = after(task, nav, beside, (0.0, -2.0), cars=[(0, -20.0, 8.0)])
    nav = after(task, nav, (30.0, -OFFSET), (0.0, -2.0), cars=[(0, -20.0, 8.0)])
    assert float(nav.task.post) == pytest.approx(0.2 * steps, abs=1e-5)
    assert float(nav.task.near_misses) == missed


def test_a_near_miss_counts_once(task: CrossStreet, begun: Any) -> None:
    near, far = [(0, 9.0, 6.0)], [(0, 30.0, 2.0)]
    nav, counts = begun, []
    # Two steps near, four of 0.2 s away from it, near again: one miss. Six steps away: another.
    for cars in (near, near, *[far] * 4, near, *[far] * 6, near):
        nav = after(task, nav, (30.0, -OFFSET), cars=cars)
        counts.append(float(nav.task.near_misses))
    assert counts == [1.0] * 13 + [2.0]
    assert float(nav.task.least) < 1.5


def test_stops_count_on_the_road_and_waiting_beside_it(task: CrossStreet, begun: Any) -> None:
    nav = begun
    for xy, velocity, stops, waited in (
        ((30.0, -6.0), (0.0, 0.0), 0.0, 0.2),  # stands at the kerb
        ((30.0, -6.0), (0.0, 0.2), 0.0, 0.4),  # still, until it goes faster than 0.3 m/s
        ((30.0, -5.0), (0.0, 1.0), 0.0, 0.4),
        ((30.0, -3.0), (0.0, 1.0), 0.0, 0.4),
        ((30.0, -2.9), (0.0, 0.05), 1.0, 0.4),  # stops on the road
        ((30.0, -2.9), (0.0, 0.0), 1.0, 0.4),
        ((30.0, -2.8), (0.0, 0.2), 1.0, 0.4),
        ((30.0, -2.8), (0.0, 0.05), 1.0, 0.4),  # it had not gone on
        ((30.0, -2.0), (0.0, 1.0), 1.0, 0.4),
        ((30.0, -1.9), (0.0, 0.0), 2.0, 0.4),
        ((30.0, 5.0), (0.0, 0.0), 2.0, 0.6),
    ):
        new = after(task, nav, xy, velocity)
        assert (float(new.task.stops), float(new.task.waited)) == (stops, pytest.approx(waited))
        assert float(task.rewards(nav, new)["stop"]) == stops - float(nav.task.stops)
        nav = new


@pytest.mark.parametrize(
    ("result", "near_misses", "stops", "seconds", "score"),
    [
        (Result.GOAL, 0, 0, 5.0, 1.0),  # 10 m at 2 m/s
        (Result.GOAL, 0, 0, 14.0, 0.8),  # 9 s of delay
        (Result.GOAL, 1, 2, 14.0, 0.8 * 0.5 * 0.64),
        (Result.GOAL, 0, 0, 55.0, 0.0),
        (Result.HIT_AGENT, 0, 0, 5.0, 0.0),
        (Result.TIMEOUT, 0, 0, 60.0, 0.0),
    ],
)
def test_scores_by_hand(
    task: CrossStreet, begun: Any, result: Result, near_misses: int, stops: int, seconds: float, score: float
) -> None:
    state = begun.task._replace(near_misses=jnp.float32(near_misses), stops=jnp.float32(stops))
    nav = begun._replace(
        task=state, result=jnp.int32(result), steps=jnp.int32(round(seconds / 0.2)), route_length=jnp.float32(10.0)
    )
    found = {name: float(x) for name, x in task.scores(nav).items()}
    assert list(found) == list(task.SCORES)
    assert found["score"] == pytest.approx(score, abs=1e-5)
    assert (found["near_misses"], found["near_miss"], found["stops"]) == (near_misses, near_misses > 0, stops)
    assert (found["seconds"], found["delay"]) == pytest.approx((seconds, seconds - 5.0), abs=1e-4)


def test_the_privileged_vector_tells_of_the_next_vehicles(env: NavEnv, task: CrossStreet, begun: Any) -> None:
    nav = after(task, begun, (30.0, -3.0), cars=[(0, 20.0 + HALF_LENGTH, 5.0), (1, -20.0, 4.0)])
    values = np.asarray(env.observe(nav)["privileged"])[-12:]
    marked = float(task.marked(nav))
    np.testing.assert_allclose([*values[:2], *np.abs(values[2:4])], [marked, 0.1, 0.3, 0.0], atol=6e-3)
    # The southern lane's vehicle is 4 s away at 5 m/s, the northern one's has passed, and the others are far.
    told = values[4:].reshape(2, 2, 2)[[lane_of(task, side) for side in (0, 1)]]
    np.testing.assert_allclose(told[0, 0], [0.4, 5.0 / 8.0], atol=5e-3)
    np.testing.assert_allclose([told[0, 1, 0], *told[1, :, 0]], 1.0)
    assert float(env._proprio(nav)[3]) == marked


# The planner.


def test_the_planner_accepts_gaps_and_no_others(env: NavEnv, task: CrossStreet, begun: Any) -> None:
    planner = planner_of(env)
    assert isinstance(planner, GapAcceptor)
    assert baseline_of(env) == ("go_to_goal", go_to_goal)
    south = begun._replace(start=jnp.array([30.0, -7.0, 0.0]), goal=jnp.array([30.0, 7.0, 0.0]))
    for cars, accepted in (
        ([], True),
        ([(0, 20.0, 7.5)], False),  # is there while the robot crosses
        ([(1, 20.0, 7.5)], False),
        ([(0, -4.0, 7.5)], True),  # has passed
        ([(0, 70.0, 7.5)], True),  # is there in 9 s, before it enters the street
        ([(1, 6.0, 0.0)], True),  # gives way
        ([(1, 0.0, 0.0)], False),  # stands in its path
    ):
        nav = state_of(task, south, (30.0, -6.0), cars=cars)
        assert bool(planner.accepts(nav)) == accepted, cars
    for y, speed in ((-6.0, 0.0), (-5.0, 1.0)):  # waits at the kerb, and never stops on the road
        action = planner.act(state_of(task, south, (30.0, y), cars=[(0, 20.0, 7.5)]))
        assert float(jnp.linalg.norm(action)) == pytest.approx(speed, abs=0.1)


@pytest.mark.slow
def test_the_planner_has_fewer_near_misses_than_the_baseline(env: NavEnv) -> None:
    from urbanverse_mjx.evaluation import Rollout, fixed_episodes

    agents = {"go_to_goal": go_to_goal, "planner": planner_of(env)}
    results, _ = Rollout(env, chunk=20).run(agents, fixed_episodes(env, 40))
    scores = {a: [r.task_scores for r in results if r.agent == a and r.task_scores] for a in agents}
    missed = {a: np.mean([s["near_miss"] for s in rows]) for a, rows in scores.items()}
    assert missed["go_to_goal"] > 0.2
    assert missed["planner"] < 0.25 * missed["go_to_goal"]
    assert np.mean([s["stops"] for s in scores["planner"]]) < 0.05


def test_an_episode_is_the_same_when_it_is_run_again(env: NavEnv) -> None:
    begin = jax.jit(lambda key: env.begin_at(key, jnp.int32(0), jnp.int32(3)))
    first, second = begin(jax.random.key(1)), begin(jax.random.key(1))
    assert isinstance(first.task, CrossState)
    step = jax.jit(lambda nav: env.advance(nav, jnp.array([0.5, 0.1]))[0])
    for _ in range(3):
        first, second = step(first), step(second)
    parts = [jax.tree.leaves((nav.sim, nav.task, nav.crowd)) for nav in (first, second)]
    for a, b in zip(*parts, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.slow
def test_check_env_accepts_it(small_bank: SceneBank) -> None:
    # In several scenes, of which some have stripes.
    check_env(unicycle_env(small_bank, {**FEW, "scenes": "all"}, config=cross_street_config()), num_envs=8, num_steps=6)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.marked": 1.5}, "config.task.marked: found 1.5, needed a share"),
        ({"task.horizon": 1.0}, "config.task.horizon: found 1 s, needed more than the 1.5 s of a near miss"),
        ({"task.flow": 1800.0}, "config.task.flow: found 1800 vehicles per hour and lane, needed"),
        ({"crowd.slots.car": 5}, "config.crowd.slots: found .*'car': 5.*, needed cars alone, an even number from 6"),
        ({"crowd.slots.cyclist": 2}, "needed cars alone"),
        ({"scenario": "static"}, "found 'static' for the task 'cross_street'"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    scenes = {"scenes": small_bank.scene_ids[0]}
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **scenes, **overrides}, config=cross_street_config())


def test_scenes_without_a_road_are_refused_in_a_sentence(small_bank: SceneBank) -> None:
    kinds = np.where(small_bank.map_kind == KIND_INDEX["road"], 0, small_bank.map_kind).astype(np.uint8)
    bank = dataclasses.replace(small_bank, map_kind=kinds)
    with pytest.raises(ValidationError, match="with a crosswalk between pavements over a road with two lanes"):
        unicycle_env(bank, {**FEW, "scenes": bank.scene_ids[0]}, config=cross_street_config())
