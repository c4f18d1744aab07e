"""What every shop looks like: names, colours, goods, floors."""

import dataclasses

from ....meshes.palette import Color


@dataclasses.dataclass(frozen=True)
class Shop:
    """One variant of a shop.

    Attributes:
      name: on the sign; back, ink: the sign's colours.
      wall: kind and colour of the upper floors' wall; trim: of sills and cornices; base: of the shop front.
      floors: above the shop; width: m; goods: in the window; window: style.
      awning: its one or two colours, or none; roof: "flat", "mansard", "gable"; blade: words of a projecting sign.
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
    awning: tuple[Color, Color | None] | None = None
    roof: str = "flat"
    blade: str | None = None
    outside: str | None = None


SHOPS: dict[str, tuple[Shop, Shop, Shop]] = {
    "cafe": (
        Shop(
            "CAFE LUNA",
            "dark green",
            "cream",
            ("plaster", "#d9c7a3"),
            "dark green",
            "tables",
            2,
            7.5,
            awning=("dark green", "cream"),
            outside="tables",
        ),
        Shop(
            "Coffee Corner",
            "#5a3a26",
            "white",
            ("brick", "brick"),
            "#5a3a26",
            "tables",
            3,
            8.5,
            window="sash",
            awning=("#8a2b2b", None),
            outside="plants",
        ),
        Shop(
            "KAFFEE",
            "white",
            "black",
            ("plaster", "#9fb6bd"),
            "white",
            "tables",
            1,
            6.5,
            blade="KAFFEE",
            outside="tables",
        ),
    ),
    "restaurant": (
        Shop(
            "TRATTORIA ROMA",
            "dark red",
            "gold",
            ("plaster", "#c98f5e"),
            "dark red",
            "tables",
            2,
            9.5,
            awning=("red", "white"),
            outside="tables",
        ),
        Shop(
            "Golden Dragon",
            "red",
            "signal yellow",
            ("brick", "#8d5a48"),
            "black",
            "tables",
            3,
            9.0,
            window="sash",
            blade="FOOD",
        ),
        Shop(
            "BISTRO 24",
            "dark blue",
            "white",
            ("ashlar", "sandstone"),
            "dark blue",
            "tables",
            2,
            10.0,
            awning=("dark blue", None),
            roof="mansard",
            outside="plants",
        ),
    ),
    "bakery": (
        Shop(
            "BAKERY",
            "#7a4a26",
            "cream",
            ("plaster", "#e3cfa0"),
            "#7a4a26",
            "breads",
            2,
            7.0,
            awning=("orange", "cream"),
        ),
        Shop(
            "Boulangerie", "light blue", "white", ("ashlar", "#d8cfbd"), "light blue", "breads", 3, 7.5, roof="mansard"
        ),
        Shop(
            "DAILY BREAD",
            "cream",
            "#7a4a26",
            ("brick", "#a5634a"),
            "cream",
            "breads",
            1,
            8.0,
            awning=("#7a4a26", None),
            roof="gable",
        ),
    ),
    "convenience store": (
        Shop(
            "MINI MARKET",
            "green",
            "white",
            ("plaster", "#cfcfc8"),
            "green",
            "boxes",
            2,
            9.0,
            window="single",
            awning=("green", "white"),
        ),
        Shop("24/7 SHOP", "signal red", "white", ("panel", "#b7bcc0"), "signal red", "boxes", 1, 9.5, window="single"),
        Shop(
            "CORNER STORE",
            "signal yellow",
            "black",
            ("brick", "#7f4a3a"),
            "charcoal",
            "boxes",
            3,
            8.0,
            window="sash",
            awning=("signal yellow", "black"),
            outside="crates",
        ),
    ),
    "pharmacy": (
        Shop("PHARMACY", "white", "green", ("plaster", "#dfe3dc"), "white", "boxes", 2, 8.0, blade="cross"),
        Shop(
            "APOTHEKE",
            "dark red",
            "white",
            ("ashlar", "#cdbfa8"),
            "dark red",
            "boxes",
            3,
            8.5,
            blade="cross",
            roof="mansard",
        ),
        Shop(
            "CITY DRUGS",
            "green",
            "white",
            ("panel", "#c9d3d6"),
            "aluminium",
            "boxes",
            1,
            9.0,
            window="single",
            blade="cross",
        ),
    ),
    "bookstore": (
        Shop(
            "BOOKS",
            "dark blue",
            "gold",
            ("brick", "#94503c"),
            "dark blue",
            "books",
            2,
            7.5,
            window="sash",
            blade="BOOKS",
        ),
        Shop(
            "The Book Nook",
            "dark green",
            "gold",
            ("plaster", "#d6c9b0"),
            "dark green",
            "books",
            3,
            7.0,
            roof="mansard",
            outside="crates",
        ),
        Shop(
            "LIBRERIA", "#a8322a", "white", ("plaster", "#c9a26e"), "#5b2b22", "books", 2, 8.0, awning=("#a8322a", None)
        ),
    ),
    "clothing store": (
        Shop("MODA", "black", "white", ("ashlar", "#d9d6cf"), "black", "clothes", 3, 9.0, window="single"),
        Shop("Denim & Co", "#2d4a6b", "white", ("brick", "#9c5b45"), "#2d4a6b", "clothes", 2, 9.5, window="grid"),
        Shop(
            "BELLE",
            "pink",
            "white",
            ("plaster", "#efe3df"),
            "white",
            "clothes",
            2,
            7.5,
            awning=("pink", "white"),
            roof="mansard",
        ),
    ),
    "supermarket": (
        Shop(
            "SUPERMARKET", "signal red", "white", ("panel", "#c4c7c9"), "#d8dadb", "posters", 0, 14.0, window="single"
        ),
        Shop(
            "FRESH MARKET",
            "green",
            "signal yellow",
            ("brick", "#a8654e"),
            "charcoal",
            "posters",
            0,
            13.0,
            roof="gable",
            outside="crates",
        ),
        Shop(
            "DISCOUNT",
            "signal blue",
            "signal yellow",
            ("panel", "#e3e3de"),
            "signal blue",
            "posters",
            1,
            12.0,
            window="office",
        ),
    ),
    "flower shop": (
        Shop(
            "FLOWERS",
            "purple",
            "white",
            ("plaster", "#e0d5c4"),
            "#4f3a63",
            "flowers",
            2,
            6.5,
            awning=("pink", "white"),
            outside="plants",
        ),
        Shop(
            "Fleur",
            "#5f8f5a",
            "white",
            ("brick", "#93543f"),
            "#5f8f5a",
            "flowers",
            1,
            7.0,
            roof="gable",
            outside="plants",
        ),
        Shop(
            "BLUMEN",
            "white",
            "#c03a6b",
            ("plaster", "#b9c9b5"),
            "white",
            "flowers",
            3,
            7.0,
            awning=("#5f8f5a", None),
            outside="plants",
        ),
    ),
    "bar": (
        Shop(
            "BAR",
            "black",
            "amber",
            ("brick", "#6e3d32"),
            "black",
            "bottles",
            2,
            7.0,
            window="sash",
            blade="BAR",
            trim="dark grey",
        ),
        Shop(
            "The Old Oak",
            "dark wood",
            "gold",
            ("plaster", "#e2dccb"),
            "dark wood",
            "bottles",
            2,
            9.0,
            window="grid",
            roof="gable",
            blade="PUB",
            trim="dark wood",
            outside="plants",
        ),
        Shop(
            "NEON",
            "#221a38",
            "pink",
            ("panel", "#4b4d57"),
            "#221a38",
            "bottles",
            1,
            8.0,
            window="single",
            trim="charcoal",
            blade="BAR",
        ),
    ),
    "hair salon": (
        Shop("HAIR STUDIO", "charcoal", "pink", ("plaster", "#d5d0ca"), "charcoal", "salon", 2, 7.0),
        Shop(
            "BARBER",
            "white",
            "signal red",
            ("brick", "#99563f"),
            "dark blue",
            "salon",
            2,
            6.5,
            window="sash",
            blade="pole",
        ),
        Shop(
            "Coiffeur",
            "gold",
            "black",
            ("ashlar", "#dccdb2"),
            "black",
            "salon",
            3,
            7.0,
            roof="mansard",
            awning=("black", None),
        ),
    ),
}
