"""The training schedule: which scenes are in use when, and how long routes may be."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import default_config, wrap_for_training
from urbanverse_mjx.envs.navigation.schedule import EpisodeSchedule

DRAWS = 4000


def make(bank: SceneBank, **values: float) -> EpisodeSchedule:
    config = default_config().schedule
    config.update(values)
    return EpisodeSchedule(config, bank, np.arange(bank.num_scenes, dtype=np.int32))


def draws(schedule: EpisodeSchedule, age: int = 0, episodes: int = 0) -> tuple[np.ndarray, np.ndarray]:
    draw = jax.jit(jax.vmap(lambda key: schedule.draw(key, jnp.int32(age), jnp.int32(episodes))))
    scene, row = draw(jax.random.split(jax.random.key(0), DRAWS))
    return np.asarray(scene), np.asarray(row)


def test_without_a_schedule_every_route_of_every_scene_is_drawn(small_bank: SceneBank) -> None:
    scene, row = draws(make(small_bank), age=10**6, episodes=12345)
    for z in range(small_bank.num_scenes):
        count = int(small_bank.num_episodes[z])
        seen = np.bincount(row[scene == z], minlength=count)
        assert len(seen) == count
        # A uniform draw leaves a row out with probability (1 - 1/count)^n.
        assert (seen == 0).mean() < 3 * np.exp(-(scene == z).sum() / count) + 0.01
    assert np.abs(np.bincount(scene) / DRAWS - 1 / small_bank.num_scenes).max() < 0.05


def test_resident_scenes_are_swapped_and_all_come_round(small_bank: SceneBank) -> None:
    schedule = make(small_bank, resident_scenes=2, episodes_per_swap=5)
    used = [set(draws(schedule, episodes=e)[0].tolist()) for e in range(0, 30, 5)]
    assert all(len(group) == 2 for group in used)
    assert set(draws(schedule, episodes=4)[0].tolist()) == used[0] != used[1]
    # Three scenes, two at a time: every three swaps each scene was in use twice.
    for first in (0, 3):
        assert sorted(z for group in used[first : first + 3] for z in group) == [0, 0, 1, 1, 2, 2]


def test_routes_grow_longer(small_bank: SceneBank) -> None:
    schedule = make(small_bank, start_distance=14.0, ramp_steps=1000)
    longest = []
    for age in (0, 300, 600, 999, 1000):
        scene, row = draws(schedule, age)
        longest.append(float(small_bank.episode_length[scene, row].max()))
    assert longest == sorted(longest)
    lengths = [small_bank.episode_length[z, :n] for z, n in enumerate(small_bank.num_episodes)]
    every = max(float(part.max()) for part in lengths)
    assert longest[0] <= max(14.0, max(float(np.sort(part)[7]) for part in lengths)) + 1e-4 < every
    assert longest[-1] == pytest.approx(every)


def test_a_limit_below_every_route_leaves_the_shortest_eight(small_bank: SceneBank) -> None:
    scene, row = draws(make(small_bank, start_distance=0.5, ramp_steps=10**6))
    for z in range(small_bank.num_scenes):
        assert len(np.unique(row[scene == z])) == 8
        lengths = np.sort(small_bank.episode_length[z, : int(small_bank.num_episodes[z])])
        assert small_bank.episode_length[z, row[scene == z]].max() == pytest.approx(lengths[7])


@pytest.mark.extended
def test_counts_outlive_episodes(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"episode_length": 5, "terminate_off_traversable": False})
    wrapped = wrap_for_training(env, 5)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.key(0), 3))
    step = jax.jit(wrapped.step)
    for _ in range(12):
        state = step(state, jnp.full((3, 2), 0.01))
    assert np.asarray(state.data.age).tolist() == [12] * 3
    assert np.asarray(state.data.episodes).tolist() == [2] * 3
    assert np.asarray(state.data.steps).tolist() == [2] * 3


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"resident_scenes": -1}, "resident_scenes"),
        ({"episodes_per_swap": 0}, "episodes_per_swap"),
        ({"start_distance": 12.0}, "both or neither"),
        ({"ramp_steps": 5}, "both or neither"),
        ({"learnable": 1.5}, "between 0 and 1"),
        ({"learnable": 0.5, "resident_scenes": 2}, "one of them"),
    ],
)
def test_broken_schedules_are_refused(small_bank: SceneBank, values: dict[str, float], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        make(small_bank, **values)
