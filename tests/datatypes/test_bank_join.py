"""Joined banks: every scene has the same hulls, meshes, textures, skies and episodes as before."""

import dataclasses
import pathlib

import numpy as np
import pytest

from tests.support.agent_appearances import BOXES, with_box_agents
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.bank_join import join


def renamed(bank: SceneBank, suffix: str) -> SceneBank:
    return dataclasses.replace(bank, meta={**bank.meta, "scene_ids": [s + suffix for s in bank.scene_ids]})


def wider(bank: SceneBank) -> SceneBank:
    """The same streets in larger arrays, with one more corner on every route."""
    more = bank.episode_waypoints[:, :, -1:]
    slots = np.full((bank.num_scenes, 3), -1, np.int32)
    ids = [[*row, "", "", ""] for row in bank.meta["object_ids"]]
    still = np.tile(np.array([1, 0, 0, 0], np.float32), (bank.num_scenes, 3, 1))
    return dataclasses.replace(
        bank,
        episode_waypoints=np.concatenate([bank.episode_waypoints, more], 2),
        slot_mesh=np.concatenate([bank.slot_mesh, slots], 1),
        slot_category=np.concatenate([bank.slot_category, slots], 1),
        slot_position=np.pad(bank.slot_position, ((0, 0), (0, 3), (0, 0))),
        slot_quaternion=np.concatenate([bank.slot_quaternion, still], 1),
        meta={**bank.meta, "object_ids": ids},
    )


def mesh(bank: SceneBank, number: int) -> tuple[np.ndarray, ...]:
    vertices = slice(*bank.mesh_vertex_start[number : number + 2])
    faces = slice(*bank.mesh_face_start[number : number + 2])
    material = bank.mesh_material[number]
    texture = bank.texture(int(bank.material_texture[material]))
    style = np.array([bank.material_roughness[material], bank.material_metallic[material]])
    return bank.mesh_vertices[vertices], bank.mesh_uv[vertices], bank.mesh_faces[faces], texture, style


def assert_same_scene(a: SceneBank, i: int, b: SceneBank, j: int) -> None:
    for name in ("inst", "prism"):
        rows_a, rows_b = getattr(a, f"{name}_hull")[i], getattr(b, f"{name}_hull")[j]
        there = rows_a >= 0
        assert (rows_b[: len(there)][there] >= 0).all()
        assert (rows_b >= 0).sum() == there.sum()
        for table in ("hull_vertices", "hull_planes", "hull_box", "hull_num_triangles"):
            np.testing.assert_array_equal(
                getattr(a, table)[rows_a[there]], getattr(b, table)[rows_b[: len(there)][there]]
            )
    for q, p in zip(a.slot_mesh[i], b.slot_mesh[j], strict=False):
        assert (q < 0) == (p < 0)
        if q >= 0:
            for x, y in zip(mesh(a, q), mesh(b, p), strict=True):
                np.testing.assert_array_equal(x, y)
    for q, p in zip(a.slot_category[i], b.slot_category[j], strict=False):
        assert (q < 0) == (p < 0)
        assert q < 0 or a.meta["categories"][q] == b.meta["categories"][p]
    np.testing.assert_array_equal(a.sky_radiance[a.scene_sky[i]], b.sky_radiance[b.scene_sky[j]])
    number = int(a.num_episodes[i])
    assert number == b.num_episodes[j]
    for name in ("start", "goal", "num_waypoints", "length"):
        key = f"episode_{name}"
        np.testing.assert_array_equal(getattr(a, key)[i, :number], getattr(b, key)[j, :number])
    old, new = a.episode_waypoints[i, :number], b.episode_waypoints[j, :number]
    np.testing.assert_array_equal(old, new[:, : old.shape[1]])
    assert (new[:, old.shape[1] :] == old[:, -1:]).all(), "the goal repeats"


def test_every_scene_is_what_it_was(small_bank: SceneBank) -> None:
    banks = [renamed(small_bank, "_a"), wider(renamed(small_bank, "_b"))]
    whole = join(banks)
    assert whole.scene_ids == banks[0].scene_ids + banks[1].scene_ids
    assert whole.meta["splits"] == small_bank.meta["splits"] * 2
    row = 0
    for bank in banks:
        for i in range(bank.num_scenes):
            assert_same_scene(bank, i, whole, row)
            row += 1
    np.testing.assert_allclose(np.linalg.norm(whole.slot_quaternion, axis=-1), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.linalg.det(whole.inst_rotation), 1.0, atol=1e-4)


def test_joined_bank_can_be_saved_and_one_bank_stays_as_it_is(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    join([small_bank, renamed(small_bank, "_b")]).save(tmp_path / "bank.npz")
    assert SceneBank.load(tmp_path / "bank.npz").num_scenes == 2 * small_bank.num_scenes
    alone = join([small_bank])
    for name, array in small_bank.arrays().items():
        np.testing.assert_array_equal(array, getattr(alone, name), err_msg=name)


def test_maps_take_the_coarsest_cells(small_bank: SceneBank) -> None:
    coarse = dataclasses.replace(
        renamed(small_bank, "_b"),
        map_kind=small_bank.map_kind[:, 1::2, 1::2],
        map_resolution=np.float32(2 * small_bank.map_resolution),
    )
    whole = join([small_bank, coarse])
    assert float(whole.map_resolution) == pytest.approx(2 * float(small_bank.map_resolution))
    n = small_bank.num_scenes
    np.testing.assert_array_equal(whole.map_kind[:n], whole.map_kind[n:])


@pytest.mark.parametrize("word", ["scenes", "sky images", "reaches", "multiples", "at least one"])
def test_what_does_not_fit_is_refused(small_bank: SceneBank, word: str) -> None:
    other = renamed(small_bank, "_b")
    banks = {
        "scenes": [small_bank, small_bank],
        "sky images": [small_bank, dataclasses.replace(other, sky_radiance=other.sky_radiance[:, ::2, ::2])],
        "reaches": [small_bank, dataclasses.replace(other, meta={**other.meta, "grid_reach": 9.0})],
        "multiples": [small_bank, dataclasses.replace(other, map_resolution=np.float32(0.13))],
        "at least one": [],
    }[word]
    with pytest.raises(ValidationError, match=word):
        join(banks)


def test_appearances_of_agents_survive_a_join(small_bank: SceneBank) -> None:
    """Those of the first bank that has any, with their meshes and categories, wherever these now stand."""
    looking = with_box_agents(renamed(small_bank, "_b"))
    joined = join([small_bank, looking])
    assert joined.agents["kind"] == list(BOXES)
    for i, kind in enumerate(BOXES):
        new, old = (mesh(b, b.agents["mesh"][i]) for b in (joined, looking))
        for x, y in zip(new, old, strict=True):
            np.testing.assert_array_equal(x, y)
        assert joined.meta["categories"][joined.agents["category"][i]] == f"agent:{kind}"
    assert join([small_bank]).agents["kind"] == []
    assert looking.num_meshes == small_bank.num_meshes + len(BOXES)
    assert_same_scene(small_bank, 1, looking, 1)


def test_the_geometry_of_a_scene_is_that_of_the_bank(small_bank: SceneBank) -> None:
    """Hulls where they were, the same ground and episodes; looks, and hulls of other scenes, are left out."""
    for scene in range(small_bank.num_scenes):
        alone = small_bank.geometry_of(scene)
        for found, whole in zip(alone.standing_hulls(0), small_bank.standing_hulls(scene), strict=True):
            np.testing.assert_array_equal(found, whole)
        prisms, own = small_bank.prism_hull[scene], alone.prism_hull[0]
        np.testing.assert_array_equal(own < 0, prisms < 0)
        for name in ("hull_vertices", "hull_planes", "hull_triangles", "hull_box", "hull_num_vertices"):
            table, whole = getattr(alone, name), getattr(small_bank, name)
            np.testing.assert_array_equal(table[own[own >= 0]], whole[prisms[prisms >= 0]])
        for name in ("inst_position", "prism_position", "map_kind", "map_origin", "hull_grid", "episode_waypoints"):
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(small_bank, name)[scene])
        used = np.concatenate([small_bank.inst_hull[scene], prisms])
        assert alone.num_hulls == len(set(used[used >= 0].tolist()))
        assert alone.scene_ids == small_bank.scene_ids[scene : scene + 1]
        assert (alone.num_meshes, alone.texture_data.size) == (0, 0)
