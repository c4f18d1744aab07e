"""Writes textured meshes with poses as one binary glTF file, z up, for the page."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from trimesh.exchange import gltf
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

#: cos of the angle between a face and its corners' mean normal from which it gets separate normals.
_CREASE_COSINE = 0.3


@dataclasses.dataclass(frozen=True)
class Surface:
    """Appearance of a mesh.

    Attributes:
      rgba: (4,) in [0, 1], linear.
      texture: (H, W, 3) u8 sRGB, or None.
      roughness, metallic: as in glTF, in [0, 1].
      unlit: shown without lighting.
    """

    rgba: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    texture: np.ndarray | None = None
    roughness: float = 1.0
    metallic: float = 0.0
    unlit: bool = False


@dataclasses.dataclass(frozen=True)
class Part:
    """A mesh and its poses.

    Attributes:
      vertices: (V, 3) m.
      faces: (F, 3).
      uv: (V, 2) from the lower left corner of the texture, or None.
      normals: (V, 3) unit, or None: from the faces around each vertex.
      poses: (n, 4, 4), T_root_mesh of each copy.
    """

    vertices: np.ndarray
    faces: np.ndarray
    surface: Surface
    uv: np.ndarray | None = None
    normals: np.ndarray | None = None
    poses: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(4)[None])


def glb(parts: Sequence[Part]) -> bytes:
    """Returns the parts as one file; copies of a mesh share its vertices.

    Raises:
      ValueError: no part.
    """
    if not parts:
        raise ValueError("glb: found no part, needed at least one.")
    scene = trimesh.Scene()
    materials = _Materials()
    for number, part in enumerate(parts):
        mesh = _solid(part, materials)
        name = f"mesh{number}"
        scene.geometry[name] = mesh
        for copy, pose in enumerate(part.poses):
            scene.graph.update(frame_to=f"{name}_{copy}", matrix=pose, geometry=name)
    return gltf.export_glb(scene, include_normals=True, tree_postprocessor=materials.finish)


def merged(parts: Sequence[Part]) -> list[Part]:
    """Returns parts that look the same together: one for each surface (an object, not its values), without poses.

    Each part is one drawing call of a page, so that fewer are drawn sooner. Copies of a mesh are written out.

    Args:
      parts: rigid poses.
    """
    groups: dict[int, list[Part]] = {}
    for part in parts:
        groups.setdefault(id(part.surface), []).append(part)
    return [_merge(group) for group in groups.values()]


def _merge(parts: Sequence[Part]) -> Part:
    rows: list[tuple[np.ndarray, ...]] = []
    number = 0
    for part in parts:
        vertices, faces, normals, uv = _corners(part)
        for pose in part.poses:
            turn = pose[:3, :3].T
            rows.append((vertices @ turn + pose[:3, 3], faces + number, normals @ turn, uv))
            number += len(vertices)
    vertices, faces, normals, uv = map(np.concatenate, zip(*rows, strict=True))
    return Part(vertices, faces, parts[0].surface, uv, normals)


class _Materials:
    """Materials by surface, so that equal ones are written once, and which of them are unlit."""

    def __init__(self) -> None:
        self._known: dict[int, PBRMaterial] = {}
        self._unlit: set[str] = set()
        self._kept: list[Surface] = []

    def of(self, surface: Surface) -> PBRMaterial:
        key = id(surface)
        if key not in self._known:
            name = f"surface{len(self._known)}"
            # trimesh takes whole numbers for sRGB's 8 bits but writes them as they are: numbers below 1 stay exact.
            self._known[key] = PBRMaterial(
                name=name,
                baseColorFactor=np.clip(np.rint(np.array(surface.rgba) * 255), 0, 255).astype(np.uint8),
                baseColorTexture=None if surface.texture is None else _texture_image(surface.texture),
                roughnessFactor=float(surface.roughness),
                metallicFactor=float(surface.metallic),
                alphaMode="BLEND" if surface.rgba[3] < 1.0 else "OPAQUE",
                doubleSided=False,
            )
            self._kept.append(surface)  # keeps the object alive, because ids are unique only among living objects
            if surface.unlit:
                self._unlit.add(name)
        return self._known[key]

    def finish(self, tree: dict[str, Any]) -> None:
        """Marks unlit materials, which trimesh cannot write (KHR_materials_unlit)."""
        for material in tree.get("materials", ()):
            if material.get("name") in self._unlit:
                material["extensions"] = {"KHR_materials_unlit": {}}
        if self._unlit:
            tree.setdefault("extensionsUsed", []).append("KHR_materials_unlit")


def _texture_image(texture: np.ndarray) -> Image.Image:
    """Returns a texture as a JPEG image, which is encoded ten times as fast as PNG and a third of its size."""
    image = Image.fromarray(texture)
    image.format = "JPEG"
    return image


def _solid(part: Part, materials: _Materials) -> trimesh.Trimesh:
    vertices, faces, normals, uv = _corners(part)
    visual = TextureVisuals(uv=np.asarray(uv, np.float64), material=materials.of(part.surface))
    return trimesh.Trimesh(vertices, faces, visual=visual, vertex_normals=normals, process=False)


def _corners(part: Part) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (V, 3), faces (F, 3), normals (V, 3) and uv (V, 2) of a part in its own frame, all there."""
    uv = np.zeros((len(part.vertices), 2)) if part.uv is None else part.uv
    if part.normals is not None:
        return part.vertices, part.faces, part.normals, uv
    source, faces, normals = with_normals(part.vertices, part.faces)
    return part.vertices[source], faces, normals, uv[source]


def with_normals(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns normals of the vertices (V, 3) of faces (F, 3): the area-weighted mean of the adjacent faces.

    A face with a normal far from the mean of its corners gets separate corners; so do both sides of a sheet, whose
    normals cancel.

    Returns:
      (W,) the vertex that each new one is a copy of, (F, 3) faces over the new ones, and (W, 3) unit normals.
    """
    corners = np.asarray(vertices, np.float64)[faces]
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = _unit(weighted)
    mean = _unit(_summed(faces, weighted, len(vertices)))
    alone = (np.einsum("fj,fcj->fc", flat, mean[faces]) < _CREASE_COSINE).any(1)
    mean = _unit(_summed(faces[~alone], weighted[~alone], len(vertices)))
    own = len(vertices) + np.arange(3 * alone.sum()).reshape(-1, 3)
    new = np.array(faces, np.int64)
    new[alone] = own
    source = np.concatenate([np.arange(len(vertices)), faces[alone].reshape(-1)])
    return source, new, np.concatenate([mean, np.repeat(flat[alone], 3, 0)])


def _summed(faces: np.ndarray, values: np.ndarray, number: int) -> np.ndarray:
    """(number, 3) sums of the faces' values (F, 3) at their corners."""
    rows = np.repeat(values, 3, 0)
    return np.stack([np.bincount(faces.reshape(-1), rows[:, axis], number) for axis in range(3)], -1)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1; upwards where they have no direction."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), [0.0, 0.0, 1.0])
