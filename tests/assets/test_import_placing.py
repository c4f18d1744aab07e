"""Imported meshes stand upright, in metres, with their front along +x."""

import numpy as np
import pytest

from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.categories.priors import prior
from urbanverse_mjx.assets.importing.placing import MAX_STRETCH_LOG, misfit_of_proportions, place, quarter_turns
from urbanverse_mjx.assets.meshes.glb import TO_GLTF

INDEX = load_index()


def vertices_of(leaf: str) -> np.ndarray:
    return build_mesh(INDEX.by_leaf(leaf)[0]).vertices.astype(float)


@pytest.mark.parametrize("leaf", ["bench", "sedan", "fire hydrant", "street light"])
def test_a_gltf_frame_becomes_ours(leaf: str) -> None:
    ours = vertices_of(leaf)
    placed = place(ours @ TO_GLTF.T, True, prior(leaf))
    assert (placed.scale, placed.scaled, placed.steps) == (1.0, "", ())
    assert placed.apply(ours @ TO_GLTF.T) == pytest.approx(ours, abs=1e-4)


@pytest.mark.parametrize("leaf", ["street light", "traffic cone", "sedan"])
def test_an_obj_file_that_says_nothing_is_stood_up_by_its_sizes(leaf: str) -> None:
    ours = vertices_of(leaf)
    for file, steps in ((ours, ("read with z up",)), (ours @ TO_GLTF.T, ("read with y up",))):
        placed = place(file, None, prior(leaf))
        assert placed.steps == steps
        assert np.ptp(placed.apply(file), axis=0) == pytest.approx(np.ptp(ours, axis=0), rel=1e-6)


def test_a_car_that_stands_across_is_turned() -> None:
    ours = vertices_of("sedan")
    across = ours @ quarter_turns(1).T @ TO_GLTF.T
    placed = place(across, True, prior("sedan"))
    assert placed.steps == ("turned by 270 degrees to face +x",)
    assert placed.apply(across) == pytest.approx(ours, abs=1e-4)


@pytest.mark.parametrize("view", [0, 1, 2, 3])
def test_the_annotated_view_becomes_the_front(view: int) -> None:
    """View k shows the side k quarters counter-clockwise from the file's +x."""
    ours = vertices_of("bench")
    file = ours @ quarter_turns(view).T @ TO_GLTF.T
    placed = place(file, True, prior("bench"), front_view=view)
    assert placed.apply(file) == pytest.approx(ours, abs=1e-4)


def test_an_annotated_height_sets_the_scale() -> None:
    ours = vertices_of("bench")
    height = float(np.ptp(ours[:, 2]))
    placed = place(ours @ TO_GLTF.T * 37.0, True, prior("bench"), {"height": height})
    assert placed.scale == pytest.approx(1 / 37.0)
    assert "annotated size" in placed.scaled


def test_a_stretched_object_fits_at_no_scale() -> None:
    row = prior("bench")
    extent = np.ptp(vertices_of("bench"), axis=0)
    assert misfit_of_proportions(extent, row) == 0.0
    assert misfit_of_proportions(extent * (1, 1, 30), row) > MAX_STRETCH_LOG
