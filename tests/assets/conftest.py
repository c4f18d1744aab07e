"""Fixtures shared by several modules of this folder."""

import pyarrow as pa
import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.catalogue import build_catalogue
from urbanverse_mjx.assets.selection.search import ObjectLibrary


@pytest.fixture(scope="session")
def catalogue() -> pa.Table:
    """All 102,444 records."""
    return build_catalogue(load_index())


@pytest.fixture(scope="session")
def objects(catalogue: pa.Table) -> ObjectLibrary:
    """The search over them."""
    return ObjectLibrary(catalogue)
