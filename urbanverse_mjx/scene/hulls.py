"""Convex hulls in the runtime's format: corners, outward triangles and planes, padded to one size."""

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ..datatypes import validation as v
from ..datatypes.asset import MAX_HULL_VERTICES
from ..datatypes.scene_bank import MAX_HULL_TRIANGLES

#: Triangles with a smaller area, as a share of the hull's squared size, are slivers of Qhull's triangulation of flat
#: facets. Their neighbours lie in the same plane and share their edges, so dropping them does not change the hull.
_MIN_TRIANGLE_SHARE = 1e-12


@dataclasses.dataclass(frozen=True)
class ConvexPart:
    """One convex hull in its own frame.

    Attributes:
      corners: (n, 3) float32, m, extreme points only.
      triangles: (m, 3) int32, counter-clockwise seen from outside.
      planes: (m, 4) float32, outward unit normal n and offset d of each triangle; inside is n·x <= d.
      volume: m^3.
    """

    corners: np.ndarray
    triangles: np.ndarray
    planes: np.ndarray
    volume: float

    @property
    def box(self) -> np.ndarray:
        """(2, 3): centre and half size of the box around the corners, m."""
        low, high = self.corners.min(0), self.corners.max(0)
        return np.stack([(low + high) / 2, (high - low) / 2])


def convex_part(points: np.ndarray, where: str = "hull") -> ConvexPart:
    """Computes the convex hull of `points` (n, 3). The result is cached and must not be modified.

    Raises:
      ValidationError: there are fewer than four points, all lie in one plane, or the hull has more than 32 corners.
    """
    try:
        return _convex_part(np.ascontiguousarray(points, np.float32).tobytes())
    except _NoPart as error:
        raise v.fail(where, *error.args) from error


class _NoPart(ValueError):
    """Error that states what was found, what was needed and what to try."""


# Cached, because a scene uses a hull several times (mass, table), and cousins share assets.
@functools.lru_cache(maxsize=8192)
def _convex_part(content: bytes) -> ConvexPart:
    points = np.frombuffer(content, np.float32).reshape(-1, 3)
    centre = points.astype(np.float64).mean(0)
    try:
        hull = ConvexHull(points.astype(np.float64) - centre)
    except (QhullError, ValueError) as error:
        raise _NoPart(f"{len(points)} points without volume", "a solid", "thicken or drop the part") from error
    if len(hull.vertices) > MAX_HULL_VERTICES:
        raise _NoPart(f"{len(hull.vertices)} corners", f"at most {MAX_HULL_VERTICES}", "simplify the part")
    keep = np.sort(hull.vertices)
    number = np.zeros(len(points), np.int32)
    number[keep] = np.arange(len(keep))
    a, b, c = (hull.points[hull.simplices[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    normals = hull.equations[:, :3]
    flip = np.einsum("ij,ij->i", cross, normals) < 0
    triangles = np.where(flip[:, None], hull.simplices[:, ::-1], hull.simplices)
    solid = np.linalg.norm(cross, axis=1) > _MIN_TRIANGLE_SHARE * np.ptp(hull.points, axis=0).max() ** 2
    offsets = -hull.equations[:, 3] + normals @ centre
    part = ConvexPart(
        corners=points[keep],
        triangles=number[triangles[solid]],
        planes=np.concatenate([normals, offsets[:, None]], 1)[solid].astype(np.float32),
        volume=float(hull.volume),
    )
    for array in (part.corners, part.triangles, part.planes):
        array.flags.writeable = False
    return part


def hull_table(parts: Sequence[ConvexPart]) -> dict[str, np.ndarray]:
    """The `hull_*` arrays of a `SceneBank`, one row per part."""
    t, n, f = len(parts), MAX_HULL_VERTICES, MAX_HULL_TRIANGLES
    table = {
        "hull_vertices": np.zeros((t, n, 3), np.float32),
        "hull_num_vertices": np.array([len(p.corners) for p in parts], np.int32),
        "hull_triangles": np.zeros((t, f, 3), np.int32),
        "hull_num_triangles": np.array([len(p.triangles) for p in parts], np.int32),
        "hull_planes": np.zeros((t, f, 4), np.float32),
        "hull_box": np.zeros((t, 2, 3), np.float32),
    }
    for row, part in enumerate(parts):
        table["hull_vertices"][row] = _padded(part.corners, n)
        table["hull_triangles"][row] = _padded(part.triangles, f)
        table["hull_planes"][row] = _padded(part.planes, f)
        table["hull_box"][row] = part.box
    return table


def _padded(rows: np.ndarray, length: int) -> np.ndarray:
    """Pads `rows` with copies of the first row."""
    return np.concatenate([rows, np.repeat(rows[:1], length - len(rows), 0)])
