"""Annotation of an imported asset: from its own annotation file, a vision model, or the prior of its leaf.

The official annotation JSON of UrbanVerse-100K is read under its own field names and units; fields that this package
does not use are kept. The leaf's prior and the measured mesh supply missing values.
"""

import dataclasses
import pathlib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from urbanverse_mjx.datatypes import AssetRecord, ValidationError
from urbanverse_mjx.datatypes import validation as v

from ..categories import ontology
from ..categories.materials import AIR, FINISHES, HARDNESS, material
from ..categories.physical import GRAVITY, ONE_PERSON_PUSH, ROLLING_RESISTANCE, composition, sample_meshes
from ..categories.priors import COMPOSITIONS, TRAVERSABILITY, prior
from ..records.catalogue import SCHEMA
from ..records.user_store import FILE_RECIPE
from .screening import RefusedFileError, inside

Check = Callable[[Any, str], Any]


def _positive(value: Any, where: str) -> float:
    return v.number(value, where, above=0.0, maximum=1e7)


def _share(value: Any, where: str) -> float:
    return v.number(value, where, 0.0, 1.0)


def _words(value: Any, where: str) -> list[str]:
    return [v.text(word, where) for word in v.items(value, where, maximum=64)]


def _shares(value: Any, where: str) -> list[float]:
    shares = [_share(x, where) for x in v.items(value, where, maximum=64)]
    if shares and abs(sum(shares) - 1.0) > 0.05:
        raise v.fail(where, f"shares that sum to {sum(shares):.3g}", "1")
    return shares


def _one_of(options: Sequence[str]) -> Check:
    return lambda value, where: v.choice(value, where, options)


def _stiffness(value: Any, where: str) -> float:
    """Checks a stiffness in MPa (the unit of the official schema; the toolkit's table says Pa); the upper limit is that
    of diamond, 1.2e6 MPa."""
    stiffness = v.number(value, where, above=0.0, maximum=2e12)
    return stiffness / 1e6 if stiffness > 1.3e6 else stiffness


#: Official field -> check. Other fields are kept unchecked.
FIELDS: Mapping[str, Check] = {
    **dict.fromkeys(("category", "description", "description_long", "uid", "filename"), v.text),
    **{f"description_view_{k}": v.text for k in range(4)},
    **dict.fromkeys(("height", "max_dimension", "length", "width", "mass"), _positive),
    **dict.fromkeys(("materials", "affordances", "interactive_parts", "traversable_by", "colors"), _words),
    **dict.fromkeys(("materials_composition", "colors_composition"), _shares),
    **dict.fromkeys(("receptacle", "movable", "walkable", "enterable", "support_surface"), v.boolean),
    "frontView": lambda value, where: v.integer(value, where, 0, 3),
    "quality": lambda value, where: v.number(value, where, 0.0, 10.0),
    "required_force": lambda value, where: v.number(value, where, 0.0, 1e9),
    "traversability": _one_of(TRAVERSABILITY),
    "surface_hardness": _one_of(HARDNESS),
    "surface_finish": _one_of(FINISHES),
    **dict.fromkeys(("surface_roughness", "reflectivity", "bounciness"), _share),
    "index_of_refraction": lambda value, where: v.number(value, where, 1.0, 4.0),
    "youngs_modulus": _stiffness,
    "friction_coefficient": lambda value, where: v.number(value, where, 0.0, 5.0),
    "recommended_clearance": lambda value, where: v.number(value, where, 0.0, 100.0),
    "asset_composition_type": _one_of(COMPOSITIONS),
}
SIZES = ("length", "width", "height")


def checked(raw: Mapping[str, Any], where: str) -> tuple[dict[str, Any], list[str]]:
    """The valid fields (unknown ones unchanged), and a sentence for each invalid one."""
    fields, complaints = {}, []
    for name, value in raw.items():
        check = FIELDS.get(name)
        try:
            fields[name] = value if check is None else check(value, f"{where} {name}")
        except ValidationError as error:
            complaints.append(str(error))
    return fields, complaints


def official_fields(mesh_path: pathlib.Path, folder: pathlib.Path, extras: Mapping[str, Any]) -> dict[str, Any]:
    """The official annotation beside a mesh file (`name.json`), or inside it (`asset.extras`); empty without one.

    Raises:
      RefusedFileError: an annotation with a field that is not valid.
    """
    path = mesh_path.with_suffix(".json")
    if path.is_file():
        inside(folder, path.parent, f"./{path.name}")
        try:
            raw = v.read_json(path, "annotation")
        except ValidationError as error:
            raise RefusedFileError("bad annotation", str(error)) from error
        if not isinstance(raw, dict):
            raise RefusedFileError("bad annotation", f"has {path.name}, which is no JSON object")
    elif isinstance(extras.get("category"), str):
        raw = dict(extras)
    else:
        return {}
    fields, complaints = checked(raw, path.name)
    if complaints:
        raise RefusedFileError("bad annotation", complaints[0])
    return fields


def leaf_in(texts: Sequence[str]) -> str | None:
    """The leaf of the first name that denotes one; None if no name does."""
    for text in texts:
        words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text)
        for piece in (*re.split(r"--|__", words), words):
            phrase = " ".join(w for w in re.split(r"[\s_\-.]+", piece) if w.isalpha() and w.isascii() and len(w) > 1)
            try:
                return ontology.guess_leaf(phrase or "-")
            except ontology.UnknownLabelError:
                continue
    return None


_CC = re.compile(r"(?:^|cc[\s-]*|licenses/)(by(?:[\s-]*(?:nc|sa|nd))*)\b[\s/-]*v?(\d\.\d)?", re.IGNORECASE)
_CC0 = re.compile(r"\bcc[\s-]?0\b|public\s?domain", re.IGNORECASE)
_OTHERS = ("Apache-2.0", "MIT", "BSD-3-Clause", "ODC-BY-1.0", "GPL-3.0")
_FORBIDDING = re.compile(r"all rights reserved|do not (?:re)?distribute|proprietary", re.IGNORECASE)


def known_licence(text: str) -> str | None:
    """The common name of the licence that a text mentions ("by-nc", "CC BY 4.0", its address); None if unknown.

    Creative Commons without a version means 4.0, as in Objaverse's short names.
    """
    if _CC0.search(text):
        return "CC0-1.0"
    if found := _CC.search(text.strip()):
        return "-".join(["CC", *re.findall(r"by|nc|sa|nd", found[1].lower()), found[2] or "4.0"]).upper()
    return next((name for name in _OTHERS if re.search(rf"\b{re.escape(name)}\b", text, re.IGNORECASE)), None)


def licence_of(fields: Mapping[str, Any], extras: Mapping[str, Any], copyright_text: str, default: str | None) -> str:
    """The licence of an asset: that of its annotation, of its file, or the user's default, in this order.

    A copyright notice counts only if it names a licence.

    Raises:
      RefusedFileError: no licence is stated, or it forbids use.
    """
    info = fields.get("license_info")
    stated = [info.get("license") if isinstance(info, dict) else info]
    stated += [fields.get("license"), extras.get("license"), extras.get("licence")]
    texts = [s.strip() for s in stated if isinstance(s, str) and s.strip()]
    texts += [copyright_text] if known_licence(copyright_text) else []
    for text in (*texts[:1], copyright_text):
        if _FORBIDDING.search(text):
            raise RefusedFileError("no licence", f"forbids its use ({text[:80]!r})")
    texts += [default] if default else []
    if not texts:
        raise RefusedFileError("no licence", "states no licence; name the one you have with --licence")
    return known_licence(texts[0]) or " ".join(texts[0].split())[:200]


@dataclasses.dataclass(frozen=True)
class Measured:
    """Measurements of the import: (3,) extent in m in the asset frame, and the volume inside its surface, m^3."""

    extent: tuple[float, float, float]
    volume: float


def describe(
    leaf: str, uid: str, measured: Measured, fields: Mapping[str, Any], licence: str, provenance: str, params: dict
) -> tuple[AssetRecord, dict[str, Any]]:
    """(record, complete annotation under the official names) from annotated values and, for missing ones, the leaf's
    prior.

    Sizes are always the measured ones. If a mass is annotated but no force, the force is computed from the mass.
    """
    row = prior(leaf)
    extent = np.array([measured.extent])
    guess = [fields["mass"]] if "mass" in fields else None
    values = sample_meshes(leaf, [uid], extent, np.array([measured.volume]), guess)
    make = row.makes[values.make[0]]
    shares = composition(make, float(values.solid[0]), float(values.volume[0]))
    surface = material(make.surface)
    x, y, z = measured.extent
    mass = float(fields.get("mass", values.mass[0]))
    friction = float(fields.get("friction_coefficient", values.friction[0]))
    force = (ROLLING_RESISTANCE if row.rest == "rolls" else friction) * mass * GRAVITY
    top, middle, _ = ontology.category_of(leaf)
    usual: dict[str, Any] = {
        "description": f"{leaf}, {max(x, y):.2f} m long, {min(x, y):.2f} m wide and {z:.2f} m high",
        "materials": list(shares),
        "materials_composition": [round(s, 6) for s in shares.values()],
        "required_force": force,
        "movable": row.rest not in ("fixed", "hangs"),
        "surface_hardness": surface.hardness,
        "surface_finish": surface.finish,
        "surface_roughness": surface.roughness,
        "annotation_info": {"text_llm": None, "vision_llm": None, "source": "urbanverse_mjx priors"},
    }
    for name in ("reflectivity", "index_of_refraction", "youngs_modulus", "bounciness"):
        usual[name] = getattr(surface, name)
    for name in ("receptacle", "walkable", "enterable", "support_surface", "traversability"):
        usual[name] = getattr(row, name)
    for name in ("affordances", "interactive_parts"):
        usual[name] = list(getattr(row, name))
    usual["asset_composition_type"] = row.composition_type
    whole = usual | dict(fields)
    whole |= {"uid": uid, "class_name_l1": top, "class_name_l2": middle, "class_name_l3": leaf, "category": leaf}
    whole |= {"length": max(x, y), "width": min(x, y), "height": z, "max_dimension": max(x, y, z), "frontView": 0}
    whole |= {"mass": mass, "friction_coefficient": friction, "extent_xyz": [x, y, z], "volume": measured.volume}
    info = whole.get("license_info")
    whole["license_info"] = {**(info if isinstance(info, dict) else {}), "license": licence}
    whole |= {"license": licence, "provenance": provenance}
    force = float(whole["required_force"])
    record = AssetRecord(
        uid=uid,
        category=(top, middle, leaf),
        description=str(whole["description"]),
        recipe=FILE_RECIPE,
        params=params,
        extent_xyz=measured.extent,
        length=max(x, y),
        width=min(x, y),
        height=z,
        volume=round(measured.volume, 6),
        mass=round(mass, 3),
        materials=tuple(name for name in whole["materials"] if name != AIR) or (make.surface,),
        friction_coefficient=friction,
        movable=bool(whole["movable"]) and force <= ONE_PERSON_PUSH,
        required_force=round(force, 1),
        licence=licence,
        provenance=provenance,
    )
    return record, whole


def catalogue_row(record: AssetRecord, whole: Mapping[str, Any]) -> dict[str, Any]:
    """The asset's row in a table with the columns of `assets.records.catalogue`; None for unknown values."""
    known = dict(whole) | {"recipe": record.recipe, "movable": record.movable}
    return {name: known.get(name) for name in SCHEMA.names if name != "params"}
