"""Spheres against hulls: the same distances and normals as C MuJoCo, and a bound that never lies too high."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.scene.hulls import convex_part, hull_table
from urbanverse_mjx.simulation.collision_slots import hull_contact
from urbanverse_mjx.simulation.collision_slots.static_slots import Slots

NUM_HULLS, SPHERES_PER_HULL = 60, 12
find_contacts = jax.jit(hull_contact.find_contacts, static_argnums=4)


def random_corners(rng: np.random.Generator) -> np.ndarray:
    """Corners of a box, a wedge, a prism with many corners, a flat slab or a lump."""
    kind = rng.integers(5)
    if kind == 0:
        unit = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    elif kind == 1:
        unit = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-0.4, -1, 1), (-0.4, 1, 1)])
    elif kind == 2:
        angle = np.arange(14) * 2 * np.pi / 14
        ring = np.column_stack([np.cos(angle), np.sin(angle)])
        unit = np.concatenate([np.column_stack([ring, np.full(14, z)]) for z in (-1, 1)])
    elif kind == 3:
        unit = np.array(np.meshgrid([-1, 1], [-1, 1], [-0.05, 0.05])).reshape(3, -1).T
    else:
        unit = rng.normal(size=(30, 3))
        unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    return (unit * rng.uniform(0.1, 1.2, 3)).astype(np.float32)


def near_surface(corners: np.ndarray, rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Centres (n, 3) and radii (n,) of spheres inside, across and outside the hull, at faces, edges and corners."""
    part = convex_part(corners)
    weights = rng.dirichlet([0.35] * 3, count)  # small concentration: often near an edge or a corner
    triangle = rng.integers(len(part.triangles), size=count)
    foot = np.einsum("nk,nki->ni", weights, part.corners[part.triangles[triangle]])
    away = rng.normal(size=(count, 3))
    away += 2.0 * part.planes[triangle, :3]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radius = rng.uniform(0.05, 0.25, count)
    return foot + away * (radius * rng.uniform(-0.4, 1.6, count))[:, None], radius


class Case:
    """Random hulls at random poses with spheres around them, in our table and in C MuJoCo."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        corners = [random_corners(rng) for _ in range(NUM_HULLS)]
        self.table = hull_table([convex_part(c) for c in corners])
        self.rotation = Rotation.random(NUM_HULLS, random_state=seed).as_matrix()
        self.position = rng.uniform(-3, 3, (NUM_HULLS, 3))
        spheres = [near_surface(c, rng, SPHERES_PER_HULL) for c in corners]
        local = np.stack([c for c, _ in spheres])
        self.centre = np.einsum("hij,hsj->hsi", self.rotation, local) + self.position[:, None]
        self.radius = np.stack([r for _, r in spheres])
        self.corners = corners

    @functools.cached_property
    def ours(self) -> tuple[np.ndarray, ...]:
        """Distance (h, s), normal (h, s, 3), bound (h, s), position (h, s, 3)."""
        hulls: Any = type("Hulls", (), self.table)()  # as much of a bank as is read
        table = hull_contact.hull_table(hulls)

        def one(hull: Any, rotation: Any, position: Any, centre: Any, radius: Any) -> Any:
            none, yes = jnp.full(1, -1, jnp.int32), jnp.ones(1, bool)
            slots = Slots(hull[None], none, yes, position[None], rotation[None], jnp.ones(1))
            found = hull_contact.find_contacts(centre[None], radius[None], slots, table, 1)
            bound = hull_contact.distance_bound(centre[None], radius[None], slots, table)[0, 0]
            return found.distance[0], found.normal[0], bound, found.position[0]

        over_spheres = jax.vmap(one, in_axes=(None, None, None, 0, 0))
        hull = jnp.arange(NUM_HULLS)
        args = (jnp.asarray(a, jnp.float32) for a in (self.rotation, self.position, self.centre, self.radius))
        return tuple(np.array(a) for a in jax.jit(jax.vmap(over_spheres))(hull, *args))

    @functools.cached_property
    def reference(self) -> tuple[np.ndarray, np.ndarray]:
        """Distance (h, s) by C MuJoCo and the vector (h, s, 3) between the nearest points."""
        distance = np.zeros((NUM_HULLS, SPHERES_PER_HULL))
        route = np.zeros((NUM_HULLS, SPHERES_PER_HULL, 3))
        for h in range(NUM_HULLS):
            spec = mujoco.MjSpec()
            spec.add_mesh(name="hull", uservert=self.corners[h].astype(np.float64).ravel())
            quat = np.zeros(4)
            mujoco.mju_mat2Quat(quat, self.rotation[h].ravel())
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull", pos=self.position[h], quat=quat)
            for s in range(SPHERES_PER_HULL):
                spec.worldbody.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[self.radius[h, s], 0, 0], pos=self.centre[h, s]
                )
            model = spec.compile()
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            for s in range(SPHERES_PER_HULL):
                ends = np.zeros(6)
                distance[h, s] = mujoco.mj_geomDistance(model, data, 0, 1 + s, 10.0, ends)
                route[h, s] = ends[3:] - ends[:3]
        return distance, route


@pytest.fixture(scope="module")
def case() -> Case:
    return Case(0)


def test_distances_are_those_of_c_mujoco(case: Case) -> None:
    distance, normal, bound, position = case.ours
    reference, route = case.reference
    touching = reference < 0
    assert touching.sum() > 250
    assert (~touching).sum() > 100
    # With the centre of the sphere within millimetres of the surface C's answer is off by as much, see below.
    sure = touching & (np.abs(reference + case.radius) > 0.004)
    assert sure.sum() > 0.85 * touching.sum()
    np.testing.assert_allclose(distance[sure], reference[sure], atol=1e-4)
    np.testing.assert_allclose(distance[touching], reference[touching], atol=5e-3)
    # The shortest exit from a convex body is through its nearest plane, which is exact for any centre inside.
    local = np.einsum("hij,hsi->hsj", case.rotation, case.centre - case.position[:, None])
    planes = case.table["hull_planes"]
    height = np.einsum("hfi,hsi->hsf", planes[..., :3], local) - planes[:, None, :, 3]
    inside = height.max(-1) < 0
    assert inside.sum() > 50
    np.testing.assert_allclose(distance[inside], (height.max(-1) - case.radius)[inside], atol=1e-5)
    # Pairs that are apart need no exact distance, but must be apart, and not farther than they are.
    assert (distance[~touching] > -1e-5).all()
    assert (distance[~touching] < reference[~touching] + 1e-4).all()
    assert (bound < reference + 1e-5).all()
    # The normal points from the hull to the sphere; C gives the vector between the nearest points.
    deep = touching & (reference < -0.005)
    expected = -route[deep] / np.linalg.norm(route[deep], axis=1, keepdims=True)
    # Where several exits are nearly equally long (inside, at an edge) C MuJoCo may choose another one of equal depth.
    assert (np.einsum("ni,ni->n", normal[deep], expected) > 0.999).mean() > 0.97
    np.testing.assert_allclose(np.linalg.norm(normal, axis=-1), 1.0, atol=1e-5)
    # The contact lies half-way between the two surfaces.
    middle = case.centre - normal * (case.radius + 0.5 * distance)[..., None]
    np.testing.assert_allclose(position, middle, atol=1e-5)


def test_touching_spheres_outside_have_exact_normals(case: Case) -> None:
    """A sphere whose centre is outside has one nearest point: normal and distance must agree to float precision."""
    _, normal, _, _ = case.ours
    reference, route = case.reference
    outside = (reference < -0.005) & (reference > -0.9 * case.radius)
    assert outside.sum() > 150
    expected = -route[outside] / np.linalg.norm(route[outside], axis=1, keepdims=True)
    angle = np.linalg.norm(np.cross(normal[outside], expected), axis=1)
    assert np.quantile(angle, 0.98) < 2e-3


def two_plates(gap: float) -> tuple[Slots, hull_contact.HullTable]:
    """Two cubes of 2 m side by side with flat tops at z = 0, the seam at x = 0."""
    cube = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T.astype(np.float32)
    bank: Any = type("Hulls", (), hull_table([convex_part(cube)]))()
    position = jnp.array([[-1.0 - gap, 0.0, -1.0], [1.0 + gap, 0.0, -1.0]])
    eye = jnp.broadcast_to(jnp.eye(3), (2, 3, 3))
    none = jnp.full(2, -1, jnp.int32)
    slots = Slots(jnp.zeros(2, jnp.int32), none, jnp.ones(2, bool), position, eye, jnp.ones(2))
    return slots, hull_contact.hull_table(bank)


@pytest.mark.parametrize("x", [-0.03, -0.002, 0.0, 0.001, 0.05])
def test_a_wheel_on_a_seam_stands_on_level_ground(x: float) -> None:
    slots, table = two_plates(0.0)
    found = find_contacts(jnp.array([[x, 0.2, 0.1095]]), jnp.array([0.11]), slots, table, 2)
    nearest = int(jnp.argmin(found.distance))
    np.testing.assert_allclose(found.distance[nearest], -0.0005, atol=1e-6)
    np.testing.assert_allclose(found.normal[nearest], (0, 0, 1), atol=1e-6)


def test_pairs_beyond_the_number_of_contacts_are_counted() -> None:
    slots, table = two_plates(0.0)
    centres = jnp.array([[x, y, 0.1] for x in (-0.5, 0.5) for y in (-0.5, 0.0, 0.5)])
    radii = jnp.full(6, 0.11)
    enough = find_contacts(centres, radii, slots, table, 8)
    assert int(enough.missed) == 0
    assert int((enough.distance < 0).sum()) == 6
    few = find_contacts(centres, radii, slots, table, 4)
    assert int(few.missed) == 2
    assert int((few.distance < 0).sum()) == 4


@pytest.mark.parametrize(("number", "missed"), [(4, 0), (6, 2)])
def test_two_thirds_of_the_contacts_may_be_at_edges(number: int, missed: int) -> None:
    """Of six contacts four: those are exact, more are counted."""
    slots, table = two_plates(0.0)
    centres = jnp.array([[-2.05, -0.5 + 0.2 * k, 0.05] for k in range(number)])
    found = find_contacts(centres, jnp.full(number, 0.11), slots, table, 6)
    assert int(found.missed) == missed
    deep = np.isclose(found.distance, np.hypot(0.05, 0.05) - 0.11, atol=1e-6)
    assert deep.sum() == 4
    np.testing.assert_allclose(found.normal[deep], np.tile([-np.sqrt(0.5), 0.0, np.sqrt(0.5)], (4, 1)), atol=1e-5)


def test_empty_slots_touch_nothing() -> None:
    slots, table = two_plates(0.0)
    slots = slots._replace(valid=jnp.zeros(2, bool))
    found = find_contacts(jnp.zeros((3, 3)), jnp.full(3, 0.11), slots, table, 4)
    assert (found.distance == jnp.inf).all()
    assert jnp.isfinite(found.position).all()
    assert jnp.isfinite(found.normal).all()


def test_planes_and_edges_of_a_box_are_those_of_a_box(small_bank: SceneBank) -> None:
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T.astype(np.float32)
    part = convex_part(corners)
    planes, edges = hull_contact.planes_and_edges(part.corners, part.triangles, part.planes)
    assert len(planes) == 6
    assert len(edges) == 12
    np.testing.assert_allclose(np.abs(edges[:, 3:]).sum(1), 2.0)
    table = hull_contact.hull_table(small_bank)
    assert table.planes.shape[0] == table.edges.shape[0] == small_bank.num_hulls
