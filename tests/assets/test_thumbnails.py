"""The cache of thumbnails; the drawing itself needs OpenGL and is replaced by an image of the texture."""

import numpy as np
import pytest
from PIL import Image

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.previews import thumbnails
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.datatypes.validation import write_atomically

RECORDS = load_index().by_leaf("traffic cone")


@pytest.fixture
def drawn(tmp_path, monkeypatch) -> list[str]:
    """Names of the drawn thumbnails, in a cache of this test's own."""
    names: list[str] = []

    def draw(mesh, path):
        names.append(path.name)
        image = Image.fromarray(np.resize(mesh.texture, (160, 160, 3)))
        return write_atomically(path, lambda p: image.save(p, "PNG"))

    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    monkeypatch.setattr(thumbnails, "draw", draw)
    return names


def test_what_is_there_is_not_drawn_again(drawn: list[str]) -> None:
    assert thumbnails.draw_missing(RECORDS[:2]) == (2, 0)
    seen: list[tuple[int, int]] = []
    assert thumbnails.draw_missing(RECORDS, lambda *done: seen.append(done)) == (len(RECORDS) - 2, 2)
    assert seen == [(k, len(RECORDS)) for k in range(1, len(RECORDS) + 1)]
    assert len(drawn) == len(set(drawn)) == len(RECORDS)
    assert thumbnails.thumbnail(RECORDS[0]).shape == (160, 160, 3)
    assert len(drawn) == len(RECORDS)


def test_another_mesh_is_another_picture() -> None:
    first, second = (build_mesh(r) for r in RECORDS[:2])
    assert thumbnails.path_of(RECORDS[0], first) == thumbnails.path_of(RECORDS[0], first)
    assert thumbnails.path_of(RECORDS[0], first) != thumbnails.path_of(RECORDS[0], second)


def test_broken_pictures_are_named(drawn: list[str]) -> None:
    thumbnails.draw_missing(RECORDS[:2])
    assert thumbnails.damaged() == []
    broken = thumbnails.folder() / drawn[0]
    broken.write_bytes(broken.read_bytes()[:60])
    assert thumbnails.damaged() == [broken]
