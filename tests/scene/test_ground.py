import numpy as np
import pytest
import shapely

from tests.support.box_bank import street_regions
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import GroundRegion, SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import PAINT_KINDS
from urbanverse_mjx.scene import ground

GRAPHS = sorted(settings.scene_root().glob("*/graph.json"))
TEXTURE = np.zeros((4, 4, 3), np.uint8)


def _square(name: str, x: float, kind: str = "sidewalk") -> GroundRegion:
    return GroundRegion(name, kind, ((x, 0.0), (x + 2.0, 0.0), (x + 2.0, 2.0), (x, 2.0)), (0.0, 0.0, 0.0))


def _regions(path: str) -> list[GroundRegion]:
    return street_regions() if path == "box" else list(SceneGraph.load(path).ground)


@pytest.mark.parametrize("path", ["box", *GRAPHS])
def test_tops_cover_every_region_exactly_and_lie_in_its_plane(path: str) -> None:
    regions = _regions(path)
    prisms = ground.ground_prisms(regions)
    bottoms = set()
    for number, region in enumerate(regions):
        mine = [p for p in prisms if p.region == number]
        assert bool(mine) != (region.kind in PAINT_KINDS)
        tops = []
        for prism in mine:
            world = prism.corners.astype(np.float64) + prism.position
            half = len(world) // 2
            assert half <= 8
            np.testing.assert_allclose(world[:half, 2], ground.plane_height(region.plane, world[:half, :2]), atol=1e-6)
            np.testing.assert_array_equal(world[:half, :2], world[half:, :2])
            bottoms |= set(np.round(world[half:, 2], 5))
            assert (world[:half, 2] - world[half:, 2] >= ground.THICKNESS - 1e-6).all()
            tops.append(shapely.Polygon(world[:half, :2]))
        if mine:
            shape = shapely.Polygon(region.polygon)
            assert shapely.union_all(tops).symmetric_difference(shape).area < 1e-4 * shape.area
    assert len(bottoms) == 1


@pytest.mark.parametrize("path", ["box", *GRAPHS])
def test_convex_regions_stay_whole(path: str) -> None:
    regions = _regions(path)
    prisms = ground.ground_prisms(regions)
    for number, region in enumerate(regions):
        shape = shapely.Polygon(region.polygon)
        if region.kind not in PAINT_KINDS and shape.convex_hull.area - shape.area < 1e-9 and len(region.polygon) <= 8:
            assert sum(p.region == number for p in prisms) == 1


def test_overlap_names_both_regions() -> None:
    ground.check_regions([_square("a", 0.0), _square("b", 2.0), _square("paint", 1.0, "road_marking")])
    with pytest.raises(ValidationError, match=r"'a'.*2 m².*'b'"):
        ground.check_regions([_square("a", 0.0), _square("b", 1.0)])
    with pytest.raises(ValidationError, match="paint alone"):
        ground.check_regions([_square("paint", 1.0, "road_marking")])


def test_visual_is_textured_in_world_metres_and_its_sides_face_outwards() -> None:
    region = GroundRegion("r", "sidewalk", ((3.0, 1.0), (7.0, 1.0), (7.0, 3.0), (3.0, 3.0)), (0.1, 0.0, 0.0))
    position, mesh = ground.region_mesh(region, TEXTURE, 2.0, 0.8)
    world = mesh.vertices + position
    top, uv = world[:4], mesh.uv[:4]
    np.testing.assert_allclose(top[:, 2], 0.1 * top[:, 0], atol=1e-6)
    shift = uv - top[:, :2] / 2.0
    np.testing.assert_allclose(shift, np.round(shift), atol=1e-5)
    np.testing.assert_allclose(shift, np.broadcast_to(shift[0], shift.shape), atol=1e-5)
    a, b, c = (world[mesh.faces[:, k]].astype(float) for k in range(3))
    normal, middle = np.cross(b - a, c - a), (a + b + c) / 3
    side = np.abs(normal[:, 2]) < 1e-9
    assert side.sum() == 8
    outwards = middle[side, :2] - [5.0, 2.0]
    assert (np.einsum("ij,ij->i", normal[side, :2], outwards) > 0).all()
    assert (normal[~side, 2] > 0).all()


def test_paint_lies_just_above_and_has_no_sides() -> None:
    position, mesh = ground.region_mesh(_square("p", 0.0, "road_marking"), TEXTURE, 1.0, 0.7)
    np.testing.assert_allclose(mesh.vertices[:, 2] + position[2], ground.PAINT_LIFT, atol=1e-7)


@pytest.mark.parametrize("angle", [0.0, 0.5, np.pi / 2, -1.2])
def test_stripes_of_a_crosswalk_run_as_the_traffic_does(angle: float) -> None:
    """A road along `angle` with a crosswalk across it: rows of constant v run along the road."""
    c, s = np.cos(angle), np.sin(angle)

    def piece(name: str, kind: str, x0: float, x1: float) -> GroundRegion:
        corners = np.array([(x0, -3.0), (x1, -3.0), (x1, 3.0), (x0, 3.0)]) @ np.array([[c, s], [-s, c]])
        return GroundRegion(name, kind, tuple(map(tuple, corners)), (0.0, 0.0, 0.0))

    walk = piece("walk", "crosswalk", 5.0, 9.0)
    regions = [piece("a", "road", 0.0, 5.0), walk, piece("b", "road", 9.0, 14.0), piece("c", "sidewalk", 14.0, 16.0)]
    turn = ground.traffic_turn(walk, regions)
    assert np.angle(np.exp(2j * (turn - angle))) == pytest.approx(0.0, abs=1e-5)
    assert ground.traffic_turn(regions[0], regions) == 0.0
    assert ground.traffic_turn(walk, [walk, regions[3]]) == 0.0, "beside no road"
    position, mesh = ground.region_mesh(walk, TEXTURE, 2.0, 0.8, turn=turn)
    top, uv = mesh.vertices[:4] + position, mesh.uv[:4]
    along = (top[:, :2] - top[0, :2]) @ (c, s)
    np.testing.assert_allclose(np.abs(uv[:, 0] - uv[0, 0]) * 2.0, np.abs(along), atol=1e-4)


def test_stripes_of_the_shipped_streets_are_not_turned() -> None:
    for path in GRAPHS:
        regions = SceneGraph.load(path).ground
        assert [ground.traffic_turn(r, regions) for r in regions] == [0.0] * len(regions)
