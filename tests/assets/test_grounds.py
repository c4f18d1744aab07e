"""The 288 ground materials: they tile, joints have their metric positions, frictions are ordered."""

import hashlib

import numpy as np
import pytest

from urbanverse_mjx.assets.appearances import appearance_search, ground_materials
from urbanverse_mjx.assets.appearances.grounds import ground_records, paint_ground, table
from urbanverse_mjx.assets.appearances.grounds.surface import normals
from urbanverse_mjx.assets.categories.materials import material
from urbanverse_mjx.datatypes import ValidationError

RECORDS = {record.uid: record for record in ground_records()}
#: One material of every family and one of every condition.
FIRST = {record.family: record.uid for record in reversed(ground_records())}
FIRST |= {record.condition: record.uid for record in reversed(ground_records())}
SOME = sorted(set(FIRST.values()))


def test_there_are_as_many_as_the_paper_has() -> None:
    assert len(ground_records("road")) == 98
    assert len(ground_records("sidewalk")) == 190
    assert len({record.description for record in ground_records()}) == 288
    groups = {record.condition_group for record in ground_records()}
    assert groups >= {"dry", "worn", "cracked", "patched", "wet", "snowy", "painted", "leaf-strewn"}
    families = {record.family for record in ground_records("sidewalk")}
    assert families >= {"asphalt", "concrete", "brick", "setts", "slabs", "tiles", "tactile", "gravel", "stone"}


@pytest.mark.parametrize("uid", SOME)
def test_it_tiles(uid: str) -> None:
    """The step over the seam is no larger than the largest step inside, in every map."""
    maps = paint_ground(uid)
    for name, noise in (("albedo", 2.0), ("roughness", 2.0), ("height", 1e-4)):
        field = getattr(maps, name).astype(float)
        for axis in (0, 1):
            others = tuple(k for k in range(field.ndim) if k != axis)
            inside = np.abs(np.diff(field, axis=axis)).mean(axis=others)
            seam = np.abs(field.take(0, axis) - field.take(-1, axis)).mean()
            assert seam <= 1.15 * inside.max() + noise, (name, axis)
    # A groove on the seam may kink the normals; they must be those of the height laid side by side.
    pixel = maps.record.tile_size_m / 512
    down, right = np.gradient(np.tile(maps.height.astype(float), (2, 2))[256:768, 256:768], pixel)
    wanted = np.stack([-right, down, np.ones_like(down)], -1)
    wanted /= np.linalg.norm(wanted, axis=-1, keepdims=True)
    found = np.roll(maps.normal, (256, 256), (0, 1)) / 127.5 - 1
    assert np.abs(found - wanted)[1:-1, 1:-1].max() < 0.01
    assert maps.albedo.shape == (512, 512, 3)
    assert 20 < maps.albedo.mean() < 240
    length = np.linalg.norm(maps.normal.astype(float) / 127.5 - 1, axis=-1)
    assert np.abs(length - 1).max() < 0.02
    assert maps.normal[..., 2].min() > 127, "no normal points into the ground"


def _period(field: np.ndarray, axis: int) -> int:
    """Repetitions along an axis: the lowest strong frequency of a map's mean profile (narrow joints have overtones)."""
    profile = field.mean(axis=1 - axis)
    strength = np.abs(np.fft.rfft(profile - profile.mean()))[1:60]
    return int((strength > 0.5 * strength.max()).argmax()) + 1


@pytest.mark.parametrize(
    ("uid", "across", "down"),
    [
        ("sidewalk/flags_square", 0.4, 0.4),
        ("sidewalk/brick_stack", 0.203, 0.1015),
        ("sidewalk/brick_red_running", None, 0.1),
        ("sidewalk/flags_buff", None, 0.3),
        ("sidewalk/terracotta", 0.2, 0.2),
        ("road/clinker_running", None, 0.1),
        ("sidewalk/boardwalk", 0.14, None),
    ],
)
def test_joints_are_where_the_metres_say(uid: str, across: float | None, down: float | None) -> None:
    maps = paint_ground(uid)
    # Joints are 5 mm deep or more; slabs stand up to 2 mm lower than others.
    low = maps.height < -0.0035
    for axis, unit in ((1, across), (0, down)):
        if unit is not None:
            assert maps.record.tile_size_m / _period(low.astype(float), axis) == pytest.approx(unit, rel=0.01)


def test_tactile_domes_stand_67_mm_apart_and_5_mm_high() -> None:
    maps = paint_ground("sidewalk/tactile_domes_yellow")
    pixel = maps.record.tile_size_m / 512
    strip = maps.height[int(0.8 / pixel) + 2 : int(1.6 / pixel) - 2]
    assert 0.004 < strip.max() < 0.008, "5 mm on slabs that stand up to 2 mm higher than others"
    profile = (strip > 0.003).mean(0)
    domes = np.abs(np.fft.rfft(profile - profile.mean())).argmax()
    assert maps.record.tile_size_m / domes == pytest.approx(0.4 / 6, rel=0.01)


def test_normals_lean_away_from_a_bump() -> None:
    y, x = np.mgrid[0:64, 0:64]
    bump = 0.01 * np.exp(-((x - 32) ** 2 + (y - 32) ** 2) / 50.0)
    n = normals(bump, 0.01)
    assert n[32, 40, 0] > 0.05 > -0.05 > n[32, 24, 0], "x grows to the right"
    assert n[24, 32, 1] > 0.05 > -0.05 > n[40, 32, 1], "y grows up the image"
    # A plane of slope 1:10 along u, by hand.
    assert normals(np.tile(np.arange(8) * 0.001, (8, 1)), 0.01)[4, 4] == pytest.approx(np.array([-1, 0, 10]) / 101**0.5)


def test_friction_starts_from_the_table_and_falls_with_water_snow_and_ice() -> None:
    for record in ground_records():
        dry = material(record.matter).friction
        assert 0.0 < record.friction <= dry
        assert record.friction_reason
        if record.condition in ("dry", "cracked", "patched"):
            assert record.friction == dry
    dry, wet, snow, ice = (RECORDS[f"road/asphalt_used{c}"].friction for c in ("", "-wet", "-snow_tracks", "-icy"))
    assert dry > wet > snow > ice
    assert snow == pytest.approx(0.66 * 0.30 + 0.34 * 0.72 * 0.70, abs=1e-3)


def test_wet_is_darker_and_smoother_and_snow_is_bright() -> None:
    dry, wet, snow = (paint_ground(f"sidewalk/flags_grey{c}") for c in ("", "-wet", "-snow"))
    assert wet.albedo.mean() < 0.85 * dry.albedo.mean()
    assert wet.roughness.mean() < 0.6 * dry.roughness.mean()
    assert snow.albedo.mean() > 1.1 * dry.albedo.mean()


def test_same_uid_same_maps_and_unknown_uid() -> None:
    first, again = paint_ground("sidewalk/crazy_paving"), paint_ground("sidewalk/crazy_paving")
    assert np.array_equal(first.albedo, again.albedo)
    assert np.array_equal(first.normal, again.normal)
    with pytest.raises(ValidationError, match="road/asphalt_old-cracked"):
        table.find_ground("road/asphalt_old-cheese")


def test_the_table_is_the_same_on_every_machine() -> None:
    text = "\n".join(repr(record) for record in ground_records())
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == "e93723af94c3c16c"


def test_scenes_take_them() -> None:
    painted = ground_materials.build_material("sidewalk/brick_red_basket")
    assert painted.texture.shape == (256, 256, 3)
    assert painted.kind == "sidewalk"
    assert painted.tile_size_m == pytest.approx(8 * 2 * 0.1016)
    assert 0.5 < painted.roughness < 1


@pytest.mark.parametrize("uid", ["road/asphalt_old-sealed", "sidewalk/calcada_waves-wet"])
def test_stored_thumbnails_are_those_of_today(uid: str) -> None:
    kind = appearance_search.road if uid.startswith("road") else appearance_search.sidewalk
    stored = kind.load_thumbnails([uid])[uid].astype(float)
    # JPEG at quality 82 costs a few grey levels.
    assert np.abs(stored - appearance_search.ground_thumbnail(uid)).mean() < 8


def test_crops_find_their_material() -> None:
    """The paper's pixel-wise mean squared error, against the formula spelled out."""
    thumbnails = appearance_search.sidewalk.load_thumbnails()
    for uid in ("sidewalk/brick_red_herringbone", "sidewalk/flags_checks", "sidewalk/concrete_pale-puddled"):
        ranked = appearance_search.rank_grounds(thumbnails[uid], "sidewalk")
        assert ranked[0][0] == uid
        assert ranked[0][1] < 1e-6
        assert len(ranked) == 190
        assert [error for _, error in ranked] == sorted(error for _, error in ranked)
    one, other = thumbnails["sidewalk/flags_checks"], thumbnails["sidewalk/slate"]
    small = [appearance_search._shrunk(image, (32, 32)) / 255.0 for image in (one, other)]
    by_hand = ((small[0] - small[1]) ** 2).mean()
    assert dict(appearance_search.rank_grounds(one, "sidewalk"))["sidewalk/slate"] == pytest.approx(by_hand, rel=1e-3)
    both = dict(appearance_search.rank_grounds([one, other], "sidewalk"))
    assert both["sidewalk/slate"] == pytest.approx(by_hand / 2, rel=1e-3)


@pytest.mark.parametrize("crops", [[], np.zeros((4, 4), np.uint8), [np.zeros((4, 4, 3))]])
def test_a_bad_crop_is_refused(crops: object) -> None:
    with pytest.raises(ValidationError, match="crop"):
        appearance_search.rank_grounds(crops, "road")  # pyright: ignore[reportArgumentType]


def test_search_joins_filters_by_and_and_lists_by_or() -> None:
    found = appearance_search.sidewalk.get_uids_conditioned(families=["brick", "setts"], conditions="wet")
    assert found
    assert all(RECORDS[u].family in ("brick", "setts") and RECORDS[u].condition_group == "wet" for u in found)
    slippery = appearance_search.road.get_uids_conditioned(friction_coefficient_range=(None, 0.4))
    assert slippery == [r.uid for r in ground_records("road") if r.friction <= 0.4]
    assert appearance_search.sidewalk.get_uids_conditioned(query="red bricks in basket weave", top_k=1) == [
        "sidewalk/brick_red_basket"
    ]
    assert "yellow" in appearance_search.sidewalk.explain_annotation("colors")
    with pytest.raises(ValidationError, match="families"):
        appearance_search.road.get_uids_conditioned(flavour="sweet")
    with pytest.raises(ValidationError, match="low <= high"):
        appearance_search.road.get_uids_conditioned(tile_size_range=(3, 1))
