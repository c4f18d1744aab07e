"""Makes collision hulls: CoACD for parts that are not convex, then merging until the asset's budget of hulls is met.

Most street assets are assemblies of convex parts, so the mesh is first split into its connected pieces. A nearly convex
piece is represented by its hull; CoACD decomposes the others. Then the two hulls whose union adds the least empty space
are merged repeatedly. Compared with one CoACD run over the whole mesh, this keeps thin posts exact (no voxel remeshing)
and takes seconds instead of minutes.
"""

import concurrent.futures
import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError, cKDTree

from urbanverse_mjx.datatypes.asset import MAX_HULL_VERTICES, MAX_HULLS, AssetMesh
from urbanverse_mjx.process_pool import worker_pool
from urbanverse_mjx.progress import Progress

from ..meshes.recipe import get_recipe
from ..records.index import build_mesh, load_index
from .hulls import MILLIMETRE, HullStore, hull_budget, mesh_key, store_path


@dataclasses.dataclass(frozen=True)
class HullOptions:
    """Options for making collision hulls.

    Chosen manually; `tests/assets/test_hulls.py` bounds what the hulls of the catalogue miss and add.

    Attributes:
      flush_height: m; lower assets (a manhole cover) are flush with the ground, and their hulls are moved below it.
      flush_top, flush_bottom: m, heights of these hulls.
      foot_plate: m; a piece that ends below (a pole's foot plate) is left out, because wheels roll over it.
      half_sheet: m, half the thickness given to flat pieces.
      max_flat_deviation: m; a piece is flat if its points deviate less from a plane (root mean square).
      excess_share: CoACD decomposes a piece if the empty share of its hull exceeds this, and the empty volume the
        largest of the two below.
      excess_volume: m^3.
      excess_of_box: as a share of the asset's box.
      coacd_threshold: concavity; 0.05 to 0.1 is the usual range.
      negligible_volume: m^3; unions that add less are always made.
      overhead_height: m; empty space above it, over robots and most people, has the weight `overhead_weight`.
      overhead_weight: see `overhead_height`.
      shadow_height: m; newly covered ground counts as empty space of this height, so thin plates stay apart.
      neighbours: candidates for a union per piece.
      max_uncovered_distance, max_uncovered_share: a simplified hull is enlarged until the distance of its piece's
        points outside it is below the first (m) or the second as a share of its longest side.
      max_enlargements: largest number of these enlargements.
      max_protrusion: largest protrusion of a hull from the mesh's box, as a share of the box's side.
      batch: meshes to a set of worker processes.
    """

    flush_height: float = 0.03
    flush_top: float = -0.02
    flush_bottom: float = -0.06
    foot_plate: float = 0.02
    half_sheet: float = 0.004
    max_flat_deviation: float = 0.005
    excess_share: float = 0.26
    excess_volume: float = 0.008
    excess_of_box: float = 1e-3
    coacd_threshold: float = 0.1
    negligible_volume: float = 2e-4
    overhead_height: float = 1.7
    overhead_weight: float = 0.1
    shadow_height: float = 0.15
    neighbours: int = 10
    max_uncovered_distance: float = 0.05
    max_uncovered_share: float = 0.007
    max_enlargements: int = 3
    max_protrusion: float = 0.02
    batch: int = 40


OPTIONS = HullOptions()


@dataclasses.dataclass(frozen=True)
class Piece:
    """One convex piece: corners (n, 3) m, volume in m^3, and area of its projection to the ground in m^2."""

    corners: np.ndarray
    volume: float
    shadow: float


def convex_piece(points: np.ndarray) -> Piece:
    """The convex hull of points; flat or thin sets are thickened."""
    centre = points.mean(0)
    _, _, axes = np.linalg.svd(points - centre, full_matrices=True)
    local = (points - centre) @ axes.T
    for axis in range(3):
        if np.ptp(local[:, axis]) < 2 * OPTIONS.half_sheet:
            local = np.concatenate([local + s * OPTIONS.half_sheet * np.eye(3)[axis] for s in (-1, 1)])
    points = local @ axes + centre
    hull = ConvexHull(points)
    corners = points[hull.vertices]
    return Piece(corners, float(hull.volume), float(ConvexHull(corners[:, :2]).volume))


def connected_pieces(mesh: AssetMesh, part_faces: Sequence[int] | None = None) -> list[tuple[np.ndarray, np.ndarray]]:
    """(vertices, faces) of each connected piece, with shared vertices.

    Args:
      part_faces: number of faces of each part of the mesh, so that parts that only touch are separated; without it,
        pieces are separated by shared vertices only.
    """
    counts = [len(mesh.faces)] if part_faces is None else list(part_faces)
    pieces = []
    for stop, count in zip(np.cumsum(counts), counts, strict=True):
        pieces += _connected(mesh.vertices.astype(np.float64), mesh.faces[stop - count : stop])
    return pieces


def _connected(vertices: np.ndarray, faces: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], faces.reshape(-1, 3)
    keys = np.round(vertices / 1e-5).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    vertices, faces = vertices[first], inverse.reshape(-1)[faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    rows, columns = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(vertices), len(vertices)))
    _, label = connected_components(graph, directed=False)
    pieces = []
    for k in np.unique(label[faces[:, 0]]):
        chosen = faces[label[faces[:, 0]] == k]
        kept, local = np.unique(chosen, return_inverse=True)
        pieces.append((vertices[kept], local.reshape(-1, 3)))
    return pieces


def closed_surface(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Closes every hole of a piece by a fan of triangles, so that a shell counts as a solid."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    known = set(map(tuple, edges.tolist()))
    onward = {b: a for a, b in known if (b, a) not in known}  # along the border, opposite to the faces
    points, fans = [vertices], []
    while onward:
        first, then = onward.popitem()
        loop = [first]
        while then != first and then in onward:
            loop.append(then)
            then = onward.pop(then)
        middle = sum(len(p) for p in points)
        points.append(vertices[loop].mean(0, keepdims=True))
        fans += [(a, b, middle) for a, b in zip(loop, [*loop[1:], first], strict=True)]
    if fans:
        faces = np.concatenate([faces, np.array(fans)])
    return np.concatenate(points), faces


def signed_volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """m^3 inside a closed surface."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6)


def split_piece(vertices: np.ndarray, faces: np.ndarray, budget: int, allowance: float) -> list[Piece]:
    """The convex pieces of one connected part: its hull if that is accurate enough, otherwise the result of CoACD.

    Args:
      budget: largest number of pieces.
      allowance: m^3 of air that the hull may add.
    """
    whole = convex_piece(vertices)
    if budget == 1 or vertices[:, 2].min() > OPTIONS.overhead_height:
        return [whole]
    thickness = np.linalg.svd(vertices - vertices.mean(0), compute_uv=False)[-1]
    if thickness < OPTIONS.max_flat_deviation * np.sqrt(len(vertices)):
        return [whole]  # a cloth or a pane, which CoACD would split into many pieces
    vertices, faces = closed_surface(vertices, faces)
    air = whole.volume - signed_volume(vertices, faces)
    if air < max(OPTIONS.excess_share * whole.volume, allowance):
        return [whole]
    import coacd  # loads a native library, and most meshes are convex or have shipped hulls

    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=OPTIONS.coacd_threshold,
        max_convex_hull=min(budget, MAX_HULLS),
        preprocess_mode="auto",
        preprocess_resolution=40,
        resolution=1000,
        mcts_nodes=10,
        mcts_iterations=60,
        mcts_max_depth=2,
        seed=0,
    )
    return [convex_piece(np.asarray(v, float)) for v, _ in parts if len(v) >= 4] or [whole]


def _cost(a: Piece, b: Piece, union: Piece) -> float:
    """Cost of a union for robots on the ground: m^3 of empty space, and newly covered ground."""
    space = max(union.volume - a.volume - b.volume, 0.0)
    if union.corners[:, 2].min() > OPTIONS.overhead_height:
        return OPTIONS.overhead_weight * space
    return space + OPTIONS.shadow_height * max(union.shadow - a.shadow - b.shadow, 0.0)


def merge_pieces(pieces: list[Piece], budget: int) -> list[Piece]:
    """Joins pieces until at most `budget` are left and no cheap union remains."""
    pieces = _without_contained(pieces)
    costs: dict[tuple[int, int], tuple[float, Piece]] = {}
    alive = dict(enumerate(pieces))
    serial = len(pieces)

    def consider(i: int) -> None:
        centres = np.array([alive[k].corners.mean(0) for k in alive])
        names = list(alive)
        _, near = cKDTree(centres).query(alive[i].corners.mean(0), k=min(OPTIONS.neighbours + 1, len(names)))
        for n in np.atleast_1d(near):
            j = names[int(n)]
            pair = (min(i, j), max(i, j))
            if i != j and pair not in costs:
                union = convex_piece(np.concatenate([alive[i].corners, alive[j].corners]))
                costs[pair] = (_cost(alive[i], alive[j], union), union)

    for i in list(alive):
        consider(i)
    while len(alive) > 1 and costs:
        (i, j), (cost, union) = min(costs.items(), key=lambda item: (item[1][0], item[0]))
        if len(alive) <= budget and cost > OPTIONS.negligible_volume:
            break
        del alive[i], alive[j]
        costs = {pair: c for pair, c in costs.items() if i not in pair and j not in pair}
        alive[serial] = union
        consider(serial)
        serial += 1
        if not costs and len(alive) > budget:
            for k in list(alive):
                consider(k)
    return _without_contained(list(alive.values()))


def _without_contained(pieces: list[Piece], tolerance: float = 0.008) -> list[Piece]:
    """Drops pieces that lie inside a larger one."""
    order = sorted(range(len(pieces)), key=lambda k: (-pieces[k].volume, k))
    kept: list[Piece] = []
    planes: list[np.ndarray] = []
    for k in order:
        corners = pieces[k].corners
        if any((corners @ p[:, :3].T + p[:, 3] <= tolerance).all() for p in planes):
            continue
        kept.append(pieces[k])
        planes.append(ConvexHull(corners).equations)
    return kept


def simplified(corners: np.ndarray, limit: int = MAX_HULL_VERTICES, enlarge: bool = True) -> np.ndarray:
    """Reduces a hull to at most `limit` corners, greedily those that protrude most, and enlarges it to cover most of
    the lost volume, unless `enlarge` is false."""
    if len(corners) <= limit:
        return corners
    directions = np.concatenate([np.eye(3), -np.eye(3), np.array([[1, 1, 1], [-1, -1, 1]]) / np.sqrt(3)])
    chosen = list(dict.fromkeys(int(k) for k in (corners @ directions.T).argmax(0)))
    missed = 0.0
    while len(chosen) <= limit:
        try:
            missing = _gaps(corners, corners[chosen])
        except QhullError:
            chosen.append(next(k for k in range(len(corners)) if k not in chosen))
            continue
        missed = float(missing.max())
        if missed < 1e-3 or len(chosen) == limit:
            break
        chosen.append(int(missing.argmax()))
    if not enlarge:
        return corners[chosen]
    # The hull keeps the piece's vertical extent, so that it does not penetrate the pavement.
    low, high = corners[:, 2].min(), corners[:, 2].max()
    grown = corners[chosen]
    bound = max(OPTIONS.max_uncovered_distance, OPTIONS.max_uncovered_share * float(np.ptp(corners, axis=0).max()))
    for _ in range(OPTIONS.max_enlargements):
        away = grown - grown.mean(0)
        reach = np.linalg.norm(away, axis=1, keepdims=True)
        grown = grown + away * 0.7 * missed / np.maximum(reach, 1e-6)
        grown[:, 2] = np.clip(grown[:, 2], low, high)
        missed = float(_gaps(corners, grown).max())
        if missed <= bound:
            break
    return grown


def _gaps(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(n,) m, distance of points (n, 3) outside the hull of the corners; negative inside."""
    planes = ConvexHull(corners).equations
    return (points @ planes[:, :3].T + planes[:, 3]).max(1)


def is_flush(mesh: AssetMesh) -> bool:
    """Whether an asset is flush with the ground, so that its hull is moved below it."""
    return bool(mesh.extent[2] <= OPTIONS.flush_height)


def decompose(mesh: AssetMesh, budget: int, part_faces: Sequence[int] | None = None) -> tuple[np.ndarray, ...]:
    """At most `budget` convex hulls of a mesh, each (n, 3) int32 in whole millimetres with n <= 32."""
    flush = is_flush(mesh)
    if flush:
        flat = np.unique(np.round(mesh.vertices[:, :2], 3), axis=0)
        layers = [np.column_stack([flat, np.full(len(flat), z)]) for z in (OPTIONS.flush_bottom, OPTIONS.flush_top)]
        pieces = [convex_piece(np.concatenate(layers))]
    elif budget == 1:
        pieces = [convex_piece(mesh.vertices.astype(np.float64))]
    else:
        allowance = max(OPTIONS.excess_volume, OPTIONS.excess_of_box * float(np.prod(mesh.extent)))
        solids = [(v, f) for v, f in connected_pieces(mesh, part_faces) if v[:, 2].max() > OPTIONS.foot_plate + 1e-4]
        parts = [p for v, f in solids for p in split_piece(v, f, budget, allowance)]
        pieces = merge_pieces(parts, budget)
    # CoACD decomposes a voxel copy of the mesh, which exceeds it by up to a voxel. Hulls are therefore limited to the
    # mesh's box, except for the corners of coarse circles.
    slack = np.inf if flush else np.array([OPTIONS.max_protrusion, OPTIONS.max_protrusion, 0.0]) * mesh.extent
    low, high = mesh.vertices.min(0) - slack, mesh.vertices.max(0) + slack
    rounded = [np.round(np.clip(simplified(p.corners), low, high) / MILLIMETRE).astype(np.int32) for p in pieces]
    # Largest first, ties by position, because the order is part of the content.
    keyed = sorted(zip(pieces, rounded, strict=True), key=lambda x: (-round(x[0].volume, 6), x[1].min(0).tolist()))
    return tuple(np.unique(r, axis=0) for _, r in keyed)


def _work(key: str, recipe: str, leaf: str, variant: int, budget: int) -> tuple[str, tuple[np.ndarray, ...]]:
    built = get_recipe(recipe, leaf).build(variant)
    return key, decompose(built.mesh, budget, built.part_faces)


def build_missing(
    jobs: int, leaf: str | None = None, again: bool = False, report: Callable[[str], object] = print
) -> HullStore:
    """Decomposes the meshes that the store lacks in worker processes, writes the store, and removes unused keys.

    CoACD may abort after some hundred meshes in one process (CoACD's issue 23), so every batch uses new processes.
    """
    store = HullStore.load(store_path())
    found = dict(store.hulls)
    tasks: dict[str, tuple[str, str, str, int, int]] = {}
    needed: set[str] = set()
    for record in load_index().records:
        mesh = build_mesh(record)
        budget = hull_budget(mesh, get_recipe(record.recipe, record.leaf).hulls)
        key = mesh_key(mesh, budget)
        needed.add(key)
        if (again or key not in found) and leaf in (None, record.leaf):
            tasks[key] = (key, record.recipe, record.leaf, int(record.params["variant"]), budget)
    waiting = list(tasks.values())
    with Progress() as progress:
        report_done, done = progress.task("convex hulls", len(waiting)), 0
        for first in range(0, len(waiting), OPTIONS.batch):
            with worker_pool(jobs, niceness=5) as pool:
                futures = [pool.submit(_work, *task) for task in waiting[first : first + OPTIONS.batch]]
                for future in concurrent.futures.as_completed(futures):
                    key, hulls = future.result()
                    found[key] = hulls
                    done += 1
                    report_done(done)
            HullStore(found).save(store_path())
    kept = HullStore({k: h for k, h in found.items() if k in needed})
    path = kept.save(store_path())
    count = sum(len(h) for h in kept.hulls.values())
    report(
        f"{path.name}: {len(kept.hulls)} meshes, {count} hulls, {path.stat().st_size} bytes; {len(tasks)} newly made"
    )
    return kept
