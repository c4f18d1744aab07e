"""The page of file formats: its street compiles, and its tables name the fields that there are."""

import pathlib
import re

import mujoco
import pytest

from urbanverse_mjx.datatypes import SceneGraph
from urbanverse_mjx.datatypes.json_schema import SCHEMAS

PAGE = (pathlib.Path(__file__).parents[2] / "docs" / "formats.md").read_text(encoding="utf-8")


def test_a_street_of_ten_lines_compiles(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = [part.split("```")[0] for part in PAGE.split("```python\n")[1:]]
    assert len([line for line in code.splitlines() if line and not line.startswith(("from", "import"))]) <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "docs/formats.md", "exec"), {})
    graph = SceneGraph.load(tmp_path / "my_street.json")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "my_street" / "scene.xml"))
    names = {model.body(i).name for i in range(model.nbody)} | {model.geom(i).name for i in range(model.ngeom)}
    for obj in graph.objects:
        assert any(obj.id in name for name in names), obj.id


@pytest.mark.parametrize(("heading", "name"), [("## Scene graph", "graph"), ("## Scene layout", "layout")])
def test_the_tables_name_every_field(heading: str, name: str) -> None:
    section = PAGE.split(heading)[1].split("\n## ")[0]
    said = set(re.findall(r"`([a-z_]+)(?:\[\])?`", section))
    schema = SCHEMAS[name]()
    fields = set(schema["properties"])
    for part in ("objects", "ground"):
        fields |= set(schema["properties"][part]["items"]["properties"])
    assert fields <= said
