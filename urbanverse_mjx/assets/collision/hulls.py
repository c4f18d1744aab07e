"""Stores and loads collision hulls by the content of the mesh; loading never runs CoACD.

The store is one compressed file, `assets_index/hulls/hulls.npz`: the corners of all hulls in millimetres (int32), hull
after hull, and for every mesh key the range of its hulls. `assets.collision.decompose` makes missing ones.
`close.npz` beside it holds, by the same keys, hulls that stand out less of some of the meshes, where a robot can touch
them; frozen sets have the first ones, so these are read only on request (`SceneLayout.hulls`). Some sets are frozen
with them too, so further meshes get theirs in `close-2.npz`, the second revision, which is asked before the first.
"""

import dataclasses
import functools
import hashlib
import os
import pathlib
from collections.abc import Callable, Mapping

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, HullSet, ValidationError, array_file
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.settings import asset_root

from ..meshes import instances, laying
from ..meshes.recipe import get_recipe
from ..records.index import base_mesh
from ..records.user_store import AGAIN, FILE_RECIPE, HULLS, mesh_file

BUILD_COMMAND = "python -m urbanverse_mjx.assets hulls"
MILLIMETRE = 1e-3
# Shift of the rounding bins. Manually chosen sizes (multiples of 0.5 mm) then never lie on a bin's edge, where
# differences between machines in the last bit would change the key.
_BIN_SHIFT = 0.317


def mesh_key(mesh: AssetMesh, budget: int) -> str:
    """Hash of 32 hexadecimal digits over the vertices (1 mm bins), the faces and the hull budget."""
    bins = np.floor(mesh.vertices.astype(np.float64) / MILLIMETRE + _BIN_SHIFT).astype(np.int32)
    digest = hashlib.sha256(f"{budget}/{len(bins)}/{len(mesh.faces)}/".encode())
    digest.update(bins.astype("<i4").tobytes())
    digest.update(mesh.faces.astype("<i4").tobytes())
    return digest.hexdigest()[:32]


@dataclasses.dataclass(frozen=True)
class HullStore:
    """Hulls by mesh key; every hull an (n, 3) int32 array of whole millimetres."""

    hulls: Mapping[str, tuple[np.ndarray, ...]]

    def save(self, path: str | os.PathLike[str]) -> pathlib.Path:
        """Writes the store with sorted keys, so that equal stores have equal arrays."""
        keys = sorted(self.hulls)
        flat = [h for k in keys for h in self.hulls[k]]
        arrays = {
            "keys": np.array([list(bytes.fromhex(k)) for k in keys], np.uint8).reshape(-1, 16),
            "hulls_per_key": np.array([len(self.hulls[k]) for k in keys], np.uint8),
            "corners_per_hull": np.array([len(h) for h in flat], np.uint8),
            "corners_mm": np.concatenate(flat).astype(np.int32) if flat else np.zeros((0, 3), np.int32),
        }
        return array_file.save(path, arrays)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> "HullStore":
        """Reads the store; a missing file is an empty store.

        Raises:
          ValidationError: the file is damaged, or its counts and corners are inconsistent.
        """
        if not pathlib.Path(path).is_file():
            return HullStore({})
        data = array_file.load(path, "collision hulls", "copy it again from where it is whole")
        _check_store(str(path), data)
        ends = np.cumsum(data["corners_per_hull"].astype(int))
        hulls = np.split(data["corners_mm"], ends[:-1]) if len(ends) else []
        stops = np.cumsum(data["hulls_per_key"].astype(int))
        keys = [row.tobytes().hex() for row in data["keys"]]
        return HullStore(
            {k: tuple(hulls[b - n : b]) for k, b, n in zip(keys, stops, np.diff(stops, prepend=0), strict=True)}
        )


def _check_store(path: str, data: Mapping[str, np.ndarray]) -> None:
    """Checks that a file has the arrays of a store and that its counts match the numbers of hulls and corners."""
    hint = f"build it again with `{BUILD_COMMAND}`"
    names = {"keys", "hulls_per_key", "corners_per_hull", "corners_mm"}
    if set(data) != names:
        raise v.fail(path, f"other arrays than expected ({', '.join(sorted(names ^ set(data)))})", "hulls", hint)
    keys, per_key, per_hull, corners = (
        data[name] for name in ("keys", "hulls_per_key", "corners_per_hull", "corners_mm")
    )
    fits = keys.shape == (len(per_key), 16) and corners.shape == (int(per_hull.sum()), 3)
    if not fits or int(per_key.sum()) != len(per_hull):
        raise v.fail(path, "counts that are not those of its hulls and corners", "counts that add up", hint)


def store_path() -> pathlib.Path:
    return asset_root() / "hulls" / "hulls.npz"


def regional_store_path() -> pathlib.Path:
    """The hulls of regional buildings."""
    return asset_root() / "hulls" / "regional.npz"


#: Kind of hulls (`SceneLayout.hulls`) -> revisions of the closer hulls that it takes, the newest first.
REVISIONS = {"close": ("close",), "close-2": ("close-2", "close")}


def close_store_path(revision: str = "close") -> pathlib.Path:
    """The closer hulls of catalogue and regional buildings that a revision adds to the earlier ones."""
    return asset_root() / "hulls" / f"{revision}.npz"


@functools.cache
def _store() -> HullStore:
    return HullStore({**HullStore.load(regional_store_path()).hulls, **HullStore.load(store_path()).hulls})


@functools.cache
def close_store(kind: str) -> HullStore:
    """The closer hulls of a kind, of the newest revision that has some; meshes that have none are not in it."""
    found: dict[str, tuple[np.ndarray, ...]] = {}
    for revision in reversed(REVISIONS[kind]):
        found |= {key: hulls for key, hulls in HullStore.load(close_store_path(revision)).hulls.items() if hulls}
    return HullStore(found)


@functools.cache
def close_hash(kind: str) -> str:
    """Hash of 64 hexadecimal digits over the stores of a kind of closer hulls."""
    digest = hashlib.sha256()
    for path in map(close_store_path, REVISIONS[kind]):
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def hull_budget(mesh: AssetMesh, cap: int | None) -> int:
    """Largest number of hulls for a mesh: the recipe's limit, otherwise by the mesh's largest side.

    Small objects get few hulls, because the simulator streams only the 16 hulls nearest to a robot.
    """
    if cap is not None:
        return cap
    largest = float(mesh.extent.max())
    return 3 if largest < 1.1 else 6 if largest < 2.2 else 12


def load_hulls(record: AssetRecord, kind: str = "") -> HullSet:
    """The convex hulls of a record in the asset frame at scale 1 (for an instance, the scaled hulls of its base shape;
    for a lying asset, turned). Never runs CoACD.

    Args:
      kind: `SceneLayout.hulls`; "" for the first hulls, else closer ones where a store of this kind has some.

    Raises:
      ValidationError: the store (for an imported asset, the user's) has no hulls for this mesh; the message names the
        command that makes them.
    """
    if record.recipe == FILE_RECIPE:
        return _file_hulls(record)
    key = hull_key(record)
    laid = record.params.get(laying.KEY)
    close = kind and laid is None  # lying assets rest on the first hulls
    found = (close_store(kind).hulls.get(key) if close else None) or _store().hulls.get(key)
    if found is None:
        raise ValidationError(
            f"asset {record.uid!r}: found no collision hulls for its mesh ({key}), needed them in {store_path().name}; "
            f"build the missing ones with `{BUILD_COMMAND}`."
        )
    hulls = HullSet(tuple(h.astype(np.float32) * np.float32(MILLIMETRE) for h in found))
    if instances.KEY in record.params:
        hulls = instances.scaled_hulls(hulls, record.params[instances.KEY]["scale"])
    return hulls if laid is None else HullSet(tuple(laying.turned(h, laid).astype(np.float32) for h in hulls.hulls))


def hull_key(record: AssetRecord) -> str:
    """Key of a record's base mesh in the stores."""
    mesh = base_mesh(record)
    return mesh_key(mesh, hull_budget(mesh, get_recipe(record.recipe, record.leaf).hulls))


def hull_loader(kind: str) -> Callable[[AssetRecord], HullSet]:
    """The function that loads the hulls of a layout's records.

    Args:
      kind: `SceneLayout.hulls`.
    """
    return functools.partial(load_hulls, kind=kind) if kind else load_hulls


def _file_hulls(record: AssetRecord) -> HullSet:
    """The convex hulls of a record whose recipe is `file`, made when it was imported.

    Raises:
      ValidationError: the file of hulls is missing or holds none.
    """
    path = mesh_file(record).with_name(HULLS)
    stored = list(HullStore.load(path).hulls.values())
    if len(stored) != 1:
        raise ValidationError(
            f"asset {record.uid!r}: found {len(stored)} sets of hulls in {path}, needed one; {AGAIN}."
        )
    return HullSet(tuple(h.astype(np.float32) * np.float32(MILLIMETRE) for h in stored[0]))
