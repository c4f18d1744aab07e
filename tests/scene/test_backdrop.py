"""What closes the view around a street: windows at the ends of rows, ground behind houses, fronts beyond the ground."""

import dataclasses
import math

import numpy as np
import pytest
import shapely

from urbanverse_mjx.assets.recipes.building.regional.styles import Form, traditions
from urbanverse_mjx.citygen.section import StreetSection, ground_regions
from urbanverse_mjx.datatypes import AssetMesh, PlacedGround
from urbanverse_mjx.scene.backdrop import House, openings, surround
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
