"""Makes an HTML page of compiled scenes with images and statistics."""

import dataclasses
import os
import pathlib
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .. import settings
from .banks import shipped_scenes
from .scenes import compile_graph

if TYPE_CHECKING:
    from ..viz.scene_gallery import Card


@dataclasses.dataclass(frozen=True)
class Gallery:
    """Path of the page, and number of scenes."""

    page: pathlib.Path
    scenes: int


def draw_gallery(
    scenes: Sequence[str | os.PathLike[str]] = (),
    out: str | os.PathLike[str] | None = None,
    report: str | os.PathLike[str] | None = None,
    agent: str = "planner",
    title: str = "Scenes",
    quiet: bool = True,
) -> Gallery:
    """Renders compiled scenes from above and at eye level and writes a page with their statistics.

    Args:
      scenes: compiled scenes, or folders of them; none: the shipped streets, compiled first.
      out: folder of the page; None for the cache. Existing images are kept if they are current.
      report: report.json of a benchmark; the failure rate of `agent` in each scene is shown as its difficulty.
      quiet: whether to show no progress bar on standard error.

    Raises:
      ValidationError: a folder has no compiled scene, or the file is not a report.
    """
    from rich.console import Console
    from rich.progress import track

    from ..datatypes import BenchmarkReport
    from ..scene.folders import scene_folders
    from ..viz.scene_cards import draw_card
    from ..viz.scene_gallery import make_card, with_difficulty, write_page

    failures = None if report is None else BenchmarkReport.load(report)
    folder = settings.cache_dir("gallery") if out is None else pathlib.Path(out)
    folders = scene_folders([pathlib.Path(scene) for scene in scenes] or _shipped(quiet))
    shown = track(folders, "drawing scenes", console=Console(stderr=True), disable=quiet)
    cards: list[Card] = [make_card(scene, folder, draw_card) for scene in shown]
    if failures is not None:
        cards = with_difficulty(cards, failures, agent)
    return Gallery(write_page(cards, folder, title), len(cards))


def _shipped(quiet: bool) -> list[pathlib.Path]:
    """Folders of the shipped streets, which are compiled into the cache if they are missing or their inputs changed."""
    from rich.console import Console
    from rich.progress import track

    # Named like the bank, by a hash of all its inputs.
    home = settings.cache_dir("scenes", settings.shipped_bank_path().stem)
    folders = []
    console = Console(stderr=True)
    for graph in track(shipped_scenes()[0], "compiling streets", console=console, disable=quiet):
        folder = home / graph.parent.name
        if not (folder / "metadata.json").is_file():
            compile_graph(graph, folder)
        folders.append(folder)
    return folders
