"""The sets of the scene library: their table, ids, hashes, and the error for a missing bank."""

import dataclasses
import gzip
import json
import pathlib
from typing import Any

import numpy as np
import pytest
import shapely

from tests.support.toy_assets import FEW, few_episodes
from urbanverse_mjx import settings
from urbanverse_mjx.assets.collision import hulls
from urbanverse_mjx.datatypes import (
    BankShards,
    GraphObject,
    GroundRegion,
    SceneBank,
    SceneGraph,
    Source,
    ValidationError,
)
from urbanverse_mjx.datatypes.ground import PAINT_KINDS
from urbanverse_mjx.datatypes.validation import write_json
from urbanverse_mjx.pipeline.banks import join_banks
from urbanverse_mjx.pipeline.benchmarking import benchmark_bank
from urbanverse_mjx.pipeline.library import building
from urbanverse_mjx.pipeline.library.building import cousins_of, graph_of, layouts_of, pack_set
from urbanverse_mjx.scene import library
from urbanverse_mjx.scene.stability_trial import hanging

from .test_stability import CUBE, scene_of


def test_sets_and_ids() -> None:
    sets = library.sets()
    assert {"urbanverse160", "autobench", "craftbench", "validation", "procedural", "places"} <= set(sets)
    assert sum(sets[n].cousins * len(layouts_of(sets[n])) for n in ("urbanverse160", "autobench", "procedural")) == 330
    assert sets["urbanverse160"].scene_id("Africa_Egypt_Cairo_walk_01", 4) == "Africa_Egypt_Cairo_walk_01_Cousin_05"
    assert sets["procedural"].scene_id("procedural_007", 0) == "procedural_007"
    assert graph_of(sets["procedural"], "procedural_007").id == "procedural_007"
    assert len(layouts_of(sets["craftbench"])) == 12
    with pytest.raises(ValidationError, match="layout of procedural"):
        graph_of(sets["procedural"], "procedural_160")


def test_validation_is_held_out_of_the_training_sets() -> None:
    known = library.sets()
    splits = {name: [known[name].split_of(scene) for scene in scenes] for name, scenes in _scenes().items()}
    assert {name: (row.count("train"), row.count("validation"), row.count("test")) for name, row in splits.items()} == {
        "urbanverse160": (140, 20, 0),
        "procedural": (144, 16, 0),
        "validation": (0, 8, 0),
        "validation_v2": (0, 8, 0),
        "craftbench": (0, 0, 12),
        "craftbench_v2": (0, 0, 12),
        "autobench_v2": (0, 0, 10),
    }
    layouts = known["urbanverse160"].validation
    assert set(layouts) <= set(layouts_of(known["urbanverse160"]))
    assert len({layout.split("_")[0] for layout in layouts}) == 4  # continents
    assert list(known["procedural"].validation) == layouts_of(known["procedural"])[-16:]
    # All cousins of a layout, or none.
    held_out = library.held_out(_scenes()["urbanverse160"])
    assert {scene.rsplit("_Cousin_", 1)[0] for scene in held_out} == set(layouts)


def _scenes() -> dict[str, list[str]]:
    """Scene ids of each set."""
    found = {}
    for name in (
        "urbanverse160",
        "procedural",
        "validation",
        "validation_v2",
        "craftbench",
        "craftbench_v2",
        "autobench_v2",
    ):
        scenes = library.scene_set(name)
        found[name] = [scenes.scene_id(layout, k) for layout in layouts_of(scenes) for k in range(scenes.cousins)]
    return found


def test_joined_banks_hold_validation_out_even_where_they_were_packed_before(
    small_bank: SceneBank, tmp_path: pathlib.Path
) -> None:
    count = small_bank.num_scenes
    ids = ["Europe_Italy_Naples_walk_01_Cousin_05", *(f"procedural_{k:03d}" for k in range(count - 1))]
    meta = {**small_bank.meta, "scene_ids": ids, "splits": ["train"] * count}
    dataclasses.replace(small_bank, meta=meta).save(tmp_path / "bank.npz")
    assert join_banks([tmp_path / "bank.npz"]).meta["splits"] == ["validation", *["train"] * (count - 1)]
    # The paper's comparison trains on all of them: a caller's choice has priority.
    assert join_banks([tmp_path / "bank.npz"], ["train=*"]).meta["splits"] == ["train"] * count


def test_scenes_are_as_many_as_the_documentation_says() -> None:
    count = sum(scenes.cousins * len(layouts_of(scenes)) for scenes in library.sets().values())
    root = pathlib.Path(__file__).parents[2]
    assert f"build the scene library into the cache: {count} scenes" in (root / "Makefile").read_text()
    assert f"`make scenes` all {count} " in (root / "docs" / "included.md").read_text()


def test_a_missing_bank_names_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    with pytest.raises(ValidationError, match="run `urbanverse scene library autobench`"):
        library.bank_path("autobench")
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValidationError, match="set of scenes"):
        library.bank_path("nonsense")


def test_a_damaged_table_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(tmp_path))
    (tmp_path / "library.json").write_text('{"a": {"cousins": 0, "split": "train", "seed": 0}}')
    with pytest.raises(ValidationError, match="a: cousins"):
        library.sets()
    (tmp_path / "library.json").write_text('{"a": {"cousins": 1, "split": "train", "seed": 0, "builder": "magic"}}')
    with pytest.raises(ValidationError, match="a: builder"):
        library.sets()
    row = '{"a": {"cousins": 1, "split": "train", "seed": 0, "validation": ["x", "x"]}}'
    (tmp_path / "library.json").write_text(row)
    with pytest.raises(ValidationError, match="a: validation"):
        library.sets()
    (tmp_path / "library.json").write_text(row.replace('["x", "x"]', "16"))
    with pytest.raises(ValidationError, match="a: validation"):
        library.sets()


def test_packed_graphs_have_the_same_bytes_and_broken_ones_are_refused(tmp_path: pathlib.Path) -> None:
    autobench = library.scene_set("autobench")
    graph = graph_of(autobench, layouts_of(autobench)[0])
    a, b = tmp_path / "a.json.gz", tmp_path / "b.json.gz"
    graph.save(a)
    graph.save(b)
    assert a.read_bytes() == b.read_bytes()
    assert SceneGraph.load(a) == graph
    b.write_bytes(a.read_bytes()[:500])
    with pytest.raises(ValidationError, match="not JSON"):
        SceneGraph.load(b)
    b.write_bytes(b"{}")
    with pytest.raises(ValidationError, match="not JSON"):
        SceneGraph.load(b)
    assert json.loads(gzip.decompress(a.read_bytes()))["id"] == graph.id


def test_a_layout_has_the_committed_hash() -> None:
    """Materialised anew, without compiling."""
    autobench = library.scene_set("autobench")
    layout = "NorthAmerica_Cuba_Havana_walk_01"
    cousin = next(iter(cousins_of(autobench, layout)))
    known = library.shipped_hashes("autobench")[cousin.layout.id]
    assert cousin.layout.content_hash() == known["layout"]
    assert len(cousin.layout.objects) > 0.9 * len(graph_of(autobench, layout).objects)


def test_committed_hashes_belong_to_the_committed_graphs() -> None:
    for name in ("urbanverse160", "autobench", "autobench_v2"):
        scenes, known = library.scene_set(name), library.shipped_hashes(name)
        graphs = {layout: graph_of(scenes, layout) for layout in layouts_of(scenes)}
        assert {layout: graph.id for layout, graph in graphs.items()} == {layout: layout for layout in graphs}
        hashes = {layout: graph.content_hash() for layout, graph in graphs.items()}
        assert {scene: row["graph"] for scene, row in known.items()} == {
            scenes.scene_id(layout, k): content for layout, content in hashes.items() for k in range(scenes.cousins)
        }
        assert all(set(row) == {"graph", "layout", "scene"} for row in known.values())
        # No two cousins are alike.
        assert len({row["layout"] for row in known.values()}) == len(known)


@pytest.mark.parametrize("name", ["urbanverse160", "autobench_v2"])
def test_ground_of_captures_has_straight_borders_and_no_holes(name: str) -> None:
    """Outlines that follow cells have more than 1,300 corners a street."""
    scenes = library.scene_set(name)
    for layout in layouts_of(scenes):
        regions = [r for r in graph_of(scenes, layout).ground if r.kind not in PAINT_KINDS]
        assert sum(len(r.polygon) for r in regions) < 600, layout
        # Touching regions share corners in whole millimetres; what they leave open is a hole.
        whole = shapely.union_all([shapely.Polygon(r.polygon) for r in regions]).buffer(0.03).buffer(-0.03)
        assert isinstance(whole, shapely.Polygon), layout
        assert sum(shapely.Polygon(ring).area for ring in whole.interiors) < 1.0, layout


def test_a_record_of_another_format_counts_as_not_built(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    layout = layouts_of(library.scene_set("autobench"))[0]
    scene = library.scene_set("autobench").scene_id(layout, 0)
    folder, path = building._paths("autobench", scene)
    built = []

    def compiled(name: str, cousin: str, graph: SceneGraph, key: str) -> dict[str, Any]:
        built.append(scene)
        write_json(folder / "metadata.json", {})
        record = dict.fromkeys(building.RECORD_FIELDS, 0) | {"key": key, "id": scene}
        write_json(path, record)
        return record

    monkeypatch.setattr(building, "cousins_of", lambda scenes, layout: iter(["its cousin"]))
    monkeypatch.setattr(building, "_compile", compiled)
    (record,) = building.build_layout("autobench", layout)
    assert building.build_layout("autobench", layout) == [record]
    assert len(built) == 1
    older = {name: value for name, value in record.items() if name != "let_go"}
    for number, other in enumerate((older, older | {"fallen": 3}, [record]), 2):
        write_json(path, other)
        assert building.build_layout("autobench", layout) == [record]
        assert len(built) == number


@pytest.mark.extended
def test_a_set_with_the_regional_look_is_built(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    """What is drawn on the road is counted in the record, which is found again."""
    kinds = {"walk": ("sidewalk", -2.0, 2.0, 0.15), "road": ("road", 2.0, 10.0, 0.0)}
    ground = tuple(
        GroundRegion(name, kind, ((0.0, low), (40.0, low), (40.0, high), (0.0, high)), (0.0, 0.0, z))
        for name, (kind, low, high, z) in kinds.items()
    )
    bench = GraphObject("bench_0", "bench", (20.0, -1.0, 0.6), (0.6, 1.6, 0.9), 0.0)
    graph = SceneGraph("corner", Source("hand", "CC0-1.0", "Tokyo", "Japan"), (bench,), ground)
    graph.save(tmp_path / "scenes" / "mine" / "corner" / "graph.json")
    rows = {"mine": {"cousins": 1, "split": "train", "seed": 0, "regional": True}}
    write_json(tmp_path / "scenes" / library.TABLE, rows)
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(tmp_path / "scenes"))
    monkeypatch.setattr(library, "folder", lambda name: tmp_path / "built" / name)
    monkeypatch.setattr(building, "ROWS", FEW)
    with few_episodes():
        (record,) = building.build_layout("mine", "corner")
    assert record["drawn"] > 0
    compiled = []
    monkeypatch.setattr(building, "_compile", lambda *given: compiled.append(given))
    assert building.build_layout("mine", "corner") == [record]
    assert not compiled
    rows["mine"]["hulls"] = "close"
    write_json(tmp_path / "scenes" / library.TABLE, rows)
    building.build_layout("mine", "corner")
    assert len(compiled) == 1
    monkeypatch.setattr(hulls, "close_hash", lambda kind: "another store")
    building.build_layout("mine", "corner")
    assert compiled[0][-1] != compiled[1][-1], "a changed store of hulls builds the scene again"
    rows["mine"]["standing"] = True
    write_json(tmp_path / "scenes" / library.TABLE, rows)
    building.build_layout("mine", "corner")
    assert compiled[1][-1] != compiled[2][-1]


def test_only_the_second_versions_ask_for_objects_that_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    """The others are frozen, and policies were chosen on them."""
    known = library.sets()
    assert {name for name, scenes in known.items() if scenes.standing} == {
        "autobench_v2",
        "craftbench_v2",
        "validation_v2",
    }
    asked = []
    monkeypatch.setattr(
        "urbanverse_mjx.materialisation.materialise_cousins", lambda *_, **more: asked.append(more["standing"]) or []
    )
    for name in ("craftbench", "craftbench_v2"):
        assert list(cousins_of(known[name], layouts_of(known[name])[0])) == []
    assert asked == [False, True]


def test_most_hulls_in_reach_is_what_the_shipped_streets_allow(bank: SceneBank) -> None:
    """As many as engines have slots for without adding any: their results stay what they were."""
    most = [library.most_in_reach(bank, z) for z in range(bank.num_scenes)]
    assert 8 < max(n["hulls"] for n in most) <= 16
    assert 3 < max(n["prisms"] for n in most) <= 8


def test_what_hangs_is_told_from_what_stands() -> None:
    scene = scene_of(CUBE)
    up = dataclasses.replace(scene, object_position=scene.object_position + np.array([0.0, 0.0, 2.0]))
    assert not hanging(scene).any()
    assert hanging(up).all()


def test_the_cache_key_of_the_streets_ignores_the_library(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    monkeypatch.delenv("URBANVERSE_BANK", raising=False)
    root = tmp_path / "scenes"
    (root / "one").mkdir(parents=True)
    (root / "one" / "graph.json").write_text("{}")
    (root / "splits.json").write_text("{}")
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(root))
    before = settings.default_bank_path()
    (root / "set" / "layout").mkdir(parents=True)
    (root / "set" / "layout" / "graph.json").write_text("{}")
    (root / "set" / "hashes.json").write_text("{}")
    assert settings.default_bank_path() == before
    (root / "one" / "graph.json").write_text("[]")
    assert settings.default_bank_path() != before


def test_a_set_is_packed_to_a_file_or_a_folder_which_replaces_it(
    small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    """One bank at a time is where all look for it; a folder is packed part by part."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    packed = []

    def pack_bank(folders: list[pathlib.Path], splits: list[str]) -> SceneBank:
        packed.append([path.name for path in folders])
        rows = [small_bank.scene_ids.index(path.name) for path in folders]
        bank = SceneBank.take(BankShards(tmp_path / "small.bank"), rows)
        return dataclasses.replace(bank, meta={**bank.meta, "splits": splits})

    small_bank.save(tmp_path / "small.bank")
    monkeypatch.setattr("urbanverse_mjx.scene.pack_bank", pack_bank)
    monkeypatch.setattr("urbanverse_mjx.pipeline.banks._SCENES_TOGETHER", 2)
    records = {name: {} for name in small_bank.scene_ids}
    most = pack_set("craftbench", records)
    assert library.bank_path("craftbench").name == "bank.npz"
    assert pack_set("craftbench", records, shards=True) == most
    assert packed == [list(small_bank.scene_ids), list(small_bank.scene_ids[:2]), [small_bank.scene_ids[2]]]
    path = library.bank_path("craftbench")
    assert path.name == "bank.bank"
    for bank in (SceneBank.load(path), benchmark_bank("craftbench")):
        assert bank.scene_ids == small_bank.scene_ids
        assert bank.meta["splits"] == ["test"] * 3
    pack_set("craftbench", records)
    assert library.bank_path("craftbench").name == "bank.npz"
    assert not path.exists()
