"""Metric street assets: ontology, index, parametric recipes, collision hulls, export."""

from .hulls import load_hulls
from .index import AssetIndex, build_mesh, load_index
from .ontology import UnknownLabelError, category_of, match_label, nearest_leaves

__all__ = [
    "AssetIndex",
    "UnknownLabelError",
    "build_mesh",
    "category_of",
    "load_hulls",
    "load_index",
    "match_label",
    "nearest_leaves",
]
