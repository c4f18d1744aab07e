"""The installed files of `pip install`: the package with its data files, and the folders of data."""

import pathlib

from hatchling.builders.wheel import WheelBuilder

ROOT = pathlib.Path(__file__).parents[2]
PACKAGE = ROOT / "urbanverse_mjx"


def test_a_wheel_holds_every_file_of_the_package_and_its_data() -> None:
    """A pattern in .gitignore or pyproject.toml leaves files out of a wheel that a clone has."""
    packed = {file.distribution_path for file in WheelBuilder(str(ROOT)).recurse_included_files()}
    own = {
        path.relative_to(ROOT).as_posix()
        for path in PACKAGE.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert own - packed == set()
    assert "urbanverse_mjx/py.typed" in packed, "type checkers read no annotations of a package without it"
    assert {pathlib.PurePosixPath(path).suffix for path in own} >= {".py", ".toml", ".json", ".npz", ".xml"}
    for name in ("assets_index/index.parquet", "assets_index/hulls/hulls.npz", "benchmarks/protocols/shipped.json"):
        assert (ROOT / name).is_file()
        assert f"urbanverse_mjx/_data/{name}" in packed
