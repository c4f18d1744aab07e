"""`python -m urbanverse_mjx.assets COMMAND`: make, see and take out assets; `--help` lists the commands."""

import pathlib

import tyro
from rich.console import Console
from rich.progress import track

from .export_command import export
from .importing.command import import_assets


def build() -> None:
    """Writes assets_index/index.parquet from the recipes."""
    from .index import build_index, save_index

    index = build_index()
    path = save_index(index)
    content = index.content_hash()[:16]
    Console().print(f"{path.name}: {len(index.records)} records of {len(index.leaves)} leaves, content {content}")


def hulls(jobs: int = 2, leaf: str | None = None, again: bool = False) -> None:
    """Makes the collision hulls of every record whose mesh has none yet, and drops hulls nobody needs.

    Args:
      jobs: processes at once.
      leaf: only this leaf.
      again: also where there are hulls already (after a change of the decomposition itself).
    """
    from .decompose import build_missing

    build_missing(jobs, leaf, again, Console().print)


def gallery(out: pathlib.Path = pathlib.Path("docs/contact_sheet.png"), columns: int = 8) -> None:
    """Draws the contact sheet of all leaves (needs an OpenGL that renders off screen: MUJOCO_GL=egl or osmesa).

    Args:
      out: PNG to write.
      columns: tiles in a row.
    """
    from .gallery import contact_sheet
    from .index import load_index

    index = load_index()
    path = contact_sheet(index, out, columns=columns)
    Console().print(f"{path}: {len(index.leaves)} leaves, {path.stat().st_size} bytes")


def catalogue(out: pathlib.Path | None = None) -> None:
    """Writes the table of all 102,444 records as Parquet, into the cache unless told otherwise.

    Args:
      out: file to write.
    """
    import pyarrow.parquet as pq

    from urbanverse_mjx.datatypes.validation import write_atomically
    from urbanverse_mjx.settings import cache_dir

    from .catalogue import build_catalogue, catalogue_hash
    from .index import load_index

    table = build_catalogue(load_index(), lambda leaves: iter(track(leaves, "records")))
    built = table.num_rows - table["recipe"].null_count
    path = write_atomically(out or cache_dir("assets", "catalogue.parquet"), lambda p: pq.write_table(table, p))
    Console().print(
        f"{path}: {table.num_rows} records, {built} with a mesh, content {catalogue_hash(table)[:16]}", soft_wrap=True
    )


def labels(folder: pathlib.Path | None = None) -> None:
    """Writes assets_index/labels.csv: every label of six public vocabularies with its leaf, or with none.

    Args:
      folder: where the vocabularies' lists lie; without it the labels of the stored table are mapped anew.
    """
    from urbanverse_mjx.settings import asset_root

    from .labels import map_labels, read_vocabularies, save_labels, stored_vocabularies

    rows = map_labels(stored_vocabularies() if folder is None else read_vocabularies(folder))
    path = save_labels(rows, asset_root() / "labels.csv")
    empty = sum(row.leaf is None for row in rows)
    Console().print(f"{path.name}: {len(rows)} labels, {empty} of them without a leaf")


#: Also behind `urbanverse assets`.
COMMANDS = {
    "build": build,
    "hulls": hulls,
    "gallery": gallery,
    "export": export,
    "import": import_assets,
    "catalogue": catalogue,
    "labels": labels,
}

if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(COMMANDS)
