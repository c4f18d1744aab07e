"""`SceneLayout`: one digital cousin, every asset chosen and placed. File: `layout.json`."""

import dataclasses
import re
from typing import Any, ClassVar, Self

from . import ground
from . import validation as v
from .json_datatype import JsonDatatype
from .scene_graph import MAX_OBJECTS, MAX_REGIONS

SCHEMA = "urbanverse.scene_layout/1"
#: Which collision hulls a layout asks for: the first ones, or those that stand out least where a robot can touch, as of
#: a revision of their store.
HULL_KINDS = ("", "close", "close-2")


def _colour(value: Any, where: str) -> str:
    text = v.text(value, where)
    if text != "own" and not re.fullmatch("#[0-9a-f]{6}", text):
        raise v.fail(where, v.show(value), "'#rrggbb' with digits 0-9 and a-f, or 'own'")
    return text


@dataclasses.dataclass(frozen=True)
class PlacedObject:
    """An asset at a pose.

    Attributes:
      id: the graph object's id.
      label: the graph object's label.
      category: leaf of the ontology.
      asset_uid: record in the asset index.
      position: (3,) m, world position of the asset's origin (centre of its footprint on the ground).
      yaw: rad, counter-clockwise from +x.
      scale: (3,) factors along the asset's own axes.
      mass: kg, after scaling.
      friction: sliding friction coefficient.
      movable: whether a robot could push it over or along.
      paint: colours of its painted parts (`assets.meshes.repaint`) instead of its record's; () for those.
    """

    id: str
    label: str
    category: str
    asset_uid: str
    position: tuple[float, float, float]
    yaw: float
    scale: tuple[float, float, float]
    mass: float
    friction: float
    movable: bool
    paint: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        v.text(self.id, "object.id")
        where = f"object {self.id!r}"
        set_ = object.__setattr__
        for name in ("label", "category", "asset_uid"):
            v.text(getattr(self, name), f"{where}.{name}")
        set_(self, "position", v.vector(self.position, f"{where}.position", 3, minimum=-1e5, maximum=1e5))
        set_(self, "yaw", v.number(self.yaw, f"{where}.yaw", minimum=-100.0, maximum=100.0))
        set_(self, "scale", v.vector(self.scale, f"{where}.scale", 3, minimum=0.01, maximum=100.0))
        set_(self, "mass", v.number(self.mass, f"{where}.mass", above=0.0, maximum=1e9))
        set_(self, "friction", v.number(self.friction, f"{where}.friction", minimum=0.0, maximum=5.0))
        v.boolean(self.movable, f"{where}.movable")
        paint = v.items(self.paint, f"{where}.paint", maximum=8)
        set_(self, "paint", tuple(_colour(color, f"{where}.paint") for color in paint))

    def to_json(self) -> dict[str, Any]:
        body = {**dataclasses.asdict(self), "position": list(self.position), "scale": list(self.scale)}
        # Left out where there is none, so that older layouts keep their hashes.
        paint = body.pop("paint")
        return {**body, "paint": list(paint)} if paint else body

    @staticmethod
    def from_json(value: Any, where: str) -> "PlacedObject":
        where = v.named(value, where, "object")
        names = [f.name for f in dataclasses.fields(PlacedObject) if f.name != "paint"]
        m = v.mapping(value, where, names, ("paint",))
        v.text(m["id"], f"{where}.id")
        return PlacedObject(**m)


@dataclasses.dataclass(frozen=True)
class PlacedGround:
    """A ground region with its material; see `GroundRegion` for the geometry."""

    id: str
    kind: str
    polygon: tuple[tuple[float, float], ...]
    plane: tuple[float, float, float]
    material: str

    def __post_init__(self) -> None:
        v.text(self.id, "ground.id")
        where = f"ground {self.id!r}"
        set_ = object.__setattr__
        v.choice(self.kind, f"{where}.kind", ground.GROUND_KINDS[1:])
        set_(self, "polygon", ground.check_polygon(self.polygon, f"{where}.polygon"))
        set_(self, "plane", ground.check_plane(self.plane, f"{where}.plane"))
        v.text(self.material, f"{where}.material")

    def to_json(self) -> dict[str, Any]:
        body = dataclasses.asdict(self)
        return {**body, "polygon": [list(p) for p in self.polygon], "plane": list(self.plane)}

    @staticmethod
    def from_json(value: Any, where: str) -> "PlacedGround":
        where = v.named(value, where, "ground")
        m = v.mapping(value, where, [f.name for f in dataclasses.fields(PlacedGround)])
        v.text(m["id"], f"{where}.id")
        return PlacedGround(**m)


@dataclasses.dataclass(frozen=True)
class SceneLayout(JsonDatatype):
    """One cousin of a graph: placed assets, ground materials and the sky.

    Attributes:
      id: scene id; cousins of one graph differ in their suffix.
      graph_id, graph_hash: the graph it was made from.
      seed, cousin: what chose among equally good assets.
      objects, ground: placed objects.
      sky: id of a sky.
      sky_yaw: rad, its rotation about z.
      hashes: further inputs, name to hash (asset index, materialiser).
      place: (city, country) whose roads and plants the compiler draws, or None: roads without markings of a country.
      hulls: "close" for the collision hulls that stand out least where a robot can touch, "close-2" for the second
        revision of these, "" for the first hulls.
    """

    KIND: ClassVar[str] = "scene layout"

    id: str
    graph_id: str
    graph_hash: str
    seed: int
    cousin: int
    objects: tuple[PlacedObject, ...]
    ground: tuple[PlacedGround, ...]
    sky: str
    sky_yaw: float
    hashes: dict[str, str]
    place: tuple[str, str] | None = None
    hulls: str = ""

    def __post_init__(self) -> None:
        for name in ("id", "graph_id"):
            v.identifier(getattr(self, name), f"layout.{name}")
        for name in ("graph_hash", "sky"):
            v.text(getattr(self, name), f"layout.{name}")
        v.integer(self.seed, "layout.seed", 0)
        v.integer(self.cousin, "layout.cousin", 0)
        set_ = object.__setattr__
        set_(self, "objects", v.instances(self.objects, "objects", PlacedObject, maximum=MAX_OBJECTS))
        set_(self, "ground", v.instances(self.ground, "ground", PlacedGround, minimum=1, maximum=MAX_REGIONS))
        v.unique((o.id for o in self.objects), "objects")
        v.unique((g.id for g in self.ground), "ground")
        set_(self, "sky_yaw", v.number(self.sky_yaw, "layout.sky_yaw", minimum=-100.0, maximum=100.0))
        if not isinstance(self.hashes, dict):
            raise v.fail("layout.hashes", v.show(self.hashes), "a JSON object of texts")
        for key, value in self.hashes.items():
            v.text(key, "layout.hashes")
            v.text(value, f"layout.hashes.{key}")
        if self.place is not None:
            place = v.items(self.place, "layout.place", minimum=2, maximum=2)
            set_(self, "place", tuple(v.text(name, "layout.place") for name in place))
        v.choice(self.hulls, "layout.hulls", HULL_KINDS)

    def to_json(self) -> dict[str, Any]:
        body: dict[str, Any] = {
            "schema": SCHEMA,
            "id": self.id,
            "graph_id": self.graph_id,
            "graph_hash": self.graph_hash,
            "seed": self.seed,
            "cousin": self.cousin,
            "objects": [o.to_json() for o in self.objects],
            "ground": [g.to_json() for g in self.ground],
            "sky": self.sky,
            "sky_yaw": self.sky_yaw,
            "hashes": dict(self.hashes),
        }
        # Left out where there is none, so that older layouts keep their hashes.
        if self.place is not None:
            body["place"] = list(self.place)
        return {**body, "hulls": self.hulls} if self.hulls else body

    @classmethod
    def from_json(cls, value: Any) -> Self:
        optional = ("place", "hulls")
        names = [f.name for f in dataclasses.fields(cls) if f.name not in optional]
        m = dict(v.mapping(value, "layout", ["schema", *names], optional))
        v.choice(m.pop("schema"), "layout.schema", (SCHEMA,))
        objects = v.items(m.pop("objects"), "objects", maximum=MAX_OBJECTS)
        regions = v.items(m.pop("ground"), "ground", minimum=1, maximum=MAX_REGIONS)
        return cls(
            objects=tuple(PlacedObject.from_json(o, f"objects[{i}]") for i, o in enumerate(objects)),
            ground=tuple(PlacedGround.from_json(g, f"ground[{i}]") for i, g in enumerate(regions)),
            **m,
        )
