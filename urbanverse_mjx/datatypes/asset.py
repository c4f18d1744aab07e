"""`AssetRecord` (one line of the asset index), `AssetMesh` (its visual mesh) and `HullSet` (its collision hulls).

Asset frame: +x front, +y left, z up, origin at the centre of the footprint on the ground.
"""

import dataclasses
from typing import Any

import numpy as np

from . import validation as v

MAX_HULLS = 16
MAX_HULL_VERTICES = 32


@dataclasses.dataclass(frozen=True)
class AssetRecord:
    """One metric asset of the index.

    Attributes:
      uid: unique, stable over versions of the index.
      category: (top, mid, leaf) of the 8/59/659 ontology.
      description: one sentence.
      recipe, params: how to build the mesh (`assets.build_mesh(record)`).
      extent_xyz: (3,) m, size of the mesh's box in the asset frame.
      length, width: m, the longer and the shorter ground side (length >= width).
      height: m.
      volume: m^3 of solid material's outer shape.
      mass: kg.
      materials: dominant materials, most first.
      friction_coefficient: sliding friction.
      movable: whether a person can move it.
      required_force: N to make it slide.
      licence, provenance: terms of use and source.
    """

    uid: str
    category: tuple[str, str, str]
    description: str
    recipe: str
    params: dict[str, Any]
    extent_xyz: tuple[float, float, float]
    length: float
    width: float
    height: float
    volume: float
    mass: float
    materials: tuple[str, ...]
    friction_coefficient: float
    movable: bool
    required_force: float
    licence: str
    provenance: str

    def __post_init__(self) -> None:
        v.text(self.uid, "asset.uid")
        where = f"asset {self.uid!r}"
        set_ = object.__setattr__
        levels = v.items(self.category, f"{where}.category", 3, 3)
        set_(self, "category", tuple(v.text(c, f"{where}.category[{i}]") for i, c in enumerate(levels)))
        for name in ("description", "recipe", "licence", "provenance"):
            v.text(getattr(self, name), f"{where}.{name}")
        if not isinstance(self.params, dict):
            raise v.fail(f"{where}.params", v.show(self.params), "a JSON object")
        set_(self, "extent_xyz", v.vector(self.extent_xyz, f"{where}.extent_xyz", 3, above=0.0))
        for name in ("length", "width", "height", "volume", "mass"):
            set_(self, name, v.number(getattr(self, name), f"{where}.{name}", above=0.0))
        if self.length < self.width:
            raise v.fail(f"{where}.length", f"{self.length:g} < width {self.width:g}", "length >= width")
        names = v.items(self.materials, f"{where}.materials", 1)
        set_(self, "materials", tuple(v.text(m, f"{where}.materials[{i}]") for i, m in enumerate(names)))
        set_(
            self,
            "friction_coefficient",
            v.number(self.friction_coefficient, f"{where}.friction_coefficient", 0.0, 5.0),
        )
        v.boolean(self.movable, f"{where}.movable")
        set_(self, "required_force", v.number(self.required_force, f"{where}.required_force", minimum=0.0))

    @property
    def leaf(self) -> str:
        return self.category[2]

    def to_json(self) -> dict[str, Any]:
        body = dataclasses.asdict(self)
        return {k: list(x) if isinstance(x, tuple) else x for k, x in body.items()}

    @staticmethod
    def from_json(value: Any, where: str = "asset") -> "AssetRecord":
        return AssetRecord(**v.mapping(value, where, [f.name for f in dataclasses.fields(AssetRecord)]))


@dataclasses.dataclass(frozen=True)
class AssetMesh:
    """A triangle mesh with one texture, in the asset frame.

    Attributes:
      vertices: (V, 3) float32, m. Vertices are split where a crease or a UV seam should show.
      faces: (F, 3) int32, counter-clockwise seen from outside.
      uv: (V, 2) float32, (0, 0) = lower left corner of the texture.
      texture: (H, W, 3) uint8, sRGB; a few palette cells or an atlas of at most 512x512.
      roughness, metallic: in [0, 1], for the whole mesh.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    texture: np.ndarray
    roughness: float = 0.8
    metallic: float = 0.0

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "vertices", np.ascontiguousarray(self.vertices, np.float32))
        set_(self, "faces", np.ascontiguousarray(self.faces, np.int32))
        set_(self, "uv", np.ascontiguousarray(self.uv, np.float32))
        set_(self, "texture", np.ascontiguousarray(self.texture, np.uint8))
        n = len(self.vertices)
        if self.vertices.shape != (n, 3) or n < 4 or not np.isfinite(self.vertices).all():
            raise v.fail("mesh.vertices", f"shape {self.vertices.shape}", "(V >= 4, 3) finite metres")
        if self.uv.shape != (n, 2):
            raise v.fail("mesh.uv", f"shape {self.uv.shape}", f"({n}, 2)")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3 or len(self.faces) < 4:
            raise v.fail("mesh.faces", f"shape {self.faces.shape}", "(F >= 4, 3)")
        if self.faces.view(np.uint32).max() >= n:  # a negative one is a large one
            raise v.fail("mesh.faces", "an index outside the vertices", f"indices in [0, {n})")
        if self.texture.ndim != 3 or self.texture.shape[2] != 3:
            raise v.fail("mesh.texture", f"shape {self.texture.shape}", "(H, W, 3) uint8")

    @property
    def extent(self) -> np.ndarray:
        """(3,) size of the bounding box, m."""
        return self.vertices.max(0) - self.vertices.min(0)


@dataclasses.dataclass(frozen=True)
class AgentAppearance:
    """An appearance of one kind of moving agent: its mesh stands on the ground, its front along +x.

    Attributes:
      kind: row of `crowds.KINDS`.
      category: leaf of the ontology.
    """

    kind: str
    category: str
    mesh: AssetMesh


@dataclasses.dataclass(frozen=True)
class HullSet:
    """Convex hulls of one asset, in the asset frame at scale 1.

    Attributes:
      hulls: at most 16 arrays (n, 3) float32, 4 <= n <= 32, the corners of each hull, m.
    """

    hulls: tuple[np.ndarray, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.hulls) <= MAX_HULLS:
            raise v.fail("hulls", f"{len(self.hulls)} hulls", f"1 to {MAX_HULLS}")
        for i, hull in enumerate(self.hulls):
            if hull.ndim != 2 or hull.shape[1] != 3 or not 4 <= len(hull) <= MAX_HULL_VERTICES:
                raise v.fail(f"hulls[{i}]", f"shape {hull.shape}", f"(4..{MAX_HULL_VERTICES}, 3)")
