"""Thumbnails in the cache: of every base shape by `make thumbnails`, of instances on demand.

MuJoCo's renderer draws them like the galleries (needs off-screen OpenGL: MUJOCO_GL=egl or osmesa). An image's name is a
hash of the mesh, the texture and the version of the drawing code, so a changed recipe never shows an old image.
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
    """Folder of the thumbnails."""
    return cache_dir("assets", "thumbnails")


def thumbnail(record: AssetRecord) -> np.ndarray:
    """(160, 160, 3) uint8 image of a record, read from the cache, or drawn and stored in it."""
    mesh = build_mesh(record)
    path = path_of(record, mesh)
    if not path.is_file():
        draw(mesh, path)
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def path_of(record: AssetRecord, mesh: AssetMesh) -> pathlib.Path:
    """The file of a record's image."""
    digest = hashlib.sha256(np.round(mesh.vertices, 3).tobytes() + mesh.faces.tobytes() + mesh.texture.tobytes())
    # The mesh is given, so only the version of the drawing code matters, not that of the mesh code.
    digest.update(str(versions.CODE["thumbnails"].version).encode())
    return folder() / f"{record.uid.replace('/', '--')}-{digest.hexdigest()[:12]}.png"


def draw(mesh: AssetMesh, path: pathlib.Path) -> pathlib.Path:
    """Renders one mesh to a file atomically."""
    from .gallery import render_row

    image = Image.fromarray(render_row([mesh], SIZE))
    return write_atomically(path, lambda p: image.save(p, "PNG", optimize=True))


def draw_missing(
    records: Sequence[AssetRecord], progress: Callable[[int, int], object] = lambda done, total: None
) -> tuple[int, int]:
    """Draws the records that have no image yet; can be interrupted and continued.

    Returns:
      (number of drawn images, number of existing images).
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
    """The damaged image files in the cache."""
    broken = []
    for path in sorted(folder().glob("*.png")) if folder().is_dir() else []:
        try:
            with Image.open(path) as image:
                image.load()
        except (OSError, UnidentifiedImageError):
            broken.append(path)
    return broken
