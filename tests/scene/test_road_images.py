"""Images of kerbs, gutters, paving for the blind and covers, and the coats of roads: what they show, in metres."""

import colorsys

import numpy as np
import pytest

from urbanverse_mjx.assets.appearances.ground_materials import build_material
from urbanverse_mjx.datatypes import PlacedGround
from urbanverse_mjx.scene.roads import RoadRules, draw_roads, images
from urbanverse_mjx.scene.roads.drawing import PAINTS, _coat

#: Hues in degrees of the colours that names of images hold; None for those without a hue.
HUES = {"yellow": (38, 55), "red": (350, 370), "white": None, "black": None, "concrete": None, "granite": None}
HUES |= {"basalt": None, "setts": None, "cover": None, "gully": None}
#: Shares of light that dry surfaces reflect, in sRGB: black paint and cast iron, stone, white paint.
DARK, STONE, PALE = (0.05, 0.33), (0.30, 0.68), (0.68, 0.90)
LIGHT = {"black": DARK, "cover": DARK, "gully": DARK, "white": PALE, "concrete": STONE, "granite": STONE}
LIGHT |= {"basalt": STONE, "setts": STONE, "yellow": (0.45, 0.68), "red": (0.20, 0.45)}


def image_of(name: str) -> np.ndarray:
    return images.paint_image(name)[0] / 255.0


@pytest.mark.parametrize("name", images.LENGTHS)
def test_an_image_has_the_colours_of_its_name(name: str) -> None:
    image = image_of(name)
    words = [word for word in name.split() if word in HUES]
    for word, part in zip(words, np.array_split(image, len(words), axis=1), strict=True):
        colour = np.median(part.reshape(-1, 3), 0)
        hue, saturation, _ = colorsys.rgb_to_hsv(*colour)
        if (found := HUES[word]) is None:
            assert saturation < 0.1, (word, colour)
        else:
            assert saturation > 0.5, (word, colour)
            assert any(found[0] <= 360 * hue + turn <= found[1] for turn in (0, 360)), (word, colour)
        if name.endswith("tactile") and word == "red":
            continue
        low, high = LIGHT[word]
        assert low <= colour.mean() <= high, (word, colour)


@pytest.mark.parametrize("name", [n for n in images.LENGTHS if n.endswith("kerb")])
def test_one_dark_joint_is_between_two_stones(name: str) -> None:
    """Joints of a centimetre to four: two of 64 columns."""
    light = image_of(name).mean(-1)
    stones = len(light[0]) // len(light)
    assert stones == (2 if len(name.split()) == 3 else 1)
    for stone in np.hsplit(light, stones):
        columns = np.median(stone, 0) / np.median(stone)  # some of the paint is gone
        np.testing.assert_allclose(columns[:2], 0.55, atol=0.1)
        assert (columns[2:] > 0.85).all()
        width = 2 / 64 * images.LENGTHS[name] / stones
        assert 0.01 < width < 0.04


@pytest.mark.parametrize(("name", "share"), [("yellow kerb", 0.25), ("white kerb", 0.3), ("red white kerb", 0.15)])
def test_paint_on_stones_is_worn_in_spots(name: str, share: float) -> None:
    """Where it is gone the stone is grey and darker; the share is less than that of worn paint, which fades out."""
    image = image_of(name)
    for stone in np.split(image, image.shape[1] // 64, axis=1):
        body = stone[:, 2:]
        away = np.abs(body - np.median(body.reshape(-1, 3), 0)).max(-1)
        faded = (away > 0.12).mean()
        assert 0.1 * share < faded < 1.2 * share, name


@pytest.mark.parametrize("name", [n for n in images.LENGTHS if n.endswith("tactile")])
def test_paving_for_the_blind_has_five_rows_of_domes(name: str) -> None:
    """Domes 60 mm apart and 31 mm wide: ISO 23599 has 50 to 70 mm, and tops of 12 to 25 mm on bases 10 mm wider."""
    assert images.LENGTHS[name] == images.WIDTHS[name] == 0.3
    light = image_of(name)[4:, 4:].mean(-1)
    raised = light > 1.08 * np.median(light)
    pixel = images.LENGTHS[name] / 64
    for axis in (0, 1):
        power = np.abs(np.fft.rfft(raised.mean(axis) - raised.mean(), 640))
        assert 640 * pixel / power.argmax() == pytest.approx(0.06, rel=0.06)
    width = 2 * np.sqrt(raised.mean() * 0.06**2 / np.pi)
    assert 0.022 < width < 0.035
    ring = light < 0.85 * np.median(light)  # their shadow, which the joints' two rows are too narrow to be
    assert 0.15 < ring.mean() < 0.25


def test_setts_are_seven_in_two_rows_with_dark_joints() -> None:
    image = image_of("setts gutter").mean(-1)
    dark = image < 0.3
    for rows in (slice(4, 28), slice(36, 60)):
        joints = dark[rows].all(0)
        assert (np.diff(joints.astype(int), prepend=0) == 1).sum() == 7
    assert (np.diff(dark.all(1).astype(int), prepend=0) == 1).sum() == 3, "both edges and the middle"
    assert 0.1 < images.LENGTHS["setts gutter"] / 7 < 0.2, "m, of a sett"


def test_a_gully_has_six_slots_and_a_cover_is_a_ribbed_disc() -> None:
    gully = image_of("gully").mean(-1)
    slots = gully[32] < 0.1
    assert (np.diff(slots.astype(int), prepend=0) == 1).sum() == 6
    assert 0.016 < slots.mean() * images.LENGTHS["gully"] / 6 < 0.042, "m; EN 124: 16 to 42 mm"
    np.testing.assert_array_equal(np.flatnonzero(gully[:, 7] < 0.1), np.arange(8, 56))
    cover = image_of("cover").mean(-1)
    y, x = (np.mgrid[0:64, 0:64] + 0.5) / 32 - 1
    away = np.hypot(x, y)
    assert cover[(away > 0.79) & (away < 0.83)].mean() < 0.6 * cover[away < 0.7].mean(), "the gap at its frame"
    assert cover[away > 0.95].mean() > 1.2 * cover[(away > 0.85) & (away < 0.92)].mean(), "the road around it"
    middle = cover[16:48, 16:48]
    assert 1.2 < np.quantile(middle, 0.75) / np.quantile(middle, 0.25) < 1.6, "ribs"


@pytest.mark.parametrize("name", ["concrete gutter", "setts gutter"])
def test_dirt_of_a_gutter_lies_against_the_kerb(name: str) -> None:
    """The last row of an image is at v = 0, where a gutter begins at the kerb."""
    light = image_of(name).mean((1, 2))
    if name == "concrete gutter":
        assert light[50:60].mean() < 0.92 * light[2:12].mean()
        assert light[-1] < 0.85 * light[-4]
    assert light.min() > 0.15


def test_paints_and_patches_have_the_colours_of_their_names() -> None:
    """Bitumen, new and worn asphalt, concrete and steel are grey, in this order; markings have the hues of theirs."""
    colours = {name: np.array(colour) for name, (colour, _) in PAINTS.items()}
    grey = ("groove", "seam", "patch", "track", "steel", "pale patch", "bed", "white")
    for name in grey:
        assert np.ptp(colours[name]) < 0.035, name
    dark, light = ("groove", "seam"), ("steel", "pale patch", "bed")
    assert all(0.05 < colours[name].mean() < 0.1 for name in dark), "bitumen reflects a hundredth"
    assert all(0.14 < colours[name].mean() < 0.2 for name in ("patch", "track")), "asphalt two to three"
    assert all(0.45 < colours[name].mean() < 0.65 for name in light)
    assert colours["white"].mean() > 0.8
    hues = {name: 360 * colorsys.rgb_to_hsv(*colours[name])[0] for name in ("yellow", "blue")}
    assert 38 < hues["yellow"] < 55
    assert 205 < hues["blue"] < 225
    shares = {name: share for name, (_, share) in PAINTS.items()}
    assert all(shares[name] == 1.0 for name in ("white", "yellow", "blue", "steel", "groove"))
    assert shares["track"] < 0.2 < shares["pale patch"] < shares["patch"] < shares["seam"] < 1.0


@pytest.mark.parametrize("wear", [0.0, 0.2, 0.5, 0.8])
@pytest.mark.parametrize("paint", ["white", "yellow"])
def test_as_much_of_a_paint_is_gone_as_its_wear_says(paint: str, wear: float) -> None:
    """Three quarters of the wear: where more of the road than of the paint shows."""
    road = build_material("asphalt_old").texture / 255.0
    coat = _coat("asphalt_old", paint, wear)[0] / 255.0
    colour = np.array(PAINTS[paint][0])
    across = colour - road.mean((0, 1))
    share = (coat - road) @ across / (across @ across)
    assert (share < 0.5).mean() == pytest.approx(0.75 * wear, abs=0.08)
    assert share.max() > 0.75, "some of it is left"


@pytest.mark.parametrize("kerb_of", ["granite", "red white"])
def test_images_on_kerbs_are_not_stretched(kerb_of: str) -> None:
    """A repetition has its length along the border, and each face and top of the stones shows the image once."""
    square = ((0.0, 0.0), (30.0, 0.0), (30.0, 6.0), (0.0, 6.0))
    walk = ((0.0, 6.0), (30.0, 6.0), (30.0, 9.0), (0.0, 9.0))
    regions = [
        PlacedGround("road", "road", square, (0.0, 0.0, 0.0), "asphalt_old"),
        PlacedGround("walk", "sidewalk", walk, (0.0, 0.0, 0.15), "slabs_grey"),
    ]
    drawn = draw_roads(regions, {}, (), RoadRules(kerb=kerb_of), "a")
    kerbs = [d for d in drawn if "kerb" in d.id]
    assert kerbs
    for kerb in kerbs:
        image = f"{kerb_of} kerb"
        uv = kerb.mesh.uv[kerb.mesh.faces]
        corners = kerb.mesh.vertices[kerb.mesh.faces]
        along = np.ptp(corners[..., 0], axis=1)
        np.testing.assert_allclose(np.ptp(uv[..., 0], axis=1), along / images.LENGTHS[image], atol=1e-3)
        np.testing.assert_allclose(np.ptp(uv[..., 1], axis=1), 1.0, atol=1e-6)
        upright = np.ptp(corners[..., 2], axis=1) > 0.1
        assert upright.any()
        assert not upright.all()
        top = corners[~upright, :, 2]
        assert top.min() > 0.15 - kerb.position[2], "above the pavement"
        np.testing.assert_allclose(corners[upright, :, 2].max(1), top.max(), atol=1e-6, err_msg="no gap at the edge")
        lowest = np.take_along_axis(uv[upright, :, 1], corners[upright, :, 2].argmin(1)[:, None], 1)
        np.testing.assert_allclose(lowest, 0.0, atol=1e-6)


def test_what_lies_along_a_border_has_its_place_its_size_and_its_image() -> None:
    """A road askew with a crosswalk that the pavement meets at its height: a gutter of 0.3 m in the road and gullies of
    0.42 m by 0.3 m in it, and at the crosswalk 0.6 m of paving for the blind behind 0.15 m of kerb stones."""
    turn, origin = np.radians(30.0), np.array([12.0, -7.0])
    along, left = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])

    def region(
        name: str, kind: str, box: tuple[float, float, float, float], height: float, material: str
    ) -> PlacedGround:
        s0, s1, d0, d1 = box
        ring = tuple(
            tuple((origin + s * along + d * left).tolist()) for s, d in ((s0, d0), (s1, d0), (s1, d1), (s0, d1))
        )
        return PlacedGround(name, kind, ring, (0.0, 0.0, height), material)  # type: ignore[arg-type]

    regions = [
        region("west", "road", (0.0, 58.0, -3.0, 3.0), 0.0, "asphalt_old"),
        region("cross", "crosswalk", (58.0, 62.0, -3.0, 3.0), 0.0, "zebra_new"),
        region("east", "road", (62.0, 120.0, -3.0, 3.0), 0.0, "asphalt_old"),
        region("walk_a", "sidewalk", (0.0, 58.0, 3.0, 6.0), 0.15, "slabs_grey"),
        region("ramp", "sidewalk", (58.0, 62.0, 3.0, 6.0), 0.0, "slabs_grey"),
        region("walk_b", "sidewalk", (62.0, 120.0, 3.0, 6.0), 0.15, "slabs_grey"),
    ]
    rules = RoadRules(gutter="concrete", tactile="yellow", kerb="granite")
    drawn = draw_roads(regions, {"cross": "asphalt_old"}, (), rules, "a")
    places = {"concrete gutter": (2.7, 3.0, 0.3), "yellow tactile": (3.15, 3.75, 0.3), "gully": (2.7, 3.0, 0.3)}
    for image, (low, high, width) in places.items():
        meshes = [d.mesh.vertices[d.mesh.faces] + d.position for d in drawn if image.replace(" ", "") in d.id]
        uvs = [d.mesh.uv[d.mesh.faces] for d in drawn if image.replace(" ", "") in d.id]
        assert meshes, image
        corners, uv = np.concatenate(meshes), np.concatenate(uvs)
        at = np.stack([(corners[..., :2] - origin) @ along, (corners[..., :2] - origin) @ left], -1)
        assert at[..., 1].min() == pytest.approx(low, abs=2e-3)
        assert at[..., 1].max() == pytest.approx(high, abs=2e-3)
        edges, turned = corners[:, 1:] - corners[:, :1], uv[:, 1:] - uv[:, :1]
        area = np.abs(np.linalg.det(edges[..., :2])) / 2
        shown = np.abs(np.linalg.det(turned)) / 2
        np.testing.assert_allclose(shown * images.LENGTHS[image] * width, area, rtol=2e-3, err_msg=image)
        if image == "gully":
            np.testing.assert_allclose(area, 0.42 * 0.3 / 2, rtol=2e-3)
            assert len(np.unique(np.round(corners.mean(1), 2), axis=0)) >= 2 * 4, "every 18 m"
        else:
            s0, s1 = at[..., 0].min(), at[..., 0].max()
            assert (s0, s1) == (
                pytest.approx(0.0 if image != "yellow tactile" else 58.0, abs=0.3),
                pytest.approx(120.0 if image != "yellow tactile" else 62.0, abs=0.3),
            )
            # Its own axes: one coordinate of the image runs along the border.
            straight = np.abs(edges[..., :2] @ left) < 1e-6
            np.testing.assert_allclose(
                np.abs(turned[..., 0])[straight] * images.LENGTHS[image],
                np.abs(edges[..., :2] @ along)[straight],
                atol=2e-3,
            )
