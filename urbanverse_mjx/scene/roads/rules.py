"""`RoadRules`: how the roads of a country are marked; rows of `rules.toml`."""

import dataclasses
from typing import Any

from ...datatypes import validation as v
from ...datatypes.toml_table import table
from ...datatypes.traffic_side import keeps_left

CENTRE_STYLES = ("dashed", "solid", "double")
EDGES = ("none", "white", "yellow", "double yellow")
ZEBRAS = ("bars", "ladder")
APPROACHES = ("none", "diamond", "teeth", "zigzag")
BAYS = ("none", "box", "tee")
KERBS = ("concrete", "granite", "basalt", "yellow", "white", "black white", "black yellow", "red white")
GUTTERS = ("none", "concrete", "setts")


@dataclasses.dataclass(frozen=True, kw_only=True)
class RoadRules:
    """How the roads of a country or city are marked. Lengths in m.

    Attributes:
      traffic: side of the road on which vehicles drive, "left" or "right".
      centre: colour of the line between opposite directions. centre_style: one of `CENTRE_STYLES`.
      dash, gap: lengths of broken lines.
      edge: lines along the kerb where nobody parks, one of `EDGES`.
      zebra: colour of the bars of a crosswalk. between: colour of what lies between them, "" for the road itself.
      bar, bar_gap: widths of the bars and between them. zebra_style: one of `ZEBRAS`.
      stop: width of stop lines, 0 for none.
      approach: what is painted before a crosswalk, one of `APPROACHES`.
      bay: marks of parking bays, one of `BAYS`. bay_colour: their colour.
      kerb: material or paint of kerb stones, one of `KERBS`.
      gutter: one of `GUTTERS`.
      tactile: colour of the paving for the blind at crosswalks, "" for none.
      tram: whether rails lie in the road. tram_bed: whether in a bed of concrete.
      wear: share of the paint that is gone, in [0, 1].
      patches: number of repaired places per 100 m.
    """

    traffic: str = "right"
    centre: str = "white"
    centre_style: str = "dashed"
    dash: float = 3.0
    gap: float = 4.5
    edge: str = "none"
    zebra: str = "white"
    between: str = ""
    bar: float = 0.5
    bar_gap: float = 0.5
    zebra_style: str = "bars"
    stop: float = 0.4
    approach: str = "none"
    bay: str = "box"
    bay_colour: str = "white"
    kerb: str = "concrete"
    gutter: str = "concrete"
    tactile: str = ""
    tram: bool = False
    tram_bed: bool = False
    wear: float = 0.3
    patches: float = 4.0

    def __post_init__(self) -> None:
        choices = {
            "traffic": ("left", "right"), "centre_style": CENTRE_STYLES, "edge": EDGES, "zebra_style": ZEBRAS,
            "approach": APPROACHES, "bay": BAYS, "kerb": KERBS, "gutter": GUTTERS,
        }  # fmt: skip
        for name, allowed in choices.items():
            v.choice(getattr(self, name), f"road rules: {name}", allowed)


_TABLE: dict[str, Any] = table(__file__)


def rules_of(city: str, country: str) -> RoadRules:
    """The rules of a country with the exceptions of a city; those that most countries share for an unknown one."""
    side = {"traffic": "left" if keeps_left(country) else "right"}
    return RoadRules(**{**side, **_TABLE["countries"].get(country, {}), **_TABLE["cities"].get(city, {})})
