"""Base meshes on the disk, so that no process builds twice what another has built: a recipe takes 80 ms, a file one.

A file's folder names the code that makes meshes: a changed recipe never finds the old shape. The cache may be missing,
full or broken: then the mesh is built. A damaged file is renamed and written anew.
"""

import functools
import hashlib
import pathlib
from collections.abc import Callable

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, array_file
from urbanverse_mjx.settings import cache_dir

_ARRAYS = ("vertices", "faces", "uv", "texture")


def cached_mesh(recipe: str, leaf: str, variant: int, build: Callable[[], AssetMesh]) -> AssetMesh:
    """The base mesh of a recipe's variant: read where it lies in the cache, else built and put there."""
    name = hashlib.sha256(f"{recipe}/{leaf}/{variant}".encode()).hexdigest()[:24]
    path = cache_dir("meshes", _code_digest(), f"{name}.npz")
    found = array_file.load_cached(path, "a mesh", ("surface", *_ARRAYS))
    if found is not None:
        roughness, metallic = found.pop("surface").tolist()
        return AssetMesh(**found, roughness=roughness, metallic=metallic)
    mesh = build()
    arrays = {part: getattr(mesh, part) for part in _ARRAYS}
    array_file.save_cached(path, {"surface": np.array([mesh.roughness, mesh.metallic], np.float64), **arrays})
    return mesh


@functools.cache
def _code_digest() -> str:
    """16 hexadecimal digits over the code of this room and of the mesh, and numpy's version."""
    room = pathlib.Path(__file__).parent
    digest = hashlib.sha256(np.__version__.encode())
    for path in (*sorted(room.rglob("*.py")), room.parent / "datatypes" / "asset.py"):
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]
