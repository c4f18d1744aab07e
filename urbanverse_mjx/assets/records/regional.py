"""Records of regional buildings, which stand beside the catalogue: it, its count and its searches do not know them.

`python -m urbanverse_mjx.assets regional` writes `assets_index/regional.parquet` and their hulls.
"""

import functools
import pathlib
from collections.abc import Sequence

from urbanverse_mjx.datatypes import AssetRecord
from urbanverse_mjx.settings import asset_root

from .index import AssetIndex, load_index

FILE = "regional.parquet"
#: Part of the uids of these records.
MARK = "/regional-"
#: Countries whose houses and signs the catalogue has already: brick terraces and English shops.
OF_CATALOGUE = ("United Kingdom", "Ireland")


def index_path() -> pathlib.Path:
    return asset_root() / FILE


def load_regional() -> AssetIndex:
    """The index of regional buildings.

    Raises:
      ValidationError: the file does not exist or is damaged.
    """
    return load_index(index_path())


@functools.cache
def regional_hash() -> str:
    """Hash of 64 hexadecimal digits over all records."""
    return load_regional().content_hash()


@functools.cache
def of_tradition(name: str) -> tuple[AssetRecord, ...]:
    """The records of a tradition, by uid."""
    return tuple(r for r in load_regional().records if r.params["tradition"] == name)


def tradition_of(city: str, country: str) -> str | None:
    """Name of the tradition that serves a city, or else its country; None without one."""
    from ..recipes.building.regional.styles import traditions

    for place in (city, country):
        for name, tradition in traditions().items():
            if place in tradition.places:
                return name
    return None


def is_served(city: str, country: str) -> bool:
    """Whether a city or country has the regional look: a tradition serves it, or the catalogue's houses are its own."""
    return country in OF_CATALOGUE or tradition_of(city, country) is not None


def places() -> list[str]:
    """The cities and countries that have the regional look."""
    from ..recipes.building.regional.styles import traditions

    return sorted((*OF_CATALOGUE, *(place for tradition in traditions().values() for place in tradition.places)))


def records_of(uids: Sequence[str]) -> list[AssetRecord]:
    """The records of uids of regional buildings, in their order.

    Raises:
      ValidationError: no such uid.
    """
    index = load_regional()
    return [index.get(uid) for uid in uids]
