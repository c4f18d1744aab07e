"""Films every shipped policy, the tasks beside point goals, and every scene of CraftBench and AutoBench.

    python -m benchmarks.films                        # all, into build/media; `make docs-media` does the same
    python -m benchmarks.films --only coco_best craftbench_v2

A policy is shown in one episode of each shipped test street, however it ends, a task in one episode of the planner in
a shipped test street, however it ends, a scene of a benchmark in one of four episodes of coco_best, one that reaches
its goal where there is one (`urbanverse scene library craftbench` builds the scenes of CraftBench). Films that exist
are kept, so that an interrupted run continues; those of benchmarks that are not built are left out and named at the
end. index.html shows all. The last line of stdout is one JSON object: bytes of each film.
"""

import argparse
import dataclasses
import html
import json
import pathlib
import sys
from collections.abc import Callable, Sequence

from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.frozen import Protocol
from urbanverse_mjx.pipeline.benchmarking import protocol_file
from urbanverse_mjx.pipeline.playing import PlayOptions
from urbanverse_mjx.settings import cache_dir

POLICIES = pathlib.Path(__file__).with_name("policies")
DRIVER = "coco_best"
#: Benchmarks whose scenes are filmed: with a version's own look and friction, the latest first.
BENCHMARKS = ("craftbench_v2", "autobench_v2", "craftbench", "autobench")
#: Film -> environment of a task.
TASKS = {
    "social_nav": "CocoSocialNav",
    "follow_person": "CocoFollowPerson",
    "follow_route": "CocoFollowRoute",
    "cross_street": "CocoCrossStreet",
    "object_goal": "CocoObjectGoal",
    "multi_robot": "CocoMultiRobot",
    "deliver": "CocoDeliver",
}
#: Film -> number of episodes that have to be driven together, of which one is shown.
TOGETHER = {"multi_robot": 4}
#: Episodes that are driven of a benchmark's scene, of which one is shown.
_DRIVEN = 4
#: Images a second of a policy's film, and of a scene's or task's, of which a gait's steps of 0.02 s make up a whole
#: number each.
_FPS, _SCENE_FPS = 25.0, 10.0


@dataclasses.dataclass(frozen=True)
class Film:
    """One film: its name, a sentence about it, what is played, and the benchmark of its scene."""

    name: str
    about: str
    options: PlayOptions
    benchmark: str = ""


def films() -> list[Film]:
    """All films: of the policies, of the tasks, and of the benchmarks' scenes."""
    # Six seconds of coco_best: 8 % smaller than by the preset medium at the same quality, and closer to the original.
    style = {"quality": 3.3, "encoder": "veryslow", "samples": 2, "quiet": True}
    found = [
        Film(
            path.parent.name,
            "in the shipped test streets",
            PlayOptions(policy=path.parent, num_episodes=2, fps=_FPS, **style),
        )
        for path in sorted(POLICIES.glob("*/policy.json"))
    ]
    for name, environment in TASKS.items():
        shown = {"num_episodes": TOGETHER.get(name, 1), "shown": 1, "fps": _SCENE_FPS}
        options = PlayOptions(policy="planner", env_name=environment, **shown, **style)
        found.append(Film(name, f"{environment}, driven by the planner", options))
    for benchmark in BENCHMARKS:
        protocol = Protocol.load(protocol_file(benchmark))
        # The policy sees what its training showed, as when it is scored.
        conditions = {k: x for k, x in protocol.conditions.items() if not k.startswith("vision_config.")}
        bank = cache_dir("library", benchmark, "bank.npz")
        for scene in protocol.scenes:
            shown = {"num_episodes": _DRIVEN, "prefer_successes": True, "shown": 1, "fps": _SCENE_FPS}
            options = PlayOptions(
                policy=POLICIES / DRIVER, bank=bank, scenes=scene.id, env_overrides=conditions, **shown, **style
            )
            found.append(Film(f"{benchmark}-{scene.id}", f"driven by {DRIVER}", options, benchmark))
    return found


def make(
    chosen: Sequence[Film], out: pathlib.Path, say: Callable[[str], object] = lambda _: None
) -> tuple[dict[str, int], list[str]]:
    """Makes the films that are missing in a folder, and its index.html.

    Returns:
      bytes of each film, and the benchmarks whose films are left out because their scenes are not built.
    """
    sizes: dict[str, int] = {}
    missing: list[str] = []
    for film in chosen:
        path = out / f"{film.name}.mp4"
        if not path.is_file():
            bank = film.options.bank
            if bank is not None and not bank.is_file():
                if film.benchmark not in missing:
                    missing.append(film.benchmark)
                continue
            say(f"{film.name} ...")
            # An interrupted film is not taken for a whole one.
            part = path.with_suffix(".part.mp4")
            part.parent.mkdir(parents=True, exist_ok=True)
            pipeline.play(part, film.options)
            part.replace(path)
        sizes[film.name] = path.stat().st_size
        v.write_atomically(out / "index.html", lambda p: p.write_text(_page(chosen, sizes), encoding="utf-8"))
    return sizes, missing


def _page(chosen: Sequence[Film], done: dict[str, int]) -> str:
    cards = "".join(
        f'<figure><video controls muted loop width="640" src="{html.escape(film.name)}.mp4"></video>'
        f"<figcaption>{html.escape(film.name)}, {html.escape(film.about)}</figcaption></figure>"
        for film in chosen
        if film.name in done
    )
    return f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Films</title><body>{cards}</body></html>\n'


def main(argv: Sequence[str] | None = None) -> int:
    """Makes the films that are asked for."""
    every = {film.name: [film] for film in films()}
    groups = every | {name: [f for (f,) in every.values() if f.benchmark == name] for name in BENCHMARKS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/media"), help="folder of the films")
    names = ", ".join([*BENCHMARKS, *every])
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", help=f"of {names}; a benchmark's name means all its scenes"
    )
    args = parser.parse_args(argv)
    try:
        unknown = next((name for name in args.only or () if name not in groups), None)
        if unknown is not None:
            raise v.fail("--only", repr(unknown), f"some of {names}")
        chosen = {film.name: film for name in args.only or every for film in groups[name]}
        sizes, missing = make(list(chosen.values()), args.out, lambda line: print(line, file=sys.stderr, flush=True))
    except ValidationError as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps(sizes))
    if missing:
        names, left = " ".join(missing), v.counted(len(chosen) - len(sizes), "films")
        print(
            f"Found no scenes of {' and '.join(missing)}, needed them for {left}; run "
            f"`urbanverse scene library {names}` and this command again.",
            file=sys.stderr,
        )
    return 2 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
