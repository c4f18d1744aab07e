"""From what a street holds to what stands where: assets, materials, a sky, and no two things in one place."""

from .cousins import Cousin, index_of, materialise_cousins
from .materialise import Materialisation, materialise
from .shortlists import LeftOut

__all__ = ["Cousin", "LeftOut", "Materialisation", "index_of", "materialise", "materialise_cousins"]
