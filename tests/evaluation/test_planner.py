"""The privileged planner: its model of COCO against C MuJoCo, its waypoints, its maps, and that it arrives."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from benchmarks.lib.gait_trials import Judge, Wandering, flat
from tests.support.box_bank import HALF_WIDTH, KERB_Y, LENGTH, box_scene, box_skies
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import GroundRegion, SceneBank
from urbanverse_mjx.envs.navigation.clearance_maps import build_clearance_maps
from urbanverse_mjx.envs.navigation.scenarios import bank_for
from urbanverse_mjx.evaluation import Rollout, fixed_episodes
from urbanverse_mjx.evaluation.planner import (
    _ROWS,
    Planner,
    RouteField,
    _Field,
    _field_at,
    _fill_half_cells,
    footprint,
    motion_of,
    placed,
    waypoint_of,
)
from urbanverse_mjx.evaluation.route_fields import NODE
from urbanverse_mjx.robots import gait_of, load, make_coco
from urbanverse_mjx.robots.waypoint import pd_velocity
from urbanverse_mjx.scene.bank import pack


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
@pytest.mark.parametrize("command", [(2.0, 0.0), (1.0, 0.8), (2.0, 0.5)])
def test_the_model_of_coco_stays_beside_c_mujoco(drive: str, command: tuple[float, float]) -> None:
    """Two seconds after a start from rest: within 0.4 m and 9°, five times as long as a command is held."""
    robot = make_coco(drive)  # type: ignore[arg-type]
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[2] = robot.spawn_height
    motion, (x, y, yaw, v, w) = motion_of(robot), np.zeros(5)
    omega = float(np.clip(command[1], -command[0] * motion.curvature, command[0] * motion.curvature))
    data.ctrl[:] = np.asarray(robot.command(jnp.array([command[0], omega])))
    dt = model.opt.timestep
    for _ in range(round(2.0 / dt)):
        mujoco.mj_step(model, data)
        v += (command[0] - v) * (1.0 - np.exp(-dt / motion.speed_lag))
        w += (omega - w) * (1.0 - np.exp(-dt / motion.turn_lag * (1.0 + v / motion.eases)))
        side = motion.pivot * w
        x, y = x + (v * np.cos(yaw) - side * np.sin(yaw)) * dt, y + (v * np.sin(yaw) + side * np.cos(yaw)) * dt
        yaw += w * dt
    heading = 2.0 * np.arctan2(data.qpos[6], data.qpos[3])
    assert np.hypot(*(data.qpos[:2] - [x, y])) < 0.4
    assert abs(np.arctan2(np.sin(heading - yaw), np.cos(heading - yaw))) < 0.16


def _coco_on(
    slope: tuple[float, float], command: tuple[float, float], seconds: float, drive: str
) -> tuple[float, float]:
    """Speed ahead and yaw rate at the end of C MuJoCo's drive over a plane that rises ahead and to the left."""
    robot = make_coco(drive)  # type: ignore[arg-type]
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    model = spec.compile()
    down = np.array([-slope[0], -slope[1], -1.0])
    model.opt.gravity[:] = 9.81 * down / np.linalg.norm(down)
    data = mujoco.MjData(model)
    data.qpos[2] = robot.spawn_height
    data.ctrl[:] = np.asarray(robot.command(jnp.array(command)))
    mujoco.mj_step(model, data, round(seconds / model.opt.timestep))
    yaw = 2.0 * np.arctan2(data.qpos[6], data.qpos[3])
    return float(data.qvel[:2] @ [np.cos(yaw), np.sin(yaw)]), float(data.qvel[5])


@pytest.mark.parametrize("drive", ["differential", "ackermann"])
@pytest.mark.parametrize("slope", [0.12, 0.06, -0.12])
@pytest.mark.parametrize("speed", [0.0, 0.4, 2.0])
def test_the_model_of_coco_climbs_as_in_c_mujoco(drive: str, slope: float, speed: float) -> None:
    """A ramp of 12 % takes 0.3 m/s of any speed: a command of 0.2 m/s rolls back, as one to stand does."""
    found, _ = _coco_on((slope, 0.0), (speed, 0.0), 3.0, drive)
    motion, pose, v, w = motion_of(make_coco(drive)), np.zeros(3), 0.0, 0.0  # type: ignore[arg-type]
    for _ in range(15):
        pose, v, w = motion.drive(pose, v, w, motion.obeyed(speed, 0.0), 0.2, (slope, 0.0))
    assert float(v) == pytest.approx(found, abs=0.05)


@pytest.mark.parametrize(("left", "omega"), [(-0.12, -1.0), (-0.06, -1.0), (-0.06, 1.0), (0.06, -0.6)])
def test_the_model_of_coco_veers_downhill_as_in_c_mujoco(left: float, omega: float) -> None:
    """A turn on the spot towards the upper side of a ramp of 12 % does not come about."""
    _, found = _coco_on((0.0, left), (0.0, omega), 0.6, "differential")
    motion, pose, v, w = motion_of(make_coco("differential")), np.zeros(3), 0.0, 0.0
    for _ in range(6):
        pose, v, w = motion.drive(pose, v, w, motion.obeyed(0.0, omega), 0.1, (0.0, left))
    assert float(w) == pytest.approx(found, abs=0.25)


#: Robot -> commands at which it walks, those at which it stands, and m, how far off the model may be after 2 s.
GAITS = {
    "go2": (
        [(1.0, 0.0), (0.5, 0.6), (1.0, 1.0), (0.4, 0.0), (0.0, 1.0)],
        [(0.2, 0.25), (0.2, 0.0), (0.0, 0.25)],
        0.1,
    ),
    # Its turns on the spot to the left often fail, and it veers to the right at 1 m/s.
    "mini_cheetah": (
        [(1.0, 0.0), (0.5, 0.6), (1.0, 1.0), (0.4, 0.0), (0.3, -1.0), (0.3, 1.0)],
        [(0.2, 0.25), (0.2, 0.0), (0.0, 0.25), (0.0, -0.25)],
        0.18,
    ),
    "b2": ([(1.0, 0.0), (0.5, 0.6), (1.0, 1.0), (0.4, 0.0), (0.0, 1.0)], [(0.15, 0.0), (0.0, 0.3)], 0.15),
    # It does not turn on the spot.
    "g1": ([(1.0, 0.0), (0.5, 0.6), (0.4, 0.8), (0.75, 0.0)], [(0.2, 0.2), (0.2, 0.0), (0.0, 0.8)], 0.15),
}


@pytest.mark.parametrize("name", GAITS)
def test_the_model_of_a_gait_stays_beside_c_mujoco(name: str) -> None:
    """Two seconds after a start from rest, within 9°; at commands too small to walk, both stand still, if they lean."""
    walking, standing, apart = GAITS[name]
    requested, stand = np.array([*walking, *standing]), len(walking)
    robot = load(name)
    judge, seconds, dt = Judge(robot, gait_of(robot)), 2.0, 0.02
    model = judge.model(flat())
    start = judge.start(model, np.zeros((len(requested), 3)), np.zeros(len(requested)))
    commands = np.stack([requested[:, 0], 0.0 * requested[:, 0], requested[:, 1]], 1)[:, None]
    walked = judge.run(model, start, Wandering(commands), seconds)
    motion, (x, y, yaw, v, w) = motion_of(robot), np.zeros((5, len(requested)))
    goal_v, goal_w = (np.asarray(part) for part in motion.obeyed(requested[:, 0], requested[:, 1]))
    np.testing.assert_array_equal(goal_v[:stand], requested[:stand, 0])
    np.testing.assert_array_equal(np.stack([goal_v, goal_w])[:, stand:], 0.0)
    for _ in range(round(seconds / dt)):
        v += (goal_v - v) * (1.0 - np.exp(-dt / motion.speed_lag))
        w += (goal_w - w) * (1.0 - np.exp(-dt / motion.turn_lag))
        x, y, yaw = x + v * np.cos(yaw) * dt, y + v * np.sin(yaw) * dt, yaw + w * dt
    off = np.hypot(walked.position[:, -1, 0] - x, walked.position[:, -1, 1] - y)[:stand]
    late = np.abs(np.angle(np.exp(1j * (walked.yaw[:, -1] - yaw))))[:stand]
    assert off.max() < apart, off
    assert late.max() < 0.16, late
    # The last half of a second.
    drifted = np.linalg.norm(np.diff(walked.position[stand:, [-26, -1], :2], axis=1), axis=-1)
    twisted = np.abs(np.diff(walked.yaw[stand:, [-26, -1]], axis=1))
    assert drifted.max() < 0.03, drifted
    assert twisted.max() < 0.1, twisted


def test_waypoints_mean_the_command_they_are_made_of() -> None:
    for v in (0.0, 0.4, 1.4, 2.0):
        for w in (-1.0, -0.25, 0.0, 0.6, 1.0):
            point = waypoint_of(jnp.float32(v), jnp.float32(w), 2.0, 0.2)
            assert float(jnp.abs(point).max()) <= 1.0
            found = pd_velocity(point, 0.2, 2.0, 1.0)
            assert found[0] == pytest.approx(v, abs=0.011)
            assert found[1] == pytest.approx(w, abs=1e-3)


def test_coco_covers_its_collision_spheres() -> None:
    body = footprint(make_coco())
    assert body.half_width == pytest.approx(0.346, abs=1e-3)
    assert body.reach == pytest.approx(0.443, abs=1e-3)
    assert (body.discs[:, 0] + body.discs[:, 2]).max() == pytest.approx(0.353, abs=1e-3)
    assert len(body.feet) == 4


def test_clearance_maps_hold_where_hulls_stand(small_bank: SceneBank) -> None:
    maps = build_clearance_maps(small_bank, [0], 1.0)
    hull, position = small_bank.inst_hull[0], small_bank.inst_position[0]
    rotation = small_bank.inst_rotation[0]
    checked = 0
    for q in np.flatnonzero(hull >= 0):
        corners = small_bank.hull_vertices[hull[q], : small_bank.hull_num_vertices[hull[q]]]
        middle = (corners @ rotation[q].T + position[q])[:, :2].mean(0)
        i, j = np.floor((middle - maps.origin[0]) / 0.05).astype(int)
        if min(i, j) >= 0 and i < maps.to_hull.shape[1] and j < maps.to_hull.shape[2]:
            assert maps.to_hull[0, i, j] < 0.0
            checked += 1
    assert checked > 20
    starts = small_bank.episode_start[0, : small_bank.num_episodes[0], :2]
    i, j = np.floor((starts - maps.origin[0]) / 0.05).astype(int).T
    assert maps.to_hull[0, i, j].min() > 0.3
    assert maps.to_edge[0, i, j].min() > 0.3


def _dropped_kerb(lip: float, slope: float, shift: float) -> SceneBank:
    """A crosswalk at y < shift and a ramp that begins `lip` m above it, rises by `slope` and ends 1 m on."""

    def box(name: str, kind: str, y0: float, y1: float, plane: tuple[float, float, float]) -> GroundRegion:
        return GroundRegion(name, kind, ((0.0, y0), (LENGTH, y0), (LENGTH, y1), (0.0, y1)), plane)

    top = lip + slope
    regions = [
        box("crossing", "crosswalk", -HALF_WIDTH, shift, (0.0, 0.0, 0.0)),
        box("ramp", "sidewalk", shift, shift + 1.0, (0.0, slope, lip - slope * shift)),
        box("walk", "sidewalk", shift + 1.0, HALF_WIDTH, (0.0, 0.0, top)),
    ]
    return pack([box_scene(0, num_objects=1, regions=regions)], ["train"], box_skies())


@pytest.mark.parametrize("shift", [0.0, 0.013, 0.025, 0.049])
@pytest.mark.parametrize(("lip", "slope", "edge"), [(0.02, 1 / 8, False), (0.03, 1 / 8, False), (0.04, 0.0, True)])
def test_a_dropped_kerb_is_no_edge_and_a_low_kerb_is(lip: float, slope: float, edge: bool, shift: float) -> None:
    """Wherever the border lies in a cell. In cells of 10 cm the lip of 3 cm would be an edge."""
    bank = _dropped_kerb(lip, slope, shift)
    maps = build_clearance_maps(bank, [0], 1.0)
    i, low, high = (
        int((at - start) / 0.05)
        for at, start in ((3.0, maps.origin[0, 0]), (-0.5, maps.origin[0, 1]), (1.5, maps.origin[0, 1]))
    )
    across = maps.to_edge[0, i, low:high].astype(float)
    if edge:
        assert (across < 0.0).sum() == 2
        border = maps.origin[0, 1] + (low + np.flatnonzero(across < 0.0).mean() + 0.5) * 0.05
        assert border == pytest.approx(shift, abs=0.05)
    else:
        assert across.min() > 0.9


def test_padding_a_bank_changes_no_clearance(small_bank: SceneBank) -> None:
    """A bank's maps are padded to those of its largest scene."""
    alone = build_clearance_maps(small_bank, [0], 1.0)
    kinds = np.pad(small_bank.map_kind, ((0, 0), (0, 90), (0, 70)))
    joined = build_clearance_maps(dataclasses.replace(small_bank, map_kind=kinds), [0], 1.0)
    x, y = alone.to_edge.shape[1:]
    assert joined.to_edge.shape[1:] > (x, y)
    for name in ("to_hull", "to_edge"):
        np.testing.assert_array_equal(getattr(joined, name)[0, :x, :y], getattr(alone, name)[0])
    assert (joined.to_edge[0, x + 20 :] == -1.0).all()
    assert (joined.to_edge[0, :, y + 20 :] == -1.0).all()
    assert (joined.to_edge[0] > 0.0).any()


def _flank(small_bank: SceneBank) -> tuple[Planner, np.ndarray]:
    """A planner on the first box street, and the middle of the border between its left ramp and the pavement, where the
    ramp is half as high: the pavement is 7.5 cm higher at x < 28 m."""
    env = unicycle_env(bank_for("clean", small_bank))
    return Planner(env), np.array([28.0, KERB_Y + 0.75])


@pytest.mark.extended
def test_no_kerb_is_under_the_trunk(small_bank: SceneBank) -> None:
    """Astride of a flank, no foot is near it; the trunk would touch it."""
    planner, border = _flank(small_bank)
    astride = jnp.asarray([*border, np.pi / 2], jnp.float32)
    beside = jnp.asarray([border[0] + 0.6, border[1], np.pi / 2], jnp.float32)
    feet = planner._to_edge.at(0, *placed(astride, planner._body.feet))
    assert float(feet.min()) > 0.1
    assert float(planner._gap(0, astride)) < 0.0
    assert float(planner._gap(0, beside)) > 0.1


@pytest.mark.extended
def test_no_edge_lies_between_two_predictions(small_bank: SceneBank) -> None:
    """At 2 m/s they are 0.6 m apart; a planner that could jump over an edge would wait for that for ever."""
    planner, border = _flank(small_bank)
    for first in np.arange(0.0, 0.6, 0.02):
        path = [jnp.asarray([border[0] + first + 0.6 * k, border[1], np.pi], jnp.float32) for k in range(-2, 3)]
        assert min(float(planner._gap(0, pose)) for pose in path) < 0.02


def test_the_planner_looks_not_across_an_edge(small_bank: SceneBank) -> None:
    """A field that falls behind a flank tempts no robot in front of it; beside the flank it does."""
    planner, border = _flank(small_bank)
    nodes = np.arange(120) * 0.1
    cost = jnp.asarray(np.where(nodes[:, None] > 1.95, 20.0, 10.0) + np.zeros((120, 120)), jnp.float32)
    route = RouteField(jnp.asarray(border - [2.0, 6.0], jnp.float32), cost)
    for y, expected in ((border[1], 20.0), (border[1] + 1.8, 10.0)):
        pose = jnp.asarray([border[0] + 0.45, y, np.pi], jnp.float32)
        here = _field_at(route, pose, 0.0)
        assert float(here) == pytest.approx(20.0)
        assert float(planner._nose(0, route, pose, here)) == pytest.approx(expected)


def test_the_planner_knows_the_slope(small_bank: SceneBank) -> None:
    """The left ramp of the crossing rises by 0.15 m in 1.5 m along y."""
    planner, _ = _flank(small_bank)
    on_ramp = np.array([30.0, KERB_Y + 0.75])
    for yaw in (np.pi / 2, 0.0, 2.0):
        ahead, left = planner._slope(0, jnp.asarray([*on_ramp, yaw], jnp.float32))
        assert float(ahead) == pytest.approx(0.1 * np.sin(yaw), abs=0.01)
        assert float(left) == pytest.approx(0.1 * np.cos(yaw), abs=0.01)
    assert planner._slope(0, jnp.asarray([20.0, KERB_Y + 2.0, 0.3], jnp.float32)) == (0.0, 0.0)


@pytest.mark.extended
def test_a_plan_to_wait_begins_at_once_among_still_things(small_bank: SceneBank) -> None:
    """The robot stands, and to wait and then drive straight on is the cheapest plan: it would wait in every step."""
    env = unicycle_env(bank_for("clean", small_bank))
    planner = Planner(env)
    route = jax.tree.map(lambda x: x[0], planner.prepare(np.zeros(1, np.int32), np.zeros(1, np.int32)))
    start = np.asarray(env.bank.episode_start[0, 0])
    state = jnp.asarray([start[0], start[1], start[3], 0.0, 0.0], jnp.float32)
    real = np.asarray(planner.costs(jnp.int32(0), state, route, None))
    waiting = int(np.abs(np.asarray(planner.first)).sum(1).argmin())
    onwards = int(real[waiting].argmin())
    costs = jnp.asarray(real).at[waiting, onwards].set(real.min() - 1.0)
    for moved, begins in ((state, True), (state.at[3].set(0.5), False)):
        command, cost = planner._at_once(jnp.int32(0), moved, route, None, costs)
        assert bool(np.isfinite(cost)) == begins
        if begins:
            assert float(np.abs(command).max()) > 0.2
            assert float(cost) == pytest.approx(float(costs.min()), abs=0.01)
            assert float(cost) < float(costs.min())
    assert not np.isfinite(planner._at_once(jnp.int32(0), state, route, None, jnp.asarray(real))[1]), "it need not wait"


class _Graded(Planner):
    """As `SignalPlanner` weighs nearness to agents."""

    BEGINS_AMONG_AGENTS = True
    AGENT_DEPTH = 2.0


@pytest.fixture(scope="module")
def by_class(small_bank: SceneBank) -> dict[type[Planner], tuple[Planner, RouteField, np.ndarray]]:
    """Planner, route and start (x, y, heading) of the same episode."""
    env = unicycle_env(bank_for("clean", small_bank))
    found = {}
    for kind in (Planner, _Graded):
        planner = kind(env)
        route = jax.tree.map(lambda x: x[0], planner.prepare(np.zeros(1, np.int32), np.zeros(1, np.int32)))
        found[kind] = planner, route, np.asarray(env.bank.episode_start[0, 0])[[0, 1, 3]]
    return found


def _standing_and_ahead(planner: Planner, costs: Any) -> tuple[float, float]:
    """Least costs to stand first, and to drive straight on at full speed first."""
    first = np.asarray(planner.first)
    stand, ahead = int(np.abs(first).sum(1).argmin()), int((first[:, 0] - np.abs(first[:, 1])).argmax())
    return float(costs[stand].min()), float(costs[ahead].min())


def _person(start: np.ndarray, ahead: float) -> Any:
    """(1, 6), somebody who stands in front of a robot's centre; see `Planner._agents`."""
    place = start[:2] + ahead * np.array([np.cos(start[2]), np.sin(start[2])])
    return jnp.asarray([[*place, 0.0, 0.0, 0.3, 1.0]], jnp.float32)


@pytest.mark.extended
def test_a_robot_too_near_to_somebody_does_not_come_nearer(by_class: Any) -> None:
    """All commands come too near: contact alone prefers to drive through, the depth to stand."""
    for kind, stands in ((Planner, False), (_Graded, True)):
        planner, route, start = by_class[kind]
        state = jnp.asarray([*start, 0.0, 0.0], jnp.float32)
        stand, ahead = _standing_and_ahead(planner, planner.costs(jnp.int32(0), state, route, _person(start, 0.7)))
        assert min(stand, ahead) > 1000.0
        assert (stand < ahead) == stands


@pytest.mark.extended
def test_contact_with_the_street_counts_beside_that_with_agents(small_bank: SceneBank, by_class: Any) -> None:
    """Over the edge of a kerb, with somebody too near behind."""
    _, border = _flank(small_bank)
    start = np.array([border[0] - 1.0, border[1], 0.0])
    state = jnp.asarray([*start, 2.0, 0.0], jnp.float32)
    more = {}
    for kind in (Planner, _Graded):
        planner, route, _ = by_class[kind]
        for name, agents in (("alone", None), ("among", _person(start, -0.3))):
            costs = np.asarray(planner.costs(jnp.int32(0), state, route, agents))
            more[kind, name] = float(costs.max() - costs.min())
    assert more[Planner, "alone"] == more[_Graded, "alone"] > 900.0
    assert more[Planner, "among"] < 900.0
    assert more[_Graded, "among"] > 900.0


@pytest.mark.extended
def test_a_plan_to_wait_begins_among_agents_unless_one_is_in_the_way(by_class: Any) -> None:
    planner, route, start = by_class[_Graded]
    state = jnp.asarray([*start, 0.0, 0.0], jnp.float32)
    for metres, begins in ((-5.0, True), (1.2, False)):
        agents = _person(start, metres)
        real = np.asarray(planner.costs(jnp.int32(0), state, route, agents))
        waiting = int(np.abs(np.asarray(planner.first)).sum(1).argmin())
        after = np.asarray(planner._after)
        onwards = int((after[:, 0] - np.abs(after[:, 1])).argmax())
        costs = jnp.asarray(real).at[waiting, onwards].set(min(real.min() - 1.0, 5.0))
        assert bool(np.isfinite(planner._at_once(jnp.int32(0), state, route, agents, costs)[1])) == begins


def test_a_field_without_its_padding_has_the_same_values_everywhere() -> None:
    """Two scenes of different size, padded to the larger; inside, in the padding and outside the map."""
    rng = np.random.default_rng(0)
    padded = np.full((3, 40, 30), 1.0, np.float16)
    for scene, (x, y) in {0: (40, 12), 2: (9, 30)}.items():
        padded[scene, :x, :y] = rng.uniform(-0.5, 1.0, (x, y))
    origin = np.array([(-3.0, 2.0), (0.0, 0.0), (1.0, 1.0)])
    field = _Field.of(padded, [0, 2], origin, 1.0)
    assert field.values.size < padded[[0, 2]].size * 4 // 2  # half cells
    whole = _Field.of(padded, [0, 2], origin, np.nan)
    assert whole.values.size == padded[[0, 2]].size * 4
    xy = rng.uniform(-1.0, 4.0, (5000, 2)) + origin[0]
    for scene in (0, 2):
        x, y = (xy - origin[0] + origin[scene]).T.astype(np.float32)
        np.testing.assert_array_equal(field.at(scene, x, y), whole.at(scene, x, y))
        # Against the cells themselves, from which the interpolation differs by less than two neighbours do.
        inside = (x > origin[scene, 0] + 0.1) & (y > origin[scene, 1] + 0.1)
        i, j = ((np.stack([x, y], -1)[inside] - origin[scene]) / 0.05).astype(int).T
        seen = (i < 39) & (j < 29)
        around = np.stack([padded[scene, i[seen] + a, j[seen] + b] for a in (-1, 0, 1) for b in (-1, 0, 1)])
        found = np.asarray(field.at(scene, x, y))[inside][seen]
        assert (found >= around.min(0) - 1e-3).all()
        assert (found <= around.max(0) + 1e-3).all()
        assert seen.sum() > 400


@pytest.mark.parametrize("shape", [(2, 2), (3, 70), (70, 3), (2 * _ROWS + 1, 5)])
def test_a_field_is_interpolated_linearly_at_the_centres_of_quarter_cells(shape: tuple[int, int]) -> None:
    """Against NumPy's interpolation along each axis, also where rows are interpolated in several parts."""
    cells = np.random.default_rng(0).uniform(-1.0, 1.0, shape).astype(np.float16)
    fine = np.empty((2 * shape[0], 2 * shape[1]), np.int16)
    _fill_half_cells(cells, fine)
    at = [(np.arange(2 * n) + 0.5) / 2 - 0.5 for n in shape]
    rows = np.stack([np.interp(at[0], np.arange(shape[0]), column) for column in cells.T.astype(float)], 1)
    both = np.stack([np.interp(at[1], np.arange(shape[1]), row) for row in rows])
    np.testing.assert_allclose(fine, 1000.0 * both, atol=0.51)


@pytest.mark.extended
def test_it_reaches_every_goal_of_a_free_scene(small_bank: SceneBank) -> None:
    env = unicycle_env(bank_for("clean", small_bank))
    results, _ = Rollout(env).run({"planner": Planner(env)}, fixed_episodes(env, 6))
    assert [r.result for r in results] == ["goal"] * 6
    assert all(r.path_length < 1.3 * r.route_length + 1.0 for r in results)


def test_a_widened_window_has_the_same_costs_everywhere(small_bank: SceneBank) -> None:
    """Also beyond the window, where the costs are those of its border."""
    env = unicycle_env(small_bank)
    planner, rows = Planner(env), np.array([0, 1], np.int32)
    narrow = planner.prepare(np.array([0, 1], np.int32), rows)
    narrow = narrow._replace(cost=narrow.cost[:, :-7, :-5])  # smaller than any map
    wide = planner.widened(narrow)
    assert wide.cost.shape[1:] == tuple(np.array(planner._maps.to_hull.shape[1:]) // 2)
    assert (np.array(wide.cost.shape) > narrow.cost.shape)[1:].all()
    size = np.array(narrow.cost.shape[1:]) * NODE
    points = narrow.origin[:, None] + np.random.default_rng(0).uniform(-0.3, 1.3, (2, 200, 2)) * size
    of = jax.vmap(lambda route, points: jax.vmap(route.at)(points))
    known, found = of(narrow, jnp.asarray(points)), of(wide, jnp.asarray(points))
    np.testing.assert_allclose(found, known, rtol=1e-5, atol=2e-3)  # the border is at a thousandth of a node
    assert np.ptp(np.asarray(known)) > 5.0


@pytest.mark.extended
def test_it_stands_rather_than_touch(small_bank: SceneBank) -> None:
    """Dropped in front of a wall at full speed, with every path ahead barred, it brakes."""
    env = unicycle_env(small_bank)
    planner, episodes = Planner(env), fixed_episodes(env, 1)
    route = jax.tree.map(lambda x: x[0], planner.prepare(episodes.scenes, episodes.episodes))
    state = jnp.asarray(np.append(small_bank.episode_start[0, 0, :2], [0.0, 2.0, 0.0]), jnp.float32)
    agents = jnp.array([[*(np.asarray(state[:2]) + [2.2, 0.0]), 0.0, 0.0, 1.0, 1.0]])
    costs = np.asarray(planner.costs(0, state, route, agents))
    fast = costs[np.asarray(planner.first[:, 0]) == 2.0].min()
    still = costs[np.asarray(planner.first[:, 0]) == 0.0].min()
    assert still < fast
    assert still < 1000.0 <= fast
