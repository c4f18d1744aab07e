"""Random streets for benchmarks: a cross-section with kerbs and ramps, house fronts, and randomly placed objects.

Scene frame as in `citygen.section`: the street runs along +x, its middle at y = 0. On each side a band along the kerb
and one along the houses hold objects close together; between them a lane stays open, with people next to it.
"""

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from urbanverse_mjx.assets import AssetIndex
from urbanverse_mjx.assets.appearances.ground_materials import material_ids
from urbanverse_mjx.assets.appearances.skies import sky_ids
from urbanverse_mjx.citygen import catalogue, section
from urbanverse_mjx.datatypes import AssetRecord, GroundRegion, PlacedGround, PlacedObject, SceneLayout, ValidationError
from urbanverse_mjx.datatypes.hashing import content_hash

#: Raised whenever the same seed gives a different layout.
VERSION = "1"
LENGTH = 200.0  # m, the length that the engines are designed for
#: Streets with different ground; further layouts repeat them, so that ground meshes are shared as houses are.
SECTIONS = 16
#: Records of a leaf that are used: keeps the file of a bank small.
VARIANTS = 2
#: Bands of a pavement: m from the kerb, and m from the house fronts.
KERB_BAND, WALL_BAND = (0.25, 1.35), (1.45, 0.05)
LANE = 1.2  # m that stay free next to objects between the bands: a robot of 0.35 m radius with margin
APART = 0.25  # m between two objects
MOUTH = 2.4  # m on each side of a crosswalk's middle that stay free along the kerb
FLAT, UP = 0.0, section.KERB_HEIGHT

HOUSES = (
    "apartment building",
    "bakery",
    "bank",
    "bar",
    "bookstore",
    "cafe",
    "clothing store",
    "convenience store",
    "flower shop",
    "hair salon",
    "hotel",
    "house",
    "office building",
    "pharmacy",
    "restaurant",
    "supermarket",
)
KERBSIDE = (
    "tree",
    "tree",
    "tree",
    "street light",
    "lamppost",
    "bollard",
    "bollard",
    "parking meter",
    "fire hydrant",
    "trash bin",
    "postbox",
    "mailbox",
    "bicycle parking",
    "bicycle",
    "motorcycle",
    "stop sign",
    "no parking sign",
    "directional sign",
    "street cabinet",
    "newspaper stand",
    "charging station",
    "guard stone",
    "traffic cone",
)
WALLSIDE = (
    "bench",
    "potted plant",
    "plant pot",
    "table",
    "chair",
    "chair",
    "advertising board",
    "vending machine",
    "garbage bag",
    "shrub",
    "storage box",
    "parcels",
    "scooter",
    "picnic table",
    "rock",
    "sculpture",
)
WALKING = (
    "pedestrian adult",
    "pedestrian adult",
    "pedestrian adult",
    "pedestrian child",
    "elderly person",
    "jogger",
    "delivery worker",
    "police officer",
    "dog",
    "stroller",
    "wheelchair",
    "scooter",
    "delivery robot",
    "handcart",
)
VEHICLES = ("sedan", "hatchback car", "suv", "van", "minivan", "pickup truck", "taxi", "police car", "cyclist", "truck")
#: Share of the objects in each band, fronts apart.
SHARES = {"kerb": 0.4, "wall": 0.33, "walk": 0.12, "road": 0.15}
_LEAVES = {"kerb": KERBSIDE, "wall": WALLSIDE, "walk": WALKING, "road": VEHICLES}


@dataclasses.dataclass(frozen=True)
class Stock:
    """Objects of a street.

    houses: leaves of the fronts; leaves: of the objects, by band; variants: records of a leaf that are used;
    skies: that may be drawn, none for all.
    """

    houses: tuple[str, ...] = HOUSES
    leaves: Mapping[str, tuple[str, ...]] = dataclasses.field(default_factory=lambda: dict(_LEAVES))
    variants: int = VARIANTS
    skies: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True)
class Ground:
    """A street's cross-section, its regions, and the material of each kind of ground."""

    section: section.StreetSection
    regions: tuple[GroundRegion, ...]
    materials: Mapping[str, str]


#: Attempts per object before the street counts as full.
_TRIES = 60


@dataclasses.dataclass
class _Street:
    """A street being filled; boxes (n, 4) are x and y from and to of what each object takes at walking height."""

    ground: section.StreetSection
    rng: np.random.Generator
    index: AssetIndex
    stock: Stock
    objects: list[PlacedObject] = dataclasses.field(default_factory=list)
    boxes: list[tuple[float, float, float, float]] = dataclasses.field(default_factory=list)

    def record(self, leaves: tuple[str, ...]) -> AssetRecord:
        """A random record of a random leaf."""
        options = self.index.by_leaf(leaves[self.rng.integers(len(leaves))])[: self.stock.variants]
        return options[self.rng.integers(len(options))]

    def put(self, record: AssetRecord, x: float, y: float, z: float, yaw: float) -> None:
        self.objects.append(
            PlacedObject(
                id=f"{record.leaf.replace(' ', '_')}_{len(self.objects):03d}",
                label=record.leaf,
                category=record.leaf,
                asset_uid=record.uid,
                position=(round(x, 3), round(y, 3), z),
                yaw=round(yaw, 3),
                scale=(1.0, 1.0, 1.0),
                mass=record.mass,
                friction=record.friction_coefficient,
                movable=record.movable,
            )
        )

    def is_free(self, box: tuple[float, float, float, float]) -> bool:
        """Whether a box keeps `APART` from all others."""
        if not self.boxes:
            return True
        x0, x1, y0, y1 = np.array(self.boxes).T
        return not bool(
            ((x0 < box[1] + APART) & (x1 > box[0] - APART) & (y0 < box[3] + APART) & (y1 > box[2] - APART)).any()
        )


def make_ground(seed: int, number: int) -> Ground:
    """Cross-section `number` of a seed, with a material for each kind of ground."""
    rng = np.random.default_rng([seed, 1, number])
    # Half metres, so that streets differ visibly; pavements wide enough for both bands and a lane between.
    carriageway = 6.0 + 0.5 * rng.integers(0, 7)
    left, right = 5.0 + 0.5 * rng.integers(0, 4, 2)
    crosswalks = (np.array([0.15, 0.4, 0.62, 0.87]) + rng.uniform(-0.04, 0.04, 4)) * LENGTH
    street = section.StreetSection(
        LENGTH, float(carriageway), float(left), float(right), tuple(float(round(x, 1)) for x in crosswalks)
    )
    regions = tuple(section.ground_regions(street))
    kinds = sorted({r.kind for r in regions})
    return Ground(street, regions, {k: str(rng.choice(material_ids(k))) for k in kinds})


def make_layout(
    seed: int,
    number: int,
    index: AssetIndex,
    objects: tuple[int, int],
    stock: Stock | None = None,
    ground: Ground | None = None,
) -> SceneLayout:
    """Layout `number` of a seed with between objects[0] and objects[1] objects, house fronts included.

    Args:
      stock: its objects; default: those of the frozen benchmark banks.
      ground: its section; default: one of `SECTIONS`.

    Raises:
      ValidationError: so many do not fit, or fewer are wanted than there are house fronts.
    """
    stock = stock or Stock()
    ground = ground or make_ground(seed, number % SECTIONS)
    rng = np.random.default_rng([seed, 2, number])
    street = _Street(ground.section, rng, index, stock)
    wanted = int(rng.integers(objects[0], objects[1] + 1))
    _put_houses(street)
    if len(street.objects) > wanted:
        raise ValidationError(
            f"--objects: found {wanted}, needed at least {len(street.objects)} for the house fronts; ask for more."
        )
    for band, count in _share(wanted - len(street.objects)).items():
        for _ in range(count):
            _put_somewhere(street, band)
    name = f"bench_s{seed}_{number:03d}"
    return SceneLayout(
        id=name,
        graph_id=name,
        graph_hash=content_hash({"generator": VERSION, "seed": seed, "number": number, "objects": list(objects)}),
        seed=seed,
        cousin=0,
        objects=tuple(street.objects),
        ground=tuple(PlacedGround(r.id, r.kind, r.polygon, r.plane, ground.materials[r.kind]) for r in ground.regions),
        sky=str(rng.choice(stock.skies or sky_ids())),
        sky_yaw=round(float(rng.uniform(-math.pi, math.pi)), 3),
        hashes={"assets": index.content_hash(), "generator": VERSION},
    )


def _share(count: int) -> dict[str, int]:
    """How many of `count` objects go into each band."""
    shares = {band: int(share * count) for band, share in SHARES.items()}
    shares["kerb"] += count - sum(shares.values())
    return shares


def _put_houses(street: _Street) -> None:
    """House fronts side by side along both sides, and across both ends."""
    ground = street.ground
    x0, x1 = ground.span()
    for side in (1, -1):
        x = x0
        while True:
            house = street.record(street.stock.houses)
            depth, width, _ = house.extent_xyz
            if x + width > x1:
                break
            y = side * (ground.front(side) + depth / 2)
            street.put(house, x + width / 2, y, UP, -side * math.pi / 2)
            x += width
    for at_end in (False, True):
        y, edge = -ground.front(-1), ground.closing_x(at_end)
        while y < ground.front(1):
            house = street.record(street.stock.houses)
            depth, width, _ = house.extent_xyz
            away = depth / 2 if at_end else -depth / 2
            street.put(house, edge + away, y + width / 2, UP, math.pi if at_end else 0.0)
            y += width


def _put_somewhere(street: _Street, band: str) -> None:
    """One object at a random free place of a band, or of another one where that is full.

    Raises:
      ValidationError: none was found anywhere.
    """
    for other in (band, *(b for b in SHARES if b != band)):
        for _ in range(_TRIES):
            side = 1 if street.rng.random() < 0.5 else -1
            record = street.record(street.stock.leaves[other])
            if _try_place(street, other, side, record):
                return
    raise ValidationError(
        f"--objects: found no free place for another object in a street with {len(street.objects)}, needed one; "
        "ask for fewer."
    )


def _try_place(street: _Street, band: str, side: int, record: AssetRecord) -> bool:
    """Puts an object at one random place, if it is free; `v` counts metres from the kerb, towards the houses."""
    rng, ground = street.rng, street.ground
    yaw = _facing(band, side, rng)
    half_x, half_v, shift = _footprint(record, yaw)
    low, high = _limits(band, ground.width(side), half_v, rng)
    if low > high:
        return False
    x, v = rng.uniform(1.0 + half_x, ground.length - 1.0 - half_x), rng.uniform(low, high)
    reach = half_x + MOUTH + (4.0 if band == "road" else 0.0)  # no parked vehicle before a crosswalk
    if band != "wall" and min(abs(x - c) for c in ground.crosswalks) < reach:
        return False
    y = side * (ground.half + v)
    taken = (x - half_x, x + half_x, y - half_v, y + half_v)
    if band == "walk":  # no two people side by side: together they would close the lane
        y0, y1 = sorted(side * (ground.half + edge) for edge in _lane(ground, side))
        taken = (x - half_x - LANE, x + half_x + LANE, y0, y1)
    if not street.is_free(taken):
        return False
    street.boxes.append(taken)
    street.put(record, x - shift[0], y - shift[1], FLAT if band == "road" else UP, yaw)
    return True


def _lane(ground: section.StreetSection, side: int) -> tuple[float, float]:
    """The strip between the bands, m from the kerb, `APART` taken off on both sides."""
    return KERB_BAND[1] + APART, ground.width(side) - WALL_BAND[0] - APART


def _facing(band: str, side: int, rng: np.random.Generator) -> float:
    """Yaw (rad) of an object in a band: along the street or across it, not quite straight."""
    if band == "wall":
        yaw = -side * math.pi / 2
    elif band == "road":
        yaw = math.pi if side > 0 else 0.0
    else:
        yaw = math.pi / 2 * int(rng.integers(4)) if band == "kerb" else math.pi * int(rng.integers(2))
    return math.remainder(yaw + rng.uniform(-1, 1) * (0.03 if band == "road" else 0.15), math.tau)


def _footprint(record: AssetRecord, yaw: float) -> tuple[float, float, tuple[float, float]]:
    """Half sizes (m) along x and y of an object's footprint at walking height, and its centre relative to the
    origin."""
    along, across, _ = record.extent_xyz
    stem = catalogue.STEMS.get(record.leaf)
    ahead = 0.0
    if stem:
        ahead, along, across = stem.offset * along / 2, stem.side, stem.side
    c, s = math.cos(yaw), math.sin(yaw)
    half_x, half_y = (abs(c) * along + abs(s) * across) / 2, (abs(s) * along + abs(c) * across) / 2
    return half_x, half_y, (ahead * c, ahead * s)


def _limits(band: str, width: float, half: float, rng: np.random.Generator) -> tuple[float, float]:
    """From and to which distance from the kerb (m) an object's middle may be; to < from where it is too big."""
    if band == "kerb":
        return KERB_BAND[0] + half, KERB_BAND[1] - half
    if band == "wall":
        return width - WALL_BAND[0] + half, width - WALL_BAND[1] - half
    if band == "road":
        return -0.3 - half - 0.1, -0.3 - half
    low, high = KERB_BAND[1], width - WALL_BAND[0]
    slack = high - low - LANE - 2 * half
    if slack < 0:
        return 1.0, 0.0
    return (low + half, low + half + slack) if rng.random() < 0.5 else (high - half - slack, high - half)
