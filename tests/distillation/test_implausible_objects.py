"""An object that cannot be of a street is left out of a distilled graph, and named; the rest of the film stays."""

import dataclasses
import json
import pathlib

import pytest

from tests.support import drawn_street as street
from urbanverse_mjx.datatypes import SceneGraph, ValidationError
from urbanverse_mjx.pipeline.generation.checks import leave_out_implausible
from urbanverse_mjx.pipeline.generation.distilling import distil_to


def distilled(folder: pathlib.Path) -> SceneGraph:
    drawn = street.record(folder / "drawn", street.street_objects()[:4], street.walk(8, x0=10.0))
    (folder / "out").mkdir()
    return distil_to(drawn, folder / "out", lambda done, total: None)


def test_an_implausible_object_is_left_out_and_named(tmp_path: pathlib.Path) -> None:
    graph = distilled(tmp_path)
    before = (tmp_path / "out" / "evidence.json").read_bytes()
    assert leave_out_implausible(tmp_path / "out", graph) is graph
    assert (tmp_path / "out" / "evidence.json").read_bytes() == before
    first, *others = graph.objects
    wrong = dataclasses.replace(graph, objects=(dataclasses.replace(first, size=(2000.0, 800.0, 600.0)), *others))
    kept = leave_out_implausible(tmp_path / "out", wrong)
    assert kept.objects == tuple(others)
    assert SceneGraph.load(tmp_path / "out" / "graph.json").content_hash() == kept.content_hash()
    evidence = json.loads((tmp_path / "out" / "evidence.json").read_text())
    (said,) = evidence["implausible"]
    assert f"{first.id!r} ({first.label}): found a size of 2,000" in said
    assert [entry["id"] for entry in evidence["objects"]] == [obj.id for obj in others]


def test_a_film_of_implausible_objects_alone_is_refused(tmp_path: pathlib.Path) -> None:
    graph = distilled(tmp_path)
    wrong = tuple(dataclasses.replace(obj, size=(2000.0, 800.0, 600.0)) for obj in graph.objects)
    with pytest.raises(ValidationError, match="found a size of 2,000"):
        leave_out_implausible(tmp_path / "out", dataclasses.replace(graph, objects=wrong))
