"""`CityProfile`: parameters of a city's streets, one row of a reviewed table."""

import dataclasses
from typing import Literal

from ...datatypes import validation as v

#: (name, share): relative frequencies. A name may end in "#2", which selects the third base shape of a leaf.
Mix = tuple[tuple[str, float], ...]
Side = Literal["left", "right"]


def mix(text: str) -> Mix:
    """Parses "cafe#1 3, bar 2" as (("cafe#1", 3.0), ("bar", 2.0)); a name without a number has share 1.

    Raises:
      ValidationError: an empty entry, or a share that is not above 0.
    """
    found = []
    for entry in text.split(","):
        words = entry.split()
        if not words:
            raise v.fail("mix", repr(text), "names with shares, parted by commas", "remove the empty entry")
        share = float(words[-1]) if words[-1].replace(".", "", 1).isdigit() and len(words) > 1 else None
        name = " ".join(words if share is None else words[:-1])
        found.append((name, v.number(1.0 if share is None else share, f"mix {name!r}", above=0.0)))
    return tuple(found)


@dataclasses.dataclass(frozen=True, kw_only=True)
class CityProfile:
    """A street of a city.

    Lengths are m, densities objects per 100 m of one pavement (of the whole road for traffic).

    Attributes:
      continent, country, city, travel: parts of the scene's id; `travel` says whether the trajectory walks or drives.
      drives: side of the road for traffic.
      road: width between the kerbs.
      left, right: widths of the pavements; below 1 m they are not walked on.
      kerb: height. verge: width of the green strip between kerb and pavement. yard: depth of the front gardens.
      bends: turns (degrees) of the street at equal distances, positive to the left.
      side_streets: their number per side. crosswalks: their number, spread evenly.
      lane: width kept free for walking, except at `blocked` places per pavement.
      houses: leaves of the fronts.
      height, frontage: their range.
      gaps: share of fronts with a gap (fence) after it.
      parked_left, parked_right: share of the kerb taken by parked vehicles.
      parked: which.
      on_pavement: vehicles parked on the pavement.
      traffic: moving vehicles.
      moving: their number.
      kerbside, wallside: objects along the kerb and along the houses.
      furniture, clutter: their numbers.
      people: which.
      crowd: their number.
      groups: cafes, stalls, works ... (`groups.GROUPS`), with the number of each on the whole street.
      hung: objects on the fronts.
      hangings: their number.
      trees: growths (`stock.GROWTHS`).
      spacing: between them; 0 for none.
      asphalt, paving, open_ground: materials of road, pavement, and verges and yards.
      skies: names of skies.
      reason: the reason for these values.
    """

    continent: str
    country: str
    city: str
    travel: Literal["walk", "drive"] = "walk"
    drives: Side = "right"
    road: float
    left: float
    right: float
    kerb: float = 0.15
    verge: float = 0.0
    yard: float = 0.0
    bends: tuple[float, ...] = ()
    side_streets: int = 2
    crosswalks: int = 3
    lane: float = 1.5
    blocked: int = 0
    houses: Mix
    height: tuple[float, float]
    frontage: tuple[float, float] = (6.0, 14.0)
    gaps: float = 0.0
    parked_left: float = 0.5
    parked_right: float = 0.5
    parked: Mix
    on_pavement: float = 0.0
    traffic: Mix
    moving: float = 3.0
    kerbside: Mix
    furniture: float = 16.0
    wallside: Mix
    clutter: float = 14.0
    people: Mix
    crowd: float = 8.0
    groups: Mix = ()
    hung: Mix = ()
    hangings: float = 0.0
    trees: Mix = ()
    spacing: float = 0.0
    asphalt: Mix
    paving: Mix
    open_ground: str = "grass"
    skies: Mix
    reason: str

    def __post_init__(self) -> None:
        where = f"profile of {self.city}"
        v.choice(self.travel, f"{where}: travel", ("walk", "drive"))
        v.choice(self.drives, f"{where}: drives", ("left", "right"))
        for name, low, high in (("road", 3.0, 30.0), ("left", 0.4, 12.0), ("right", 0.4, 12.0), ("lane", 1.1, 4.0)):
            v.number(getattr(self, name), f"{where}: {name}", low, high)
        v.number(self.kerb, f"{where}: kerb", 0.06, 0.25)
        v.number(max(self.left, self.right), f"{where}: the wider pavement", self.lane, 12.0)
        v.text(self.reason, f"{where}: reason")
        if any(abs(b) > 14.0 for b in self.bends):
            raise v.fail(
                f"{where}: bends", v.show(self.bends), "at most 14 degrees each", "spread them over more bends"
            )

    @property
    def name(self) -> str:
        """Returns Continent_Country_City_travel without blanks and accents, the authors' naming scheme."""
        return "_".join((*(_plain(x) for x in (self.continent, self.country, self.city)), self.travel))


def _plain(text: str) -> str:
    table = str.maketrans({"ã": "a", "á": "a", "é": "e", "í": "i", "ó": "o", "ü": "u", " ": "", "-": ""})
    return text.translate(table)
