"""Carriageways at crosswalks: the lanes of the traffic that comes over each, and straight routes across.

In:   maps and hulls of a bank's scenes. Out: `Carriageways`, tables of lanes, and `Routes` over them. When: once per
bank, on the host; look-ups every control step, inside jit, per env.

A road is followed from its crosswalk to both sides, in the middle between its edges, as far as two lanes fit into it.
Traffic keeps right, as that of the crowds does. What stands in the lanes, such as parked vehicles, is taken away.
"""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from scipy import ndimage, spatial

from ....crowds import KINDS
from ....datatypes import KIND_INDEX, RobotSpec, SceneBank
from ....geometry.grids import Grid
from ....geometry.polylines import arc_lengths, points_at
from ..clearance_maps import CELL as FINE
from ..clearance_maps import build_clearance_maps
from .crosswalks import Rectangle, rectangles
from .routes import Routes

#: m between points of a lane.
STEP = 0.5
#: Kinds of ground of a carriageway.
_ROAD = tuple(KIND_INDEX[kind] for kind in ("road", "road_marking", "crosswalk"))
_CAR = KINDS["car"]


@dataclasses.dataclass(frozen=True)
class LaneOptions:
    """Sizes of lanes and routes; chosen here.

    Attributes:
      width: m, least width of a road, for two lanes.
      widening: m that either half of a road may be wider than at the crosswalk; more is a junction.
      offset: m, largest distance of a lane from the road's middle.
      wide_share: largest share of a road with no edge near on either side; more is a car park or a square.
      space: m between a vehicle and what stands beside it.
      overhead: m, free height above vehicles.
      reach: m to which a road is followed to either side.
      turning: m, length over which its direction is taken.
      smoothing: m, standard deviation of the smoothing of its middle.
      before, after: m, least length of a lane before the crosswalk and behind it.
      from_kerb: m, range of the distances of starts and goals from the crosswalk.
      clearance: m, free distance along a route beyond the robot's half width, see `_half_width`.
      number: routes of a scene. tries: largest number of drawn routes for each that is taken.
    """

    width: float = 4.8
    widening: float = 0.3
    offset: float = 1.75
    wide_share: float = 0.5
    space: float = 0.1
    overhead: float = 0.2
    reach: float = 80.0
    turning: float = 2.5
    smoothing: float = 2.0
    before: float = 12.0
    after: float = 6.0
    from_kerb: tuple[float, float] = (2.5, 6.0)
    clearance: float = 0.15
    number: int = 64
    tries: int = 40


_OPTIONS = LaneOptions()


@dataclasses.dataclass(frozen=True)
class Road:
    """A road with its crosswalk on the host.

    Attributes:
      row: the crosswalk.
      across: (2,) unit vector in which people cross.
      half: (2,) m, half the crosswalk's size across the road and along it.
      lanes: the two lanes (n, 2) m in the directions of their traffic, points `STEP` m apart.
    """

    row: Rectangle
    across: np.ndarray
    half: np.ndarray
    lanes: tuple[np.ndarray, np.ndarray]


def roads_of(bank: SceneBank, scene: int) -> list[Road]:
    """The roads of a scene with a crosswalk over which two lanes of traffic come, in the order of `rectangles`."""
    ground = Grid(
        np.asarray(bank.map_origin[scene], np.float64), float(bank.map_resolution), bank.map_kind[scene].shape
    )
    is_road = np.isin(bank.map_kind[scene], _ROAD)
    # Points outside the map get the nearest cell, and no road leads there.
    is_road[[0, -1]] = is_road[:, [0, -1]] = False

    def driven(points: np.ndarray) -> np.ndarray:
        return ground.at(is_road, points)

    found = []
    for row in rectangles(bank, scene):
        left = np.array([-row.axis[1], row.axis[0]])
        for across, along, half in ((row.axis, left, row.half), (left, row.axis, row.half[::-1])):
            ends = row.centre + np.outer([-1.0, 1.0], along) * (half[1] + 1.0)
            lanes = _lanes(row, along, half, driven) if driven(ends).all() else None
            if lanes is not None:
                found.append(Road(row, across, half, lanes))
                break
    return found


_Driven = Callable[[np.ndarray], np.ndarray]


def _edge(point: np.ndarray, direction: np.ndarray, driven: _Driven, most: float) -> float:
    """m from a point of a road to its edge, at most `most`."""
    away = np.arange(0.0, most + 0.05, 0.05)
    off = ~driven(point + away[:, None] * direction)
    return float(away[np.argmax(off)]) if off.any() else most


class _Middle(NamedTuple):
    """Points (n, 2) m of a road's middle, half its width (n,) m there, and (n,) bool, whether it is a place without
    edges."""

    points: np.ndarray
    width: np.ndarray
    wide: np.ndarray


def _traced(start: np.ndarray, direction: np.ndarray, half: float, driven: _Driven) -> _Middle:
    """A road's middle from a point in a direction."""
    points, widths, wide, heading = [start], [half], [False], direction
    back, most = round(_OPTIONS.turning / STEP), half + _OPTIONS.widening
    for _ in range(round(_OPTIONS.reach / STEP)):
        point = points[-1] + STEP * heading
        if not driven(point[None])[0]:
            break
        normal = np.array([-heading[1], heading[0]])
        left, right = (_edge(point, s * normal, driven, most) for s in (1.0, -1.0))
        if left + right < _OPTIONS.width:
            break
        point = point + np.clip(0.5 * (left - right), -0.25, 0.25) * normal
        points.append(point)
        widths.append(0.5 * (left + right))
        wide.append(min(left, right) >= most)
        if len(points) > back:
            chord = point - points[-1 - back]
            heading = chord / np.linalg.norm(chord)
    return _Middle(np.array(points), np.array(widths), np.array(wide))


def _lanes(
    row: Rectangle, along: np.ndarray, half: np.ndarray, driven: _Driven
) -> tuple[np.ndarray, np.ndarray] | None:
    """The two lanes of the road over a crosswalk; None if they are too short, or it is no road but a place."""
    ahead, behind = (_traced(row.centre, sign * along, float(half[0]), driven) for sign in (1.0, -1.0))
    middle, width, wide = (np.concatenate([b[:0:-1], a]) for a, b in zip(ahead, behind, strict=True))
    needed = half[1] + max(_OPTIONS.before, _OPTIONS.after)
    short = min(len(ahead.points), len(behind.points)) * STEP < needed
    if short or 2.0 * half[0] < _OPTIONS.width or wide.mean() > _OPTIONS.wide_share:
        return None
    sigma = _OPTIONS.smoothing / STEP
    # Straight on at both ends, where a filter that repeats the last value would pull the line inwards.
    ends = np.arange(1, round(4 * sigma) + 1)[:, None]
    before, after = (middle[k] + ends * (middle[k] - middle[n]) for k, n in ((0, 1), (-1, -2)))
    smooth = ndimage.gaussian_filter1d(np.concatenate([before[::-1], middle, after]), sigma, axis=0)
    middle, width = smooth[len(ends) : -len(ends)], ndimage.gaussian_filter1d(width, sigma)
    tangent = np.gradient(middle, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    right = np.stack([tangent[:, 1], -tangent[:, 0]], -1)
    aside = np.minimum(0.5 * width, _OPTIONS.offset)[:, None]
    first, second = (_even((middle + sign * aside * right)[:: int(sign)]) for sign in (1.0, -1.0))
    return first, second


def _even(points: np.ndarray) -> np.ndarray:
    """The line through points (n, 2) m by points `STEP` m apart."""
    lengths = arc_lengths(points)
    return points_at(points, lengths, np.arange(0.0, lengths[-1], STEP))


class Carriageways(NamedTuple):
    """The roads of all scenes, padded to the largest number C with P points in a lane.

    Attributes:
      centre, across, half: (Z, C, 2), see `Road`; an unused row is infinitely far away.
      marked: (Z, C) bool, whether there are stripes, at which drivers give way.
      points: (Z, C, 2, P, 2) m, those of both lanes; the last repeats.
      length: (Z, C, 2) m, of the lanes.
      station: (Z, C, 2) m, of the crosswalk's middle along them.
    """

    centre: Float[Array, "Z C 2"]
    across: Float[Array, "Z C 2"]
    half: Float[Array, "Z C 2"]
    marked: Array
    points: Float[Array, "Z C 2 P 2"]
    length: Float[Array, "Z C 2"]
    station: Float[Array, "Z C 2"]

    @staticmethod
    def of(number: int, roads: Mapping[int, Sequence[Road]], marked: Mapping[int, Sequence[bool]]) -> "Carriageways":
        """The table for a bank of a number of scenes; marked: see `marked_roads`."""
        most = max(len(rows) for rows in roads.values())
        longest = max(len(lane) for rows in roads.values() for road in rows for lane in road.lanes)
        shape = number, most
        centre, across, half = np.full((*shape, 2), 1e6), np.zeros((*shape, 2)), np.zeros((*shape, 2))
        across[..., 0] = 1.0
        points, length = np.zeros((*shape, 2, longest, 2)), np.full((*shape, 2), STEP)
        stripes, station = np.zeros(shape, bool), np.zeros((*shape, 2))
        for z, rows in roads.items():
            for c, road in enumerate(rows):
                centre[z, c], across[z, c], half[z, c] = road.row.centre, road.across, road.half
                stripes[z, c] = marked[z][c]
                for n, lane in enumerate(road.lanes):
                    points[z, c, n, : len(lane)], points[z, c, n, len(lane) :] = lane, lane[-1]
                    length[z, c, n] = (len(lane) - 1) * STEP
                    station[z, c, n] = np.linalg.norm(lane - road.row.centre, axis=1).argmin() * STEP
        return Carriageways(
            centre=jnp.asarray(centre, jnp.float32),
            across=jnp.asarray(across, jnp.float32),
            half=jnp.asarray(half, jnp.float32),
            marked=jnp.asarray(stripes),
            points=jnp.asarray(points, jnp.float32),
            length=jnp.asarray(length, jnp.float32),
            station=jnp.asarray(station, jnp.float32),
        )

    def nearest(self, scene: Int[Array, ""], xy: Float[Array, "2"]) -> Int[Array, ""]:
        """() i32, the road whose crosswalk is nearest to (2,) m."""
        return jnp.argmin(((self.centre[scene] - xy) ** 2).sum(-1)).astype(jnp.int32)

    def beside(self, scene: Int[Array, ""], road: Int[Array, ""], xy: Float[Array, "*n 2"]) -> Float[Array, "*n 2"]:
        """(..., 2) m of points (..., 2) from the crosswalk's middle, across the road and along it."""
        away, across = xy - self.centre[scene, road], self.across[scene, road]
        return jnp.stack([away @ across, away[..., 1] * across[0] - away[..., 0] * across[1]], -1)

    def along(
        self, scene: Int[Array, ""], road: Int[Array, ""], xy: Float[Array, "2"]
    ) -> tuple[Float[Array, "2"], Float[Array, "2"]]:
        """Stations (2,) m of the nearest points of both lanes, and (2,) m how far they are from (2,) m."""
        away = jnp.linalg.norm(self.points[scene, road] - xy, axis=-1)
        # The first of the nearest points: the last one repeats.
        near = jnp.argmin(away, -1)
        lanes = jnp.arange(2)
        point = self.points[scene, road, lanes, near]
        ahead = self.points[scene, road, lanes, jnp.minimum(near + 1, away.shape[1] - 1)]
        behind = self.points[scene, road, lanes, jnp.maximum(near - 1, 0)]
        tangent = ahead - behind
        tangent = tangent / jnp.maximum(jnp.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
        beyond = ((xy - point) * tangent).sum(-1)
        aside = (xy - point)[:, 1] * tangent[:, 0] - (xy - point)[:, 0] * tangent[:, 1]
        return near * STEP + beyond, jnp.abs(aside)

    def at(
        self, scene: Int[Array, ""], road: Int[Array, ""], lane: Int[Array, " A"], station: Float[Array, " A"]
    ) -> tuple[Float[Array, "A 2"], Float[Array, " A"]]:
        """(A, 2) m and headings (A,) rad at stations (A,) m of lanes (A,); those of the ends beyond them."""
        length = self.length[scene, road, lane]
        index = jnp.clip(station, 0.0, length - 1e-3) / STEP
        first = jnp.floor(index).astype(jnp.int32)
        a, b = (self.points[scene, road, lane, jnp.maximum(first + k, 0)] for k in (0, 1))
        before = self.points[scene, road, lane, jnp.maximum(first - 1, 0)]
        # Where the last point repeats, its direction is that of the segment before.
        last = jnp.minimum(first + 2, jnp.round(length / STEP).astype(jnp.int32))
        after = self.points[scene, road, lane, last]
        share = (index - first)[:, None]
        course = (1.0 - share) * (b - before) + share * (after - a)
        return a + share * (b - a), jnp.arctan2(course[:, 1], course[:, 0])


def marked_roads(roads: Mapping[int, Sequence[Road]], share: float) -> dict[int, list[bool]]:
    """Which roads keep their stripes: a share of all, evenly spaced in the order of scenes and crosswalks."""
    found: dict[int, list[bool]] = {}
    count = 0
    for z in sorted(roads):
        found[z] = [np.floor((count + k + 1) * share) > np.floor((count + k) * share) for k in range(len(roads[z]))]
        count += len(roads[z])
    return found


# Routes.


def _half_width(robot: RobotSpec) -> float:
    """m, half the robot's width as a share of the disc around it, as for other routes."""
    return 0.75 * float(robot.planner_radius)


def crossing_routes(
    bank: SceneBank, scene: int, number: int, roads: Mapping[int, Sequence[Road]], robot: RobotSpec
) -> Routes | None:
    """Straight routes over the crosswalks of a scene from pavement to pavement, drawn from `number`, which is that of
    its roads; None if there is none."""
    if not roads[number]:
        return None
    maps = build_clearance_maps(bank, [scene], robot.planner_height)
    clear = np.minimum(maps.to_hull[scene], maps.to_edge[scene]).astype(np.float32)
    grid = Grid(maps.origin[scene], FINE, clear.shape)
    side = round(float(bank.map_resolution) / FINE)
    paved = np.kron(bank.map_kind[scene] == KIND_INDEX["sidewalk"], np.ones((side, side), bool))

    rng = np.random.default_rng(number)
    low, high = _OPTIONS.from_kerb
    needed = _half_width(robot) + _OPTIONS.clearance
    each = -(-_OPTIONS.number // len(roads[number]))
    rows: list[tuple[np.ndarray, np.ndarray]] = []
    for road in roads[number]:
        along = np.array([-road.across[1], road.across[0]])
        aside = max(road.half[1] - needed, 0.0)
        count = _OPTIONS.tries * each
        sign = rng.choice([-1.0, 1.0], count)
        lateral = rng.uniform(-aside, aside, (2, count))
        away = road.half[0] + rng.uniform(low, high, (2, count))
        ends = [
            road.row.centre + (s * sign * a)[:, None] * road.across + b[:, None] * along
            for s, a, b in zip((-1.0, 1.0), away, lateral, strict=True)
        ]
        share = np.linspace(0.0, 1.0, 120)[:, None, None]
        line = ends[0] + share * (ends[1] - ends[0])
        good = (grid.at(clear, line) >= needed).all(0) & grid.at(paved, ends[0]) & grid.at(paved, ends[1])
        # A robot that turns at its start sweeps the disc around it.
        good &= grid.at(clear, ends[0]) >= float(robot.planner_radius) + 0.1
        rows += [(ends[0][k], ends[1][k]) for k in np.flatnonzero(good)[:each]]
    rows = rows[: _OPTIONS.number]
    if not rows:
        return None
    a, b = (np.array([row[k] for row in rows]) for k in (0, 1))
    yaw = np.arctan2(*(b - a).T[::-1])
    start = np.column_stack([a, grid.at(maps.ground[scene], a), yaw])
    goal = np.column_stack([b, grid.at(maps.ground[scene], b)])
    length = np.linalg.norm(b - a, axis=1)
    return Routes(
        start.astype(np.float32), goal[:, None].astype(np.float32), np.ones(len(rows), np.int32), length.astype("f4")
    )


def unmarked(bank: SceneBank, roads: Mapping[int, Sequence[Road]], marked: Mapping[int, Sequence[bool]]) -> SceneBank:
    """The bank without the stripes of roads that are not marked: their surface looks like the nearest road's."""
    names = np.array([*bank.meta["categories"], ""])
    meshes, plain = np.array(bank.slot_mesh), []
    for z, rows in roads.items():
        category = names[bank.slot_category[z]]
        slots = {k: np.flatnonzero((category == f"ground:{k}") & (meshes[z] >= 0)) for k in ("crosswalk", "road")}
        if not all(len(own) for own in slots.values()):
            continue
        middles = {kind: _middles(bank, z, own) for kind, own in slots.items()}
        for road, stripes in zip(rows, marked[z], strict=True):
            if stripes:
                continue
            crosswalk, beside = (
                slots[kind][np.linalg.norm(middles[kind] - road.row.centre, axis=1).argmin()] for kind in slots
            )
            plain.append((int(bank.slot_mesh[z, crosswalk]), int(bank.mesh_material[bank.slot_mesh[z, beside]])))
            # A mesh of its own, because scenes share equal meshes.
            meshes[z, crosswalk] = len(bank.mesh_material) + len(plain) - 1
    if not plain:
        return bank
    arrays: dict[str, np.ndarray] = {"slot_mesh": meshes}
    arrays["mesh_material"] = np.append(bank.mesh_material, [m for _, m in plain]).astype(bank.mesh_material.dtype)
    for start, values in (("mesh_vertex_start", ("mesh_vertices", "mesh_uv")), ("mesh_face_start", ("mesh_faces",))):
        ends = getattr(bank, start)
        counts = np.array([ends[mesh + 1] - ends[mesh] for mesh, _ in plain])
        arrays[start] = np.append(ends, ends[-1] + np.cumsum(counts)).astype(ends.dtype)
        for name in values:
            rows_of = getattr(bank, name)
            arrays[name] = np.concatenate([rows_of, *(rows_of[ends[mesh] : ends[mesh + 1]] for mesh, _ in plain)])
    return dataclasses.replace(bank, **arrays)


def _middles(bank: SceneBank, scene: int, slots: np.ndarray) -> np.ndarray:
    """(n, 2) m, the middles of the boxes around the meshes of slots (n,), which are not turned: those of ground."""
    found = np.zeros((len(slots), 2))
    for k, slot in enumerate(slots):
        mesh = bank.slot_mesh[scene, slot]
        corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1], :2]
        found[k] = 0.5 * (corners.min(0) + corners.max(0)) + bank.slot_position[scene, slot, :2]
    return found


def cleared(bank: SceneBank, roads: Mapping[int, Sequence[Road]]) -> SceneBank:
    """The bank without the objects that stand in the lanes."""
    names = ("inst_hull", "inst_object", "hull_grid", "slot_mesh", "slot_movable")
    tables = {name: np.array(getattr(bank, name)) for name in names}
    reach = _CAR.radius + _OPTIONS.space
    for z, rows in roads.items():
        if not rows:
            continue
        lanes = np.concatenate([lane for road in rows for lane in road.lanes])
        tree = spatial.KDTree(lanes)
        stands = set()
        instances = np.flatnonzero(bank.inst_hull[z] >= 0)
        for k, corners in zip(instances, bank.standing_hulls(z), strict=True):
            # Crowns of trees are above the vehicles; the ground is level within a kerb's height.
            if corners[:, 2].min() > _CAR.height + _OPTIONS.overhead:
                continue
            outline = _outline(corners[:, :2])
            if tree.query(outline)[0].min() < reach or _holds(outline, lanes):
                stands.add(int(bank.inst_object[z, k]))
        gone = np.isin(bank.inst_object[z], list(stands)) & (bank.inst_object[z] >= 0)
        numbers = np.flatnonzero(gone)
        tables["inst_hull"][z, numbers] = tables["inst_object"][z, numbers] = -1
        grid = np.where(np.isin(bank.hull_grid[z], numbers), -1, bank.hull_grid[z])
        # Empty places of a cell come last.
        tables["hull_grid"][z] = np.take_along_axis(grid, np.argsort(grid < 0, axis=-1, kind="stable"), -1)
        slots = np.array(sorted(stands), np.int64)
        tables["slot_mesh"][z, slots], tables["slot_movable"][z, slots] = -1, 0
    return dataclasses.replace(bank, **tables)


def _outline(corners: np.ndarray) -> np.ndarray:
    """Points (n, 2) m on the outline of a hull at most about 0.2 m apart."""
    low, high = corners.min(0), corners.max(0)
    if (high - low).min() < 1e-6:
        return corners
    ring = corners[spatial.ConvexHull(corners, qhull_options="QJ").vertices]
    following = np.roll(ring, -1, axis=0)
    share = np.linspace(0.0, 1.0, 1 + int(np.ceil(np.linalg.norm(following - ring, axis=1).max() / 0.2)))[:, None, None]
    return (ring + share * (following - ring)).reshape(-1, 2)


def _holds(outline: np.ndarray, points: np.ndarray) -> bool:
    """Whether one of the points (n, 2) m is in the box around an outline."""
    return bool(((points >= outline.min(0)) & (points <= outline.max(0))).all(-1).any())


def parameters() -> str:
    """The options of lanes and routes, for keys of caches."""
    return repr(dataclasses.astuple(_OPTIONS))
