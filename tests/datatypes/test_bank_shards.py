"""Banks as folders of shards: what is read is what was written, once each; damage is found when it is read."""

import dataclasses
import json
import pathlib
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.support.agent_appearances import with_box_agents
from tests.support.box_bank import box_bank
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import (
    BankShards,
    BankShardsWriter,
    SceneBank,
    ValidationError,
    array_file,
    bank_padding,
)
from urbanverse_mjx.datatypes.bank_join import join
from urbanverse_mjx.pipeline.banks import join_banks, join_shards


def renamed(bank: SceneBank, prefix: str) -> SceneBank:
    return dataclasses.replace(bank, meta={**bank.meta, "scene_ids": [prefix + name for name in bank.scene_ids]})


def written(bank: SceneBank, path: pathlib.Path) -> BankShards:
    bank.save(path)
    return BankShards(path)


def assert_same(found: SceneBank, wanted: SceneBank) -> None:
    """Every array to the bit, and all of the meta but the schema, which only banks of files name."""
    for name, array in wanted.arrays().items():
        other = found.arrays()[name]
        assert (other.dtype, other.shape) == (array.dtype, array.shape), name
        assert other.tobytes() == array.tobytes(), name
    metas = [{**bank.meta, "schema": "", "agents": bank.agents} for bank in (found, wanted)]
    assert metas[0] == metas[1]


def rendered_scene(bank: SceneBank, scene: int) -> list[tuple[object, ...]]:
    """What stands in a scene, without the numbers of tables: meshes with surfaces, hulls, light."""
    rows: list[tuple[object, ...]] = []
    for mesh, *pose in zip(
        bank.slot_mesh[scene],
        bank.slot_position[scene],
        bank.slot_quaternion[scene],
        bank.slot_mass[scene],
        strict=True,
    ):
        if mesh < 0:
            rows.append(("none",))
            continue
        corners = slice(*bank.mesh_vertex_start[mesh : mesh + 2])
        faces = slice(*bank.mesh_face_start[mesh : mesh + 2])
        material = bank.mesh_material[mesh]
        texture = int(bank.material_texture[material])
        parts = [
            bank.mesh_vertices[corners],
            bank.mesh_uv[corners],
            bank.mesh_faces[faces],
            bank.material_rgba[material],
        ]
        parts += [bank.material_roughness[material], bank.material_metallic[material], *pose]
        parts += [] if texture < 0 else [bank.texture(texture)]
        rows.append(tuple(np.asarray(part).tobytes() for part in parts))
    for name in ("inst_hull", "prism_hull"):
        for hull in getattr(bank, name)[scene]:
            names = ("hull_vertices", "hull_triangles", "hull_planes", "hull_box", "hull_num_triangles")
            rows.append(("none",) if hull < 0 else tuple(getattr(bank, n)[hull].tobytes() for n in names))
    names = ("hull_grid", "prism_grid", "map_kind", "episode_waypoints", "inst_rotation")
    rows.append(tuple(getattr(bank, name)[scene].tobytes() for name in names))
    sky = bank.scene_sky[scene]
    rows.append((bank.sky_radiance[sky].tobytes(), bank.sky_sun_direction[sky].tobytes(), bank.meta["skies"][sky]))
    rows.append(tuple(bank.meta["categories"][c] if c >= 0 else "" for c in bank.slot_category[scene]))
    return rows


def test_a_bank_comes_back_bit_for_bit(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    assert_same(SceneBank.load(written(small_bank, tmp_path / "a.bank").path), small_bank)


def test_scenes_that_are_taken_are_those_of_the_bank_in_the_shapes_of_all(
    small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    for rows in ([2], [2, 0], [1]):
        some = SceneBank.take(shards, rows)
        assert some.scene_ids == tuple(small_bank.scene_ids[row] for row in rows)
        for k, row in enumerate(rows):
            assert rendered_scene(some, k) == rendered_scene(small_bank, row)
            assert some.meta["object_ids"][k] == small_bank.meta["object_ids"][row]
        for name in ("inst_position", "hull_grid", "map_kind", "episode_start", "slot_mesh"):
            assert getattr(some, name).shape[1:] == getattr(small_bank, name).shape[1:]
    assert some.num_hulls < small_bank.num_hulls


def test_what_banks_share_is_stored_once(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    """Joined to one bank the same streets are there twice; in a folder they need only their index again."""
    again = renamed(small_bank, "again_")
    one, two = written(small_bank, tmp_path / "one.bank"), tmp_path / "two.bank"
    with BankShardsWriter(two) as writer:
        for bank in (small_bank, again):
            writer.add(bank.arrays(), bank.meta)
    both = BankShards(two)
    assert both.counts() == one.counts()
    assert both.num_bytes == one.num_bytes
    assert len(join([small_bank, again]).mesh_material) == 2 * small_bank.num_meshes
    loaded = SceneBank.load(two)
    assert loaded.scene_ids == (*small_bank.scene_ids, *again.scene_ids)
    for row in range(small_bank.num_scenes):
        assert rendered_scene(loaded, row + small_bank.num_scenes) == rendered_scene(small_bank, row)


def test_banks_of_other_sizes_are_padded_as_joined_ones(tmp_path: pathlib.Path) -> None:
    """`join` is the reference: the same scenes, arrays of scenes bit for bit the same."""
    first, second = box_bank(2, seed=0), renamed(box_bank(1, seed=5), "other_")
    whole = join([first, second])
    with BankShardsWriter(tmp_path / "a.bank") as writer:
        for bank in (first, second):
            writer.add(bank.arrays(), bank.meta)
    found = SceneBank.load(tmp_path / "a.bank")
    for name in ("inst_position", "inst_rotation", "hull_grid", "prism_grid", "map_kind", "map_origin", "num_episodes"):
        assert getattr(found, name).tobytes() == getattr(whole, name).tobytes(), name
    for name in ("episode_start", "episode_waypoints", "episode_length", "slot_position", "slot_quaternion"):
        assert getattr(found, name).tobytes() == getattr(whole, name).tobytes(), name
    for row in range(whole.num_scenes):
        assert rendered_scene(found, row) == rendered_scene(whole, row)


def test_a_folder_is_opened_by_its_index_alone(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    for file in shards.path.glob("shard-*"):
        file.unlink()
    opened = BankShards(shards.path)
    assert opened.scene_ids == small_bank.scene_ids
    with pytest.raises(ValidationError, match=r"shard-.*found a file that is missing"):
        SceneBank.take(opened, [0])


def test_every_damaged_byte_is_found_by_the_scenes_that_read_it(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    (file,) = shards.path.glob("shard-*")
    body, rng = file.read_bytes(), np.random.default_rng(0)
    said = []
    for place in rng.integers(0, len(body), 40):
        file.write_bytes(body[:place] + bytes([body[place] ^ 8]) + body[place + 1 :])
        try:
            bank = SceneBank.load(shards.path)
        except ValidationError as error:
            said.append(str(error))
        else:  # between two pieces
            assert_same(bank, small_bank)
    assert len(said) >= 35
    assert all(re.fullmatch(r".*shard-.*found damaged bytes.*copy the folder again.*", text) for text in said)


def test_damage_in_one_scene_leaves_the_others(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    (file,) = shards.path.glob("shard-*")
    body, own = bytearray(file.read_bytes()), small_bank.episode_waypoints[2, :4].tobytes()
    assert body.count(own) == 1
    body[body.index(own)] ^= 1
    file.write_bytes(body)
    opened = BankShards(shards.path)
    assert SceneBank.take(opened, [0, 1]).num_scenes == 2
    with pytest.raises(ValidationError, match=rf"scene '{small_bank.scene_ids[2]}': found damaged bytes"):
        SceneBank.take(opened, [2])


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_files_that_are_cut_off_are_refused(small_bank: SceneBank, tmp_path: pathlib.Path, share: float) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    (file,) = shards.path.glob("shard-*")
    body, index = file.read_bytes(), shards.path / "index.npz"
    file.write_bytes(body[: int(share * len(body))])
    with pytest.raises(ValidationError, match=r"shard-"):
        SceneBank.load(shards.path)
    file.write_bytes(body)
    whole = index.read_bytes()
    index.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValidationError, match=r"index\.npz: found an unreadable or damaged file"):
        SceneBank.load(shards.path)


def test_a_wrong_index_with_right_checksums_is_refused(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    wrong = {**small_bank.arrays(), "hull_grid": np.full_like(small_bank.hull_grid, 10**6)}
    with BankShardsWriter(tmp_path / "a.bank") as writer:
        writer.add(wrong, small_bank.meta)
    with pytest.raises(ValidationError, match=r"bank\.hull_grid: "):
        SceneBank.load(tmp_path / "a.bank")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("scene_pieces", 10**6),
        ("hull_piece", -1),
        ("mesh_pieces", 10**6),
        ("mesh_material", 10**6),
        ("material_texture", -2),
        ("texture_piece", 10**6),
        ("sky_piece", -5),
        ("scene_sky", 10**6),
        ("mesh_counts", 10**6),
        ("scene_shapes", 10**6),
        ("texture_shape", -1),
    ],
)
def test_an_index_with_rows_outside_its_tables_is_refused(
    small_bank: SceneBank, tmp_path: pathlib.Path, name: str, value: int
) -> None:
    """Also where its checksum is right."""
    index = written(small_bank, tmp_path / "a.bank").path / "index.npz"
    tables = array_file.load(index, "", "")
    tables[name].reshape(-1)[0] = value
    array_file.save(index, tables)
    with pytest.raises(ValidationError, match=r"a\.bank.*found"):
        SceneBank.load(index.parent)


def test_an_index_without_a_field_is_refused(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    index = written(small_bank, tmp_path / "a.bank").path / "index.npz"
    tables = array_file.load(index, "", "")
    meta = json.loads(tables["meta"].tobytes())
    for field in ("files", "shapes", "agents", "scene_ids"):
        less = json.dumps({key: value for key, value in meta.items() if key != field})
        array_file.save(index, {**tables, "meta": np.frombuffer(less.encode(), np.uint8)})
        with pytest.raises(ValidationError, match=rf"index\.npz: meta\.{field}: found nothing"):
            SceneBank.load(index.parent)
    array_file.save(index, {**tables, "num_episodes": tables["num_episodes"][:1]})
    with pytest.raises(ValidationError, match="num_episodes: found 1 rows"):
        BankShards(index.parent)


def test_a_folder_without_an_index_is_no_bank(tmp_path: pathlib.Path, small_bank: SceneBank) -> None:
    (tmp_path / "a.bank").mkdir()
    with pytest.raises(ValidationError, match=r"a\.bank: found no index\.npz in it"):
        SceneBank.load(tmp_path / "a.bank")
    with pytest.raises(ValidationError, match="no scene"), BankShardsWriter(tmp_path / "a.bank"):
        pass
    (tmp_path / "mine.bank").mkdir()
    (tmp_path / "mine.bank" / "photo.jpg").write_bytes(b"x")
    with pytest.raises(ValidationError, match="something that is not a scene bank"):
        small_bank.save(tmp_path / "mine.bank")
    assert (tmp_path / "mine.bank" / "photo.jpg").read_bytes() == b"x"


def test_rows_that_do_not_exist_are_refused(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    for rows in ([], [3], [-1], [0, 0]):
        with pytest.raises(ValidationError, match="different rows from 0 to 2"):
            shards.take(rows)
    with pytest.raises(ValidationError, match="no scene 'nowhere'"):
        shards.rows_of(["nowhere"])
    np.testing.assert_array_equal(shards.rows_of(small_bank.scene_ids[::-1]), [2, 1, 0])


def test_an_older_bank_stays_until_the_new_one_is_whole(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    shards = written(small_bank, tmp_path / "a.bank")
    before = sorted(file.name for file in shards.path.iterdir())
    other = box_bank(1, seed=7)

    def interrupted() -> None:
        with BankShardsWriter(shards.path) as writer:
            writer.add(other.arrays(), other.meta)
            assert_same(SceneBank.load(shards.path), small_bank)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert sorted(file.name for file in shards.path.iterdir()) == before
    assert_same(SceneBank.load(shards.path), small_bank)
    (shards.path / "shard-0badc0de-0000.bin").write_bytes(b"of a writer that was killed")
    other.save(shards.path)
    assert len(list(shards.path.iterdir())) == 2
    assert_same(SceneBank.load(shards.path), other)


def test_pieces_are_spread_over_files(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("urbanverse_mjx.datatypes.bank_shards_writer.SHARD_BYTES", 4096)
    shards = written(small_bank, tmp_path / "a.bank")
    assert len(list(shards.path.glob("shard-*"))) > 5
    assert_same(SceneBank.load(shards.path), small_bank)


def test_banks_that_do_not_fit_together_are_refused(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    other = renamed(small_bank, "other_")
    wrong = dataclasses.replace(other, map_resolution=np.array(0.5, np.float32))
    with BankShardsWriter(tmp_path / "a.bank") as writer:
        writer.add(small_bank.arrays(), small_bank.meta)
        with pytest.raises(ValidationError, match="map cells"):
            writer.add(wrong.arrays(), wrong.meta)
        with pytest.raises(ValidationError, match="twice"):
            writer.add(small_bank.arrays(), small_bank.meta)
    assert_same(SceneBank.load(tmp_path / "a.bank"), small_bank)


@pytest.mark.extended
def test_joined_to_a_folder_banks_are_as_joined_to_a_file(
    small_bank: SceneBank, tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where one of them is a folder, and with a coarser map."""
    first = with_box_agents(small_bank)
    other = renamed(box_bank(2, seed=5), "other_")
    other = dataclasses.replace(other, map_resolution=np.array(2.0 * small_bank.map_resolution, np.float32))
    first.save(tmp_path / "first.bank")
    other.save(tmp_path / "other.npz")
    paths, out = [str(tmp_path / "first.bank"), str(tmp_path / "other.npz")], tmp_path / "out.bank"
    split = "held_out=other_*"
    assert main(["scene", "join", *paths, "--out", str(out), "--split", split]) == 0
    said = json.loads(capsys.readouterr().out)
    wanted, found = join_banks(paths, [split]), SceneBank.load(out)
    assert said == {
        "bank": str(out),
        "scenes": list(wanted.scene_ids),
        "hulls": int((wanted.inst_hull >= 0).sum()),
        "prisms": int((wanted.prism_hull >= 0).sum()),
    }
    assert found.meta["splits"] == wanted.meta["splits"]
    assert float(found.map_resolution) == float(wanted.map_resolution)
    for row in range(wanted.num_scenes):
        assert rendered_scene(found, row) == rendered_scene(wanted, row)
    for bank in (found, wanted):
        names = [bank.meta["categories"][row] for row in bank.agents["category"]]
        assert names == ["agent:pedestrian", "agent:car"]
    with pytest.raises(ValidationError, match="one of the banks that are joined"):
        join_shards(paths, paths[0])


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_padding_that_was_cut_off_is_filled_up_again(data: st.DataObject) -> None:
    """To the bit, whatever the numbers; NaN and -0.0 are numbers like others."""
    name = data.draw(st.sampled_from(["inst_hull", "inst_position", "inst_friction", "map_kind", "episode_length"]))
    dtype = {"inst_hull": np.int32, "map_kind": np.uint8}.get(name, np.float32)
    shape = {"inst_position": (5, 3), "map_kind": (4, 5)}.get(name, (6,))
    values = [-1, 0, 3] if dtype == np.int32 else [0, 1] if dtype == np.uint8 else [0.0, -0.0, 1.0, float("nan")]
    whole = data.draw(hnp.arrays(dtype, shape, elements=st.sampled_from(values)))
    part = bank_padding.trimmed(name, whole)
    again = np.empty_like(whole)
    bank_padding.fill_up(again, name, part)
    assert again.tobytes() == whole.tobytes()
