"""Reads the user's own assets: meshes from files, stored in the cache with an index of their own.

A record whose recipe is `file` names its mesh by `params["path"]`, a GLB below the store's folder, and by the SHA-256
of that file; its hulls are next to the GLB. `assets.importing` writes the store; this module only reads it.
"""

import functools
import hashlib
import pathlib

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, ValidationError
from urbanverse_mjx.settings import imported_assets

from ..meshes.glb import read_glb

#: Recipe name of records whose mesh is a file.
FILE_RECIPE = "file"
INDEX, HULLS, CATALOGUE = "index.parquet", "hulls.npz", "catalogue.parquet"
AGAIN = "import its source again with `urbanverse assets import`"


def mesh_file(record: AssetRecord) -> pathlib.Path:
    """The GLB of a record whose recipe is `file`.

    Raises:
      ValidationError: the record has no path, or one outside the store.
    """
    root = imported_assets()
    name = record.params.get("path")
    path = (root / name).resolve() if isinstance(name, str) and name else root
    if path == root or not path.is_relative_to(root.resolve()):
        raise ValidationError(f"asset {record.uid!r}: found the mesh path {name!r}, needed a file inside {root}.")
    return path


def file_mesh(record: AssetRecord) -> AssetMesh:
    """The mesh of a record whose recipe is `file`.

    Raises:
      ValidationError: the file is missing, differs from the imported one, or its box differs from the record's.
    """
    return _read(mesh_file(record), str(record.params.get("sha256")), record.extent_xyz, record.uid)


@functools.lru_cache(maxsize=256)
def _read(path: pathlib.Path, sha256: str, extent: tuple[float, ...], uid: str) -> AssetMesh:
    if not path.is_file():
        raise ValidationError(f"asset {uid!r}: found no file {path}, needed its mesh; {AGAIN}.")
    body = path.read_bytes()
    if hashlib.sha256(body).hexdigest() != sha256:
        raise ValidationError(f"asset {uid!r}: found {path.name} changed, needed it as it was imported; {AGAIN}.")
    mesh = read_glb(body)
    if np.abs(mesh.extent - np.asarray(extent)).max() > 1e-3:
        raise ValidationError(
            f"asset {uid!r}: found a mesh of {np.round(mesh.extent, 3)} m, needed {list(extent)} m as indexed; {AGAIN}."
        )
    return mesh
