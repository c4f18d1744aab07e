"""One graph -> one compiled scene: which layout is compiled."""

import pathlib
from typing import Any

import pytest

from tests.support.box_bank import street_regions
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import GraphObject, NounError, SceneGraph, SceneLayout, Source
from urbanverse_mjx.pipeline import scenes
from urbanverse_mjx.scene import compiler


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[SceneLayout]:
    """The layouts that would be compiled; nothing is."""
    found: list[SceneLayout] = []

    def compile_scene(layout: SceneLayout, *_: Any, **__: Any) -> SceneLayout:
        found.append(layout)
        return layout

    monkeypatch.setattr(compiler, "compile_scene", compile_scene)
    monkeypatch.setattr(scenes, "make_driver", lambda: None)
    return found


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
    with pytest.raises(NounError, match="--half"):
        pipeline.compile_graph(tmp_path / "graph.json", tmp_path / "out", half=3)
