"""Real to sim to real: tunes a policy on cousins of a filmed street, and drives the street itself before and after.

    python -m benchmarks.street_tuning prepare --out OUT      # film, cousins, banks: on the processor alone
    python -m benchmarks.street_tuning tune --out OUT         # trains and scores on a GPU; needs OUT/prepared alone
    python -m benchmarks.street_tuning --out OUT --add
    python -m benchmarks.street_tuning --page

No real street is involved, and no street that anything was trained on. Those by default are the three of CraftBench in
which coco_best arrives least often (benchmarks/scores/by_scene.csv); places of `lib.transfer_places` can be named too.
For each of them `prepare` compiles the street, films it by `urbanverse capture`, and gives the film with errors to
`urbanverse gen`: as from a phone that measures depth, with blurred images, drifting poses and wrong depth, in which the
shipped network finds the objects (as `benchmarks.transfer_recordings` does). OUT/prepared/STREET then holds the bank of
its five cousins, and one of five cousins of the street's own graph, of which the first is the street that was filmed.
With `--film video`, `gen` gets spoilt images alone (`BLUR`, `EXPOSURE`, `NOISE`) and estimates poses and depth too;
prepared.json says how many frames got a pose.

`tune` drives the street by the policy as it is (`before`), after PPO on the cousins of the film (`film`) and on those
of the street's own graph (`own`: an upper bound, which has seen the street and its routes), with the preset `tune` in
the conditions in which the policy was trained. Routes of the frozen benchmark are not scored, because streets were
chosen by them. The final parameters are scored; nothing is chosen by scores.

What is done is kept, so that a stopped run continues; a training goes on from its newest checkpoint. The last line of
stdout is one JSON object, which `tune` also writes to OUT/tuned/STREET/result.json. `--add` writes the rows into
benchmarks/scores/street_tuning.csv, and `--page` the table of docs/results.md, as `make results` does.
"""

import argparse
import csv
import functools
import json
import os
import pathlib
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks import results
from benchmarks.lib.options import option, parsed_options
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v

POLICY = pathlib.Path(__file__).with_name("policies") / "coco_best"
STREETS = (
    "07_narrow_alley_outdoor_dining",
    "08_commercial_street_bike_lane_dual_sidewalks",
    "09_cbd_t_intersection_construction_sites",
)
COUSINS, SEEDS = 5, (0, 1)
#: Arms of `tune` -> their name in the table.
ARMS = {"before": "before", "film": "cousins of the film", "own": "cousins of its own graph"}
#: Frames per second of the film, and its size in pixels: steps of 0.7 m, as in a video of which `gen` takes two frames
#: a second.
RATE, SIZE = 2.0, (270, 480)
#: Of `--film video`, px: longest smear by motion, and largest sigma of the defocus; powers of two by which the
#: exposure of a frame differs at most; noise of a pixel (of 1).
BLUR, EXPOSURE, NOISE = (4.0, 0.8), 0.3, 0.02
FILMS = ("sensor", "video")
#: Stages of `prepare` whose time counts from the film to the tuned policy.
FROM_FILM = ("perception", "gen")
MARKS = "<!-- street tuning: python -m benchmarks.street_tuning --page -->", "<!-- end of street tuning -->"
RESULT, PREPARED, ASKED, BANK = "result.json", "prepared.json", "options.json", "bank.npz"
#: Result of an episode -> its letter in the rows.
LETTERS = {
    "goal": "g", "hit": "h", "off_traversable": "o", "timeout": "t", "fall": "f", "non_finite": "n", "hit_agent": "a",
    "lost": "l", "stopped": "s", "dropped": "d",
}  # fmt: skip


# Prepare.


class Clock:
    """Seconds of the stages of a street, kept in its folder; those of `gen` are what it says of its own stages."""

    def __init__(self, file: pathlib.Path) -> None:
        self.file = file
        self.seconds: dict[str, float] = v.read_json(file, "seconds") if file.is_file() else {}

    def __call__(self, stage: str, begin: float) -> None:
        """Keeps the time since `begin`."""
        self.keep(stage, time.monotonic() - begin)

    def keep(self, stage: str, seconds: float) -> None:
        """Keeps a time in place of one that the stage had."""
        self.seconds[stage] = round(seconds, 1)
        v.write_json(self.file, self.seconds)


def known_streets() -> dict[str, Callable[[], Any]]:
    """Name -> function that composes a street."""
    from benchmarks.lib import transfer_places
    from urbanverse_mjx.citygen import craftbench

    return {**craftbench.BUILDERS, **transfer_places.DIRECT, **transfer_places.FILMED}


def film(bank: pathlib.Path, folder: pathlib.Path, frames: int | None) -> None:
    """Films the first scene of a bank by `urbanverse capture`; frames: None for once along both sides."""
    from urbanverse_mjx import pipeline
    from urbanverse_mjx.pipeline.filming import CaptureOptions

    shutil.rmtree(folder, ignore_errors=True)
    pipeline.capture(folder, CaptureOptions(bank=bank, rate=RATE, size=SIZE, frames=frames))


def spoil(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """(H, W, 3) u8 as a camera carried in the hand takes it: smeared, out of focus, in another exposure, with noise."""
    from benchmarks.lib.shifts import exposed
    from benchmarks.transfer_recordings import blurred

    return exposed(blurred(image, rng, BLUR), rng.uniform(-EXPOSURE, EXPOSURE), NOISE, rng)


def seen(film_folder: pathlib.Path, folder: pathlib.Path, kind: str, seed: int) -> None:
    """Writes what `gen` gets: spoilt images alone, or a recording with erroneous poses and depth."""
    from PIL import Image

    from benchmarks import transfer_recordings
    from benchmarks.lib.injection import inject
    from urbanverse_mjx.datatypes import Recording
    from urbanverse_mjx.work_folder import replacing_folder, work_folder

    filmed, rng = Recording.load(film_folder), np.random.default_rng(seed)
    with replacing_folder(folder) as fresh:
        if kind == "video":
            for k in range(len(filmed)):
                Image.fromarray(spoil(filmed.rgb(k), rng)).save(fresh / f"{k:04d}.png")
            return
        with work_folder(".perceived-", folder.parent) as work:
            perceived = transfer_recordings.perceived(filmed, work / "perceived", seed)
            inject(perceived, fresh, seed, transfer_recordings.ERRORS, images=True)


def generate(source: pathlib.Path, out: pathlib.Path, cousins: int, workers: int, pictures: bool) -> dict[str, Any]:
    """Makes cousins of a source by `urbanverse gen`."""
    from urbanverse_mjx import pipeline
    from urbanverse_mjx.pipeline import GenerationOptions, VideoOptions

    video = VideoOptions(rate=RATE)
    options = GenerationOptions(cousins, usd=False, pictures=pictures, workers=workers, video=video)
    return pipeline.generate(source, out, options, quiet=not sys.stderr.isatty())


def with_pose(run: pathlib.Path) -> str:
    """How many frames of a video got a pose in a run of `gen`; "" for a recording, whose poses are given."""
    file = run / "recording" / "perception.json"
    if not file.is_file():
        return ""
    body = v.read_json(file, "perception record")
    return f"{body['registered']} of {body['frames']['kept']}"


def prepare(street: str, args: argparse.Namespace) -> dict[str, Any]:
    """Films a street and makes the banks of its cousins; returns what is written to prepared.json."""
    done, work = args.out / "prepared" / street / PREPARED, args.out / "work" / street
    asked = {"street": street, "film": args.film, "cousins": args.cousins}
    if done.is_file():
        body = v.read_json(done, "prepared street")
        if {k: body.get(k) for k in asked} == asked:
            return body
        raise ValidationError(f"{done}: found {body}, needed {asked}; take another folder for --out.")
    work.mkdir(parents=True, exist_ok=True)
    clock, say = Clock(work / "seconds.json"), functools.partial(_say, street)
    graph = work / "graph.json"
    if not graph.is_file():
        known_streets()[street]().graph().save(graph)
    own = generate(graph, work / "own", args.cousins, args.workers, False)
    clock.keep("own", sum(own["seconds"].values()))
    say(f"compiled, {own['nodes']} objects")
    if not (work / "film" / "recording.json").is_file():
        begin = time.monotonic()
        film(work / "own" / BANK, work / "film", args.frames)
        clock("film", begin)
        say("filmed")
    kind = work / f"seen-{args.film}"
    if not kind.is_dir():
        begin = time.monotonic()
        seen(work / "film", kind, args.film, int(street.strip("t")[:2]))
        # A camera's errors cost nothing; the network that finds objects for a recording does.
        clock("perception" if args.film == "sensor" else "spoiling", begin)
    made = generate(kind, work / f"gen-{args.film}", args.cousins, args.workers, True)
    clock.keep("gen", sum(made["seconds"].values()))
    posed = with_pose(work / f"gen-{args.film}")
    say(f"{made['nodes']} objects found, {made['placed']} placed" + (f"; {posed} frames with a pose" if posed else ""))
    folder = done.parent
    for name, source in (("own", work / "own"), ("film", work / f"gen-{args.film}")):
        (folder / name).mkdir(parents=True, exist_ok=True)
        v.write_atomically(folder / name / BANK, functools.partial(shutil.copyfile, source / BANK))
    said = {"objects": own["placed"][0], "found": made["nodes"], "placed": made["placed"], "with_pose": posed}
    said["seconds"] = clock.seconds
    v.write_json(done, {**asked, **said})
    return {**asked, **said}


# Drive.


def environment(bank: Any, args: argparse.Namespace) -> Any:
    """The environment of the preset `tune` over a bank, in the conditions in which the policy was trained."""
    from urbanverse_mjx.envs import registry
    from urbanverse_mjx.evaluation.frozen import Protocol

    conditions = Protocol.load(settings.protocol_root() / "craftbench.json").conditions
    overrides = {"preset": "tune", "impl": args.impl, **conditions, **parsed_options(args.env)}
    return registry.load("CocoNav", config_overrides=overrides, bank=bank)


def scored(bank: Any, count: int) -> np.ndarray:
    """Rows of the first scene's episode table that are scored: `count` evenly spaced ones of those that are not in the
    frozen list of CraftBench."""
    from urbanverse_mjx.evaluation.frozen import Protocol

    frozen = Protocol.load(settings.protocol_root() / "craftbench.json").scenes
    known = np.array([[*e.start[:2], *e.goal[:2]] for scene in frozen for e in scene.episodes])
    episodes = int(bank.num_episodes[0])
    ends = np.concatenate([bank.episode_start[0, :episodes, :2], bank.episode_goal[0, :episodes, :2]], 1)
    # Protocols keep fewer digits than banks.
    same = (np.abs(ends[:, None] - known).max(-1) < 0.01).any(1)
    others = np.flatnonzero(~same).astype(np.int32)
    return others[np.unique(np.linspace(0, len(others) - 1, count).round().astype(int))]


def drive(env: Any, policy: pathlib.Path, scenes: np.ndarray, rows: np.ndarray) -> list[Any]:
    """Drives a policy once along routes (scene, row of its table) without randomisation; returns the results."""
    from urbanverse_mjx.evaluation import benchmark
    from urbanverse_mjx.evaluation.held_out import for_scoring
    from urbanverse_mjx.evaluation.rollouts import EpisodeSet
    from urbanverse_mjx.training.policy import load_policy

    episodes = EpisodeSet(scenes.astype(np.int32), rows, 0, np.arange(len(rows), dtype=np.uint32))
    agent = load_policy(policy)[0]
    return list(benchmark.drive(for_scoring(env, env.bank), "policy", agent, episodes, False, len(rows)).results)


# Tune.


def train(
    street: str, arm: str, seed: int, env: Any, args: argparse.Namespace
) -> tuple[pathlib.Path, int, float | None]:
    """Trains an arm, or goes on with its training; returns the policy, its env-steps, and the wall time (s) with
    compilation, None if it was interrupted."""
    from ml_collections import ConfigDict

    from benchmarks.lib.unseen import steps_of
    from urbanverse_mjx.envs.registry import with_overrides
    from urbanverse_mjx.training import iterative
    from urbanverse_mjx.training.config import default_ppo_config
    from urbanverse_mjx.training.policy import PolicySpec, latest_policy
    from urbanverse_mjx.training.record import RunRecord
    from urbanverse_mjx.training.run_folder import at_work
    from urbanverse_mjx.training.tuning import tune

    folder = args.out / "tuned" / street / f"{arm}-{seed}"
    config = default_ppo_config("tune")
    own = {"seed": seed, "num_timesteps": args.steps, "num_envs": args.num_envs}
    given = {k: x for k, x in own.items() if x is not None} | parsed_options(args.set)
    config = with_overrides(ConfigDict(config.to_dict()), given)
    file, begin = folder / "seconds.json", time.monotonic()
    begun = iterative.begun(folder)
    if begun and RunRecord.load(folder).ppo != json.loads(json.dumps(config.to_dict())):
        raise ValidationError(f"{folder}: found a training with other options, needed these; take another --out.")
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with at_work(folder):
            done = 0 if not begun else steps_of(folder)
            if done < max(int(config.num_timesteps) // _each(config), 1) * _each(config):
                tune("CocoNav", env, config, folder, args.policy, begun, quiet=not sys.stderr.isatty())
        seconds = None if begun else round(time.monotonic() - begin, 1)
        latest_policy(folder / "checkpoints")  # a training without a policy is not done
        v.write_json(file, {"seconds": seconds})
    policy = latest_policy(folder / "checkpoints")
    return policy, PolicySpec.load(policy).steps, v.read_json(file, "seconds")["seconds"]


def _each(config: Any) -> int:
    """Env-steps of an iteration."""
    return int(config.num_envs) * int(config.finetune.unroll_length)


def tune_street(street: str, args: argparse.Namespace) -> dict[str, Any]:
    """Trains and scores all arms of a street; returns what is written to its result.json."""
    from urbanverse_mjx.datatypes import SceneBank

    folder = args.out / "prepared" / street
    if not (folder / PREPARED).is_file():
        raise ValidationError(
            f"{folder}: found no {PREPARED}, needed a prepared street; run `python -m benchmarks.street_tuning "
            f"prepare --out {args.out} --streets {street}`, or copy OUT/prepared from where it ran."
        )
    prepared = v.read_json(folder / PREPARED, "prepared street")
    out = args.out / "tuned" / street
    names = ("episodes", "env", "set", "steps", "num_envs")
    asked = {"policy": str(args.policy), **{name: getattr(args, name) for name in names}}
    # Scores of other options are not compared with these.
    if (out / ASKED).is_file():
        given = v.read_json(out / ASKED, "options")
        if given != asked:
            raise ValidationError(f"{out / ASKED}: found {given}, needed {asked}; take another folder for --out.")
    out.mkdir(parents=True, exist_ok=True)
    v.write_json(out / ASKED, asked)
    if (out / RESULT).is_file():
        result = v.read_json(out / RESULT, "result")
        if {arm["seed"] for arm in result["arms"]} == {None, *args.seeds}:
            return result
    banks = {name: SceneBank.load(folder / name / BANK) for name in ("own", "film")}
    rows = scored(banks["own"], args.episodes)
    scenes = np.zeros(len(rows), np.int32)
    env = environment(banks["own"], args)
    arms = []
    for seed in (None, *args.seeds):
        for arm in ("before",) if seed is None else ("film", "own"):
            file = out / f"{arm}.json" if seed is None else out / f"{arm}-{seed}.json"
            if not file.is_file():
                policy, steps, seconds = args.policy, 0, 0.0
                if seed is not None:
                    trained_in = env if arm == "own" else environment(banks["film"], args)
                    policy, steps, seconds = train(street, arm, seed, trained_in, args)
                begin = time.monotonic()
                found = drive(env, policy, scenes, rows)
                body = {"arm": arm, "seed": seed, "env_steps": steps, "seconds_train": seconds}
                body |= {"seconds_score": round(time.monotonic() - begin, 1)}
                v.write_json(file, {**body, "ends": "".join(LETTERS[x.result] for x in found)})
            body = v.read_json(file, "arm")
            _say(street, f"{arm} {'' if seed is None else seed}: {rate(body['ends']):.1f} % of {len(body['ends'])}")
            arms.append(body)
    result = {"street": street, "prepared": prepared, "arms": arms}
    v.write_json(out / RESULT, result)
    return result


def rate(ends: str) -> float:
    """Success rate in percent of episodes by their letters."""
    return 100.0 * ends.count("g") / len(ends)


def minutes(arm: Mapping[str, Any], prepared: Mapping[str, Any]) -> float | None:
    """Wall time from the film to the policy of an arm; None if a part was not measured whole."""
    parts = [arm["seconds_train"], *(prepared["seconds"].get(name, 0.0) for name in FROM_FILM)]
    return None if None in parts else round(sum(parts) / 60.0, 1)


# Rows and page.

COLUMNS = ("street", "arm", "seed", "env_steps", "seconds_train", "ends")


def add(result: pathlib.Path, folder: pathlib.Path = results.SCORES) -> int:
    """Writes the arms of a result.json into street_tuning.csv, replacing those of its street; returns their number."""
    body = v.read_json(result, "result")
    prepared, about = body["prepared"], {"street": body["street"]}
    made = {"film": prepared["film"], "seconds_prepare": sum(prepared["seconds"].get(k, 0.0) for k in FROM_FILM)}
    rows = [{**about, **made, **{k: _cell(arm[k]) for k in COLUMNS[1:]}} for arm in body["arms"]]
    results.replace_rows(folder / "street_tuning.csv", about, rows)
    return len(rows)


def _cell(value: Any) -> Any:
    return "" if value is None else value


def read(folder: pathlib.Path) -> dict[str, list[dict[str, str]]]:
    """Street -> its rows."""
    found: dict[str, list[dict[str, str]]] = {}
    with (folder / "street_tuning.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["street"], []).append(row)
    return found


def outcomes(rows: Sequence[Mapping[str, str]], arm: str) -> np.ndarray:
    """(seeds, episodes) 100 where an episode of an arm arrived, else 0."""
    ends = [row["ends"] for row in rows if row["arm"] == arm]
    return np.array([[100.0 * (letter == "g") for letter in text] for text in ends])


def _share(rates: np.ndarray, routes: np.ndarray) -> str:
    """Mean success (%) of (seeds, episodes) rates on some of the routes, with their number."""
    return f"{rates[:, routes].mean():.1f} ({routes.sum()})" if routes.any() else "- (0)"


def page_text(folder: pathlib.Path = results.SCORES) -> str:
    """Markdown of the part of the page between the marks."""
    found, lines = read(folder), []
    for street, rows in sorted(found.items()):
        rates = {arm: outcomes(rows, arm) for arm in ARMS}
        scores = [results.over_seeds_and_scenes(rates[arm]) for arm in ARMS]
        scores.append(results.difference(rates["film"], rates["before"]))
        cells = [f"{s.mean:.1f} [{s.low:.1f}, {s.high:.1f}]" for s in scores]
        cells += [_share(rates["film"], rates["before"][0] == arrived) for arrived in (0.0, 100.0)]
        times = [
            (float(r["seconds_prepare"]) + float(r["seconds_train"])) / 60.0
            for r in rows
            if r["arm"] == "film" and r["seconds_train"]
        ]
        took = f"{np.mean(times):.0f}" if times else "-"
        about = [street, rows[0]["film"], str(len(rates["before"][0])), str(len(rates["film"]))]
        lines.append(f"| {' | '.join([*about, *cells, took])} |")
    head = ["street", "film", "routes", "seeds", *ARMS.values(), "film - before", "of those that failed before"]
    head += ["of those that arrived before", "minutes from the film"]
    parts = ["\n".join([f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}", *lines])] if lines else []
    absent = [street for street in STREETS if street not in found]
    if absent:
        names = ", ".join(f"`{name}`" for name in absent)
        command = 'python -m benchmarks.campaign --out OUT --gpus 2 --rows "street-tuning-*"'
        parts.append(f"Not run yet: {names}; `{command}` runs what is missing.")
    return "\n\n".join(parts)


def write_page() -> None:
    """Writes the table in docs/results.md."""
    page = results.with_table(results.PAGE.read_text(encoding="utf-8"), page_text(), MARKS)
    results.PAGE.write_text(page, encoding="utf-8")


# Command line.


def _say(street: str, text: str) -> None:
    print(f"{street}: {text}", file=sys.stderr, flush=True)


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(
        prog="python -m benchmarks.street_tuning",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    cli.add_argument("stage", nargs="?", choices=("prepare", "tune"))
    cli.add_argument("--out", type=pathlib.Path)
    cli.add_argument("--streets", nargs="+", metavar="STREET", help=f"default: {', '.join(STREETS)}")
    cli.add_argument("--policy", type=pathlib.Path, default=POLICY, help="a student's folder; default: coco_best")
    cli.add_argument("--film", choices=FILMS, default=FILMS[0], help="what gen gets")
    cli.add_argument("--frames", type=int, help="of the film; default: once along both sides of the street")
    cli.add_argument("--cousins", type=int, default=COUSINS)
    cli.add_argument("--seeds", nargs="+", type=int, default=list(SEEDS), help="of the trainings")
    cli.add_argument("--steps", type=int, help="env-steps of a training; default: the preset's")
    cli.add_argument("--num-envs", type=int, help="default: the preset's")
    cli.add_argument("--episodes", type=int, default=192, help="routes of a street that are scored")
    cli.add_argument("--impl", default="auto")
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as num_slots=8")
    cli.add_argument(
        "--set", type=option, nargs="*", default=[], help="options of the training, such as finetune.epochs=1"
    )
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes that compile")
    cli.add_argument("--add", action="store_true", help="write the rows that are there into benchmarks/scores")
    cli.add_argument("--page", action="store_true", help="write the table of docs/results.md")
    args = cli.parse_args(argv)
    if args.stage is None and not (args.add or args.page):
        cli.error("needed prepare, tune, --add or --page")
    if args.out is None and not args.page:
        cli.error("--out: needed a folder, or --page")
    return args


def _main(args: argparse.Namespace) -> int:
    if args.page:
        write_page()
        return 0
    args.out, args.policy = args.out.absolute(), args.policy.absolute()
    if args.add:
        found = sorted(args.out.glob(f"tuned/*/{RESULT}"))
        print(json.dumps({"rows": sum(add(result) for result in found)}))
        return 0
    for street in args.streets or ():
        v.choice(street, "--streets", sorted(known_streets()))
    for name in ("episodes", "workers", "cousins"):
        v.integer(getattr(args, name), f"--{name}", 1)
    streets = args.streets or STREETS
    if args.stage == "prepare":
        print(json.dumps({street: prepare(street, args) for street in streets}))
        return 0
    done = {street: tune_street(street, args) for street in streets}
    said = {}
    for street, body in done.items():
        said[street] = {
            (arm["arm"] if arm["seed"] is None else f"{arm['arm']}-{arm['seed']}"): {
                "SR": round(rate(arm["ends"]), 1),
                "minutes": None if arm["seed"] is None else minutes(arm, body["prepared"]),
            }
            for arm in body["arms"]
        }
    print(json.dumps(said))
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command."""
    args = arguments(argv)
    if args.stage == "prepare":
        # Every process computes on one core.
        os.environ |= {"OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    settings.use_compilation_cache()
    try:
        return _main(args)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
