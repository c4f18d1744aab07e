"""`urbanverse study ...`: makes the page of a user study, analyses its answers, and compares layouts without people."""

import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from .. import pipeline
from ._options import parse


@dataclasses.dataclass(frozen=True)
class MakeArgs:
    """Render scenes and write a static page on which people compare and rate them; prints one JSON line."""

    out: pathlib.Path
    """Folder of the page, to be copied to any web server or opened as a file. The key, which tells what each image
    shows, is written beside it as NAME-key.json: keep it."""
    ours: tuple[pathlib.Path, ...]
    """Compiled scenes, or folders of them."""
    baseline: tuple[pathlib.Path, ...] = ()
    """Scenes that each of a pair is compared with, such as procedural ones; none: no pairs."""
    oracle: tuple[pathlib.Path, ...] = ()
    """Scenes that are rated, too, such as CraftBench."""
    graphs: pathlib.Path | None = None
    """Folder with ID/graph.json of the sources of --ours, for ratings of fidelity; none: no such ratings."""
    pairs: int = 100
    """Pairs of images from above."""
    rated: int = 10
    """Scenes of each group whose walkthrough video is rated."""
    fidelity: int = 10
    """Cousins that are compared with the plan of their source."""
    catches: int = 3
    """Trials of each kind that show whether a participant pays attention."""
    width: int = 800
    """Pixels."""
    frames: int = 150
    """Frames of a video, 10 per second."""
    seed: int = 0
    """Of the choice of scenes, pairs and names."""
    title: str = "Streets"
    """Of the page."""
    consent: pathlib.Path | None = None
    """File with the text that participants agree to."""
    contact: str = ""
    """Who answers questions about the study."""
    quiet: bool = False
    """Do not print the name of each part."""


@dataclasses.dataclass(frozen=True)
class AnalyseArgs:
    """Print shares, means, 95 % intervals and Fleiss' kappa of a study's answers as JSON."""

    key: Annotated[pathlib.Path, tyro.conf.Positional]
    """NAME-key.json."""
    answers: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """CSV files of the participants."""


@dataclasses.dataclass(frozen=True)
class LayoutsArgs:
    """Compare layouts of scenes with those of other scenes, or of the graphs that they were made from; prints JSON."""

    scenes: Annotated[tuple[pathlib.Path, ...], tyro.conf.Positional]
    """Compiled scenes, or folders of them; with --graphs, the first cousin of each source."""
    against: tuple[pathlib.Path, ...] = ()
    """Other compiled scenes."""
    graphs: pathlib.Path | None = None
    """Folder with ID/graph.json of the sources."""
    permutations: int = 999
    """Exchanges of whole streets, for the p-values."""
    quiet: bool = False
    """Do not print the name of each part."""


_Command = (
    Annotated[MakeArgs, tyro.conf.subcommand("make")]
    | Annotated[AnalyseArgs, tyro.conf.subcommand("analyse")]
    | Annotated[LayoutsArgs, tyro.conf.subcommand("layouts")]
)


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse study`."""
    args = parse(_Command, argv, "urbanverse study")  # type: ignore[arg-type]
    if isinstance(args, AnalyseArgs):
        print(json.dumps(pipeline.analyse_study(args.key, args.answers)))
        return 0

    def progress(name: str) -> None:
        if not args.quiet:
            print(name, file=sys.stderr, flush=True)

    if isinstance(args, LayoutsArgs):
        found = pipeline.compare_layouts(args.scenes, args.against, args.graphs, args.permutations, progress)
        print(json.dumps(found))
        return 0
    own = ("pairs", "rated", "fidelity", "catches", "width", "frames", "seed", "title", "contact")
    consent = "" if args.consent is None else args.consent.read_text(encoding="utf-8")
    options = pipeline.StudyOptions(**{name: getattr(args, name) for name in own}, consent=consent)
    done = pipeline.make_study(args.out, args.ours, args.baseline, args.oracle, args.graphs, options, progress)
    print(json.dumps({"page": str(done.page), "key": str(done.key), "trials": done.trials}))
    return 0
