"""Other colours for painted parts, and crowns of sprays."""

import dataclasses

import numpy as np
import pytest

from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.meshes import crowns, palette, repaint, sheets
from urbanverse_mjx.assets.meshes.instances import pixels

INDEX = load_index()


def shares(mesh) -> dict[tuple[int, ...], float]:
    """Colour of each flat triangle -> share of the surface."""
    corners = mesh.uv[mesh.faces]
    flat = (corners == corners[:, :1]).all((1, 2))
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    row, column = pixels(mesh.texture, corners[flat, 0]).T
    found: dict[tuple[int, ...], float] = {}
    for color, size in zip(mesh.texture[row, column].tolist(), area[flat] / area.sum(), strict=True):
        found[tuple(color)] = found.get(tuple(color), 0.0) + float(size)
    return found


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_car_changes_its_body_and_keeps_tyres_and_glass(number: int) -> None:
    mesh = build_mesh(INDEX.by_leaf("sedan")[number])
    old, new = shares(mesh), shares(repaint.repainted(mesh, ["#1f3f75"]))
    body = max(old, key=lambda c: old[c])
    assert new[(0x1F, 0x3F, 0x75)] == pytest.approx(old[body], abs=0.02)
    assert body not in new
    for name in ("rubber", "dark glass", "charcoal"):
        assert new[palette.NAMED[name]] == pytest.approx(old[palette.NAMED[name]])


def test_shades_of_a_part_stay_darker() -> None:
    mesh = build_mesh(INDEX.by_leaf("sedan")[0])  # a silver body with a darker underside
    new = shares(repaint.repainted(mesh, ["#c80000"]))
    reds = sorted(c[0] for c in new if c[0] > 60 and c[1] < 10 and c[2] < 10)
    assert reds[-1] == 200
    assert reds[0] == pytest.approx(200 * 0x5D / 0xA9, abs=4)


def test_clothes_are_two_parts_and_skin_is_none() -> None:
    mesh = build_mesh(INDEX.by_leaf("pedestrian adult")[1])  # a blue shirt, jeans, medium skin
    new = shares(repaint.repainted(mesh, ["#102030", "#a0b0c0"]))
    assert new[(0x10, 0x20, 0x30)] > 0.25
    assert new[(0xA0, 0xB0, 0xC0)] > 0.25
    assert palette.NAMED["skin medium"] in new


def test_no_colours_change_nothing_and_an_untinted_record_has_its_recipes_colours() -> None:
    record = INDEX.by_leaf("sedan")[0]
    mesh = build_mesh(record)
    assert repaint.repainted(mesh, []) is mesh
    assert repaint.untinted(record) is record
    inner = {"base": "x", "scale": [1.0, 1.0, 1.0], "tint": [0.3, 1.1, 0.9]}
    tinted = dataclasses.replace(record, params={**record.params, "instance": inner})
    np.testing.assert_array_equal(build_mesh(repaint.untinted(tinted)).texture, mesh.texture)
    assert (build_mesh(tinted).texture != mesh.texture).any()


def test_sprays_use_the_triangles_of_the_lumps_and_leave_the_trunk() -> None:
    record = INDEX.by_leaf("tree")[0]
    mesh = build_mesh(record)
    leafy = crowns.with_sprays(mesh, record.uid)
    np.testing.assert_array_equal(leafy.faces, mesh.faces)
    np.testing.assert_array_equal(leafy.uv, mesh.uv)
    corners = mesh.uv[mesh.faces]
    trunk = np.unique(mesh.faces[(corners == corners[:, :1]).all((1, 2))])
    np.testing.assert_array_equal(leafy.vertices[trunk], mesh.vertices[trunk])
    moved = np.linalg.norm(leafy.vertices - mesh.vertices, axis=1)
    assert 0.4 < (moved > 1e-6).sum() / (len(moved) - len(trunk)) < 0.8
    assert moved.max() < 1.2
    assert np.abs(leafy.extent - mesh.extent).max() < 1.0
    normal = [
        np.cross(
            m.vertices[m.faces[:, 1]] - m.vertices[m.faces[:, 0]], m.vertices[m.faces[:, 2]] - m.vertices[m.faces[:, 0]]
        )
        for m in (mesh, leafy)
    ]
    cosine = (normal[0] * normal[1]).sum(1) / np.maximum(
        np.linalg.norm(normal[0], axis=1) * np.linalg.norm(normal[1], axis=1), 1e-12
    )
    assert (cosine < 0.97).sum() > 500
    car = build_mesh(INDEX.by_leaf("sedan")[0])
    assert np.abs(crowns.with_sprays(car, "a").vertices - car.vertices).max() == 0.0


def test_the_two_sides_of_printed_cloth_are_apart_and_each_is_outside() -> None:
    """Back to back in one place, a renderer without culling mixes the letters of both sides."""
    record = INDEX.by_leaf("banner")[0]
    mesh = build_mesh(record)
    apart = sheets.with_sides_apart(mesh)
    assert record.leaf in sheets.LETTERED
    cloth = ~(mesh.uv[mesh.faces] == mesh.uv[mesh.faces][:, :1]).all((1, 2))
    for shown, gap in ((mesh, 0.0), (apart, sheets.APART)):
        triangles = shown.vertices.astype(float)[shown.faces[cloth]]
        towards = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])[:, 0] > 0
        front, back = triangles[towards].mean(1), triangles[~towards].mean(1)
        assert len(front) == len(back) > 50
        nearest = np.abs(front[:, None, 1:] - back[None, :, 1:]).sum(-1).argmin(1)
        assert (front[:, 0] - back[nearest, 0]) == pytest.approx(gap, abs=0.3 * sheets.APART)
    assert np.array_equal(apart.uv, mesh.uv)
    moved = np.unique(np.flatnonzero((apart.vertices != mesh.vertices).any(1)))
    assert set(moved) == set(np.unique(mesh.faces[cloth]))
    bench = build_mesh(INDEX.by_leaf("bollard")[0])
    assert sheets.with_sides_apart(bench) is bench
