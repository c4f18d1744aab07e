"""Unit-independent measures of a file's triangles, computed once for `corruption`."""

import dataclasses
import functools

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

WELD = 1e-5  # of the diagonal: vertices nearer than this are one


@dataclasses.dataclass(frozen=True)
class Shape:
    """A welded mesh, z up, scaled to a diagonal of 1 and standing on z = 0.

    Attributes:
      vertices: (V, 3).
      faces: (F, 3), none with two equal corners.
      degenerate: share of the file's faces that had two equal corners or no area.
    """

    vertices: np.ndarray
    faces: np.ndarray
    degenerate: float

    @staticmethod
    def of(vertices: np.ndarray, faces: np.ndarray) -> "Shape":
        """Welds a mesh of (V, 3) vertices and (F, 3) faces."""
        used, faces = np.unique(faces, return_inverse=True)
        vertices, faces = vertices[used], faces.reshape(-1, 3)
        low, high = vertices.min(0), vertices.max(0)
        diagonal = float(np.linalg.norm(high - low)) or 1.0
        vertices = (vertices - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]) / diagonal
        _, first, inverse = np.unique(np.round(vertices / WELD), axis=0, return_index=True, return_inverse=True)
        vertices, faces = vertices[first], inverse.reshape(-1)[faces]
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        good = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12
        return Shape(vertices, faces[good], 1.0 - float(good.mean()))

    @property
    def extent(self) -> np.ndarray:
        """(3,) box of the vertices in use."""
        seen = self.vertices[np.unique(self.faces)]
        return seen.max(0) - seen.min(0)

    @functools.cached_property
    def area_vectors(self) -> np.ndarray:
        """(F, 3) normal times area of each face."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return np.cross(b - a, c - a) / 2

    @functools.cached_property
    def areas(self) -> np.ndarray:
        """(F,) areas."""
        return np.linalg.norm(self.area_vectors, axis=1)

    @functools.cached_property
    def normals(self) -> np.ndarray:
        """(F, 3) unit normals."""
        return self.area_vectors / self.areas[:, None]

    @functools.cached_property
    def label(self) -> np.ndarray:
        """(F,) number of the connected component of each face."""
        rows, columns = self.faces[:, [0, 1]].ravel(), self.faces[:, [1, 2]].ravel()
        n = len(self.vertices)
        _, label = connected_components(coo_matrix((np.ones(len(rows)), (rows, columns)), (n, n)), directed=False)
        return np.unique(label[self.faces[:, 0]], return_inverse=True)[1]

    @functools.cached_property
    def boxes(self) -> np.ndarray:
        """(C, 2, 3) least and greatest corner of each component."""
        count = int(self.label.max()) + 1
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        corners = self.vertices[self.faces]
        np.minimum.at(low, self.label, corners.min(1))
        np.maximum.at(high, self.label, corners.max(1))
        return np.stack([low, high], axis=1)

    @functools.cached_property
    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """(faces on each edge (E,), (P, 2) pairs of faces that share an edge alone)."""
        f = np.arange(len(self.faces))
        edges = np.sort(np.concatenate([self.faces[:, [0, 1]], self.faces[:, [1, 2]], self.faces[:, [2, 0]]]), axis=1)
        owner = np.concatenate([f, f, f])
        order = np.lexsort((edges[:, 1], edges[:, 0]))
        edges, owner = edges[order], owner[order]
        starts = np.flatnonzero(np.concatenate([[True], (edges[1:] != edges[:-1]).any(1)]))
        counts = np.diff(np.append(starts, len(edges)))
        twos = starts[counts == 2]
        return counts, np.column_stack([owner[twos], owner[twos + 1]])

    @functools.cached_property
    def bends(self) -> np.ndarray:
        """(P,) angle between the two faces at each shared edge, rad."""
        pairs = self.edges[1]
        cosine = np.einsum("ij,ij->i", self.normals[pairs[:, 0]], self.normals[pairs[:, 1]])
        return np.arccos(np.clip(cosine, -1.0, 1.0))

    @property
    def thickness(self) -> float:
        """Least over middle side of the box along the principal axes."""
        seen = self.vertices[np.unique(self.faces)]
        _, _, axes = np.linalg.svd(seen - seen.mean(0), full_matrices=False)
        sides = np.sort(np.ptp(seen @ axes.T, axis=0))
        return float(sides[0] / max(sides[1], 1e-12))

    @property
    def slivers(self) -> float:
        """Share of faces more than 12 times as long as high, as fans and strips of CAD surfaces are."""
        corners = self.vertices[self.faces]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        return float((sides.max(1) ** 2 / np.maximum(2 * self.areas, 1e-15) > 12).mean())

    def clusters(self, gap: float) -> np.ndarray:
        """(C,) number of the cluster of each component: components whose boxes are nearer than `gap` are in one."""
        low, high = self.boxes[:, 0] - gap / 2, self.boxes[:, 1] + gap / 2
        if len(low) > 2000:
            return np.zeros(len(low), int)
        meet = ((low[:, None] <= high[None]) & (high[:, None] >= low[None])).all(2)
        return connected_components(coo_matrix(meet), directed=False)[1]
