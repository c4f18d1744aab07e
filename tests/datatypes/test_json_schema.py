"""The schemas against the datatypes: accepted and refused files, and the text of every field."""

import copy
import dataclasses
import json
from typing import Any, cast

import jsonschema
import pytest

from tests.datatypes.test_corruptions import CASES, DATATYPES
from urbanverse_mjx import settings
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datatypes import SceneLayout
from urbanverse_mjx.datatypes.json_schema import SCHEMAS
from urbanverse_mjx.datatypes.scene_graph import MAX_OBJECTS, MAX_REGIONS

#: Corruptions that no schema expresses: the datatype alone refuses them.
BEYOND = (
    *("crossing", "no-area", "corner-twice", "touching", "spike", "id-twice", "ud800", "10000000"),
    *("nan", "inf", "True"),
)
VALIDATORS = {name: jsonschema.Draft202012Validator(make()) for name, make in SCHEMAS.items()}


@pytest.mark.parametrize("name", list(SCHEMAS))
def test_it_is_a_schema_that_describes_every_field(name: str) -> None:
    schema = SCHEMAS[name]()
    jsonschema.Draft202012Validator.check_schema(schema)
    bare = []

    def walk(part: dict[str, Any], path: str) -> None:
        for field, inner in part.get("properties", {}).items():
            if field != "schema" and "description" not in inner and inner.get("type") != "object":
                bare.append(f"{path}.{field}")
            walk(inner, f"{path}.{field}")
            if isinstance(inner.get("items"), dict):
                walk(inner["items"], f"{path}.{field}[]")

    walk(schema, name)
    # The ground of a layout refers to that of a graph; the fields of a source are clear by their names.
    assert all(".source." in path or path.startswith(("layout.ground", "graph.sky")) for path in bare), bare


def test_shipped_graphs_are_valid() -> None:
    paths = sorted(settings.scene_root().glob("*/graph.json"))
    assert len(paths) >= 6
    for path in paths:
        VALIDATORS["graph"].validate(json.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("name", list(DATATYPES))
def test_what_a_datatype_writes_is_valid(name: str) -> None:
    datatype, body = DATATYPES[name]
    VALIDATORS[name].validate(body)
    VALIDATORS[name].validate(datatype.from_json(body).to_json())


@pytest.mark.parametrize("name", list(DATATYPES))
def test_what_the_datatype_refuses_the_schema_refuses_where_it_can(name: str) -> None:
    passed = []
    for case in CASES:
        whose, spoiled = case.values[0], cast("Any", case.values[2])
        if "10,000 entries" in str(case.id):
            continue  # minutes of walking, for one keyword
        if whose == name and VALIDATORS[name].is_valid(spoiled):
            passed.append(str(case.id))
    beyond = [label for label in passed if not any(word in label.replace(" ", "-") for word in BEYOND)]
    assert not beyond, beyond
    refused = sum(case.values[0] == name for case in CASES) - len(passed)
    assert refused > 5 * len(passed)
    lists = SCHEMAS[name]()["properties"]
    assert (lists["objects"]["maxItems"], lists["ground"]["maxItems"]) == (MAX_OBJECTS, MAX_REGIONS)


def test_bounds_are_those_of_the_datatypes() -> None:
    """At each bound that a schema names the datatype accepts, and a little beyond both refuse."""
    tried = 0
    for name, (datatype, body) in DATATYPES.items():
        for path, low, high in _bounds(SCHEMAS[name](), body):
            for bound, sign in ((low, -1.0), (high, 1.0)):
                if bound is None:
                    continue
                for value, fine in ((bound, True), (bound + sign * max(abs(bound), 1) * 1e-6, False)):
                    changed = _put(body, path, value)
                    assert VALIDATORS[name].is_valid(changed) is fine, (path, value)
                    if fine:
                        datatype.from_json(changed)
                    else:
                        with pytest.raises(ValueError, match="needed"):
                            datatype.from_json(changed)
                    tried += 1
    assert tried > 50


def _bounds(schema: dict[str, Any], value: Any, path: tuple[Any, ...] = ()):
    """Path, least and greatest number of each number of a body, where its schema has inclusive ones."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key in schema.get("properties", {}):
                yield from _bounds(schema["properties"][key], inner, (*path, key))
    elif isinstance(value, list):
        fixed = schema.get("prefixItems", [])
        for i, inner in enumerate(value[:1] if "polygon" in path or not fixed else value):
            yield from _bounds(fixed[i] if fixed else schema["items"], inner, (*path, i))
    elif schema.get("type") == "number" and not {"polygon"} & set(path):
        yield path, schema.get("minimum"), schema.get("maximum")


def _put(body: Any, path: tuple[Any, ...], value: float) -> Any:
    changed = copy.deepcopy(body)
    spot = changed
    for key in path[:-1]:
        spot = spot[key]
    spot[path[-1]] = value
    return changed


def test_the_command_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["schema", "layout"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == SCHEMAS["layout"]()
    fields = {"schema", *(field.name for field in dataclasses.fields(SceneLayout))}
    assert set(printed["required"]) == fields - {"place", "hulls"}
    assert set(printed["properties"]) == fields
