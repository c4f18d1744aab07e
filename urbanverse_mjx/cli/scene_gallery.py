"""`urbanverse scene gallery`: makes a page of compiled scenes with images and statistics."""

import dataclasses
import json
import pathlib
from typing import Annotated

import tyro

from .. import pipeline


@dataclasses.dataclass(frozen=True)
class GalleryArgs:
    """Draw compiled scenes from above and at eye level on a page with their statistics; prints one JSON line."""

    scenes: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional] = ()
    """Compiled scenes, or folders of them (a set of the scene library); none: the shipped streets, compiled first."""
    out: pathlib.Path | None = None
    """Folder of the page; default: in the cache. Existing images are kept if they are current."""
    report: pathlib.Path | None = None
    """report.json of a benchmark, whose failure rate in each scene is shown as its difficulty."""
    agent: str = "planner"
    """Agent of the report whose failure rate is used."""
    title: str = "Scenes"
    """Of the page."""
    quiet: bool = False
    """No progress bars."""


def main(args: GalleryArgs) -> int:
    """Runs `urbanverse scene gallery`."""
    done = pipeline.draw_gallery(args.scenes, args.out, args.report, args.agent, args.title, args.quiet)
    print(json.dumps({"page": str(done.page), "scenes": done.scenes}))
    return 0
