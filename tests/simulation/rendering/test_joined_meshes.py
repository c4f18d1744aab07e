"""Joined tables of triangles show each corner as its own table does."""

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.simulation.rendering.meshes import RenderMeshes


def table(seed: int, textured: bool) -> RenderMeshes:
    """Two meshes of random corners, with UVs where textured."""
    rng, spec = np.random.default_rng(seed), mujoco.MjSpec()
    for name in ("a", "b"):
        corners = rng.normal(size=(12, 3))
        extra = {"usertexcoord": rng.random((12, 2)).ravel()} if textured else {}
        spec.add_mesh(
            name=name,
            uservert=corners.ravel(),
            userface=rng.permutation(12),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            **extra,
        )
    return RenderMeshes.of(spec.compile())


def corners(meshes: RenderMeshes) -> np.ndarray:
    """(F, 3, 8) position, normal and UV of every corner; UV NaN where there is none."""
    uv = np.concatenate([meshes.uv, np.full((1, 2), np.nan, np.float32)])  # row -1
    return np.concatenate(
        [meshes.vertices[meshes.face], meshes.normals[meshes.face_normal], uv[meshes.face_uv]], axis=-1
    )


@pytest.mark.parametrize("textured", [(True, False, True), (False, False), (False, True, False), (True,)])
def test_corners_stay_what_they_are(textured: tuple[bool, ...]) -> None:
    parts = [table(seed, has_uv) for seed, has_uv in enumerate(textured)]
    before = [{name: array.copy() for name, array in vars(part).items()} for part in parts]
    whole = RenderMeshes.joined(parts)
    np.testing.assert_array_equal(corners(whole), np.concatenate([corners(part) for part in parts]))
    np.testing.assert_array_equal(whole.count, np.concatenate([part.count for part in parts]))
    assert np.isnan(corners(whole)).any() == (not all(textured))
    for part, kept in zip(parts, before, strict=True):
        for name, array in kept.items():
            np.testing.assert_array_equal(getattr(part, name), array)
            assert getattr(whole, name).dtype == array.dtype
