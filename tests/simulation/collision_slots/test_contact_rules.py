"""Which touches of a step count, and where a body that moves touches the ground, by hand."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.simulation.collision_slots import body_contact, static_slots
from urbanverse_mjx.simulation.collision_slots.agent_slots import FIRST_OWNER, noted
from urbanverse_mjx.simulation.collision_slots.static_slots import Slots


class Touch(NamedTuple):
    agent: jnp.ndarray
    agent_force: jnp.ndarray


@pytest.mark.parametrize(
    ("before", "met", "force", "after"),
    [
        ((-1, 0.0), (True, True), (3.0, 5.0), (1, 5.0)),
        ((2, 9.0), (True, True), (3.0, 5.0), (2, 9.0)),
        ((2, 4.0), (True, True), (3.0, 5.0), (1, 5.0)),
        ((2, 4.0), (True, False), (3.0, 5.0), (2, 4.0)),
        ((-1, 0.0), (False, False), (3.0, 5.0), (-1, 0.0)),
        ((-1, 0.0), (True, False), (0.0, 5.0), (0, 0.0)),
    ],
)
def test_the_agent_that_was_hit_hardest_is_noted(before, met, force, after) -> None:
    touch = Touch(jnp.int32(before[0]), jnp.float32(before[1]))
    owner = FIRST_OWNER - jnp.arange(2)
    found = noted(touch, jnp.array(met), owner, jnp.array(force))
    assert (int(found.agent), float(found.agent_force)) == after


def test_a_body_touches_the_ground_at_its_outermost_points() -> None:
    """An octagon that sinks 5 mm into a slab, with points inside it, above it and beside the slab."""
    angles = body_contact.FIRST_DIRECTION + 2.0 * np.pi * np.arange(8) / 8
    ring = np.stack([0.4 * np.cos(angles), 0.3 * np.sin(angles), np.full(8, -0.005)], -1)
    others = np.array([[0.1, 0.0, -0.005], [2.0, 0.0, 0.5], [-9.0, 0.0, -0.005]])
    faces = np.concatenate([np.eye(3), -np.eye(3)])
    planes = np.concatenate([faces.T, np.array([[5.0, 5.0, 1.0, 5.0, 5.0, 1.0]])])
    prisms = Slots(
        hull=jnp.zeros((1, 1), jnp.int32),
        owner=jnp.full((1, 1), -1),
        valid=jnp.ones((1, 1), bool),
        position=jnp.array([[[0.0, 0.0, -1.0]]]),
        rotation=jnp.eye(3)[None, None],
        friction=jnp.full((1, 1), 0.5),
    )
    places = jnp.asarray(np.concatenate([ring, others])[None], jnp.float32)
    found = body_contact.ground_contacts(
        places, jnp.zeros((1, 3)), prisms, jnp.asarray(planes[None], jnp.float32), jnp.full(1, 0.9)
    )
    touching = np.isfinite(np.asarray(found.distance).reshape(-1))
    where = np.asarray(found.position).reshape(-1, 3)[touching]
    corners = {tuple(np.round(p[:2], 4)) for p in ring}
    assert {tuple(np.round(p[:2].astype(float), 4)) for p in where} <= corners
    assert len(where) >= 6, "an oval has most of its corners outermost"
    np.testing.assert_allclose(where[:, 2], -0.0025, atol=1e-6)
    np.testing.assert_allclose(np.asarray(found.distance).reshape(-1)[touching], -0.005, atol=1e-6)
    np.testing.assert_allclose(np.asarray(found.normal).reshape(-1, 3)[touching], [[0.0, 0.0, 1.0]] * len(where))


@pytest.mark.parametrize(
    ("point", "cell"),
    [
        ((0.1, 0.1), (0, 0)),
        ((1.9, 2.1), (0, 1)),
        ((7.9, 5.9), (3, 2)),
        ((8.1, 6.1), (3, 2)),
        ((99.0, -99.0), (3, 0)),
        ((np.nan, 3.0), (0, 1)),
    ],
)
def test_points_outside_a_grid_are_in_its_nearest_cell(point: tuple[float, float], cell: tuple[int, int]) -> None:
    found = static_slots.grid_cell(jnp.zeros(2), 2.0, (4, 3), jnp.array([*point, 0.0]))
    assert found.tolist() == list(cell)
