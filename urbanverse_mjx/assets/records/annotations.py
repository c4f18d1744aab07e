"""The annotation of a record in the official JSON format, and the meaning of its fields."""

import functools
import json
from collections.abc import Mapping
from typing import Any

from urbanverse_mjx import __version__
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.settings import asset_root

from ..categories import ontology
from ..categories.materials import read_rows

_COLUMNS = ("field", "unit", "meaning", "origin")
#: Sides of views 0 to 3: name, and the axis of the box across the view.
_VIEWS = (("front", 1), ("left side", 0), ("back", 1), ("right side", 0))


@functools.cache
def fields() -> Mapping[str, Mapping[str, str]]:
    """field -> unit, meaning and origin, of `assets_index/fields.csv`."""
    return {row["field"]: row for _, row in read_rows(asset_root() / "fields.csv", _COLUMNS)}


def explain(field: str) -> str:
    """Meaning, unit and source of a field.

    Raises:
      ValidationError: no such field.
    """
    key = "attribute_*" if field.startswith("attribute_") else field
    if key not in fields():
        raise ValidationError(f"annotation: found {field!r}, needed one of {', '.join(fields())}.")
    row = fields()[key]
    unit = f" ({row['unit']})" if row["unit"] else ""
    return f"{field}{unit}: {row['meaning']}. From: {row['origin']}."


def annotation(row: Mapping[str, Any]) -> dict[str, Any]:
    """The annotation of a row of the catalogue, without unknown fields."""
    known = {k: v for k, v in row.items() if v is not None and k not in ("attributes", "params", "license")}
    attributes = json.loads(row["attributes"]) if row["attributes"] else {}
    return {
        **known,
        **dict(zip(("class_id_l1", "class_id_l2", "class_id_l3"), _class_ids(row["category"]), strict=True)),
        "description_long": _long(row),
        **(_views(row) if row["colors"] else {}),
        **attributes,
        "filename": row["uid"].replace("/", "--") + ".glb",
        "license_info": {"license": row["license"], "provenance": row["provenance"]},
        "annotation_info": {"annotator": f"urbanverse_mjx {__version__}", "vision_llm": None, "text_llm": None},
    }


@functools.cache
def _ids() -> tuple[dict[str, int], ...]:
    levels = zip(*ontology.categories().values(), strict=True)
    return tuple({name: k for k, name in enumerate(dict.fromkeys(level))} for level in levels)


def _class_ids(leaf: str) -> tuple[int, ...]:
    return tuple(ids[name] for ids, name in zip(_ids(), ontology.category_of(leaf), strict=True))


def _long(row: Mapping[str, Any]) -> str:
    made = ", ".join(name for name in row["materials"] if name != "air")
    text = [f"{row['description'][:1].upper()}{row['description'][1:]}.", f"Made of {made}."]
    if row["affordances"]:
        text.append(f"It is {', '.join(row['affordances'])}.")
    if row["interactive_parts"]:
        text.append(f"One can use its {', '.join(row['interactive_parts'])}.")
    force = f"{row['required_force']:.3g} N move it" if row["movable"] else "One person cannot move it"
    text.append(f"{force}; for passers-by it is {_passing(row['traversability'])}.")
    return " ".join(text)


def _passing(traversability: str) -> str:
    return {"obstacle": "an obstacle"}.get(traversability, f"something to {traversability}")


def _views(row: Mapping[str, Any]) -> dict[str, str]:
    texts = {}
    for number, (side, axis) in enumerate(_VIEWS):
        size = f"{row['extent_xyz'][axis]:.3g} m across and {row['height']:.3g} m high"
        texts[f"description_view_{number}"] = f"the {side} of a {row['category']}, {', '.join(row['colors'])}, {size}"
    return texts
