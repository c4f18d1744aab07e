"""`SceneGraph`: objects and ground of a street, before any asset is chosen. File: `graph.json`."""

import dataclasses
from typing import Any, ClassVar, Self

from . import ground
from . import validation as v
from .json_datatype import JsonDatatype

SCHEMA = "urbanverse.scene_graph/1"
MAX_OBJECTS = 5_000
MAX_REGIONS = 1_000
MAX_DESCRIPTOR = 64
_WITHIN = {"minimum": -ground.LIMIT, "maximum": ground.LIMIT}


def _descriptor(value: Any, where: str) -> tuple[int, ...] | None:
    if value is None:
        return None
    raw = v.items(value, where, minimum=1, maximum=MAX_DESCRIPTOR)
    return tuple(v.integer(x, f"{where}[{i}]", 0, 255) for i, x in enumerate(raw))


def _optional(value: Any, where: str) -> None:
    """An optional field without a value is left out of the file, never null."""
    if "descriptor" in value and value["descriptor"] is None:
        raise v.fail(f"{where}.descriptor", "null", f"1 to {MAX_DESCRIPTOR} whole numbers", "remove the field")


def _with_descriptor(body: dict[str, Any], descriptor: tuple[int, ...] | None) -> dict[str, Any]:
    return body if descriptor is None else {**body, "descriptor": list(descriptor)}


@dataclasses.dataclass(frozen=True)
class GraphObject:
    """One object in the scene.

    Attributes:
      id: unique in the graph.
      label: free text or a leaf of the ontology.
      center: (3,) m, centre of the box in the world frame (z up).
      size: (3,) m, the box's full extent (along the heading, across, up), at least 1 mm.
      yaw: rad, heading counter-clockwise from +x.
      score: confidence in [0, 1].
      descriptor: at most 64 numbers of 8 bits describing its appearance, or None.
    """

    id: str
    label: str
    center: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float
    score: float = 1.0
    descriptor: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        where = f"object {self.id!r}"
        set_ = object.__setattr__
        v.text(self.id, "object.id")
        v.text(self.label, f"{where}.label")
        set_(self, "center", v.vector(self.center, f"{where}.center", 3, minimum=-1e5, maximum=1e5))
        set_(self, "size", v.vector(self.size, f"{where}.size", 3, minimum=1e-3, maximum=1e4))
        set_(self, "yaw", v.number(self.yaw, f"{where}.yaw", minimum=-100.0, maximum=100.0))
        set_(self, "score", v.number(self.score, f"{where}.score", 0.0, 1.0))
        set_(self, "descriptor", _descriptor(self.descriptor, f"{where}.descriptor"))

    def to_json(self) -> dict[str, Any]:
        body = {
            "id": self.id,
            "label": self.label,
            "center": list(self.center),
            "size": list(self.size),
            "yaw": self.yaw,
            "score": self.score,
        }
        return _with_descriptor(body, self.descriptor)

    @staticmethod
    def from_json(value: Any, where: str) -> "GraphObject":
        where = v.named(value, where, "object")
        m = v.mapping(value, where, ("id", "label", "center", "size", "yaw"), ("score", "descriptor"))
        v.text(m["id"], f"{where}.id")
        _optional(m, where)
        return GraphObject(**m)


@dataclasses.dataclass(frozen=True)
class GroundRegion:
    """A piece of ground with a planar top.

    Regions other than paint do not overlap; together they are everything one can stand on.

    Attributes:
      id: unique in the graph.
      kind: one of `ground.GROUND_KINDS` except "none".
      polygon: (n, 2) m, simple ring, stored counter-clockwise.
      plane: (a, b, c) with the top at z = a x + b y + c.
      descriptor: as for objects; chooses the material.
    """

    id: str
    kind: str
    polygon: tuple[tuple[float, float], ...]
    plane: tuple[float, float, float]
    descriptor: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        v.text(self.id, "ground.id")
        where = f"ground {self.id!r}"
        set_ = object.__setattr__
        v.choice(self.kind, f"{where}.kind", ground.GROUND_KINDS[1:])
        set_(self, "polygon", ground.check_polygon(self.polygon, f"{where}.polygon"))
        set_(self, "plane", ground.check_plane(self.plane, f"{where}.plane"))
        set_(self, "descriptor", _descriptor(self.descriptor, f"{where}.descriptor"))

    def to_json(self) -> dict[str, Any]:
        body = {
            "id": self.id,
            "kind": self.kind,
            "polygon": [list(p) for p in self.polygon],
            "plane": list(self.plane),
        }
        return _with_descriptor(body, self.descriptor)

    @staticmethod
    def from_json(value: Any, where: str) -> "GroundRegion":
        where = v.named(value, where, "ground")
        m = v.mapping(value, where, ("id", "kind", "polygon", "plane"), ("descriptor",))
        v.text(m["id"], f"{where}.id")
        _optional(m, where)
        return GroundRegion(**m)


@dataclasses.dataclass(frozen=True)
class Source:
    """Where a graph comes from: the video (or "synthetic"/"hand"), its licence, city and country."""

    video: str
    licence: str
    city: str
    country: str

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            v.text(getattr(self, field.name), f"source.{field.name}")


@dataclasses.dataclass(frozen=True)
class SceneGraph(JsonDatatype):
    """⟨objects, ground, sky⟩ plus where they come from.

    Attributes:
      id: scene id, letters, digits, "_" and "-".
      source: provenance.
      objects: at most 5,000.
      ground: at least one region, at most 1,000.
      sky_descriptor: appearance of the sky or None (any sky).
      camera_path: (n, 4) of x, y, z (m), yaw (rad): the camera's trajectory; may be empty.
    """

    KIND: ClassVar[str] = "scene graph"

    id: str
    source: Source
    objects: tuple[GraphObject, ...]
    ground: tuple[GroundRegion, ...]
    sky_descriptor: tuple[int, ...] | None = None
    camera_path: tuple[tuple[float, float, float, float], ...] = ()

    def __post_init__(self) -> None:
        v.identifier(self.id, "scene graph.id")
        set_ = object.__setattr__
        if not isinstance(self.source, Source):
            raise v.fail("source", v.show(self.source), "a Source")
        set_(self, "objects", v.instances(self.objects, "objects", GraphObject, maximum=MAX_OBJECTS))
        set_(self, "ground", v.instances(self.ground, "ground", GroundRegion, minimum=1, maximum=MAX_REGIONS))
        v.unique((o.id for o in self.objects), "objects")
        v.unique((g.id for g in self.ground), "ground")
        set_(self, "sky_descriptor", _descriptor(self.sky_descriptor, "sky.descriptor"))
        path = v.items(self.camera_path, "camera_path", maximum=100_000)
        set_(self, "camera_path", tuple(v.vector(p, f"camera_path[{i}]", 4, **_WITHIN) for i, p in enumerate(path)))

    def to_json(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "id": self.id,
            "source": dataclasses.asdict(self.source),
            "objects": [o.to_json() for o in self.objects],
            "ground": [g.to_json() for g in self.ground],
            "sky": _with_descriptor({}, self.sky_descriptor),
            "camera_path": [list(p) for p in self.camera_path],
        }

    @classmethod
    def from_json(cls, value: Any) -> Self:
        m = v.mapping(value, "scene graph", ("schema", "id", "source", "objects", "ground", "sky"), ("camera_path",))
        v.choice(m["schema"], "scene graph.schema", (SCHEMA,))
        source = v.mapping(m["source"], "source", ("video", "licence", "city", "country"))
        sky = v.mapping(m["sky"], "sky", (), ("descriptor",))
        _optional(sky, "sky")
        objects = v.items(m["objects"], "objects", maximum=MAX_OBJECTS)
        regions = v.items(m["ground"], "ground", minimum=1, maximum=MAX_REGIONS)
        return cls(
            id=m["id"],
            source=Source(**source),
            objects=tuple(GraphObject.from_json(o, f"objects[{i}]") for i, o in enumerate(objects)),
            ground=tuple(GroundRegion.from_json(g, f"ground[{i}]") for i, g in enumerate(regions)),
            sky_descriptor=sky.get("descriptor"),
            camera_path=m.get("camera_path", ()),
        )
