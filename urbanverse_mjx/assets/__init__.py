"""Metric street assets: ontology, index, parametric recipes, collision hulls, export.

Sub-packages: `categories` (ontology, priors, materials), `meshes` (mesh building), `recipes` (one per asset), `records`
(index and catalogue), `collision` (hulls and inertia), `appearances` (ground materials and skies), `images` (thumbnails
and galleries), `selection` (assets for a label, box or crop), `exporting` (GLB, MJCF and USD), `importing` (the user's
own files).
"""

from .categories.ontology import UnknownLabelError, category_of, match_label, nearest_leaves
from .collision.hulls import hull_loader, load_hulls
from .records.index import AssetIndex, build_mesh, full_index, imported_index, load_index

__all__ = [
    "AssetIndex",
    "UnknownLabelError",
    "build_mesh",
    "category_of",
    "full_index",
    "hull_loader",
    "imported_index",
    "load_hulls",
    "load_index",
    "match_label",
    "nearest_leaves",
]
