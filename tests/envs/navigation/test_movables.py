"""Objects that can be pushed in the environment: their choice, the record of a touch, and new episodes."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.datatypes import Bodies, Contacts, SceneBank, SimState, ValidationError
from urbanverse_mjx.envs import registry
from urbanverse_mjx.envs.navigation.movables import Movables, body_sizes
from urbanverse_mjx.envs.navigation.scenarios import bank_for
from urbanverse_mjx.simulation.collision_slots.body_table import body_table

NOBODY = {f"crowd.slots.{kind}": 0 for kind in ("wheelchair", "scooter", "cyclist", "car")}
ONE_WALKER = {"scenario": "dynamic", "crowd.slots.pedestrian": 1, "vision": False, "impl": "warp", **NOBODY}


@pytest.mark.extended
def test_the_objects_nearest_to_the_route_are_chosen(small_bank: SceneBank) -> None:
    """Against a plain loop over objects and pieces of the route."""
    row = body_table(small_bank).row
    movables = Movables(small_bank, row, 5)
    near = jax.jit(movables.near)
    for z in range(small_bank.num_scenes):
        for e in (0, 7):
            start, route = small_bank.episode_start[z, e, :3], small_bank.episode_waypoints[z, e]
            points, objects = np.concatenate([start[None], route])[:, :2], np.flatnonzero(row[z] >= 0)
            distance = []
            for place in small_bank.slot_position[z, objects, :2]:
                pieces = []
                for a, b in itertools.pairwise(points):
                    length = max(float((b - a) @ (b - a)), 1e-9)
                    share = np.clip((place - a) @ (b - a) / length, 0.0, 1.0)
                    pieces.append(np.linalg.norm(place - a - share * (b - a)))
                distance.append(min(pieces))
            wanted = objects[np.argsort(distance)[:5]]
            assert set(np.asarray(near(z, start, route)).tolist()) == set(wanted.tolist())
    few = np.full_like(row, -1)
    few[0, objects[:2]] = 0
    found = np.asarray(Movables(small_bank, few, 5).near(jnp.int32(0), jnp.asarray(start), jnp.asarray(route)))
    assert sorted(found.tolist()) == sorted([-1, -1, -1, *objects[:2].tolist()])


def test_a_touch_of_one_is_told_apart() -> None:
    zero = jnp.zeros((2, 3))
    bodies = Bodies(jnp.array([4, -1]), zero, zero, zero, zero, zero)

    def said(obj: int, ended: bool) -> float:
        no, none = jnp.array(False), jnp.zeros(())
        contacts = Contacts(no, jnp.array(obj), no, none, none, none)
        sim = SimState(
            scene=jnp.int32(0),
            qpos=none,
            qvel=none,
            xpos=none,
            xquat=none,
            contacts=contacts,
            slot_overflow=none,
            carry=none,
            friction_scale=none,
            mass_scale=none,
            bodies=bodies,
        )
        return float(Movables.metrics(None, sim, jnp.array(ended))["hit_movable"])  # type: ignore[arg-type]

    assert said(4, True) == 1.0
    assert said(4, False) == said(5, True) == said(-1, True) == 0.0


def test_sizes_belong_to_the_scenario_dynamic(small_bank: SceneBank) -> None:
    config = registry.get_default_config("CocoNav", "cpu")
    assert body_sizes(config) is None
    dynamic = registry.with_overrides(config, {"scenario": "dynamic"})
    assert body_sizes(dynamic) == {"bodies": 8, "awake": 3, "hulls": 4}
    assert body_sizes(registry.with_overrides(dynamic, {"movable.bodies": 0})) is None
    assert body_sizes({"scenario": "dynamic"}) is None
    with pytest.raises(ValidationError, match=r"config\.movable"):
        body_sizes(registry.with_overrides(dynamic, {"movable.awake": 9}))
    assert not (body_table(bank_for("clean", small_bank)).row >= 0).any()


@pytest.mark.slow
def test_objects_are_pushed_in_an_episode_and_stand_in_their_places_in_the_next(small_bank: SceneBank) -> None:
    """A robot that drives into an object pushes it where hits end no episode; a reset restores all objects."""
    env = registry.load("CocoNav", config_overrides={**ONE_WALKER, "terminate_on_hit": False}, bank=small_bank)
    assert env.movables is not None
    nav = jax.jit(jax.vmap(env.begin))(jax.random.split(jax.random.key(0), 8))
    bodies = jax.device_get(nav.sim.bodies)
    scene = np.asarray(nav.sim.scene)
    assert (bodies.object_index >= 0).all()
    np.testing.assert_array_equal(bodies.position, small_bank.slot_position[scene[:, None], bodies.object_index])
    # Each robot stands a metre from its first object and drives at it.
    place = bodies.position[:, 0] - [1.4, 0.0, 0.0]
    qpos = nav.sim.qpos.at[:, :2].set(place[:, :2]).at[:, 3:7].set(jnp.array([1.0, 0.0, 0.0, 0.0]))
    nav = nav._replace(sim=nav.sim._replace(qpos=qpos, xpos=nav.sim.xpos.at[:, env._root, :2].set(place[:, :2])))
    step, ahead = jax.jit(jax.vmap(env.advance)), jnp.tile(jnp.array([1.0, 0.0]), (8, 1))
    named = set()
    for _ in range(12):
        nav, _, _, metrics = step(nav, ahead)
        assert set(metrics) == set(env.zero_metrics())
        hit = np.asarray(nav.sim.contacts.hit_object)
        named |= set(np.flatnonzero(hit == bodies.object_index[:, 0]).tolist())
    moved = np.linalg.norm(np.asarray(nav.sim.bodies.position) - bodies.position, axis=-1)
    assert len(named) >= 4
    assert (moved[:, 0] > 0.1).sum() >= 3
    again = jax.jit(jax.vmap(env.reset_episode))(nav)
    obj, where = np.asarray(again.sim.bodies.object_index), np.asarray(again.sim.bodies.position)
    np.testing.assert_array_equal(where, small_bank.slot_position[np.asarray(again.sim.scene)[:, None], obj])
    for field in ("velocity", "spin", "warm"):
        assert not np.asarray(getattr(again.sim.bodies, field)).any()
