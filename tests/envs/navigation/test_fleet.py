"""Robots of one street: the exchange between consecutive envs, what each knows of the others, and contacts."""

import types
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, Result, registry
from urbanverse_mjx.envs.navigation.fleet import (
    ROBOT,
    START_SPACING,
    TRIES,
    Fleet,
    first_of_group,
    fleet_middle,
    fleet_shapes,
    grouped,
)
from urbanverse_mjx.envs.navigation.tasks.config import multi_robot_config
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering.robot_appearance import with_robot_appearance

SIZE = 3
FEW = {"task.robots": SIZE, "episode_length": 60, "terminate_off_traversable": False}


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return unicycle_env(small_bank, FEW, config=multi_robot_config())


def begun(env: NavEnv, number: int, scene: int = 0) -> Any:
    """The first states of a scene's first rows."""
    keys = jax.random.split(jax.random.key(0), number)
    scenes, rows = jnp.full(number, scene, jnp.int32), jnp.arange(number, dtype=jnp.int32)
    return jax.vmap(env.begin_at)(keys, scenes, rows)


def at(nav: Any, places: Any, yaws: Any = 0.0) -> Any:
    """States (n,) at places (n, 2) m with headings (n,) rad."""
    places = jnp.asarray(places, jnp.float32)
    yaws = jnp.broadcast_to(jnp.asarray(yaws, jnp.float32), places.shape[:1])
    turn = jnp.stack([jnp.cos(yaws / 2), 0 * yaws, 0 * yaws, jnp.sin(yaws / 2)], -1)
    sim = nav.sim
    sim = sim._replace(
        xpos=sim.xpos.at[:, 1, :2].set(places),
        xquat=sim.xquat.at[:, 1].set(turn),
        qpos=sim.qpos.at[:, :2].set(places).at[:, 3:7].set(turn),
    )
    return nav._replace(sim=sim)


# The exchange.


def test_each_member_gets_the_others_in_order_and_no_one_of_another_group() -> None:
    others = jax.vmap(grouped(3))(jnp.arange(6.0))
    np.testing.assert_array_equal(others, [[1, 2], [0, 2], [0, 1], [4, 5], [3, 5], [3, 4]])
    tree = {"a": jnp.arange(8).reshape(4, 2), "b": jnp.arange(4) > 1}
    got = jax.jit(jax.vmap(grouped(2)))(tree)
    np.testing.assert_array_equal(got["a"][:, 0], tree["a"][np.array([1, 0, 3, 2])])
    np.testing.assert_array_equal(got["b"][:, 0], [False, False, True, True])


def test_alone_there_is_nobody_and_outer_batches_do_not_mix() -> None:
    np.testing.assert_array_equal(grouped(3)(jnp.float32(7.0)), [0.0, 0.0])
    nested = jax.vmap(jax.vmap(grouped(2)))(jnp.arange(8.0).reshape(2, 4))
    np.testing.assert_array_equal(nested[..., 0], [[1, 0, 3, 2], [5, 4, 7, 6]])


def test_what_all_members_share_is_exchanged_too() -> None:
    out = jax.vmap(lambda x: grouped(2)((x, jnp.float32(3.0))))(jnp.arange(4.0))
    np.testing.assert_array_equal(out[1], np.full((4, 1), 3.0))


def test_the_first_of_a_group_leads() -> None:
    values, place = jax.vmap(first_of_group(3))(jnp.arange(10.0, 16.0))
    np.testing.assert_array_equal(values, [10, 10, 10, 13, 13, 13])
    np.testing.assert_array_equal(place, [0, 1, 2, 0, 1, 2])
    alone, place = first_of_group(3)(jnp.float32(5.0))
    assert (float(alone), int(place)) == (5.0, 0)


def test_a_batch_that_is_no_multiple_is_refused() -> None:
    with pytest.raises(ValidationError, match="found 4 side by side, needed a multiple of 3"):
        jax.vmap(grouped(3))(jnp.arange(4.0))


# What robots know of each other.


def test_the_body_covers_the_robots_collision_geoms() -> None:
    robot = make_coco()
    shapes, middle = fleet_shapes(robot, 4), fleet_middle(robot)
    assert shapes.radius.shape == (3,)
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    data.qpos[:7] = -middle, 0, robot.spawn_height, 1, 0, 0, 0
    mujoco.mj_kinematics(model, data)
    reach, half = float(shapes.radius[0]), float(shapes.half_length[0])
    for g in range(model.ngeom):
        if model.geom_contype[g] or model.geom_conaffinity[g]:
            x, y, z = data.geom_xpos[g]
            size = model.geom_size[g, 0]
            assert abs(y) + size <= reach + 1e-6
            assert abs(x) + size <= reach + half + 1e-6
            assert z + size <= shapes.height[0] + 1e-6


@pytest.mark.extended
def test_robots_begin_apart_and_know_where_the_others_are(env: NavEnv) -> None:
    nav = begun(env, 2 * SIZE)
    start = np.asarray(nav.start)[:, :2]
    for i in range(2 * SIZE):
        first = i // SIZE * SIZE
        others = [j for j in range(first, first + SIZE) if j != i]
        middle = fleet_middle(env.robot)
        yaw = np.asarray(env.bank.episode_start)[0, np.array(others), 3]
        expected = start[others] + middle * np.stack([np.cos(yaw), np.sin(yaw)], -1)
        body = nav.crowd.bodies
        np.testing.assert_allclose(np.stack([body.x[i], body.y[i]], -1), expected, atol=1e-5)
        assert np.asarray(nav.crowd.present[i]).all()
        assert np.linalg.norm(start[others] - start[i], axis=-1).min() >= START_SPACING - 1e-5


@pytest.mark.extended
def test_robots_in_different_scenes_do_not_meet(env: NavEnv) -> None:
    keys, rows = jax.random.split(jax.random.key(0), SIZE), jnp.arange(SIZE, dtype=jnp.int32)
    nav = jax.vmap(env.begin_at)(keys, jnp.array([0, 0, 1], jnp.int32), rows)
    assert nav.crowd is not None
    np.testing.assert_array_equal(nav.crowd.present, [[True, False], [True, False], [False, False]])


@pytest.mark.extended
def test_a_robot_alone_has_the_street_to_itself(env: NavEnv) -> None:
    nav = env.begin_at(jax.random.key(0), jnp.int32(0), jnp.int32(0))
    assert nav.crowd is not None
    assert not np.asarray(nav.crowd.present).any()
    new, *_ = env.advance(nav, jnp.array([1.0, 0.0]))
    assert int(new.result) == Result.RUNNING


@pytest.mark.extended
def test_after_a_step_each_knows_the_new_places_and_speeds(env: NavEnv) -> None:
    nav = at(begun(env, SIZE), [[5.0, 6.0], [9.0, 6.0], [15.0, 6.0]])
    new, *_ = jax.jit(jax.vmap(env.advance))(nav, jnp.array([[0.5, 0.0], [0.0, 0.0], [0.25, 0.0]]))
    moved = np.asarray(new.sim.xpos)[:, 1, 0] - np.array([5.0, 9.0, 15.0])
    assert moved[0] > moved[2] > moved[1] == 0.0
    middle = fleet_middle(env.robot)
    np.testing.assert_allclose(new.crowd.bodies.x[1] - middle, [5.0 + moved[0], 15.0 + moved[2]], atol=1e-5)
    np.testing.assert_allclose(new.crowd.bodies.vx[1], [moved[0] / env.dt, moved[2] / env.dt], atol=1e-4)


def test_both_of_two_robots_that_drive_into_each_other_see_the_contact(env: NavEnv) -> None:
    nav = at(begun(env, SIZE), [[5.0, 6.0], [7.0, 6.0], [20.0, 6.0]], [0.0, np.pi, 0.0])
    step, action = jax.jit(jax.vmap(env.advance)), jnp.array([[1.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    ends = np.zeros(SIZE, int)
    for _ in range(6):
        nav, *_ = step(nav, action)
        ends = np.where(ends == 0, np.asarray(nav.result), ends)
    assert ends.tolist() == [Result.HIT_AGENT, Result.HIT_AGENT, Result.RUNNING]


@pytest.mark.extended
def test_who_has_ended_stands_for_the_others(env: NavEnv) -> None:
    nav = at(begun(env, SIZE), [[5.0, 6.0], [9.0, 6.0], [15.0, 6.0]])
    fast = nav.sim._replace(qvel=nav.sim.qvel.at[:, 0].set(2.0))
    nav = nav._replace(sim=fast, result=jnp.array([Result.HIT, 0, 0], jnp.int32))
    _, motion = jax.vmap(lambda nav: env.fleet.advance(nav, 1))(nav)  # type: ignore[union-attr]
    np.testing.assert_allclose(motion.velocity[1, :, 0], [0.0, 2.0])


def test_distances_count_the_others_as_obstacles(env: NavEnv) -> None:
    nav = at(begun(env, SIZE), [[5.0, 6.5], [8.0, 6.5], [20.0, 6.5]])
    nav = nav._replace(crowd=jax.vmap(env.fleet.after)(nav.sim, nav.result))  # type: ignore[union-attr]
    one = jax.tree.map(lambda x: x[0], nav)
    beside = env.distances(one, jnp.array([[8.0 + fleet_middle(env.robot), 6.5]]))
    assert float(beside[0, 0]) == 0.0


# Beginning anew.


def test_a_group_begins_in_one_street_and_each_goes_on_there(env: NavEnv) -> None:
    keys = jax.random.split(jax.random.key(3), 8 * SIZE)
    nav = jax.jit(jax.vmap(env.begin))(keys)
    scenes, rows = (np.asarray(x).reshape(8, SIZE) for x in (nav.sim.scene, nav.episode))
    assert (scenes == scenes[:, :1]).all()
    assert len(set(scenes[:, 0])) > 1
    assert all(len(set(group)) == SIZE for group in rows), "each robot has a row of its own"
    again = jax.jit(jax.vmap(env.reset_episode))(nav)
    np.testing.assert_array_equal(again.sim.scene, nav.sim.scene)
    body, start = nav.crowd.bodies, np.asarray(again.start)[:, None, :2]
    gap = np.linalg.norm(np.stack([body.x, body.y], -1) - start, axis=-1)
    assert gap.min() > 1.0, "not where another robot is"


# In the engines, and drawn.


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["jax", "warp-fused"])
def test_in_both_engines_robots_collide(small_bank: SceneBank, impl: str) -> None:
    """Two COCOs drive at each other; each is stopped by the other."""
    overrides = {"scenes": "all", "vision": False, "impl": impl, "task.robots": 2, "terminate_on_hit": False}
    overrides |= {"terminate_off_traversable": False, "friction": "uniform"}
    config = registry.with_overrides(registry.get_default_config("CocoMultiRobot", "cpu"), overrides)
    env = registry.load_nav_env("CocoMultiRobot", config, small_bank)
    nav = begun(env, 2)
    y, free = 6.5, None
    for x in np.arange(3.0, 40.0, 0.5):
        points = np.stack([np.linspace(x, x + 3.0, 31), np.full(31, y)], -1)
        if float(env._surroundings.distances(0, jnp.asarray(points)).min()) > 0.8:
            free = x
            break
    assert free is not None, "the street has three free metres"
    nav = at(nav, [[free, y], [free + 3.0, y]], [0.0, np.pi])
    step, hits = jax.jit(jax.vmap(env.advance)), np.zeros(2, bool)
    for _ in range(12):
        nav, *_ = step(nav, jnp.array([[1.0, 0.0], [1.0, 0.0]]))
        hits |= np.asarray(nav.sim.contacts.hit_agent) == 0
    assert hits.all()
    x = np.asarray(nav.sim.xpos)[:, 1, 0]
    assert x[1] - x[0] > 1.2 * float(fleet_shapes(env.robot, 2).radius[0]), "they are not inside each other"


def test_a_robots_appearance_has_its_size_and_colours(small_bank: SceneBank) -> None:
    robot = make_coco()
    bank = with_robot_appearance(small_bank, robot, ROBOT, fleet_middle(robot))
    row = bank.agents["kind"].index(ROBOT)
    mesh = bank.agents["mesh"][row]
    corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] :]
    assert abs(float(corners[:, 2].min())) < 0.01, "the wheels stand on the ground"
    assert 0.5 < np.ptp(corners[:, 0]) < 1.2
    assert 0.4 < np.ptp(corners[:, 1]) < 0.8
    image = bank.texture(len(bank.texture_shape) - 1)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 1, "body and wheels have colours of their own"
    assert bank.meta["categories"][bank.agents["category"][row]] == "delivery robot"


@pytest.mark.slow
def test_the_camera_sees_the_robot_ahead(small_bank: SceneBank) -> None:
    overrides = {"scenes": "all", "impl": "jax", "task.robots": 2}
    config = registry.with_overrides(registry.get_default_config("CocoMultiRobot", "cpu"), overrides)
    env = registry.load_nav_env("CocoMultiRobot", config, small_bank)
    nav = begun(env, 2)
    ahead = nav.sim.xpos[0, 1, :2] + 1.5 * jnp.stack(
        [jnp.cos(env.bank.episode_start[0, 0, 3]), jnp.sin(env.bank.episode_start[0, 0, 3])]
    )
    images = []
    for x, y in (ahead, ahead + 100.0):
        body = nav.crowd.bodies
        body = body._replace(x=body.x.at[0].set(x), y=body.y.at[0].set(y))
        images.append(
            np.asarray(jax.vmap(env.observe)(nav._replace(crowd=nav.crowd._replace(bodies=body)))["pixels/front"])
        )
    changed = (np.abs(images[0][0].astype(int) - images[1][0]).max(-1) > 20).mean()
    assert changed > 0.03, "three per cent of the image"


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"task.robots": 9}, "config.task.robots: found 9, needed 2 to 8"),
        ({"task.robots": 1}, "config.task.robots: found 1, needed 2 to 8"),
        ({"scenario": "dynamic"}, "found scenario 'dynamic' with several robots in a street"),
        ({"randomization.clutter": 2}, "found randomization.clutter with several robots"),
    ],
)
def test_bad_configurations_are_refused_in_a_sentence(
    small_bank: SceneBank, overrides: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        unicycle_env(small_bank, {**FEW, **overrides}, config=multi_robot_config())


def test_the_next_episode_begins_away_from_other_robots() -> None:
    """Of the drawn starts on a line, robots stand at those up to x = 20 m, and somebody absent everywhere else."""
    x = np.arange(50.0)
    place = jnp.asarray(np.stack([np.stack([x, 0.0 * x + scene], -1) for scene in range(2)]), jnp.float32)
    body = types.SimpleNamespace(x=jnp.asarray(x, jnp.float32), y=jnp.ones(50))
    crowd = types.SimpleNamespace(bodies=body, present=jnp.asarray(x <= 20.0))
    nav: Any = types.SimpleNamespace(sim=types.SimpleNamespace(scene=jnp.int32(1)), crowd=crowd)
    fleet: Any = types.SimpleNamespace(_count=jnp.array([7, 50]), _starts=place)
    chosen = []
    for seed in range(12):
        key = jax.random.key(seed)
        scene, row = Fleet.again(fleet, key, nav)
        drawn = np.asarray(jax.random.randint(key, (TRIES,), 0, 50))
        free = np.minimum(np.maximum(drawn - 20.0, 0.0), 2.0 * START_SPACING)
        assert int(scene) == 1
        assert int(row) == drawn[free.argmax()], "the first of those that are far enough away"
        chosen.append(int(row))
    assert min(chosen) >= 20 + 2.0 * START_SPACING
    assert len(set(chosen)) > 6
