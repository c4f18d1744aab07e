"""Search trees as tables of 16-byte rows, which a ray reads with four loads a step.

Warp builds those of meshes. It keeps a node's own box, so that a step needs the node and then both its children; here a
node holds the boxes of its children, and a triangle is three rows instead of an index of an index of a vertex.

The trees of scenes are built here, over parts of objects: the box of a long pavement or of a house that stands askew
holds much that is elsewhere, and a ray would look into it for nothing. `open_large` replaces such an object by the
upper nodes of its mesh's tree.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import dataclasses
from collections.abc import Sequence

import numpy as np
import warp as wp

from ...datatypes import ValidationError
from .pbr_private import BUILD_OPTIONS

#: A reference leads to a node (from `NODE` on), or to a leaf whose first item is the rest (from `LEAF` on), or nowhere.
#: As the bits of a float it is an ordinary number: programs that flush denormal numbers to 0 leave it alone.
NODE, LEAF, EMPTY = 1 << 29, 1 << 30, (1 << 30) + (1 << 29)
#: Boxes grow by this, m: rays meet them in float32, whose step 200 m from the origin is 1.5e-5 m.
SLACK = 1.0e-4
#: Nodes on the path to a leaf at most, as in Warp's trees: the stack of a ray holds two such paths.
_MAX_DEPTH = 32


@dataclasses.dataclass(frozen=True)
class Trees:
    """Search trees over items, one per group.

    Attributes:
      roots: (groups,) i32 references; `NODE` + a row, `LEAF` + the first item, or `EMPTY`.
      nodes: (nodes, 4, 4) f32; of each of two children: lower corner and reference, upper corner.
      order: (items,) item numbers in the order of the leaves.
      last: (items,) bool in that order: whether the item is the last of its leaf.
      depth: largest number of nodes on the path to a leaf.
    """

    roots: np.ndarray
    nodes: np.ndarray
    order: np.ndarray
    last: np.ndarray
    depth: int


@wp.kernel(module="unique", module_options={"enable_backward": False, "extra_build_options": BUILD_OPTIONS})
def _read(tree: wp.uint64, number: int, corners: wp.array2d[wp.vec3], links: wp.array2d[int], items: wp.array[int]):
    """Copies Warp's tree; dim nodes (at least one per item)."""
    i = wp.tid()
    node = wp.mjpbr_bvh_node(tree, i)
    corners[i, 0] = node.lower
    corners[i, 1] = node.upper
    links[i, 0] = node.left
    links[i, 1] = node.right
    links[i, 2] = node.leaf
    if i < number:
        items[i] = wp.mjpbr_bvh_primitive(tree, i)


@wp.kernel(module="unique", module_options={"enable_backward": False})
def _find_roots(tree: wp.uint64, roots: wp.array[int]):
    """dim groups; -1 = the group is empty."""
    group = wp.tid()
    roots[group] = wp.bvh_get_group_root(tree, group)


def as_floats(numbers: np.ndarray) -> np.ndarray:
    """The same 32 bits as a float, for a row of floats."""
    return np.ascontiguousarray(numbers, np.int32).view(np.float32)


def build_trees(lower: np.ndarray, upper: np.ndarray, group: np.ndarray, groups: int, leaf_size: int) -> Trees:
    """Trees over boxes (n, 3), split where the expected cost of a ray is least.

    Args:
      group: (n,) the tree in which each box stands, below `groups`.
      leaf_size: boxes in a leaf at most.
    """
    number = len(lower)
    size = 2 * number - 1
    grown = (np.add(x, s, dtype=np.float64).astype(np.float32) for x, s in ((lower, -SLACK), (upper, SLACK)))
    boxes = [wp.array(x, dtype=wp.vec3) for x in grown]
    tree = wp.Bvh(*boxes, groups=wp.array(group, dtype=int), constructor="sah", leaf_size=leaf_size)
    roots = wp.zeros(groups, dtype=int)
    wp.launch(_find_roots, dim=groups, inputs=[tree.id, roots])
    corners, links = wp.zeros((size, 2), dtype=wp.vec3), wp.zeros((size, 3), dtype=int)
    items = wp.zeros(number, dtype=int)
    wp.launch(_read, dim=size, inputs=[tree.id, number, corners, links, items])
    return _packed(corners.numpy(), links.numpy(), roots.numpy(), items.numpy())


def _packed(corners: np.ndarray, links: np.ndarray, roots: np.ndarray, items: np.ndarray) -> Trees:
    """The tree from Warp's arrays; those of nodes that are not in it hold anything."""
    last = np.zeros(len(items), bool)
    reached: list[np.ndarray] = []
    front = roots[roots >= 0]
    while len(front):
        leaf = links[front, 2] != 0
        last[links[front[leaf], 1] - 1] = True
        reached.append(front[~leaf])
        front = links[front[~leaf], :2].ravel()
    # Warp's own order goes down into the first child first, so that data read together are adjacent.
    inner = np.sort(np.concatenate([np.zeros(0, np.int32), *reached]))
    reference = np.zeros(len(links), np.int64)
    reference[inner] = NODE + np.arange(len(inner))
    leaves = np.ones(len(links), bool)
    leaves[inner] = False
    reference[leaves] = LEAF + np.clip(links[leaves, 0], 0, NODE - 1)
    nodes = np.zeros((len(inner), 4, 4), np.float32)
    for side in (0, 1):
        child = links[inner, side]
        nodes[:, 2 * side, :3], nodes[:, 2 * side + 1, :3] = corners[child, 0], corners[child, 1]
        nodes[:, 2 * side, 3] = as_floats(reference[child])
    packed_roots = np.where(roots >= 0, reference[roots], EMPTY).astype(np.int32)
    return Trees(packed_roots, nodes, items, last, len(reached))


@dataclasses.dataclass(frozen=True)
class Items:
    """What the trees of scenes lead to: an object's whole tree, or a part of it.

    Attributes:
      owner: (n,) object.
      root: (n,) i32 reference into the trees of the meshes.
      lower, upper: (n, 3) corners of the box around it in the scene's frame, m.
    """

    owner: np.ndarray
    root: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def __getitem__(self, which: np.ndarray) -> "Items":
        return Items(self.owner[which], self.root[which], self.lower[which], self.upper[which])

    @staticmethod
    def joined(parts: Sequence["Items"]) -> "Items":
        names = [field.name for field in dataclasses.fields(Items)]
        return Items(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _areas(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Half of the surfaces of boxes (..., 3), m^2."""
    x, y, z = np.moveaxis(np.maximum(upper - lower, 0.0), -1, 0)
    return x * y + y * z + z * x


def open_large(
    objects: Items, nodes: np.ndarray, rotations: np.ndarray, positions: np.ndarray, scene: np.ndarray, share: float
) -> Items:
    """Replaces objects by parts of their trees, until no box that can be divided is large.

    Two-level trees lose most to large objects whose boxes overlap others: C. Benthin, S. Woop, I. Wald, A. T. Afra,
    "Improved two-level BVHs using partial re-braiding", HPG 2017.

    Args:
      objects: one item an object.
      nodes: (nodes, 4, 4) of the meshes' trees.
      rotations: (objects, 3, 3), positions (objects, 3) m: T_scene_object.
      scene: (objects,) of each object.
      share: of the surface of the box around a scene, above which a box is large.
    """
    lower, upper = (np.full((int(scene.max(initial=-1)) + 1, 3), fill) for fill in (np.inf, -np.inf))
    np.minimum.at(lower, scene, objects.lower)
    np.maximum.at(upper, scene, objects.upper)
    largest = share * _areas(lower, upper)
    found, front = [], objects
    while len(front.owner):
        large = (front.root < LEAF) & (_areas(front.lower, front.upper) > largest[scene[front.owner]])
        found.append(front[~large])
        front = front[large]
        rows, turn, place = nodes[front.root - NODE].astype(np.float64), rotations[front.owner], positions[front.owner]
        halves = []
        for side in (0, 2):
            low, high = rows[:, side, :3], rows[:, side + 1, :3]
            middle = np.einsum("nij,nj->ni", turn, 0.5 * (low + high)) + place
            reach = np.einsum("nij,nj->ni", np.abs(turn), 0.5 * (high - low))
            root = np.ascontiguousarray(nodes[front.root - NODE, side, 3]).view(np.int32)
            # A box that was turned is wider than what it holds, which does not leave the box of the whole.
            box = np.maximum(middle - reach, front.lower), np.minimum(middle + reach, front.upper)
            halves.append(Items(front.owner, root, *box))
        front = Items.joined(halves)
    return Items.joined([*found, front])


def build_over(items: Items, leaf: np.ndarray, group: np.ndarray, groups: int) -> tuple[np.ndarray, np.ndarray]:
    """(nodes, roots) of trees over items, one per group, each split where the expected cost of a ray is least.

    All places along all three axes are compared, which is dearer than Warp's buckets along the longest, and gives a
    tree with fewer steps where boxes overlap.

    Args:
      leaf: (n,) number behind `LEAF` in the references to items.
      group: (n,) the tree in which each item stands, below `groups`.
    """
    grown = np.concatenate([items.lower - SLACK, -(items.upper + SLACK)], axis=1).astype(np.float32)
    order = np.argsort(group, kind="stable")
    count = np.bincount(group, minlength=groups)
    begin = np.cumsum(count) - count
    nodes = np.zeros((int(np.maximum(count - 1, 0).sum()), 4, 4), np.float32)
    # Depth first, as in Warp's trees: n leaves have n - 1 nodes, which stand together.
    row = np.cumsum(np.maximum(count - 1, 0)) - np.maximum(count - 1, 0)
    roots = np.full(groups, EMPTY, np.int32)
    roots[count > 1] = NODE + row[count > 1]
    roots[count == 1] = LEAF + leaf[order[begin[count == 1]]]
    begin, row, count = begin[count > 1], row[count > 1], count[count > 1]
    depth = 0
    while len(count):
        depth += 1
        first = np.cumsum(count) - count
        segment = np.repeat(np.arange(len(count)), count)
        place = np.arange(len(segment)) + (begin - first)[segment]
        order[place], left = _split(order[place], grown, segment, first, count, _MAX_DEPTH - depth)
        # Boxes of the first and the second child in turn.
        sizes = np.stack([left, count - left], 1)
        starts = np.stack([first, first + left], 1)
        boxes = np.minimum.reduceat(grown[order[place]], starts.ravel()).reshape(-1, 2, 6)
        begins, rows = np.stack([begin, begin + left], 1), np.stack([row + 1, row + left], 1)
        references = np.where(sizes > 1, NODE + rows, LEAF + leaf[order[begins]])
        nodes[row[:, None], [0, 2], :3], nodes[row[:, None], [1, 3], :3] = boxes[..., :3], -boxes[..., 3:]
        nodes[row[:, None], [0, 2], 3] = as_floats(references)
        inner = sizes > 1
        begin, row, count = begins[inner], rows[inner], sizes[inner]
    return nodes, roots


def _split(
    order: np.ndarray, grown: np.ndarray, segment: np.ndarray, first: np.ndarray, count: np.ndarray, levels: int
) -> tuple[np.ndarray, np.ndarray]:
    """Sorts the items of each node so that those of its first child come first; their number in each node.

    Args:
      order: (n,) items of all nodes of a level, one node after the other.
      grown: (items, 6) lower corners and negative upper corners.
      segment: (n,) node of each; first, count: (nodes,) where each begins, and its size.
      levels: of nodes that may still follow below these.
    """
    place = np.arange(len(order)) - first[segment]
    size = count[segment]
    best = np.full(len(count), np.inf)
    chosen, left = order.copy(), count // 2
    # Halves need the fewest levels: whoever has no more than these to spare is halved.
    halved = count > 2 ** min(levels, 62)
    for axis in range(3):
        middle = grown[order, axis].astype(np.float64) - grown[order, axis + 3]
        sorted_ = order[np.lexsort((middle, segment))]
        boxes = grown[sorted_].astype(np.float64)
        before = _least(boxes, segment)
        after = _least(boxes[::-1], segment[::-1])[::-1]
        cost = np.full(len(order), np.inf)
        inner = np.flatnonzero(place < size - 1)
        ahead = _areas(before[inner, :3], -before[inner, 3:]) * (place[inner] + 1)
        cost[inner] = ahead + _areas(after[inner + 1, :3], -after[inner + 1, 3:]) * (size - place - 1)[inner]
        cost[halved[segment] & (place + 1 != size // 2)] = np.inf
        least = np.minimum.reduceat(cost, first)
        better = least < best
        best = np.where(better, least, best)
        at = np.flatnonzero(cost == least[segment])
        node, earliest = np.unique(segment[at], return_index=True)
        where = np.zeros(len(count), np.int64)
        where[node] = place[at[earliest]] + 1
        left = np.where(better, where, left)
        chosen = np.where(better[segment], sorted_, chosen)
    return chosen, left


def _least(boxes: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """(n, 6) least numbers so far in each segment; segments stand together."""
    # One scan for all: each segment lies below all before it.
    step = 2.0 * (np.abs(boxes).max(initial=0.0) + 1.0)
    rank = np.cumsum(np.append(0, np.abs(np.diff(segment))))[:, None] * step
    return np.minimum.accumulate(boxes - rank, axis=0) + rank


def joined(first: np.ndarray, nodes: np.ndarray, roots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(nodes, roots) of trees behind other nodes in one table."""
    shift = len(first)
    nodes = nodes.copy()
    for row in (0, 2):
        references = np.ascontiguousarray(nodes[:, row, 3]).view(np.int32)
        nodes[:, row, 3] = as_floats(np.where(references < LEAF, references + shift, references))
    roots = np.where(roots < LEAF, roots + shift, roots)
    if shift + len(nodes) >= NODE:
        raise ValidationError(
            f"search trees: found {shift + len(nodes):,} nodes; needed under {NODE:,}; use fewer scenes"
        )
    return np.concatenate([first, nodes]), roots.astype(np.int32)
