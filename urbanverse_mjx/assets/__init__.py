"""Metric street assets: ontology, index, parametric recipes, collision hulls, export."""

from .hulls import load_hulls
from .index import AssetIndex, build_mesh, full_index, imported_index, load_index
from .ontology import UnknownLabelError, category_of, match_label, nearest_leaves

__all__ = [
    "AssetIndex",
    "UnknownLabelError",
    "build_mesh",
    "category_of",
    "full_index",
    "imported_index",
    "load_hulls",
    "load_index",
    "match_label",
    "nearest_leaves",
]
