"""The replacement of `jax.pmap` for Brax on one accelerator."""

import jax
import jax.numpy as jnp
import numpy as np

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
