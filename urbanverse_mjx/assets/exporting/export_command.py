"""`urbanverse assets export`."""

import pathlib
from typing import Annotated, Literal

import tyro
from rich.console import Console
from rich.progress import track


def export(
    out: pathlib.Path,
    form: Literal["glb", "obj", "mjcf", "usd"] = "glb",
    leaf: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
    uid: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
) -> None:
    """Writes assets as GLB, OBJ, MJCF or USD, each with its annotation as JSON; imported assets too.

    Args:
      out: folder to write into.
      form: file format.
      leaf: only this leaf.
      uid: only this asset; any that `urbanverse assets search` prints.
    """
    from ..records.index import full_index
    from ..records.store import as_catalogued
    from .export import export_asset, record_to_export

    if uid is not None:
        records = (record_to_export(uid),)
    else:
        index = full_index()
        records = as_catalogued(index.records if leaf is None else index.by_leaf(leaf))
    for record in track(records, f"{form} files"):
        export_asset(record, out, form)
    Console().print(f"{out}: {len(records)} assets as {form}", soft_wrap=True)
