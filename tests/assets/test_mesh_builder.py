"""Volumes of solids against closed forms, the texture against the painted colours."""

import numpy as np
import pytest
import trimesh

from urbanverse_mjx.assets.meshes import paint, shapes
from urbanverse_mjx.assets.meshes.atlas import pack
from urbanverse_mjx.assets.meshes.mesh_builder import MeshBuilder
from urbanverse_mjx.assets.meshes.shapes import Shape

TURNED = shapes.box((1.0, 2.0, 3.0)).transformed(np.diag([-1.0, 1.0, 1.0, 1.0]))  # mirrored, still outwards
HOLE = [(0.5, 0.5), (1.5, 0.5), (1.5, 1.5), (0.5, 1.5)]
SOLIDS: list[tuple[str, Shape, float]] = [
    ("box", shapes.box((1.0, 2.0, 3.0)), 6.0),
    ("mirrored box", TURNED, 6.0),
    ("cylinder", shapes.frustum(1.0, 1.0, 2.0, 128), 2 * np.pi),
    ("cone", shapes.frustum(1.0, 0.0, 3.0, 128), np.pi),
    ("ellipsoid", shapes.ellipsoid((1.0, 2.0, 0.5), 96, 64), 4 / 3 * np.pi),
    ("capsule", shapes.capsule(0.5, 2.0, 64, 24), np.pi * 0.25 + 4 / 3 * np.pi * 0.125),
    ("torus", shapes.torus(1.0, 0.2, 96, 48), 2 * np.pi**2 * 0.04),
    ("holed plate", shapes.extrusion([(0, 0), (2, 0), (2, 2), (0, 2)], 1.0, [HOLE]), 3.0),
    ("clockwise outline", shapes.extrusion([(0, 2), (2, 2), (2, 0), (0, 0)], 1.0), 4.0),
    ("straight tube", shapes.tube([(0, 0, 0), (0, 0, 2)], 0.5, 128), 0.5 * np.pi),
    ("closed tube", shapes.tube(shapes.ring(1.0, 96), 0.1, 32, closed=True), 2 * np.pi**2 * 0.01),
    ("lathe", shapes.lathe([(0, 0), (1, 0), (1, 1), (0, 1)], 128), np.pi),
]


@pytest.mark.parametrize(("name", "shape", "volume"), SOLIDS, ids=[s[0] for s in SOLIDS])
def test_solids_are_closed_outward_and_of_the_known_volume(name: str, shape: Shape, volume: float) -> None:
    solid = trimesh.Trimesh(shape.vertices, shape.faces, process=True)
    assert solid.is_watertight
    # trimesh's volume is negative where faces point inwards.
    assert solid.volume == pytest.approx(volume, rel=1e-2)
    assert shapes.volume(shape) == pytest.approx(volume, rel=1e-2)


def test_products_are_rounded_after_every_step() -> None:
    """As one multiplication and one addition after the other, never fused: numbers of whole floats tell the two."""
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(50, 3)), rng.normal(size=(3, 4))
    expected = [[(r[0] * c[0] + r[1] * c[1]) + r[2] * c[2] for c in b.T.tolist()] for r in a.tolist()]
    np.testing.assert_array_equal(shapes.product(a, b), np.array(expected))


def test_a_bevel_cuts_only_edges() -> None:
    plain, cut = shapes.box((1, 1, 1)), shapes.box((1, 1, 1), bevel=0.1)
    assert np.ptp(cut.vertices, axis=0) == pytest.approx([1, 1, 1])
    # Each of 12 edges loses a right triangle of 0.1 x 0.1 over about its length.
    assert 0 < shapes.volume(plain) - shapes.volume(cut) < 12 * 0.1 * 0.1 / 2


def test_creases_split_and_smooth_surfaces_do_not() -> None:
    box, ball = shapes.box((1, 1, 1)), shapes.ellipsoid(1.0, 24, 16)
    assert len(shapes.split_at_creases(box, 40.0).vertices) == 24  # three corners where three faces meet
    assert len(shapes.split_at_creases(ball, 40.0).vertices) == len(ball.vertices)


def test_colours_and_images_come_back_from_the_texture() -> None:
    """Look up every face's middle in the texture: it has the part's colour or image."""
    image = np.zeros((20, 10, 3), np.uint8)
    image[:10] = (10, 20, 30)  # upper half
    image[10:] = (200, 100, 50)
    b = MeshBuilder()
    b.box((1, 1, 1), color=(255, 0, 0))
    b.ball(0.2, (0, 0, 2), (0, 255, 0))
    b.panel(image, (3.0, 0, 1.0), 1.0, 2.0, "+x")
    mesh = b.build("a test").mesh
    height, width = mesh.texture.shape[:2]
    middle = mesh.vertices[mesh.faces].mean(1)
    uv = mesh.uv[mesh.faces].mean(1)
    shown = mesh.texture[((1 - uv[:, 1]) * height).astype(int), (uv[:, 0] * width).astype(int)]
    low, high = mesh.vertices[:, 0].min(), mesh.vertices[:, 0].max()
    panel = middle[:, 0] > high - 1e-6
    assert panel.sum() == 2
    # The two triangles of a panel have their middles at a third and two thirds of its height.
    for at, colour in zip(middle[panel], shown[panel], strict=True):
        assert tuple(colour) == ((10, 20, 30) if at[2] > 1.0 else (200, 100, 50))
    rest = ~panel
    ball = middle[:, 2] > 1.5
    assert (shown[rest & ball & (middle[:, 0] < low + 1.0)] == (0, 255, 0)).all()
    assert (shown[rest & ~ball] == (255, 0, 0)).all()


def test_images_read_left_to_right_from_the_front() -> None:
    """Seen from +x with z up, the image's right side is towards +y."""
    b = MeshBuilder()
    b.box((0.1, 0.1, 0.1), color="grey")
    b.panel(paint.canvas((8, 8), "red")[0], (1.0, 0.0, 0.0), 2.0, 1.0, "+x")
    mesh = b.build("a test", recenter=False).mesh
    corners = mesh.vertices[:, 0] == 1.0
    right_of = mesh.vertices[corners, 1] > 0
    u = mesh.uv[corners, 0]
    assert u[right_of].min() > u[~right_of].max()
    upper = mesh.vertices[corners, 2] > 0
    v = mesh.uv[corners, 1]
    assert v[upper].min() > v[~upper].max()


@pytest.mark.parametrize("lettered", [False, True])
def test_text_on_the_back_of_a_sheet_reads_right_and_a_flags_back_is_mirrored(lettered: bool) -> None:
    grid = np.array([[(0.0, y, z) for y in (-1.0, 0.0, 1.0)] for z in (0.0, 1.0)])
    b = MeshBuilder()
    b.sheet(grid, image=paint.canvas((8, 8), "red")[0], both_sides=True, lettered=lettered)
    mesh = b.build("a test", recenter=False).mesh
    corners = mesh.vertices[mesh.faces]
    front = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 0] > 0
    assert front.sum() == (~front).sum() == 4
    for side, right in ((front, 1.0), (~front, -1.0 if lettered else 1.0)):
        y, u = corners[side][..., 1].ravel(), mesh.uv[mesh.faces[side]][..., 0].ravel()
        assert np.corrcoef(right * y, u)[0, 1] == pytest.approx(1.0)
        v = mesh.uv[mesh.faces[side]][..., 1].ravel()
        assert np.corrcoef(corners[side][..., 2].ravel(), v)[0, 1] == pytest.approx(1.0)


def test_the_built_mesh_stands_centred_on_the_ground() -> None:
    b = MeshBuilder()
    b.box((1, 2, 3), (5, -7, 2))
    mesh = b.build("a test").mesh
    assert mesh.vertices.min(0) == pytest.approx([-0.5, -1.0, 0.0])
    assert mesh.vertices.max(0) == pytest.approx([0.5, 1.0, 3.0])


def test_frames_nest_and_mirror() -> None:
    b = MeshBuilder()
    with b.frame((1, 0, 0)), b.frame(turn_deg=(0, 0, 90)), b.frame(scale=(1, -1, 1)):
        b.box((0.2, 0.2, 0.2), (2, 1, 0))
    # (2, 1) mirrored to (2, -1), turned by 90 degrees to (1, 2), moved to (2, 2).
    assert b.bounds.mean(0) == pytest.approx([2, 2, 0.1])
    assert b.build("a test").volume == pytest.approx(0.008)


def test_too_many_images_are_refused() -> None:
    with pytest.raises(ValueError, match="512x512"):
        pack([(0, 0, 0)], [np.zeros((400, 400, 3), np.uint8)] * 2)


def test_a_part_needs_one_paint() -> None:
    with pytest.raises(ValueError, match="exactly one"):
        MeshBuilder().add(shapes.box((1, 1, 1)))
