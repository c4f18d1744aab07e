"""Distance fields against distances worked out point by point."""

import dataclasses
import functools
import pathlib

import jax.numpy as jnp
import numpy as np
import pytest
from scipy import ndimage

from urbanverse_mjx.datatypes import SceneBank, traversable
from urbanverse_mjx.envs.navigation import surroundings as module
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.surroundings import CELL, MAX_DISTANCE, Surroundings, build_fields
from urbanverse_mjx.geometry import raster
from urbanverse_mjx.geometry.grids import Grid

HEIGHT = 0.7


@pytest.fixture(scope="module")
def surroundings(small_bank: SceneBank) -> Surroundings:
    return Surroundings(small_bank, HEIGHT)


def places(bank: SceneBank, scene: int, count: int) -> np.ndarray:
    size = np.array(bank.map_kind.shape[1:]) * float(bank.map_resolution)
    return bank.map_origin[scene] + np.random.default_rng(scene).random((count, 2)) * size


def test_distance_to_hulls(small_bank: SceneBank, surroundings: Surroundings) -> None:
    """Boxes of `box_bank` stand upright, so the ground distance to their footprints is what counts."""
    for scene in range(small_bank.num_scenes):
        points = places(small_bank, scene, 300)
        wanted = np.full(len(points), MAX_DISTANCE)
        for q in np.flatnonzero(small_bank.inst_hull[scene] >= 0):
            centre, half = small_bank.hull_box[small_bank.inst_hull[scene, q]]
            rotation = small_bank.inst_rotation[scene, q]
            assert abs(rotation[2, 2]) == pytest.approx(1.0)
            local = (points - small_bank.inst_position[scene, q, :2]) @ rotation[:2, :2] - centre[:2]
            wanted = np.minimum(wanted, np.linalg.norm(np.maximum(np.abs(local) - half[:2], 0.0), axis=1))
        got = np.asarray(surroundings.distances(scene, jnp.asarray(points)))[:, 0]
        # A distance has at most the error of the distance to the cell's middle, and is stored in whole centimetres.
        assert np.abs(got - wanted).max() <= CELL * np.sqrt(0.5) + 0.006
        assert (wanted < MAX_DISTANCE).mean() > 0.1


def one_by_one(bank: SceneBank, scene: int, shape: tuple[int, int]) -> np.ndarray:
    """(X, Y, 2) u8 cm, the fields of a scene: hull after hull, each only in the cells within reach, and the whole map
    at once."""
    ground = float(np.median(bank.episode_start[scene, : int(bank.num_episodes[scene]), 2]))
    bottom, top, shapes = ground + module.MIN_OBSTACLE_HEIGHT, ground + HEIGHT, []

    def to_box(rotation: np.ndarray, position: np.ndarray, box: np.ndarray, z: float, x: np.ndarray, y: np.ndarray):
        along = np.outer(rotation[0], x - position[0]) - box[0][:, None]
        across = np.outer(rotation[1], y - position[1]) + (rotation[2] * z)[:, None]
        outside = np.maximum(np.abs(along[:, :, None] + across[:, None]) - box[1][:, None, None], 0.0) ** 2
        return np.sqrt(outside[0] + outside[1] + outside[2])

    for q in np.flatnonzero(bank.inst_hull[scene] >= 0):
        rotation, position = bank.inst_rotation[scene, q], bank.inst_position[scene, q]
        box = bank.hull_box[bank.inst_hull[scene, q]]
        middle, reach = position + rotation @ box[0], np.abs(rotation) @ box[1]
        if middle[2] - reach[2] <= top and middle[2] + reach[2] >= bottom:
            z = np.clip(middle[2], bottom, top) - position[2]
            to = functools.partial(to_box, rotation, position, box, z)
            shapes.append((middle[:2] - reach[:2], middle[:2] + reach[:2], to))
    walkable, times = traversable(bank.map_kind[scene]), round(CELL / float(bank.map_resolution))
    walkable = np.pad(walkable, [(0, n * times - m) for n, m in zip(shape, walkable.shape, strict=True)])
    hulls = raster.nearest(Grid(bank.map_origin[scene], CELL, shape), shapes, MAX_DISTANCE)
    whole = walkable.reshape(shape[0], times, shape[1], times).all((1, 3))
    edge = ndimage.distance_transform_edt(np.pad(whole, 1))[1:-1, 1:-1] * CELL
    return np.rint(np.minimum(np.stack([hulls, edge], -1), MAX_DISTANCE) * 100.0).astype(np.uint8)


def test_hulls_computed_together_give_what_each_gives_alone(small_bank: SceneBank, bank: SceneBank) -> None:
    """Bit by bit, in shipped streets and in one whose hulls are tilted, and stand on and beyond the map's border."""
    rng = np.random.default_rng(0)
    size = np.array(small_bank.map_kind.shape[1:]) * float(small_bank.map_resolution)
    turned = np.linalg.qr(rng.normal(size=(*small_bank.inst_hull.shape, 3, 3)))[0].astype(np.float32)
    moved = small_bank.inst_position.copy()
    moved[..., :2] = small_bank.map_origin[:, None] + rng.uniform(-0.05, 1.05, moved[..., :2].shape) * size
    tilted = dataclasses.replace(small_bank, inst_rotation=turned, inst_position=moved)
    for streets, scenes in ((tilted, range(tilted.num_scenes)), (bank, range(2))):
        fields = build_fields(streets, HEIGHT)
        for scene in scenes:
            wanted = one_by_one(streets, scene, fields.shape[1:3])
            assert (wanted[..., 0] < 255).mean() > 0.01
            assert (wanted[..., 1] > 0).any()
            np.testing.assert_array_equal(fields[scene], wanted)


def test_a_scene_without_walkable_ground_has_no_distance_to_its_edge(small_bank: SceneBank) -> None:
    nothing = dataclasses.replace(small_bank, map_kind=np.zeros_like(small_bank.map_kind))
    fields = build_fields(nothing, HEIGHT)
    assert (fields[..., 1] == 0).all()
    np.testing.assert_array_equal(fields[..., 0], build_fields(small_bank, HEIGHT)[..., 0])


@pytest.mark.extended
def test_distance_to_the_edge(small_bank: SceneBank, surroundings: Surroundings) -> None:
    walkable = traversable(small_bank.map_kind)
    for scene in range(small_bank.num_scenes):
        away = small_bank.map_origin[scene] + (np.argwhere(~walkable[scene]) + 0.5) * float(small_bank.map_resolution)
        points = places(small_bank, scene, 200)
        wanted = np.array([np.linalg.norm(away - p, axis=1).min() for p in points])
        got = np.asarray(surroundings.distances(scene, jnp.asarray(points)))[:, 1]
        inside = wanted < MAX_DISTANCE - 0.5
        # Cells of 20 cm count as walkable only as a whole: up to two of them are lost at an edge.
        assert np.abs(got - wanted)[inside].max() <= 2 * CELL * np.sqrt(2.0)
        assert (got[wanted > 1.0] > 0.4).all()


def test_outside_of_the_map_nothing_is_free(small_bank: SceneBank, surroundings: Surroundings) -> None:
    far = small_bank.map_origin[0] - 5.0
    assert (np.asarray(surroundings.distances(0, jnp.asarray(far))) == 0.0).all()


def test_to_world_undoes_to_body() -> None:
    rng = np.random.default_rng(0)
    for yaw in rng.uniform(-np.pi, np.pi, 20):
        vector = jnp.asarray(rng.normal(size=2), jnp.float32)
        np.testing.assert_allclose(terms.to_body(terms.to_world(vector, jnp.float32(yaw)), yaw), vector, atol=1e-6)


def test_reward_near_object_is_zero_from_a_metre_on() -> None:
    distance = jnp.array([0.0, 0.4, 0.7, 1.0, 2.0])
    np.testing.assert_allclose(terms.reward_near_object(distance), [1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-6)


def test_large_banks_are_kept_in_the_cache(
    small_bank: SceneBank, surroundings: Surroundings, monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    monkeypatch.setattr(module, "MIN_CACHED_HULLS", 1)
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    for _ in range(2):
        np.testing.assert_array_equal(Surroundings(small_bank, HEIGHT).fields, surroundings.fields)
    (kept,) = (tmp_path / "surroundings").iterdir()
    monkeypatch.setattr(module, "build_fields", lambda *_: pytest.fail("built though kept"))
    Surroundings(small_bank, HEIGHT)
    monkeypatch.undo()
    monkeypatch.setattr(module, "MIN_CACHED_HULLS", 1)
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    kept.write_bytes(b"not a file of numpy's")
    np.testing.assert_array_equal(Surroundings(small_bank, HEIGHT).fields, surroundings.fields)
    assert (Surroundings(small_bank, HEIGHT + 1.0).fields <= surroundings.fields).all()
    assert len(list((tmp_path / "surroundings").glob("*.npz"))) == 2
