"""The six streets, one module each: a section, authored placements and seeded clutter."""

from collections.abc import Callable

from ..composer import StreetComposer
from . import commercial_bike_lane, commercial_cafes, construction_narrow, park_edge, residential_bins, tourist_scooters

#: Scene id to its builder, in the order of the banks.
BUILDERS: dict[str, Callable[[], StreetComposer]] = {
    "residential_bins": residential_bins.build,
    "commercial_cafes": commercial_cafes.build,
    "construction_narrow": construction_narrow.build,
    "tourist_scooters": tourist_scooters.build,
    "commercial_bike_lane": commercial_bike_lane.build,
    "park_edge": park_edge.build,
}

#: Which streets may be trained on; the others are only ever evaluated on.
SPLITS: dict[str, list[str]] = {
    "train": ["residential_bins", "commercial_cafes", "construction_narrow", "tourist_scooters"],
    "test": ["commercial_bike_lane", "park_edge"],
}
