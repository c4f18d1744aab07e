"""Objects that were pushed in images: equal to a bank that has them there, and unchanged where no object moved."""

import dataclasses

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import Bodies, SceneBank
from urbanverse_mjx.simulation.rendering.renderer import Renderer

OUTPUTS = ("rgb", "depth", "category", "object", "normal")
LIGHT = {"shadows": True, "shading": "matte", "appearance": 0.2}
CAMERA_POSITION, AT = np.array([20.0, 0.0, 5.0]), np.array([26.0, 6.0, 0.0])


def looking() -> np.ndarray:
    """Quaternion of a camera at `CAMERA_POSITION` towards `AT`."""
    back = (CAMERA_POSITION - AT) / np.linalg.norm(CAMERA_POSITION - AT)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, np.stack([right, np.cross(back, right), back], 1).ravel())
    return turn


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(2, 0)


def homes(bank: SceneBank) -> tuple[np.ndarray, Bodies]:
    """Two objects of the first street in the camera's view and an empty slot, where the bank has them."""
    found = np.flatnonzero(bank.slot_movable[0])
    away = np.linalg.norm(bank.slot_position[0, found, :2] - AT[:2], axis=1)
    slots = np.append(found[np.argsort(away)[:2]], -1)
    zero = jnp.zeros((3, 3))
    place, turn = (jnp.asarray(x[0, slots]) for x in (bank.slot_position, bank.slot_quaternion))
    return slots, Bodies(jnp.asarray(slots), place, turn, zero, zero, jnp.zeros((3, 6)))


@pytest.mark.extended
def test_a_object_is_seen_where_it_was_pushed(bank: SceneBank) -> None:
    slots, home = homes(bank)
    view = looking()
    moving = Renderer(bank, None, 54, 96, OUTPUTS, bodies=3, **LIGHT)
    frame = jax.jit(lambda b: moving.view(0, CAMERA_POSITION, view, 1.2, appearance_seed=3, bodies=b))
    plain = Renderer(bank, None, 54, 96, OUTPUTS, **LIGHT).view(0, CAMERA_POSITION, view, 1.2, appearance_seed=3)
    at_rest, unasked = frame(home), moving.view(0, CAMERA_POSITION, view, 1.2, appearance_seed=3)
    for name in OUTPUTS:
        np.testing.assert_array_equal(at_rest[name], plain[name], err_msg=name)
        np.testing.assert_array_equal(unasked[name], plain[name], err_msg=name)
    pushed = home._replace(
        position=home.position.at[0].add(jnp.array([0.5, -1.5, 0.8])).at[1].add(jnp.array([0.0, -0.7, 0.1])),
        quaternion=home.quaternion.at[1].set(jnp.array([0.8, 0.6, 0.0, 0.0])),
    )
    place, turn = bank.slot_position.copy(), bank.slot_quaternion.copy()
    place[0, slots[:2]], turn[0, slots[:2]] = pushed.position[:2], pushed.quaternion[:2]
    other = dataclasses.replace(bank, slot_position=place, slot_quaternion=turn)
    reference = Renderer(other, None, 54, 96, OUTPUTS, **LIGHT).view(0, CAMERA_POSITION, view, 1.2, appearance_seed=3)
    found = frame(pushed)
    assert (np.asarray(found["object"]) != np.asarray(plain["object"])).sum() > 20
    for name in ("category", "object"):
        np.testing.assert_array_equal(found[name], reference[name], err_msg=name)
    np.testing.assert_allclose(found["depth"], reference["depth"], atol=1e-3)
    np.testing.assert_allclose(found["normal"], reference["normal"], atol=1e-3)
    # Tints belong to the number of an object, and the other bank's tree numbers objects another way.
    seen = np.isin(np.asarray(reference["object"]), slots[:2])
    assert seen.sum() > 20
    ground = np.asarray(bank.meta["categories"])[np.asarray(reference["category"])[~seen]]
    assert len(set(ground)) > 1


@pytest.mark.extended
def test_each_world_has_its_own(bank: SceneBank) -> None:
    """Two streets in one batch, in one of which an object was lifted out of the image."""
    slots, home = homes(bank)
    moving = Renderer(bank, None, 54, 96, ("object",), bodies=3)
    lifted = home._replace(position=home.position.at[0, 2].add(30.0))
    both = jax.tree.map(lambda *x: jnp.stack(x), home, lifted)
    view = looking()
    seen = jax.jit(jax.vmap(lambda b: moving.view(0, CAMERA_POSITION, view, 1.2, bodies=b)["object"]))(both)
    counts = (np.asarray(seen) == slots[0]).sum((1, 2))
    assert counts[0] > 0
    assert counts[1] == 0
