"""Objects of places: labels by location, their sizes, and their numbers of collision hulls."""

from .. import catalogue
from ..canvas import object_sizes

SIZES = object_sizes.SIZES

#: Labels for each kind of location; every draw is uniform over the list.
MIXES: dict[str, tuple[str, ...]] = {
    "people": (
        "pedestrian adult", "pedestrian adult", "pedestrian adult", "pedestrian adult", "pedestrian child",
        "elderly person", "jogger", "delivery worker", "police officer", "security guard", "wheelchair user",
        "maintenance worker", "doctor", "emergency worker", "humanoid robot", "roller skater", "infant",
        "electric scooter rider", "cyclist", "dog", "stroller", "wheelchair", "suitcase",
    ),
    "animals": ("dog", "dog", "cat", "bird", "squirrel", "duck", "rabbit", "chicken", "swan", "robot dog"),
    "wall": (
        "trash bin", "trash bin", "garbage bag", "garbage bag", "storage box", "parcels", "potted plant", "plant pot",
        "bicycle", "bicycle", "scooter", "motorcycle", "chair", "stool", "bench", "barrel or bucket", "handcart",
        "vending machine", "street cabinet", "control cabinets", "shopping cart", "ladder", "broom", "stone block",
        "advertising board", "newspaper stand", "guard stone", "washing machine", "refrigerator", "storage locker",
        "vehicle wheel", "flower", "shrub", "bonsai", "vase", "water point", "ashtray", "parcel locker",
    ),
    "dumped": (
        "armchair", "couch", "mattress", "television", "refrigerator", "washing machine", "cabinet or shelf",
        "bookcase", "chest of drawers", "desk", "stool", "coatrack", "vehicle wheel", "bed", "cushion", "suitcase",
        "garbage bag", "storage box", "electric fan", "stereo sound system", "stuffed toy", "toolbox", "barrow",
        "shovel", "discarded can", "bottle", "helmet", "guitar", "drum", "picnic basket", "grocery bag", "luggage",
        "easel", "lamp", "skateboard",
    ),
    "kerb": (
        "street light", "lamppost", "trash bin", "bollard", "fire hydrant", "mailbox", "postbox", "parking meter",
        "stop sign", "no parking sign", "do not enter sign", "directional sign", "traffic sign", "caution sign",
        "speed limit sign 30 km", "speed limit sign 20 km", "street cabinet", "charging station", "bicycle parking",
        "newspaper stand", "telephone booth", "bulletin board", "information point", "street clock", "pole",
        "utility pole", "guard rail", "self-service payment kiosk or terminal", "bicycle repair station", "tree",
        "tree", "flag", "atm", "water point", "waste station", "photo booth",
    ),
    "clutter": (
        "scooter", "scooter", "bicycle", "motorcycle", "segway", "delivery robot", "robot dog", "traffic cone",
        "garbage bag", "storage box", "parcels", "advertising board", "blackboard", "stroller", "shopping cart",
        "handcart", "tricycle", "hoverboard", "skateboard", "basketball", "football",
        "dirt bike", "barrow", "stone", "rock", "toolbox", "suitcase", "luggage", "chair", "plant pot",
    ),
    "terrace": (
        "potted plant", "plant pot", "blackboard", "advertising board", "sunshade", "stool", "barrel or bucket",
        "barbecue grill", "flower", "electric fan", "chair", "armchair", "counter", "vase",
    ),
    "middle": (
        "bench", "bench", "potted plant", "plant pot", "shrub", "flower", "tree", "tree", "kiosk", "newspaper stand",
        "sculpture", "water well", "obelisk", "street clock", "lamppost", "information point", "telephone booth",
        "bicycle parking", "trash bin", "advertising board", "picnic table", "drum", "easel", "photo booth", "stage",
        "fountain", "christmas tree", "water point", "arcade game cabinet", "shelter", "information point",
    ),
    "goods": (
        "storage box", "storage box", "parcels", "barrel or bucket", "handcart", "pumpkin", "cabbage",
        "potted plant", "flower", "picnic basket", "stool", "table", "chair", "counter", "garbage bag", "tricycle",
        "bottle", "vase", "shopping cart", "suitcase", "drum", "blackboard", "sunshade", "lamp", "stuffed toy",
        "bicycle", "chicken", "barrow", "electric fan", "plant pot", "bookcase",
    ),
    "lawn": (
        "tree", "tree", "tree", "tree", "shrub", "shrub", "flower", "rock", "stone", "bench", "picnic table",
        "beach chair", "tree debris", "stone block", "grass patch", "gardener", "lawn mower", "hammock",
        "frisbee", "football", "sports ball", "bicycle", "tent", "picnic basket", "tripod", "stuffed toy",
    ),
    "sports": (
        "table-tennis table", "trampoline", "horizontal bar", "fitness equipments", "playground", "basketball",
        "football", "skateboard", "bench", "roller skater", "bicycle", "jogger", "pedestrian child",
    ),
    "works": (
        "traffic cone", "traffic cone", "traffic barricade", "construction worker", "construction worker", "barrow",
        "toolbox", "shovel", "ladder", "stone block", "debris", "barrel or bucket", "storage box", "jersey barrier",
        "stone", "helmet", "traffic controller", "public toilets", "control cabinets", "concrete tetrapod",
    ),
    "cars": (
        "sedan", "hatchback car", "suv", "van", "minivan", "pickup truck", "taxi", "police car", "car", "electric car",
        "convertible car", "coupe car", "sports car", "sedan", "hatchback car", "suv", "motorcycle",
    ),
    "long": ("truck", "bus", "camper", "ambulance", "garbage truck", "trailer", "caravan", "limousine", "fire truck"),
    "lot": (
        "shopping cart", "shopping cart", "traffic cone", "bollard", "trash bin", "parking meter", "rickshaw",
        "charging station", "motorcycle", "all-terrain vehicle", "garbage bag", "suitcase", "parcels", "scooter",
        "self-service payment kiosk or terminal", "vehicle wheel", "stroller",
    ),
    "doors": (
        "trash bin", "trash bin", "garbage bag", "plant pot", "bicycle", "potted plant", "flower", "storage box",
        "pole", "utility pole", "vehicle wheel", "parcels", "refrigerator", "stone block", "guard stone", "water point",
    ),
    "planters": ("plant pot", "potted plant", "shrub", "flower", "stone block", "bench"),
}  # fmt: skip

#: House fronts around a place.
HOUSES: tuple[str, ...] = (
    "apartment building", "apartment building", "house", "office building", "hotel", "cafe", "restaurant", "bakery",
    "convenience store", "pharmacy", "bookstore", "bank", "clothing store", "supermarket", "flower shop", "bar",
    "hair salon", "school", "garage", "bistro", "butcher shop", "bicycle shop", "greengrocer", "ice cream shop",
    "laundry", "pizzeria", "pub", "toy shop", "shoe store", "tobacco shop", "optical store", "pastry shop", "hostel",
    "watch shop", "video game store", "travel agency", "seafood shop", "juice bar", "jewelry store", "cosmetics store",
)  # fmt: skip

#: Fronts around a parking lot, and of a residential street.
SHEDS = (
    "supermarket", "retail", "garage", "office building", "convenience store", "apartment building", "school", "house",
    "hostel",
)  # fmt: skip
HOMES = (
    "house", "apartment building", "bungalow", "garage", "hotel", "hostel", "bakery", "laundry", "tobacco shop",
    "hair salon",
)  # fmt: skip

#: Number of hulls of the labels that have more than `DEFAULT_HULLS`, the largest over a label's base shapes.
DEFAULT_HULLS = 3
HULLS: dict[str, int] = {
    "bench": 6, "bicycle": 4, "bicycle parking": 5, "scooter": 4, "motorcycle": 5, "table": 4, "stool": 4,
    "picnic table": 6, "beach chair": 6, "hammock": 12, "tent": 12, "table-tennis table": 12, "trampoline": 12,
    "horizontal bar": 12, "fitness equipments": 6, "playground": 10, "lawn mower": 6, "fence": 4, "wall": 12,
    "ladder": 12, "barrow": 6, "broom": 6, "desk": 6, "bed": 12, "couch": 12, "mattress": 6,
    "cabinet or shelf": 6, "bookcase": 6, "chest of drawers": 6, "coatrack": 6, "television": 6, "easel": 6, "drum": 6,
    "blackboard": 6, "counter": 12, "electric fan": 4, "lamp": 6, "kite": 6, "tripod": 6, "tree debris": 12,
    "debris": 6, "traffic barricade": 6, "guard rail": 5, "barbecue grill": 5, "bulletin board": 7, "handcart": 4,
    "tricycle": 5, "stroller": 4, "wheelchair": 4, "wheelchair user": 6, "segway": 6, "unicycle": 6, "dirt bike": 5,
    "storage locker": 6, "parcel locker": 12, "photo booth": 6, "water point": 5, "information point": 12,
    "bicycle repair station": 6, "self-service payment kiosk or terminal": 6, "control cabinets": 6, "bonsai": 6,
    "street clock": 8, "waste station": 12, "public toilets": 12, "telephone booth": 2, "shelter": 12, "stage": 12,
    "canopy": 12, "street food stall": 8, "food truck": 6, "kiosk": 8, "water well": 12, "obelisk": 11, "fountain": 6,
    "sculpture": 6, "doctor": 6, "emergency worker": 6, "security guard": 6, "maintenance worker": 6, "gardener": 6,
    "traffic controller": 6, "roller skater": 6, "electric scooter rider": 6, "humanoid robot": 6, "swan": 6,
    "bus shelter": 10, "rickshaw": 12, "all-terrain vehicle": 12, "sunshade": 4, "cyclist": 4, "pole": 4,
    "hatchback car": 6, "forklift": 12, "road roller": 12, "excavator": 12, "cement mixer": 12, "container": 12,
    "bulldozer": 12, "motorcycle parking": 12, "truck": 5, "trailer": 12, "concrete tetrapod": 3, "gate": 12,
    "traffic light": 6, "caution sign": 5, "directional sign": 5, "traffic sign": 4, "tree": 5, "utility pole": 4,
}  # fmt: skip
#: A robot is close to at most `LONG_OBJECT_HULLS` hulls of an object longer than `LONG_OBJECT_LENGTH` (m), and to the
#: `HOUSE_HULLS` hulls of a house.
LONG_OBJECT_LENGTH, LONG_OBJECT_HULLS, HOUSE_HULLS = 3.9, 6, 2

#: Growth forms of trees that fit between houses.
SLIM: tuple[catalogue.Size, ...] = (catalogue.TREES["slim"], catalogue.TREES["street"], catalogue.TREES["palm"])

SIDEWALKS: tuple[str, ...] = (
    "asphalt_fine", "asphalt_grey-cracked", "blocks_grey-worn", "brick_red_basket", "brick_brown_running",
    "brick_buff_herringbone", "concrete_grey-worn", "concrete_pale-worn", "flags_grey-worn", "flags_mixed",
    "granite_courses-worn", "granite_light-stained", "limestone_polished-stained", "panot_flower-wet", "resin_bound",
    "setts_bows", "setts_small", "calcada_net", "crazy_paving-mossy", "hoggin-leaves", "slate-mossy",
)  # fmt: skip


def hulls(label: str, size: catalogue.Size, house: bool = False) -> int:
    """Returns about how many collision hulls of an object a robot beside it may be tested against."""
    if house:
        return HOUSE_HULLS
    return LONG_OBJECT_HULLS if max(size[:2]) > LONG_OBJECT_LENGTH else HULLS.get(label, DEFAULT_HULLS)
