"""Starts along the route: free, with the rest of the route, as often as asked for, and the table's where off."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavState, default_config
from urbanverse_mjx.envs.navigation.clearance_maps import build_clearance_maps
from urbanverse_mjx.envs.navigation.draws import Randomization
from urbanverse_mjx.envs.navigation.starts import END_MARGIN, MAX_ROUTE_DISTANCE, MIN_REMAINING_LENGTH, RandomStarts
from urbanverse_mjx.robots import make_coco

NUMBER = 300


def begun(bank: SceneBank, share: float, seed: int = 0) -> tuple[NavState, np.ndarray, np.ndarray]:
    """First states of NUMBER episodes, and their scenes and rows."""
    env = unicycle_env(bank, {"randomization.starts": share})
    scenes = np.arange(NUMBER) % bank.num_scenes
    rows = (np.arange(NUMBER) * 7) % bank.num_episodes[scenes]
    keys = jax.random.split(jax.random.key(seed), NUMBER)
    nav = jax.jit(jax.vmap(env.begin_at))(keys, jnp.asarray(scenes), jnp.asarray(rows))
    return nav, scenes, rows


def test_off_keeps_the_table_s_starts(small_bank: SceneBank) -> None:
    nav, scenes, rows = begun(small_bank, 0.0)
    np.testing.assert_array_equal(nav.start, small_bank.episode_start[scenes, rows, :3])
    np.testing.assert_array_equal(nav.waypoints, small_bank.episode_waypoints[scenes, rows])
    np.testing.assert_array_equal(nav.num_waypoints, small_bank.episode_num_waypoints[scenes, rows])


@pytest.mark.extended
def test_starts_are_free_and_keep_the_rest_of_the_route(small_bank: SceneBank) -> None:
    """Judged on maps of 5 cm, which the class does not use."""
    bank, robot = small_bank, make_coco()
    nav, scenes, rows = begun(bank, 1.0)
    moved = (np.asarray(nav.start) != bank.episode_start[scenes, rows, :3]).any(-1)
    assert moved.mean() > 0.7
    maps = build_clearance_maps(bank, range(bank.num_scenes), robot.planner_height)
    first = bank.episode_start[scenes, rows]
    off_route, on_edge = [], 0
    for e in np.flatnonzero(moved):
        z, table = scenes[e], bank.episode_waypoints[scenes[e], rows[e]]
        start, waypoints, count = np.asarray(nav.start[e]), np.asarray(nav.waypoints[e]), int(nav.num_waypoints[e])
        cell = tuple(np.floor((start[:2] - maps.origin[z]) / 0.05).astype(int))
        # Half a cell of 0.05 m; these maps end at 1 m.
        assert maps.to_hull[z][cell] >= min(robot.planner_radius + END_MARGIN - 0.05, 0.95)
        on_edge += bool(maps.to_edge[z][cell] < min(robot.planner_radius + END_MARGIN - 0.05, 0.95))
        passed = int(bank.episode_num_waypoints[z, rows[e]]) - count
        np.testing.assert_array_equal(waypoints[:count], table[passed : passed + count])
        assert (waypoints[count:] == waypoints[count - 1]).all(), "the goal repeats"
        np.testing.assert_array_equal(waypoints[count - 1], nav.goal[e])
        # The piece of the route it stands beside ends at the first waypoint that is left.
        begin = first[e, :3] if passed == 0 else table[passed - 1]
        span = table[passed] - begin
        share = (start - begin)[:2] @ span[:2] / (span[:2] @ span[:2])
        assert -1e-3 <= share <= 1.0 + 1e-3
        off_route.append(np.linalg.norm((start - begin)[:2] - share * span[:2]))
        assert start[2] == pytest.approx(begin[2] + share * span[2], abs=1e-3)
        left = np.linalg.norm(np.diff(np.concatenate([start[None], waypoints])[:, :2], axis=0), axis=1).sum()
        assert left >= MIN_REMAINING_LENGTH - 2 * MAX_ROUTE_DISTANCE
        assert float(nav.route_length[e]) == pytest.approx(left, rel=1e-4)
    # Kerbs between two kinds of walkable ground, which only these maps hold.
    assert on_edge <= 0.02 * moved.sum()
    assert max(off_route) <= MAX_ROUTE_DISTANCE + 1e-3
    assert np.mean(off_route) > 0.2


@pytest.mark.extended
def test_the_share_and_the_heading_are_drawn(small_bank: SceneBank) -> None:
    nav, scenes, rows = begun(small_bank, 0.5)
    always, _, _ = begun(small_bank, 1.0)
    moved = (np.asarray(nav.start) != small_bank.episode_start[scenes, rows, :3]).any(-1)
    could = (np.asarray(always.start) != small_bank.episode_start[scenes, rows, :3]).any(-1)
    assert moved.sum() / could.sum() == pytest.approx(0.5, abs=0.1)
    assert not (moved & ~could).any()
    w, z = np.asarray(always.sim.xquat)[could, -1, 0], np.asarray(always.sim.xquat)[could, -1, 3]
    yaw = 2 * np.arctan2(z, w)
    assert np.histogram(np.mod(yaw, 2 * np.pi), 4, (0, 2 * np.pi))[0].min() > 0.15 * could.sum()


class Yard:
    """A wall along y = 3 and a kerb along x = 9, instead of the streets' tables."""

    @staticmethod
    def distances(scene: Any, points: Any) -> Any:
        return jnp.stack([jnp.abs(3.0 - points[..., 1]), 9.0 - points[..., 0]], -1)


def test_free_places_and_the_lines_from_them_are_checked_in_every_point() -> None:
    """Against the same rule, one place after another, for any numbers of them."""
    robot = make_coco()
    starts, rng = RandomStarts(1.0, Yard(), robot), np.random.default_rng(0)  # type: ignore[arg-type]
    for number in (1, 3, 200):
        here, ahead = rng.uniform([2.0, 0.0], [9.0, 6.0], (2, number, 2))
        found = np.asarray(starts._free(jnp.int32(0), jnp.asarray(here), jnp.asarray(ahead)))
        expected = []
        for a, b in zip(here, ahead, strict=True):
            line = [np.asarray(Yard.distances(0, a + share * (b - a))) for share in np.arange(12) / 11]
            near = min(float(d.min()) for d in line)
            expected.append(line[0].min() >= robot.planner_radius + 0.15 + 0.1 and near >= robot.planner_radius)
        np.testing.assert_array_equal(found, expected)
    assert 0.05 < found.mean() < 0.95


def test_a_start_is_drawn_beside_the_route_with_the_rest_of_it() -> None:
    """On a route of two pieces in the open: every distance along the first part of it, on both sides, in the share that
    is asked for; nothing but the goal remains if all waypoints were passed."""
    route = jnp.array([[3.0, -9.0, 0.0], [8.0, -9.0, 0.5], [8.0, -30.0, 0.5], [8.0, -30.0, 0.5]])
    start, count = jnp.array([0.0, -9.0, 0.0, 0.3]), jnp.int32(3)

    class Open:
        @staticmethod
        def distances(scene: Any, points: Any) -> Any:
            return jnp.full((*points.shape[:-1], 2), 2.0)

    starts = RandomStarts(0.7, Open(), make_coco())  # type: ignore[arg-type]
    draw = jax.jit(jax.vmap(lambda key: starts.draw(key, jnp.int32(0), start, route, count)))
    there, rest, left = (np.asarray(x) for x in draw(jax.random.split(jax.random.key(0), 2000)))
    moved = (there != np.asarray(start)).any(-1)
    assert moved.mean() == pytest.approx(0.7, abs=0.04)
    np.testing.assert_array_equal(rest[~moved], np.broadcast_to(route, rest[~moved].shape))
    assert (left[~moved] == 3).all()
    corners = np.concatenate([np.asarray(start)[None, :3], np.asarray(route[:3])])
    for place, ahead, number in zip(there[moved], rest[moved], left[moved], strict=True):
        passed = 3 - int(number)
        np.testing.assert_array_equal(ahead, corners[np.minimum(np.arange(4) + passed + 1, 3)])
        a, b = corners[passed], corners[passed + 1]
        share = float((place[:2] - a[:2]) @ (b - a)[:2]) / float((b - a)[:2] @ (b - a)[:2])
        assert -1e-4 <= share <= 1.0 + 1e-4
        assert np.linalg.norm(place[:2] - (a + share * (b - a))[:2]) <= 2.0 + 1e-4
        assert place[2] == pytest.approx(a[2] + share * (b - a)[2], abs=1e-4)
    # 29 m, of which the last 8 m stay.
    along = np.where(left[moved] == 1, 8.0 - there[moved, 1] - 9.0, there[moved, 0])
    assert along.max() == pytest.approx(21.0, abs=0.2)
    assert along.min() == pytest.approx(0.0, abs=0.2)
    assert np.histogram(along, 7, (0.0, 21.0))[0].min() > 0.1 * moved.sum()
    assert np.histogram(there[moved, 3], 4, (-np.pi, np.pi))[0].min() > 0.2 * moved.sum()


def test_a_share_above_one_is_refused() -> None:
    config = default_config().randomization.copy_and_resolve_references()
    config.starts = 1.5
    with pytest.raises(ValidationError, match=r"randomization\.starts: found 1\.5"):
        Randomization(config)
