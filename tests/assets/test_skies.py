"""Skies: plausible shares of sunlight and skylight, balanced colours, brightness fit for a display."""

import numpy as np
import pytest

from urbanverse_mjx.assets.appearances import skies
from urbanverse_mjx.datatypes import ValidationError

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def pixel_directions() -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and solid angles of the pixels, from the datatype's words alone (zenith first, yaw from -pi)."""
    polar = (np.arange(64)[:, None] + 0.5) * np.pi / 64
    yaw = (np.arange(128)[None, :] + 0.5) * 2 * np.pi / 128 - np.pi
    xyz = np.stack([np.sin(polar) * np.cos(yaw), np.sin(polar) * np.sin(yaw), np.cos(polar) + 0 * yaw], -1)
    return xyz, np.sin(polar) * (np.pi / 64) * (2 * np.pi / 128) + 0 * yaw


def irradiance_on_the_ground(sky: skies.Sky) -> tuple[np.ndarray, np.ndarray]:
    """(from the sky, from the sun), each (3,)."""
    xyz, solid = pixel_directions()
    weight = np.clip(xyz[..., 2], 0, None) * solid
    return (sky.radiance * weight[..., None]).sum((0, 1)), sky.sun_irradiance * sky.sun_direction[2]


@pytest.mark.extended
def test_there_are_enough_and_they_differ() -> None:
    ids = skies.sky_ids()
    assert len(ids) >= 8
    assert len({skies.build_sky(i).radiance.tobytes() for i in ids}) == len(ids)
    assert len({skies.build_sky(i).description for i in ids}) == len(ids)


@pytest.mark.parametrize("sky_id", skies.sky_ids())
def test_a_white_surface_is_display_friendly(sky_id: str) -> None:
    sky = skies.build_sky(sky_id)
    assert sky.radiance.shape == (64, 128, 3)
    assert sky.radiance.dtype == np.float32
    assert np.isfinite(sky.radiance).all()
    assert sky.radiance.min() >= 0
    assert np.linalg.norm(sky.sun_direction) == pytest.approx(1, abs=1e-6)
    assert sky.sun_direction[2] > 0
    total = sum(irradiance_on_the_ground(sky)) @ LUMINANCE / np.pi
    # A low sun lights walls rather than the ground.
    assert (0.45 if sky.sun_direction[2] < 0.3 else 0.6) < total < 1.0


@pytest.mark.parametrize("sky_id", ["clear_morning", "hazy"])
def test_the_brightest_place_of_a_cloudless_sky_is_round_the_sun(sky_id: str) -> None:
    sky = skies.build_sky(sky_id)
    xyz, _ = pixel_directions()
    near_sun = xyz @ sky.sun_direction
    above = xyz[..., 2] > 0.45  # away from the horizon, which is bright as well
    luminance = np.where(above, sky.radiance @ LUMINANCE, 0)
    assert np.degrees(np.arccos(near_sun.flat[luminance.argmax()])) < 25


def test_clear_sky_is_blue_and_mostly_sunlit_and_overcast_is_grey_and_shadowless() -> None:
    sky, sun = irradiance_on_the_ground(skies.build_sky("clear_noon"))
    assert sky[2] > 2 * sky[0]
    assert 0.1 < (sky @ LUMINANCE) / ((sky + sun) @ LUMINANCE) < 0.35
    sky, sun = irradiance_on_the_ground(skies.build_sky("overcast_grey"))
    assert sky.max() < 1.15 * sky.min()
    assert sun @ LUMINANCE < 0.02 * (sky @ LUMINANCE)


def test_a_low_sun_is_redder_than_a_high_one() -> None:
    redness = [
        (s := skies.build_sky(i).sun_irradiance)[0] / s[2] for i in ("clear_noon", "clear_morning", "golden_hour")
    ]
    assert redness[0] < redness[1] < redness[2]


def test_overcast_follows_the_standard_gradation() -> None:
    """The CIE standard overcast sky: the zenith is about three times as bright as the horizon (clouds blur it)."""
    rows = (skies.build_sky("overcast_grey").radiance @ LUMINANCE).mean(1)
    assert 1.8 < rows[0] / rows[31] < 4.0


def test_the_panorama_wraps_round() -> None:
    """The step over the seam at yaw ±pi is like any other step."""
    for sky_id in skies.sky_ids():
        top = skies.build_sky(sky_id).radiance[:28]
        steps = np.abs(np.diff(top, axis=1)).mean((0, 2))
        assert np.abs(top[:, 0] - top[:, -1]).mean() <= steps.max() + 1e-6


def test_same_id_same_numbers_and_unknown_id() -> None:
    first = skies.build_sky("partly_cloudy").radiance.copy()
    skies.build_sky.cache_clear()
    assert np.array_equal(first, skies.build_sky("partly_cloudy").radiance)
    with pytest.raises(ValidationError, match="clear_noon"):
        skies.build_sky("green")
