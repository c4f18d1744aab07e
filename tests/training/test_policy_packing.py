"""Packed policies are smaller, and the same to the bit."""

import pathlib

import jax
import numpy as np
import orbax.checkpoint as ocp
import pytest

from urbanverse_mjx.training.policy import export_actor
from urbanverse_mjx.training.policy_packing import pack_arrays

SHIPPED = pathlib.Path(__file__).parents[2] / "benchmarks/policies/coco_paper"


def _size(folder: pathlib.Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _values(rng: np.random.Generator) -> dict[str, object]:
    weights = rng.normal(0.0, 0.05, (300, 257))
    special = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e-40, np.finfo(np.float32).max], np.float32)
    layers = {"kernel": weights.astype(np.float16), "bias": np.zeros(257, np.float32), "special": special}
    return {
        "params": {"layers_0": layers, "layers_1": {"kernel": weights.astype(np.float32)}},
        "steps": np.array(7, np.int64),
    }


def test_arrays_are_the_same_to_the_bit_and_smaller(tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "policy"
    values = _values(np.random.default_rng(0))
    ocp.PyTreeCheckpointer().save(folder, values)
    before, named = _size(folder), (folder / "_METADATA").read_bytes()
    pack_arrays(folder)
    assert _size(folder) < 0.95 * before
    assert (folder / "_METADATA").read_bytes() == named
    found = ocp.PyTreeCheckpointer().restore(folder)
    expected, actual = (jax.tree_util.tree_flatten_with_path(tree)[0] for tree in (values, found))
    assert [path for path, _ in actual] == [path for path, _ in expected]
    for (path, x), (_, y) in zip(expected, actual, strict=True):
        assert (y.dtype, y.shape, y.tobytes()) == (x.dtype, x.shape, x.tobytes()), path
    assert [path.name for path in tmp_path.iterdir()] == ["policy"], "no work folder is left"
    size = _size(folder)
    pack_arrays(folder)
    assert _size(folder) == pytest.approx(size, rel=0.01), "a packed policy can be packed"


def test_an_exported_policy_is_packed(tmp_path: pathlib.Path) -> None:
    """A shipped one is, so that it has the same size again; unpacked it has a tenth more."""
    assert _size(export_actor(SHIPPED, tmp_path / "out")) == pytest.approx(_size(SHIPPED), rel=0.02)
