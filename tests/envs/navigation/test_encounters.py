"""Where the scripted people of an encounter begin, relative to the route."""

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.crowds import behaviours
from urbanverse_mjx.envs.navigation import encounters


@pytest.mark.parametrize("heading", [0.0, 1.1, -2.5])
def test_a_place_beside_the_route_is_in_its_frame(heading: float) -> None:
    pose = jnp.float32(3.0), jnp.float32(-1.0), jnp.float32(heading)
    x, y, turned = encounters._beside(pose, jnp.float32(0.7), 2.0)
    cos, sin = np.cos(heading), np.sin(heading)
    np.testing.assert_allclose([x, y, turned], [3 + 2 * cos - 0.7 * sin, -1 + 2 * sin + 0.7 * cos, heading], atol=1e-5)


def test_who_comes_head_on_meets_the_robot_at_the_drawn_place() -> None:
    """Six metres before it, walking back along the route."""
    pose = jnp.float32(3.0), jnp.float32(-1.0), jnp.float32(1.1)
    found = encounters.ENCOUNTERS["head_on"][2](pose, jnp.float32(1.0))
    by_hand = behaviours.head_on(*encounters._beside(pose, jnp.float32(0.3), -6.0), distance=6.0)
    for a, b in zip(found, by_hand, strict=True):
        np.testing.assert_array_equal(a, b)
    assert np.hypot(found.x - 3.0, found.y + 1.0) == pytest.approx(0.3, abs=1e-4)
