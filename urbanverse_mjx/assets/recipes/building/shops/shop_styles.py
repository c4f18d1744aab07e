"""The appearance of every shop: names, colours, goods, floors."""

import dataclasses

from urbanverse_mjx.datatypes.toml_table import table

from ....meshes.palette import Color


@dataclasses.dataclass(frozen=True)
class Shop:
    """One variant of a shop.

    Attributes:
      name: on the sign.
      back, ink: the sign's colours.
      wall: kind and colour of the upper floors' wall.
      trim: of sills and cornices.
      base: of the shop front.
      floors: above the shop.
      width: m.
      goods: in the window.
      window: style.
      awning: its one or two colours, or none.
      roof: "flat", "mansard", "gable".
      blade: words of a projecting sign.
    """

    name: str
    back: Color
    ink: Color
    wall: tuple[str, Color]
    base: Color
    goods: str
    floors: int = 2
    width: float = 8.0
    trim: Color = "off white"
    window: str = "casement"
    awning: tuple[Color, ...] = ()
    roof: str = "flat"
    blade: str | None = None
    outside: str | None = None


SHOPS = {leaf: tuple(Shop(**row) for row in rows) for leaf, rows in table(__file__).items()}
