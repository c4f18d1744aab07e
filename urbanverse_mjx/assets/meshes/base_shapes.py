"""Stored measurements of every base shape: exact box and volume, visible colours, silhouettes.

One row per record of the base index in `assets_index/shapes.parquet`, written together with the index by
`python -m urbanverse_mjx.assets index`, so that 102,444 records need no mesh to be made, filtered and matched.
"""

import dataclasses
import functools
import os
import pathlib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from scipy import sparse

from urbanverse_mjx.datatypes import AssetMesh, AssetRecord, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.settings import asset_root

from ...geometry import rotations
from .instances import palette_cells, pixels
from .mesh_builder import BuiltAsset
from .table_files import read_rows

FILE = "shapes.parquet"
#: Views of an object: yaw in degrees by which it is rotated, as in `gallery.render_row`.
YAWS = (-32.0, 0.0, 90.0, 180.0)
ELEVATION = 14.0  # degrees, of the camera over the horizon; the same image as a thumbnail's
GRID, CELLS = 24, 4  # pixels of a silhouette's side; cells of its layout's side
SAMPLES = 6000  # points on the surface, ten for each pixel of the silhouette
MOST_COLORS = 12  # kept of the visible colours; the rest is small
JOIN = 1e-5  # m within which split vertices are merged
LEAST_SHARE = 0.02  # share of its box that counts as the volume of an object of open sheets, as in the base index
# Light of `gallery.scene_of`: ambient, head light, and the sun with its direction.
_AMBIENT, _HEAD, _SUN, _TO_SUN = 0.42, 0.25, 0.6, np.array([0.5, -0.45, 1.0]) / np.sqrt(0.25 + 0.2025 + 1.0)
_REAL, _REALS = pa.float64(), pa.list_(pa.float32())
SCHEMA = pa.schema(
    [
        ("uid", pa.string()),
        ("extent", pa.list_(_REAL)),
        ("volume", _REAL),
        ("make_known", pa.bool_()),
        ("colors", pa.list_(pa.uint8())),
        ("share", _REALS),
        ("light", _REALS),
        ("paint", pa.list_(pa.bool_())),
        ("layouts", pa.list_(pa.uint8())),
        ("aspects", _REALS),
    ]
)


@dataclasses.dataclass(frozen=True)
class BaseShape:
    """One base shape.

    Attributes:
      uid: uid of its record in the base index.
      extent: (3,) m, exact box of the mesh.
      volume: m^3, `enclosed_volume`.
      make_known: whether the recipe defines material or mass; otherwise they are drawn from the leaf's prior.
      colors: (C, 3) uint8 visible colours, most frequent first.
      share: (C,) of the visible area, sums to 1.
      light: (C,) brightness of the renderer's light on each colour.
      paint: (C,) colours to which a tint is applied in full.
      layouts: (V, 16) uint8 filled share of the silhouette's 4x4 cells, row by row from the top, per view of `YAWS`.
      aspects: (V,) width over height of the silhouettes.
    """

    uid: str
    extent: NDArray[np.float64]
    volume: float
    make_known: bool
    colors: NDArray[np.uint8]
    share: NDArray[np.float64]
    light: NDArray[np.float64]
    paint: NDArray[np.bool_]
    layouts: NDArray[np.uint8]
    aspects: NDArray[np.float64]


def enclosed_volume(mesh: AssetMesh, part_faces: Sequence[int]) -> float:
    """m^3 that the closed surfaces of a mesh enclose, overlaps counted twice, at least 2 % and at most all of its box.

    Within a part, vertices that were split at creases are joined again; a connected piece is closed where every edge
    belongs to an even number of triangles, and encloses |sum of a . (b x c)| / 6 (divergence theorem). Awnings, nets
    and similar meshes, which enclose almost no volume, count as 2 % of their box.
    """
    points = mesh.vertices.astype(np.float64)
    total, start = 0.0, 0
    for count in part_faces:
        faces = mesh.faces[start : start + count]
        start += count
        used, local = np.unique(faces, return_inverse=True)
        joined, which = np.unique(np.round(points[used] / JOIN).astype(np.int64), axis=0, return_inverse=True)
        total += _closed(points[faces], which.ravel()[local.ravel()].reshape(-1, 3), len(joined))
    box = float(np.prod(points.max(0) - points.min(0)))
    return min(max(total, LEAST_SHARE * box), box)


def _closed(corners: NDArray, faces: NDArray, count: int) -> float:
    """m^3 enclosed by the closed pieces among triangles: (F, 3, 3) corners, (F, 3) numbers of joined vertices."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    real = edges[:, 0] != edges[:, 1]  # merging may collapse a sliver
    graph = sparse.coo_matrix((np.ones(len(edges), bool), (edges[:, 0], edges[:, 1])), (count, count))
    pieces, label = sparse.csgraph.connected_components(graph, directed=False)
    keys, times = np.unique(edges[real, 0] * count + edges[real, 1], return_counts=True)
    is_open = np.zeros(pieces, bool)
    is_open[label[keys[times % 2 == 1] // count]] = True
    centred = corners - corners.mean((0, 1))
    signed = np.einsum("ij,ij->i", centred[:, 0], np.cross(centred[:, 1], centred[:, 2])) / 6.0
    enclosed = np.abs(np.bincount(label[faces[:, 0]], signed, pieces))
    return float(enclosed[~is_open].sum())


def measure(uid: str, built: BuiltAsset, make_known: bool) -> BaseShape:
    """Measures a built asset. Deterministic, because surface points follow a fixed sequence."""
    mesh = built.mesh
    points, normals, which = _surface(mesh, SAMPLES)
    colors, paint, of_point = _colors(mesh, which)
    seen = np.zeros((len(colors), 2))
    layouts, aspects = [], []
    for yaw in YAWS:
        front, light, layout, aspect = _view(points, normals, np.radians(yaw))
        seen[:, 0] += np.bincount(of_point[front], minlength=len(colors))
        seen[:, 1] += np.bincount(of_point[front], light, minlength=len(colors))
        layouts.append(layout)
        aspects.append(aspect)
    kept = np.argsort(-seen[:, 0], kind="stable")[:MOST_COLORS]
    kept = kept[seen[kept, 0] > 0]
    count = seen[kept, 0]
    return BaseShape(
        uid,
        mesh.vertices.astype(np.float64).max(0) - mesh.vertices.astype(np.float64).min(0),
        enclosed_volume(mesh, built.part_faces),
        make_known,
        colors[kept],
        count / count.sum(),
        seen[kept, 1] / count,
        paint[kept],
        np.array(layouts, np.uint8),
        np.array(aspects),
    )


def _surface(mesh: AssetMesh, count: int) -> tuple[NDArray, NDArray, tuple[NDArray, NDArray]]:
    """(n, 3) points distributed uniformly over the surface, their normals, and (face, texture point) of each."""
    corners = mesh.vertices.astype(np.float64)[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.sqrt((normal**2).sum(1))
    ends = np.cumsum(area)
    face = np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1], side="right").clip(0, len(area) - 1)
    # Roberts' two-dimensional sequence on the powers of the plastic number, folded into the triangle.
    u = (0.5 + 0.7548776662466927 * np.arange(count)) % 1.0
    v = (0.5 + 0.5698402909980532 * np.arange(count)) % 1.0
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    points = np.einsum("nk,nkc->nc", weights, corners[face])
    uv = np.einsum("nk,nkc->nc", weights, mesh.uv.astype(np.float64)[mesh.faces[face]])
    unit = normal[face] / np.maximum(area[face], 1e-12)[:, None]
    return points, unit, (face, uv)


def _colors(mesh: AssetMesh, which: tuple[NDArray, NDArray]) -> tuple[NDArray, NDArray, NDArray]:
    """(C, 3) colours, (C,) paint, and (n,) the colour of each surface point; images in steps of 32."""
    face, uv = which
    corners = mesh.uv[mesh.faces]
    flat = (corners == corners[:, :1]).all((1, 2))[face]
    place = pixels(mesh.texture, uv)
    color = mesh.texture[place[:, 0], place[:, 1]].astype(np.int64)
    color[~flat] = color[~flat] // 32 * 32 + 16
    cells = palette_cells(mesh)
    painted = {tuple(c) for c in cells.colors[cells.paint].tolist()}
    keys = np.concatenate([color, flat[:, None]], axis=1)
    unique, of_point = np.unique(keys, axis=0, return_inverse=True)
    paint = np.array([bool(row[3]) and tuple(row[:3]) in painted for row in unique.tolist()])
    return unique[:, :3].astype(np.uint8), paint, of_point.ravel()


def _view(points: NDArray, normals: NDArray, yaw: float) -> tuple[NDArray, NDArray, NDArray, float]:
    """Indices of the points visible in one view, the light on them, the layout and the aspect of the silhouette."""
    turn = rotations.about_z(yaw)
    p, n = points @ turn.T, normals @ turn.T
    e = np.radians(ELEVATION)
    to_camera = np.array([np.cos(e), 0.0, np.sin(e)])
    up = np.array([-np.sin(e), 0.0, np.cos(e)])
    across, above, near = p[:, 1], p @ up, p @ to_camera
    facing = n @ to_camera
    width, height = max(np.ptp(across), 1e-6), max(np.ptp(above), 1e-6)
    column = np.minimum((across - across.min()) / width * GRID, GRID - 1).astype(np.int64)
    row = np.minimum((above.max() - above) / height * GRID, GRID - 1).astype(np.int64)
    order = np.lexsort((-near, row * GRID + column))  # nearest first within a pixel
    order = order[facing[order] > 0.02]
    pixel = (row * GRID + column)[order]
    first = np.ones(len(order), bool)
    first[1:] = pixel[1:] != pixel[:-1]
    front = order[first]
    light = _AMBIENT + _HEAD * facing[front] + _SUN * np.maximum(n[front] @ _TO_SUN, 0.0)
    filled = np.zeros(GRID * GRID)
    filled[pixel] = 1.0
    step = GRID // CELLS
    layout = filled.reshape(CELLS, step, CELLS, step).mean((1, 3)).ravel()
    return front, light, np.floor(255.0 * layout + 0.5), width / height


def save_shapes(shapes: Iterable[BaseShape], path: str | os.PathLike[str] | None = None) -> pathlib.Path:
    """Writes the table, by uid."""
    rows = []
    for shape in sorted(shapes, key=lambda s: s.uid):
        row = {field.name: getattr(shape, field.name) for field in dataclasses.fields(shape)}
        rows.append({k: x.ravel().tolist() if isinstance(x, np.ndarray) else x for k, x in row.items()})
    table = pa.Table.from_pylist(rows, SCHEMA)
    path = pathlib.Path(path or asset_root() / FILE)
    return write_atomically(path, lambda p: pq.write_table(table, p, compression="zstd"))


def load_shapes(path: str | os.PathLike[str] | None = None) -> Mapping[str, BaseShape]:
    """uid -> base shape, of the packaged table or another one.

    Raises:
      ValidationError: no such file.
    """
    return _load_cached(pathlib.Path(path or asset_root() / FILE))


@functools.lru_cache(maxsize=4)
def _load_cached(path: pathlib.Path) -> Mapping[str, BaseShape]:
    if not path.is_file():
        raise ValidationError(
            f"{path}: found no such file, needed the measures of the base shapes; "
            "build them with `python -m urbanverse_mjx.assets index`."
        )
    rows = read_rows(path, "the measures of the base shapes", "copy it again from where it is whole")
    try:
        return {row["uid"]: _shape(row) for row in rows}
    except (KeyError, TypeError, ValueError) as error:
        raise ValidationError(
            f"{path}: found rows that are no base shapes ({error}), needed their measures; copy it again."
        ) from error


def _shape(row: Mapping[str, Any]) -> BaseShape:
    return BaseShape(
        row["uid"],
        np.array(row["extent"]),
        row["volume"],
        row["make_known"],
        np.array(row["colors"], np.uint8).reshape(-1, 3),
        np.array(row["share"], np.float64),
        np.array(row["light"], np.float64),
        np.array(row["paint"], bool),
        np.array(row["layouts"], np.uint8).reshape(len(YAWS), CELLS * CELLS),
        np.array(row["aspects"], np.float64),
    )


def shape_of(record: AssetRecord) -> BaseShape:
    """The measures of a record of the base index.

    Raises:
      ValidationError: the table has no measures of this uid, or those of another mesh.
    """
    shape = load_shapes().get(record.uid)
    if shape is None or np.abs(shape.extent - record.extent_xyz).max() > 1e-3:
        found = "none" if shape is None else f"a box of {np.round(shape.extent, 3).tolist()} m"
        raise ValidationError(
            f"base shape {record.uid!r}: found {found} in {FILE}, needed the measures of the index's record; "
            "write both with `python -m urbanverse_mjx.assets index`."
        )
    return shape
