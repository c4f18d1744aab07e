"""JSON Schema (draft 2020-12) of the files that people write, made from the datatypes' fields and docstrings.

Fields, whether they are optional, their types and meanings come from the dataclasses; bounds that their `__post_init__`
checks are in `_BOUNDS`. A schema never refuses a file that the datatype loads. The datatype also checks what a schema
cannot express (unique ids, rings that do not cross themselves, finite numbers).
"""

import dataclasses
import inspect
import re
import types
import typing
from typing import Any

from . import ground, scene_graph, scene_layout
from . import validation as v

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_TEXT = {"type": "string", "minLength": 1, "maxLength": v.MAX_TEXT, "pattern": "^[^\\u0000-\\u001f\\ufffe\\uffff]*$"}
_IDENTIFIER = {"pattern": "^[A-Za-z0-9_-]+$"}
_COORDINATE = {"minimum": -ground.LIMIT, "maximum": ground.LIMIT}
_SLOPE = {"minimum": -ground.MAX_SLOPE, "maximum": ground.MAX_SLOPE}
_KIND = {"enum": list(ground.GROUND_KINDS[1:])}
_BYTE = {"minimum": 0, "maximum": 255}
_COUNT = {"minimum": 0}
_DESCRIPTOR = {"minItems": 1, "maxItems": scene_graph.MAX_DESCRIPTOR, "items": _BYTE}
_ANGLE = {"minimum": -100.0, "maximum": 100.0}
_RING = {"minItems": 3, "maxItems": 512, "items": {"items": _COORDINATE}}
_PLANE = {"items": False, "prefixItems": [{"type": "number", **b} for b in (_SLOPE, _SLOPE, _COORDINATE)]}
_OBJECTS, _REGIONS = {"maxItems": scene_graph.MAX_OBJECTS}, {"minItems": 1, "maxItems": scene_graph.MAX_REGIONS}
_GROUND: dict[str, Any] = {"kind": _KIND, "polygon": _RING, "plane": _PLANE}
#: Datatype -> field -> bounds that its `__post_init__` checks in addition to the type.
_BOUNDS: dict[type, dict[str, Any]] = {
    scene_graph.GraphObject: {
        "center": {"items": _COORDINATE},
        "size": {"items": {"minimum": 1e-3, "maximum": 1e4}},
        "yaw": _ANGLE,
        "score": {"minimum": 0, "maximum": 1},
        "descriptor": _DESCRIPTOR,
    },
    scene_graph.GroundRegion: {**_GROUND, "descriptor": _DESCRIPTOR},
    scene_graph.Source: {},
    scene_graph.SceneGraph: {
        "id": _IDENTIFIER,
        "objects": _OBJECTS,
        "ground": _REGIONS,
        "sky_descriptor": _DESCRIPTOR,
        "camera_path": {"maxItems": 100_000, "items": {"items": _COORDINATE}},
    },
    scene_layout.PlacedObject: {
        "position": {"items": _COORDINATE},
        "yaw": _ANGLE,
        "scale": {"items": {"minimum": 0.01, "maximum": 100}},
        "mass": {"exclusiveMinimum": 0, "maximum": 1e9},
        "friction": {"minimum": 0, "maximum": 5},
    },
    scene_layout.PlacedGround: _GROUND,
    scene_layout.SceneLayout: {
        "id": _IDENTIFIER,
        "graph_id": _IDENTIFIER,
        "seed": _COUNT,
        "cousin": _COUNT,
        "objects": _OBJECTS,
        "ground": _REGIONS,
        "sky_yaw": _ANGLE,
        "hulls": {"enum": list(scene_layout.HULL_KINDS)},
    },
}


def graph_schema() -> dict[str, Any]:
    """The schema of `graph.json`."""
    body = _object(scene_graph.SceneGraph)
    descriptor = body["properties"].pop("sky_descriptor")
    sky = {"type": "object", "properties": {"descriptor": descriptor}, "additionalProperties": False}
    body["properties"]["sky"] = {**sky, "description": "what is known of the sky; {} stands for any sky"}
    body["required"].append("sky")
    return _file("urbanverse scene graph", scene_graph.SCHEMA, body)


def layout_schema() -> dict[str, Any]:
    """The schema of `layout.json`."""
    return _file("urbanverse scene layout", scene_layout.SCHEMA, _object(scene_layout.SceneLayout))


SCHEMAS = {"graph": graph_schema, "layout": layout_schema}


def _file(title: str, schema: str, body: dict[str, Any]) -> dict[str, Any]:
    properties = {"schema": {"const": schema}, **body["properties"]}
    return {
        "$schema": _DRAFT,
        "title": title,
        **body,
        "properties": properties,
        "required": ["schema", *body["required"]],
    }


def _object(kind: type) -> dict[str, Any]:
    """The schema of a dataclass."""
    meanings, hints, bounds = _meanings(kind), typing.get_type_hints(kind), _BOUNDS[kind]
    properties, required = {}, []
    for field in dataclasses.fields(kind):
        said = {"description": meanings[field.name]} if field.name in meanings else {}
        properties[field.name] = {**_merged(_of(hints[field.name]), bounds.get(field.name, {})), **said}
        if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            required.append(field.name)
    about = inspect.cleandoc(kind.__doc__ or "").split("\n\n")[0]
    return {
        "type": "object",
        "description": " ".join(about.split()),
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _of(hint: Any) -> dict[str, Any]:
    """The schema of a type."""
    plain: dict[Any, dict[str, Any]] = {
        str: _TEXT,
        float: {"type": "number"},
        int: {"type": "integer"},
        bool: {"type": "boolean"},
    }
    if hint in plain:
        return dict(plain[hint])
    if dataclasses.is_dataclass(hint):
        return _object(typing.cast("type", hint))
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is types.UnionType:  # fields that may be None are left out of the file
        return _of(next(part for part in inner if part is not type(None)))
    if origin is dict:
        return {"type": "object", "additionalProperties": _of(inner[1])}
    if inner[-1] is Ellipsis:
        return {"type": "array", "items": _of(inner[0])}
    return {"type": "array", "items": _of(inner[0]), "minItems": len(inner), "maxItems": len(inner)}


def _merged(base: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """Two schemas in one; `items` are merged too."""
    out = {**base, **more}
    if isinstance(base.get("items"), dict) and isinstance(more.get("items"), dict):
        out["items"] = _merged(base["items"], more["items"])
    return out


def _meanings(kind: type) -> dict[str, str]:
    """Field -> its text in the docstring's `Attributes`; "a, b: ..." describes both, "a: ...; b: ..." each."""
    _, _, text = inspect.cleandoc(kind.__doc__ or "").partition("Attributes:")
    names = "|".join(field.name for field in dataclasses.fields(kind))
    parts = re.split(rf"(?:^ *|; )((?:{names})(?:, (?:{names}))*): ", text, flags=re.MULTILINE)
    found = {}
    for said, meaning in zip(parts[1::2], parts[2::2], strict=True):
        for name in said.split(", "):
            found[name] = " ".join(meaning.split()).rstrip(".;")
    return found
