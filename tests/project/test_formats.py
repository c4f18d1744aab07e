"""The page of file formats: its tables name the fields that there are."""

import pathlib
import re

import pytest

from urbanverse_mjx.datatypes.json_schema import SCHEMAS

PAGE = (pathlib.Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("heading", "name"), [("## Scene graph", "graph"), ("## Scene layout", "layout")])
def test_the_tables_name_every_field(heading: str, name: str) -> None:
    section = PAGE.split(heading)[1].split("\n## ")[0]
    said = set(re.findall(r"`([a-z_]+)(?:\[\])?`", section))
    schema = SCHEMAS[name]()
    fields = set(schema["properties"])
    for part in ("objects", "ground"):
        fields |= set(schema["properties"][part]["items"]["properties"])
    assert fields <= said
