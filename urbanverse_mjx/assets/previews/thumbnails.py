"""Thumbnails in the cache: every base shape by `make thumbnails`, an instance when it is asked for.

Drawn by MuJoCo's renderer as the galleries are (needs an OpenGL that renders off screen: MUJOCO_GL=egl or osmesa).
An image's name holds the mesh's and the texture's content and the version of the drawing, so a changed recipe never
shows an old image.
"""

import hashlib
import pathlib
from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image, UnidentifiedImageError

from urbanverse_mjx import versions
from urbanverse_mjx.datatypes import AssetMesh, AssetRecord
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.settings import cache_dir

from ..records.index import build_mesh

SIZE = (160, 160)  # pixels, width and height


def folder() -> pathlib.Path:
    """Where thumbnails lie."""
    return cache_dir("assets", "thumbnails")


def thumbnail(record: AssetRecord) -> np.ndarray:
    """(160, 160, 3) uint8 image of a record, from the cache or drawn into it."""
    mesh = build_mesh(record)
    path = path_of(record, mesh)
    if not path.is_file():
        draw(mesh, path)
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def path_of(record: AssetRecord, mesh: AssetMesh) -> pathlib.Path:
    """The file of a record's image."""
    digest = hashlib.sha256(np.round(mesh.vertices, 3).tobytes() + mesh.faces.tobytes() + mesh.texture.tobytes())
    # The mesh exists, so only the version of the drawing counts, not those of the mesh code.
    digest.update(str(versions.CODE["thumbnails"].version).encode())
    return folder() / f"{record.uid.replace('/', '--')}-{digest.hexdigest()[:12]}.png"


def draw(mesh: AssetMesh, path: pathlib.Path) -> pathlib.Path:
    """Renders one mesh into a file, which appears whole or not at all."""
    from .gallery import render_row

    image = Image.fromarray(render_row([mesh], SIZE))
    return write_atomically(path, lambda p: image.save(p, "PNG", optimize=True))


def draw_missing(
    records: Sequence[AssetRecord], progress: Callable[[int, int], object] = lambda done, total: None
) -> tuple[int, int]:
    """Draws the records that have no image yet; after an interruption a new call continues.

    Returns:
      (images drawn, images that were there).
    """
    drawn = 0
    for k, record in enumerate(records, 1):
        mesh = build_mesh(record)
        path = path_of(record, mesh)
        if not path.is_file():
            draw(mesh, path)
            drawn += 1
        progress(k, len(records))
    return drawn, len(records) - drawn


def damaged() -> list[pathlib.Path]:
    """The files in the cache that are no whole image."""
    broken = []
    for path in sorted(folder().glob("*.png")) if folder().is_dir() else []:
        try:
            with Image.open(path) as image:
                image.load()
        except (OSError, UnidentifiedImageError):
            broken.append(path)
    return broken
