"""One graph -> one compiled scene: which layout is compiled."""

import dataclasses
import json
import pathlib
from typing import Any

import pytest

from tests.support.box_bank import street_regions
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, SceneLayout, Source, ValidationError
from urbanverse_mjx.materialisation import materialise_cousins
from urbanverse_mjx.pipeline import banks, scenes
from urbanverse_mjx.pipeline.library import building
from urbanverse_mjx.scene import compiler, library


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[SceneLayout]:
    """The layouts that would be compiled, without compiling them."""
    found: list[SceneLayout] = []

    def compile_scene(layout: SceneLayout, *_: Any, **__: Any) -> SceneLayout:
        found.append(layout)
        return layout

    monkeypatch.setattr(compiler, "compile_scene", compile_scene)
    monkeypatch.setattr(scenes, "make_controller", lambda: None)
    return found


@pytest.fixture
def graph() -> SceneGraph:
    """Four bollards and four people on the pavements of a street."""
    graph_objects = tuple(
        GraphObject(f"{label}_{x:.0f}", label, (x, 6.0, 0.15 + size[2] / 2), size, 0.0)
        for label, size, places in (
            ("bollard", (0.2, 0.2, 0.9), (10.0, 20.0, 40.0, 50.0)),
            ("pedestrian adult", (0.45, 0.55, 1.72), (12.0, 22.0, 42.0, 52.0)),
        )
        for x in places
    )
    return SceneGraph("street", Source("hand", "Apache-2.0", "none", "none"), graph_objects, tuple(street_regions()))


def test_the_same_graph_seed_and_cousin_give_the_same_street_by_every_route(
    tmp_path: pathlib.Path, compiled: list, graph: SceneGraph, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One graph compiled alone, packed into a bank, in a set of the library, and as `generate` makes it."""
    path = tmp_path / "mine" / "street" / "graph.json"
    graph.save(path)
    (tmp_path / "library.json").write_text(json.dumps({"mine": {"cousins": 5, "split": "train", "seed": 2}}))
    generated = [cousin.layout for cousin in materialise_cousins(graph, 6, seed=2)]
    for k in (0, 4, 5):
        pipeline.compile_graph(path, tmp_path / "out", seed=2, cousin=k)
    assert compiled == [generated[k] for k in (0, 4, 5)]
    banks._compile_job(path, 1, tmp_path / "out", 2)
    assert compiled[-1] == generated[1]
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(tmp_path))
    in_set = [cousin.layout for cousin in building.cousins_of(library.scene_set("mine"), "street")]
    assert [dataclasses.replace(a, id=b.id) for a, b in zip(in_set, generated, strict=False)] == generated[:5]
    assert len({o.asset_uid for o in generated[0].objects if o.label == "pedestrian adult"}) == 4


def test_closer_hulls_are_asked_for_by_the_layout(
    tmp_path: pathlib.Path, compiled: list, graph: SceneGraph, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "mine" / "street" / "graph.json"
    graph.save(path)
    for hulls in ("", "close"):
        pipeline.compile_graph(path, tmp_path / "out", hulls=hulls)
    first, close = compiled
    assert (first.hulls, close.hulls) == ("", "close")
    assert "hulls" not in first.to_json(), "older layouts keep their hashes"
    assert first.content_hash() != close.content_hash()
    with pytest.raises(ValidationError, match=r"--hulls: found 'far', needed"):
        pipeline.compile_graph(path, tmp_path / "out", hulls="far")
    monkeypatch.setenv("URBANVERSE_SCENE_ROOT", str(tmp_path))
    row = {"cousins": 1, "split": "train", "seed": 0}
    for asked in ({}, {"hulls": "close"}):
        (tmp_path / "library.json").write_text(json.dumps({"mine": row | asked}))
        (cousin,) = building.cousins_of(library.scene_set("mine"), "street")
        assert cousin.layout.hulls == asked.get("hulls", "")
    (tmp_path / "library.json").write_text(json.dumps({"mine": row | {"hulls": "far"}}))
    with pytest.raises(ValidationError, match="mine: hulls"):
        library.scene_set("mine")


def test_a_label_without_an_asset_is_refused_or_left_out_as_asked(
    tmp_path: pathlib.Path, compiled: list, graph: SceneGraph
) -> None:
    odd = dataclasses.replace(graph.objects[0], id="odd", label="zqxv", center=(30.0, 6.0, 0.6))
    dataclasses.replace(graph, objects=(*graph.objects, odd)).save(tmp_path / "graph.json")
    with pytest.raises(ValidationError, match=r"object 'odd'\.label: found 'zqxv'.*--skip-unknown"):
        pipeline.compile_graph(tmp_path / "graph.json", tmp_path / "out")
    assert not compiled
    cousin, _ = pipeline.compile_graph(tmp_path / "graph.json", tmp_path / "out", skip_unknown=True)
    assert [gone.id for gone in cousin.left_out] == ["odd"]
    assert len(compiled[0].objects) == len(graph.objects)


def test_half_of_a_street_is_compiled_where_it_is_asked_for(tmp_path: pathlib.Path, compiled: list) -> None:
    posts = tuple(
        GraphObject(f"post_{x}", "bollard", (x, 6.0, 0.6), (0.2, 0.2, 0.9), 0.0) for x in (10.0, 20.0, 40.0, 50.0)
    )
    graph = SceneGraph("street", Source("hand", "Apache-2.0", "none", "none"), posts, tuple(street_regions()))
    graph.save(tmp_path / "graph.json")
    for half in (0, 1, 2):
        pipeline.compile_graph(tmp_path / "graph.json", tmp_path / "out", half=half)
    whole, first, second = ({placed.id for placed in layout.objects} for layout in compiled)
    assert len(whole) == 4
    assert len(first) == len(second) == 2
    assert first | second == whole
    assert [layout.id[-8:] for layout in compiled[1:]] == ["_Half_01", "_Half_02"]
    with pytest.raises(ValidationError, match="--half"):
        pipeline.compile_graph(tmp_path / "graph.json", tmp_path / "out", half=3)
