"""`urbanverse assets import`."""

import pathlib
from typing import Annotated

import tyro
from rich.console import Console
from rich.markup import escape


def import_assets(
    folder: Annotated[pathlib.Path, tyro.conf.Positional],
    licence: str | None = None,
    jobs: int = 2,
    again: bool = False,
    pictures: bool = True,
    seconds: float = 300.0,
) -> None:
    """Imports the GLB, glTF and OBJ files below a folder into your own index, beside the packaged one.

    Values missing in the annotation files next to them come from a vision endpoint, if URBANVERSE_VISION_URL and
    URBANVERSE_VISION_MODEL (and URBANVERSE_VISION_KEY) are set, else from the priors of the category in the file's
    name. An interrupted import continues when it is started again.

    Args:
      folder: of the files. licence: licence of the files that state none, e.g. CC-BY-4.0; without it they are refused.
      jobs: processes at once.
      again: also files that an earlier import has done.
      pictures: draw four views of each asset.
      seconds: longest time for one step of one file.
    """
    from urbanverse_mjx.settings import imported_assets, vision_endpoint

    from .containment import Bounds
    from .run import REPORT, Entry, Options, import_folder, report

    console = Console(soft_wrap=True, highlight=False)

    def tell(done: int, of: int, entry: Entry) -> None:
        what = f"-> {entry.uid}" if entry.uid else f"refused, {entry.reason}: {entry.why}"
        fixed = "".join(f"; {name} fixed: {how}" for name, how, good in entry.findings if good)
        console.print(escape(f"[{done}/{of}] {entry.file.encode('ascii', 'backslashreplace').decode()} {what}{fixed}"))

    options = Options(licence, jobs, again, pictures, vision_endpoint(), Bounds(seconds))
    counts = report(import_folder(folder, options, tell))
    console.print(f"{counts['imported']} imported, {counts['rejected']} refused: {imported_assets() / REPORT}")
    for reason, count in counts["rejected_for"].items():
        console.print(f"  {count:>5} {reason}")
