"""A catalogue of a few leaves, so that matching is tested on real records without making all of them."""

import functools

import pyarrow as pa

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.records.catalogue import build_leaf
from urbanverse_mjx.assets.selection.search import ObjectLibrary

LEAVES = ("bench", "sedan", "bollard", "pedestrian adult", "tree", "bakery", "directional sign")


@functools.cache
def few_objects() -> ObjectLibrary:
    """Sixty records of each leaf."""
    return ObjectLibrary(pa.concat_tables([build_leaf(leaf, load_index(), 60) for leaf in LEAVES]))
