import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx import srgb

#: Encoded value, and the linear light that the tables of IEC 61966-2-1 give for it.
KNOWN = ((0.0, 0.0), (0.04045, 0.0031308), (0.5, 0.214041), (0.735357, 0.5), (1.0, 1.0))


@pytest.mark.parametrize("xp", [np, jnp])
def test_known_values_in_both_directions(xp: object) -> None:
    for value, light in KNOWN:
        assert float(srgb.linear(xp.asarray([value]))[0]) == pytest.approx(light, abs=2e-6)  # type: ignore[attr-defined]
        assert float(srgb.encoded(xp.asarray([light]))[0]) == pytest.approx(value, abs=2e-6)  # type: ignore[attr-defined]


def test_eight_bits_survive_both_ways_and_light_outside_is_clipped() -> None:
    levels = np.arange(256) / 255.0
    assert np.abs(srgb.encoded(srgb.linear(levels)) - levels).max() < 1e-7
    assert srgb.encoded(np.array([-1.0, 0.0, 1.0, 7.0])) == pytest.approx([0.0, 0.0, 1.0, 1.0])


def test_values_keep_their_precision() -> None:
    assert srgb.encoded(np.asarray([0.3], np.float32)).dtype == np.float32
    assert srgb.linear(jnp.asarray([0.3], np.float32)).dtype == jnp.float32
