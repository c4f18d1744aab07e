"""Films every shipped policy, every scene of CraftBench, and the tasks beside point goals.

    python -m benchmarks.films                        # all, into build/media; `make docs-media` does the same
    python -m benchmarks.films --only coco_best go2_best

A policy is shown in one episode of each shipped test street, however it ends, a scene of CraftBench in one of the
episodes in which coco_best reaches its goal (`urbanverse scene library craftbench` builds the scenes), a task in one
episode of the planner in a shipped test street, however it ends. Films that exist are kept, so that an interrupted run
continues; index.html shows all. The last line of stdout is one JSON object: bytes of each film.
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
from urbanverse_mjx.pipeline.benchmarking import protocol_file
from urbanverse_mjx.pipeline.playing import PlayOptions
from urbanverse_mjx.settings import cache_dir

POLICIES = pathlib.Path(__file__).with_name("policies")
BENCHMARK, DRIVER = "craftbench", "coco_best"
#: Film -> environment of a task.
TASKS = {
    "social_nav": "CocoSocialNav",
    "follow_person": "CocoFollowPerson",
    "follow_route": "CocoFollowRoute",
    "object_goal": "CocoObjectGoal",
    "multi_robot": "CocoMultiRobot",
}
#: Film -> number of episodes that have to be driven together, of which one is shown.
TOGETHER = {"multi_robot": 4}
#: Images a second of a policy's film, and of a scene's or task's, of which a gait's steps of 0.02 s make up a whole
#: number each.
_FPS, _SCENE_FPS = 25.0, 10.0


@dataclasses.dataclass(frozen=True)
class Film:
    """One film: its name, a sentence about it, and what is played."""

    name: str
    about: str
    options: PlayOptions


def films() -> list[Film]:
    """All films: of the policies, of the benchmark's scenes, and of the tasks."""
    style = {"quality": 3.5, "samples": 2, "quiet": True}
    found = [
        Film(
            path.parent.name,
            "in the shipped test streets",
            PlayOptions(policy=path.parent, num_episodes=2, fps=_FPS, **style),
        )
        for path in sorted(POLICIES.glob("*/policy.json"))
    ]
    body = v.read_json(protocol_file(BENCHMARK), "benchmark")
    bank = cache_dir("library", BENCHMARK, "bank.npz")
    for scene in (row["id"] for row in body["scenes"]):
        shown = {"num_episodes": 4, "only_successes": True, "shown": 1, "fps": _SCENE_FPS}
        options = PlayOptions(policy=POLICIES / DRIVER, bank=bank, scenes=scene, **shown, **style)
        found.append(Film(f"{BENCHMARK}-{scene}", f"driven by {DRIVER}", options))
    for name, environment in TASKS.items():
        shown = {"num_episodes": TOGETHER.get(name, 1), "shown": 1, "fps": _SCENE_FPS}
        options = PlayOptions(policy="planner", env_name=environment, **shown, **style)
        found.append(Film(name, f"{environment}, driven by the planner", options))
    return found


def make(chosen: Sequence[Film], out: pathlib.Path, say: Callable[[str], object] = lambda _: None) -> dict[str, int]:
    """Makes the films that are missing in a folder, and its index.html; returns the bytes of each film.

    Raises:
      ValidationError: the benchmark's scenes are not built; films made before stay.
    """
    sizes = {}
    for film in chosen:
        path = out / f"{film.name}.mp4"
        if not path.is_file():
            bank = film.options.bank
            if bank is not None and not bank.is_file():
                raise ValidationError(
                    f"{film.name}: found no bank at {bank}, needed that of {BENCHMARK}; run `urbanverse scene library "
                    f"{BENCHMARK}`, or name other films with --only."
                )
            say(f"{film.name} ...")
            # An interrupted film is not taken for a whole one.
            part = path.with_suffix(".part.mp4")
            part.parent.mkdir(parents=True, exist_ok=True)
            pipeline.play(part, film.options)
            part.replace(path)
        sizes[film.name] = path.stat().st_size
        v.write_atomically(out / "index.html", lambda p: p.write_text(_page(chosen, sizes), encoding="utf-8"))
    return sizes


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
    every = {film.name: film for film in films()}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/media"), help="folder of the films")
    parser.add_argument("--only", nargs="+", choices=list(every), metavar="NAME", help=f"of {', '.join(every)}")
    args = parser.parse_args(argv)
    chosen = [every[name] for name in args.only or every]
    try:
        sizes = make(chosen, args.out, lambda line: print(line, file=sys.stderr, flush=True))
    except ValidationError as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps(sizes))
    return 0


if __name__ == "__main__":
    sys.exit(main())
