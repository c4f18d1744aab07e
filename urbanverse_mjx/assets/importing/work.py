"""Steps of the import of one file, each run in a separate process (`containment`): makes the asset and draws it."""

import dataclasses
import hashlib
import json
import pathlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from urbanverse_mjx.datatypes import AssetMesh, ValidationError

from ..categories.priors import prior
from ..collision.decompose import closed_surface, connected_pieces, decompose, signed_volume
from ..collision.hulls import HullStore, hull_budget, mesh_key
from ..meshes.glb import glb_bytes, read_glb
from ..records.user_store import HULLS
from .annotation import SIZES, Measured, describe, leaf_in, licence_of, official_fields
from .bake import bake
from .corruption import NAMES, SCALE, Finding, find_in_shape
from .placing import MAX_STRETCH_LOG, Placement, place
from .reading import Source, read_source
from .screening import RefusedFileError
from .shape import Shape

MESH, RECORD, ANNOTATION, PREVIEW = "asset.glb", "record.json", "annotation.json", "preview.glb"
OBJECTS = "objects"
VIEW_SIZE = (256, 256)  # pixels


@dataclasses.dataclass(frozen=True)
class Task:
    """One file to import.

    Attributes:
      path: the file.
      folder: the imported folder around it.
      staging: folder to write into.
      name: path below the folder, with forward slashes.
      sha256: SHA-256 of the file.
      licence: licence to assume if none is stated.
      leaf: leaf of the ontology for every file; None to use the annotation or the names.
      seen: fields of the vision endpoint's annotation.
    """

    path: pathlib.Path
    folder: pathlib.Path
    staging: pathlib.Path
    name: str
    sha256: str
    licence: str | None = None
    leaf: str | None = None
    seen: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Made:
    """The result of one file: its uid, or None if a finding that was not fixed excludes it."""

    uid: str | None
    leaf: str | None
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]


def make_asset(task: Task) -> Made:
    """Reads, checks, places and decomposes one file and writes the asset's files to `task.staging`.

    Raises:
      RefusedFileError: the file must not or cannot be read, has no licence, or a broken annotation.
      ValidationError: CoACD is needed and not installed.
    """
    source = read_source(task.path, task.folder)
    said = official_fields(task.path, task.folder, source.extras)
    fields = {**task.seen, **said}
    licence = licence_of(fields, source.extras, source.copyright, task.licence)
    leaf, misnamed = _leaf(task, source, fields)
    row = prior(leaf) if leaf else None
    vertices, faces, uv, texture = bake(source.parts)
    placement = None
    if row:
        sizes = {k: float(fields[k]) for k in SIZES if k in fields}
        used = vertices[np.unique(faces)]
        placement = place(used, source.y_up, row, sizes, fields.get("frontView"))
    upright = Shape.of(vertices @ _rotation(source, placement).T, faces)
    findings = find_in_shape(upright, source, row) + misnamed
    if leaf and placement:
        findings += _scale_findings(placement, leaf)
    notes = [*source.notes, *(placement.steps if placement else ())]
    if leaf is None or placement is None or any(not f.fixed for f in findings):
        return Made(None, leaf, tuple(findings), tuple(notes))
    mesh = _asset_mesh(placement.apply(vertices), faces, uv, texture, source)
    uid = f"{leaf.replace(' ', '-')}/imported/{task.sha256[:16]}"
    _write_asset(task, mesh, uid, leaf, fields, licence)
    return Made(uid, leaf, tuple(findings), tuple(notes))


def _leaf(task: Task, source: Source, fields: Mapping[str, Any]) -> tuple[str | None, list[Finding]]:
    """The leaf that the user named, otherwise that of the annotation or the names, and a finding if the names contain
    none."""
    if task.leaf:
        return task.leaf, []
    names = [task.path.stem, *source.names, *reversed(pathlib.PurePosixPath(task.name).parts[:-1])]
    named = leaf_in(names)
    named_leaf = leaf_in([str(fields["category"])]) if "category" in fields else None
    if named_leaf:
        if named:
            return named_leaf, []
        return named_leaf, [
            Finding(NAMES, f"{task.path.name!r} names no leaf; its annotation gives {named_leaf!r}", fixed=True)
        ]
    if named:
        return named, []
    inner = ", ".join(repr(n[:40]) for n in source.names[:3])
    return None, [
        Finding(
            NAMES,
            f"neither {task.path.name!r} nor its nodes ({inner or 'without names'}) name a leaf; name it with --leaf",
        )
    ]


def _rotation(source: Source, placement: Placement | None) -> np.ndarray:
    from ..meshes.glb import TO_GLTF

    if placement:
        return placement.rotation
    return np.eye(3) if source.y_up is False else TO_GLTF.T


def _scale_findings(placement: Placement, leaf: str) -> list[Finding]:
    if placement.misfit > MAX_STRETCH_LOG:
        factor = np.exp(placement.misfit)
        return [Finding(SCALE, f"at any scale a side is {factor:.1f} times beyond what a {leaf} may have")]
    return [Finding(SCALE, placement.scaled, fixed=True)] if placement.scaled else []


def _asset_mesh(
    vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray, texture: np.ndarray, source: Source
) -> AssetMesh:
    """The placed mesh without vertices that no face uses and faces without area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    faces = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]
    used, faces = np.unique(faces, return_inverse=True)
    mesh = AssetMesh(vertices[used], faces.reshape(-1, 3), uv[used], texture, source.roughness, source.metallic)
    # The measurements use the stored float32 numbers.
    return read_glb(glb_bytes(mesh))


def _volume(mesh: AssetMesh) -> float:
    """m^3 inside the outer surface: the sum over closed pieces, each limited to its box; 2 % of the box for thin
    objects."""
    total = 0.0
    for vertices, faces in connected_pieces(mesh):
        total += min(signed_volume(*closed_surface(vertices, faces)), float(np.prod(np.ptp(vertices, axis=0))))
    box = float(np.prod(mesh.extent))
    return float(np.clip(total, max(0.02 * box, 1e-6), box))


def _write_asset(task: Task, mesh: AssetMesh, uid: str, leaf: str, fields: Mapping[str, Any], licence: str) -> None:
    hulls = decompose(mesh, hull_budget(mesh, None))
    x, y, z = (round(float(e), 4) for e in mesh.extent)
    body = glb_bytes(mesh, {"uid": uid, "source": task.name}, licence)
    params = {
        "path": f"{OBJECTS}/{task.staging.name}/{MESH}",
        "sha256": hashlib.sha256(body).hexdigest(),
        "source": task.name,
        "source_sha256": task.sha256,
    }
    measured = Measured((max(x, 1e-4), max(y, 1e-4), max(z, 1e-4)), _volume(mesh))
    provenance = f"imported from {task.name}"[:500]
    record, whole = describe(leaf, uid, measured, fields, licence, provenance, params)
    task.staging.mkdir(parents=True, exist_ok=True)
    (task.staging / MESH).write_bytes(body)
    HullStore({mesh_key(mesh, hull_budget(mesh, None)): hulls}).save(task.staging / HULLS)
    for name, value in ((RECORD, record.to_json()), (ANNOTATION, whole)):
        text = json.dumps(value, indent=1, ensure_ascii=True, default=str)
        (task.staging / name).write_text(text + "\n", encoding="utf-8")


def write_preview(task: Task) -> None:
    """Writes the file as one textured GLB a metre across, for the images of its annotation.

    Raises:
      RefusedFileError: as `make_asset`.
    """
    source = read_source(task.path, task.folder)
    vertices, faces, uv, texture = bake(source.parts)
    upright = vertices @ _rotation(source, None).T
    low, high = upright.min(0), upright.max(0)
    size = float(np.linalg.norm(high - low))
    if size <= 0 or len(faces) < 4:
        raise RefusedFileError("malformed", "has no extent")
    placed = (upright - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]) / size
    task.staging.mkdir(parents=True, exist_ok=True)
    (task.staging / PREVIEW).write_bytes(glb_bytes(_asset_mesh(placed, faces, uv, texture, source)))


def draw(staging: pathlib.Path, mesh_name: str) -> None:
    """Draws a GLB's four views, `view_0.png` (the front) to `view_3.png`, counter-clockwise.

    Raises:
      ValidationError: no off-screen OpenGL.
    """
    import mujoco
    from PIL import Image

    try:
        from .images import render_views

        views = render_views(read_glb(staging / mesh_name), VIEW_SIZE)
    except (ImportError, RuntimeError, AttributeError, OSError, mujoco.FatalError) as error:
        raise ValidationError(f"no images: {type(error).__name__}: {str(error)[:120]}; try MUJOCO_GL=egl.") from error
    for k, view in enumerate(views):
        Image.fromarray(view).save(staging / view_name(k))


def view_name(k: int) -> str:
    """File name of view k."""
    return f"view_{k}.png"
