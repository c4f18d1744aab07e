"""Converts a scene graph to layouts: chooses assets, materials and a sky, and resolves overlaps of objects."""

from .cousins import Cousin, check_labels, index_of, materialise_cousin, materialise_cousins
from .plausible import check_extent, check_placed, check_plausible, implausible_objects
from .regional import check_city, localise
from .shortlists import BUILT_IN, Embeddings, LeftOut

__all__ = [
    "BUILT_IN",
    "Cousin",
    "Embeddings",
    "LeftOut",
    "check_city",
    "check_extent",
    "check_labels",
    "check_placed",
    "check_plausible",
    "implausible_objects",
    "index_of",
    "localise",
    "materialise_cousin",
    "materialise_cousins",
]
