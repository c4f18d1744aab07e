"""Overshoot of hulls over shapes for which it is known."""

import numpy as np
import pytest
import trimesh

from benchmarks import hull_overshoot as h


def box(size: tuple[float, float, float], at: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    """(8, 3) corners of a box with its middle at x and y and its bottom at z."""
    unit = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)])
    return unit * size + np.array(at)


def mesh(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> trimesh.Trimesh:
    parts = [trimesh.convex.convex_hull(box(size, at)) for size, at in boxes]
    starts = np.cumsum([0, *(len(p.vertices) for p in parts)])
    faces = [p.faces + start for p, start in zip(parts, starts[:-1], strict=True)]
    return trimesh.Trimesh(np.concatenate([p.vertices for p in parts]), np.concatenate(faces), process=False)


def measured(shape: trimesh.Trimesh, *hulls: np.ndarray) -> h.Overshoot:
    return h.overshoot(shape.vertices, shape.faces, hulls)


def test_a_hull_of_the_shape_itself_has_none() -> None:
    found = measured(mesh(((1.0, 2.0, 1.5), (0, 0, 0))), box((1.0, 2.0, 1.5)))
    assert found.rays > 500
    assert (found.over, found.worst) == (0, pytest.approx(0.0, abs=1e-6))


def test_a_hull_that_is_larger_by_12_cm_on_one_side() -> None:
    found = measured(mesh(((1.0, 2.0, 1.5), (0, 0, 0))), box((1.12, 2.0, 1.5), (0.06, 0, 0)))
    assert found.worst == pytest.approx(0.12, abs=1e-6)
    assert found.place[0] == pytest.approx(0.62)
    # The long side in front, of a circumference of 6.24 m, seen from all directions.
    assert 0.2 < found.over / found.rays < 0.5


def test_the_distance_is_that_to_the_surface_not_along_the_ray() -> None:
    """An L closed by its hull: the middle of the closing face is half a diagonal away from the corner of the L."""
    shape = mesh(((2.0, 0.2, 1.5), (0, -0.9, 0)), ((0.2, 2.0, 1.5), (-0.9, 0, 0)))
    found = measured(shape, np.concatenate([box((2.0, 0.2, 1.5), (0, -0.9, 0)), box((0.2, 2.0, 1.5), (-0.9, 0, 0))]))
    # The face from (1, -0.8) to (-0.8, 1) is x + y = 0.2; a point of it is equally far from both arms at (0.1, 0.1).
    assert found.worst == pytest.approx(0.9, abs=0.03)
    assert found.place[:2] == pytest.approx((0.1, 0.1), abs=0.03)


def test_a_shape_above_or_below_counts_as_surface() -> None:
    """A hull 4 cm under a table top: no surface is near at its own height, but one above."""
    shape = mesh(((1.0, 1.0, 0.5), (0, 0, 0.76)))
    found = h.overshoot(shape.vertices, shape.faces, [box((1.0, 1.0, 0.54), (0, 0, 0.72))], heights=(0.74,))
    assert (found.over, found.worst) == (0, pytest.approx(0.02, abs=1e-6))


@pytest.mark.parametrize(("gap", "counted"), [(0.2, False), (0.6, True)])
def test_gaps_count_if_a_robot_fits_in(gap: float, counted: bool) -> None:
    """Two posts closed by one hull: between them there is room for a robot of 31 cm, or not."""
    at = (gap + 0.3) / 2
    posts = ((0.3, 0.3, 1.5), (0, -at, 0)), ((0.3, 0.3, 1.5), (0, at, 0))
    found = measured(mesh(*posts), np.concatenate([box(*p) for p in posts]))
    assert (found.over > 0) == counted
    if counted:
        assert found.worst == pytest.approx(gap / 2, abs=0.03)


@pytest.mark.parametrize(("sill", "counted"), [(0.6, False), (0.0, True)])
def test_a_recess_counts_if_a_robot_on_the_ground_fits_in(sill: float, counted: bool) -> None:
    """A wall with a recess of 0.4 m that begins at a sill, as of a window, or at the ground, as of a door."""
    parts = [((1.0, 3.0, 1.5), (-0.9, 0, 0)), ((0.4, 1.0, 1.5), (-0.2, -1.0, 0)), ((0.4, 1.0, 1.5), (-0.2, 1.0, 0))]
    if sill:
        parts.append(((0.4, 1.0, sill), (-0.2, 0, 0)))
    found = measured(mesh(*parts), box((1.4, 3.0, 1.5), (-0.7, 0, 0)))
    assert (found.over > 0) == counted
    assert found.worst == pytest.approx(0.4 if counted else 0.0, abs=0.05)


def test_a_room_without_a_door_is_closed() -> None:
    """Four walls around a square of 2 m: a robot cannot be inside, so a hull there does not overshoot."""
    walls = [((2.2, 0.1, 1.5), (0, y, 0)) for y in (-1.05, 1.05)] + [
        ((0.1, 2.0, 1.5), (x, 0, 0)) for x in (-1.05, 1.05)
    ]
    assert measured(mesh(*walls), box((2.2, 2.2, 1.5))).over == 0


def test_what_lies_inside_the_mesh_or_above_a_robot_does_not_count() -> None:
    shape = mesh(((1.0, 1.0, 3.0), (0, 0, 0)))
    inside, above = box((0.5, 0.5, 3.0)), box((3.0, 3.0, 1.0), (0, 0, 2.0))
    assert measured(shape, inside) == h.Overshoot(0, 0, 0.0, (0.0, 0.0, 0.0))
    assert measured(shape, above).rays == 0


def test_a_shape_of_the_catalogue_and_the_table(tmp_path, capsys) -> None:
    out = tmp_path / "overshoot.csv"
    assert h.main(["--leaf", "bollard", "--out", str(out)]) == 0
    head, *rows = out.read_text().splitlines()
    assert head.startswith("uid,leaf,rest,rays")
    assert all(row.startswith("bollard/") for row in rows)
    assert "| bollard |" in capsys.readouterr().out
    assert h.main(["--leaf", "no such leaf"]) == 2
