"""The asset index: every record of every recipe in one Parquet file, whose content a command reproduces exactly."""

import dataclasses
import functools
import json
import os
import pathlib
from collections.abc import Iterable
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, ValidationError, content_hash
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.settings import asset_root, imported_assets

from ..categories import ontology
from ..categories.materials import AIR
from ..categories.physical import composition, sample_meshes
from ..categories.priors import prior
from ..meshes import instances, laying
from ..meshes.mesh_builder import BuiltAsset
from ..meshes.mesh_cache import cached_mesh
from ..meshes.recipe import Recipe, all_recipes, get_recipe
from ..meshes.table_files import read_rows
from ..recipes.building.regional import boards
from .user_store import FILE_RECIPE, INDEX, file_mesh

GRAVITY = 9.81  # m/s^2
# N, force that one person can apply briefly; ISO 11228-2 tabulates 200-300 N of initial force for 90 % of adults.
ONE_PERSON_PUSH = 300.0
LICENCE = "Apache-2.0"
PROVENANCE = "urbanverse_mjx parametric recipe"
REBUILD = "python -m urbanverse_mjx.assets index"
SCHEMA = pa.schema(
    [
        ("uid", pa.string()),
        ("category", pa.list_(pa.string())),
        ("description", pa.string()),
        ("recipe", pa.string()),
        ("params", pa.string()),
        ("extent_xyz", pa.list_(pa.float64())),
        *[(name, pa.float64()) for name in ("length", "width", "height", "volume", "mass")],
        ("materials", pa.list_(pa.string())),
        ("friction_coefficient", pa.float64()),
        ("movable", pa.bool_()),
        ("required_force", pa.float64()),
        ("licence", pa.string()),
        ("provenance", pa.string()),
    ]
)


class AssetIndex:
    """All asset records, sorted by uid."""

    def __init__(self, records: Iterable[AssetRecord]) -> None:
        self.records: tuple[AssetRecord, ...] = tuple(sorted(records, key=lambda r: r.uid))
        self._by_uid = {r.uid: r for r in self.records}
        if len(self._by_uid) != len(self.records):
            raise ValidationError("asset index: found a uid twice, needed every uid once; rename a recipe.")
        self._by_leaf: dict[str, list[AssetRecord]] = {}
        for record in self.records:
            self._by_leaf.setdefault(record.leaf, []).append(record)

    @property
    def leaves(self) -> tuple[str, ...]:
        """The leaves that have at least one record."""
        return tuple(sorted(self._by_leaf))

    def by_leaf(self, leaf: str) -> tuple[AssetRecord, ...]:
        """The records of a leaf, sorted by uid; may be empty.

        Raises:
          UnknownLabelError: the ontology has no such leaf.
        """
        ontology.category_of(leaf)
        return tuple(self._by_leaf.get(leaf, ()))

    def __contains__(self, uid: str) -> bool:
        return uid in self._by_uid

    def get(self, uid: str) -> AssetRecord:
        """The record of a uid.

        Raises:
          ValidationError: the index has no such uid.
        """
        if uid not in self._by_uid:
            raise ValidationError(
                f"asset uid: found {uid!r}, needed one of the index's {len(self.records)} records; "
                "the layout may have been made with another index: materialise its scene graph again."
            )
        return self._by_uid[uid]

    def by_label(self, label: str) -> tuple[AssetRecord, ...]:
        """The records for a label: those of its leaf, otherwise those of its substitute leaf (a sedan for "car"); empty
        if no similar leaf has records.

        Raises:
          UnknownLabelError: no leaf has this name.
        """
        leaf = ontology.match_label(label)
        stand_in = self.stand_in(leaf)
        return self.by_leaf(stand_in) if stand_in else ()

    def stand_in(self, leaf: str) -> str | None:
        """The leaf itself if it has records, otherwise its first substitute with records, or None.

        Raises:
          UnknownLabelError: the ontology has no such leaf.
        """
        ontology.category_of(leaf)
        return next((name for name in (leaf, *ontology.stand_ins().get(leaf, ())) if name in self._by_leaf), None)

    def content_hash(self) -> str:
        """64 hexadecimal digits over all records (1 mm, 1 g)."""
        return self._content_hash

    @functools.cached_property
    def _content_hash(self) -> str:
        return content_hash([r.to_json() for r in self.records])


def uid_of(recipe: Recipe, variant: int) -> str:
    """The uid of a variant's record, which consists of the leaf, the recipe's name and the number."""
    slug = recipe.leaf.replace(" ", "-")
    family = recipe.name.replace("_", "-").replace(".", "-")
    return f"{slug}/{family}/{variant:03d}"


def make_record(recipe: Recipe, variant: int, built: BuiltAsset | None = None) -> AssetRecord:
    """Builds one variant and measures it."""
    built = built or recipe.build(variant)
    x, y, z = (round(float(e), 4) for e in built.mesh.extent)
    volume = max(built.volume, 0.02 * float(np.prod(built.mesh.extent)), 1e-6)
    uid = uid_of(recipe, variant)
    return AssetRecord(
        uid=uid,
        category=ontology.category_of(recipe.leaf),
        description=built.description,
        recipe=recipe.name,
        params={"variant": variant, **built.params},
        extent_xyz=(x, y, z),
        length=max(x, y),
        width=min(x, y),
        height=z,
        volume=round(volume, 6),
        licence=LICENCE,
        provenance=PROVENANCE,
        **(_from_prior if recipe.physics is None else _from_recipe)(recipe, uid, built, volume),
    )


def _from_recipe(recipe: Recipe, _: str, built: BuiltAsset, volume: float) -> dict[str, Any]:
    """Mass and materials of a record by the priors of its recipe."""
    physics = recipe.physics
    assert physics is not None
    mass = built.mass if built.mass is not None else float(np.clip(volume * physics.density, *physics.mass_range))
    force = physics.friction * mass * GRAVITY
    return {
        "mass": round(mass, 3),
        "materials": physics.materials,
        "friction_coefficient": physics.friction,
        "movable": physics.movable and force <= ONE_PERSON_PUSH,
        "required_force": round(force, 1),
    }


def _from_prior(recipe: Recipe, uid: str, built: BuiltAsset, volume: float) -> dict[str, Any]:
    """Mass and materials of a record by the prior of its leaf and the measured mesh."""
    extent = built.mesh.extent[None].astype(np.float64)
    guess = None if built.mass is None else [built.mass]
    values = sample_meshes(recipe.leaf, [uid], extent, np.array([volume]), guess)
    make = prior(recipe.leaf).makes[values.make[0]]
    matter = composition(make, float(values.solid[0]), float(values.volume[0]))
    return {
        "mass": round(float(values.mass[0]), 3),
        "materials": tuple(name for name in matter if name != AIR),
        "friction_coefficient": float(values.friction[0]),
        "movable": bool(values.movable[0]),
        "required_force": round(float(values.force[0]), 1),
    }


def build_mesh(record: AssetRecord) -> AssetMesh:
    """The mesh of a record: built by its recipe, or read from the user's store; for an instance, its scaled and tinted
    base shape; for a lying asset, turned.

    Raises:
      ValidationError: this version of the package has no such recipe, or its mesh differs from the record; or the file
        is missing or differs from the imported one.
    """
    if record.recipe == FILE_RECIPE:
        return file_mesh(record)
    mesh = base_mesh(record)
    if instances.KEY in record.params:
        inner = record.params[instances.KEY]
        mesh = instances.scaled_mesh(mesh, inner["scale"], inner["tint"], record.leaf)
    if laying.KEY in record.params:
        mesh = dataclasses.replace(mesh, vertices=laying.turned(mesh.vertices, record.params[laying.KEY]))
    if np.abs(mesh.extent - np.asarray(record.extent_xyz)).max() > 1e-3:
        raise ValidationError(
            f"asset {record.uid!r}: found a mesh of {np.round(mesh.extent, 3)} m, needed {list(record.extent_xyz)} m "
            f"as indexed; rebuild the index with `{REBUILD}`."
        )
    return mesh


def base_mesh(record: AssetRecord) -> AssetMesh:
    """The mesh that a record's recipe builds, before an instance scales it.

    Raises:
      ValidationError: this version of the package has no such recipe.
    """
    language = boards.spoken() if boards.is_lettered(record.recipe, record.leaf) else ""
    return _build_cached(record.recipe, record.leaf, int(record.params["variant"]), language)


@functools.lru_cache(maxsize=512)
def _build_cached(name: str, leaf: str, variant: int, language: str) -> AssetMesh:
    stamp = f"{language} {boards.stamp()}" if language else ""
    return cached_mesh(name, leaf, variant, lambda: get_recipe(name, leaf).build(variant).mesh, stamp)


def build_index() -> AssetIndex:
    """Every variant of every recipe, built and measured."""
    return AssetIndex(make_record(recipe, k) for recipe in all_recipes() for k in range(recipe.variants))


def save_index(index: AssetIndex, path: str | os.PathLike[str] | None = None) -> pathlib.Path:
    """Writes the index as Parquet (`params` as JSON text)."""
    rows = [r.to_json() for r in index.records]
    for row in rows:
        row["params"] = json.dumps(row["params"], sort_keys=True)
    table = pa.Table.from_pylist(rows, SCHEMA)
    path = pathlib.Path(path or asset_root() / "index.parquet")
    return write_atomically(path, lambda p: pq.write_table(table, p, compression="zstd"))


def load_index(path: str | os.PathLike[str] | None = None) -> AssetIndex:
    """Reads the packaged index or that of a file.

    Raises:
      ValidationError: the file does not exist, or a record is not valid.
    """
    return _load_cached(pathlib.Path(path or asset_root() / "index.parquet"))


def imported_index() -> AssetIndex:
    """The index of the assets that the user imported; may be empty."""
    path = imported_assets() / INDEX
    return AssetIndex(_read_index(path)) if path.is_file() else AssetIndex(())


def full_index() -> AssetIndex:
    """The packaged index and the imported assets as one."""
    return AssetIndex((*load_index().records, *imported_index().records))


@functools.lru_cache(maxsize=4)
def _load_cached(path: pathlib.Path) -> AssetIndex:
    if not path.is_file():
        raise ValidationError(f"{path}: found no such file, needed the asset index; build it with `{REBUILD}`.")
    return AssetIndex(_read_index(path))


def _read_index(path: pathlib.Path) -> list[AssetRecord]:
    cure = f"build it with `{REBUILD}`, or copy it again"
    rows = read_rows(path, "the asset index", cure)
    try:
        return [
            AssetRecord.from_json({**row, "params": json.loads(row["params"])}, f"{path.name}[{i}]")
            for i, row in enumerate(rows)
        ]
    except (KeyError, TypeError, json.JSONDecodeError) as error:
        raise ValidationError(
            f"{path}: found rows that are no records ({error}), needed the asset index; {cure}."
        ) from error
