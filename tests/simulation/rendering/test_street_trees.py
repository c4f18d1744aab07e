"""Trees of scenes over parts of large objects: nothing is lost from them, and images are those of whole objects."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.simulation.rendering.test_render_movable import homes
from tests.support.box_bank import box_bank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering import street_batch
from urbanverse_mjx.simulation.rendering.renderer import OUTPUTS, Renderer
from urbanverse_mjx.simulation.rendering.street_tree import (
    EMPTY,
    LEAF,
    NODE,
    SLACK,
    Items,
    build_over,
    build_trees,
    open_large,
)

from . import render_cases as cases


def leaves(nodes: np.ndarray, root: int, depth: int = 0, box: np.ndarray | None = None) -> list[tuple]:
    """(number behind `LEAF`, corners (2, 3) of the innermost box, nodes on the path) of the leaves of a tree."""
    if root >= EMPTY:
        return []
    if root >= LEAF:
        return [(root - LEAF, box, depth)]
    found = []
    for side in (0, 2):
        child = int(nodes[root - NODE, side, 3:].copy().view(np.int32)[0])
        found += leaves(nodes, child, depth + 1, nodes[root - NODE, side : side + 2, :3])
    return found


def boxes(rng: np.random.Generator, number: int) -> tuple[np.ndarray, np.ndarray]:
    lower = rng.uniform(-50, 50, (number, 3))
    return lower, lower + rng.uniform(0, 4, (number, 3))


def items_of(lower: np.ndarray, upper: np.ndarray) -> Items:
    number = np.arange(len(lower))
    return Items(number, LEAF + number, lower, upper)


def test_every_item_is_a_leaf_of_its_own_tree() -> None:
    rng = np.random.default_rng(0)
    lower, upper = boxes(rng, 300)
    lower[100:120], upper[100:120] = lower[100], upper[100]  # many in one place
    group = rng.integers(0, 9, 300)
    group[group == 5] = 4  # tree 5 is empty
    group[group == 7] = 6
    group[0] = 7  # one item alone in tree 7
    leaf = rng.permutation(1000)[:300]
    nodes, roots = build_over(items_of(lower, upper), leaf, group, 9)
    for tree in range(9):
        found = leaves(nodes, int(roots[tree]))
        own = np.flatnonzero(group == tree)
        assert sorted(number for number, _, _ in found) == sorted(leaf[own].tolist())
        for number, box, _ in found:
            if box is not None:
                item = int(np.flatnonzero(leaf == number)[0])
                np.testing.assert_allclose(box, [lower[item] - SLACK, upper[item] + SLACK], atol=0.1 * SLACK)
    # A node's box is that of all below it, no larger.
    root = int(roots[4]) - NODE
    whole = np.array([nodes[root, [0, 2], :3].min(0), nodes[root, [1, 3], :3].max(0)])
    edges = [lower[group == 4].min(0) - SLACK, upper[group == 4].max(0) + SLACK]
    np.testing.assert_allclose(whole, edges, atol=0.1 * SLACK)


def expected_steps(nodes: np.ndarray, root: int) -> float:
    """Sum over the nodes of a tree of the surface of each box: steps of a ray from anywhere, but for a factor."""
    if root >= LEAF:
        return 0.0
    total = 0.0
    for side in (0, 2):
        x, y, z = (nodes[root - NODE, side + 1, :3] - nodes[root - NODE, side, :3]).astype(float)
        total += x * y + y * z + z * x
        total += expected_steps(nodes, int(nodes[root - NODE, side, 3:].copy().view(np.int32)[0]))
    return total


def test_trees_cost_a_ray_less_than_those_with_buckets_along_one_axis() -> None:
    """Flat ground under many small objects, as in a street."""
    rng = np.random.default_rng(1)
    lower, upper = boxes(rng, 400)
    lower[:, 2], upper[:, 2] = 0.0, rng.uniform(1, 8, 400)
    lower[:60, :2] -= rng.uniform(0, 30, (60, 2))
    upper[:60, 2] = 0.1
    group = np.zeros(400, int)
    nodes, roots = build_over(items_of(lower, upper), np.arange(400), group, 1)
    warps = build_trees(lower, upper, group, 1, leaf_size=1)
    assert expected_steps(nodes, int(roots[0])) < 0.95 * expected_steps(warps.nodes, int(warps.roots[0]))


def test_no_path_outgrows_the_stack_of_a_ray() -> None:
    """Boxes each of which is twice as large as the one before: the cheapest tree is a chain."""
    size = 2.0 ** np.arange(60)[:, None] * 1e-6 + np.zeros((60, 3))
    nodes, roots = build_over(items_of(size, 1.9 * size), np.arange(60), np.zeros(60, int), 1)
    found = leaves(nodes, int(roots[0]))
    assert sorted(number for number, _, _ in found) == list(range(60))
    assert 20 < max(depth for _, _, depth in found) <= 32


def test_parts_of_an_object_hold_all_its_triangles() -> None:
    rng = np.random.default_rng(2)
    lower, upper = boxes(rng, 200)
    mesh = (np.arange(200) >= 150).astype(int)
    trees = build_trees(lower, upper, mesh, 2, leaf_size=4)
    turns = rotations.matrix_f64(rng.normal(size=(3, 4)))
    places = rng.uniform(-20, 20, (3, 3))
    owners_mesh = np.array([0, 1, 0])
    corners = []
    for i in range(3):
        low, high = lower[mesh == owners_mesh[i]], upper[mesh == owners_mesh[i]]
        ends = (
            np.stack([low, high], 1)[:, [0, 0, 0, 0, 1, 1, 1, 1], 0],
            np.stack([low, high], 1)[:, [0, 0, 1, 1] * 2, 1],
        )
        points = np.stack([*ends, np.stack([low, high], 1)[:, [0, 1] * 4, 2]], -1)
        corners.append(points @ turns[i].T + places[i])
    objects = Items(
        np.arange(3),
        trees.roots[owners_mesh],
        np.array([c.min((0, 1)) for c in corners]),
        np.array([c.max((0, 1)) for c in corners]),
    )
    scene = np.array([0, 0, 1])
    assert len(open_large(objects, trees.nodes, turns, places, scene, 1.1).owner) == 3
    for share in (0.3, 0.02, 0.0):
        items = open_large(objects, trees.nodes, turns, places, scene, share)
        assert len(items.owner) > 3
        for owner in range(3):
            own, below = items.owner == owner, []
            for root, low, high in zip(items.root[own], items.lower[own], items.upper[own], strict=True):
                for first, _, _ in leaves(trees.nodes, int(root)):
                    last = first + int(np.argmax(trees.last[first:]))
                    number = trees.order[first : last + 1]
                    below += number.tolist()
                    inside = corners[owner][number - (150 if owners_mesh[owner] else 0)]
                    assert (inside >= low - 1e-6).all()
                    assert (inside <= high + 1e-6).all()
            assert sorted(below) == np.flatnonzero(mesh == owners_mesh[owner]).tolist()
    x, y, z = (items.upper - items.lower).T
    assert (items.root >= LEAF).all()
    assert ((x * y + y * z + z * x) > 0).all()


@pytest.mark.extended
def test_images_do_not_depend_on_what_is_divided(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole objects, and every object divided down to the leaves of its mesh; one of them pushed, all outputs."""
    bank, robot = box_bank(4, seed=0), make_coco()
    places = cases.make_places(bank, robot, 8)
    _, home = homes(bank)
    pushed = home._replace(position=home.position.at[0].add(jnp.array([0.5, -1.5, 0.8])))
    options = {"shadows": True, "shading": "matte", "appearance": 0.2, "bodies": 3}

    def draw(share: float) -> dict[str, np.ndarray]:
        monkeypatch.setattr(street_batch, "_LARGE", share)
        renderer = Renderer(bank, robot, 36, 64, (*OUTPUTS, "coverage"), **options)
        frames = jax.jit(jax.vmap(lambda *place: renderer(*place, appearance_seed=3, bodies=pushed)))
        return {name: np.asarray(x) for name, x in frames(*places.inputs).items()}

    whole, divided = draw(2.0), draw(0.0)
    assert len(np.unique(whole["object"])) > 20
    for name, image in whole.items():
        np.testing.assert_array_equal(image, divided[name], err_msg=name)
