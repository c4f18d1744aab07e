"""From a scene graph to a layout: assets, materials, a sky, and no overlap of objects."""

from .cousins import Cousin, check_labels, index_of, materialise_cousin, materialise_cousins
from .shortlists import LeftOut

__all__ = ["Cousin", "LeftOut", "check_labels", "index_of", "materialise_cousin", "materialise_cousins"]
