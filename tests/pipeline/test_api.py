"""Public names of `urbanverse_mjx.pipeline`: each exists, is documented, and is imported on first use only."""

import ast
import inspect
import pathlib
import subprocess
import sys

import pytest

from urbanverse_mjx import pipeline


def test_importing_the_pipeline_loads_nothing_heavy() -> None:
    code = "import sys; from urbanverse_mjx import pipeline; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "jax", "warp", "brax", "mujoco"} & set(done.stdout.split())


@pytest.mark.parametrize("name", pipeline.__all__)
def test_every_name_is_documented(name: str) -> None:
    found = getattr(pipeline, name)
    assert found.__name__ == name
    assert inspect.getdoc(found)
    assert name in dir(pipeline)


def test_names_stand_alike_for_people_types_and_imports() -> None:
    """The table of lazy names, the imports that type checkers read, and `__all__`."""
    tree = ast.parse(pathlib.Path(pipeline.__file__).read_text(encoding="utf-8"))
    seen = {
        alias.name: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level == 1
        for alias in node.names
    }
    assert seen == pipeline._HOMES
    assert pipeline.__all__ == sorted(pipeline._HOMES)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = pipeline.nonsense  # pyright: ignore[reportAttributeAccessIssue]
