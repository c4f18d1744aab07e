"""Fixtures shared by several modules of this folder."""

import fcntl
import hashlib
import pathlib
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import urbanverse_mjx
from tests.support.kept_programs import remove_least_recent
from urbanverse_mjx import settings
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.catalogue import build_catalogue
from urbanverse_mjx.assets.selection.search import ObjectLibrary
from urbanverse_mjx.datatypes.validation import write_atomically

#: Bytes of tables that are kept for later runs.
KEPT = 2**28


def sources_key() -> str:
    """Of all that the table of records comes from: any module of the package, the index, Python and NumPy."""
    digest = hashlib.sha256(f"{sys.version} {np.__version__} {pa.__version__}".encode())
    package = pathlib.Path(urbanverse_mjx.__file__).parent
    for path in sorted([*package.rglob("*.py"), *(p for p in settings.asset_root().rglob("*") if p.is_file())]):
        digest.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


@pytest.fixture(scope="session")
def catalogue() -> pa.Table:
    """All 102,444 records, made by the first process that asks (10 s) after any of their sources has changed."""
    path = settings.cache_dir("tests", "catalogues") / f"{sources_key()}-cache"
    path.parent.mkdir(parents=True, exist_ok=True)
    with (path.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.is_file():
            table = build_catalogue(load_index())
            write_atomically(path, lambda p: pq.write_table(table, p))
            remove_least_recent(path.parent, KEPT)
    return pq.read_table(path)


@pytest.fixture(scope="session")
def objects(catalogue: pa.Table) -> ObjectLibrary:
    """The search over them."""
    return ObjectLibrary(catalogue)
