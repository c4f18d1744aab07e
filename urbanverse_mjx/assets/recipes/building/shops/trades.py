"""Shop windows of each trade: goods, names and colours of three variants."""

import dataclasses

from urbanverse_mjx.datatypes.toml_table import table

from ....meshes.palette import Color

Names = tuple[str, str, str]
Paint = tuple[Color, Color]


@dataclasses.dataclass(frozen=True)
class Trade:
    """A kind of shop.

    Attributes:
      goods: pictograms in the window, the first one also on the sign.
      names, paints: of the three variants; a paint is the sign's ground and its ink.
      fronts: layouts of the ground floor: "side", "middle", "wide", "counter", "closed" or "folding".
      outside: what stands on the pavement, if anything.
      lit: whether the window is warm or cold inside.
      single: whether it is always one storey.
    """

    goods: tuple[str, ...]
    names: Names
    paints: tuple[Paint, Paint, Paint]
    fronts: Names = ("side", "middle", "wide")
    outside: str | None = None
    lit: bool = True
    single: bool = False


TRADES = {leaf: Trade(**row) for leaf, row in table(__file__).items()}
