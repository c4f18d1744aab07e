"""`python -m urbanverse_mjx.assets build | hulls | gallery | export`: rebuild what `assets_index/` holds."""


import tyro
from rich.console import Console


def build() -> None:
    """Writes assets_index/index.parquet from the recipes."""
    from .index import build_index, save_index

    index = build_index()
    path = save_index(index)
    Console().print(f"{path.name}: {len(index.records)} records of {len(index.leaves)} leaves, content {index.content_hash()[:16]}")


def hulls(jobs: int = 2, leaf: str | None = None) -> None:
    """Runs CoACD for every record whose mesh has no hulls yet (one process each), and drops hulls nobody needs.

    Args:
      jobs: processes at once.
      leaf: only this leaf.
    """
    from .decompose import build_missing

    build_missing(jobs, leaf)


#: Also behind `urbanverse assets`.
COMMANDS = {"build": build, "hulls": hulls}

if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(COMMANDS)
