"""Metric street assets: ontology, index, parametric recipes, collision hulls, export.

What is known of a category stands in `categories`; how a mesh is built in `meshes`, and the recipes in `recipes`; what
the index and the catalogue hold in `records`; hulls and inertia in `collision`; ground materials and skies in
`appearances`; thumbnails and galleries in `images`; which asset fits a label, box or crop in `selection`; GLB, MJCF
and USD in `exporting`, and the user's own files in `importing`.
"""

from .categories.ontology import UnknownLabelError, category_of, match_label, nearest_leaves
from .collision.hulls import load_hulls
from .records.index import AssetIndex, build_mesh, full_index, imported_index, load_index

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
