"""Stores the catalogue as a Parquet file in the cache, which `urbanverse assets build` writes.

The file's name is a hash of its inputs (the tables of `assets_index/` and the version of the code), so an outdated file
is never used.
"""

import functools
import hashlib
import json
import os
import pathlib
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from rich.console import Console
from rich.progress import track

from urbanverse_mjx import versions
from urbanverse_mjx.datatypes import AssetRecord, ValidationError
from urbanverse_mjx.datatypes.array_file import discard
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.settings import asset_root, cache_dir, imported_assets

from .catalogue import SCHEMA, build_catalogue, build_leaf, catalogue_hash
from .index import load_index
from .user_store import CATALOGUE

BUILD_COMMAND = "urbanverse assets build"
CONTENT_FILE = "catalogue.json"
_DATA = ("index.parquet", "shapes.parquet", "priors.csv", "materials.csv", "ontology.json")
_CONTENT = b"urbanverse.content"  # key of the file's metadata that holds the content's hash


@functools.cache
def inputs_key() -> str:
    """Hash of 16 hexadecimal digits over the inputs of the catalogue: its tables and the version of its code."""
    digest = hashlib.sha256(json.dumps(versions.of("catalogue")).encode())
    for path in (asset_root() / name for name in _DATA):
        digest.update(f"{path.name}\0".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def store_path() -> pathlib.Path:
    """Path of the catalogue for the current tables and code."""
    return cache_dir("assets", f"catalogue-{inputs_key()}.parquet")


def build_store(path: str | os.PathLike[str] | None = None, show_progress: bool = True) -> pathlib.Path:
    """Makes all records and writes them atomically."""
    console = Console(file=sys.stderr)

    def progress(leaves: Sequence[str]) -> Iterator[str]:
        return iter(track(leaves, "asset records", console=console, disable=not show_progress))

    table = build_catalogue(load_index(), progress)
    table = table.replace_schema_metadata({_CONTENT: catalogue_hash(table).encode()})
    # One row group without dictionary, because the whole table is read at once.
    options = {"compression": "zstd", "row_group_size": table.num_rows, "write_page_checksum": True}
    return write_atomically(path or store_path(), lambda p: pq.write_table(table, p, **options))


def load_store(path: str | os.PathLike[str] | None = None) -> pa.Table:
    """Loads the table of all records; makes it first if the cache has none. A damaged file is renamed.

    Raises:
      ValidationError: the file of a given path does not exist or is not a catalogue.
    """
    if path is not None:
        return _load_cached(pathlib.Path(path))
    try:
        return _load_cached(ensure_store())
    except ValidationError as error:
        discard(store_path(), str(error))
    return _load_cached(ensure_store())


def load_joined_store() -> pa.Table:
    """Loads the table of all records, followed by the assets that the user imported.

    Raises:
      ValidationError: the imported table is damaged.
    """
    table, path = load_store(), imported_assets() / CATALOGUE
    if not path.is_file():
        return table
    body = path.read_bytes()
    try:
        imported = pq.read_table(pa.BufferReader(body)).select(SCHEMA.names).cast(SCHEMA)
    except (pa.ArrowInvalid, KeyError, OSError) as error:
        raise ValidationError(
            f"{path}: found no table of imported assets ({str(error).splitlines()[0][:80]}), needed one; import an "
            "asset again with `urbanverse assets import`."
        ) from error
    if not imported.num_rows:
        return table
    rows = json.dumps(imported.to_pylist(), sort_keys=True)
    content = hashlib.sha256(f"{recorded_content(table)} {rows}".encode()).hexdigest()
    joined = pa.concat_tables([table.replace_schema_metadata(None), imported.replace_schema_metadata(None)])
    return joined.replace_schema_metadata({_CONTENT: content.encode()})


def ensure_store() -> pathlib.Path:
    """Makes the file of the current catalogue if there is none; call this before several processes load it."""
    path = store_path()
    return path if path.is_file() else build_store(show_progress=sys.stderr.isatty())


@functools.lru_cache(maxsize=2)
def _load_cached(path: pathlib.Path) -> pa.Table:
    if not path.is_file():
        raise ValidationError(f"{path}: found no such file, needed the catalogue; build it with `{BUILD_COMMAND}`.")
    try:
        table = pq.read_table(path, page_checksum_verification=True)
    except (pa.ArrowInvalid, OSError) as error:
        raise ValidationError(
            f"{path}: found a file that is not whole ({str(error).splitlines()[0][:80]}), needed the catalogue; "
            f"build it again with `{BUILD_COMMAND}`."
        ) from error
    if table.schema.remove_metadata() != SCHEMA:
        raise ValidationError(f"{path}: found other columns, needed the catalogue's; build it with `{BUILD_COMMAND}`.")
    return table


def shipped_content() -> str:
    """The content hash that is committed with the tables; empty if there is none."""
    path = asset_root() / CONTENT_FILE
    return json.loads(path.read_text(encoding="utf-8"))["content"] if path.is_file() else ""


def save_content(table: pa.Table) -> pathlib.Path:
    """Writes the content hash of the current tables to `assets_index/catalogue.json`, to be committed with them."""
    meshes = table.num_rows - table["recipe"].null_count
    body = {"content": catalogue_hash(table), "records": table.num_rows, "with_mesh": meshes}
    text = json.dumps(body, indent=2) + "\n"
    return write_atomically(asset_root() / CONTENT_FILE, lambda p: p.write_text(text, encoding="utf-8"))


def forget() -> None:
    """Clears the table cached in memory, after the file has changed."""
    _load_cached.cache_clear()


def recorded_content(table: pa.Table) -> str:
    """The content hash stored in the table; empty if there is none."""
    return (table.schema.metadata or {}).get(_CONTENT, b"").decode()


def as_catalogued(records: Sequence[AssetRecord]) -> list[AssetRecord]:
    """Base shapes with the mass, materials and forces that the catalogue gives them; other records as they are.

    The index of base shapes holds the estimates of their recipes, from which the catalogue only chooses the make.
    """
    shapes = load_index()
    leaves = dict.fromkeys(record.leaf for record in records if record.uid in shapes)
    found: dict[str, AssetRecord] = {}
    for leaf in leaves:
        rows = build_leaf(leaf, shapes, len(shapes.by_leaf(leaf))).to_pylist()
        found |= {row["uid"]: record_of(row) for row in rows}
    return [found.get(record.uid, record) for record in records]


def record_of(row: Mapping[str, Any]) -> AssetRecord:
    """The `AssetRecord` of a row of the table, to build, place and export.

    Raises:
      ValidationError: the row has no mesh.
    """
    if row["recipe"] is None:
        raise ValidationError(
            f"asset {row['uid']!r}: found no base shape of {row['category']!r}, needed a recipe for that leaf; "
            "choose another leaf, or its substitute (`AssetIndex.by_label`)."
        )
    return AssetRecord(
        uid=row["uid"],
        category=(row["class_name_l1"], row["class_name_l2"], row["class_name_l3"]),
        description=row["description"],
        recipe=row["recipe"],
        params=json.loads(row["params"]),
        extent_xyz=tuple(row["extent_xyz"]),
        materials=tuple(name for name in row["materials"] if name != "air"),
        licence=row["license"],
        **{
            name: row[name]
            for name in (
                *("length", "width", "height", "volume", "mass", "friction_coefficient", "movable"),
                *("required_force", "provenance"),
            )
        },
    )
