"""Bridges the breaks of a structure by mappings of the frames around each.

At some places the incremental mapping of a whole film registers frames to distant points alone: their steps become
several times too long, and what comes after is turned by any angle. The images are not to blame there: the mapping of
the frames around the break, which begins with another pair, is mostly right. It shares frames with both sides, on which
it is laid by similarities; its own poses replace those in between. Sides that it does not fit stay as they are, to be
joined by what both show (`pieces`).
"""

import dataclasses
from collections.abc import Callable, Iterable

import numpy as np
from scipy.spatial.transform import Rotation

from .pieces import cut
from .structure import Structure


@dataclasses.dataclass(frozen=True)
class BridgeOptions:
    """Limits of a bridge.

    Chosen manually; docs/decisions/gen_perception.md measures their effect on poses.

    Attributes:
      pads: frames on either side of a break that are mapped again; the next number is tried where the bridge does not
        fit.
      edge: frames next to a break whose poses are not trusted, at least; the bridge's replace them, and those of more
        frames where it does not fit them.
      min_side: fewest frames of a side; shorter pieces belong to the break, because they often are wrong in themselves.
      min_common: fewest frames that a bridge shares with each side.
      max_gap: frames, longest break.
      max_turn: rad, largest difference of orientation in a common frame after the similarity.
      max_shift: largest distance of the camera in a common frame after the similarity, in its median steps.
      max_speed_ratio: largest ratio between the median steps of the common frames and of the whole side, either way:
        several wrong frames can all have the same wrong unit.
    """

    pads: tuple[int, ...] = (14, 20, 28)
    edge: int = 2
    min_side: int = 16
    min_common: int = 6
    max_gap: int = 60
    max_turn: float = float(np.radians(2.0))
    max_shift: float = 0.3
    max_speed_ratio: float = 1.6


_BRIDGE = BridgeOptions()
#: Function (first frame, last frame) -> their structure, mapped alone; None if that fails.
Rebuild = Callable[[int, int], Structure | None]


@dataclasses.dataclass(frozen=True)
class _Part:
    """Some frames of a structure, and where they go.

    Attributes:
      structure: whose frames they are.
      rows: (k,) of its registered frames, in order.
      place: (4, 4) similarity from the structure's unit and axes to the result's.
      group: the result's model.
    """

    structure: Structure
    rows: np.ndarray
    place: np.ndarray
    group: int

    @property
    def frames(self) -> np.ndarray:
        """(k,) numbers of the frames."""
        return self.structure.registered[self.rows]

    @property
    def step(self) -> float:
        """Median distance between neighbouring cameras, in the unit of the part's structure."""
        return self.structure.step(self.rows)

    def between(self, first: float, last: float) -> "_Part":
        """The part with only the frames from `first` to `last`."""
        frames = self.frames
        return dataclasses.replace(self, rows=self.rows[(frames >= first) & (frames <= last)])


def bridged(structure: Structure, rebuild: Rebuild) -> Structure:
    """A structure whose breaks are bridged where a mapping of the frames around fits both sides; the same object if no
    break is."""
    pieces = cut(structure.model, structure.registered, structure.poses)
    out: list[_Part] = []
    groups: dict[int, tuple[np.ndarray, int]] = {}
    found, count = 0, 0
    for rows in sorted(pieces, key=lambda rows: int(structure.registered[rows[0]])):
        model, part = int(structure.model[rows[0]]), _Part(structure, rows, np.eye(4), 0)
        side = _last_side(out)
        bridge = _bridge(out[side], part, rebuild) if side is not None and _is_side(part) else None
        if bridge is not None:
            # Shorter pieces after the last side are part of the break.
            out[side:] = bridge
            found += 1
        else:
            # In the unit and axes of the model's earlier parts, or in its own.
            if model not in groups:
                count += 1
            place, group = groups.get(model, (part.place, count - 1))
            out.append(dataclasses.replace(part, place=place, group=group))
        groups[model] = out[-1].place, out[-1].group
    return dataclasses.replace(_combined(structure, out), bridges=found) if found else structure


def _is_side(part: _Part) -> bool:
    """Whether a part is long enough for a bridge to be laid on."""
    return len(part.rows) >= _BRIDGE.min_side


def _last_side(parts: list[_Part]) -> int | None:
    """The last of the parts that are long enough."""
    return next((k for k in reversed(range(len(parts))) if _is_side(parts[k])), None)


def _bridge(before: _Part, after: _Part, rebuild: Rebuild) -> tuple[_Part, _Part, _Part] | None:
    """The first of two parts, the frames between them, and the second, shortened where the bridge replaces it and moved
    to the first; None if no mapping fits."""
    last, first = int(before.frames[-1]), int(after.frames[0])
    if not 0 < first - last <= _BRIDGE.max_gap:
        return None
    windows = [
        (max(int(before.frames[0]), last - pad), min(int(after.frames[-1]), first + pad)) for pad in _BRIDGE.pads
    ]
    for low, high in dict.fromkeys(windows):
        again = rebuild(low, high)
        # Where no matches lead across, more frames do not help.
        if again is None or np.ptp(again.model) > 0:
            return None
        if len(cut(again.model, again.registered, again.poses)) > 1:
            continue
        edges = range(_BRIDGE.edge, max(_BRIDGE.pads))
        onto = _first_fit(again, before, (before.between(low, last - edge) for edge in edges))
        back = _first_fit(again, after, (after.between(first + edge, high) for edge in edges))
        if onto is not None and back is not None:
            (place, start), (inverse, end) = onto, back
            place = before.place @ place
            own = _Part(again, np.arange(len(again.registered)), place, before.group)
            return (
                before.between(-np.inf, start.frames[-1]),
                own.between(start.frames[-1] + 1, end.frames[0] - 1),
                dataclasses.replace(
                    after.between(end.frames[0], np.inf), place=place @ np.linalg.inv(inverse), group=before.group
                ),
            )
    return None


def _first_fit(structure: Structure, side: _Part, parts: Iterable[_Part]) -> tuple[np.ndarray, _Part] | None:
    """The similarity of `_laid` onto the first part of a side that a structure fits, and that part; None if it fits
    none."""
    usual = side.step
    for part in parts:
        place = _laid(structure, part)
        if place is not None and abs(np.log(part.step / usual)) <= np.log(_BRIDGE.max_speed_ratio):
            return place, part
    return None


def _laid(structure: Structure, part: _Part) -> np.ndarray | None:
    """(4, 4) similarity from a structure's unit and axes to those of a part's structure, by their common frames; None
    if they are too few or differ."""
    _, own, there = np.intersect1d(structure.registered, part.frames, return_indices=True)
    if len(own) < _BRIDGE.min_common:
        return None
    a, b = structure.poses[own], part.structure.poses[part.rows[there]]
    turns = Rotation.from_matrix(b[:, :3, :3] @ np.swapaxes(a[:, :3, :3], 1, 2))
    turn = turns.mean()
    here, goal = a[:, :3, 3], b[:, :3, 3]
    spread = np.linalg.norm(here - here.mean(0))
    if spread <= 0.0 or part.step <= 0.0:
        return None
    scale = np.linalg.norm(goal - goal.mean(0)) / spread
    place = np.eye(4)
    place[:3, :3] = scale * turn.as_matrix()
    place[:3, 3] = goal.mean(0) - place[:3, :3] @ here.mean(0)
    shifts = np.linalg.norm(here @ place[:3, :3].T + place[:3, 3] - goal, axis=1) / part.step
    angles = (turns * turn.inv()).magnitude()
    return place if shifts.max() <= _BRIDGE.max_shift and angles.max() <= _BRIDGE.max_turn else None


def _combined(structure: Structure, parts: list[_Part]) -> Structure:
    """One structure of all parts. A point that several parts see becomes one of each, because they move apart."""
    parts = [part for part in parts if len(part.rows)]
    registered, poses, points, model = [], [], [], []
    frame, point, pixel = [], [], []
    frames_before = points_before = 0
    for part in parts:
        own, turn = part.structure, part.place[:3, :3]
        scale = np.cbrt(np.linalg.det(turn))
        moved = np.tile(np.eye(4), (len(part.rows), 1, 1))
        moved[:, :3, :3] = turn / scale @ own.poses[part.rows, :3, :3]
        moved[:, :3, 3] = own.poses[part.rows, :3, 3] @ turn.T + part.place[:3, 3]
        new = np.full(len(own.registered), -1)
        new[part.rows] = np.arange(len(part.rows))
        seen = new[own.frame] >= 0
        used, number = np.unique(own.point[seen], return_inverse=True)
        registered.append(part.frames)
        poses.append(moved)
        points.append(own.points[used] @ turn.T + part.place[:3, 3])
        frame.append(frames_before + new[own.frame[seen]])
        point.append(points_before + number)
        pixel.append(own.pixel[seen])
        model.append(np.full(len(part.rows), part.group))
        frames_before, points_before = frames_before + len(part.rows), points_before + len(used)
    whole = dataclasses.replace(
        structure,
        registered=np.concatenate(registered).astype(np.int32),
        poses=np.concatenate(poses),
        points=np.concatenate(points),
        frame=np.concatenate(frame).astype(np.int32),
        point=np.concatenate(point).astype(np.int32),
        pixel=np.concatenate(pixel),
        model=np.concatenate(model).astype(np.int32),
    )
    return whole.only(np.argsort(whole.registered))
