"""Fixtures shared by several modules of this folder."""

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.support.kept_tables import kept
from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.catalogue import build_catalogue
from urbanverse_mjx.assets.selection.search import ObjectLibrary


@pytest.fixture(scope="session")
def catalogue() -> pa.Table:
    """All 102,444 records, made by the first process that asks (10 s) after any of their sources has changed."""
    return pq.read_table(kept("catalogues", lambda path: pq.write_table(build_catalogue(load_index()), path)))


@pytest.fixture(scope="session")
def objects(catalogue: pa.Table) -> ObjectLibrary:
    """The search over them."""
    return ObjectLibrary(catalogue)
