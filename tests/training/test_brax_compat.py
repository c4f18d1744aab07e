"""The replacement of `jax.pmap` for Brax on one accelerator."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from brax.training.logger import EpisodeMetricsLogger

from urbanverse_mjx.training import brax_compat


def test_one_device_pmap_is_pmap_on_one_device() -> None:
    """With an axis name, arguments without the axis, and a function that closes over a table."""
    table = jnp.arange(5.0)

    def function(x: jax.Array, y: jax.Array) -> tuple[jax.Array, jax.Array]:
        return jax.lax.psum(x @ table, "i"), jax.lax.pmean(y, "i") + x

    x, y = jnp.arange(10.0).reshape(1, 2, 5), jnp.ones(5)
    one = jax.devices()[:1]
    wanted = jax.pmap(function, axis_name="i", in_axes=(0, None), devices=one)(x, y)
    found = brax_compat.one_device_pmap(function, axis_name="i", in_axes=(0, None), devices=one)(x, y)
    for a, b in zip(found, wanted, strict=True):
        assert a.shape == b.shape
        np.testing.assert_allclose(a, b, rtol=1e-6)


def test_it_is_for_one_accelerator_alone() -> None:
    """On the CPU of the tests nothing changes: neither JAX's setting nor what Brax sees."""
    before = getattr(jax.config, brax_compat._AS_ARGUMENTS)
    assert not brax_compat.tables_as_arguments()
    assert getattr(jax.config, brax_compat._AS_ARGUMENTS) == before
    assert brax_compat.load_ppo().jax is jax


def test_brax_sees_all_else_of_jax() -> None:
    seen = brax_compat._JaxOnOneDevice("jax")
    assert seen.jit is jax.jit
    assert seen.pmap is brax_compat.one_device_pmap
    tree = {"a": jnp.arange(3), "b": (jnp.ones((2, 2)),)}
    placed = seen.device_put_replicated(tree, jax.devices()[:1])
    np.testing.assert_array_equal(placed["a"], jnp.arange(3)[None])
    assert placed["b"][0].shape == (1, 2, 2)


def test_metrics_are_braxs_and_another_number_of_ended_episodes_compiles_nothing(
    caplog: pytest.LogCaptureFixture,
) -> None:
    rng = np.random.default_rng(0)
    ours, theirs = list[dict[str, float]](), list[dict[str, float]]()
    loggers = (
        brax_compat.load_ppo().metric_logger.EpisodeMetricsLogger(100, 1, lambda _, found: ours.append(found)),
        EpisodeMetricsLogger(100, 1, lambda _, found: theirs.append(found)),
    )

    def rollout(ended: int) -> tuple[dict[str, jax.Array], jax.Array, dict[str, jax.Array]]:
        dones = np.zeros(5 * 7, np.float32)
        dones[rng.choice(len(dones), ended, replace=False)] = 1.0
        draw = lambda: jnp.asarray(rng.uniform(1.0, 9.0, (5, 7)), jnp.float32)  # noqa: E731
        metrics = {"length": draw(), "reward": draw(), "hit_per_step": draw()}
        return metrics, jnp.asarray(dones.reshape(5, 7)), {"loss": jnp.asarray(rng.uniform(size=3), jnp.float32)}

    for ended in (0, 3, 17, 35):
        for logger, arrays in zip(loggers, [rollout(ended)] * 2, strict=True):
            logger.update_episode_metrics(*arrays)
    assert len(ours) == len(theirs) == 4
    for one, other in zip(ours, theirs, strict=True):
        assert one.pop("episode/sps") > 0.0
        other.pop("episode/sps")
        assert one.keys() == other.keys()
        assert one == pytest.approx(other, rel=1e-6)
    more = [rollout(ended) for ended in (1, 2, 5, 8, 13, 21, 34)]
    with jax.log_compiles():
        for logger, compiled in zip(loggers, (False, True), strict=True):
            caplog.clear()
            for arrays in more:
                logger.update_episode_metrics(*arrays)
            assert ("Finished XLA compilation" in caplog.text) is compiled, "Brax's own does: else this is not needed"
