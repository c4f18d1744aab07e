"""Objects beside the route: where they may stand, that every episode has others, and that they are seen and touched."""

import itertools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.datatypes import Bodies, SceneBank, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.envs.heights import GroundHeights
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.clearance_maps import build_clearance_maps
from urbanverse_mjx.envs.navigation.clutter import (
    END_CLEARANCE,
    GROUND_CELL,
    MIN_GAP,
    MIN_SOURCE_DISTANCE,
    RIM,
    ROUTE_MARGIN,
    Clutter,
)
from urbanverse_mjx.envs.navigation.movables import body_sizes
from urbanverse_mjx.envs.navigation.surroundings import Surroundings
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.collision_slots.body_table import body_table

NUMBER, EPISODES = 6, 200


@pytest.fixture(scope="module")
def clutter(small_bank: SceneBank) -> Clutter:
    robot = make_coco()
    return Clutter(
        small_bank, body_table(small_bank).row, NUMBER, robot, Surroundings(small_bank, robot.planner_height)
    )


def rows_of(bank: SceneBank) -> tuple[np.ndarray, np.ndarray]:
    """Scenes and rows of EPISODES episodes of all scenes."""
    scenes = np.arange(EPISODES) % bank.num_scenes
    return scenes, (np.arange(EPISODES) // bank.num_scenes) % bank.num_episodes[scenes]


Drawn = Callable[[int], tuple[Bodies, Bodies]]


@pytest.fixture(scope="module")
def drawn(small_bank: SceneBank, clutter: Clutter) -> Drawn:
    """Seed -> of `EPISODES` episodes: the chosen objects in their places of the bank, and beside the route."""
    bank, (scenes, rows) = small_bank, rows_of(small_bank)
    start, goal = bank.episode_start[scenes, rows, :3], bank.episode_goal[scenes, rows]
    waypoints = bank.episode_waypoints[scenes, rows]

    def one(key: Any, scene: Any, start: Any, goal: Any, waypoints: Any) -> tuple[Bodies, Bodies]:
        chosen = clutter.choose(key, scene, start, waypoints)
        slot = jnp.maximum(chosen, 0)
        place, turn = (jnp.asarray(x)[scene, slot] for x in (bank.slot_position, bank.slot_quaternion))
        home = Bodies(chosen, place, turn, place * 0, place * 0, jnp.zeros((NUMBER, 6)))
        return home, clutter.place(key, scene, start, goal, waypoints, home)

    program = jax.jit(jax.vmap(one))
    return lambda seed: program(
        jax.random.split(jax.random.key(seed), EPISODES), jnp.asarray(scenes), start, goal, waypoints
    )


@pytest.mark.extended
def test_they_stand_beside_the_route_and_touch_nothing(small_bank: SceneBank, clutter: Clutter, drawn: Drawn) -> None:
    """Judged by exact outlines of the hulls and by the points of the route, without the class's own fields."""
    robot, bank = make_coco(), small_bank
    home, placed = (jax.tree.map(np.asarray, x) for x in drawn(0))
    moved = np.linalg.norm(placed.position - home.position, axis=-1) > 1e-3
    assert moved.mean() > 0.3, "some streets are narrow, but not all"
    maps = build_clearance_maps(bank, range(bank.num_scenes), robot.planner_height)
    scene_of = []
    for e, (z, row) in enumerate(zip(*rows_of(bank), strict=True)):
        route = np.concatenate([bank.episode_start[z, row, None, :3], bank.episode_waypoints[z, row]])[:, :2]
        fine = np.concatenate([np.linspace(a, b, 80) for a, b in itertools.pairwise(route)])
        ends = np.stack([route[0], bank.episode_goal[z, row, :2]])
        present = home.object_index[e] >= 0
        assert len(set(home.object_index[e][present].tolist())) == present.sum(), "no object twice"
        away = np.linalg.norm(home.position[e][present][:, None, :2] - fine, axis=-1).min(-1)
        assert (away > MIN_SOURCE_DISTANCE - 0.1).all(), "taken from where nobody drives"
        places = []
        for m in np.flatnonzero(moved[e]):
            p, r = placed.position[e, m, :2], float(clutter._radius[z, home.object_index[e, m]])
            assert r > 0.05
            assert np.linalg.norm(fine - p, axis=1).min() >= robot.planner_radius + ROUTE_MARGIN + r - 0.02
            assert np.linalg.norm(ends - p, axis=1).min() >= robot.planner_radius + r + END_CLEARANCE
            cell = tuple(np.floor((p - maps.origin[z]) / 0.05).astype(int))
            # Half a cell of 0.2 m in the class's fields, which hold boxes around the hulls, and 0.05 m in the map here.
            assert maps.to_hull[z][cell] >= min(r + MIN_GAP - 0.2, 0.95)
            assert maps.to_edge[z][cell] >= min(r + MIN_GAP - 0.2, 0.95)
            assert all(np.linalg.norm(p - q) >= r + other + MIN_GAP - 1e-4 for q, other in places)
            places.append((p, r))
            scene_of.append(z)
    # As high above the ground as before, exactly in the class's cells; a kerb between cells is 0.1 m.
    for ground, error in ((GroundHeights(bank, GROUND_CELL), 1e-4), (GroundHeights(bank), 0.02)):
        look_up = jax.jit(jax.vmap(ground))
        above, wanted = (
            x[moved][:, 2] - look_up(np.array(scene_of), x[moved][:, :2]) for x in (placed.position, home.position)
        )
        np.testing.assert_allclose(above, wanted, rtol=0.0, atol=error)
    still = home.object_index[~moved] >= -1
    np.testing.assert_array_equal(placed.quaternion[~moved][still], home.quaternion[~moved][still])


def test_a_kerb_in_any_direction_cuts_off_a_point_of_the_rim() -> None:
    """Points of the unit circle; a straight kerb at 98 % of its radius, in 720 directions."""
    np.testing.assert_allclose(np.linalg.norm(RIM, axis=-1), 1.0, rtol=1e-12)
    angle = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    farthest = (RIM @ np.stack([np.cos(angle), np.sin(angle)])).max(0)
    assert farthest.min() > 0.98


def test_every_episode_has_others(drawn: Drawn) -> None:
    (home, placed), (other_home, other) = drawn(0), drawn(1)
    assert (np.asarray(home.object_index) != np.asarray(other_home.object_index)).any(-1).mean() > 0.9
    assert (np.asarray(placed.position) != np.asarray(other.position)).any((-1, -2)).mean() > 0.9
    again = drawn(0)[1]
    np.testing.assert_array_equal(placed.position, again.position)


def test_distances_hold_them(clutter: Clutter, drawn: Drawn) -> None:
    """Against a loop over circles."""
    _, placed = drawn(0)
    rng = np.random.default_rng(0)
    one = jax.tree.map(lambda x: x[0], placed)
    points = np.asarray(one.position)[rng.integers(0, NUMBER, 40), :2] + rng.normal(0.0, 1.0, (40, 2))
    before = jnp.asarray(rng.uniform(0.0, 2.55, (40, 2)), jnp.float32)
    found = np.asarray(clutter.nearer(before, jnp.int32(0), one, jnp.asarray(points, jnp.float32)))
    wanted = np.asarray(before).copy()
    for k, p in zip(np.asarray(one.object_index), np.asarray(one.position), strict=True):
        if k >= 0:
            circle = np.maximum(np.linalg.norm(points - p[:2], axis=1) - float(clutter._radius[0, k]), 0.0)
            wanted[:, 0] = np.minimum(wanted[:, 0], circle)
    np.testing.assert_allclose(found, wanted, atol=1e-4)
    assert (found[:, 0] < np.asarray(before)[:, 0]).any()


def test_distance_to_the_route_is_that_of_its_pieces() -> None:
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [4.0, 3.0]])
    points = np.array([[2.0, 1.0], [5.0, 2.0], [-3.0, 4.0], [4.0, 7.0]])
    np.testing.assert_allclose(
        terms.distance_to_route(jnp.asarray(points), jnp.asarray(corners)), [1.0, 1.0, 5.0, 4.0], rtol=1e-6
    )


@pytest.mark.extended
def test_the_robot_sees_and_touches_them_where_they_stand(small_bank: SceneBank) -> None:
    """Driven straight at an object of the clutter: it is what is hit, and what is seen before."""
    overrides = {"preset": "cpu", "scenes": "all", "randomization.clutter": 4, "impl": "warp"}
    env = registry.load("CocoNav", config_overrides=overrides, bank=small_bank)
    assert env.clutter is not None
    nav = jax.jit(jax.vmap(env.begin))(jax.random.split(jax.random.key(3), 12))
    assert nav.sim.bodies is not None
    place, objects, scene = (
        np.asarray(x) for x in (nav.sim.bodies.position, nav.sim.bodies.object_index, nav.sim.scene)
    )
    home = small_bank.slot_position[scene[:, None], np.maximum(objects, 0)]
    moved = np.linalg.norm(place - home, axis=-1) > 0.01
    assert moved.any(1).sum() >= 6
    first = moved.argmax(1)
    middle, target = (np.take_along_axis(x, first.reshape(-1, *[1] * (x.ndim - 1)), 1)[:, 0] for x in (place, objects))
    radius = np.asarray(env.clutter._radius)[scene, np.maximum(target, 0)]
    # To its west, with 0.3 m between the circles, facing it.
    qpos = np.array(nav.sim.qpos)
    qpos[:, 0] = middle[:, 0] - radius - env.robot.planner_radius - 0.3
    qpos[:, 1], qpos[:, 3:7] = middle[:, 1], [1.0, 0.0, 0.0, 0.0]
    begun = jax.vmap(env.engine.init)(
        nav.sim.scene, jnp.asarray(qpos), jnp.zeros_like(nav.sim.qvel), nav.sim.bodies.object_index
    )
    nav = nav._replace(sim=begun._replace(bodies=nav.sim.bodies))
    without = nav._replace(sim=nav.sim._replace(bodies=begun.bodies))
    observe = jax.jit(jax.vmap(env.observe))
    frames = [np.asarray(observe(x)["pixels/front"], np.int32) for x in (nav, without)]
    differs = (np.abs(frames[0] - frames[1]).max(-1) > 8).mean((1, 2))
    step = jax.jit(jax.vmap(lambda x: env.advance(x, jnp.array([1.0, 0.0]))[0]))
    hit = np.full(len(target), -1)
    for _ in range(8):
        nav = step(nav)
        touched = np.asarray(nav.sim.contacts.hit_object)
        hit = np.where(hit < 0, touched, hit)
    there = moved.any(1)
    # Something else of the street may stand between, in the few envs where the west side is not the route's.
    assert (hit[there] == target[there]).mean() >= 0.6
    assert (differs[there & (hit == target)] > 0.02).all(), "it fills part of the image"


def test_sizes_of_the_body_slots() -> None:
    config = registry.get_default_config("CocoNav", "fast")
    assert body_sizes(config) is None
    assert body_sizes(registry.with_overrides(config, {"randomization.clutter": 2})) == {
        "bodies": 2,
        "awake": 2,
        "hulls": 4,
    }
    for wrong in ({"randomization.clutter": -1}, {"randomization.clutter": 1, "scenario": "dynamic"}):
        with pytest.raises(ValidationError, match=r"config\.randomization\.clutter"):
            body_sizes(registry.with_overrides(config, wrong))
