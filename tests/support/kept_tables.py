"""What takes seconds to make from the package's assets, kept for later runs until any of its sources changes."""

import fcntl
import functools
import hashlib
import json
import pathlib
import sys
from collections.abc import Callable

import numpy as np
import pyarrow as pa

import urbanverse_mjx
from tests.support.kept_programs import remove_least_recent
from urbanverse_mjx import settings
from urbanverse_mjx.assets import build_mesh, load_index
from urbanverse_mjx.assets.collision.hulls import hull_key
from urbanverse_mjx.assets.records.regional import load_regional
from urbanverse_mjx.datatypes import AssetRecord
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.process_pool import worker_pool

#: Bytes of tables that are kept for later runs.
KEPT = 2**28


#: Packages that `assets` may import, by the contract of import-linter, beside the modules next to them.
BELOW = ("assets", "datatypes", "geometry")


@functools.cache
def sources_key() -> str:
    """Of all that tables come from: every module that assets depend on, the index, Python and NumPy."""
    digest = hashlib.sha256(f"{sys.version} {np.__version__} {pa.__version__}".encode())
    package = pathlib.Path(urbanverse_mjx.__file__).parent
    modules = [*package.glob("*.py"), *(path for name in BELOW for path in (package / name).rglob("*.py"))]
    for path in sorted([*modules, *(p for p in settings.asset_root().rglob("*") if p.is_file())]):
        digest.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def kept(name: str, make: Callable[[pathlib.Path], object]) -> pathlib.Path:
    """A file that the first process that asks writes with `make`; others wait for it.

    Args:
      name: of a folder for such files.
    """
    path = settings.cache_dir("tests", name) / f"{sources_key()}-cache"
    path.parent.mkdir(parents=True, exist_ok=True)
    with (path.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.is_file():
            write_atomically(path, make)
            remove_least_recent(path.parent, KEPT)
    return path


def base_key(record: AssetRecord) -> str:
    """The key of a base shape, which has the extent of its record."""
    build_mesh(record)
    return hull_key(record)


@functools.cache
def hull_keys() -> dict[str, str]:
    """uid -> key in the stores of hulls, of every base shape and of every regional one.

    Where no mesh is in the cache yet, making 2,500 of them takes minutes of a processor.
    """

    def make(path: pathlib.Path) -> None:
        base, regional = load_index().records, load_regional().records
        with worker_pool(settings.num_threads()) as pool:
            found = [*pool.map(base_key, base, chunksize=16), *pool.map(hull_key, regional, chunksize=16)]
        keys = {record.uid: key for record, key in zip((*base, *regional), found, strict=True)}
        path.write_text(json.dumps(keys), encoding="utf-8")

    return json.loads(kept("hull_keys", make).read_text(encoding="utf-8"))
