"""What each trade's shops show: goods, names and colours of three variants."""

import dataclasses

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


TRADES: dict[str, Trade] = {
    "alcohol shop": Trade(
        ("wine", "whisky", "beer", "wine"),
        ("WINE & SPIRITS", "Liquor Store", "VINOTHEK"),
        (("dark red", "cream"), ("signal yellow", "black"), ("#3d2a4a", "gold")),
    ),
    "bicycle shop": Trade(
        ("bike",),
        ("BICYCLES", "Velo Werkstatt", "CITY BIKES"),
        (("signal blue", "white"), ("orange", "black"), ("lime", "black")),
        ("wide", "middle", "side"),
        "bicycle",
    ),
    "bistro": Trade(
        ("wineglass", "cutlery"),
        ("LE BISTRO", "Bistro Central", "BISTRO 12"),
        (("dark green", "gold"), ("black", "white"), ("#7a2630", "cream")),
        ("folding", "folding", "middle"),
        "tables",
    ),
    "bubble tea bar": Trade(
        ("bubbletea",),
        ("BUBBLE TEA", "Boba Bar", "TEA POP"),
        (("#b58cd0", "white"), ("#f4b6c8", "#5a2b3d"), ("#8ed0b8", "white")),
        ("counter", "counter", "side"),
        single=True,
    ),
    "butcher shop": Trade(
        ("sausage", "ham", "cow"),
        ("BUTCHER", "Metzgerei", "PRIME MEATS"),
        (("signal red", "white"), ("white", "dark red"), ("black", "signal red")),
        ("side", "middle", "side"),
    ),
    "cheese shop": Trade(
        ("cheese", "cheesewheel", "bread"),
        ("CHEESE SHOP", "Fromagerie", "KAAS"),
        (("#f2c14a", "#4a3010"), ("#33558a", "#f6e3a0"), ("#7a4f20", "cream")),
        ("side", "middle", "side"),
    ),
    "comic shop": Trade(
        ("comic", "hero", "sheets"),
        ("COMICS", "Hero Cave", "MANGA & COMICS"),
        (("signal yellow", "signal red"), ("signal blue", "signal yellow"), ("signal red", "white")),
        ("side", "wide", "middle"),
        lit=False,
    ),
    "copy shop or print shop": Trade(
        ("printer", "sheets"),
        ("COPY SHOP", "Print & Copy", "DRUCK 24"),
        (("signal blue", "white"), ("#e6007e", "white"), ("charcoal", "signal yellow")),
        ("wide", "side", "middle"),
        lit=False,
    ),
    "cosmetics store": Trade(
        ("lipstick", "perfume"),
        ("BEAUTY", "Cosmetics", "PARFUMERIE"),
        (("pink", "white"), ("black", "pink"), ("white", "#b0174f")),
        ("wide", "middle", "side"),
    ),
    "dry cleaning": Trade(
        ("hanger",),
        ("DRY CLEANING", "Express Cleaners", "REINIGUNG"),
        (("signal blue", "white"), ("teal", "white"), ("white", "signal blue")),
        ("side", "wide", "middle"),
        lit=False,
    ),
    "e-cigarette store": Trade(
        ("vape",),
        ("VAPE SHOP", "E-Cig Cloud", "STEAM"),
        (("black", "light green"), ("purple", "white"), ("charcoal", "#40e0e0")),
        ("side", "middle", "side"),
        lit=False,
    ),
    "electronics store": Trade(
        ("television", "phone", "computer"),
        ("ELECTRONICS", "TechWorld", "MEDIA HOUSE"),
        (("signal red", "white"), ("dark blue", "signal yellow"), ("charcoal", "white")),
        ("wide", "wide", "middle"),
        lit=False,
    ),
    "fast food restaurant": Trade(
        ("burger", "fries"),
        ("BURGER HOUSE", "Fry King", "QUICK BITES"),
        (("signal red", "signal yellow"), ("signal yellow", "signal red"), ("dark green", "white")),
        ("wide", "middle", "wide"),
        single=True,
    ),
    "furniture store": Trade(
        ("sofa", "lamp"),
        ("FURNITURE", "Home & Sofa", "MOEBELHAUS"),
        (("signal blue", "signal yellow"), ("charcoal", "white"), ("dark red", "white")),
        ("wide", "wide", "wide"),
    ),
    "greengrocer": Trade(
        ("apple", "carrot", "oranges"),
        ("FRUIT & VEG", "Greengrocer", "OBST & GEMUESE"),
        (("green", "white"), ("dark green", "#f4d35e"), ("#a8c94a", "#254a1c")),
        ("folding", "side", "middle"),
        "crates",
    ),
    "hardware store": Trade(
        ("hammer", "wrench", "saw"),
        ("HARDWARE", "Tool Depot", "EISENWAREN"),
        (("orange", "white"), ("signal yellow", "black"), ("dark green", "white")),
        ("wide", "middle", "side"),
        lit=False,
    ),
    "ice cream shop": Trade(
        ("icecream",),
        ("ICE CREAM", "Gelateria Roma", "EIS"),
        (("pink", "white"), ("#9adbd0", "#a8324a"), ("white", "#d6457a")),
        ("counter", "side", "counter"),
        "cone",
        single=True,
    ),
    "internet cafe": Trade(
        ("computer", "wifi"),
        ("INTERNET CAFE", "NetPoint", "CYBER CAFE"),
        (("dark blue", "#5ce0ff"), ("signal red", "white"), ("#2b2140", "light green")),
        ("wide", "side", "middle"),
        lit=False,
    ),
    "jewelry store": Trade(
        ("goldring", "diamond"),
        ("JEWELLERY", "Bijoux", "GOLD & DIAMONDS"),
        (("black", "gold"), ("dark blue", "white"), ("dark red", "gold")),
        ("middle", "side", "middle"),
    ),
    "juice bar": Trade(
        ("juice", "oranges"),
        ("JUICE BAR", "Fresh Press", "VITAMIN"),
        (("orange", "white"), ("lime", "#254a1c"), ("signal yellow", "#d44a10")),
        ("counter", "counter", "side"),
        single=True,
    ),
    "laundry": Trade(
        ("washer",),
        ("LAUNDROMAT", "Coin Laundry", "WASCHSALON"),
        (("light blue", "dark blue"), ("signal blue", "white"), ("signal yellow", "black")),
        ("wide", "side", "middle"),
        lit=False,
    ),
    "lighting store": Trade(
        ("lamp", "bulb"),
        ("LIGHTING", "Lumen", "LEUCHTEN"),
        (("black", "lamp"), ("white", "black"), ("dark blue", "amber")),
        ("wide", "middle", "side"),
    ),
    "massage shop": Trade(
        ("massage", "lotus"),
        ("THAI MASSAGE", "Massage & Spa", "LOTUS MASSAGE"),
        (("#7b3f6b", "gold"), ("#3f5f4a", "cream"), ("#b5523a", "white")),
        ("side", "closed", "middle"),
    ),
    "musical instrument store": Trade(
        ("guitar", "violin", "note"),
        ("MUSIC STORE", "Guitars & Strings", "MUSIKHAUS"),
        (("dark red", "gold"), ("black", "orange"), ("dark green", "cream")),
        ("middle", "wide", "side"),
    ),
    "nightclub": Trade(
        ("disco", "cocktail", "note"),
        ("CLUB MIRAGE", "NIGHTCLUB", "PULSE"),
        (("#241438", "#ff4fd8"), ("black", "#40e0ff"), ("#301020", "#ff5a3c")),
        ("closed", "closed", "closed"),
    ),
    "optical store": Trade(
        ("glasses", "sunglasses", "eye"),
        ("OPTICIAN", "Eyewear", "OPTIK"),
        (("white", "signal blue"), ("teal", "white"), ("dark red", "white")),
        ("middle", "wide", "side"),
        lit=False,
    ),
    "pastry shop": Trade(
        ("cake", "croissant"),
        ("PATISSERIE", "Sweet Cakes", "KONDITOREI"),
        (("#f0b8c4", "#6b2b3b"), ("#6b4127", "#f6e3c0"), ("#a6d4cf", "#5b2b22")),
        ("side", "middle", "side"),
        "tables",
    ),
    "photography shop": Trade(
        ("camera", "portrait"),
        ("PHOTO STUDIO", "Foto Express", "CAMERA HOUSE"),
        (("signal yellow", "black"), ("black", "white"), ("signal red", "white")),
        ("side", "middle", "side"),
        lit=False,
    ),
    "pizzeria": Trade(
        ("pizza", "pizzawhole"),
        ("PIZZERIA", "Pizza Napoli", "LA FORNACE"),
        (("dark green", "white"), ("signal red", "white"), ("#5a2a18", "amber")),
        ("folding", "side", "middle"),
        "tables",
    ),
    "pub": Trade(
        ("beer",),
        ("THE RED LION", "The Anchor Pub", "O'BRIEN'S PUB"),
        (("dark red", "gold"), ("dark blue", "gold"), ("dark green", "gold")),
        ("middle", "middle", "side"),
        "barrels",
    ),
    "real estate agency": Trade(
        ("listing", "home", "listing"),
        ("REAL ESTATE", "Home Agents", "IMMOBILIEN"),
        (("dark blue", "white"), ("signal red", "white"), ("white", "dark green")),
        ("wide", "middle", "side"),
        lit=False,
    ),
    "retail": Trade(
        ("bag", "hanger", "teddy", "lamp"),
        ("THE SHOP", "Store No. 5", "BAZAAR"),
        (("charcoal", "white"), ("teal", "white"), ("signal red", "signal yellow")),
        ("wide", "middle", "side"),
    ),
    "seafood shop": Trade(
        ("fish", "crab"),
        ("FRESH FISH", "Seafood Market", "FISCH"),
        (("signal blue", "white"), ("teal", "cream"), ("white", "signal blue")),
        ("counter", "side", "middle"),
        "ice",
        lit=False,
    ),
    "shoe store": Trade(
        ("heel", "boot", "sneaker"),
        ("SHOES", "Shoe Corner", "SCHUHHAUS"),
        (("dark red", "white"), ("white", "black"), ("#5a3a26", "gold")),
        ("wide", "middle", "side"),
    ),
    "tattoo shop": Trade(
        ("heart", "skull"),
        ("TATTOO", "Ink & Needle", "BLACK ROSE TATTOO"),
        (("black", "signal red"), ("#3a1a1a", "white"), ("charcoal", "gold")),
        ("side", "closed", "side"),
    ),
    "tobacco shop": Trade(
        ("pipe", "cigars"),
        ("TOBACCO", "Tabac", "CIGARS & PIPES"),
        (("dark green", "gold"), ("signal red", "white"), ("#4a2a18", "gold")),
        ("side", "side", "middle"),
    ),
    "toy shop": Trade(
        ("teddy", "blocks", "ball"),
        ("TOYS", "Toy Box", "SPIELWAREN"),
        (("signal red", "signal yellow"), ("signal blue", "white"), ("orange", "white")),
        ("middle", "wide", "side"),
    ),
    "travel agency": Trade(
        ("beach", "plane"),
        ("TRAVEL AGENCY", "Sunny Travel", "REISEBUERO"),
        (("signal blue", "white"), ("orange", "white"), ("teal", "signal yellow")),
        ("wide", "side", "middle"),
        lit=False,
    ),
    "video game store": Trade(
        ("gamepad", "invader", "television"),
        ("VIDEO GAMES", "Game Zone", "PIXEL STORE"),
        (("#1b1b3a", "light green"), ("signal red", "white"), ("purple", "white")),
        ("wide", "side", "middle"),
        lit=False,
    ),
    "watch shop": Trade(
        ("watch", "clock"),
        ("WATCHES", "Horloger", "UHREN"),
        (("dark green", "gold"), ("black", "white"), ("dark blue", "gold")),
        ("side", "middle", "side"),
    ),
}
