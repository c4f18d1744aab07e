"""City blocks: reviewed profiles of cities, and the generator that makes a street from a profile."""

from ...datatypes import validation as v
from .block import block
from .profile import CityProfile
from .tables import FOLDER, read_profiles

_LIBRARY = ("africa", "asia", "europe", "middle_east", "north_america", "oceania", "south_america")

#: The paper's 32 cities (appendix on the scene library), one layout each, and ten other cities for AutoBench.
PROFILES: dict[str, tuple[CityProfile, ...]] = {
    "urbanverse160": tuple(p for continent in _LIBRARY for p in read_profiles(FOLDER / f"{continent}.toml")),
    "autobench": read_profiles(FOLDER / "autobench.toml"),
}


def layouts(name: str) -> dict[str, CityProfile]:
    """Returns layout id (Continent_Country_City_walk_01) to profile for a set.

    Raises:
      ValidationError: no set of blocks has this name.
    """
    v.choice(name, "set of blocks", PROFILES)
    return {f"{profile.name}_01": profile for profile in PROFILES[name]}


#: Seed of the blocks of each set.
SEEDS = {"urbanverse160": 160, "autobench": 10}

__all__ = ["PROFILES", "SEEDS", "CityProfile", "block", "layouts"]
