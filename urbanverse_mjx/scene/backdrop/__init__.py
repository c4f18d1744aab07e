"""What is drawn around a street of a known city: windows at the ends of rows, ground behind them, fronts beyond.

In:   the ground and the houses of a layout that names its city and country.
Out:  visual meshes beside those of the ground; they have no hull and change no map.
"""

from .ends import openings
from .houses import LEAST_WIDTH, House, house
from .surroundings import surround

__all__ = ["LEAST_WIDTH", "House", "house", "openings", "surround"]
