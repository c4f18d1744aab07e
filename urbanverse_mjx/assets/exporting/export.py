"""Exports assets to GLB, OBJ, MJCF or USD, each with its annotation under the official field names.

All files are in metres. GLB is y up with its front along +z, as glTF requires; OBJ, MJCF and USD keep the asset frame
(+x front, +y left, z up, origin on the ground under the centre).
"""

import os
import pathlib
from collections.abc import Callable, Mapping
from typing import Any

from urbanverse_mjx.datatypes import AssetRecord, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically, write_json

from ..collision.hulls import load_hulls
from ..meshes.glb import glb_bytes
from ..records.index import build_mesh, full_index
from ..records.store import as_catalogued
from .export_mjcf import mjcf_text
from .export_usd import write_usd
from .obj import mtl_text, obj_text, png_bytes

Path = str | os.PathLike[str]
OBJ_REMARK = "metres; z up, front along +x"


def official_annotation(record: AssetRecord) -> dict[str, Any]:
    """A record under the field names and in the units of UrbanVerse-100K's annotation files."""
    top, middle, leaf = record.category
    return {
        "uid": record.uid,
        "class_name_l1": top,
        "class_name_l2": middle,
        "class_name_l3": leaf,
        "category": leaf,
        "description": record.description,
        "height": record.height,
        "max_dimension": max(record.extent_xyz),
        "length": record.length,
        "width": record.width,
        "materials": list(record.materials),
        "mass": record.mass,
        "frontView": 0,
        "movable": record.movable,
        "required_force": record.required_force,
        "friction_coefficient": record.friction_coefficient,
        "license_info": {"license": record.licence, "uri": record.provenance},
    }


def record_to_export(uid: str) -> AssetRecord:
    """Returns the record of a base shape, an imported asset, or any other uid of the catalogue.

    Raises:
      ValidationError: the uid does not exist, or the catalogue is not built (`make assets`).
    """
    from ..selection.search import library

    index = full_index()
    return as_catalogued([index.get(uid)])[0] if uid in index else library().record(uid)


def export_glb(record: AssetRecord, path: Path) -> pathlib.Path:
    """Writes an asset as GLB, texture inside; `asset.extras` holds its annotation."""
    body = glb_bytes(build_mesh(record), official_annotation(record), record.licence)
    return write_atomically(path, lambda temporary: temporary.write_bytes(body))


def export_obj(record: AssetRecord, path: Path) -> pathlib.Path:
    """Writes an asset as OBJ, with its material (`.mtl`) and texture (`.png`) beside it."""
    path, mesh = pathlib.Path(path), build_mesh(record)
    texture, material = _beside(path, ".png"), _beside(path, ".mtl")
    _write(texture, png_bytes(mesh.texture))
    _write(material, mtl_text(mesh, texture.name).encode())
    return _write(path, obj_text(mesh, material.name, f"{record.uid}; {OBJ_REMARK}").encode())


def export_mjcf(record: AssetRecord, path: Path) -> pathlib.Path:
    """Writes an asset as MJCF (`.xml`), with its visual mesh (`.obj`) and texture (`.png`) beside it.

    Raises:
      ValidationError: the asset has no collision hulls.
    """
    path, mesh, hulls = pathlib.Path(path), build_mesh(record), load_hulls(record).hulls
    texture, visual = _beside(path, ".png"), _beside(path, ".obj")
    _write(texture, png_bytes(mesh.texture))
    _write(visual, obj_text(mesh, None, f"{record.uid}; {OBJ_REMARK}").encode())
    return _write(path, mjcf_text(record, mesh, hulls, visual.name, texture.name).encode())


def export_usd(record: AssetRecord, path: Path) -> pathlib.Path:
    """Writes an asset as USD (`.usda` as text, `.usdc` or `.usd` in binary), with its texture (`.png`) beside it.

    Raises:
      ValidationError: the asset has no collision hulls, or usd-core is not installed.
    """
    path, mesh, hulls = pathlib.Path(path), build_mesh(record), load_hulls(record).hulls
    texture = _beside(path, ".png")
    _write(texture, png_bytes(mesh.texture))
    temporary = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        write_usd(temporary, record, mesh, hulls, texture.name)
        return temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


#: format -> (suffix, writer).
FORMATS: Mapping[str, tuple[str, Callable[[AssetRecord, Path], pathlib.Path]]] = {
    "glb": (".glb", export_glb),
    "obj": (".obj", export_obj),
    "mjcf": (".xml", export_mjcf),
    "usd": (".usda", export_usd),
}


def export_asset(record: AssetRecord, folder: Path, form: str = "glb") -> pathlib.Path:
    """Writes an asset to a subfolder of `folder` (a single file for GLB), with its annotation as JSON.

    Raises:
      ValidationError: no such format, or the asset has no collision hulls and the format needs them.
    """
    if form not in FORMATS:
        raise ValidationError(f"export: found the format {form!r}, needed one of {', '.join(FORMATS)}.")
    suffix, write = FORMATS[form]
    name = record.uid.replace("/", "--")
    place = pathlib.Path(folder) if form == "glb" else pathlib.Path(folder) / name
    path = write(record, place / f"{name}{suffix}")
    write_json(place / f"{name}.json", official_annotation(record))
    return path


def _beside(path: pathlib.Path, suffix: str) -> pathlib.Path:
    return path.with_suffix(suffix)


def _write(path: pathlib.Path, body: bytes) -> pathlib.Path:
    return write_atomically(path, lambda temporary: temporary.write_bytes(body))
