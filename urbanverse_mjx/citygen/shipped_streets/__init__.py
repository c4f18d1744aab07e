"""The six shipped streets, one module each: a cross-section, manual placements and seeded clutter."""

from collections.abc import Callable

from ..composer import StreetComposer
from . import commercial_bike_lane, commercial_cafes, construction_narrow, park_edge, residential_bins, tourist_scooters

#: Scene id to builder, in the order of the scene banks.
BUILDERS: dict[str, Callable[[], StreetComposer]] = {
    "residential_bins": residential_bins.build,
    "commercial_cafes": commercial_cafes.build,
    "construction_narrow": construction_narrow.build,
    "tourist_scooters": tourist_scooters.build,
    "commercial_bike_lane": commercial_bike_lane.build,
    "park_edge": park_edge.build,
}

#: Streets of each split; only those of `train` are used in training, the others in evaluation only.
SPLITS: dict[str, list[str]] = {
    "train": ["residential_bins", "commercial_cafes", "construction_narrow", "tourist_scooters"],
    "test": ["commercial_bike_lane", "park_edge"],
}
