"""Borders between the areas of a grid of labels: a planar graph, every border once.

A cell corner where three or more areas meet, or four cells in a chequerboard pattern, is a node; arcs connect the
nodes. Two arcs that continue each other at a node form one stroke, so that a kerb along a road and its crosswalks is
one line; the third arc ends there.
"""

import dataclasses
import itertools

import numpy as np

type Corner = tuple[int, int]
type Arc = list[Corner]  # corners of cells, one cell apart

#: Number of cells along an arc from which its direction at a node is computed.
_TANGENT_CELLS = 8
#: rad, subtracted from the turn between two arcs at a node if both are borders of the same sort.
_SAME_KIND_BONUS = np.radians(25.0)
#: rad, largest turn at which the second pair of arcs at a node of four is joined.
_MAX_STRAIGHT_TURN = np.radians(60.0)


@dataclasses.dataclass(frozen=True)
class Stroke:
    """A chain of arcs that continue each other through nodes.

    Attributes:
      corners: (n + 1, 2) i64 corners of cells, one cell apart; the last is the first again where `closed`.
      sides: (n, 2) i64 flat indices into the padded grid of the two cells that each edge lies between.
    """

    corners: np.ndarray
    sides: np.ndarray

    @property
    def closed(self) -> bool:
        """Whether the stroke ends at its first corner."""
        return bool((self.corners[0] == self.corners[-1]).all())


def strokes(labels: np.ndarray, sort_of: np.ndarray) -> list[Stroke]:
    """All borders of a grid, the longest first.

    Args:
      labels: (X, Y) u8; 0 = outside. Corner (i, j) is the low corner of cell (i, j).
      sort_of: (L, L) sort of the border between two labels, 0 = with the outside; borders of one sort are joined at
        nodes.

    Returns:
      Strokes that together hold every border once. Indices in `sides` are those of `np.pad(labels, 1)`.
    """
    padded = np.pad(labels, 1).astype(np.int64)
    near = _adjacency(padded)
    nodes = {c for c, others in near.items() if len(others) > 2}
    arcs, rings = _arcs(near, nodes)
    chains = [*_chains(arcs, padded, sort_of), *rings]
    made = [Stroke(np.array(c), _sides(np.array(c), padded.shape[1])) for c in chains]
    return sorted(made, key=lambda s: (-len(s.corners), *s.corners[0].tolist()))


def _adjacency(padded: np.ndarray) -> dict[Corner, list[Corner]]:
    """For each corner of the unpadded grid, the corners that a border connects to it."""
    near: dict[Corner, list[Corner]] = {}
    along_y = np.argwhere(padded[:-1, 1:-1] != padded[1:, 1:-1])
    along_x = np.argwhere(padded[1:-1, :-1] != padded[1:-1, 1:])
    for edges, step in ((along_y, (0, 1)), (along_x, (1, 0))):
        for i, j in edges.tolist():
            a, b = (i, j), (i + step[0], j + step[1])
            near.setdefault(a, []).append(b)
            near.setdefault(b, []).append(a)
    return near


def _arcs(near: dict[Corner, list[Corner]], nodes: set[Corner]) -> tuple[list[Arc], list[Arc]]:
    """Arcs between nodes, and closed rings without any."""
    used: set[tuple[Corner, Corner]] = set()

    def follow(a: Corner, b: Corner) -> Arc:
        arc = [a, b]
        while arc[-1] not in nodes and arc[-1] != a:
            one, other = near[arc[-1]]
            arc.append(other if one == arc[-2] else one)
        used.update(itertools.pairwise(arc))
        used.update(itertools.pairwise(arc[::-1]))
        return arc

    arcs = [follow(n, b) for n in sorted(nodes) for b in near[n] if (n, b) not in used]
    rings = [follow(c, near[c][0]) for c in sorted(near) if c not in nodes and (c, near[c][0]) not in used]
    return arcs, rings


def _sides(corners: np.ndarray, width: int) -> np.ndarray:
    """(n, 2) flat indices into the padded grid beside each edge."""
    low = np.minimum(corners[:-1], corners[1:])
    along_x = corners[:-1, 0] != corners[1:, 0]
    # Cell (i, j) is (i + 1, j + 1) in the padded grid; the other lies one cell lower, across the edge.
    one = (low[:, 0] + 1) * width + low[:, 1] + 1
    return np.stack([one - np.where(along_x, 1, width), one], -1)


def _chains(arcs: list[Arc], padded: np.ndarray, sort_of: np.ndarray) -> list[Arc]:
    """Arcs joined through their nodes."""
    # End e of arc e // 2: 0 its first corner, 1 its last.
    ends: dict[Corner, list[int]] = {}
    for k, arc in enumerate(arcs):
        ends.setdefault(arc[0], []).append(2 * k)
        ends.setdefault(arc[-1], []).append(2 * k + 1)
    sorts = [_sort(arc, padded, sort_of) for arc in arcs]
    partner: dict[int, int] = {}
    for node in sorted(ends):
        partner |= _paired(ends[node], arcs, sorts)
    chains, done = [], set()
    # Open chains begin at an end without partner; the remaining chains are closed.
    for e in [*(e for e in range(2 * len(arcs)) if e not in partner), *range(2 * len(arcs))]:
        if e // 2 in done:
            continue
        chain: Arc = []
        while e // 2 not in done:
            done.add(e // 2)
            arc = arcs[e // 2][:: -1 if e % 2 else 1]
            chain += arc[1:] if chain else arc
            e = partner.get(e ^ 1, e)
        chains.append(chain)
    return chains


def _sort(arc: Arc, padded: np.ndarray, sort_of: np.ndarray) -> int:
    one, other = padded.ravel()[_sides(np.array(arc[:2]), padded.shape[1])[0]]
    return int(sort_of[one, other])


def _paired(ends: list[int], arcs: list[Arc], sorts: list[int]) -> dict[int, int]:
    """Pairs of ends to join at a node: always the straightest two, so that a third ends on a line."""

    def heading(e: int) -> complex:
        arc = arcs[e // 2][:: -1 if e % 2 else 1]
        tip = arc[min(_TANGENT_CELLS, len(arc) - 1)]
        if tip == arc[0]:  # a loop of few cells
            tip = arc[len(arc) // 2]
        return complex(tip[0] - arc[0][0], tip[1] - arc[0][1])

    pairs = []
    for a, first in enumerate(ends):
        for second in ends[a + 1 :]:
            turn = abs(np.angle(-heading(first) * np.conj(heading(second))))
            same = sorts[first // 2] == sorts[second // 2]
            # A border with the outside is only joined to another border with the outside.
            outer = same and not sorts[first // 2]
            pairs.append((turn - (np.pi if outer else _SAME_KIND_BONUS * same), turn, first, second))
    partner: dict[int, int] = {}
    for _, turn, first, second in sorted(pairs):
        if first in partner or second in partner or (partner and turn > _MAX_STRAIGHT_TURN):
            continue
        partner |= {first: second, second: first}
    return partner
