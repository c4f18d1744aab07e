"""Splits a structure where the frames before and after do not see what they would see if their link was right.

Where the camera turns away between two frames, COLMAP links the halves if both show similar objects: a few matches
between two equal houses, all on one wall, which fit a pose well. The rest of the image then contradicts the pose. By
the structure, the frames before and after look at the same place from nearly the same direction, but of the points that
either side sees there, the other sees none but those of the link. Between rightly linked frames it sees most, because
they were matched, and SIFT recognises a point from a similar direction.
"""

import dataclasses
import itertools

import numpy as np

from .structure import Structure


@dataclasses.dataclass(frozen=True)
class LinkOptions:
    """Which points a frame is expected to see, and how many of them it has to.

    Chosen on twelve captures, five long films and twelve wrong links; docs/decisions/gen_perception.md has the figures.

    Attributes:
      max_scale: largest ratio of an expected point's depths in two frames, either way.
      max_angle: rad, largest angle between the rays from two frames to an expected point.
      min_expected: fewest points expected of the frames before in those after, and the reverse; with fewer, a link is
        not judged.
      min_share: a link is wrong if the share of the expected points that is seen is lower than this part of the usual
        share. Sides are judged by the one of which more is seen, because something near may hide what the other sees.
    """

    max_scale: float = 3.0
    max_angle: float = float(np.radians(45.0))
    min_expected: int = 50
    min_share: float = 0.3


_LINKS = LinkOptions()


def split(structure: Structure, own: np.ndarray, overlap: int) -> Structure:
    """A structure whose wrong links are gone: the frames after one are a model of their own, as if no match led there.
    The same object if all links are right.

    Args:
      own: (m,) which of COLMAP's models each frame is from. Those that were merged into one (`Structure.model`) have no
        common points, and are not compared.
      overlap: number of following frames with which each was matched.
    """
    seen = _Seen(structure)
    model = structure.model.copy()
    usual = None
    while True:
        share = np.full(len(model), np.inf)
        for one in np.unique(model):
            rows = np.flatnonzero(model == one)
            share[rows[1:]] = _shares(seen, rows, own, overlap)
        judged = share[np.isfinite(share)]
        if not len(judged):
            break
        usual = float(np.median(judged)) if usual is None else usual
        worst = int(share.argmin())
        if share[worst] >= _LINKS.min_share * usual:
            break
        model[(model == model[worst]) & (np.arange(len(model)) >= worst)] = model.max() + 1
    return structure if (model == structure.model).all() else _with_models(structure, model)


class _Seen:
    """What the frames of a structure see, and would see of one another's points.

    Attributes:
      registered: (m,) numbers of the frames.
    """

    def __init__(self, structure: Structure) -> None:
        self.registered = structure.registered
        self._structure = structure
        pairs = np.unique(np.stack([structure.frame, structure.point]).astype(np.int64), axis=1)
        ends = np.searchsorted(pairs[0], np.arange(len(structure.registered) + 1))
        self._points = [pairs[1, a:b] for a, b in itertools.pairwise(ends)]
        self._found: dict[tuple[int, int], np.ndarray] = {}

    def counts(self, a: int, b: int) -> np.ndarray:
        """(2,): how many points of row `a` are expected in row `b`, and how many of them it sees."""
        if (a, b) not in self._found:
            self._found[a, b] = self._count(a, b)
        return self._found[a, b]

    def _count(self, a: int, b: int) -> np.ndarray:
        camera, poses = self._structure.camera, self._structure.poses
        expected = self._points[a]
        rays = [self._structure.points[expected] - poses[row, :3, 3] for row in (a, b)]
        depths = [ray @ poses[row, :3, 2] for ray, row in zip(rays, (a, b), strict=True)]
        # Never true of a point behind either camera.
        alike = np.maximum(*depths) < _LINKS.max_scale * np.minimum(*depths)
        across = rays[1] @ poses[b, :3, :2] / np.where(alike, depths[1], 1.0)[:, None]
        pixel = camera.fx * across + [camera.cx, camera.cy]
        inside = ((pixel >= 0) & (pixel < [camera.width, camera.height])).all(1)
        lengths = np.prod([np.linalg.norm(ray, axis=1) for ray in rays], 0)
        aligned = np.einsum("ni,ni->n", *rays) > np.cos(_LINKS.max_angle) * lengths
        expected = expected[alike & inside & aligned]
        return np.array([len(expected), np.isin(expected, self._points[b], assume_unique=True).sum()])


def _shares(seen: _Seen, rows: np.ndarray, own: np.ndarray, overlap: int) -> np.ndarray:
    """(k - 1,): the larger of the shares of expected points seen across each link of the rows (k,) of a model, infinite
    where it is not judged. Half of `overlap` on either side are compared, so that matches were sought for all pairs."""
    reach = max(1, overlap // 2)
    out = np.full(len(rows) - 1, np.inf)
    for k in range(1, len(rows)):
        counts = np.zeros((2, 2))
        for a in rows[max(0, k - reach) : k]:
            for b in rows[k : k + reach]:
                if own[a] == own[b] and seen.registered[b] - seen.registered[a] <= overlap:
                    counts += seen.counts(a, b), seen.counts(b, a)
        if counts[:, 0].min() >= _LINKS.min_expected:
            out[k - 1] = (counts[:, 1] / counts[:, 0]).max()
    return out


def _with_models(structure: Structure, model: np.ndarray) -> Structure:
    """The structure with other models (m,). A point that several of them see becomes one of each that sees it more than
    once; the others' observations of it go."""
    key = model[structure.frame].astype(np.int64) * len(structure.points) + structure.point
    used, point, views = np.unique(key, return_inverse=True, return_counts=True)
    kept = (views[point] > 1) | (np.bincount(structure.point)[structure.point] == 1)
    return dataclasses.replace(
        structure,
        points=structure.points[used % len(structure.points)],
        frame=structure.frame[kept],
        point=point[kept].astype(np.int32),
        pixel=structure.pixel[kept],
        model=model,
    )
