"""Poses at rest, by closed forms and by C MuJoCo, and assets of the catalogue that lie in one."""

import dataclasses
from collections.abc import Sequence

import mujoco
import numpy as np
import pytest

from urbanverse_mjx.assets import build_mesh, load_hulls, load_index
from urbanverse_mjx.assets.collision.lying import MARK, is_lying, lying, upright_uid
from urbanverse_mjx.assets.collision.rest_poses import firmest_pose, rest_poses, stands
from urbanverse_mjx.datatypes import AssetRecord

INDEX = load_index()
BOX = np.array([[x, y, z] for x in (-0.2, 0.2) for y in (-0.1, 0.1) for z in (0.0, 0.6)])
#: A base shape of each kind that does not stand on its hulls.
FALLING = ("shovel", "umbrella", "kite", "unicycle", "football")


def movement(hulls: Sequence[np.ndarray]) -> tuple[float, float]:
    """m and degrees by which hulls of 5 kg move on a plane within two seconds of C MuJoCo."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.005
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[9, 9, 1], pos=[0, 0, -1], contype=2, conaffinity=1)
    body = spec.worldbody.add_body()
    body.add_freejoint()
    for k, hull in enumerate(hulls):
        spec.add_mesh(name=f"hull_{k}", uservert=np.ravel(hull).astype(float).tolist())
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"hull_{k}", density=100.0, contype=1, conaffinity=2)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start, turned = data.xipos[1].copy(), data.xquat[1].copy()
    mujoco.mj_step(model, data, 400)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    angle = 2.0 * np.arccos(min(abs(float(data.xquat[1] @ turned)), 1.0))
    return float(np.linalg.norm(data.xipos[1] - start)), float(np.degrees(angle))


def shape(leaf: str) -> AssetRecord:
    """The first base shape of a leaf that does not stand."""
    return next(r for r in INDEX.by_leaf(leaf) if not stands(load_hulls(r).hulls))


def test_a_box_rests_on_its_sides_and_tips_over_its_shorter_edge() -> None:
    poses = rest_poses([BOX])
    np.testing.assert_allclose([p.turn for p in poses], np.radians([0, 90, 90, 90, 90, 180]), atol=1e-9)
    np.testing.assert_allclose(poses[0].margin, np.arctan(0.1 / 0.3))
    np.testing.assert_allclose(poses[0].down, [0, 0, -1], atol=1e-12)
    assert stands([BOX])
    firmest = firmest_pose([BOX])  # on its broad side: 0.4 x 0.6 m, the centre 0.1 m high
    assert firmest is not None
    np.testing.assert_allclose(firmest.margin, np.arctan(0.2 / 0.1))
    np.testing.assert_allclose(np.abs(firmest.down), [0, 1, 0], atol=1e-12)


def test_hulls_count_as_one_body() -> None:
    """A slab on a post: 0.5 m beside the post's middle its weight is outside the foot."""
    post, slab = BOX, BOX * [3.0, 3.0, 0.3] + [0.0, 0.0, 0.6]
    assert stands([post, slab])
    assert not stands([post, slab + [0.5, 0.0, 0.0]])
    assert movement([post, slab])[1] < 1.0
    assert movement([post, slab + [0.5, 0.0, 0.0]])[1] > 20.0


def test_what_stands_on_a_point_does_not_stand() -> None:
    assert not stands([BOX * np.where(BOX[:, 2:] == 0.0, [[0.001, 0.001, 1.0]], 1.0)])


@pytest.mark.parametrize("leaf", FALLING)
def test_a_shape_that_falls_is_at_rest_when_it_lies(leaf: str) -> None:
    record = shape(leaf)
    laid = lying(record)
    assert laid is not None
    hulls, mesh = load_hulls(laid).hulls, build_mesh(laid)
    shift, angle = movement(hulls)
    assert shift < 0.005
    assert angle < 1.0
    if leaf != "football":  # which may balance on its corner for two seconds
        assert movement(load_hulls(record).hulls)[1] > 5.0
    assert min(float(h[:, 2].min()) for h in hulls) == pytest.approx(0.0, abs=2e-4)
    np.testing.assert_allclose(mesh.extent, laid.extent_xyz, atol=1e-3)
    np.testing.assert_allclose(mesh.vertices[:, :2].min(0) + mesh.vertices[:, :2].max(0), 0.0, atol=1e-3)
    assert laid.mass == record.mass


def test_shovels_and_kites_lie_flat_and_a_ball_keeps_its_size() -> None:
    for leaf in ("shovel", "kite"):
        record = shape(leaf)
        laid = lying(record)
        assert laid is not None
        assert laid.height < 0.2 < record.height
        assert laid.length == pytest.approx(record.height, rel=0.05)
    ball = shape("football")
    laid = lying(ball)
    assert laid is not None
    np.testing.assert_allclose(laid.extent_xyz, ball.extent_xyz, rtol=0.03)


def test_the_turn_moves_hulls_with_the_mesh_and_closer_hulls_are_not_used() -> None:
    laid = lying(shape("shovel"))
    assert laid is not None
    low, high = build_mesh(laid).vertices.min(0), build_mesh(laid).vertices.max(0)
    corners = np.concatenate(load_hulls(laid).hulls)
    np.testing.assert_allclose([corners.min(0), corners.max(0)], [low, high], atol=0.03)
    for hull, other in zip(load_hulls(laid).hulls, load_hulls(laid, "close").hulls, strict=True):
        np.testing.assert_array_equal(hull, other)


def test_uids_tell_lying_assets_and_the_index_holds_none() -> None:
    record = shape("shovel")
    laid = lying(record)
    assert laid is not None
    assert laid.uid == record.uid + MARK
    assert upright_uid(laid.uid) == record.uid == upright_uid(record.uid)
    assert is_lying(laid.uid)
    assert not [r.uid for r in INDEX.records if is_lying(r.uid)]


def test_an_imported_asset_is_not_laid() -> None:

    assert lying(dataclasses.replace(shape("shovel"), recipe="file")) is None
