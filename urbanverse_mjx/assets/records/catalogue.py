"""Makes the catalogue of 102,444 records: as many per leaf as UrbanVerse-100K has, with the official field names in SI
units.

The first records of a leaf are the base shapes that its recipes build; the others are instances of them with boxes
drawn from the leaf's prior (`instances`). The records of a leaf without base shapes are drawn from the prior only:
sizes, materials, mass, force and affordances are present and consistent, `recipe` is null, and fields that need a mesh
are empty. All physical fields are computed from the measured box and volume and the leaf's row, so that they are
consistent; the masses of the base index (`AssetIndex`, used in streets) do not change. As in `AssetRecord`, `movable`
means that one person can move the object.

A record's uid consists of its leaf and number. A record depends only on the base shapes of its leaf.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from urbanverse_mjx.datatypes import AssetRecord, ValidationError

from ..categories import ontology
from ..categories.materials import AIR, material, materials
from ..categories.physical import (
    GRAVITY,
    MASS_STEP,
    ONE_PERSON_PUSH,
    ROLLING_RESISTANCE,
    Measured,
    Physical,
    composition,
    sample_meshes,
    sample_uids,
)
from ..categories.priors import Prior, prior
from ..meshes.base_shapes import shape_of
from ..meshes.instances import instance_params, place
from ..meshes.tints import tints
from .index import LICENCE, PROVENANCE, AssetIndex
from .record_texts import Shown, attributes, descriptions, main_colors

PRIOR_PROVENANCE = "urbanverse_mjx priors (sizes and matter drawn from the leaf's row; no mesh)"
INSTANCE_PROVENANCE = f"{PROVENANCE}, scaled to a box drawn from the leaf's prior and tinted"
_TEXT, _TEXTS, _REAL, _REALS = pa.string(), pa.list_(pa.string()), pa.float64(), pa.list_(pa.float64())
SCHEMA = pa.schema(
    [
        *[(name, _TEXT) for name in ("uid", "class_name_l1", "class_name_l2", "class_name_l3", "category")],
        ("description", _TEXT),
        *[(name, _REAL) for name in ("height", "max_dimension", "length", "width", "volume", "mass")],
        ("extent_xyz", _REALS),
        ("materials", _TEXTS),
        ("materials_composition", _REALS),
        ("colors", _TEXTS),
        ("colors_composition", _REALS),
        *[(name, pa.bool_()) for name in ("receptacle", "movable", "walkable", "enterable", "support_surface")],
        ("required_force", _REAL),
        *[(name, _TEXTS) for name in ("affordances", "interactive_parts", "traversable_by")],
        *[(name, _TEXT) for name in ("traversability", "surface_hardness", "surface_finish")],
        *[(name, _REAL) for name in ("surface_roughness", "reflectivity", "index_of_refraction", "youngs_modulus")],
        *[(name, _REAL) for name in ("friction_coefficient", "bounciness", "recommended_clearance")],
        ("asset_composition_type", _TEXT),
        ("frontView", pa.int8()),
        ("recipe", _TEXT),
        ("params", _TEXT),
        ("attributes", _TEXT),
        ("license", _TEXT),
        ("provenance", _TEXT),
    ]
)
# The clearance of the official example (a 6.1 m long car) is 1.5 m; the least one is for objects like bollards.
MIN_CLEARANCE, CLEARANCE_PER_METRE, MAX_CLEARANCE = 0.2, 0.25, 1.5
MAX_MAKE_DIFFERENCE = 0.05  # difference of the shared materials below which two makes fit equally well
# Materials that are treated as equal in the search for a base shape's make.
_KIN = {
    "green wood": "wood",
    "hardwood": "wood",
    "PVC": "plastic",
    "ABS": "plastic",
    "clay": "terracotta",
    "metal": "steel",
}
PERSON_CLEARANCE = 0.5  # m, distance between people that pass each other


def leaf_counts() -> dict[str, int]:
    """leaf -> number of records, 102,444 in all, in the ontology's order."""
    return {leaf: n for mids in ontology.tree().values() for leaves in mids.values() for leaf, n in leaves.items()}


def leaf_uid(leaf: str, index: int) -> str:
    """uid of a leaf's record whose box is drawn from the leaf's prior."""
    return f"{leaf.replace(' ', '-')}/prior/{index:05d}"


def build_leaf(leaf: str, index: AssetIndex, count: int | None = None) -> pa.Table:
    """The table of one leaf: the recipes' records first, then those drawn from the prior.

    Args:
      leaf: exact leaf name.
      index: where the records with meshes come from.
      count: how many records; None for as many as UrbanVerse-100K has.

    Raises:
      UnknownLabelError: no such leaf.
      ValidationError: the count is below 1.
    """
    row = prior(leaf)
    count = leaf_counts()[leaf] if count is None else count
    if count < 1:
        raise ValidationError(f"records of {leaf!r}: found {count}, needed at least 1.")
    bases = index.by_leaf(leaf)
    uids = [leaf_uid(leaf, k) for k in range(min(len(bases), count), count)]
    if not bases:
        return _table(row, uids, sample_uids(leaf, uids), [])
    shapes = [shape_of(r) for r in bases]
    extent, volume = np.array([r.extent_xyz for r in bases]), np.array([s.volume for s in shapes])
    names = [r.uid for r in bases]
    values = sample_uids(leaf, names, Measured(extent, volume, _makes_of(row, bases, extent, volume)))
    shown = [Shown(r, s, None, None) for r, s in zip(bases, shapes, strict=True)]
    tables = [_table(row, names, values, shown).slice(0, count)]
    if uids:
        placed = place(leaf, uids, np.array([s.extent for s in shapes]))
        volume = np.array([s.volume for s in shapes])[placed.base] * placed.scale.prod(1)
        # Instances have the materials of their base shape's recipe; if it defines none, materials are drawn for each
        # instance.
        known = np.array([s.make_known for s in shapes])[placed.base]
        make = np.where(known, values.make[placed.base], sample_uids(leaf, uids).make)
        measured = Measured(placed.extent, volume, make)
        drawn = zip(placed.base, placed.scale, tints(uids), strict=True)
        shown = [Shown(bases[b], shapes[b], scale, tint) for b, scale, tint in drawn]
        tables.append(_table(row, uids, sample_uids(leaf, uids, measured), shown))
    return pa.concat_tables(tables)


def _makes_of(row: Prior, bases: Sequence[AssetRecord], extent: Any, volume: Any) -> NDArray[np.int64]:
    """The make of each base shape: the one that shares most of its materials, weighted by their order; of several, the
    one whose mass is nearest to the recipe's."""
    by_mass = sample_meshes(row.leaf, [r.uid for r in bases], extent, volume, [r.mass for r in bases]).make
    shared = np.array([[_shared(make.shares, r.materials) for make in row.makes] for r in bases])
    alike = shared >= shared.max(1, keepdims=True) - MAX_MAKE_DIFFERENCE
    return np.where(alike[np.arange(len(bases)), by_mass], by_mass, shared.argmax(1))


def _shared(shares: Mapping[str, float], materials: Sequence[str]) -> float:
    """Share of a make that the materials cover; the k-th material has the weight 1 / k."""
    found = 0.0
    for rank, name in enumerate(materials, 1):
        kin = _KIN.get(name, name)
        found += sum(share for other, share in shares.items() if _KIN.get(other, other) == kin) / rank
    return found


def build_catalogue(index: AssetIndex, progress: Callable[[Sequence[str]], Iterator[str]] = iter) -> pa.Table:
    """The table of all leaves.

    Args:
      index: where the records with meshes come from.
      progress: wraps the list of leaves, e.g. in a progress bar.
    """
    return pa.concat_tables(build_leaf(leaf, index) for leaf in progress(list(leaf_counts())))


def disagreements(table: pa.Table) -> dict[str, str]:
    """uid -> fault, for every record whose values contradict each other; empty for a consistent table.

    Checked: length, width, height and max_dimension against the box; shares that sum to 1; mass against volume, shares
    and densities; required_force against mass, friction (or rolling) and gravity; movable against the force.
    """
    names = ("uid", "category", "extent_xyz", "length", "width", "height", "max_dimension", "volume", "mass")
    names += ("materials", "materials_composition", "friction_coefficient", "required_force", "movable")
    columns = [table[name].to_pylist() for name in names]
    densities = {name: m.density for name, m in materials().items()} | {AIR: 0.0}
    found = {}
    for cells in zip(*columns, strict=True):
        row: dict[str, Any] = dict(zip(names, cells, strict=True))
        if wrong := _contradiction(row, densities):
            found[row["uid"]] = wrong
    return found


def _contradiction(row: Mapping[str, Any], densities: Mapping[str, float]) -> str | None:
    x, y, z = row["extent_xyz"]
    shares = row["materials_composition"]
    leaf = prior(row["category"])
    if (row["length"], row["width"], row["height"], row["max_dimension"]) != (max(x, y), min(x, y), z, max(x, y, z)):
        return "sizes are not those of the box"
    if abs(sum(shares) - 1.0) > 1e-9 or min(shares) < 0.0 or len(shares) != len(row["materials"]):
        return "materials_composition does not sum to 1"
    matter = sum(share * densities[name] for name, share in zip(row["materials"], shares, strict=True))
    if abs(matter * row["volume"] - row["mass"]) > 1e-5 * row["mass"] + MASS_STEP:
        return "mass is not volume times the density of the materials"
    coefficient = ROLLING_RESISTANCE if leaf.rest == "rolls" else row["friction_coefficient"]
    if abs(coefficient * row["mass"] * GRAVITY - row["required_force"]) > 1e-5 * row["required_force"] + 1e-5:
        return "required_force is not the coefficient times the weight"
    if row["movable"] != (leaf.rest not in ("fixed", "hangs") and row["required_force"] <= ONE_PERSON_PUSH):
        return "movable contradicts required_force"
    return None


def catalogue_hash(table: pa.Table) -> str:
    """Hash of 64 hexadecimal digits over the table's content: names and texts unchanged, numbers to five digits."""
    digest = hashlib.sha256(json.dumps(table.column_names).encode())
    for name in table.column_names:
        digest.update(f"\0{name}\0".encode())
        column = table[name].combine_chunks()
        if pa.types.is_list(column.type):
            digest.update(np.ascontiguousarray(column.offsets, dtype="<i8").tobytes())
            column = column.values
        if pa.types.is_floating(column.type):
            digest.update("\0".join(f"{x:.5g}" for x in column.to_pylist()).encode())
        else:
            digest.update("\0".join(map(str, column.to_pylist())).encode())
    return digest.hexdigest()


def _table(row: Prior, uids: Sequence[str], values: Physical, shown: Sequence[Shown]) -> pa.Table:
    top, middle, leaf = ontology.category_of(row.leaf)
    count = len(uids)
    makes = [row.makes[k] for k in values.make]
    surfaces = [material(make.surface) for make in makes]
    shares = [composition(m, s, v) for m, s, v in zip(makes, values.solid, values.volume, strict=True)]
    none = [None] * count
    colors, color_shares = main_colors(row.leaf, shown) if shown else (none, none)
    columns: dict[str, Any] = {
        "uid": uids,
        "class_name_l1": [top] * count,
        "class_name_l2": [middle] * count,
        "class_name_l3": [leaf] * count,
        "category": [leaf] * count,
        "description": [
            shown[k].record.description if shown and shown[k].scale is None else text
            for k, text in enumerate(descriptions(row, makes, values, colors))
        ],
        "extent_xyz": list(values.extent),
        "max_dimension": values.extent.max(1),
        "materials": [list(s) for s in shares],
        "materials_composition": [list(s.values()) for s in shares],
        "movable": values.movable,
        "required_force": np.round(values.force, 6),
        "friction_coefficient": values.friction,
        "recommended_clearance": _clearance(row, values),
        "surface_hardness": [s.hardness for s in surfaces],
        "surface_finish": [s.finish for s in surfaces],
        "surface_roughness": [s.roughness for s in surfaces],
        "frontView": [0] * count,  # every front faces +x, which view 0 shows
        "colors": colors,
        "colors_composition": color_shares,
        "recipe": [s.record.recipe for s in shown] or none,
        "params": [_params(s) for s in shown] or none,
        "attributes": [attributes(s.record) for s in shown] or none,
        "license": [LICENCE] * count,
        "provenance": [_provenance(s) for s in shown] or [PRIOR_PROVENANCE] * count,
    }
    columns |= {name: getattr(values, name) for name in ("height", "length", "width", "volume", "mass")}
    for name in ("reflectivity", "index_of_refraction", "youngs_modulus", "bounciness"):
        columns[name] = [getattr(s, name) for s in surfaces]
    for name in ("receptacle", "walkable", "enterable", "support_surface", "traversability"):
        columns[name] = [getattr(row, name)] * count
    for name in ("affordances", "interactive_parts"):
        columns[name] = [list(getattr(row, name))] * count
    columns["traversable_by"] = [_traversable_by(row)] * count
    columns["asset_composition_type"] = [row.composition_type] * count
    return pa.table({name: pa.array(columns[name], SCHEMA.field(name).type) for name in SCHEMA.names})


def _clearance(row: Prior, values: Physical) -> Any:
    """m, recommended clearance: grows with the object's size, larger for people and animals, 0 for passable objects."""
    if row.traversability == "pass through":
        return np.zeros(len(values.length))
    least = PERSON_CLEARANCE if row.rest == "alive" else MIN_CLEARANCE
    return np.round(np.minimum(least + CLEARANCE_PER_METRE * values.length, MAX_CLEARANCE), 2)


def _traversable_by(row: Prior) -> list[str]:
    """Agents that can pass over or through an object: people over walkable and through yielding objects, wheels over
    flat ground."""
    who = []
    if row.walkable or row.traversability != "obstacle":
        who += ["pedestrian", "legged robot"]
    if row.walkable and row.traversability == "pass through":
        who += ["wheeled robot", "wheelchair", "bicycle"]
    if row.walkable and "drivable" in row.affordances:
        who += ["car"]
    return who


def _params(shown: Shown) -> str:
    params = shown.record.params
    if shown.scale is not None and shown.tint is not None:
        params = instance_params(int(params["variant"]), shown.record.uid, shown.scale.tolist(), shown.tint.tolist())
    return json.dumps(params, sort_keys=True)


def _provenance(shown: Shown) -> str:
    return PROVENANCE if shown.scale is None else INSTANCE_PROVENANCE
