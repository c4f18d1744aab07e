"""The motions that a privileged teacher is told to be free, against exact distances to the outlines of hulls."""

import dataclasses
import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import shapely

from tests.support.compiling import optimized
from tests.support.unicycle import unicycle_env
from urbanverse_mjx import robots
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.envs.navigation import clear_arcs as module
from urbanverse_mjx.envs.navigation.clear_arcs import (
    ARCS,
    CURVATURES,
    MARGIN,
    NEAR,
    POSES,
    SPEED,
    STEP,
    TURN_RATE,
    ClearArcs,
    arc_poses,
)
from urbanverse_mjx.envs.navigation.clearance_maps import CELL, MIN_OBSTACLE_HEIGHT
from urbanverse_mjx.robots.footprint import footprint

#: m, error of the nearest cell's distance, and of a byte.
ERROR = CELL * np.sqrt(0.5) + 0.003


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return robots.load("coco")


@pytest.fixture(scope="module")
def arcs(bank: SceneBank, robot: RobotSpec) -> ClearArcs:
    return ClearArcs(bank, footprint(robot).discs, robot.planner_height)


def outlines(bank: SceneBank, scene: int, height: float) -> shapely.MultiPolygon:
    """The hulls that the robot does not pass, seen from above."""
    ground = float(np.median(bank.episode_start[scene, : int(bank.num_episodes[scene]), 2]))
    found = [
        shapely.MultiPoint(corners[:, :2]).convex_hull
        for corners in bank.standing_hulls(scene)
        if corners[:, 2].min() <= ground + height and corners[:, 2].max() >= ground + MIN_OBSTACLE_HEIGHT
    ]
    return shapely.MultiPolygon([x for x in found if isinstance(x, shapely.Polygon)])


def poses_near_objects(bank: SceneBank, scene: int, count: int) -> np.ndarray:
    """(n, 3) x, y (m), yaw, within 2 m of hulls, on level pavement beside the routes' points."""
    rng = np.random.default_rng(scene)
    rows = rng.integers(0, int(bank.num_episodes[scene]), count)
    start = bank.episode_start[scene, rows]
    places = start[:, :2] + rng.normal(0.0, 0.5, (count, 2))
    return np.column_stack([places, rng.uniform(-np.pi, np.pi, count)])


def exact(body: np.ndarray, pose: np.ndarray, motion: np.ndarray, hulls: shapely.Geometry) -> float:
    """m between discs (D, 3) and hulls, of a robot at `motion` (x, y, yaw) seen from `pose`."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    x, y = pose[:2] + np.array([[c, -s], [s, c]]) @ motion[:2]
    c, s = np.cos(pose[2] + motion[2]), np.sin(pose[2] + motion[2])
    centres = np.array([x, y]) + body[:, :2] @ np.array([[c, s], [-s, c]])
    return float((shapely.distance(shapely.points(centres), hulls) - body[:, 2]).min())


def test_arcs_are_what_driving_at_a_constant_curvature_gives() -> None:
    poses, fine = arc_poses(), 1000
    assert poses.shape == (ARCS, POSES, 3)
    for curvature, motion in zip(CURVATURES, poses, strict=False):
        x = y = yaw = 0.0
        for k in range(POSES * fine):
            middle = yaw + 0.5 * curvature * STEP / fine
            x, y, yaw = (
                x + STEP / fine * np.cos(middle),
                y + STEP / fine * np.sin(middle),
                yaw + curvature * STEP / fine,
            )
            if (k + 1) % fine == 0:
                assert np.allclose(motion[k // fine], (x, y, yaw), atol=1e-6)
    right, left = poses[-2:]
    assert np.all(right[:, :2] == 0.0)
    assert np.allclose(left[-1], (0.0, 0.0, np.pi / 2))
    assert np.allclose(left, -right)


def test_margins_are_distances_to_outlines(bank: SceneBank, robot: RobotSpec, arcs: ClearArcs) -> None:
    """In shipped streets, near objects and far from them; where a disc is inside a hull both are negative."""
    body, motions = footprint(robot).discs, arc_poses()
    inside = outside = 0
    for scene in range(min(bank.num_scenes, 3)):
        hulls = outlines(bank, scene, robot.planner_height)
        for pose in poses_near_objects(bank, scene, 12):
            got = np.asarray(arcs.margins(scene, jnp.asarray(pose[:2], jnp.float32), jnp.float32(pose[2])))
            for arc in range(ARCS):
                for k in range(0, POSES, 3):
                    wanted = exact(body, pose, motions[arc, k], hulls)
                    # The distance to a polygon is 0 inside it, where the field goes on to negative values.
                    assert got[arc, k] <= wanted + ERROR
                    inside += wanted < 0.0
                    if 0.0 <= wanted < 0.3:
                        assert got[arc, k] == pytest.approx(wanted, abs=ERROR)
                        outside += 1
    assert inside > 20
    assert outside > 20


def test_what_is_told_follows_from_the_margins(bank: SceneBank, arcs: ClearArcs) -> None:
    """A motion is free up to the first pose in contact, whatever comes behind it."""
    blocked = 0
    for pose in poses_near_objects(bank, 0, 40):
        place, yaw = jnp.asarray(pose[:2], jnp.float32), jnp.float32(pose[2])
        margins = np.asarray(arcs.margins(0, place, yaw))
        free, near = np.split(np.asarray(arcs.observe(0, place, yaw)), 2)
        for arc in range(ARCS):
            touching = np.flatnonzero(margins[arc] <= 0.0)
            first = touching[0] if len(touching) else POSES
            assert free[arc] == pytest.approx(first / POSES)
            assert near[arc] == pytest.approx(np.clip(margins[arc, :NEAR].min() / module.MARGIN, -1.0, 1.0), abs=1e-6)
            blocked += first < POSES and (margins[arc, first:] > 0.0).any()
    assert blocked, "no motion that leads through an object"


def test_the_field_is_kept_and_depends_on_hulls_alone(
    small_bank: SceneBank, robot: RobotSpec, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    first = module.kept_field(small_bank, robot.planner_height)
    path = module.path_of(small_bank, robot.planner_height)
    assert path.is_file()
    monkeypatch.setattr(module, "build_field", lambda *_: pytest.fail("made again"))
    assert np.array_equal(module.kept_field(small_bank, robot.planner_height), first)
    moved = dataclasses.replace(small_bank, inst_position=small_bank.inst_position + np.float32(0.5))
    assert module.path_of(moved, robot.planner_height) != path
    assert module.path_of(small_bank, robot.planner_height + 0.1) != path
    routes = dataclasses.replace(small_bank, episode_goal=small_bank.episode_goal + np.float32(1.0))
    assert module.path_of(routes, robot.planner_height) == path


def test_scenes_together_give_what_each_gives_alone(
    small_bank: SceneBank, robot: RobotSpec, monkeypatch: pytest.MonkeyPatch
) -> None:
    together = module.build_field(small_bank, robot.planner_height)
    monkeypatch.setattr(module, "_TOGETHER", 1)
    assert np.array_equal(module.build_field(small_bank, robot.planner_height), together)


def test_observation_under_jit_and_vmap(bank: SceneBank, arcs: ClearArcs) -> None:
    poses = poses_near_objects(bank, 1, 8).astype(np.float32)
    both = jax.jit(jax.vmap(lambda p: arcs.observe(1, p[:2], p[2])))(jnp.asarray(poses))
    assert both.shape == (8, 2 * ARCS)
    for pose, told in zip(poses, both, strict=True):
        assert np.allclose(told, arcs.observe(1, jnp.asarray(pose[:2]), jnp.asarray(pose[2])), atol=1e-5)


def test_agents_are_where_they_will_be_when_the_robot_gets_there(small_bank: SceneBank, robot: RobotSpec) -> None:
    options = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter", "cyclist")}
    options |= {"crowd.slots.pedestrian": 2, "crowd.slots.car": 1, "scenes": small_bank.scene_ids[0]}
    with optimized():
        env = unicycle_env(small_bank, {**options, "scenario": "dynamic"})
        crowd = jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0)).crowd
    assert env.dynamic is not None
    rng = np.random.default_rng(4)
    place, yaw = np.array([20.0, -5.0]), 0.7
    at, heading = place + rng.normal(0.0, 1.5, (3, 2)), rng.uniform(-np.pi, np.pi, 3)
    velocity = rng.normal(0.0, 1.5, (3, 2))
    fields = dict(zip(("x", "y", "vx", "vy", "heading"), (*at.T, *velocity.T, heading), strict=True))
    bodies = crowd.bodies._replace(**{name: jnp.asarray(x, jnp.float32) for name, x in fields.items()})
    present = np.array([True, True, True])
    discs = footprint(robot).discs
    arcs = ClearArcs(small_bank, discs, robot.planner_height)

    dynamic = env.dynamic

    def gaps(points: Any, after: Any) -> Any:
        return dynamic.gaps(crowd._replace(bodies=bodies, present=jnp.asarray(present)), points, after)

    found = np.asarray(arcs.margins_to_agents(gaps, jnp.asarray(place), jnp.float32(yaw)))
    half, radius = env.dynamic.shapes.half_length, env.dynamic.shapes.radius
    for m, motion in enumerate(arc_poses()):
        for k in (0, 5, POSES - 1):
            seconds = STEP * (k + 1) / SPEED if m < len(CURVATURES) else abs(motion[k, 2]) / TURN_RATE
            ahead = np.stack([np.cos(heading), np.sin(heading)], -1) * half[:, None]
            middle = at + velocity * seconds
            axes = [shapely.LineString(x) for x in np.stack([middle - ahead, middle + ahead], 1)]
            expected = min(
                exact(discs, np.array([*place, yaw]), motion[k], x) - r for x, r in zip(axes, radius, strict=True)
            )
            assert found[m, k] == pytest.approx(expected, abs=1e-3)
    assert found.min() < 0.0 < found.max()
    told = np.asarray(arcs.observe(0, jnp.asarray(place), jnp.float32(yaw), gaps))
    np.testing.assert_allclose(told[: 2 * ARCS], arcs.observe(0, jnp.asarray(place), jnp.float32(yaw)))
    np.testing.assert_allclose(told[2 * ARCS : 3 * ARCS], np.cumprod(found > 0.0, axis=1).mean(1), atol=1e-6)
    np.testing.assert_allclose(told[3 * ARCS :], np.clip(found[:, :NEAR].min(1) / MARGIN, -1.0, 1.0), atol=1e-5)
    present[:] = False
    nobody = np.asarray(arcs.observe(0, jnp.asarray(place), jnp.float32(yaw), gaps))
    np.testing.assert_array_equal(nobody[2 * ARCS :], 1.0)
