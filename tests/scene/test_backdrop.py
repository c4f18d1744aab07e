"""What closes the view around a street: windows at the ends of rows, ground behind houses, fronts beyond the ground."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

from urbanverse_mjx.assets.recipes.building.regional.styles import Form, traditions
from urbanverse_mjx.citygen.section import StreetSection, ground_regions
from urbanverse_mjx.datatypes import AssetMesh, PlacedGround
from urbanverse_mjx.scene.backdrop import House, ends, images, openings, surround, surroundings
from urbanverse_mjx.scene.backdrop.ends import LEAST_WALL, OUT, openings_of, side_wall
from urbanverse_mjx.scene.backdrop.houses import TERRACE
from urbanverse_mjx.scene.backdrop.surroundings import REACH, SUNK, UNDER, outline
from urbanverse_mjx.scene.roads import Drawn

WIDTH, DEPTH, HEIGHT = 8.0, 7.0, 9.0
PLACES = [("Tokyo", "Japan"), ("London", "United Kingdom"), ("Bangkok", "Thailand"), ("Havana", "Cuba")]


def block() -> AssetMesh:
    """A house of six plain walls, its front towards +x."""
    x, y = DEPTH / 2, WIDTH / 2
    corners = np.array([(i * x, j * y, k * HEIGHT) for i in (-1, 1) for j in (-1, 1) for k in (0, 1)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))], np.int32)
    return AssetMesh(corners, faces, np.zeros((8, 2), np.float32), np.zeros((4, 4, 3), np.uint8), 0.8, 0.0)


def row(middles: list[float], look: Form = TERRACE) -> list[House]:
    """Houses along x that face the street to the south."""
    found = []
    for k, x in enumerate(middles):
        outline = shapely.box(x - WIDTH / 2, 6.5, x + WIDTH / 2, 6.5 + DEPTH)
        at = np.array([x, 6.5 + DEPTH / 2, 0.1])
        found.append(House(f"house_{k}", at, -math.pi / 2, block(), outline, (1.0, 1.0, 1.0), look, 0))
    return found


def street() -> list[PlacedGround]:
    material = {"road": "asphalt_old", "crosswalk": "zebra_new"}
    section = StreetSection(60.0, 7.0, 3.0, 3.0, (30.0,), start="junction", end="junction")
    return [
        PlacedGround(r.id, r.kind, r.polygon, r.plane, material.get(r.kind, "slabs_grey"))
        for r in ground_regions(section)
    ]


def corners(drawn: list[Drawn], name: str) -> np.ndarray:
    """(n, 3, 3) m, the triangles of the meshes of a name in the scene frame."""
    return np.concatenate([d.mesh.vertices[d.mesh.faces] + d.position for d in drawn if name in d.id])


def test_both_ends_of_a_row_have_windows_and_the_walls_between_none() -> None:
    houses = row([10.0, 18.0, 26.0])
    counts = [[len(openings_of(h, side, houses)[1]) for side in (1, -1)] for h in houses]
    assert [sum(pair) > 0 for pair in counts] == [True, False, True]
    assert sorted(counts[0]) == sorted(counts[2])
    assert min(counts[0]) == 0


@pytest.mark.parametrize("name", sorted(traditions()))
def test_every_form_has_openings_in_a_free_wall(name: str) -> None:
    for form in traditions()[name].forms:
        (alone,) = row([10.0], form)
        assert side_wall(alone, 1)[1].area > LEAST_WALL
        for side in (1, -1):
            assert openings_of(alone, side, [alone])[1], f"{form.sizes}: no opening"


def test_windows_stand_on_the_wall_and_inside_its_outline() -> None:
    houses = row([10.0, 18.0])
    found = corners(openings(houses, "a"), "windows")
    ends = np.array([10.0 - WIDTH / 2, 18.0 + WIDTH / 2])
    from_wall = np.abs(found[..., 0, None] - ends).min(-1)
    assert from_wall.max() < OUT + 1e-3
    assert found[..., 1].min() > 6.5
    assert found[..., 1].max() < 6.5 + DEPTH
    assert found[..., 2].min() > 0.1 + 0.3
    assert found[..., 2].max() < 0.1 + HEIGHT
    # They face away from the house.
    normal = np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
    face = np.abs(normal[:, 0]) > 0.9 * np.linalg.norm(normal, axis=1)
    assert (np.sign(normal[face, 0]) == np.sign(found[face, 0, 0] - 14.0)).all()


def test_buildings_with_walls_of_their_own_are_left_alone() -> None:
    houses = [dataclasses.replace(h, look=None) for h in row([10.0])]
    assert openings(houses, "a") == []


@pytest.mark.parametrize("place", PLACES)
def test_whoever_looks_out_sees_a_front_in_every_direction(place: tuple[str, str]) -> None:
    houses = row([10.0, 18.0, 40.0])
    drawn = surround(street(), houses, place, "a")
    fronts = corners(drawn, "fronts")
    camera = np.array([30.0, 0.0, 1.6])
    for angle in np.radians(np.arange(0, 360, 7)):
        ray = np.array([math.cos(angle), math.sin(angle), 0.0])
        edge1, edge2 = fronts[:, 1] - fronts[:, 0], fronts[:, 2] - fronts[:, 0]
        normal = np.cross(edge1, edge2)
        slope = normal @ ray
        t = np.einsum("ij,ij->i", normal, fronts[:, 0] - camera) / np.where(np.abs(slope) < 1e-9, np.inf, slope)
        point = camera + t[:, None] * ray - fronts[:, 0]
        # Inside a triangle: both shares are at least 0 and add up to at most 1.
        d11, d12, d22 = ((a * b).sum(1) for a, b in ((edge1, edge1), (edge1, edge2), (edge2, edge2)))
        p1, p2 = (point * edge1).sum(1), (point * edge2).sum(1)
        area = d11 * d22 - d12**2
        u, w = (d22 * p1 - d12 * p2) / area, (d11 * p2 - d12 * p1) / area
        hit = (t > 0) & (u > -1e-6) & (w > -1e-6) & (u + w < 1 + 1e-6)
        assert hit.any(), f"nothing at {math.degrees(angle):.0f} degrees"
        # The nearest one shows its front, not its back.
        assert slope[hit][t[hit].argmin()] < 0


def test_ground_goes_on_to_the_houses_and_beyond_the_ends_below_that_of_the_scene() -> None:
    regions, houses = street(), row([10.0, 18.0])
    found = corners(surround(regions, houses, ("Tokyo", "Japan"), "a"), "around")
    laid = shapely.union_all([shapely.Polygon(t[:, :2]).buffer(1e-6) for t in found])
    own = shapely.union_all([shapely.Polygon(r.polygon) for r in regions], grid_size=1e-3)
    built = shapely.union_all([h.footprint for h in houses])
    gap = shapely.box(6.0, 3.5, 22.0, 8.0).union(shapely.box(-REACH + 1, -3.0, 61.0 + REACH - 1, 3.0))
    assert gap.difference(laid.union(own)).area < 0.01
    assert laid.intersection(own.buffer(-2 * UNDER)).area < 0.01
    assert found[..., 2].max() < 0.3 - SUNK / 2
    assert outline(own, built).buffer(0.01).covers(own.buffer(REACH / 2))


def test_a_road_goes_on_as_a_road_and_its_long_sides_do_not() -> None:
    def strip(name: str, kind: str, low: float, high: float, material: str) -> PlacedGround:
        ring = ((0.0, low), (60.0, low), (60.0, high), (0.0, high))
        return PlacedGround(name, kind, ring, (0.0, 0.0, 0.0), material)

    regions = [strip("road", "road", -3.5, 3.5, "asphalt_old"), strip("walk", "sidewalk", 3.5, 6.5, "slabs_grey")]
    roads = [d for d in surround(regions, row([10.0]), ("Tokyo", "Japan"), "a") if d.kind == "road"]
    across = np.concatenate([d.mesh.vertices[:, :2] + d.position[:2] for d in roads])
    assert np.abs(across[:, 1]).max() < 3.5 + 2 * UNDER
    assert across[:, 0].min() < -REACH / 2
    assert across[:, 0].max() > 60 + REACH / 2


def test_it_is_the_same_every_time_and_other_for_another_street() -> None:
    first, again, other = (surround(street(), row([10.0]), ("Tokyo", "Japan"), s) for s in ("a", "a", "b"))
    assert [d.id for d in first] == [d.id for d in again]
    assert all(np.array_equal(a.mesh.texture, b.mesh.texture) for a, b in zip(first, again, strict=True))
    assert any(not np.array_equal(a.mesh.texture, b.mesh.texture) for a, b in zip(first, other, strict=True))


#: Windows of the block's side walls: two bays 0.35 m inside 7 m, one on each of three floors of 2.8 m above 3 m.
BAYS, SILLS = (-1.575, 1.575), (0.55 + 0.8, 3.0 + 0.8, 5.8 + 0.8)


def pairs(found: list[tuple[float, float]]) -> np.ndarray:
    return np.array(sorted(found)).reshape(-1, 2)


@pytest.mark.parametrize("side", [1, -1])
def test_windows_of_a_wall_by_hand(side: int) -> None:
    (alone,) = row([10.0])
    y, found = openings_of(alone, side, [alone])
    assert y == pytest.approx(side * WIDTH / 2)
    np.testing.assert_allclose(pairs(found), [(x, z) for x in BAYS for z in SILLS], atol=1e-6)
    # A fifth higher, the third floor's windows, 1.68 m high, do not fit below 9 m.
    tall = dataclasses.replace(alone, scale=(1.0, 1.0, 1.2))
    _, found = openings_of(tall, side, [tall])
    np.testing.assert_allclose(pairs(found), [(x, 1.2 * z) for x in BAYS for z in SILLS[:2]], atol=1e-6)
    low = dataclasses.replace(TERRACE, sill=0.2, window_size=(2.0, 2.5))
    assert ends.window_size(low, 1.5) == (1.2, pytest.approx(1.7 * 1.5))
    found = openings_of(dataclasses.replace(alone, look=low), side, [alone])[1]
    assert {round(z, 4) for _, z in found} == {1.0, 3.45, 6.25}, "no sill below 0.45 m"


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_house_before_a_wall_closes_the_bays_behind_it(turn: float, side: int) -> None:
    """A neighbour before the half of the wall at +x (asset frame); what is 1.6 m and less away takes the light."""
    (alone,) = row([10.0])
    alone = dataclasses.replace(alone, yaw=turn)
    c, s = math.cos(turn), math.sin(turn)

    def neighbour(low: float, high: float, gap: float) -> House:
        near, far = sorted((side * (WIDTH / 2 + gap), side * (WIDTH / 2 + gap + 5.0)))
        at = np.array([(low, near), (high, near), (high, far), (low, far)])
        world = alone.position[:2] + np.stack([c * at[:, 0] - s * at[:, 1], s * at[:, 0] + c * at[:, 1]], -1)
        return dataclasses.replace(alone, id="next", footprint=shapely.Polygon(world))

    for low, gap, open_bays in (
        (0.6, 0.0, BAYS[:1]), (0.6, 0.3, BAYS[:1]), (0.6, 1.5, BAYS[:1]), (0.6, 1.7, BAYS), (2.0, 0.1, BAYS[:1]),
        (2.2, 0.1, BAYS), (-9.0, 0.9, ()),
    ):  # fmt: skip
        found = openings_of(alone, side, [alone, neighbour(low, 9.0, gap)])[1]
        assert sorted({round(x, 4) for x, _ in found}) == list(open_bays), (low, gap)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("sill", "edged"), [(1.35, True), (6.6, False)])
def test_a_window_is_an_image_in_front_of_its_wall(side: int, sill: float, edged: bool) -> None:
    """1 m by 1.4 m and a surround of 0.1125 m on each side; below 4.5 m with edges, above flat. Image 11 of 64."""
    (alone,) = row([10.0])
    rows = ends._window(
        dataclasses.replace(alone, yaw=0.0, position=np.array([5.0, -3.0, 0.1])), side, 4.0 * side, (1.5, sill), 11
    )
    place = rows[:, :3] - [5.0, -3.0, 0.1]
    edge = 0.09 * 1.25
    out = 4.05 if edged else 4.02
    assert len(rows) == (30 if edged else 6)
    face, rim = rows[:6], rows[6:]
    low, high = (1.5 - 0.5 - edge, sill - edge), (1.5 + 0.5 + edge, sill + 1.4 + edge)
    np.testing.assert_allclose(place[:6, [0, 2]].min(0), low, atol=1e-6)
    np.testing.assert_allclose(place[:6, [0, 2]].max(0), high, atol=1e-6)
    np.testing.assert_allclose(place[:6, 1], side * out, atol=1e-6)
    # From outside, the image is not mirrored: at +y the lower x lies on the right.
    right = side * (1.5 - place[:6, 0]) / (0.5 + edge)
    np.testing.assert_allclose(face[:, 3], 3 / 8 + (right + 1) / 16, atol=1e-6)
    up = (place[:6, 2] - low[1]) / (high[1] - low[1])
    np.testing.assert_allclose(face[:, 4], 6 / 8 + up / 8, atol=1e-6)
    if edged:
        np.testing.assert_allclose(rim[:, 3:], [[(3 + 0.04) / 8, (6 + 0.04) / 8]] * 24, atol=1e-6)
        corners = place[6:].reshape(-1, 3, 3)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert np.linalg.norm(normal, axis=1).sum() / 2 == pytest.approx(2 * 0.05 * (1.0 + 1.4 + 4 * edge))
        middle = np.array([1.5, 0.0, sill + 0.7])
        assert ((corners.mean(1) - middle)[:, [0, 2]] * normal[:, [0, 2]]).sum(1).min() > 0.0, "faces outwards"
        assert {round(float(v), 4) for v in np.abs(corners[..., 1]).ravel()} == {4.0, 4.05}


def test_windows_of_a_scene_have_the_images_of_their_looks() -> None:
    """Two looks in two squares of the ground; each window shows the part of the image that is its look's."""
    other = dataclasses.replace(TERRACE, trim=("black",), window="casement")
    size = 2 * ends.CELL
    at = [row([0.3 * size])[0], row([1.2 * size], other)[0], row([1.9 * size])[0]]
    found = openings(at, "a")
    assert len(found) == 2
    tiles = [(0, 0), (0, 1)]
    for drawn, looks in zip(found, ([0], [0, 1]), strict=True):
        seen = set()
        for uv in drawn.mesh.uv[drawn.mesh.faces].mean(1):
            seen.add((int((1 - uv[1]) * 8), int(uv[0] * 8)))
        assert seen == {tiles[k] for k in looks}
    image = found[0].mesh.texture
    step = images.WINDOW
    assert image.shape[:2] == (8 * step, 8 * step)
    first, second = image[:step, :step].astype(int), image[:step, step : 2 * step].astype(int)
    assert first[:2].mean() > 150 > 80 > second[:2].mean(), "surrounds are cream and black"
    assert (image[step:] == 128).all()
    assert (image[:step, 2 * step :] == 128).all()
    assert found[0].kind == "building"


RED, GREEN, BLUE = (250, 10, 10), (10, 250, 10), (10, 10, 250)


def plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fronts of grey walls with red panes, blue shop windows and green signs."""

    def plain(colour: tuple[int, int, int], size: tuple[int, int] = (8, 8)) -> Image.Image:
        return Image.new("RGB", size, colour)

    monkeypatch.setattr(images.panes, "cladding", lambda *_: plain((128, 128, 128)))
    monkeypatch.setattr(images.panes, "pane", lambda *_: plain(RED))
    monkeypatch.setattr(images.panes, "shop", lambda *_: plain(BLUE))
    monkeypatch.setattr(images.panes, "sign", lambda *_: plain(GREEN))


def painted(image: np.ndarray, colour: tuple[int, int, int], tall: float, width: float) -> Any:
    """Function that tells whether (y, z) m of a front has a colour."""
    hues = np.abs(image.astype(int) - colour).sum(-1) < 200

    def at(y: float, z: float) -> bool:
        rows = images.FRONT - images.ROOF
        return bool(hues[images.ROOF + int((1 - z / tall) * rows), int((y / width + 0.5) * images.FRONT)])

    return at


def test_a_front_has_its_windows_and_its_door(monkeypatch: pytest.MonkeyPatch) -> None:
    """7 m wide: round(6.5 / 2.3) = 3 bays on three floors; on the ground a door of 1.1 m by 2.2 m in the middle one."""
    plainly(monkeypatch)
    form = dataclasses.replace(TERRACE, spacing=2.3, attic=0.35)
    image = images.front(form, (7.0, 3), 0, "", np.random.default_rng(0))
    tall = 3.0 + 2 * 2.8 + 0.35
    assert images.height_of(form, 3) == pytest.approx(tall)
    at = painted(image, RED, tall, 7.0)
    for y in (-6.5 / 3, 0.0, 6.5 / 3):
        for z in (0.3 + 0.8, 3.0 + 0.8, 5.8 + 0.8):
            glass = z > 2.0 or y != 0.0
            for dy, dz, inside in (
                (0.0, 0.7, True), (0.42, 0.7, True), (-0.42, 0.7, True), (0.0, 0.1, True), (0.0, 1.3, True),
                (0.6, 0.7, False), (-0.6, 0.7, False), (0.0, -0.12, False), (0.0, 1.53, False),
            ):  # fmt: skip
                assert at(y + dy, z + dz) == (inside and glass), (y, z, dy, dz)
    dark = image.astype(int).sum(-1) < 360
    rows = images.FRONT - images.ROOF

    def is_dark(y: float, z: float) -> bool:
        return bool(dark[images.ROOF + int((1 - z / tall) * rows), int((y / 7.0 + 0.5) * images.FRONT)])

    frame = np.array(images.rgb(images.shade(images.nth(form.frame, 1), 0.5)))
    door = image[images.ROOF + int((1 - 1.2 / tall) * rows), images.FRONT // 2]
    np.testing.assert_allclose(door, frame, atol=12)
    for y, z, inside in ((0.4, 1.0, True), (-0.4, 1.0, True), (0.0, 2.2, True), (0.0, 2.45, False), (0.7, 1.0, False)):
        pixel = image[images.ROOF + int((1 - z / tall) * rows), int((y / 7.0 + 0.5) * images.FRONT)]
        assert (np.abs(pixel.astype(int) - frame).sum() < 40) == inside, (y, z)
    # A front of less than half a bay has one, and all of them a cornice and a roof.
    narrow = painted(images.front(form, (1.6, 2), 0, "", np.random.default_rng(0)), RED, 3.0 + 2.8 + 0.35, 1.6)
    assert narrow(0.0, 3.8 + 0.7)
    trim, roof = (np.array(images.rgb(images.nth(c, 0))) for c in (form.trim, form.roof_colors))
    np.testing.assert_allclose(image[images.ROOF + 1], np.tile(trim, (images.FRONT, 1)), atol=40)
    assert np.abs(image[: images.ROOF - 1].mean((0, 1)) - roof).max() < 60


def test_a_front_with_shops_has_their_windows_below_their_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    """8 m: two shops of 4 m, 3.7 m of window from 0.25 m to 0.9 m below the ceiling, signs of 0.7 m above."""
    plainly(monkeypatch)
    form = dataclasses.replace(TERRACE, ground="glass", ground_height=3.6, unit=4.0, boards=(("red", "white"),))
    image = images.front(form, (8.0, 2), 0, sorted(images.words.languages())[0], np.random.default_rng(0))
    tall = 3.6 + 2.8 + form.attic
    window, sign, pane = (painted(image, colour, tall, 8.0) for colour in (BLUE, GREEN, RED))
    for y in (-2.0, 2.0):
        for dy in (-1.75, 0.0, 1.75):
            assert window(y + dy, 0.45)
            assert window(y + dy, 2.5)
            assert not window(y + dy, 0.1)
            assert sign(y + dy, 2.9)
            assert sign(y + dy, 3.35)
            assert not sign(y + dy, 2.6)
            assert not sign(y + dy, 3.55)
        assert not window(y - 1.95, 1.5)
        assert not pane(y, 1.5)
    assert pane(-8 / 2 + 0.25 + 7.5 / 6, 3.6 + 0.8 + 0.7), "the floor above has windows"


def test_the_image_of_a_window_is_its_pane_in_its_trim(monkeypatch: pytest.MonkeyPatch) -> None:
    plainly(monkeypatch)
    image = images.window(TERRACE, 0, np.random.default_rng(0)).astype(int)
    assert image.shape == (32, 32, 3)
    trim = np.array(images.rgb(TERRACE.trim[0]))
    assert np.abs(image[[0, 1, -1, -2]] - trim).max() < 60
    assert np.abs(image[:, [0, 1, -1, -2]] - trim).max() < 60
    # 0.09 of 32 pixels are 2.9.
    assert np.abs(image[4:-4, 4:-4] - RED).max() < 60


@pytest.mark.parametrize("roof", ["tiles", "flat"])
def test_a_front_is_a_block_by_hand(roof: str) -> None:
    """From a to b it faces to the left, 5 m deep to the right; image 6 is the third of the lower row."""
    form = dataclasses.replace(TERRACE, roof=roof, rise=2.0)
    a, b = np.array([2.0, 1.0]), np.array([2.0, 10.0])
    rows = surroundings._front(a, b, 0.5, form, (9.0, 2), 6, 1.1)
    high = 0.5 + images.height_of(form, 2) * 1.1
    corners = rows[:, :3].reshape(-1, 3, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    unit = normal / (2 * area[:, None])
    wall = high - 0.2
    ahead, north, south = ((unit @ np.array(d) > 0.999) for d in ((-1, 0, 0), (0, 1, 0), (0, -1, 0)))
    assert area[ahead].sum() == pytest.approx(9.0 * wall)
    np.testing.assert_allclose(corners[ahead][..., 0], 2.0)
    gable = 0.5 * 5.0 * 2.0 if roof == "tiles" else 0.0
    for side, y in ((north, 10.0), (south, 1.0)):
        assert area[side].sum() == pytest.approx(5.0 * wall + gable)
        np.testing.assert_allclose(corners[side][..., 1], y)
        assert corners[side][..., 0].min() == pytest.approx(2.0)
        assert corners[side][..., 0].max() == pytest.approx(7.0)
    sloped = unit[:, 2] > 0.1
    assert sloped.any() == (roof == "tiles")
    if roof == "tiles":
        assert area[sloped].sum() == pytest.approx(9.0 * np.hypot(2.5, 2.0))
        assert (unit[sloped][:, 0] < 0.0).all()
        assert corners[..., 2].max() == pytest.approx(high + 2.0)
    assert corners[..., 2].min() == pytest.approx(0.2)
    # The image: upright, and not mirrored when seen from the left of a to b.
    flat = rows.reshape(-1, 3, 5)[ahead].reshape(-1, 5)
    np.testing.assert_allclose(flat[:, 3], 2 / 4 + (10.0 - flat[:, 1]) / 9.0 / 4, atol=1e-6)
    eaves = (1 - images.ROOF / images.FRONT) / 2
    np.testing.assert_allclose(flat[:, 4], (flat[:, 2] - 0.2) / wall * eaves, atol=1e-6)
    sides = rows.reshape(-1, 3, 5)[north | south].reshape(-1, 5)
    assert (np.abs(sides[:, 3] - 0.508) < 0.0045).all(), "of the wall beside the windows"


def test_what_closes_the_view_stands_around_everything_in_whole_pieces() -> None:
    """Nine metres away; gaps of up to 16 m between what is around two blocks are closed. Only roads' ends go on."""
    square, far, near = shapely.box(0, 0, 40, 40), shapely.box(76, 0, 90, 40), shapely.box(72, 0, 90, 40)
    for other, parts in ((far, 2), (near, 1)):
        found = shapely.get_parts(outline(square, other))
        assert len(found) == parts
        for part in found if parts == 2 else ():
            away = shapely.distance(shapely.points(shapely.get_coordinates(part)), square.union(other))
            assert away.max() < 9.0 + 1e-6
            assert away.min() > 9.0 - 2.0
    assert surroundings._usual_height([]) == 6.0
    assert surroundings._usual_height(row([10.0, 18.0])) == pytest.approx(HEIGHT)
    laid = [
        (r, shapely.Polygon(r.polygon))
        for r in (
            PlacedGround("a", "road", ((0, 0), (4, 0), (4, 4), (0, 4)), (0.1, 0.0, 1.0), "asphalt_old"),
            PlacedGround("b", "road", ((4, 0), (8, 0), (8, 4), (4, 4)), (0.0, 0.2, 2.0), "asphalt_old"),
        )
    ]
    height = surroundings.floor_of(laid)
    np.testing.assert_allclose(height(np.array([[-3.0, 2.0], [2.0, 9.0], [7.0, 6.0]])), [1.0, 1.2, 2.8], atol=1e-6)
    # Of a road's outline, pieces of 2 to 13 m are its ends, wherever it turns.
    ring = shapely.LineString([(0, 0), (40, 0), (40, 7), (41.5, 8), (40, 9), (0, 9), (0, 0)])
    ends_found = [sorted(shapely.get_coordinates(line).tolist()) for line in surroundings._lines(ring)]
    assert sorted(ends_found) == [[[0.0, 0.0], [0.0, 9.0]], [[40.0, 0.0], [40.0, 7.0]]]
