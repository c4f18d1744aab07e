"""No product of matrices in a step is left to a GPU's ten bits."""

from collections.abc import Iterator
from typing import Any

import jax
import jax.extend
import jax.numpy as jnp
import pytest

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry
from urbanverse_mjx.precision import full_precision


def products(jaxpr: Any) -> Iterator[Any]:
    """The precisions of all products in a program and in those it calls."""
    for equation in jaxpr.eqns:
        if equation.primitive.name == "dot_general":
            yield equation.params["precision"]
        for value in jax.tree.leaves(list(equation.params.values()), is_leaf=lambda x: hasattr(x, "eqns")):
            inner = getattr(value, "jaxpr", value)
            if hasattr(inner, "eqns"):
                yield from products(inner)


# On "warp" the step itself is Warp's: JAX multiplies only what the observation and the camera need.
@pytest.mark.extended
@pytest.mark.parametrize(("impl", "least"), [("jax", 4), ("warp", 2)])
def test_every_product_in_an_env_is_of_full_precision(small_bank: SceneBank, impl: str, least: int) -> None:
    overrides = {"preset": "cpu", "scenes": "all", "impl": impl, "vision_config.height": 12, "vision_config.width": 20}
    env = registry.load("CocoNav", config_overrides=overrides, bank=small_bank)
    keys, action = jax.random.split(jax.random.key(0), 2), jnp.zeros((2, env.action_size))

    def episode(keys: jax.Array, action: jax.Array) -> Any:
        return jax.vmap(env.step)(jax.vmap(env.reset)(keys), action)

    found = list(products(jax.make_jaxpr(episode)(keys, action).jaxpr))
    assert len(found) >= least
    highest = jax.lax.Precision.HIGHEST
    assert {p if isinstance(p, tuple) else (p, p) for p in found} == {(highest, highest)}


def test_the_caller_keeps_its_own_precision() -> None:
    @full_precision
    def inner(x: jax.Array) -> jax.Array:
        return x @ x

    jaxpr = jax.make_jaxpr(lambda x: inner(x) + x @ x)(jnp.ones((2, 2))).jaxpr
    assert [p is None for p in products(jaxpr)] == [False, True]
