"""Films every shipped policy, the tasks beside point goals, and every scene of CraftBench and AutoBench.

    python -m benchmarks.films                        # all, into build/media; `make docs-media` does the same
    python -m benchmarks.films --only coco_best craftbench_v2
    python -m benchmarks.films --clip --out docs/films --only social_nav deliver

A policy is shown in one episode of each shipped test street, however it ends. A task is shown in one of several
episodes of the planner in a shipped street, a scene of a benchmark in one of four episodes of coco_best: one that
reaches its goal where there is one (`urbanverse scene library craftbench` builds the scenes of CraftBench). Films that
exist are kept, so that an interrupted run continues; those of benchmarks that are not built are left out and named at
the end. index.html shows all. With --clip the films are the last seconds of an episode, small enough for a page: at
most 80 kB. The last line of stdout is one JSON object: bytes of each film.
"""

import argparse
import dataclasses
import functools
import html
import json
import pathlib
import subprocess
import sys
import warnings
from collections.abc import Callable, Sequence

import imageio_ffmpeg

from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.frozen import Protocol
from urbanverse_mjx.pipeline.benchmarking import protocol_file
from urbanverse_mjx.pipeline.playing import PlayOptions
from urbanverse_mjx.settings import cache_dir
from urbanverse_mjx.work_folder import work_folder

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
    "drop_off": "CocoDropOff",
}
#: Film -> street of a task. On the narrow pavement of construction_narrow, robots that meet stand until the end.
STREETS = {
    "social_nav": "tourist_scooters",
    "follow_person": "park_edge",
    "follow_route": "commercial_bike_lane",
    "cross_street": "residential_bins",
    "object_goal": "park_edge",
    "multi_robot": "commercial_bike_lane",
    "deliver": "commercial_cafes",
    "drop_off": "commercial_cafes",
}
#: Film -> another camera, as in `PlayOptions`: from behind, the robot hides what its arm does.
_CAMERAS = {name: {"azimuth": 60.0, "nearness": 0.55} for name in ("deliver", "drop_off")}
#: Episodes that are driven of a task or of a benchmark's scene, of which one is shown. Four robots of a street are
#: driven together.
_DRIVEN = 4
#: Of a clip: s of the episode's end, s for which the last picture stands, and bytes, of which the container takes some.
_CLIP, _STANDS, CLIP_BYTES = 8.0, 1.0, 80_000
_CLIP_SHARE = 0.9
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
        shown = {"num_episodes": _DRIVEN, "prefer_successes": True, "shown": 1, "fps": _SCENE_FPS}
        shown |= {"scenes": STREETS[name]} | _CAMERAS.get(name, {})
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


def clip(path: pathlib.Path, options: PlayOptions) -> None:
    """Writes the last seconds of a film with at most `CLIP_BYTES` bytes; the last picture stands for a second.

    Raises:
      ValidationError: the clip is larger.
    """
    with work_folder("urbanverse-clip-") as folder:
        # Nothing is lost before the one encoding that counts, for which two passes spread the bytes.
        whole = folder / "whole.mp4"
        exact = {"last": _CLIP, "quality": 10.0, "encoder": "fast"}
        pipeline.play(whole, dataclasses.replace(options, **exact))
        _, seconds = imageio_ffmpeg.count_frames_and_secs(str(whole))
        rate = int(8 * _CLIP_SHARE * CLIP_BYTES / (seconds + _STANDS))
        filters = f"hqdn3d=2:1.5:3:3,tpad=stop_mode=clone:stop_duration={_STANDS:g}"
        program, log = imageio_ffmpeg.get_ffmpeg_exe(), str(folder / "pass")
        # One thread: the bytes do not depend on the number of processors.
        encode = ["-c:v", "libx264", "-preset", "veryslow", "-pix_fmt", "yuv420p", "-threads", "1", "-b:v", str(rate)]
        start = [program, "-v", "error", "-y", "-i", str(whole), "-vf", filters, *encode, "-passlogfile", log]
        exactly = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"]
        with warnings.catch_warnings():
            # JAX warns of every fork; the child starts ffmpeg and does nothing else.
            warnings.filterwarnings("ignore", r"os\.fork\(\) was called", RuntimeWarning)
            subprocess.run([*start, "-pass", "1", "-f", "null", "-"], check=True)
            subprocess.run([*start, "-pass", "2", *exactly, str(path)], check=True)
    if path.stat().st_size > CLIP_BYTES:
        raise v.fail(str(path), f"{path.stat().st_size} bytes", f"at most {CLIP_BYTES}", "lower _CLIP_SHARE")


def make(
    chosen: Sequence[Film],
    out: pathlib.Path,
    say: Callable[[str], object] = lambda _: None,
    clips: bool = False,
) -> tuple[dict[str, int], list[str]]:
    """Makes the films that are missing in a folder, and its index.html; or clips, without a page.

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
            (clip if clips else pipeline.play)(part, film.options)
            part.replace(path)
        sizes[film.name] = path.stat().st_size
        if not clips:
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
    parser.add_argument("--clip", action="store_true", help="the last seconds alone, small, and no index.html")
    args = parser.parse_args(argv)
    try:
        unknown = next((name for name in args.only or () if name not in groups), None)
        if unknown is not None:
            raise v.fail("--only", repr(unknown), f"some of {names}")
        chosen = {film.name: film for name in args.only or every for film in groups[name]}
        say = functools.partial(print, file=sys.stderr, flush=True)
        sizes, missing = make(list(chosen.values()), args.out, say, args.clip)
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
