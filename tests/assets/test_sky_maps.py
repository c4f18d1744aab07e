"""The 306 skies: light that follows the formulas, images without black, bands or seams, search and matching."""

import hashlib

import numpy as np
import pytest

from urbanverse_mjx.assets.appearances import appearance_search, skies
from urbanverse_mjx.assets.appearances.grounds import ground_records
from urbanverse_mjx.assets.appearances.sky_maps import atmosphere, clouds, paint_sky, sky_records
from urbanverse_mjx.assets.appearances.sky_maps.table import MOMENTS, WEATHERS, unit_to_sun
from urbanverse_mjx.datatypes import ValidationError

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
RECORDS = {record.uid: record for record in sky_records()}
#: Every moment and every weather at least once.
SOME = [f"{moment}-{weather}" for moment, weather in zip(list(MOMENTS) + ["summer_noon"], WEATHERS, strict=True)]


def directions(height: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and solid angles of the pixels, from the datatype's words alone."""
    polar = (np.arange(height)[:, None] + 0.5) * np.pi / height
    yaw = (np.arange(2 * height)[None, :] + 0.5) * np.pi / height - np.pi
    xyz = np.stack([np.sin(polar) * np.cos(yaw), np.sin(polar) * np.sin(yaw), np.cos(polar) + 0 * yaw], -1)
    return xyz, np.sin(polar) * (np.pi / height) ** 2 + 0 * yaw


def test_there_are_as_many_as_the_paper_has() -> None:
    assert len(RECORDS) == 306
    assert len({record.description for record in sky_records()}) == 306
    assert {record.season for record in sky_records()} == {"spring", "summer", "autumn", "winter"}
    assert sum(record.time == "night" for record in sky_records()) == 18


def test_the_table_is_the_same_on_every_machine() -> None:
    text = "\n".join(repr(record) for record in sky_records())
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == "4ce52fc85a0f2def"


@pytest.mark.parametrize("uid", SOME)
def test_a_sky_is_neither_black_nor_seamed_and_exposed_as_it_says(uid: str) -> None:
    sky, record = paint_sky(uid, 128), RECORDS[uid]
    assert sky.radiance.shape == (128, 256, 3)
    assert sky.radiance.dtype == np.float32
    assert np.isfinite(sky.radiance).all()
    luminance = sky.radiance @ LUMINANCE
    assert luminance[:62].min() > 0.02 * record.exposure, "no black in the sky"
    steps = np.abs(np.diff(luminance[:58], axis=1)).mean(0)
    assert np.abs(luminance[:58, 0] - luminance[:58, -1]).mean() <= steps.max() + 1e-6
    xyz, solid = directions(128)
    weight = np.clip(xyz[..., 2], 0, None) * solid
    # A low sun counts as if it stood at 20 degrees: it lights walls.
    facing = max(float(sky.sun_direction[2]), 0.35) if sky.sun_direction[2] > 0 else 0.0
    total = ((sky.radiance * weight[..., None]).sum((0, 1)) + sky.sun_irradiance * facing) @ LUMINANCE / np.pi
    assert total == pytest.approx(record.exposure, rel=0.15)
    assert np.allclose(sky.sun_direction, unit_to_sun(record), atol=1e-6)


@pytest.mark.parametrize("uid", ["summer_noon-crisp", "spring_morning-clear", "winter_dusk-clear", "autumn_noon-smog"])
def test_a_cloudless_sky_has_no_bands(uid: str) -> None:
    """From row to row brightness changes smoothly: no step differs from its neighbours by more than 4 %."""
    luminance = paint_sky(uid, 256).radiance[:112] @ LUMINANCE
    steps = np.diff(np.log(luminance), axis=0)
    assert np.abs(np.diff(steps, axis=0)).max() < 0.04


def test_sunlight_overhead_is_what_the_optical_depths_say() -> None:
    """exp(-tau) by hand: molecules 8 km, haze 1.2 km, and a tent of ozone 30 km wide at its foot."""
    air = atmosphere.build_air(2.0)
    haze = atmosphere.RAYLEIGH_SCATTERING[1] * 8000  # turbidity 2: as much haze as air, to within the 550 nm of both
    tau = atmosphere.RAYLEIGH_SCATTERING * 8000 + haze + atmosphere.OZONE_ABSORPTION * 15_000
    assert air.sunlight(1.0) / atmosphere.SUNLIGHT == pytest.approx(np.exp(-tau), rel=0.02)


def test_the_sun_reddens_and_sets() -> None:
    air = atmosphere.build_air(1.5)
    high, low = air.sunlight(0.9), air.sunlight(0.05)
    assert high[0] / high[2] < 1.5 < 3 < low[0] / low[2]
    assert air.sunlight(-0.02).max() == 0


def test_the_zenith_of_a_clear_day_is_bluer_and_darker_than_its_horizon() -> None:
    air = atmosphere.build_air(1.5)
    zenith, low = atmosphere.clear_sky(air, np.sin(np.radians([89, 4])), np.array([np.pi / 2]), np.sin(np.radians(45)))[
        :, 0
    ]
    assert zenith[2] / zenith[0] > 1.4 * low[2] / low[0]
    assert low @ LUMINANCE > 1.5 * (zenith @ LUMINANCE)


def test_the_brightest_place_of_a_clear_sky_is_round_the_sun() -> None:
    sky = paint_sky("autumn_noon-clear", 128)
    xyz, _ = directions(128)
    brightest = (sky.radiance[:60] @ LUMINANCE).argmax()
    assert np.degrees(np.arccos(xyz[:60].reshape(-1, 3)[brightest] @ sky.sun_direction)) < 3


def test_overcast_is_grey_shadowless_and_brighter_overhead() -> None:
    sky = paint_sky("spring_noon-overcast", 128)
    mean = sky.radiance[:60].mean((0, 1))
    assert mean.max() < 1.2 * mean.min()
    assert not sky.sun_irradiance.any()
    rows = (sky.radiance @ LUMINANCE).mean(1)
    assert 1.6 < rows[:6].mean() / rows[56:60].mean() < 4.0


@pytest.mark.parametrize("cover", [0.15, 0.5, 0.9])
def test_clouds_cover_what_they_should(cover: float) -> None:
    water = clouds.grow(clouds.Heaps(cover), np.random.default_rng(3))
    assert (water.max(0) > 0.1).mean() == pytest.approx(cover, abs=0.13)
    assert np.abs(water[..., 0] - water[..., -1]).mean() < 2 * np.abs(np.diff(water, axis=-1)).mean() + 0.01


def test_a_layer_over_a_round_earth_ends_at_the_horizon() -> None:
    """sqrt(2 R h + h^2) by hand: a base at 1,200 m is 124 km away at the horizon and 1,200 m overhead."""
    assert clouds.distance_to(np.array([1.0, 0.0]), 1200.0) == pytest.approx([1200.0, 123_660.0], rel=1e-3)


def test_finer_pictures_show_the_same_clouds() -> None:
    uid = "summer_afternoon-scattered_cumulus"
    coarse, fine = paint_sky(uid, 96).radiance, paint_sky(uid, 192).radiance
    fine = fine.reshape(96, 2, 192, 2, 3).mean((1, 3))
    assert np.corrcoef(coarse[:40].ravel(), fine[:40].ravel())[0, 1] > 0.9


def test_same_uid_same_numbers_and_unknown_uid() -> None:
    first, again = paint_sky("night-broken_cumulus", 64), paint_sky("night-broken_cumulus", 64)
    assert np.array_equal(first.radiance, again.radiance)
    with pytest.raises(ValidationError, match="night-clear"):
        paint_sky("night-cheese")


@pytest.mark.parametrize("uid", ["summer_noon-few_cumulus", "winter_dusk-cirrus", "night-clear"])
def test_scenes_take_them(uid: str) -> None:
    sky = skies.build_sky(uid)
    assert sky.radiance.shape == (64, 128, 3)
    assert sky.radiance.max() <= skies.MAX_RADIANCE
    assert sky.sun_direction[2] > 0
    assert np.linalg.norm(sky.sun_direction) == pytest.approx(1, abs=1e-5)
    if uid.startswith("winter_dusk"):
        assert not sky.sun_irradiance.any()


@pytest.mark.parametrize("uid", ["autumn_noon-mackerel", "spring_dawn-rain"])
def test_stored_thumbnails_are_those_of_today(uid: str) -> None:
    stored = appearance_search.sky.load_thumbnails([uid])[uid].astype(float)
    assert np.abs(stored - appearance_search.sky_thumbnail(uid)).mean() < 6


def test_a_crop_of_a_sky_finds_it_by_its_histogram() -> None:
    thumbnails = appearance_search.sky.load_thumbnails()
    first = 0
    for uid in SOME:
        descriptor = appearance_search.sky_descriptor(thumbnails[uid][20:40])
        assert len(descriptor) == 64
        assert 0 <= min(descriptor) <= max(descriptor) <= 255
        ranked = appearance_search.rank_skies(descriptor)
        assert len(ranked) == 306
        first += uid in [name for name, distance in ranked if distance < 1e-6]
    assert first == len(SOME)
    blue = np.full((8, 16, 3), (70, 120, 200), np.uint8)
    grey = np.full((8, 16, 3), (200, 200, 200), np.uint8)
    kinds = [
        RECORDS[appearance_search.rank_skies(appearance_search.sky_descriptor(crop))[0][0]].kind
        for crop in (blue, grey)
    ]
    assert kinds[0] not in ("overcast", "stratus")
    assert kinds[1] in ("overcast", "stratus", "hazy")
    with pytest.raises(ValidationError, match="64"):
        appearance_search.rank_skies((1, 2, 3))


def test_search() -> None:
    found = appearance_search.sky.get_uids_conditioned(
        seasons=["winter"], kinds=["clear", "hazy"], sun_elevation_range=(10, None)
    )
    assert found
    assert all(RECORDS[u].season == "winter" and RECORDS[u].sun_elevation >= 10 for u in found)
    best = appearance_search.sky.get_uids_conditioned(query="mackerel sky at a spring sunset", top_k=1)
    assert best == ["spring_sunset-mackerel"]
    assert appearance_search.sky.load_annotations(best)[best[0]]["kind"] == "cirrus"
    snowy = appearance_search.sky.get_uids_conditioned(snow=True)
    assert all(RECORDS[u].snow for u in snowy)
    assert 0 < len(snowy) < 54
    with pytest.raises(ValidationError, match="true or false"):
        appearance_search.sky.get_uids_conditioned(snow="yes")


def test_its_own_descriptor_finds_every_material_and_sky_first():
    for record in (*ground_records("road"), *ground_records("sidewalk")):
        assert (
            appearance_search.rank_ground_descriptors(appearance_search.own_ground_descriptor(record.uid), record.kind)[
                0
            ][0]
            == record.uid
        )
    for record in sky_records():
        assert appearance_search.rank_skies(appearance_search.own_sky_descriptor(record.uid))[0][0] == record.uid
    with pytest.raises(ValidationError, match="sky"):
        appearance_search.own_sky_descriptor("no such sky")
