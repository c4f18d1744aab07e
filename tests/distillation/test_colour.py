"""Grey images are told from coloured ones, and do not choose colours."""

import json
import pathlib

import numpy as np
import pytest
from PIL import Image

from tests.materialisation.catalogue_part import few_objects
from tests.support import drawn_street as street
from urbanverse_mjx.assets.selection import descriptors
from urbanverse_mjx.assets.selection.matching import Matcher
from urbanverse_mjx.datatypes import Recording
from urbanverse_mjx.distillation.colour import is_colourless, without_colour
from urbanverse_mjx.pipeline.generation.distilling import distil_to


def test_an_image_without_colour_is_known(tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(0)
    grey = np.repeat(rng.integers(0, 255, (64, 64, 1)), 3, 2)
    sepia = np.clip(grey * 0.7 + [40, 20, 0], 0, 255)
    noisy = np.clip(grey + rng.normal(0, 1, grey.shape), 0, 255)
    for image in (grey, sepia, noisy):
        assert is_colourless(image.astype(np.uint8))
        Image.fromarray(image.astype(np.uint8)).save(tmp_path / "image.jpg", quality=75)
        assert is_colourless(np.asarray(Image.open(tmp_path / "image.jpg").convert("RGB")))
    street_like = np.clip(grey + [[[6, 0, -8]]] * rng.uniform(-1, 1, (64, 64, 1)), 0, 255)
    assert not is_colourless(street_like.astype(np.uint8))


def drained(recording: Recording) -> Recording:
    for number, frame in enumerate(recording.frames):
        grey = recording.rgb(number).mean(-1).astype(np.uint8)
        Image.fromarray(np.repeat(grey[..., None], 3, 2)).save(recording.folder / frame.rgb)
    return recording


@pytest.mark.extended
@pytest.mark.parametrize("grey", [False, True])
def test_a_recording_without_colour_leaves_the_choice_of_ground_and_sky_open(
    tmp_path: pathlib.Path, grey: bool
) -> None:
    drawn = street.record(tmp_path / "drawn", street.street_objects(), street.walk(8, x0=10.0))
    (tmp_path / "out").mkdir()
    assert without_colour(drawn) is False
    graph = distil_to(drained(drawn) if grey else drawn, tmp_path / "out", lambda done, total: None)
    assert json.loads((tmp_path / "out" / "evidence.json").read_text())["colour"] is not grey
    assert (graph.sky_descriptor is None) is grey
    assert all((region.descriptor is None) is grey for region in graph.ground)
    assert graph.objects
    for obj in graph.objects:
        assert obj.descriptor is not None
        assert (sum(obj.descriptor[: descriptors.COLORS]) == 0) is grey
        assert sum(obj.descriptor[descriptors.COLORS :]) > 0


def test_outlines_alone_still_rank_and_colours_do_not() -> None:
    """Two crops of one outline in other colours match the same assets; another outline matches others."""
    matcher = Matcher(few_objects())
    mask = np.zeros((60, 60), bool)
    mask[20:50, 5:55] = True
    other = np.zeros((60, 60), bool)
    other[5:55, 10:50] = np.triu(np.ones((50, 40), bool))

    def ranked(colour: tuple[int, int, int], outline: np.ndarray, blind: bool) -> list[str]:
        query = descriptors.of_image(np.full((60, 60, 3), colour, np.uint8), outline)
        if blind:
            query[: descriptors.COLORS] = 0
        return [match.uid for match in matcher.match("sedan", (4.6, 1.82, 1.45), query, count=8)]

    assert ranked((200, 30, 30), mask, False) != ranked((30, 60, 200), mask, False)
    assert ranked((200, 30, 30), mask, True) == ranked((30, 60, 200), mask, True)
    assert ranked((200, 30, 30), mask, True) != ranked((200, 30, 30), other, True)
