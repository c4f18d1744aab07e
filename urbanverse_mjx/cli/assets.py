"""`urbanverse assets`: look into the asset index, and rebuild what it holds."""

import difflib
from collections.abc import Sequence
from typing import Annotated

import tyro


def list_assets(leaf: str | None = None) -> None:
    """List the assets, or those of one leaf category.

    Args:
      leaf: a leaf of the ontology, e.g. "bollard".
    """
    from ..assets import load_index

    index = load_index()
    _print_table(index.by_leaf(leaf) if leaf else index.records)


def find(label: Annotated[str, tyro.conf.Positional]) -> None:
    """Show which leaf a label of a scene graph is matched to, and the assets it may become.

    Args:
      label: what a detector or a person calls the thing, e.g. "trash can".
    """
    from ..assets import load_index, match_label

    index = load_index()
    leaf = match_label(label)
    records = index.by_label(label)
    print(f"{label!r} is the leaf {leaf!r}")
    if records and index.stand_in(leaf) != leaf:
        print(f"no asset of this leaf yet; {index.stand_in(leaf)!r} stands in for it")
    _print_table(records)
    if not records:
        near = difflib.get_close_matches(leaf, index.leaves, n=3, cutoff=0.0)
        print(f"no asset of this leaf yet; the nearest leaves with assets are {', '.join(near)}")


def _print_table(records: Sequence) -> None:
    print(f"{'uid':<44} {'along x across x up, m':<22} {'mass, kg':>9}  description")
    for r in records:
        size = " x ".join(f"{side:.2f}" for side in r.extent_xyz)
        print(f"{r.uid:<44} {size:<22} {r.mass:>9.1f}  {r.description}")


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse assets`."""
    from ..assets import __main__ as maintenance

    commands = {"list": list_assets, "find": find, **maintenance.COMMANDS}
    tyro.extras.subcommand_cli_from_dict(commands, args=list(argv), prog="urbanverse assets")
    return 0
