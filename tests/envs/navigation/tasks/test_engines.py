"""`FollowRoute` and `CrossStreet` on both engines: the same episode, and what the task counts in it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.compiling import optimized
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry

#: Control steps of 0.2 s, in which the robot drives up to 1.5 m and touches nothing.
STEPS = 5


@pytest.mark.slow
@pytest.mark.parametrize(("name", "cars"), [("CocoFollowRoute", 1), ("CocoCrossStreet", 6)])
def test_both_engines_run_the_same_episode(small_bank: SceneBank, name: str, cars: int) -> None:
    slots = {f"crowd.slots.{kind}": 0 for kind in ("pedestrian", "wheelchair", "scooter", "cyclist")}
    options = {**slots, "crowd.slots.car": cars, "vision": False, "scenes": small_bank.scene_ids[0]}
    found = {}
    for impl in ("jax", "warp-fused"):
        config = registry.with_overrides(registry.get_default_config(name, "cpu"), {**options, "impl": impl})
        env = registry.load_nav_env(name, config, small_bank)
        with optimized():
            nav = jax.jit(env.begin_at)(jax.random.key(0), jnp.int32(0), jnp.int32(0))
            step = jax.jit(lambda nav, env=env: env.advance(nav, jnp.array([0.8, 0.1]))[0])
            for _ in range(STEPS):
                nav = step(nav)
        found[impl] = nav
    one, other = found.values()
    np.testing.assert_allclose(one.sim.xpos[1], other.sim.xpos[1], atol=2e-3)
    assert float(one.driven) > 0.5
    assert int(one.result) == int(other.result)
    for a, b in zip(jax.tree.leaves(one.task), jax.tree.leaves(other.task), strict=True):
        np.testing.assert_allclose(a, b, atol=2e-2)
    first, second = (env.observe(nav)["privileged"] for nav in found.values())
    np.testing.assert_allclose(first, second, atol=2e-2)
