"""Vehicles, people, animals, plants, buildings: of the size of their kind, the right way round, closed where needed."""

import itertools

import numpy as np
import pytest

from urbanverse_mjx.assets.collision import decompose
from urbanverse_mjx.assets.meshes import recipe
from urbanverse_mjx.assets.meshes.mesh_builder import BuiltAsset, MeshBuilder
from urbanverse_mjx.assets.recipes.building.facade import Facade
from urbanverse_mjx.assets.recipes.street_user.figure import STANDING, Figure, Person
from urbanverse_mjx.assets.recipes.vehicle import car_shapes
from urbanverse_mjx.assets.recipes.vehicle.vehicle_body import Body

#: Least and greatest (length along x, width along y, height) of real objects, m.
SIZES = {
    "sedan": ((4.2, 1.8, 1.35), (5.3, 2.3, 1.65)),
    "hatchback car": ((3.4, 1.7, 1.35), (4.5, 2.2, 1.7)),
    "suv": ((4.1, 1.8, 1.55), (5.3, 2.4, 2.0)),
    "van": ((4.8, 1.9, 1.9), (6.5, 2.6, 2.8)),
    "bus": ((9.0, 2.4, 2.8), (12.5, 3.0, 3.5)),
    "truck": ((5.0, 2.2, 2.4), (8.5, 2.8, 3.6)),
    "bicycle": ((1.5, 0.4, 0.9), (1.95, 0.75, 1.2)),
    "motorcycle": ((1.7, 0.6, 1.0), (2.4, 0.95, 1.4)),
    "wheelchair": ((0.8, 0.55, 0.85), (1.2, 0.8, 1.25)),
    "stroller": ((0.8, 0.45, 0.9), (1.3, 0.7, 1.25)),
    "delivery robot": ((0.6, 0.45, 0.9), (1.1, 0.75, 1.7)),
    "pedestrian adult": ((0.25, 0.4, 1.5), (1.2, 0.8, 2.0)),
    "pedestrian child": ((0.15, 0.25, 0.8), (1.0, 0.6, 1.55)),
    "dog": ((0.5, 0.12, 0.35), (1.4, 0.45, 1.0)),
    "cat": ((0.25, 0.1, 0.3), (0.8, 0.35, 0.5)),
    "bird": ((0.25, 0.1, 0.2), (0.7, 0.3, 0.5)),
    "tree": ((2.0, 2.0, 4.5), (7.5, 7.5, 9.0)),
    "grass patch": ((1.0, 1.0, 0.01), (3.0, 3.0, 0.03)),
    "cafe": ((4.5, 6.0, 6.0), (10.0, 14.5, 18.5)),
    "house": ((6.0, 6.0, 7.0), (10.5, 10.0, 11.0)),
    "garage": ((5.5, 5.5, 2.5), (8.0, 11.0, 5.5)),
}


def built(leaf: str) -> list[BuiltAsset]:
    return [r.build(k) for r in recipe.all_recipes() if r.leaf == leaf for k in range(r.variants)]


def closed_volume(asset: BuiltAsset) -> float:
    """m^3 of the largest piece without any hole in the input of the convex decomposition."""
    volumes = [0.0]
    for vertices, faces in decompose.connected_pieces(asset.mesh, asset.part_faces):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        if (np.unique(edges, axis=0, return_counts=True)[1] == 2).all():
            volumes.append(decompose.signed_volume(vertices, faces))
    return max(volumes)


@pytest.mark.parametrize("leaf", SIZES)
def test_sizes_are_those_of_the_kind(leaf: str) -> None:
    least, greatest = np.array(SIZES[leaf])
    for asset in built(leaf):
        extent = asset.mesh.extent
        if "lying" in asset.description:
            continue
        assert (extent >= least).all(), f"{asset.description}: {extent.round(2)}"
        assert (extent <= greatest).all(), f"{asset.description}: {extent.round(2)}"
        assert asset.mesh.vertices[:, 2].min() == pytest.approx(0, abs=1e-6)
        assert np.abs(asset.mesh.vertices[:, :2].max(0) + asset.mesh.vertices[:, :2].min(0)).max() < 1e-5
        assert 200 <= len(asset.mesh.faces) <= 4000 or leaf == "garage"


@pytest.mark.parametrize("name", ["SEDAN", "HATCHBACK", "SUV", "VAN", "MINIVAN", "PICKUP"])
def test_car_bodies_are_closed_and_as_voluminous_as_cars(name: str) -> None:
    """Closed, so that CoACD gets a solid; the volume is checked against an independent integration of the sections."""
    shape = getattr(car_shapes, name)
    body = Body(MeshBuilder(), shape)
    body.shell("red")
    volume = closed_volume(body.builder.build("a body"))
    assert volume == pytest.approx(body.volume, rel=1e-4)
    upper, (heights, shares) = np.array(shape.upper), np.array(shape.section).T
    x = np.linspace(upper[:, 0].min(), upper[:, 0].max(), 400)
    levels = [np.linspace(shape.sill, _height(upper, at), 50) for at in x]
    slices = [np.trapezoid(shape.width * np.interp(z, heights, shares), z) for z in levels]
    # The integration has neither wheel arches, nor tapered ends, nor the bulge, which change the volume by up to 25 %.
    assert volume == pytest.approx(np.trapezoid(slices, x), rel=0.25)


def _height(upper: np.ndarray, x: float) -> float:
    """Height of the outline's upper side over x."""
    best = 0.3
    for (x0, z0, _), (x1, z1, _) in itertools.pairwise(upper):
        if min(x0, x1) <= x <= max(x0, x1) and x0 != x1:
            best = max(best, z0 + (x - x0) / (x1 - x0) * (z1 - z0))
    return best


def test_cars_stand_on_their_wheels_and_look_along_x() -> None:
    for leaf in ("sedan", "hatchback car", "suv", "minivan"):
        for asset in built(leaf):
            vertices = asset.mesh.vertices
            low = vertices[vertices[:, 2] < 0.05]
            # Four places touch the ground, one in each quadrant.
            assert len({tuple(np.sign(p[:2]).astype(int)) for p in low}) == 4
            # The bonnet is lower than the tail's or roof's rear part: front third against rear third, above the wheels.
            third = asset.mesh.extent[0] / 6
            front = vertices[vertices[:, 0] > 2 * third][:, 2].max()
            middle = vertices[np.abs(vertices[:, 0]) < third][:, 2].max()
            assert front < 0.8 * middle


def test_a_block_with_openings_stays_closed_whatever_its_openings() -> None:
    """Doors that cross the plain ground floor's edge, windows above and below it: no seam gapes."""
    rng = np.random.default_rng(3)
    image = np.full((8, 8, 3), 128, np.uint8)
    for _ in range(12):
        facade = Facade(MeshBuilder(), 10.0, 6.0, 9.0, "white")
        carved = 0.0
        for k in range(4):
            width, height, recess = rng.uniform(0.8, 1.9), rng.uniform(0.9, 3.5), rng.uniform(0.05, 0.5)
            facade.opening(-3.75 + 2.5 * k, rng.uniform(0.05, 4.5), width, height, image, recess, sill=False)
            carved += width * height * recess
        facade.walls(image, "grey", 3.1)
        assert closed_volume(facade.builder.build("a block")) == pytest.approx(10 * 6 * 9 - carved, rel=1e-5)


def test_every_shop_and_house_is_a_closed_block() -> None:
    for leaf in ("bakery", "house", "garage"):
        for asset in built(leaf):
            depth, width, height = asset.mesh.extent
            assert closed_volume(asset) > 0.45 * depth * width * height


@pytest.mark.parametrize("height", [1.1, 1.65, 1.9])
def test_figures_are_as_tall_as_asked_and_seven_heads_high(height: float) -> None:
    figure = Figure(MeshBuilder(), Person(height=height, hair="bald"), STANDING)
    figure.build()
    low, high = figure.builder.bounds
    assert high[2] - low[2] == pytest.approx(height, rel=0.03)
    head = 2 * figure.head_radii[2]
    assert 6.7 < height / head < 7.8
    # Face and toes point along +x: the toes reach further from the ankles than the heels do.
    assert high[0] - figure.ankles[0][0] > 0.08 * height
    assert figure.ankles[0][0] - low[0] < 0.08 * height


def test_trees_leave_room_to_drive_under_their_crowns() -> None:
    for asset in built("tree")[:6]:
        vertices = asset.mesh.vertices
        low = vertices[(vertices[:, 2] < 1.0)]
        assert np.linalg.norm(low[:, :2], axis=1).max() < 0.9, "below a metre there is only the trunk"


@pytest.mark.extended
def test_the_same_variant_is_the_same_mesh_again() -> None:
    for leaf in ("tree", "cafe", "pedestrian adult"):
        first, second = built(leaf)[0].mesh, built(leaf)[0].mesh
        assert np.array_equal(first.vertices, second.vertices)
        assert np.array_equal(first.faces, second.faces)
        assert np.array_equal(first.texture, second.texture)
