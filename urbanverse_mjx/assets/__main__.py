"""`python -m urbanverse_mjx.assets build | hulls | gallery | export`: make, see and take out assets."""

import pathlib

import tyro
from rich.console import Console
from rich.progress import track


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


def export(out: pathlib.Path, leaf: str | None = None) -> None:
    """Writes assets as GLB files.

    Args:
      out: folder to write into.
      leaf: only this leaf.
    """
    from .export import export_glb
    from .index import load_index

    index = load_index()
    records = index.records if leaf is None else index.by_leaf(leaf)
    for record in track(records, "GLB files"):
        export_glb(record, out / (record.uid.replace("/", "--") + ".glb"))
    Console().print(f"{out}: {len(records)} GLB files")


#: Also behind `urbanverse assets`.
COMMANDS = {"build": build, "hulls": hulls, "gallery": gallery, "export": export}

if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(COMMANDS)
