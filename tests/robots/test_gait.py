"""The gait file: equal actions by hand, in NumPy and in JAX, and errors for invalid files."""

import dataclasses
import pathlib

import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.gaits import make_gait
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.robots.gait import Gait, sensor_frame


def test_frame_by_hand() -> None:
    frame = sensor_frame(
        np, np.array([4.0, 0, 0]), np.array([0, 0, -1.0]), np.full(2, 0.3), np.full(2, 20.0), np.ones(3), np.zeros(2)
    )
    np.testing.assert_allclose(frame, [1, 0, 0, 0, 0, -1, 0.3, 0.3, 1, 1, 1, 1, 1, 0, 0])


def test_network_by_hand() -> None:
    """15 inputs, two hidden units, one action: ELU on both sides of zero, tanh at the end."""
    kernel = np.zeros((12, 2), np.float32)
    kernel[0] = 1.0, -1.0
    gait = Gait(
        (kernel, np.ones((2, 1), np.float32)),
        (np.zeros(2, np.float32), np.full(1, 0.5, np.float32)),
        stand=np.array([0.2], np.float32),
        scale=np.array([0.5], np.float32),
        history=1,
        control_dt=0.02,
        meta={},
    )
    seen = np.zeros(12)
    seen[0] = 2.0
    action = gait.action(np, seen)
    assert action[0] == pytest.approx(np.tanh(2.0 + (np.exp(-2.0) - 1.0) + 0.5), rel=1e-6)
    assert gait.target(action)[0] == pytest.approx(0.2 + 0.5 * action[0])


def test_file_gives_back_the_gait_and_jax_agrees(tmp_path: pathlib.Path) -> None:
    gait = make_gait(seed=3)
    gait.save(tmp_path / "g.npz")
    back = Gait.load(tmp_path / "g.npz")
    assert (back.history, back.control_dt, back.meta) == (gait.history, gait.control_dt, gait.meta)
    seen = np.random.default_rng(0).normal(size=(7, gait.history * 45)).astype(np.float32)
    np.testing.assert_array_equal(back.action(np, seen), gait.action(np, seen))
    np.testing.assert_allclose(np.asarray(back.action(jnp, jnp.asarray(seen))), gait.action(np, seen), atol=2e-6)
    assert np.abs(gait.action(np, seen)).max() < 1.0


def test_half_precision_halves_the_file_and_is_kept_to_the_bit(tmp_path: pathlib.Path) -> None:
    gait = make_gait(seed=3)
    half = gait.in_half_precision()
    sizes, seen = [], np.random.default_rng(0).normal(size=(7, gait.history * 45)).astype(np.float32)
    for one in (gait, half):
        one.save(tmp_path / "g.npz")
        back = Gait.load(tmp_path / "g.npz")
        for found, expected in zip((*back.kernels, *back.biases), (*one.kernels, *one.biases), strict=True):
            assert found.dtype == np.float32
            np.testing.assert_array_equal(found, expected)
        sizes.append((tmp_path / "g.npz").stat().st_size)
    assert sizes[1] < 0.6 * sizes[0]
    off = np.abs(np.concatenate([(a - b).ravel() for a, b in zip(half.kernels, gait.kernels, strict=True)]))
    assert 0.0 < off.max() <= 2.0**-11 * max(np.abs(kernel).max() for kernel in gait.kernels)
    np.testing.assert_allclose(half.action(np, seen), gait.action(np, seen), atol=2e-3)
    large = dataclasses.replace(gait, biases=(*gait.biases[:-1], np.full(12, 7e4, np.float32)))
    with pytest.raises(ValidationError, match="a weight beyond 65,504"):
        large.in_half_precision()
    large.save(tmp_path / "large.npz")
    np.testing.assert_array_equal(Gait.load(tmp_path / "large.npz").biases[-1], large.biases[-1])


def test_what_is_no_gait_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="export-gait"):
        Gait.load(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("hello")
    with pytest.raises(ValidationError, match="unreadable"):
        Gait.load(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(ValidationError, match="head: found something that is not JSON"):
        Gait.load(tmp_path / "other.npz")
    gait = make_gait()
    with pytest.raises(ValidationError, match="225 to 12"):
        Gait(gait.kernels[1:], gait.biases[1:], gait.stand, gait.scale, gait.history, gait.control_dt, {})
