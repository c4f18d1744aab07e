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
from .reading import Source
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

# Thresholds, chosen so that all shipped assets pass and the broken ones of the tests do not;
# docs/decisions/asset_import.md.
MANY = 300  # faces; below, statistics of surfaces are unreliable
DEGENERATE = 0.3  # share of faces without area
SHREDS, SHRED_FACES = 0.4, 3  # share of the area in components of so few faces
NOISE_ANGLE, NOISE_NORMALS = 0.8, 0.7  # rad, mean bend; share of faces with a unique direction
HALF_OPEN = 0.12  # norm of the sum of horizontal area vectors over the whole area (0 for a closed surface)
THIN, BOARD = 0.02, 0.15  # ratio of the least to the middle side; boards may have a single face
TERRAIN_UP, TERRAIN_FLAT, TERRAIN_COVER, LEVEL = 0.85, 0.35, 0.6, 0.7
BASE_HEIGHT, BASE_AREA, BASE_SIDE = 0.12, 2.5, 1.6
GAP, PARTNER, ALIKE = 0.04, 0.2, 0.8  # of the diagonal; shares of the largest cluster's box volume
SLIVERS = 0.35
CAD_WORDS = re.compile(
    r"solidworks|autodesk inventor|catia|opencascade|open cascade|freecad|step2gl|cad exchanger|onshape|fusion ?360|"
    r"\.(?:step|stp|iges|igs|sldprt|sldasm|catpart|ipt)\b",
    re.IGNORECASE,
)


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
    if len(shape.faces) < MANY or (row and row.walkable):
        return
    x, y, z = shape.extent
    underside = (shape.normals[:, 2] < -0.99) & (shape.vertices[shape.faces][:, :, 2].max(1) < 0.02 * z)
    # A base plate is level; terrain is not.
    level = (shape.normals[:, 2] > 0.999) & (np.ptp(shape.vertices[shape.faces][:, :, 2], axis=1) < 1e-3)
    if float(shape.areas[level].sum()) > LEVEL * x * y:
        return
    areas, up = shape.areas[~underside], shape.area_vectors[~underside, 2]
    climbing = float(up[shape.normals[~underside, 2] > 0.3].sum())
    share = float(areas[shape.normals[~underside, 2] > 0.3].sum() / areas.sum())
    cover = climbing / (x * y)
    if share > TERRAIN_UP and z < TERRAIN_FLAT * min(x, y) and TERRAIN_COVER < cover < 1.15:
        yield Finding(TERRAIN, f"{share:.0%} of its surface faces the sky, over {cover:.0%} of its ground")


def _several(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    single = row is None or row.composition_type == "single"
    label = shape.clusters(GAP)
    boxes = [
        (shape.boxes[label == k, 0].min(0), shape.boxes[label == k, 1].max(0)) for k in range(int(label.max()) + 1)
    ]
    volumes = np.array([np.prod(np.maximum(high - low, 1e-4)) for low, high in boxes])
    large = volumes > PARTNER * volumes.max()
    # Equal hoops of a rack form one asset; two equal cars do not have a plausible common shape.
    alike = (
        row is not None
        and volumes[large].min() > ALIKE * volumes.max()
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
    if thickness < min(THIN, flat / 3):
        yield Finding(PAPER, f"{thickness:.4f} times as thick as wide")
    elif len(shape.faces) <= 64 and flat > THIN and _all_sheets(shape):
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
    foot = tops <= BASE_HEIGHT * height
    if row is None or not foot.any() or foot.all():
        return
    low, rest = (shape.vertices[np.unique(shape.faces[rows])] for rows in (foot, ~foot))
    rest = rest[rest[:, 2] > BASE_HEIGHT * height] if (rest[:, 2] > BASE_HEIGHT * height).any() else rest
    sides, upper = np.ptp(low[:, :2], axis=0), np.ptp(rest[:, :2], axis=0)
    usual = max(row.length[2], row.width[2]) / row.height[1]
    share = float(np.prod(sides) / max(np.prod(upper), 1e-9))
    if share > BASE_AREA and sides.max() > BASE_SIDE * usual * height:
        yield Finding(BASE, f"a slab {share:.1f} times the ground of what stands on it")


def _bad_mesh(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if shape.degenerate > DEGENERATE:
        yield Finding(BAD_MESH, f"{shape.degenerate:.0%} of its faces have no area")
        return
    if len(shape.faces) < MANY or (row and row.form == "plant"):
        return
    counts = np.bincount(shape.label)
    shreds = float(shape.areas[counts[shape.label] <= SHRED_FACES].sum() / shape.areas.sum())
    if shreds > SHREDS:
        yield Finding(BAD_MESH, f"{shreds:.0%} of its surface lies in loose shreds")
        return
    if len(shape.bends):
        directions = np.unique(np.round(shape.normals, 2), axis=0)
        if shape.bends.mean() > NOISE_ANGLE and len(directions) > NOISE_NORMALS * len(shape.faces):
            yield Finding(BAD_MESH, f"a noisy surface, {np.degrees(shape.bends.mean()):.0f} degrees from face to face")
            return
    # The area vectors of a closed surface sum to zero; an open underside is harmless.
    missing = float(np.linalg.norm(shape.area_vectors.sum(0)[:2]) / shape.areas.sum())
    if missing > HALF_OPEN and _flatness(row) > BOARD:
        yield Finding(BAD_MESH, f"a side of it is missing ({missing:.0%} of its surface has no opposite face)")


def _textured(source: Source) -> bool:
    return any(p.texture is not None and np.ptp(p.texture.reshape(-1, 3), axis=0).max() > 4 for p in source.parts)


def _coloured(source: Source) -> bool:
    """Whether there are several colours by material or vertex, which count as an appearance."""
    plain = {tuple(np.round(p.color)) for p in source.parts if p.texture is None and p.colors is None}
    return len(plain) > 1 or any(p.colors is not None and np.ptp(p.colors, axis=0).max() > 8 for p in source.parts)


def _cad(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if _textured(source) or source.colourless:
        return
    words = CAD_WORDS.search(" ".join((source.generator, *source.names)))
    if words:
        yield Finding(CAD, f"no texture, and its file speaks of {words.group()!r}")
    elif len(shape.faces) >= MANY and shape.slivers > SLIVERS and not any(p.uv is not None for p in source.parts):
        yield Finding(CAD, f"no texture, and {shape.slivers:.0%} of its faces are slivers of trimmed surfaces")


def _texture(shape: Shape, source: Source, row: Prior | None) -> Iterator[Finding]:
    if not _textured(source) and not _coloured(source) and not source.colourless:
        yield Finding(NO_TEXTURE, "; ".join(("one colour all over", *source.notes[-1:])))
