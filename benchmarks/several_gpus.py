"""The same training on one and on two GPUs: success on CraftBench, and env-steps per second of each stage.

    CUDA_VISIBLE_DEVICES=0,1 python -m benchmarks.several_gpus --train procedural/bank.npz --test craftbench/bank.npz \
        --seed 0 --out runs/gpus-2-0
    python -m benchmarks.campaign --out OUT --gpus 2 --rows "gpus-*"
    python -m benchmarks.campaign --out OUT --add
    python -m benchmarks.several_gpus --page

The first command trains the three stages of the preset `best` on all devices that JAX has, with an equal number of envs
in all however many devices there are, scores the final parameters on all episodes of CraftBench, and writes
result.json; killed and started again it goes on. The second does this with one and two GPUs and two seeds, where
nothing else runs on them. The speed of a stage is the median over its log, without compilation. `--page` writes the
table of docs/results.md.
"""

import argparse
import csv
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks import results
from benchmarks.lib.options import option, parsed_options
from urbanverse_mjx.datatypes import validation as v

SEEDS, GPUS = (0, 1), (1, 2)
STAGES = {"teacher": "teacher", "imitation": "imitation", "finetune": "PPO of the student"}
TEST, AGENT = "craftbench", "best"
MARKS = "<!-- several gpus: python -m benchmarks.several_gpus --page -->", "<!-- end of several gpus -->"
TABLE = "several_gpus.csv"


def speed(log: pathlib.Path) -> float:
    """Median env-steps per second in the log of a stage.

    Raises:
      SystemExit: it was logged nowhere, because the stage was too short.
    """
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    rates = [line["steps_per_second"] for line in lines if "steps_per_second" in line]
    if not rates:
        raise SystemExit(f"error: {log}: found no speed, needed at least two iterations of this stage; see --steps.")
    return float(np.median(rates))


def train(args: argparse.Namespace) -> dict[str, Any]:
    """Trains and scores; returns what is written to result.json."""
    import jax
    from ml_collections import ConfigDict

    from benchmarks.lib.unseen import begin, brief, load
    from urbanverse_mjx.envs import registry
    from urbanverse_mjx.envs.registry import with_overrides
    from urbanverse_mjx.training.config import default_ppo_config
    from urbanverse_mjx.training.policy import load_policy
    from urbanverse_mjx.training.record import FILE
    from urbanverse_mjx.training.run_folder import at_work
    from urbanverse_mjx.training.teacher_student import COMPLETE, IMITATION, TEACHER, TeacherStudent

    log = begin(args.out)
    streets = load(args.train, args.test, [], args.episodes, log)
    overrides = {"preset": "best", "impl": args.impl, "scenes": ",".join(streets.train), **parsed_options(args.env)}
    env = registry.load("CocoNav", config_overrides=overrides, bank=streets.bank)
    streets.suite.check(env)
    given = {"num_timesteps": args.steps, "num_envs": args.num_envs, "seed": args.seed} | parsed_options(args.set)
    config = with_overrides(ConfigDict(default_ppo_config("best").to_dict()), given)
    folder = args.out / "training"

    def teacher_env() -> Any:
        return registry.load("CocoNav", config=env.config, config_overrides={"vision": False}, bank=env.bank)

    training = TeacherStudent("CocoNav", env, teacher_env, config, folder, quiet=True)
    if not (folder / COMPLETE).is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with at_work(folder):
            training.train((folder / FILE).is_file(), lambda text: log(stage=text))
    logs = {"teacher": folder / TEACHER, "imitation": folder / IMITATION, "finetune": folder}
    speeds = {name: round(speed(path / "log.jsonl"), 1) for name, path in logs.items()}
    log(**speeds)
    policy, spec = load_policy(folder / "checkpoints")
    scores = streets.suite.score(env, AGENT, policy)
    log(**{name: brief(x) for name, x in scores.items()})
    about = {"gpus": jax.local_device_count(), "device": jax.devices()[0].device_kind, "seed": args.seed}
    return {**about, "steps": spec.steps, "num_envs": int(config.num_envs), "speed": speeds, AGENT: scores}


def add(result: pathlib.Path, folder: pathlib.Path = results.SCORES) -> int:
    """Writes the rows of a result.json into several_gpus.csv, replacing those of its seed and number of GPUs; returns
    their number."""
    body = json.loads(result.read_text(encoding="utf-8"))
    about = {"gpus": body["gpus"], "seed": body["seed"]}
    made = {"num_envs": body["num_envs"], "env_steps": body["steps"], **body["speed"]}
    scenes = sorted(body[AGENT][TEST]["by_scene"].items())
    rows = [{**about, **made, "scene": scene, "SR": round(score["SR"], 6)} for scene, score in scenes]
    results.replace_rows(folder / TABLE, about, rows)
    return len(rows)


def page_text(folder: pathlib.Path = results.SCORES) -> str:
    """Markdown of the part of the page between the marks."""
    rates: dict[int, dict[tuple[str, str], float]] = {}
    speeds: dict[int, dict[str, dict[str, float]]] = {}
    with (folder / TABLE).open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            rates.setdefault(int(row["gpus"]), {})[row["seed"], row["scene"]] = float(row["SR"])
            speeds.setdefault(int(row["gpus"]), {})[row["seed"]] = {k: float(row[k]) for k in STAGES}
    tables = {n: results.by_seed_and_scene(rates[n], f"{TABLE}: {n} GPUs") for n in sorted(rates)}
    means = {n: {k: float(np.mean([s[k] for s in speeds[n].values()])) for k in STAGES} for n in tables}
    lines = []
    for n, table in tables.items():
        score = results.over_seeds_and_scenes(table)
        cells = [str(n), str(score.seeds), _cell(score), *(f"{means[n][k]:,.0f}" for k in STAGES)]
        lines.append(f"| {' | '.join(cells)} |")
    if set(GPUS) <= set(tables):
        one, two = GPUS
        cells = [f"{two} against {one}", "", _cell(results.difference(tables[two], tables[one]))]
        cells += [f"{means[two][k] / means[one][k]:.2f} times" for k in STAGES]
        lines.append(f"| {' | '.join(cells)} |")
    head = ["GPUs", "seeds", "CraftBench", *(f"env-steps/s, {title}" for title in STAGES.values())]
    parts = ["\n".join([f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}", *lines])] if lines else []
    absent = [f"`gpus-{n}-{s}`" for n in GPUS for s in SEEDS if str(s) not in speeds.get(n, {})]
    if absent:
        command = 'python -m benchmarks.campaign --out OUT --gpus 2 --rows "gpus-*"'
        parts.append(f"Not run yet: {', '.join(absent)}; `{command}` runs what is missing.")
    return "\n\n".join(parts)


def _cell(score: results.Score) -> str:
    return f"{score.mean:.1f} [{score.low:.1f}, {score.high:.1f}]"


def write_page() -> None:
    """Writes the table in docs/results.md."""
    page = results.with_table(results.PAGE.read_text(encoding="utf-8"), page_text(), MARKS)
    results.PAGE.write_text(page, encoding="utf-8")


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--train", nargs="+", type=pathlib.Path, help="banks to train on")
    cli.add_argument("--test", nargs="+", type=pathlib.Path, help="banks to drive, one of them craftbench/bank.npz")
    cli.add_argument("--out", type=pathlib.Path)
    cli.add_argument("--steps", type=int, default=20_000_000, help="env-steps of all stages")
    cli.add_argument("--num-envs", type=int, default=4096, help="in all, however many devices there are")
    cli.add_argument("--episodes", type=int, default=768, help="of a bank to test that has no frozen protocol")
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as num_slots=8")
    cli.add_argument(
        "--set", type=option, nargs="*", default=[], help="options of the training, such as network.memory=0"
    )
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--impl", default="auto")
    cli.add_argument("--page", action="store_true", help="write the table of docs/results.md, train nothing")
    args = cli.parse_args(argv)
    if not args.page and None in (args.train, args.test, args.out):
        cli.error("needed --train, --test and --out, or --page")
    return args


def main() -> int:
    args = arguments()
    if args.page:
        write_page()
        return 0
    args.out = args.out.absolute()
    body = train(args)
    v.write_json(args.out / "result.json", body)
    print(json.dumps({k: x for k, x in body.items() if k != AGENT}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
