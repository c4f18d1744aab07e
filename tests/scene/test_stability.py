"""Stable and unstable objects, and that unstable ones become fixed."""

import dataclasses

import numpy as np
import pytest

from tests.support.standing_objects import CUBE, LEANING, scene_of
from urbanverse_mjx.scene import compiler
from urbanverse_mjx.scene.stability import _around_movable, displacements


def test_boxes_stay_and_a_leaning_post_falls():
    moves = displacements(scene_of(CUBE, LEANING, CUBE))
    assert [m.id for m in moves] == ["thing_1"]
    assert moves[0].tilt > 0.5
    assert moves[0].shift > 0.2


def test_what_is_fixed_cannot_fall():
    assert displacements(scene_of(LEANING, movable=False)) == []


def test_a_box_in_the_air_comes_down_and_one_in_another_is_thrown_out():
    scene = scene_of(CUBE, CUBE)
    high = scene.object_position + [[0, 0, 0], [0, 0, 1.0]]
    assert [m.id for m in displacements(dataclasses.replace(scene, object_position=high))] == ["thing_1"]
    inside = scene.object_position - [[0, 0, 0], [0.8, 0, 0]]
    assert displacements(dataclasses.replace(scene, object_position=inside))


@dataclasses.dataclass(frozen=True)
class Part:
    """The fields of a layout that `_with_unstable_frozen` reads."""

    id: str
    movable: bool = True


@dataclasses.dataclass(frozen=True)
class Parts:
    objects: tuple[Part, ...]


def test_what_is_unstable_is_frozen_until_all_stay():
    geometry, layout = compiler._with_unstable_frozen(
        scene_of(CUBE, LEANING),
        Parts((Part("thing_0"), Part("thing_1"))),  # pyright: ignore[reportArgumentType]
    )
    assert geometry.object_movable.tolist() == [True, False]
    assert [o.movable for o in layout.objects] == [True, False]
    assert displacements(geometry) == []
    assert displacements(geometry, seconds=0.01) == pytest.approx([])


def test_only_fixed_objects_near_by_count():
    """Half a metre apart in the box street: the neighbour stays in the trial, the one after next does not."""
    scene = dataclasses.replace(scene_of(CUBE, CUBE, CUBE), object_movable=np.array([True, False, False]))
    position = scene.object_position.copy()
    position[1] = position[0] + [0.8, 0, 0]
    position[2] = position[0] + [0, 4.0, 0]
    near = _around_movable(dataclasses.replace(scene, object_position=position))
    assert near.object_ids == ("thing_0", "thing_1")
    np.testing.assert_array_equal(near.object_position, position[:2])
    assert [near.hulls[h].tolist() for h in near.inst_hull] == [CUBE.tolist()] * 2
    assert near.inst_object.tolist() == [0, 1]
