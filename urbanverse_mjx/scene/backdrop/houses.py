"""Houses of a scene as the background sees them, and the looks of houses that are drawn beside them."""

import dataclasses

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ...assets.recipes.building.regional import boards
from ...assets.recipes.building.regional.buildings import form_of
from ...assets.recipes.building.regional.styles import Form, traditions
from ...assets.records import regional
from ...datatypes import AssetMesh, AssetRecord, PlacedObject

#: m, least width of a house.
LEAST_WIDTH = 3.0
#: Recipes of the catalogue whose side walls are plain.
PLAIN = ("buildings.house", "shops.shop", "trade_shops.trade_shop")
#: Houses of the countries that keep the catalogue's terraces.
TERRACE = Form(
    sizes=((5.5, 2), (6.5, 3), (7.5, 2)),
    ground_height=3.0,
    storey=2.8,
    wall="brick",
    colors=("#9a4a36", "#a8563e", "#7f4034"),
    trim=("cream", "#b4b2ac", "off white"),
    base=("#8f4634", "#9c503c", "#78402f"),
    window="sash",
    window_size=(1.0, 1.4),
    ground="house",
    roof="tiles",
    roof_colors=("#4a4a4e", "#5a4a44"),
)


@dataclasses.dataclass(frozen=True)
class House:
    """A house that stands in a scene.

    Attributes:
      id: of its object.
      position: (3,) m; yaw: rad.
      mesh: visual mesh, scaled, in the asset frame.
      footprint: outline on the ground, scene frame.
      scale: (3,) of its axes.
      look: form whose windows its side walls may have; None for a building whose walls stay as they are.
      dressing: number of its colours.
    """

    id: str
    position: np.ndarray
    yaw: float
    mesh: AssetMesh
    footprint: BaseGeometry
    scale: tuple[float, float, float]
    look: Form | None
    dressing: int


def house(placed: PlacedObject, record: AssetRecord, mesh: AssetMesh, corners: np.ndarray) -> House:
    """A house from its object.

    Args:
      mesh: its visual mesh, scaled.
      corners: (n, 2) m, of its hulls in the scene frame.
    """
    look, dressing = None, 0
    if regional.MARK in record.uid:
        look, dressing = form_of(record.recipe, record.leaf, int(record.params["variant"]))
    elif record.recipe in PLAIN:
        look, dressing = TERRACE, len(record.uid) % 3
    outline = shapely.MultiPoint(corners).convex_hull
    return House(placed.id, np.array(placed.position), placed.yaw, mesh, outline, placed.scale, look, dressing)


def looks_of(place: tuple[str, str]) -> tuple[tuple[Form, ...], str]:
    """The forms of the houses of a place, and the language of their signs."""
    name = regional.tradition_of(*place)
    if name is None:
        return (TERRACE,), ""
    tradition = traditions()[name]
    with boards.in_language(boards.language_of(place)):
        return tradition.forms, boards.shop_language(tradition.language)
