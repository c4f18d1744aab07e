"""The distillation's knowledge about labels: sizes, shapes and fronts."""

import numpy as np

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.selection.label_priors import LabelPriors


def test_shapes_fill_their_boxes() -> None:
    """Points all over a bench: inside its box and near each of its sides."""
    known = LabelPriors(load_index())("bench")
    assert len(known.shapes) == len(known.extents) > 0
    assert not known.faces_road
    for shape, extent in zip(known.shapes, known.extents, strict=True):
        np.testing.assert_allclose(np.ptp(shape, axis=0), extent, rtol=0.1)
        assert (np.ptp(shape, axis=0) <= extent + 1e-3).all()


def test_houses_face_the_road_and_have_no_shape() -> None:
    known = LabelPriors(load_index())("house")
    assert known.faces_road
    assert known.shapes == ()
    assert len(known.extents) > 0


def test_the_same_shapes_every_time() -> None:
    first, second = (LabelPriors(load_index())("mailbox").shapes for _ in range(2))
    assert all((a == b).all() for a, b in zip(first, second, strict=True))
