"""Where the index's data lie: `assets_index/` beside the package in a checkout, inside the package in a wheel."""

import functools
import pathlib

from urbanverse_mjx.datatypes import NounError


@functools.cache
def data_root() -> pathlib.Path:
    """The folder that holds `ontology.json`, `index.parquet` and `hulls/`.

    Raises:
      NounError: the installation carries no data.
    """
    package = pathlib.Path(__file__).resolve().parents[1]
    candidates = (package.parent / "assets_index", package / "_data" / "assets_index")
    for folder in candidates:
        if (folder / "ontology.json").is_file():
            return folder
    raise NounError(
        f"asset index: found no ontology.json in {' or '.join(map(str, candidates))}, needed the packaged data; "
        "install the package again, or run from a checkout."
    )
