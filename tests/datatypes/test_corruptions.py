"""Every field of a graph and of a layout, spoiled in every way its type allows, is refused by name.

The cases are made by walking the file's JSON, so a field added to a datatype is covered or fails here.
"""

import copy
import dataclasses
import itertools
import json
import math
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.datatypes import SceneGraph, SceneLayout, ValidationError, ground

from . import strategies

GRAPH = {
    "schema": "urbanverse.scene_graph/1",
    "id": "corner_7",
    "source": {"video": "synthetic", "licence": "CC0-1.0", "city": "Bern", "country": "Switzerland"},
    "objects": [
        {"id": "bench_00", "label": "bench", "center": [1.0, 2.0, 0.5], "size": [0.6, 1.8, 0.9],
         "yaw": 0.3, "score": 0.9,
         "descriptor": [1, 2, 255]},
        {"id": "car_00", "label": "sedan", "center": [5.0, -2.0, 0.7], "size": [4.5, 1.8, 1.4], "yaw": -1.0},
    ],
    "ground": [
        {"id": "road", "kind": "road", "polygon": [[0, -5], [20, -5], [20, 0], [0, 0]], "plane": [0, 0, 0]},
        {"id": "walk", "kind": "sidewalk", "polygon": [[0, 0], [20, 0], [20, 4], [0, 4]], "plane": [0, 0.1, 0.15],
         "descriptor": [7]},
    ],
    "sky": {"descriptor": [3, 4]},
    "camera_path": [[0, 0, 1.6, 0.0], [5, 0, 1.6, 0.1]],
}  # fmt: skip
LAYOUT = {
    "schema": "urbanverse.scene_layout/1",
    "id": "corner_7_cousin2",
    "graph_id": "corner_7",
    "graph_hash": "ab" * 32,
    "seed": 3,
    "cousin": 2,
    "objects": [
        {"id": "bench_00", "label": "bench", "category": "bench", "asset_uid": "bench/slats/001",
         "position": [1.0, 2.0, 0.15],
         "yaw": 0.3, "scale": [1.0, 1.1, 0.9], "mass": 40.0, "friction": 0.6, "movable": False},
    ],
    "ground": [
        {"id": "walk", "kind": "sidewalk", "polygon": [[0, 0], [20, 0], [20, 4], [0, 4]], "plane": [0, 0, 0.15],
         "material": "slabs_grey"},
    ],
    "sky": "clear_noon",
    "sky_yaw": 0.5,
    "hashes": {"assets": "cd" * 32},
}  # fmt: skip
DATATYPES = {"graph": (SceneGraph, GRAPH), "layout": (SceneLayout, LAYOUT)}

OPTIONAL = {"score", "descriptor", "camera_path"}
#: Dictionaries whose keys are free.
FREE = {("hashes",)}
#: Lists that may be empty or shorter without harm.
SHRINKABLE = {"objects", "ground", "camera_path", "descriptor", "polygon"}

Path = tuple[str | int, ...]


def walk(value: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    yield path, value
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from walk(child, (*path, key))


def changed(body: Any, path: Path, new: Any) -> Any:
    body = copy.deepcopy(body)
    spot = body
    for key in path[:-1]:
        spot = spot[key]
    spot[path[-1]] = new
    return body


def without(body: Any, path: Path) -> Any:
    body = copy.deepcopy(body)
    spot = body
    for key in path[:-1]:
        spot = spot[key]
    del spot[path[-1]]
    return body


WRONG = {
    "text": (None, 5, 1.5, True, [], {}, ["a"], "", "line\nbreak", "\x00", "\ud800", "a\ufffe", "\uffff", "x" * 3000),
    "boolean": (None, 0, 1, "true", [], {}),
    "number": (None, True, "1.0", [], {}, [1.0], math.nan, math.inf, -math.inf, 10**400, 1e300, -1e300),
    "whole": (None, True, "1", [], 1.5, math.nan, -1),
    "list": (None, 0, "abc", {}, True),
    "dict": (None, 0, "abc", [], True),
}
WHOLE = {"seed", "cousin"}


def kind_of(path: Path, value: Any) -> str:
    if isinstance(value, bool):
        return "boolean"
    if isinstance(value, (int, float)):
        return "whole" if path[-1] in WHOLE or "descriptor" in path else "number"
    return {str: "text", list: "list", dict: "dict"}[type(value)]


def corruptions(body: Any) -> Iterator[tuple[str, Path, Any]]:
    """(description, place, the corrupted body)."""
    for path, value in walk(body):
        yield from corruptions_at(body, path, value)


def corruptions_at(body: Any, path: Path, value: Any) -> Iterator[tuple[str, Path, Any]]:
    """Those of the value at one path."""
    kind = kind_of(path, value) if path else "dict"
    if path:
        for wrong in WRONG[kind]:
            yield f"{wrong!r:.40}", path, changed(body, path, wrong)
    if path and isinstance(path[-1], str) and path[-1] not in OPTIONAL and path[:-1] not in FREE:
        yield "missing", path, without(body, path)
    if isinstance(value, dict) and path not in FREE:
        yield "unknown field", (*path, "colour"), changed(body, (*path, "colour"), "red")
    if isinstance(value, list) and path[-1] not in SHRINKABLE:
        yield "one fewer", path, without(body, (*path, 0))
        yield "one more", path, changed(body, path, [*value, value[-1]])


def special(name: str, body: Any) -> Iterator[tuple[str, Path, Any]]:
    """Corruptions that only the meaning of a field gives away."""
    for word in ("urbanverse.scene_graph/2", "urbanverse.scene_layout/0", "something"):
        yield "wrong schema", ("schema",), changed(body, ("schema",), word)
    for word in ("a b", "../up", "ä", "²", "a/b", "."):
        yield "odd scene id", ("id",), changed(body, ("id",), word)
    for word in ("grass", "none", "Road"):
        yield "unknown kind", ("ground", 0, "kind"), changed(body, ("ground", 0, "kind"), word)
    rings = {
        "crossing": [[0, 0], [2, 2], [2, 0], [0, 2]],
        "two corners": [[0, 0], [1, 0]],
        "no area": [[0, 0], [1, 0], [2, 0]],
        "corner twice": [[0, 0], [1, 0], [1, 0], [0, 1]],
        "touching": [[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]],
        "spike": [[0, 0], [4, 0], [2, 0], [2, 3]],
        "spike at the start": [[2, 0], [0, 0], [4, 0], [4, 3]],
        "no corners": [],
        "513 corners": [[math.cos(math.tau * i / 513), math.sin(math.tau * i / 513)] for i in range(513)],
    }
    for what, ring in rings.items():
        yield what, ("ground", 0, "polygon"), changed(body, ("ground", 0, "polygon"), ring)
    for plane in ([2.1, 0, 0], [0, -2.1, 0]):
        yield "too steep", ("ground", 0, "plane"), changed(body, ("ground", 0, "plane"), plane)
    yield "no ground", ("ground",), changed(body, ("ground",), [])
    for group in ("objects", "ground"):
        entry = body[group][0]
        yield "id twice", (group,), changed(body, (group,), [entry, copy.deepcopy(entry)])
        many = [{**entry, "id": f"n{i}"} for i in range(10_000)]
        yield "10,000 entries", (group,), changed(body, (group,), many)
    positive = ("size",) if name == "graph" else ("scale",)
    for field, axis, bad in itertools.product(positive, range(3), (0, 0.0, -1, -0.5)):
        yield "not positive", ("objects", 0, field, axis), changed(body, ("objects", 0, field, axis), bad)
    yield from (of_graph if name == "graph" else of_layout)(body)


def of_graph(body: Any) -> Iterator[tuple[str, Path, Any]]:
    """Descriptors, scores and sizes that are none."""
    for bad in (1e-300, 5e-324, 0.0, 9e-4):
        yield "size", ("objects", 0, "size", 1), changed(body, ("objects", 0, "size", 1), bad)
    for place in (("objects", 0), ("ground", 1), ("sky",)):
        for bad in ([], [0] * 65, [256], [-1], [1.5], [True]):
            yield "descriptor", (*place, "descriptor"), changed(body, (*place, "descriptor"), bad)
    for bad in (-0.1, 1.1):
        yield "score", ("objects", 0, "score"), changed(body, ("objects", 0, "score"), bad)


def of_layout(body: Any) -> Iterator[tuple[str, Path, Any]]:
    """Masses and frictions that are none."""
    for field, bad in (("mass", 0), ("mass", -1), ("friction", -0.1), ("friction", 6)):
        yield field, ("objects", 0, field), changed(body, ("objects", 0, field), bad)


def expected_words(body: Any, path: Path, spoiled: Any) -> list[str]:
    """Parts of the message: the entry (by its id, or by its place if the id itself is corrupted) and the field."""
    field = next((key for key in reversed(path) if isinstance(key, str)), "")
    if len(path) < 2 or path[0] not in ("objects", "ground") or not isinstance(path[1], int):
        return [field]
    entry = spoiled[path[0]][path[1]]
    if not isinstance(entry, dict):
        return [f"{path[0]}[{path[1]}]"]
    name = entry.get("id")
    usable = path[2:] != ("id",) and isinstance(name, str)
    return [repr(name) if usable else "", field if len(path) > 2 else ""]


CASES = [
    pytest.param(
        name,
        path,
        spoiled,
        id=f"{name}-{'.'.join(map(str, path)) or 'whole'}-{what}"[:90].encode("ascii", "replace").decode(),
    )
    for name, (_, body) in DATATYPES.items()
    for what, path, spoiled in itertools.chain(corruptions(body), special(name, body))
]


@pytest.mark.parametrize("name", list(DATATYPES))
def test_the_sound_bodies_are_accepted(name):
    datatype, body = DATATYPES[name]
    again = datatype.from_json(body).to_json()
    assert datatype.from_json(again).to_json() == again


@pytest.mark.parametrize(("name", "path", "spoiled"), CASES)
def test_every_corruption_is_refused_by_name(name, path, spoiled):
    datatype, body = DATATYPES[name]
    with pytest.raises(ValidationError) as caught:
        datatype.from_json(spoiled)
    message = str(caught.value)
    for word in expected_words(body, path, spoiled):
        assert word in message
    assert "found" in message
    assert "needed" in message
    assert len(message) < 700


@pytest.mark.parametrize("whole", [None, 5, "text", [], [GRAPH], True, math.nan])
@pytest.mark.parametrize("datatype", [SceneGraph, SceneLayout])
def test_a_body_that_is_no_object_is_refused(datatype, whole):
    with pytest.raises(ValidationError):
        datatype.from_json(whole)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_random_graph_with_one_random_corruption_is_refused(data):
    datatype, datatypes = data.draw(
        st.sampled_from([(SceneGraph, strategies.graphs), (SceneLayout, strategies.layouts)])
    )
    body = json.loads(json.dumps(data.draw(datatypes).to_json()))
    place = data.draw(st.sampled_from(list(walk(body))))
    _, _, spoiled = data.draw(st.sampled_from(list(corruptions_at(body, *place))))
    with pytest.raises(ValidationError):
        datatype.from_json(spoiled)


FIELDS = [
    (SceneGraph.from_json(GRAPH).objects[0], "graph object"),
    (SceneGraph.from_json(GRAPH).ground[0], "region"),
    (SceneGraph.from_json(GRAPH).source, "source"),
    (SceneGraph.from_json(GRAPH), "graph"),
    (SceneLayout.from_json(LAYOUT).objects[0], "placed object"),
    (SceneLayout.from_json(LAYOUT).ground[0], "placed ground"),
    (SceneLayout.from_json(LAYOUT), "layout"),
]


@pytest.mark.parametrize(
    ("datatype", "field"),
    [
        pytest.param(datatype, f.name, id=f"{what}-{f.name}")
        for datatype, what in FIELDS
        for f in dataclasses.fields(datatype)
    ],
)
def test_datatypes_made_in_code_are_checked_too(datatype, field):
    """`dataclasses.replace` goes through the constructor: no field of no datatype takes an object of another kind."""
    for wrong in (object(), b"bytes", {1, 2}, lambda: 1, 3 + 4j):
        with pytest.raises(ValidationError):
            dataclasses.replace(datatype, **{field: wrong})


@pytest.mark.parametrize("group", ["objects", "ground"])
def test_lists_of_datatypes_hold_datatypes_only(group):
    for datatype in (SceneGraph.from_json(GRAPH), SceneLayout.from_json(LAYOUT)):
        with pytest.raises(ValidationError, match=rf"{group}\[1\]"):
            dataclasses.replace(datatype, **{group: (getattr(datatype, group)[0], "stranger")})


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=8))
def test_a_ring_is_taken_exactly_when_shapely_calls_it_a_simple_polygon(corners):
    """Small whole coordinates make crossings, touches, spikes and repeats common; shapely gives the reference."""
    shapely = pytest.importorskip("shapely")
    ring = shapely.Polygon(corners)
    sound = ring.is_valid and ring.area > 1e-4 and all(a != b for a, b in itertools.pairwise([*corners, corners[0]]))
    try:
        ground.check_polygon(corners, "polygon")
        taken = True
    except ValidationError:
        taken = False
    assert taken == sound
