"""Search trees as tables of 16-byte rows: Warp builds them, a ray reads them with four loads a step.

Warp keeps a node's own box, so that a step needs the node and then both its children; here a node holds the boxes of
its children, and a triangle is three rows instead of an index of an index of a vertex.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import dataclasses

import numpy as np
import warp as wp

from ...datatypes import ValidationError
from .pbr_private import BUILD_OPTIONS

#: A reference leads to a node (from `NODE` on), or to a leaf whose first item is the rest (from `LEAF` on), or nowhere.
#: As the bits of a float it is an ordinary number: programs that flush denormal numbers to 0 leave it alone.
NODE, LEAF, EMPTY = 1 << 29, 1 << 30, (1 << 30) + (1 << 29)
#: Boxes grow by this, m: rays meet them in float32, whose step 200 m from the origin is 1.5e-5 m.
SLACK = 1.0e-4


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


def joined(first: np.ndarray, second: Trees) -> tuple[np.ndarray, np.ndarray]:
    """(nodes, roots) of trees `second` behind other nodes in one table."""
    shift = len(first)
    nodes = second.nodes.copy()
    for row in (0, 2):
        references = np.ascontiguousarray(nodes[:, row, 3]).view(np.int32)
        nodes[:, row, 3] = as_floats(np.where(references < LEAF, references + shift, references))
    roots = np.where(second.roots < LEAF, second.roots + shift, second.roots)
    if shift + len(nodes) >= NODE:
        raise ValidationError(
            f"search trees: found {shift + len(nodes):,} nodes; needed under {NODE:,}; use fewer scenes"
        )
    return np.concatenate([first, nodes]), roots.astype(np.int32)
