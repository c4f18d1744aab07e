"""Loads a screened file: triangles, texture coordinates, images, and the file's own metadata."""

import dataclasses
import io
import json
import pathlib
import re
import urllib.parse
from typing import Any

import numpy as np
import trimesh
import trimesh.resolvers
from PIL import Image
from trimesh.visual.texture import TextureVisuals

from ... import srgb
from . import plain_gltf, skinning
from .screening import LIMITS, Limits, RefusedFileError, inside, screen

MAX_IMAGE_BYTES = 256 * 2**20
MAX_IMAGE_PIXELS = 64 * 10**6
WHITE = (255.0, 255.0, 255.0)
#: Colour of files whose format has no colours: unpainted concrete or metal.
GREY = (150.0, 150.0, 150.0)
#: Attribute under which a mesh with a material keeps its vertex colours: copies of its `visual` lose them.
_COLORS = "urbanverse_colors"


@dataclasses.dataclass(frozen=True)
class Part:
    """Triangles with one material, in the file's own frame and unit.

    Attributes:
      vertices: (V, 3).
      faces: (F, 3).
      uv: (V, 2) from the texture's lower left corner, or None.
      texture: (H, W, 3) uint8, or None.
      color: (3,) sRGB 0-255, factor of the texture, or the colour itself.
      colors: (V, 3) sRGB 0-255 of each vertex, or None.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None
    texture: np.ndarray | None
    color: tuple[float, float, float]
    colors: np.ndarray | None


@dataclasses.dataclass(frozen=True)
class Source:
    """The contents of a mesh file.

    Attributes:
      parts: at least one.
      y_up: whether y is up and the front along +z, as in glTF; None for other files without that information.
      names: of its nodes, meshes and materials, outermost first.
      generator, copyright: texts of the file.
      extras: its `asset.extras`.
      roughness, metallic: of its largest part.
      colourless: whether it is of a format without colours (STL, or PLY that holds none) and drawn grey.
      notes: parts that could not be read.
    """

    parts: tuple[Part, ...]
    y_up: bool | None
    names: tuple[str, ...]
    generator: str
    copyright: str
    extras: dict[str, Any]
    roughness: float
    metallic: float
    notes: tuple[str, ...]
    colourless: bool = False

    @property
    def vertices(self) -> np.ndarray:
        """(V, 3) of all parts."""
        return np.concatenate([p.vertices for p in self.parts])

    @property
    def faces(self) -> np.ndarray:
        """(F, 3) of all parts."""
        starts = np.cumsum([0, *[len(p.vertices) for p in self.parts[:-1]]])
        return np.concatenate([p.faces + start for p, start in zip(self.parts, starts, strict=True)])


class _Neighbours(trimesh.resolvers.Resolver):
    """Resolver that gives the reader only files of the imported folder, and records refused ones."""

    def __init__(self, folder: pathlib.Path, base: pathlib.Path) -> None:
        self.folder, self.base = folder, base
        self.refused: RefusedFileError | None = None
        self.missing: list[str] = []

    def get(self, name: str) -> bytes:
        # glTF names files by URIs, in which a space is %20; OBJ and PLY by plain names.
        for plain in dict.fromkeys((name.strip(), urllib.parse.unquote(name.strip()))):
            try:
                path = inside(self.folder, self.base, plain)
            except RefusedFileError as error:
                self.refused = error
                raise
            if path.is_file() and path.stat().st_size <= MAX_IMAGE_BYTES:
                return _as_utf8(path.read_bytes()) if path.suffix.lower() == ".mtl" else path.read_bytes()
        self.missing.append(name[:80])
        raise FileNotFoundError(name)

    def keys(self) -> list[str]:
        return []

    def namespaced(self, namespace: str) -> "_Neighbours":
        return self

    def write(self, name: str, data: Any) -> None:
        raise RefusedFileError("path trick", f"wants to write {name[:80]!r}")


def _as_utf8(body: bytes) -> bytes:
    """A text file's bytes as UTF-8; other bytes are interpreted as Latin-1."""
    try:
        body.decode("utf-8")
    except UnicodeDecodeError:
        return body.decode("latin-1").encode("utf-8")
    return body


def read_source(path: pathlib.Path, folder: pathlib.Path, limits: Limits = LIMITS) -> Source:
    """Screens and loads one GLB, glTF, OBJ, STL or PLY file; skinned meshes in their rest pose.

    Raises:
      RefusedFileError: the file must not or cannot be read, or has no finite triangles.
    """
    tree = screen(path, folder, limits)
    Image.MAX_IMAGE_PIXELS = MAX_IMAGE_PIXELS // 2  # PIL raises at twice this
    neighbours = _Neighbours(folder, path.parent)
    kind = path.suffix.lower().removeprefix(".")
    try:
        solids = [solid for solid in _solids(path, kind, tree, neighbours) if len(solid.faces)]
    except (MemoryError, RefusedFileError):
        raise
    except Exception as error:  # the reader raises errors of any type
        raise neighbours.refused or RefusedFileError(
            "malformed", f"cannot be read ({type(error).__name__}: {str(error)[:100]})"
        ) from error
    if neighbours.refused:
        raise neighbours.refused
    if not solids:
        raise RefusedFileError("malformed", "holds no triangles")
    for solid in solids:
        _check(solid)
    is_gltf = kind in ("glb", "gltf")
    parts = tuple(_part(solid, is_gltf) for solid in solids)
    colourless = kind in ("stl", "ply") and all(p.texture is None and p.colors is None for p in parts)
    if colourless:
        parts = tuple(dataclasses.replace(p, color=GREY) for p in parts)
    asset = _object(tree, "asset")
    notes = ["it has no colours and is drawn grey"] if colourless else []
    notes += [f"found no file {name!r}" for name in neighbours.missing]
    if tree.get("images") and all(part.texture is None for part in parts):
        notes.append(f"its images are missing, damaged or of more than {MAX_IMAGE_PIXELS} pixels")
    largest = max(solids, key=lambda s: s.area)
    return Source(
        parts,
        True if is_gltf else _up(path),
        _names(tree) if tree else _obj_names(path) if kind == "obj" else (),
        str(asset.get("generator", ""))[:200],
        str(asset.get("copyright", ""))[:500],
        _object(asset, "extras"),
        *_surface(largest),
        tuple(notes),
        colourless,
    )


def _solids(path: pathlib.Path, kind: str, tree: dict[str, Any], neighbours: _Neighbours) -> list[trimesh.Trimesh]:
    """All triangles of a file, in the frame of its scene."""
    if tree and not plain_gltf.is_plain(tree):
        tree, body = plain_gltf.plain_glb(tree, path, neighbours.folder)
        kind = "glb"
    else:
        body = path.read_bytes()
    if kind == "obj":
        body = _as_utf8(body)
    skinned = bool(tree.get("skins"))
    if skinned:
        tree = skinning.readable(tree)
        body = skinning.glb_with(tree, body) if kind == "glb" else json.dumps(tree).encode()
    scene = trimesh.load_scene(io.BytesIO(body), file_type=kind, resolver=neighbours, process=False)
    for mesh in scene.geometry.values():
        if isinstance(mesh, trimesh.Trimesh) and isinstance(mesh.visual, TextureVisuals):
            if "color" in mesh.visual.vertex_attributes:
                mesh.vertex_attributes[_COLORS] = mesh.visual.vertex_attributes["color"]
    solids = skinning.posed(scene, tree) if skinned else scene.dump()
    solids = [g for g in solids if isinstance(g, trimesh.Trimesh)]
    if kind == "stl":  # every triangle has corners of its own
        for solid in solids:
            _check(solid)
            solid.merge_vertices()
    return solids


def _object(tree: dict[str, Any], name: str) -> dict[str, Any]:
    value = tree.get(name)
    return value if isinstance(value, dict) else {}


def _check(solid: trimesh.Trimesh) -> None:
    if not np.isfinite(solid.vertices).all():
        raise RefusedFileError("not finite", "has vertices that are no finite numbers")
    if np.abs(solid.vertices).max(initial=0.0) > 1e9:
        raise RefusedFileError("absurd numbers", "has vertices further out than 1e9")
    if len(solid.vertices) == 0 or solid.faces.min() < 0 or solid.faces.max() >= len(solid.vertices):
        raise RefusedFileError("absurd numbers", "has faces of vertices that it does not have")


def _part(solid: trimesh.Trimesh, linear: bool) -> Part:
    vertices = np.asarray(solid.vertices, np.float64)
    faces = np.asarray(solid.faces, np.int64)
    visual: Any = solid.visual
    if isinstance(visual, TextureVisuals):
        material = visual.material
        image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
        texture = None if image is None else _opaque(image)
        uv = None if visual.uv is None else np.asarray(visual.uv, np.float64)
        if uv is not None and not (uv.shape == (len(vertices), 2) and np.isfinite(uv).all()):
            uv = None
        factor = getattr(material, "baseColorFactor", None) if linear else getattr(material, "diffuse", None)
        color = WHITE if factor is None else _srgb(np.asarray(factor, float)[:3], linear)
        texture = texture if uv is not None else None
        colors = None if texture is not None else _vertex_colors(solid, linear)
        if colors is not None:
            colors = colors * (np.asarray(color) / 255.0)
        return Part(vertices, faces, uv, texture, color, colors)
    colors = None
    if visual is not None and visual.kind == "vertex":
        colors = np.asarray(visual.vertex_colors, np.float64)[:, :3]
        colors = 255.0 * srgb.encoded(colors / 255.0) if linear else colors
    elif visual is not None and visual.kind == "face":
        vertices, faces, colors = _per_face(vertices, faces, np.asarray(visual.face_colors, np.float64)[:, :3])
    return Part(vertices, faces, None, None, WHITE, colors)


def _vertex_colors(solid: trimesh.Trimesh, linear: bool) -> np.ndarray | None:
    """(V, 3) sRGB 0-255, vertex colours of a mesh that also has a material; None without colours."""
    found = np.asarray(solid.vertex_attributes.get(_COLORS, ()))
    if found.ndim != 2 or len(found) != len(solid.vertices) or found.shape[1] < 3 or not np.isfinite(found).all():
        return None
    share = found[:, :3].astype(np.float64)
    if np.issubdtype(found.dtype, np.integer):
        share = share / np.iinfo(found.dtype).max
    return 255.0 * srgb.encoded(share) if linear else 255.0 * np.clip(share, 0.0, 1.0)


def _per_face(vertices: np.ndarray, faces: np.ndarray, colors: np.ndarray) -> tuple[np.ndarray, ...]:
    return vertices[faces.ravel()], np.arange(3 * len(faces)).reshape(-1, 3), np.repeat(colors, 3, axis=0)


def _opaque(image: Image.Image) -> np.ndarray:
    """(H, W, 3) uint8; transparent pixels take the mean colour of the others."""
    pixels = np.asarray(image.convert("RGBA"), np.float64)
    alpha = pixels[..., 3:] / 255.0
    seen = alpha.sum()
    mean = (pixels[..., :3] * alpha).sum((0, 1)) / seen if seen > 0 else np.full(3, 128.0)
    return np.round(pixels[..., :3] * alpha + mean * (1 - alpha)).astype(np.uint8)


def _srgb(color: np.ndarray, linear: bool) -> tuple[float, float, float]:
    """0-255; glTF's factors are linear light (glTF 2.0, section 3.9.2), OBJ's are not."""
    share = np.clip(color / (255.0 if color.max() > 1.0 else 1.0), 0.0, 1.0)
    if linear:
        share = srgb.encoded(share)
    r, g, b = (float(255.0 * c) for c in share)
    return r, g, b


def _surface(solid: trimesh.Trimesh) -> tuple[float, float]:
    material = getattr(solid.visual, "material", None)
    values = [getattr(material, name, None) for name in ("roughnessFactor", "metallicFactor")]
    # A file without these factors, or with a texture instead, gets those of painted plastic.
    roughness, metallic = (d if v is None else float(np.clip(v, 0, 1)) for v, d in zip(values, (0.8, 0.0), strict=True))
    return roughness, metallic


def _names(tree: dict[str, Any]) -> tuple[str, ...]:
    found = [row.get("name") for key in ("scenes", "nodes", "meshes", "materials") for row in tree.get(key, [])]
    return tuple(dict.fromkeys(str(n)[:120] for n in found if isinstance(n, str)))[:200]


def _up(path: pathlib.Path) -> bool | None:
    """Whether y is up, by a comment in the header of the file (OBJ, PLY); None without one, as always in STL."""
    with path.open("rb") as file:
        lines = [file.readline(1000).lower() for _ in range(10)]
    remarks = b" ".join(line for line in lines if line.startswith((b"#", b"comment")))
    axis = re.search(rb"\b([yz])[ -]up\b", remarks)
    return None if axis is None else axis.group(1) == b"y"


def _obj_names(path: pathlib.Path) -> tuple[str, ...]:
    found: list[str] = []
    with path.open("rb") as file:
        for line in file:
            if line[:2] in (b"o ", b"g ") and len(found) < 200:
                found.append(_as_utf8(line[2:].strip()).decode()[:120])
    return tuple(dict.fromkeys(found))
