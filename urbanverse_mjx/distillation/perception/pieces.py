"""Splits a trajectory where matches are missing and joins its pieces.

When a camera turns in front of a bare wall, the images before and after have no match. Each piece alone is correct,
upright and metric. The rotation about z and the shift between pieces are unknown; the shift is nearly known, because
the camera continues at its speed. The rotation is the one at which walls, poles and cars of both pieces coincide, since
both show the street around their meeting point.
"""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
from scipy import ndimage

from ...geometry import rotations


@dataclasses.dataclass(frozen=True)
class CutOptions:
    """Conditions for cutting a trajectory, and limits of the comparison of its pieces.

    Chosen manually; docs/decisions/gen_perception.md measures their effect on poses.

    Attributes:
      window: steps on either side from which the camera's speed is computed.
      min_frames: fewest frames of a piece.
      jump_ratio: a step longer than its neighbours by this factor is a jump to a similar-looking place.
      break_ratio: where the step length changes abruptly by this factor, the unit of the structure changes.
      max_range: m; points within this distance of the meeting point of two pieces are compared.
      max_below: m below the cameras, lower limit of the compared points.
      max_above: m above the cameras, upper limit of the compared points.
      coarse_search: step of the rotation (rad), range of the rotation to either side (rad), cell size (m), step of the
        shift (m).
      fine_search: the same for the search around the best coarse result.
      meeting_error: m, error of the meeting point of two pieces.
      meeting_error_frame: m, additional error for every frame in between.
      max_meeting_error: m, upper limit of the error of the meeting point.
    """

    window: int = 5
    min_frames: int = 4
    jump_ratio: float = 3.0
    break_ratio: float = 2.0
    max_range: float = 40.0
    max_below: float = 1.1
    max_above: float = 5.0
    coarse_search: tuple[float, float, float, float] = (np.radians(2.0), np.pi, 0.5, 0.5)
    fine_search: tuple[float, float, float, float] = (np.radians(0.5), np.radians(4.0), 0.25, 0.125)
    meeting_error: float = 0.5
    meeting_error_frame: float = 0.25
    max_meeting_error: float = 3.0


_CUT = CutOptions()


@dataclasses.dataclass(frozen=True)
class JoinOptions:
    """Conditions for joining two pieces by their common structure.

    Chosen manually; docs/decisions/gen_perception.md measures their effect on poses.

    Attributes:
      min_share: least share of a piece's occupied cells that match the other piece.
      other_turn_ratio: least ratio of the best rotation's score to that of any rotation farther away than `other_turn`.
      other_turn: rad.
      model_turn_ratio: least ratio of the best rotation's score to that of the model's own rotation within
        `model_turn`.
      model_turn: rad.
      turn_error: rad, how far off the rotation may be from that of a camera that keeps turning.
      turn_error_frame: rad, more of it for every usual interval from one piece to the next.
    """

    min_share: float = 0.25
    other_turn_ratio: float = 1.7
    other_turn: float = float(np.radians(35.0))
    model_turn_ratio: float = 1.5
    model_turn: float = float(np.radians(10.0))
    turn_error: float = float(np.radians(20.0))
    turn_error_frame: float = float(np.radians(10.0))


_JOIN = JoinOptions()


@dataclasses.dataclass(frozen=True)
class Piece:
    """Some frames of a trajectory, upright and in metres, in a coordinate frame of their own.

    Attributes:
      rows: (k,) of the structure's registered frames.
      frames: (k,) their numbers, ascending.
      at: (k,) their times in usual intervals between frames; more than 1 apart where frames were left out.
      model: pieces of one model also have a relative rotation, with a larger error.
      poses: (k, 4, 4) T_piece_camera, z up.
      points: (p, 3) m, points of the structure.
    """

    rows: np.ndarray
    frames: np.ndarray
    at: np.ndarray
    model: int
    poses: np.ndarray
    points: np.ndarray


def cut(model: np.ndarray, registered: np.ndarray, poses: np.ndarray) -> list[np.ndarray]:
    """Rows (k,) of every piece; models are cut where the path jumps or its unit changes.

    Args:
      model, registered, poses: (m,), (m,) and (m, 4, 4), as in `Structure`.
    """
    pieces: list[np.ndarray] = []
    for one in np.unique(model):
        rows = np.flatnonzero(model == one)
        distance = np.linalg.norm(np.diff(poses[rows, :3, 3], axis=0), axis=1)
        pieces += _cut(rows, distance / np.diff(registered[rows]), float(np.median(distance)) if len(distance) else 0.0)
    return [rows for rows in pieces if len(rows) >= _CUT.min_frames] or [max(pieces, key=len)]


def _cut(rows: np.ndarray, steps: np.ndarray, common: float) -> list[np.ndarray]:
    """Cuts rows (k,) of one model recursively at the worst step, given the (k - 1,) steps per frame and their common
    length."""
    # A pause of the camera is neither a change of the unit nor a jump.
    floor = 0.1 * common + 1e-12
    worst, at = 1.0, -1
    for k in range(len(steps)):
        sides = [side for side in (steps[max(0, k - _CUT.window) : k], steps[k + 1 : k + 1 + _CUT.window]) if len(side)]
        usual = [float(np.median(side)) + floor for side in sides] or [np.inf]
        breaks = max(usual) / min(usual) / _CUT.break_ratio if min(k, len(steps) - 1 - k) >= 3 else 0.0
        wrong = max(float(steps[k]) / (_CUT.jump_ratio * max(common, *usual)), breaks)
        if wrong > worst:
            worst, at = wrong, k
    if at < 0:
        return [rows]
    return _cut(rows[: at + 1], steps[:at], common) + _cut(rows[at + 1 :], steps[at + 1 :], common)


def join(pieces: Sequence[Piece]) -> list[np.ndarray | None]:
    """(4, 4) T_world_piece of every piece, None if no rotation fits. The world frame is that of the longest piece.

    The other pieces are joined in the order of their distance in time from the joined ones.
    """
    first = max(range(len(pieces)), key=lambda k: len(pieces[k].rows))
    out: list[np.ndarray | None] = [None] * len(pieces)
    out[first] = np.eye(4)
    joined, left = pieces[first], set(range(len(pieces))) - {first}
    while left:
        for k in sorted(left, key=lambda k: _apart(joined, pieces[k])):
            turned = _beside(pieces, out, k)
            place = _meet(joined, pieces[k], turned)
            if place is not None:
                out[k] = place
                joined = _together(joined, pieces[k], place)
                left.remove(k)
                break
        else:
            return out
    return out


def _apart(a: Piece, b: Piece) -> int:
    return int(np.abs(a.frames[:, None] - b.frames[None]).min())


def _beside(pieces: Sequence[Piece], places: Sequence[np.ndarray | None], k: int) -> float | None:
    """rad, rotation of the joined piece of the same model that is nearest in time; None without one."""
    known = [
        (_apart(piece, pieces[k]), place)
        for piece, place in zip(pieces, places, strict=True)
        if place is not None and piece.model == pieces[k].model
    ]
    if not known:
        return None
    _, place = min(known, key=lambda found: found[0])
    return float(np.arctan2(place[1, 0], place[0, 0]))


def _together(joined: Piece, piece: Piece, place: np.ndarray) -> Piece:
    order = np.argsort(np.r_[joined.frames, piece.frames], kind="stable")
    return dataclasses.replace(
        joined,
        rows=np.r_[joined.rows, piece.rows][order],
        frames=np.r_[joined.frames, piece.frames][order],
        at=np.r_[joined.at, piece.at][order],
        poses=np.concatenate([joined.poses, place @ piece.poses])[order],
        points=np.concatenate([joined.points, piece.points @ place[:3, :3].T + place[:3, 3]]),
    )


def _speed(piece: Piece, row: int) -> np.ndarray:
    """(3,) m per frame around a row."""
    low, high = max(0, row - 2), min(len(piece.frames) - 1, row + 2)
    return (piece.poses[high, :3, 3] - piece.poses[low, :3, 3]) / max(1, piece.frames[high] - piece.frames[low])


def _meet(joined: Piece, piece: Piece, turned: float | None) -> np.ndarray | None:
    """(4, 4) that aligns a piece with the joined ones at the two frames nearest in time; None if no rotation fits.

    Args:
      turned: rad, rotation to use if the surroundings do not determine one.
    """
    gap = joined.frames[:, None] - piece.frames[None]
    a, b = np.unravel_index(np.argmin(np.abs(gap)), gap.shape)
    frames = -int(gap[a, b])
    here, there = joined.poses[a, :3, 3], piece.poses[b, :3, 3]
    before, after = _speed(joined, int(a)), _speed(piece, int(b))

    def goes_on(angle: float) -> np.ndarray:
        return frames / 2 * (before + rotations.about_z(angle) @ after)

    grown = min(_CUT.meeting_error + _CUT.meeting_error_frame * (abs(frames) - 1), _CUT.max_meeting_error)
    known, own = _near(joined.points - here), _near(piece.points - there)
    angle, shift = turned, np.zeros(2)
    if len(known) and len(own):
        cells = np.unique(np.round(own / 0.3).astype(int), axis=0) * 0.3
        turns, scores, shifts = _search(known, cells, goes_on, 0.0, np.zeros(2), _CUT.coarse_search, grown)
        likely, reach = _turned_on(joined, int(a), piece, int(b))
        scores = np.where(_away(turns, likely) <= reach, scores, 0.0)
        best = int(scores.argmax())
        second = _JOIN.other_turn_ratio * scores[_away(turns, turns[best]) > _JOIN.other_turn].max()
        if turned is not None:
            second = max(second, _JOIN.model_turn_ratio * scores[_away(turns, turned) < _JOIN.model_turn].max())
        if scores[best] > max(_JOIN.min_share, second):
            fine = _search(known, cells, goes_on, turns[best], shifts[best], _CUT.fine_search, _CUT.coarse_search[3])
            best = int(fine[1].argmax())
            angle, shift = float(fine[0][best]), fine[2][best]
    if angle is None:
        return None
    place = np.eye(4)
    place[:3, :3] = rotations.about_z(angle)
    place[:3, 3] = here + goes_on(angle) * [1.0, 1.0, 0.0] + np.r_[shift, 0.0] - place[:3, :3] @ there
    return place


def _turned_on(joined: Piece, a: int, piece: Piece, b: int) -> tuple[float, float]:
    """rad, the rotation of a piece if the camera kept turning as before and after, and how far off that may be."""
    elapsed = float(piece.at[b] - joined.at[a])
    rate = (_turn_rate(joined, a) + _turn_rate(piece, b)) / 2
    likely = _heading(joined, a) + elapsed * rate - _heading(piece, b)
    return likely, _JOIN.turn_error + abs(elapsed) * _JOIN.turn_error_frame


def _heading(piece: Piece, row: int) -> float:
    """rad, direction of the camera's axis about z."""
    return float(np.arctan2(piece.poses[row, 1, 2], piece.poses[row, 0, 2]))


def _turn_rate(piece: Piece, row: int) -> float:
    """rad per usual interval around a row."""
    low, high = max(0, row - 1), min(len(piece.frames) - 1, row + 1)
    turn = np.angle(np.exp(1j * (_heading(piece, high) - _heading(piece, low))))
    return float(turn) / max(1.0, piece.at[high] - piece.at[low])


def _away(turns: np.ndarray, turn: float) -> np.ndarray:
    """(t,) rad, absolute differences between angles and one angle."""
    return np.abs(np.angle(np.exp(1j * (turns - turn))))


def _near(points: np.ndarray) -> np.ndarray:
    """Points (p, 3) relative to the meeting place that stand above the ground near it."""
    near = (np.abs(points[:, :2]) < _CUT.max_range).all(1)
    return points[near & (points[:, 2] > -_CUT.max_below) & (points[:, 2] < _CUT.max_above)]


def _search(
    known: np.ndarray,
    own: np.ndarray,
    goes_on: Callable[[float], np.ndarray],
    middle: float,
    start: np.ndarray,
    steps: tuple[float, float, float, float],
    reach: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rotations (t,) rad; the share (t,) of a piece's points near known ones (p, 3) m at the best shift; and that shift
    (t, 2) m. Points are relative to the meeting point of the pieces."""
    turn_step, turn_reach, size, shift_step = steps
    cell = np.array([size, size, 1.0])
    extent = _CUT.max_range + _CUT.max_meeting_error + 3.0
    low = -np.array([extent, extent, _CUT.max_below + 1.0])
    shape = np.ceil(-2 * low[:2] / size).astype(int)
    grid = np.zeros((*shape, int(_CUT.max_above - low[2]) + 2), np.float32)
    grid[tuple(np.floor((known - low) / cell).astype(int).T)] = 1.0
    # The weight of a point falls with its distance from a known one: 1 in the same cell, one half at about 0.6 cells.
    near = np.minimum(4.0 * ndimage.gaussian_filter(grid, (0.8, 0.8, 0.5)), 1.0)
    half = round(turn_reach / turn_step)
    turns = middle + turn_step * np.arange(-half, half + 1)
    offsets = np.arange(-reach, reach + 1e-9, shift_step)
    shifts = start + np.stack(np.meshgrid(offsets, offsets, indexing="ij"), -1).reshape(-1, 2)
    scores, best = np.zeros(len(turns)), np.zeros((len(turns), 2))
    for k, turn in enumerate(turns):
        moved = own @ rotations.about_z(turn).T + goes_on(turn) * [1.0, 1.0, 0.0]
        found = []
        for shift in shifts:
            at = np.floor((moved + np.r_[shift, 0.0] - low) / cell).astype(int)
            inside = ((at >= 0) & (at < grid.shape)).all(1)
            found.append(near[tuple(at[inside].T)].sum())
        scores[k] = max(found) / len(own)
        best[k] = shifts[int(np.argmax(found))]
    return turns, scores, best
