"""`urbanverse assets import`."""

import pathlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import tyro
from rich.console import Console
from rich.markup import escape

from urbanverse_mjx.datatypes import ValidationError

if TYPE_CHECKING:
    from .run import Entry


def import_assets(
    folder: Annotated[pathlib.Path, tyro.conf.Positional],
    licence: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
    leaf: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
    jobs: int = 2,
    again: bool = False,
    pictures: bool = True,
    seconds: float = 300.0,
) -> None:
    """Imports GLB, glTF, OBJ, STL and PLY files below a folder, or one, into your own index beside the packaged one.

    Values missing in the annotation files next to them come from a vision endpoint, if URBANVERSE_VISION_URL and
    URBANVERSE_VISION_MODEL (and URBANVERSE_VISION_KEY) are set, else from the priors of the category in the file's
    name. An interrupted import continues when it is started again.

    Args:
      folder: of the files, or a file.
      licence: licence of the files that state none, e.g. CC-BY-4.0; without it they are refused.
      leaf: what all the files are, e.g. "traffic cone"; without it annotations or names say it.
      jobs: processes at once.
      again: also files that an earlier import has done.
      pictures: draw four views of each asset.
      seconds: longest time for one step of one file.
    """
    from urbanverse_mjx.settings import imported_assets, vision_endpoint

    from ..categories.ontology import match_label
    from .containment import Bounds
    from .run import REPORT, Entry, Options, import_folder, report

    console = Console(soft_wrap=True, highlight=False)

    def tell(done: int, of: int, entry: Entry) -> None:
        what = f"-> {entry.uid}" if entry.uid else f"refused, {entry.reason}: {entry.why}"
        fixed = "".join(f"; {name} fixed: {how}" for name, how, good in entry.findings if good)
        console.print(escape(f"[{done}/{of}] {entry.file.encode('ascii', 'backslashreplace').decode()} {what}{fixed}"))

    leaf = None if leaf is None else match_label(leaf)
    options = Options(licence, leaf, jobs, again, pictures, vision_endpoint(), Bounds(seconds))
    entries = import_folder(folder, options, tell)
    counts = report(entries)
    if not counts["imported"]:
        raise ValidationError(_none(folder, entries, imported_assets() / REPORT))
    console.print(f"{counts['imported']} imported, {counts['rejected']} refused: {imported_assets() / REPORT}")
    for reason, count in counts["rejected_for"].items():
        console.print(f"  {count:>5} {reason}")


def _none(folder: pathlib.Path, entries: "Sequence[Entry]", where: pathlib.Path) -> str:
    """The sentence for an import that took nothing."""
    if len(entries) == 1:
        return f"{folder}: refused, {entries[0].reason}: {entries[0].why.rstrip('.')}."
    return f"{folder}: found {len(entries)} files and none to import, needed at least one; {where} says why."
