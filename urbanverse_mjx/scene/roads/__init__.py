"""What is drawn on the ground of a street of a known country: markings, kerb stones, gutters, covers, patches, rails.

In:   the ground and the parked vehicles of a layout that names its city and country.
Out:  visual meshes beside those of the ground; they have no hull and change no map.
"""

from .drawing import LEAST_ROUGHNESS, Drawn, crosswalk_materials, draw_roads
from .markings import Parked
from .rules import RoadRules, rules_of

__all__ = ["LEAST_ROUGHNESS", "Drawn", "Parked", "RoadRules", "crosswalk_materials", "draw_roads", "rules_of"]
