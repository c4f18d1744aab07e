"""Where a small robot could drive in a view: reachable objects, free directions, and the carriageway ahead.

All of it is read from the scene's map with a margin: cells of 0.2 m, clearance to the nearest object between 0.3 and
2 m above the ground or to the end of pavements, crosswalks and paths.
"""

import math

import numpy as np
from scipy import ndimage

from urbanverse_mjx.capture.street import CELL
from urbanverse_mjx.datatypes import KIND_INDEX

from .facts import Facts, Seen
from .views import FOVY, HEIGHT, WIDTH

#: m, half the robot's width with and without the margin: free needs the first, blocked is below the second.
WIDE, NARROW = 0.5, 0.3
#: m from an object at which it counts as reached, with and without the margin.
NEAR, NEAR_WIDE = 0.8, 1.4
#: Degrees to each side, and m: the directions of which one is free, and where judging them starts.
TURNS, LENGTHS, START = (15, 25), (4, 7), 0.6
#: Degrees to the left, m: the stretches that are judged for right of way, their half width, and the least length on the
#: carriageway.
STRETCHES, AHEAD, HALF_LANE, LEAST_ROAD = (
    {"straight ahead": 0, "20 degrees to the left": 20, "20 degrees to the right": -20},
    8.0,
    0.4,
    1.0,
)
_STEP = 0.1  # m
_HALF_ANGLE = math.atan(math.tan(FOVY / 2) * WIDTH / HEIGHT)


def reachable(facts: Facts, seen: Seen) -> bool | None:
    """Whether the robot can drive from the camera to an object without leaving pavements, crosswalks and paths.

    Returns:
      True if it can within the view even with a margin, False if it cannot anywhere without the margin, else None.
    """
    street, view = facts.street, facts.view
    target = _near(facts, seen)
    at = tuple(street.cell(view.position[:2]))
    close = np.hypot(*(street.middle(np.indices(street.kind.shape).transpose(1, 2, 0)) - view.position[:2]).T).T
    # The camera may stand nearer to something than the margin: the robot starts in the open next to it.
    start = close <= 1.0
    wide = (street.clearance >= WIDE) & in_view(facts, close)
    if _joined(wide, start, target <= NEAR):
        return True
    narrow = (street.clearance >= NARROW) | (start & (street.clearance > 0))
    if street.clearance[at] > 0 and not _joined(narrow, start, target <= NEAR_WIDE):
        return False
    return None


def in_view(facts: Facts, close: np.ndarray) -> np.ndarray:
    """(X, Y) bool: cells of the street's grid that are before the camera, or within 1.5 m of it."""
    street, view = facts.street, facts.view
    away = street.middle(np.indices(street.kind.shape).transpose(1, 2, 0)) - view.position[:2]
    turn = np.arctan2(away[..., 1], away[..., 0]) - view.yaw
    return (np.abs(np.angle(np.exp(1j * turn))) < _HALF_ANGLE) | (close <= 1.5)


def _near(facts: Facts, seen: Seen) -> np.ndarray:
    """(X, Y) m: distance of cells to an object's collision hulls, or to where its mesh stands if it has none."""
    bank, scene, street = facts.bank, facts.scene, facts.street
    own = np.zeros(street.kind.shape, bool)
    rows = np.flatnonzero((bank.inst_object[scene] == seen.slot) & (bank.inst_hull[scene] >= 0))
    for row in rows:
        hull = bank.inst_hull[scene, row]
        local = bank.hull_vertices[hull, : bank.hull_num_vertices[hull]]
        world = local @ bank.inst_rotation[scene, row].T + bank.inst_position[scene, row]
        low = world[world[:, 2] < world[:, 2].min() + 1.5, :2]
        middle = low.mean(0)
        for share in np.linspace(0.0, 1.0, 9):
            i, j = street.cell(middle + share * (low - middle)).T
            own[i, j] = True
    if not len(rows):
        own[tuple(street.cell(bank.slot_position[scene, seen.slot, :2]))] = True
    return ndimage.distance_transform_edt(~own) * CELL


def _joined(free: np.ndarray, start: np.ndarray, end: np.ndarray) -> bool:
    parts, _ = ndimage.label(free, np.ones((3, 3)))
    return bool((set(parts[start & free].tolist()) & set(parts[end & free].tolist())) - {0})


def line(facts: Facts, turn: float, first: float, last: float, aside: float = 0.0) -> np.ndarray:
    """Points (n, 2) m along a direction: `turn` rad to the left of the view, `first` to `last` m, `aside` m left."""
    along = np.arange(first, last + _STEP / 2, _STEP)
    c, s = math.cos(facts.view.yaw + turn), math.sin(facts.view.yaw + turn)
    return facts.view.position[:2] + along[:, None] * [c, s] + aside * np.array([-s, c])


def free_direction(facts: Facts, degrees: float, length: float) -> str | None:
    """The one of "left", "straight ahead" and "right" that is free for `length` m, or None if that is not certain."""
    street, states = facts.street, {}
    turn = math.radians(degrees)
    for name, angle in (("left", turn), ("straight ahead", 0.0), ("right", -turn)):
        i, j = street.cell(line(facts, angle, START, length)).T
        clearance = street.clearance[i, j]
        blocked = clearance[: round((length - START - 0.5) / _STEP)].min() < NARROW
        states[name] = True if clearance.min() >= WIDE else False if blocked else None
    free = [name for name, state in states.items() if state]
    return free[0] if len(free) == 1 and None not in states.values() else None


def yields_to_vehicles(facts: Facts, degrees: float) -> bool | None:
    """Whether walking `AHEAD` m, `degrees` to the left of the view, enters the carriageway outside of a crosswalk.

    Returns:
      None if it only touches it, or if the ground there is not visible.
    """
    turn = math.radians(degrees)
    road = [KIND_INDEX["road"], KIND_INDEX["road_marking"]]
    lengths = []
    for aside in (-HALF_LANE, 0.0, HALF_LANE):
        kinds = facts.kind_at(line(facts, turn, 0.3, AHEAD, aside))
        if (kinds == 0).any():
            return None
        lengths.append(np.isin(kinds, road).sum() * _STEP)
    points = line(facts, turn, 2.5, AHEAD)
    height = facts.street.height[tuple(facts.street.cell(points).T)]
    pixels, _ = facts.view.project(np.column_stack([points, np.nan_to_num(height, nan=facts.view.ground)]))
    cells = np.floor(pixels).astype(int)
    inside = np.all((cells >= 0) & (cells < facts.view.slots.shape), axis=-1)
    slots = facts.view.slots[tuple(cells[inside].T)]
    visible = (slots >= 0) & facts.grounds[np.maximum(slots, 0)]
    if not inside.any() or visible.mean() < 0.9:
        return None
    if min(lengths) >= LEAST_ROAD:
        return True
    return False if max(lengths) == 0.0 else None
