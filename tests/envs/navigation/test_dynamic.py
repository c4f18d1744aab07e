"""Dynamic streets in the environment: agents, encounters near the route, distances of the robot to people."""

import dataclasses
import types
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from ml_collections import ConfigDict

from tests.support.compiling import optimized
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.crowds import Bodies, crowd
from urbanverse_mjx.crowds.behaviours import GO, ROAM, STAY
from urbanverse_mjx.crowds.crowd import Crowd
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, check_env, default_config
from urbanverse_mjx.envs.navigation import dynamic_tables
from urbanverse_mjx.envs.navigation.dynamic import (
    INTIMATE_DISTANCE,
    MAX_PEOPLE_DISTANCE,
    PEOPLE_METRICS,
    PERSONAL_DISTANCE,
    slot_appearances,
    slot_kinds,
)
from urbanverse_mjx.envs.navigation.encounters import ENCOUNTERS, Encounters, route_pose
from urbanverse_mjx.envs.navigation.scenarios import bank_for
from urbanverse_mjx.evaluation import Rollout, fixed_episodes, go_to_goal, make_report, to_markdown
from urbanverse_mjx.evaluation.agents import zero

WALKERS = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter", "cyclist", "car")}
DYNAMIC = {"scenario": "dynamic", "crowd.slots.pedestrian": 9, "terminate_off_traversable": False, **WALKERS}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    with optimized():  # the crowd's tables take seconds
        return unicycle_env(small_bank, {**DYNAMIC, "episode_length": 12})


@pytest.fixture(scope="module")
def begun(env: NavEnv) -> Any:
    return jax.jit(jax.vmap(env.begin))(jax.random.split(jax.random.key(0), 24))


@pytest.mark.slow
def test_people_are_there_and_meet_the_route(env: NavEnv, begun: Any) -> None:
    """Near the robot, apart from it and from each other, on the ground, some with a script and some roaming."""
    crowd, start = begun.crowd, np.asarray(begun.start)
    there = np.asarray(crowd.present)
    assert 0.5 < there.mean() <= 1.0
    x, y = np.asarray(crowd.bodies.x), np.asarray(crowd.bodies.y)
    away = np.hypot(x - start[:, :1], y - start[:, 1:2])[there]
    assert away.min() > 1.2
    assert np.mean(away < 30.0) > 0.9
    gap = np.hypot(x[:, :, None] - x[:, None], y[:, :, None] - y[:, None])
    both = there[:, :, None] & there[:, None] & ~np.eye(9, dtype=bool)
    assert gap[both].min() > 2 * 0.27
    mode = np.asarray(crowd.mode)[there]
    assert {GO, STAY, ROAM} == set(mode.tolist())
    motion = jax.jit(jax.vmap(env.dynamic.places))(crowd, begun.sim.scene)  # type: ignore[union-attr]
    np.testing.assert_allclose(np.asarray(motion.position)[there][:, 2].max(), 0.15, atol=1e-3)


@pytest.mark.slow
def test_motion_carries_agents_from_state_to_state(env: NavEnv, begun: Any) -> None:
    dynamic = env.dynamic
    assert dynamic is not None
    after, motion = jax.jit(jax.vmap(lambda nav: dynamic.advance(nav, 1)))(begun)
    end = np.asarray(motion.position + env.dt * motion.velocity)
    where = np.asarray(motion.present)
    assert where.mean() > 0.5
    reached = np.stack([np.asarray(after.bodies.x), np.asarray(after.bodies.y)], -1)
    np.testing.assert_allclose(end[where][:, :2], reached[where], atol=1e-4)
    assert np.linalg.norm(np.asarray(motion.velocity), axis=-1)[where].max() < 2.5
    crowd = jax.tree.map(lambda x: x[0], begun.crowd)
    elsewhere = crowd._replace(bodies=crowd.bodies._replace(x=crowd.bodies.x + 20.0))
    assert not np.asarray(dynamic.motion(crowd, elsewhere, begun.sim.scene[0]).present).any(), "who appears is absent"


def test_a_control_step_of_a_crowd_by_hand(env: NavEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of its steps moves everybody by 0.1 m along x and 0.3 rad; the second leaps, the third
    was absent."""
    dynamic = env.dynamic
    assert dynamic is not None
    crowd = Crowd(Bodies(*[jnp.zeros(9)] * 5), *[jnp.zeros(9)] * (len(Crowd._fields) - 1))
    body = crowd.bodies._replace(x=jnp.linspace(10.0, 14.0, 9), y=jnp.full(9, 6.0), heading=jnp.full(9, 3.0))
    before = crowd._replace(bodies=body, present=jnp.arange(9) != 2)
    seen: list[Any] = []

    def step(crowd: Crowd, scene: Any, observer: Any, robot: Any, key: Any, rights: Any) -> Crowd:
        seen.append((scene, observer, robot))
        moved = crowd.bodies.x + 0.1 + 30.0 * (jnp.arange(9) == 1)
        return crowd._replace(bodies=crowd.bodies._replace(x=moved, heading=crowd.bodies.heading + 0.3))

    monkeypatch.setattr(dynamic.model, "step", step)
    sim = types.SimpleNamespace(
        scene=jnp.int32(1),
        xpos=jnp.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.3]]),
        xquat=jnp.array([[1.0, 0.0, 0.0, 0.0], [np.cos(0.2), 0.0, 0.0, np.sin(0.2)]]),
        qvel=jnp.array([0.5, -0.6, 0.0, 0.0, 0.0, 0.0]),
    )
    nav: Any = types.SimpleNamespace(sim=sim, crowd=before, key=jax.random.key(0), steps=jnp.int32(3))
    with jax.disable_jit():
        after, motion = dynamic.advance(nav, 1)
    steps = round(env.dt / 0.1)
    assert len(seen) == steps
    scene, observer, robot = seen[0]
    assert int(scene) == 1
    np.testing.assert_allclose(
        [observer.x, observer.y, observer.heading, *robot], [3.0, 4.0, 0.4, 0.5, -0.6], atol=1e-6
    )
    others = np.arange(9) != 1
    np.testing.assert_allclose((after.bodies.x - body.x)[others], 0.1 * steps, atol=1e-5)
    np.testing.assert_allclose(motion.position[:, :2], np.stack([body.x, body.y], -1), atol=1e-6)
    np.testing.assert_allclose(motion.position[:, 2], 0.15, atol=1e-3)
    np.testing.assert_allclose(motion.velocity[others], np.tile([0.1 * steps / env.dt, 0.0, 0.0], (8, 1)), atol=1e-4)
    np.testing.assert_allclose(motion.velocity[1], 0.0)
    np.testing.assert_allclose(motion.turn_rate, 0.3 * steps / env.dt, atol=1e-4)
    assert motion.present.tolist() == [True, False, False] + [True] * 6


def test_gaps_and_metrics_by_hand(env: NavEnv) -> None:
    dynamic = env.dynamic
    assert dynamic is not None
    crowd = Crowd(Bodies(*[jnp.zeros(9)] * 5), *[jnp.zeros(9)] * (len(Crowd._fields) - 1))
    only = crowd._replace(
        present=jnp.arange(9) == 4, bodies=crowd.bodies._replace(x=jnp.full(9, 10.0), y=jnp.full(9, 6.0))
    )
    gap = 1.0 - 0.27 - env.robot.planner_radius
    values = dynamic.metrics(only, jnp.int32(Result.RUNNING), jnp.array([10.0, 7.0]), jnp.array([0.3, 0.4]))
    assert tuple(values) == PEOPLE_METRICS
    assert float(values["people_distance"]) == pytest.approx(gap, abs=1e-5)
    assert [float(values[f"{n}_time_per_step"]) for n in ("intimate", "personal")] == [
        gap < INTIMATE_DISTANCE,
        gap < PERSONAL_DISTANCE,
    ]
    assert float(values["personal_speed_per_step"]) == pytest.approx(0.5)
    nobody = dynamic.metrics(
        only._replace(present=jnp.zeros(9, bool)), jnp.int32(Result.HIT_AGENT), jnp.zeros(2), jnp.ones(2)
    )
    assert [float(x) for x in nobody.values()] == [1.0, MAX_PEOPLE_DISTANCE, 0.0, 0.0, 0.0]
    near = dynamic.nearer(jnp.full((2, 2), 2.0), only, jnp.array([[10.0, 6.5], [10.0, 20.0]]))
    np.testing.assert_allclose(near, [[0.5 - 0.27, 2.0], [2.0, 2.0]], atol=1e-6)


@pytest.mark.slow
def test_touching_a_person_is_a_result_of_its_own(env: NavEnv, begun: Any) -> None:
    """The robot is placed on an agent; one env has contact, the others do not."""
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 24))
    nav = state.data
    who = int(np.argmax(np.asarray(nav.crowd.present[3])))
    place = jnp.array([nav.crowd.bodies.x[3, who], nav.crowd.bodies.y[3, who]])
    qpos = nav.sim.qpos.at[3, :2].set(place)
    state = dataclasses.replace(state, data=nav._replace(sim=nav.sim._replace(qpos=qpos)))
    after = jax.jit(jax.vmap(env.step))(state, jnp.tile(jnp.array([-1.0, 0.0]), (24, 1)) * 0.0)
    result = np.asarray(after.info["result"])
    assert result[3] == Result.HIT_AGENT
    assert (np.delete(result, 3) == Result.RUNNING).all()
    assert float(after.metrics["hit_agent"][3]) == 1.0
    assert float(after.metrics["hit"][3]) == 0.0
    assert float(after.metrics["people_distance"][3]) == 0.0
    assert float(after.metrics["reward/hit"][3]) == -200.0


def test_tables_of_a_crowd_are_kept(env: NavEnv, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the environment's scenes are read from the cache, not built again."""
    assert env.dynamic is not None
    monkeypatch.setattr(dynamic_tables, "build_tables", lambda *_: pytest.fail("built again"))
    kept = dynamic_tables.kept_tables(env.bank, env.scenes.tolist())
    np.testing.assert_array_equal(kept.height, env.dynamic._height)
    np.testing.assert_array_equal(kept.origin, env.dynamic._origin)
    floor = np.asarray(kept.height)
    assert floor.shape[0] == small_bank.num_scenes
    assert np.nanmin(floor) == pytest.approx(0.0, abs=0.01), "the road"
    assert np.nanmax(floor) == pytest.approx(0.15, abs=0.01), "the pavement"


def test_tables_have_rows_of_the_scenes_in_use_alone(env: NavEnv, small_bank: SceneBank) -> None:
    """Those of a street that is used alone are its row in the tables of all, and nothing of the others."""
    every, one = (dynamic_tables.kept_tables(small_bank, z) for z in (env.scenes.tolist(), [2, 2]))
    assert every.row.tolist() == [0, 1, 2]
    assert int(one.row[2]) == 0
    for found, whole in zip(jax.tree.leaves(one[:-1]), jax.tree.leaves(every[:-1]), strict=True):
        assert found.shape == (1, *whole.shape[1:])
        np.testing.assert_array_equal(found[0], whole[2])


@pytest.mark.extended
def test_tables_of_many_scenes_are_the_same_from_processes(
    env: NavEnv, small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = dynamic_tables.kept_tables(small_bank, env.scenes.tolist()).crowd
    monkeypatch.setattr(crowd, "workers_for", lambda *_: 2)
    made = crowd.make_tables(small_bank, env.scenes.tolist())
    for found, whole in zip(jax.tree.leaves(made), jax.tree.leaves(kept), strict=True):
        np.testing.assert_array_equal(found, whole)


def test_static_streets_carry_nothing_of_it(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank)
    state = jax.eval_shape(env.reset, jax.random.key(0))
    assert env.dynamic is None
    assert state.data.crowd is None
    assert not set(PEOPLE_METRICS) & set(state.metrics)


@pytest.mark.slow
def test_check_env_accepts_dynamic_streets(env: NavEnv) -> None:
    check_env(env, num_envs=4, num_steps=6)


@pytest.mark.slow
def test_evaluation_counts_people(env: NavEnv) -> None:
    results, trajectory = Rollout(env, chunk=12).run({"go": go_to_goal, "zero": zero}, fixed_episodes(env, 6))
    assert all(r.people_distance is not None and 0.0 <= r.people_distance <= MAX_PEOPLE_DISTANCE for r in results)
    assert all(0.0 <= r.intimate_time <= 1.0 for r in results if r.intimate_time is not None)
    assert trajectory.agents is not None
    assert trajectory.agents.position.shape == (12, 12, 9, 3)
    report = make_report("dynamic", results, {})
    assert "| agent | agent_hits | people_distance | IT | speed_near_people |" in to_markdown(report)


def test_route_poses_lie_on_the_route() -> None:
    start = jnp.array([1.0, 2.0, 0.0])
    waypoints = jnp.array([[4.0, 2.0, 0.0], [4.0, 6.0, 0.0], [4.0, 6.0, 0.0]])
    for arc, wanted in ((0.0, (1.0, 2.0, 0.0)), (2.0, (3.0, 2.0, 0.0)), (5.0, (4.0, 4.0, np.pi / 2))):
        np.testing.assert_allclose(route_pose(start, waypoints, arc), wanted, atol=1e-5)
    np.testing.assert_allclose(route_pose(start, waypoints, 99.0), (4.0, 6.0, np.pi / 2), atol=1e-5)


@pytest.mark.extended
def test_every_encounter_takes_place_where_there_is_room_and_nowhere_else() -> None:
    every = Encounters(ConfigDict(dict.fromkeys(ENCOUNTERS, 1.0)), walkers=9)
    start, waypoints = jnp.array([0.0, 0.0, 0.0, 0.0]), jnp.array([[30.0, 0.0, 0.0]])
    keys = jax.random.split(jax.random.key(0), 200)

    def draw(free: float) -> Any:
        return jax.vmap(lambda k: every.draw(k, start, waypoints, lambda p: jnp.full(p.shape, free)))(keys)

    script = draw(2.0)
    assert script.mode.shape == (200, 9)
    assert (np.asarray(script.mode) != ROAM).mean(0).min() > 0.6, "most take place; some would stand in another"
    assert not (np.asarray(draw(0.1).mode) != ROAM).any()
    head_on, cross = (script.mode[:, 0] == GO), (script.mode[:, 1] == GO)
    assert np.abs(np.asarray(script.y[:, 0])[np.asarray(head_on)]).max() < 0.5, "on the route"
    assert (np.asarray(script.anchor_x - script.x)[:, 0] < -10.0).all(), "towards the robot and past it"
    ends = np.stack([np.asarray(script.y[:, 1]), np.asarray(script.anchor_y[:, 1])])[:, np.asarray(cross)]
    np.testing.assert_allclose(np.abs(ends), 2.5, atol=1e-5)
    np.testing.assert_allclose(ends.sum(0), 0.0, atol=1e-5)
    assert (ends[0] > 0).mean() == pytest.approx(0.5, abs=0.2), "from both sides"
    few = Encounters(ConfigDict(dict.fromkeys(ENCOUNTERS, 1.0)), walkers=2)
    assert few.draw(keys[0], start, waypoints, lambda p: jnp.ones(p.shape)).mode.shape == (2,)  # type: ignore[union-attr]
    assert Encounters(ConfigDict({"talk": 0.0}), 9).draw(keys[0], start, waypoints, jnp.ones_like) is None
    with pytest.raises(ValidationError, match="'dance'"):
        Encounters(ConfigDict({"dance": 0.5}), 9)


def test_slots_are_sorted_and_looked_up(small_bank: SceneBank) -> None:
    config = default_config().crowd
    kinds = slot_kinds(config)
    assert len(kinds) == 16
    assert kinds[-2:] == ("car", "car")
    with pytest.raises(ValidationError, match="no appearance of a pedestrian"):
        slot_appearances(kinds, small_bank)
    appearances = {"kind": ["car", "pedestrian", "pedestrian"], "mesh": [0, 1, 2], "category": [0, 0, 0]}
    bank = dataclasses.replace(small_bank, meta={**small_bank.meta, "agents": appearances})
    assert slot_appearances(("pedestrian", "pedestrian", "pedestrian", "car"), bank) == (1, 2, 1, 0)
    with pytest.raises(ValidationError, match="scenario"):
        unicycle_env(small_bank, {"scenario": "busy"})


def test_clean_streets_hold_ground_alone(small_bank: SceneBank) -> None:
    clean = bank_for("clean", small_bank)
    assert (clean.inst_hull < 0).all()
    assert (clean.hull_grid < 0).all()
    names = np.array(clean.meta["categories"])[clean.slot_category[clean.slot_mesh >= 0]]
    assert all(name.startswith("ground:") for name in names)
    assert len(names) == sum(
        str(small_bank.meta["categories"][c]).startswith("ground:")
        for c in small_bank.slot_category[small_bank.slot_mesh >= 0]
    )
    np.testing.assert_array_equal(clean.prism_hull, small_bank.prism_hull)
