"""Rotations agree with SciPy's, in numpy and under jit, with the right sense of rotation."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from urbanverse_mjx.geometry import rotations

COUNT = 50


def drawn(seed: int) -> tuple[np.ndarray, Rotation]:
    quaternion = Rotation.random(COUNT, random_state=seed).as_quat(scalar_first=True)
    return quaternion, Rotation.from_quat(quaternion, scalar_first=True)


@pytest.mark.parametrize("in_jax", [False, True])
def test_quaternions_turn_as_scipys(in_jax: bool) -> None:
    p, first = drawn(0)
    q, second = drawn(1)
    vector = np.random.default_rng(2).normal(size=(COUNT, 3))

    def found(p: Any, q: Any, vector: Any) -> tuple[Any, ...]:
        return rotations.matrix(p), rotations.matrix(rotations.product(p, q)), rotations.rotate(p, vector)

    wanted = first.as_matrix(), (first * second).as_matrix(), first.apply(vector)
    got = jax.jit(found)(*(jnp.asarray(a, jnp.float32) for a in (p, q, vector))) if in_jax else found(p, q, vector)
    for one, other in zip(got, wanted, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-5 if in_jax else 1e-12)


def test_rotation_vectors_are_scipys_also_near_zero() -> None:
    vectors = np.random.default_rng(3).normal(size=(COUNT, 3)) * np.logspace(-12, 0, COUNT)[:, None]
    vectors[0] = 0.0
    wanted = Rotation.from_rotvec(vectors).as_quat(scalar_first=True)
    np.testing.assert_allclose(rotations.from_rotation_vector(vectors), wanted, atol=1e-15)
    single = jax.jit(rotations.from_rotation_vector)(jnp.asarray(vectors, jnp.float32))
    np.testing.assert_allclose(single, wanted, atol=1e-6)


def test_stored_quaternions_need_not_be_of_unit_length() -> None:
    quaternion, wanted = drawn(3)
    found = rotations.matrix_f64((3.0 * quaternion).astype(np.float32))
    assert found.dtype == np.float64
    np.testing.assert_allclose(found @ found.swapaxes(-1, -2), np.broadcast_to(np.eye(3), found.shape), atol=1e-14)
    np.testing.assert_allclose(found, wanted.as_matrix(), atol=1e-6)


def test_headings_are_counter_clockwise_and_survive_a_round_trip() -> None:
    yaw = np.linspace(-3.1, 3.1, COUNT)
    np.testing.assert_allclose(rotations.yaw_of(rotations.from_yaw(yaw)), yaw)
    np.testing.assert_allclose(rotations.yaw_of(rotations.from_yaw(jnp.asarray(yaw))), yaw, atol=1e-6)
    assert rotations.from_yaw(np.pi) == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-15)
    np.testing.assert_allclose(rotations.matrix(rotations.from_yaw(yaw))[7], rotations.about_z(yaw[7]), atol=1e-15)
    assert rotations.about_z(np.pi / 2) @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0])


def test_a_leaning_body_keeps_its_heading_and_loses_height() -> None:
    rolled = Rotation.from_euler("ZYX", [0.7, 0.3, -0.2])
    quaternion = rolled.as_quat(scalar_first=True)
    assert rotations.yaw_of(quaternion) == pytest.approx(0.7)
    assert rotations.up_of(quaternion) == pytest.approx(rolled.as_matrix()[2, 2])
