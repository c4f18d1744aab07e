"""Detects the nine forms of corruption of web-crawled assets that the UrbanVerse paper lists.

In the paper, people inspect assets; this module applies rules to the mesh, its annotated leaf, and the names in the
file. The leaf's prior prevents false findings for objects that are thin, scattered or rough (a poster, a flock, a
hedge).
"""

import dataclasses
import re
from collections.abc import Iterator

import numpy as np

from ..categories import ontology
from ..categories.priors import Prior
from .placing import misfit_of_proportions
from .reading import Part, Source
from .shape import Shape

BAD_MESH = "bad mesh"
NO_TEXTURE = "no texture"
PAPER = "paper-like"
BASE = "with base"
TERRAIN = "terrain map"
NAMES = "inconsistent name"
CAD = "CAD-like"
SEVERAL = "non-single object"
SCALE = "non-uniform scale"
#: The paper's order (its list of nine).
CORRUPTIONS = (BAD_MESH, NO_TEXTURE, PAPER, BASE, TERRAIN, NAMES, CAD, SEVERAL, SCALE)

CAD_WORDS = re.compile(
    r"solidworks|autodesk inventor|catia|opencascade|open cascade|freecad|step2gl|cad exchanger|onshape|fusion ?360|"
    r"\.(?:step|stp|iges|igs|sldprt|sldasm|catpart|ipt)\b",
    re.IGNORECASE,
)


@dataclasses.dataclass(frozen=True)
class Thresholds:
    """Limits of the rules, chosen so that all shipped assets pass and the broken ones of the tests do not
    (docs/decisions/asset_import.md); shares are in [0, 1].

    Attributes:
      min_faces: number of faces below which statistics of surfaces are unreliable.
      degenerate_share: of the faces, without area.
      shred_share: of the area, in components of at most `shred_faces` faces.
      shred_faces: see `shred_share`.
      noise_angle: rad, mean bend from face to face of a noisy surface.
      noise_normals: share of the faces that have a direction of their own in a noisy surface.
      open_share: norm of the sum of the horizontal area vectors over the whole area; 0 for a closed surface.
      sheet_ratio: of the least to the middle side, below which a shape is a sheet.
      board_ratio: the same for a leaf's flattest object, up to which a single face is enough.
      terrain_up: share of the area that faces the sky.
      terrain_height: largest height over the shorter ground side of terrain.
      terrain_cover: least share of the ground that terrain covers.
      plate_share: of the ground, level; above it the shape is a plate and no terrain.
      base_height: share of the height in which a base is looked for.
      base_area: ground of a base over that of what stands on it.
      base_side: side of a base over the largest side of the leaf at that height.
      object_gap: share of the diagonal that separates two objects.
      object_volume: share of the largest object's box volume that makes another object.
      alike_volume: the same from which all objects are alike.
      sliver_share: of the faces, thin triangles of trimmed surfaces.
      chosen_color: range of the three channels (0-255) above which a colour is no grey that a program put there.
    """

    min_faces: int = 300
    degenerate_share: float = 0.3
    shred_share: float = 0.4
    shred_faces: int = 3
    noise_angle: float = 0.8
    noise_normals: float = 0.7
    open_share: float = 0.12
    sheet_ratio: float = 0.02
    board_ratio: float = 0.15
    terrain_up: float = 0.85
    terrain_height: float = 0.35
    terrain_cover: float = 0.6
    plate_share: float = 0.7
    base_height: float = 0.12
    base_area: float = 2.5
    base_side: float = 1.6
    object_gap: float = 0.04
    object_volume: float = 0.2
    alike_volume: float = 0.8
    sliver_share: float = 0.35
    chosen_color: float = 40.0


_LIMITS = Thresholds()


@dataclasses.dataclass(frozen=True)
class Finding:
    """A corruption: its name, the evidence, and whether the import fixed it."""

    name: str
    evidence: str
    fixed: bool = False


def find_in_shape(shape: Shape, source: Source, row: Prior | None) -> list[Finding]:
    """Finds faults of a file's mesh and appearance; `row` is the prior of its leaf, or None."""
    if len(shape.faces) < 4:
        return [Finding(BAD_MESH, f"{len(shape.faces)} faces with an area, needed at least 4")]
    checks = (_terrain, _several, _paper, _base, _bad_mesh, _cad, _texture)
    return [finding for check in checks for finding in check(shape, source, row)]


def _terrain(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if len(shape.faces) < _LIMITS.min_faces or (row and row.walkable):
        return
    x, y, z = shape.extent
    underside = (shape.normals[:, 2] < -0.99) & (shape.vertices[shape.faces][:, :, 2].max(1) < 0.02 * z)
    # A base plate is level; terrain is not.
    level = (shape.normals[:, 2] > 0.999) & (np.ptp(shape.vertices[shape.faces][:, :, 2], axis=1) < 1e-3)
    if float(shape.areas[level].sum()) > _LIMITS.plate_share * x * y:
        return
    areas, up = shape.areas[~underside], shape.area_vectors[~underside, 2]
    climbing = float(up[shape.normals[~underside, 2] > 0.3].sum())
    share = float(areas[shape.normals[~underside, 2] > 0.3].sum() / areas.sum())
    cover = climbing / (x * y)
    if share > _LIMITS.terrain_up and z < _LIMITS.terrain_height * min(x, y) and _LIMITS.terrain_cover < cover < 1.15:
        yield Finding(TERRAIN, f"{share:.0%} of its surface faces the sky, over {cover:.0%} of its ground")


def _several(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    single = row is None or row.composition_type == "single"
    label = shape.clusters(_LIMITS.object_gap)
    boxes = [
        (shape.boxes[label == k, 0].min(0), shape.boxes[label == k, 1].max(0)) for k in range(int(label.max()) + 1)
    ]
    volumes = np.array([np.prod(np.maximum(high - low, 1e-4)) for low, high in boxes])
    large = volumes > _LIMITS.object_volume * volumes.max()
    # Equal hoops of a rack form one asset; two equal cars do not have a plausible common shape.
    alike = (
        row is not None
        and volumes[large].min() > _LIMITS.alike_volume * volumes.max()
        and misfit_of_proportions(shape.extent, row) == 0
    )
    if single and large.sum() > 1 and not alike:
        yield Finding(
            SEVERAL,
            f"{int(large.sum())} objects apart, of {_percent(volumes[large] / volumes.max())} of the largest",
        )
        return
    leaves = {leaf for name in source.names if (leaf := _exact_leaf(name))}
    middles = {ontology.category_of(leaf)[1] for leaf in leaves}
    if single and len(leaves) >= 3 and len(middles) >= 3:
        yield Finding(SEVERAL, f"nodes called {', '.join(sorted(leaves)[:5])}")


def _percent(shares: np.ndarray) -> str:
    return ", ".join(f"{share:.0%}" for share in sorted(shares)[-2::-1][:4])


def _exact_leaf(name: str) -> str | None:
    try:
        return ontology.match_label(re.sub(r"[\d_.\-]+", " ", name).strip() or "-")
    except ontology.UnknownLabelError:
        return None


def _paper(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if row and row.walkable:
        return
    flat = _flatness(row)
    thickness = shape.thickness
    if thickness < min(_LIMITS.sheet_ratio, flat / 3):
        yield Finding(PAPER, f"{thickness:.4f} times as thick as wide")
    elif len(shape.faces) <= 64 and flat > _LIMITS.sheet_ratio and _all_sheets(shape):
        yield Finding(PAPER, f"made of {int(shape.label.max()) + 1} flat sheets")


def _flatness(row: Prior | None) -> float:
    """Least over middle side of the flattest object of the leaf."""
    if row is None:
        return 1.0
    sides = [np.sort([row.length[k], row.width[k], row.height[k]]) for k in range(3)]
    return min(float(s[0] / s[1]) for s in sides)


def _all_sheets(shape: Shape) -> bool:
    """Every face belongs to a component without thickness (crossed cards)."""
    for k in range(int(shape.label.max()) + 1):
        faces = shape.label == k
        if np.abs(shape.normals[faces] @ shape.normals[faces][0]).min() < 0.999:
            return False
    return True


def _base(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    """Detects a slab at the base that is much wider than the object on it and than the largest object of the leaf."""
    height = shape.extent[2]
    tops = shape.vertices[shape.faces][:, :, 2].max(1)
    foot = tops <= _LIMITS.base_height * height
    if row is None or not foot.any() or foot.all():
        return
    low, rest = (shape.vertices[np.unique(shape.faces[rows])] for rows in (foot, ~foot))
    rest = (
        rest[rest[:, 2] > _LIMITS.base_height * height] if (rest[:, 2] > _LIMITS.base_height * height).any() else rest
    )
    sides, upper = np.ptp(low[:, :2], axis=0), np.ptp(rest[:, :2], axis=0)
    usual = max(row.length[2], row.width[2]) / row.height[1]
    share = float(np.prod(sides) / max(np.prod(upper), 1e-9))
    if share > _LIMITS.base_area and sides.max() > _LIMITS.base_side * usual * height:
        yield Finding(BASE, f"a slab {share:.1f} times the ground of what stands on it")


def _bad_mesh(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if shape.degenerate > _LIMITS.degenerate_share:
        yield Finding(BAD_MESH, f"{shape.degenerate:.0%} of its faces have no area")
        return
    if len(shape.faces) < _LIMITS.min_faces or (row and row.form == "plant"):
        return
    counts = np.bincount(shape.label)
    shreds = float(shape.areas[counts[shape.label] <= _LIMITS.shred_faces].sum() / shape.areas.sum())
    if shreds > _LIMITS.shred_share:
        yield Finding(BAD_MESH, f"{shreds:.0%} of its surface lies in loose shreds")
        return
    if len(shape.bends):
        directions = np.unique(np.round(shape.normals, 2), axis=0)
        if shape.bends.mean() > _LIMITS.noise_angle and len(directions) > _LIMITS.noise_normals * len(shape.faces):
            yield Finding(BAD_MESH, f"a noisy surface, {np.degrees(shape.bends.mean()):.0f} degrees from face to face")
            return
    # The area vectors of a closed surface sum to zero; an open underside is harmless.
    missing = float(np.linalg.norm(shape.area_vectors.sum(0)[:2]) / shape.areas.sum())
    if missing > _LIMITS.open_share and _flatness(row) > _LIMITS.board_ratio:
        yield Finding(BAD_MESH, f"a side of it is missing ({missing:.0%} of its surface has no opposite face)")


def _textured(source: Source) -> bool:
    return any(p.texture is not None and np.ptp(p.texture.reshape(-1, 3), axis=0).max() > 4 for p in source.parts)


def _coloured(source: Source) -> bool:
    """Whether there are several colours by material or vertex, or one that somebody chose: what has none is grey."""
    plain = {tuple(np.round(p.color)) for p in source.parts if p.texture is None and p.colors is None}
    if len(plain) > 1 or any(p.colors is not None and np.ptp(p.colors, axis=0).max() > 8 for p in source.parts):
        return True
    return any(np.ptp(_mean_color(p)) > _LIMITS.chosen_color for p in source.parts)


def _mean_color(part: Part) -> np.ndarray:
    """(3,) sRGB 0-255."""
    if part.texture is not None:
        return part.texture.reshape(-1, 3).mean(0) * np.asarray(part.color) / 255.0
    return np.asarray(part.color) if part.colors is None else part.colors.mean(0)


def _cad(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if _textured(source) or source.colourless:
        return
    words = CAD_WORDS.search(" ".join((source.generator, *source.names)))
    if words:
        yield Finding(CAD, f"no texture, and its file speaks of {words.group()!r}")
    elif (
        len(shape.faces) >= _LIMITS.min_faces
        and shape.slivers > _LIMITS.sliver_share
        and not any(p.uv is not None for p in source.parts)
    ):
        yield Finding(CAD, f"no texture, and {shape.slivers:.0%} of its faces are slivers of trimmed surfaces")


def _texture(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if not _textured(source) and not _coloured(source) and not source.colourless:
        yield Finding(NO_TEXTURE, "; ".join(("one colour all over", *source.notes[-1:])))
