"""`urbanverse scene gallery`: a page of compiled scenes with pictures and numbers."""

import dataclasses
import json
import pathlib
from typing import TYPE_CHECKING, Annotated

import tyro

from .. import settings

if TYPE_CHECKING:
    from ..viz.scene_gallery import Card


@dataclasses.dataclass(frozen=True)
class GalleryArgs:
    """Draw compiled scenes from above and at eye level into a page with their numbers; prints one JSON line."""

    scenes: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional] = ()
    """Compiled scenes, or folders of them (a set of the scene library); none: the shipped streets, compiled first."""
    out: pathlib.Path | None = None
    """Folder of the page; default: in the cache. Pictures that are there and current are kept."""
    report: pathlib.Path | None = None
    """report.json of a benchmark: how often the planner failed in each scene is its difficulty."""
    agent: str = "planner"
    """Whose failures in the report count."""
    title: str = "Scenes"
    quiet: bool = False


def main(args: GalleryArgs) -> int:
    """Runs `urbanverse scene gallery`."""
    from rich.console import Console
    from rich.progress import track

    from ..datatypes import BenchmarkReport
    from ..scene.folders import scene_folders
    from ..viz.scene_cards import draw_card
    from ..viz.scene_gallery import make_card, with_difficulty, write_page

    report = None if args.report is None else BenchmarkReport.load(args.report)
    out = args.out or settings.cache_dir("gallery")
    folders = scene_folders(args.scenes or _shipped(args.quiet))
    shown = track(folders, "drawing scenes", console=Console(stderr=True), disable=args.quiet)
    cards: list[Card] = [make_card(folder, out, draw_card) for folder in shown]
    if report is not None:
        cards = with_difficulty(cards, report, args.agent)
    page = write_page(cards, out, args.title)
    print(json.dumps({"page": str(page), "scenes": len(cards)}))
    return 0


def _shipped(quiet: bool) -> list[pathlib.Path]:
    """The shipped streets, compiled into the cache where they are not there or anything they are made of changed."""
    from rich.console import Console
    from rich.progress import track

    from ..pipeline import compile_graph, shipped_scenes

    # Named as the bank is: by everything that makes it.
    home = settings.cache_dir("scenes", settings.shipped_bank_path().stem)
    folders = []
    console = Console(stderr=True)
    for graph in track(shipped_scenes()[0], "compiling streets", console=console, disable=quiet):
        folder = home / graph.parent.name
        if not (folder / "metadata.json").is_file():
            compile_graph(graph, folder)
        folders.append(folder)
    return folders
