"""Fragments of objects: what lies in the box of an object that was seen more often, and when it is one of its own."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from urbanverse_mjx.datatypes import LabelPrior
from urbanverse_mjx.distillation.boxes import Box
from urbanverse_mjx.distillation.depth_scale import DepthScale
from urbanverse_mjx.distillation.objects import Fused, FusedObject, mean_belief, without_fragments

LABELS = ("house", "pharmacy", "car")
#: A pharmacy is a house; a car is neither.
ALIKE = np.array([[1.0, 0.95, 0.0], [0.95, 1.0, 0.0], [0.0, 0.0, 1.0]])


def scene(label: str, frames: list[int], shift: float = 0.0, votes: Any = None) -> tuple[list[FusedObject], Any]:
    """A house that frames 0 to 19 show, and an object of a metre in its middle, `shift` m along x, of other frames."""
    rows = np.arange(20), 20 + np.arange(len(frames))
    sizes = np.array([8.0, 6.0, 5.0]), np.ones(3)
    centers = np.zeros(3), np.array([shift, 0.0, 0.0])
    labels = [0] * 20 + [LABELS.index(label)] * len(frames)
    of_row = np.r_[np.zeros(20, int), np.ones(len(frames), int)]
    half = np.stack(sizes)[of_row] / 2
    middle = np.stack(centers)[of_row]
    beliefs = np.eye(3)[labels]
    if votes is not None:
        beliefs[20:] = votes
    fused = SimpleNamespace(
        views=SimpleNamespace(labels=LABELS, frame=np.r_[np.arange(20), frames], score=np.ones(len(labels))),
        placed=SimpleNamespace(low=middle - half, high=middle + half),
        alike=ALIKE,
        votes=beliefs,
    )
    objects = [
        FusedObject(k, name, 0.9, Box(at, size, 0.0, 0.1, 0.0, (False, False, False), size), LabelPrior(), row)
        for k, (name, at, size, row) in enumerate(zip(("house", label), centers, sizes, rows, strict=True))
    ]
    return objects, fused


@pytest.mark.parametrize(
    ("label", "frames", "shift", "left"),
    [
        ("house", [30, 31, 32, 33], 0.0, [0]),
        ("pharmacy", [30, 31, 32, 33], 0.0, [0]),  # labels that are nearly one
        ("car", [30, 31, 32, 33], 0.0, [0, 1]),  # an object of another kind, such as a car before it
        ("house", [30, 31, 32, 33], 6.0, [0, 1]),  # beside it
        ("house", [0, 1, 32, 33], 0.0, [0]),  # half of its frames show both
        ("house", [0, 1, 2, 33], 0.0, [0, 1]),  # most do: two objects
        ("house", list(range(30, 41)), 0.0, [0, 1]),  # seen more than half as often
    ],
)
def test_a_fragment_is_of_the_same_label_inside_and_rarely_beside(
    label: str, frames: list[int], shift: float, left: list[int]
) -> None:
    objects, fused = scene(label, frames, shift)
    assert [t.number for t in without_fragments(objects, fused)] == left


def test_beliefs_tell_a_fragment_with_a_dissimilar_label() -> None:
    """Named a car by a hair, but its views believe in a house."""
    objects, fused = scene("car", [30, 31, 32, 33], votes=[1.0, 0.0, 0.0])
    assert [t.number for t in without_fragments(objects, fused)] == [0]


def test_near_and_certain_views_believe_more() -> None:
    views = SimpleNamespace(belief=np.eye(3)[[0, 1, 2]], score=np.array([0.5, 1.0, 1.0]))
    fused: Any = SimpleNamespace(views=views, placed=SimpleNamespace(sigma=np.array([0.5, 1.0, 4.0])))
    found = mean_belief(fused, np.arange(3))  # weights 1, 1 and a quarter
    np.testing.assert_allclose(found, np.array([4.0, 4.0, 1.0]) / 9.0)
    np.testing.assert_allclose(mean_belief(fused, np.array([2])), [0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("single_view", "noise", "doubtful", "exact"),
    [
        (False, 0.001, False, True),
        (False, 0.001, True, False),  # true depth below detections
        (False, 0.05, False, False),  # certain labels over estimated depth
        (True, 0.05, True, True),
    ],
)
def test_annotations_with_agreeing_depth_are_exact(
    single_view: bool, noise: float, doubtful: bool, exact: bool
) -> None:
    belief = np.array([[1.0, 0.0], [0.4, 0.6] if doubtful else [0.0, 1.0]], np.float32)
    unused: Any = None
    views: Any = SimpleNamespace(belief=belief)
    depth = DepthScale(np.ones(2), noise)
    fused = Fused(unused, views, unused, unused, unused, unused, unused, unused, depth, single_view)
    assert fused.exact == exact
