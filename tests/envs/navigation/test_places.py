"""Scenes that come and go: a place is, to the bit, an environment that was loaded with its scene."""

import pathlib
import time
from collections.abc import Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import monitoring

from tests.support.placed import OVERRIDES, env_of, placed_env
from urbanverse_mjx import table_arguments
from urbanverse_mjx.datatypes import BankShards, PlacedBank, SceneBank, ValidationError
from urbanverse_mjx.envs import NavEnv, registry, wrap_for_training
from urbanverse_mjx.envs.navigation import place_scenes
from urbanverse_mjx.envs.navigation.places import ScenePlaces, spread_steps
from urbanverse_mjx.training.run import train

ENVS = 6


@pytest.fixture(scope="module")
def shards(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> BankShards:
    path = tmp_path_factory.mktemp("places") / "streets.bank"
    small_bank.save(path)
    return BankShards(path)


@pytest.fixture(scope="module")
def placed(shards: BankShards) -> Iterator[tuple[NavEnv, ScenePlaces]]:
    env = placed_env(shards)
    with ScenePlaces(env, 10) as places:
        places.begin(0, 10)
        yield env, places


def driven(env: NavEnv, begin: Any, step: Any, place: int) -> list[Any]:
    """What `ENVS` robots see, get and do in a place for some steps from rows of its scene."""
    keys, rows = jax.random.split(jax.random.key(3), ENVS), jnp.arange(ENVS, dtype=jnp.int32)
    nav = begin(keys, jnp.full(ENVS, place, jnp.int32), rows)
    out = []
    for _ in range(12):
        nav, obs, reward, done = step(nav, jnp.tile(jnp.array([1.0, 0.1]), (ENVS, 1)))
        out.append((obs, reward, done, nav.sim._replace(scene=nav.sim.scene * 0)))
    assert any(float(jnp.abs(reward).max()) > 0.0 for _, reward, _, _ in out)
    return out


def programs(env: NavEnv) -> tuple[Any, Any]:
    def step(nav: Any, action: jax.Array) -> Any:
        new, reward, done, _ = env.advance(nav, action)
        return new, env.observe(new), reward, done

    held = env.held
    begin = table_arguments.jit(jax.vmap(env.begin_at), held=held)
    return begin, table_arguments.jit(jax.vmap(step), held=held)


def assert_same(first: Any, second: Any) -> None:
    jax.tree.map(np.testing.assert_array_equal, first, second)


@pytest.mark.extended
def test_a_place_is_an_environment_loaded_with_its_scene(placed: tuple[NavEnv, ScenePlaces]) -> None:
    env, places = placed
    bank, shards = places.bank, places.bank.folder
    begin, step = programs(env)
    alone = {}
    for row in range(shards.num_scenes):
        one = env_of(shards, row)
        engines: list[Any] = [one.engine, env.engine]
        assert len({(engine.num_slots, engine.num_prism_slots) for engine in engines}) == 1
        alone[row] = driven(one, *programs(one), 0)
    assert any((a != b).any() for a, b in zip(*(jax.tree.leaves(alone[row][0][0]) for row in (0, 1)), strict=True))
    before = {place: driven(env, begin, step, place) for place in range(2)}
    for place, row in enumerate(bank.present(0)):
        assert_same(before[place], alone[row])
    for exchanges in range(1, 5):
        gone = places.before(10 * exchanges, None, lambda _, gone: gone)
        changed = (exchanges - 1) % 2
        np.testing.assert_array_equal(gone, np.arange(2) == changed)
        for place, row in enumerate(bank.present(exchanges)):
            found = driven(env, begin, step, place)
            assert_same(found, alone[row])
            if place != changed:
                assert_same(found, before[place])
            before[place] = found
    assert places.exchanges == 4
    assert places.reported()["places/exchanges"] == 4.0
    limit = time.monotonic() + 120.0
    while not list(places._folder.glob("scene-*")):
        assert time.monotonic() < limit, "what comes next is prepared"
        time.sleep(0.05)


@pytest.mark.extended
def test_new_episodes_begin_where_the_scene_has_gone_alone(placed: tuple[NavEnv, ScenePlaces]) -> None:
    env, _ = placed
    wrapped = wrap_for_training(env, env.config.episode_length)
    reset, reset_gone = (table_arguments.jit(f, held=wrapped.held) for f in (wrapped.reset, wrapped.reset_gone))
    step = table_arguments.jit(wrapped.step, held=wrapped.held)
    state = reset(jax.random.split(jax.random.key(0), 16))
    state = step(state, jnp.ones((16, 2)))
    place = np.asarray(state.data.sim.scene)
    assert set(place) == {0, 1}
    new, begins = reset_gone(state, jnp.array([True, False]))
    np.testing.assert_array_equal(begins, place == 0)
    stays = np.flatnonzero(place == 1)

    def data_of(tree: Any) -> Any:
        is_key = lambda x: jnp.issubdtype(x.dtype, jax.dtypes.prng_key)  # noqa: E731
        return jax.tree.map(lambda x: np.asarray(jax.random.key_data(x) if is_key(x) else x)[stays], tree)

    assert_same(data_of(new), data_of(state))
    gone = np.flatnonzero(place == 0)
    assert (np.asarray(new.data.steps)[gone] == 0).all()
    assert (np.asarray(new.data.episodes)[gone] == np.asarray(state.data.episodes)[gone] + 1).all()
    for name in ("truncation", "time_out", "episode_done"):
        assert (np.asarray(new.info[name])[gone] == 1.0).all()
    assert (np.asarray(new.done)[gone] == 1.0).all()
    assert_same(new.obs, jax.jit(jax.vmap(env.observe))(new.data))
    after = step(new, jnp.ones((16, 2)))
    lengths = np.asarray(after.info["episode_metrics"]["length"])
    assert (lengths[gone] == 1.0).all(), "sums of the next episode begin anew"
    assert (lengths[stays] == 2.0).all()


@pytest.mark.extended
def test_an_exchange_compiles_nothing(placed: tuple[NavEnv, ScenePlaces]) -> None:
    env, places = placed
    events: list[str] = []

    def listen(event: str, duration_secs: float, **kwargs: str | int) -> None:
        del duration_secs, kwargs
        if "/compile/" in event:
            events.append(event)

    wrapped = wrap_for_training(env, env.config.episode_length)
    reset, reset_gone = (table_arguments.jit(f, held=wrapped.held) for f in (wrapped.reset, wrapped.reset_gone))
    step = table_arguments.jit(wrapped.step, held=wrapped.held)
    state, action = reset(jax.random.split(jax.random.key(0), 8)), jnp.ones((8, 2))
    places.begin(0, 10)
    state = places.before(0, state, lambda state, gone: reset_gone(state, gone)[0])
    state = step(state, action)
    monitoring.register_event_duration_secs_listener(listen)
    try:
        for exchanges in range(1, 4):
            state = places.before(10 * exchanges, state, lambda state, gone: reset_gone(state, gone)[0])
            state = jax.block_until_ready(step(state, action))
        assert places.exchanges == 3
        assert not events
        jax.jit(lambda x: x + 17.25)(jnp.ones(5))
        assert events, "the listener hears of programs"
    finally:
        monitoring.unregister_event_duration_listener(listen)


def test_scenes_come_in_an_order_of_the_seed_again_and_again(shards: BankShards) -> None:
    rows = np.arange(3)
    bank = PlacedBank.open(shards, rows, 2, seed=5)
    order = np.random.default_rng(5).permutation(rows)
    np.testing.assert_array_equal(bank.rows, order)
    assert bank.scene_ids == tuple(shards.scene_ids[row] for row in order[:2])
    assert bank.all_ids == shards.scene_ids
    present = bank.present(0)
    assert present == order[:2].tolist()
    for exchange in range(1, 8):
        place, row = bank.coming(2 + exchange - 1)
        assert (place, row) == ((exchange - 1) % 2, int(order[(exchange + 1) % 3]))
        assert row not in present
        present[place] = row
        assert bank.present(exchange) == present
    assert spread_steps(bank, 1000, 64) == 500
    assert spread_steps(bank, 20, 64) == 32


def test_scenes_without_looks_are_the_same_streets(shards: BankShards) -> None:
    whole, plain = SceneBank.take(shards, [2, 0]), SceneBank.take(shards, [2, 0], looks=False)
    for name in ("inst_hull", "hull_planes", "prism_grid", "map_kind", "episode_waypoints"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(plain, name))
    assert (plain.slot_mesh == -1).all()
    assert plain.num_meshes == 0
    assert len(plain.texture_data) == 0
    rows = [SceneBank.take(shards, [row]) for row in range(3)]
    for row, one in enumerate(rows):
        np.testing.assert_array_equal(shards.skies[shards.scene_sky[row]], one.sky_radiance[one.scene_sky[0]])


def test_arrays_of_a_file_are_those_that_were_saved(tmp_path: pathlib.Path) -> None:
    tree = {
        "a": np.arange(5, dtype=np.int16),
        "b": [np.zeros((0, 3)), np.float32(2.0), "name"],
        "c": np.arange(12.0).reshape(3, 4)[:, ::-1],
    }
    place_scenes.save(tmp_path / "file", tree)
    found = place_scenes.load(tmp_path / "file")
    (tmp_path / "file").unlink()
    assert found["b"][1:] == tree["b"][1:]
    for first, second in ((found["a"], tree["a"]), (found["b"][0], tree["b"][0]), (found["c"], tree["c"])):
        np.testing.assert_array_equal(first, second)
        assert first.dtype == second.dtype


@pytest.mark.parametrize(
    ("overrides", "where"),
    [
        ({"scenario": "dynamic"}, "config.scenario"),
        ({"schedule.resident_scenes": 2}, "resident_scenes"),
        ({"schedule.learnable": 0.5}, "learnable"),
        ({"observations.clear_arcs": True}, "clear_arcs"),
        ({"impl": "warp"}, "warp-fused"),
        ({"vision_config.shadows": True}, "shadows"),
    ],
)
def test_what_does_not_change_with_its_scenes_is_refused(
    shards: BankShards, overrides: dict[str, Any], where: str
) -> None:
    bank = PlacedBank.open(shards, np.arange(3), 2, seed=0)
    with pytest.raises(ValidationError, match=where):
        registry.load("CocoNav", config_overrides={**OVERRIDES, **overrides}, bank=bank)


def test_numbers_that_do_not_fit_are_refused(shards: BankShards, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="fewer places than scenes"):
        PlacedBank.open(shards, np.arange(3), 3, seed=0)
    env = placed_env(shards)
    with pytest.raises(ValidationError, match="1 or more"):
        ScenePlaces(env, 0)
    with pytest.raises(ValidationError, match="at least 16"):
        ScenePlaces(env, 10).begin(0, 32)
    with pytest.raises(ValidationError, match="whose scenes stay"):
        ScenePlaces(env_of(shards, 0), 10)
    with pytest.raises(ValidationError, match="Brax's PPO"):
        train("CocoNav", env, registry.get_ppo_config("CocoNav", "cpu"), tmp_path / "run")
