"""Incentives of the presets: discounted returns of driving straight to the goal, crawling and standing short."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.unicycle import UnicycleEngine, unicycle_robot
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.envs import PRESETS, NavEnv, Result, default_config
from urbanverse_mjx.envs.navigation.config import go2_nav_config
from urbanverse_mjx.envs.navigation.scenarios import bank_for, select_scenes
from urbanverse_mjx.envs.registry import with_overrides
from urbanverse_mjx.training.config import default_ppo_config

#: Presets that keep published reward terms, which have the fault (docs/decisions/presets.md).
PUBLISHED = ("paper", "urbansim_v0_1")
DISTANCES = np.array([1.01, 1.5, 3.0, 10.0, 25.0])  # m to the goal at the start
SPEEDS = np.array([0.0, 0.05, 0.2, 0.5, 1.0, 2.0])  # m/s; the last is COCO's greatest


class Returns:
    """Discounted returns of one preset on open ground, (distances, speeds), and how the episodes end.

    A time-out is a truncation: the trainer bootstraps with the value of the last state, which for a standing robot is
    the last reward for ever.
    """

    def __init__(self, preset: str, bank: SceneBank):
        config = with_overrides(default_config(preset), {"action_mode": "velocity", "terminate_off_traversable": False})
        robot = unicycle_robot()
        assert robot.max_speed == SPEEDS[-1]
        engine = UnicycleEngine(robot, config.ctrl_dt)
        env = NavEnv(with_overrides(config, {"scenes": "all"}), bank_for("clean", bank), robot, engine, None)
        discount = default_ppo_config(preset).discounting

        def run(distance: jax.Array, speed: jax.Array) -> tuple[jax.Array, jax.Array]:
            nav = env.begin_at(jax.random.key(0), jnp.int32(0), jnp.int32(0))
            # A millimetre nearer: crawling steps would else end on the radius, where rounding decides of one more.
            distance = distance - 1e-3
            pose = env.qpos0.at[3:7].set(jnp.array([1.0, 0.0, 0.0, 0.0]))
            nav = nav._replace(
                sim=engine.init(jnp.int32(0), pose, nav.sim.qvel),
                goal=pose[:3].at[0].add(distance),
                goal_distance=distance,
            )
            action = jnp.stack([2.0 * speed / robot.max_speed - 1.0, 0.0])

            def step(carry: Any, _: None) -> tuple[Any, None]:
                nav, value, factor, result = carry
                new, reward = env.advance(nav, action)[:2]
                running = result == Result.RUNNING
                value = value + jnp.where(running, factor * reward, 0.0)
                forever = factor * discount / (1.0 - discount) * reward
                value = value + jnp.where(running & (new.result == Result.TIMEOUT), forever, 0.0)
                return (new, value, factor * discount, jnp.where(running, new.result, result)), None

            start = (nav, jnp.float32(0.0), jnp.float32(1.0), jnp.int32(Result.RUNNING))
            (_, value, _, result), _ = jax.lax.scan(step, start, None, config.episode_length)
            return value, result

        over_speeds = jax.vmap(run, (None, 0))
        value, result = jax.jit(jax.vmap(over_speeds, (0, None)))(
            jnp.asarray(DISTANCES, jnp.float32), jnp.asarray(SPEEDS, jnp.float32)
        )
        self.value, self.result = np.asarray(value), np.asarray(result)

    def at(self, distance: float, speed: float) -> float:
        return float(self.value[list(DISTANCES).index(distance), list(SPEEDS).index(speed)])


# A preset that learns by imitation has no discount; its rewards are those of `cpu`.
@pytest.mark.parametrize(
    "preset", [p for p in PRESETS if p not in PUBLISHED and "algorithm" not in default_ppo_config(p)]
)
def test_driving_to_the_goal_pays_most_and_neither_crawling_nor_standing_short(
    preset: str, small_bank: SceneBank
) -> None:
    returns = Returns(preset, small_bank)
    assert (returns.result[:, -1] == Result.GOAL).all()
    assert (returns.result[:, 0] == Result.TIMEOUT).all()
    assert (np.diff(returns.value, axis=1) > 0).all(), f"faster is better from everywhere: {returns.value}"
    standing, crawling, full = returns.value[:, 0], returns.value[:, 1], returns.value[:, -1]
    assert (standing <= 0.1 * full).all()
    assert (crawling[1:] <= 0.7 * full[1:]).all()
    # Both robots are rewarded alike.
    assert go2_nav_config(preset).reward_config == default_config(preset).reward_config


def test_published_terms_pay_as_their_documentation_says(small_bank: SceneBank) -> None:
    paper, urbansim = (Returns(preset, small_bank) for preset in PUBLISHED)
    assert paper.at(1.5, 0.05) == pytest.approx(2215, abs=3)
    assert paper.at(1.5, 2.0) == pytest.approx(2046, abs=3)
    assert paper.at(1.01, 0.0) == pytest.approx(1972, abs=3)
    assert paper.at(1.01, 2.0) == pytest.approx(2042, abs=3)
    assert urbansim.at(1.5, 0.05) == pytest.approx(171, abs=1)
    assert urbansim.at(1.5, 2.0) == pytest.approx(225, abs=1)
    assert urbansim.at(1.01, 0.0) == pytest.approx(197, abs=1)
    assert urbansim.at(1.01, 0.05) == pytest.approx(203, abs=1)


def test_scenes_are_named_by_split_or_id(small_bank: SceneBank) -> None:
    ids = small_bank.scene_ids
    assert select_scenes(small_bank, "all").tolist() == [0, 1, 2]
    assert select_scenes(small_bank, f"{ids[2]},{ids[0]}").tolist() == [2, 0]
    assert select_scenes(small_bank, [ids[1]]).tolist() == [1]
    for split in set(small_bank.meta["splits"]):
        rows = [k for k, name in enumerate(small_bank.meta["splits"]) if name == split]
        assert select_scenes(small_bank, split).tolist() == rows
    for which, name in (([], r"\[\]"), ("", "''"), (f"{ids[0]},nowhere", "'nowhere'"), (["nowhere"], "'nowhere'")):
        with pytest.raises(ValidationError, match=rf"found {name}, which names no scene.*its 3 scenes \({ids[0]}, "):
            select_scenes(small_bank, which)
