"""From what a street holds to what stands where: assets, materials, a sky, and no two objects in one place."""

from .cousins import Cousin, check_labels, index_of, materialise_cousin, materialise_cousins
from .shortlists import LeftOut

__all__ = ["Cousin", "LeftOut", "check_labels", "index_of", "materialise_cousin", "materialise_cousins"]
