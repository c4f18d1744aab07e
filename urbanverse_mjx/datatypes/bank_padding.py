"""Padding of the arrays of scene banks: what fills a scene's rows up to the largest scene's, and its removal."""

import numpy as np

#: Fill values of padding, where not 0.
EMPTY = {
    "inst_hull": -1,
    "inst_object": -1,
    "inst_friction": 1.0,
    "prism_hull": -1,
    "prism_friction": 1.0,
    "prism_material_friction": 1.0,
    "hull_grid": -1,
    "prism_grid": -1,
    "slot_mesh": -1,
    "slot_category": -1,
}
_TURNS = {"inst_rotation": np.identity(3, dtype=np.float32), "slot_quaternion": np.array([1, 0, 0, 0], np.float32)}
_WAYPOINTS = "episode_waypoints"


def fill_up(out: np.ndarray, name: str, part: np.ndarray) -> None:
    """Writes a scene's array into one of at least its size and fills the rest with padding.

    Args:
      out: of one scene, with as many axes as `part`; its content is overwritten.
      name: field of `SceneBank`.
      part: what comes before the padding, at least one episode where it is of episodes.
    """
    if out.shape != part.shape:
        out[...] = _TURNS[name] if name in _TURNS else EMPTY.get(name, 0)
    out[tuple(slice(0, n) for n in part.shape)] = part
    if name == _WAYPOINTS and part.shape[1] < out.shape[1]:
        out[: len(part), part.shape[1] :] = out[: len(part), part.shape[1] - 1 : part.shape[1]]
    if name.startswith("episode_") and len(part) < len(out):
        out[len(part) :] = out[:1]


def trimmed(name: str, array: np.ndarray) -> np.ndarray:
    """The smallest part of a scene's array (a view) from which `fill_up` makes all of it, bit for bit.

    Args:
      name: field of `SceneBank`.
      array: (...) of one scene.
    """
    if not array.ndim or not array.size:
        return array
    if name.startswith("episode_"):
        same = _bits(array) == _bits(array[:1])
        other = np.flatnonzero(~same.reshape(len(array), -1).all(1))
        return array[: int(other[-1]) + 1 if len(other) else 1]
    if name in _TURNS:
        other = (_bits(array) != _bits(_TURNS[name])).reshape(len(array), -1).any(1)
        return array[: _end(other)]
    other = _bits(array) != _bits(np.array(EMPTY.get(name, 0), array.dtype))
    # Positions and the like keep their last axis: a vector is not cut.
    axes = range(array.ndim if array.dtype.kind in "iu" else 1)
    ends = [_end(other.any(tuple(i for i in range(array.ndim) if i != axis))) for axis in axes]
    return array[tuple(slice(0, end) for end in ends)]


def _end(rows: np.ndarray) -> int:
    found = np.flatnonzero(rows)
    return int(found[-1]) + 1 if len(found) else 0


def _bits(array: np.ndarray) -> np.ndarray:
    """The numbers as whole numbers of their bits, among which -0.0 is not 0.0."""
    array = np.ascontiguousarray(array) if array.ndim else array
    return array.view(f"u{array.dtype.itemsize}")
