"""Trains policies of a task beside point goals and scores them between a scripted baseline and a planner.

    python -m benchmarks.tasks --task CocoSocialNav --out runs/social_nav
    python -m benchmarks.tasks --task CocoSocialNav --out runs/social_nav-0 --train procedural/bank.npz --seed 0
    python -m benchmarks.tasks --task CocoSocialNav --out runs/social_nav-0 --train procedural/bank.npz --camera
    python -m benchmarks.tasks --task CocoSocialNav --out runs/social_nav-1 --teacher POLICY --student POLICY
    python -m benchmarks.tasks --add runs/social_nav-0/result.json
    python -m benchmarks.tasks --page

The first command drives the baseline and the planner with full knowledge, the ceiling, on evenly spaced episodes of
the bank `validation`. With `--train` a privileged teacher is trained by PPO before, on the streets of these banks; with
`--camera` a student with a camera imitates it and goes on by PPO (the preset `best`), after the teacher of `--out` if
there is one. `--teacher` and `--student` score policies that are there. All agents drive the same
episodes with the same crowds, without randomisation. `relative` is where a policy is between baseline (0) and ceiling
(1) by the task's headline score; 0.5 is asked of a trained one. Writes log.jsonl, result.json, episodes.csv and policy
folders to `--out`. With `--alone` policies are driven without baseline and planner, whose scores are those of
benchmarks/scores/tasks.csv. `--add` writes the rows of a result into that file, and `--page` its rows into the pages of
docs/tasks.
"""

import argparse
import csv
import pathlib
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from benchmarks.lib.options import option, parsed_options
from benchmarks.lib.tables import markdown
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import EpisodeResult, SceneBank
from urbanverse_mjx.datatypes import validation as v

if TYPE_CHECKING:
    from ml_collections import ConfigDict

    from urbanverse_mjx.envs import NavEnv
    from urbanverse_mjx.evaluation.held_out import Suite

SCORES = pathlib.Path(__file__).with_name("scores") / "tasks.csv"
PAGES = pathlib.Path(__file__).parents[1] / "docs" / "tasks"
COLUMNS = ("task", "agent", "seed", "steps", "episodes", "metric", "mean", "low", "high")
#: Environment -> its page, and its metrics with their title and decimals, of which the first is the headline.
TASKS: dict[str, tuple[str, dict[str, tuple[str, int]]]] = {
    "CocoSocialNav": (
        "social_nav.md",
        {
            "task/score": ("score", 3),
            "SR": ("SR %", 1),
            "agent_hits": ("touches a person %", 1),
            "task/intimate_time": ("time within 0.45 m", 3),
            "task/personal_time": ("time within 1.2 m", 3),
            "task/least_distance": ("least distance m", 2),
            "task/time_to_collision": ("least time to collision s", 2),
            "task/jerk": ("jerk m/s³", 1),
            "task/turning": ("turning rad/m", 2),
            "task/people_delay": ("people's delay s/min", 2),
        },
    ),
    "CocoObjectGoal": (
        "object_goal.md",
        {
            "task/score": ("score (SPL)", 3),
            "SR": ("SR %", 1),
            "task/distance_to_success": ("distance to success m", 2),
            "RC": ("RC %", 1),
            "hit_episodes": ("episodes with contact %", 1),
        },
    ),
    "CocoMultiRobot": (
        "multi_robot.md",
        {
            "task/score": ("score (deliveries per minute and street)", 2),
            "task/deliveries": ("deliveries of a robot", 2),
            "task/robot_contact": ("touches a robot", 3),
            "task/robot_distance": ("least distance to a robot m", 2),
            "SR": ("SR %", 1),
            "hit_episodes": ("episodes with contact %", 1),
        },
    ),
    "CocoDeliver": (
        "deliver.md",
        {
            "task/score": ("score (SPL)", 3),
            "SR": ("SR %", 1),
            "task/press_force": ("largest force N", 1),
            "task/tip_distance": ("fingertip from the button m", 3),
            "hit_episodes": ("episodes with contact %", 1),
        },
    ),
    "CocoDropOff": (
        "drop_off.md",
        {
            "task/score": ("score (SPL)", 3),
            "SR": ("SR %", 1),
            "task/parcel_distance": ("parcel from the box's middle m", 3),
            "task/release_height": ("height of the release m", 3),
            "hit_episodes": ("episodes with contact %", 1),
        },
    ),
    "CocoFollowPerson": (
        "follow_person.md",
        {
            "task/score": ("score", 3),
            "SR": ("SR %", 1),
            "task/in_sight": ("in sight", 3),
            "task/distance": ("distance m", 2),
            "RC": ("RC %", 1),
            "hit_episodes": ("episodes with contact %", 1),
        },
    ),
    "CocoFollowRoute": (
        "follow_route.md",
        {
            "task/score": ("score", 3),
            "SR": ("SR %", 1),
            "RC": ("RC %", 1),
            "task/violations": ("violations", 2),
            "task/crossings": ("crosswalks entered", 2),
            "hit_episodes": ("episodes with contact %", 1),
            "task/standing": ("standing s", 1),
            "task/seconds": ("seconds", 1),
        },
    ),
    "CocoCrossStreet": (
        "cross_street.md",
        {
            "task/score": ("score", 3),
            "SR": ("SR %", 1),
            "agent_hits": ("hit by a vehicle %", 1),
            "task/near_misses": ("near misses", 2),
            "task/near_miss": ("episodes with a near miss", 3),
            "task/time_to_collision": ("least time to collision s", 2),
            "task/post_encroachment_time": ("least post-encroachment time s", 2),
            "task/stops": ("stops on the road", 2),
            "task/waited": ("waited s", 1),
            "task/delay": ("delay s", 1),
            "task/seconds": ("seconds", 1),
        },
    ),
}
HEADLINE = "task/score"
MARKS = "<!-- tasks: python -m benchmarks.tasks --page -->", "<!-- end of tasks -->"


def relative(policy: float, baseline: float, ceiling: float) -> float | None:
    """Where a score is between the baseline's (0) and the ceiling's (1); None if the ceiling is no higher."""
    return None if ceiling <= baseline else (policy - baseline) / (ceiling - baseline)


def overrides(args: argparse.Namespace, scenes: Sequence[str], camera: bool, trains: bool = False) -> dict[str, Any]:
    """Environment options of the training or scoring in some scenes."""

    found = {"preset": "best", "impl": args.impl, "scenes": ",".join(scenes), "vision": camera}
    return found | parsed_options(args.env) | (parsed_options(args.train_env) if trains else {})


def scoring_env(args: argparse.Namespace, camera: bool) -> "NavEnv":
    """The environment without randomisation in the streets of the bank to test on."""
    from urbanverse_mjx.envs import registry
    from urbanverse_mjx.envs.navigation.draws import OFF

    bank = SceneBank.load(args.test)
    options = overrides(args, bank.scene_ids, camera) | {"randomization": OFF}
    config = registry.with_overrides(registry.get_default_config(args.task, "best"), _without_preset(options))
    return registry.load_nav_env(args.task, config, bank)


def _without_preset(options: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if name != "preset"}


def suite_of(env: "NavEnv", episodes: int) -> "Suite":
    """Evenly spaced episodes of the streets to test on."""
    from urbanverse_mjx.evaluation.held_out import Suite

    return Suite.of(env.bank, {"validation": [env.bank.scene_ids[z] for z in env.scenes]}, episodes, [])


def train(args: argparse.Namespace, log: Callable[..., None]) -> dict[str, Any]:
    """Trains the policies; returns agent -> policy folder."""
    from benchmarks.lib.banks import joined
    from urbanverse_mjx.envs import NavEnv, registry
    from urbanverse_mjx.training.policy import latest_policy
    from urbanverse_mjx.training.teacher_student import TEACHER, TeacherStudent

    banks = [SceneBank.load(path) for path in args.train]
    bank = joined(banks)
    chosen = [name for part in banks for name in part.scene_ids[: args.train_scenes]]
    config = training_config(args)
    folder = args.out / "training"

    def env_of(camera: bool) -> NavEnv:
        options = overrides(args, chosen, camera, True)
        env = registry.load(args.task, config_overrides=options, bank=bank)
        assert isinstance(env, NavEnv)
        return env

    def say(text: str) -> None:
        log(stage=text)

    if not args.camera:
        shutil.rmtree(folder, ignore_errors=True)  # of an interrupted attempt
        training = TeacherStudent(args.task, env_of(True), lambda: env_of(False), config, folder)
        return {"teacher": training.train_teacher(say)}
    unseen = scoring_env(args, True)
    suite = suite_of(unseen, args.episodes)
    env = env_of(True)
    training = TeacherStudent(
        args.task, env, lambda: env_of(False), config, folder, lambda s: suite.quick(unseen, s, ["validation"])
    )
    result = training.train(resume=folder.is_dir(), say=say)
    assert result.policy is not None
    return {"teacher": latest_policy(folder / TEACHER), "student": result.policy}


def given(args: argparse.Namespace) -> dict[str, pathlib.Path]:
    """Agent -> policy folder, of the command line."""
    named = {"teacher": args.teacher, "student": args.student}
    return {name: path for name, path in named.items() if path is not None}


def training_config(args: argparse.Namespace) -> "ConfigDict":
    """The preset `best` of the task's training with the sizes of the command line; `--steps` are those of the teacher,
    to which the other stages' are in the preset's proportion."""
    from urbanverse_mjx.envs import registry

    config = registry.get_ppo_config(args.task, "best").copy_and_resolve_references().unlock()
    shares = config.shares
    config.num_timesteps = round(args.steps * sum(shares.values()) / shares.teacher)
    config.num_envs, config.seed = args.num_envs, args.seed
    config.validation_episodes = args.episodes
    config.update_from_flattened_dict(parsed_options(args.set))
    return config.lock()


def score(env: "NavEnv", name: str, agent: Any, episodes: Any, at_once: int) -> list[EpisodeResult]:
    """Drives an agent on all episodes."""
    from urbanverse_mjx.evaluation import benchmark

    return list(benchmark.drive(env, name, agent, episodes, False, at_once).results)


def _rows(path: pathlib.Path) -> list[dict[str, str]]:
    """The rows of a table of scores."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _reference_rows(task: str, path: pathlib.Path = SCORES) -> list[dict[str, str]]:
    """Rows of the headline of a task's baseline and planner."""
    return [r for r in _rows(path) if r["task"] == task and not r["seed"] and r["metric"] == HEADLINE]


def references(task: str, path: pathlib.Path = SCORES) -> dict[str, float]:
    """Agent -> headline score, of a task's baseline and planner in benchmarks/scores/tasks.csv."""
    return {row["agent"]: float(row["mean"]) for row in _reference_rows(task, path)}


def driven_references(task: str, path: pathlib.Path = SCORES) -> int:
    """The number of episodes of a task's references in benchmarks/scores/tasks.csv; 0 if there are none."""
    return min((int(row["episodes"]) for row in _reference_rows(task, path)), default=0)


def summary_of(results: Sequence[EpisodeResult]) -> dict[str, Any]:
    """Metric -> {"mean", "low", "high"}, and the number of episodes by their ends."""
    from urbanverse_mjx.evaluation import result_counts, summarise

    return {**summarise(results), "ends": result_counts(results)}


def measure(args: argparse.Namespace, log: Callable[..., None]) -> dict[str, Any]:
    """Trains what is asked for, and scores it beside baseline and ceiling."""
    from urbanverse_mjx.evaluation.report import write_csv
    from urbanverse_mjx.evaluation.task_agents import baseline_of, planner_of
    from urbanverse_mjx.training.policy import PolicySpec, load_policy

    blind = scoring_env(args, False)
    episodes = suite_of(blind, args.episodes).episodes["validation"]
    told = driven_references(args.task)
    if args.alone and len(episodes) != told:
        raise SystemExit(
            f"error: --alone: found {len(episodes)} episodes to drive and {told} of {args.task}'s baseline and planner "
            f"in {SCORES.name}, needed as many; give --episodes {told}, or leave out --alone."
        )
    trained = train(args, log) if args.train else given(args)
    baseline, drive = baseline_of(blind)
    agents: dict[str, tuple[Any, Any]] = {}
    if not args.alone:
        agents = {baseline: (blind, drive), "planner": (blind, planner_of(blind))}
    for name, folder in trained.items():
        env = scoring_env(args, True) if name == "student" else blind
        agents[name] = env, load_policy(folder)[0]
    results: list[EpisodeResult] = []
    found: dict[str, Any] = {}
    for name, (env, agent) in agents.items():
        own = score(env, name, agent, episodes, args.at_once)
        results += own
        steps = PolicySpec.load(trained[name]).steps if name in trained else 0
        found[name] = {"steps": steps, "summary": summary_of(own)}
        log(
            agent=name,
            **{k: found[name]["summary"].get(k) for k in TASKS[args.task][1]},
            ends=found[name]["summary"]["ends"],
        )
    means = references(args.task) if args.alone else {}
    means |= {name: found[name]["summary"][HEADLINE]["mean"] for name in agents}
    for name in trained:
        found[name]["relative"] = relative(means[name], means[baseline], means["planner"])
        log(agent=name, relative=found[name]["relative"])
    write_csv(args.out / "episodes.csv", [r.to_row() for r in results])
    return {"task": args.task, "seed": args.seed, "agents": found}


# Tables.


def add(result: pathlib.Path, path: pathlib.Path = SCORES) -> None:
    """Writes the rows of a result; those of its task, agents and seed are replaced."""
    from urbanverse_mjx.evaluation.report import write_csv

    body = v.read_json(result, "result")
    kept: list[dict[str, Any]] = [*_rows(path)] if path.is_file() else []
    seeds = {name: str(body["seed"]) if agent["steps"] else "" for name, agent in body["agents"].items()}
    kept = [r for r in kept if not (r["task"] == body["task"] and seeds.get(r["agent"]) == r["seed"])]
    for name, agent in body["agents"].items():
        about = {"task": body["task"], "agent": name, "seed": seeds[name], "steps": agent["steps"] or ""}
        about["episodes"] = agent["summary"]["n"]
        for metric in TASKS[body["task"]][1]:
            values = agent["summary"].get(metric) or {"mean": "", "low": "", "high": ""}
            kept.append({**about, "metric": metric, **{k: "" if values[k] is None else values[k] for k in COLUMNS[6:]}})
    order = list(TASKS)
    kept.sort(key=lambda r: (order.index(r["task"]), r["seed"] != "", str(r["seed"])))
    write_csv(path, [{k: r[k] for k in COLUMNS} for r in kept])


def table(task: str, rows: Sequence[Mapping[str, str]]) -> str:
    """The table of a task: a line for each agent and seed, with intervals, and where it is between the references."""
    metrics = TASKS[task][1]
    agents: dict[tuple[str, str], dict[str, Mapping[str, str]]] = {}
    for row in rows:
        if row["task"] == task:
            agents.setdefault((row["agent"], row["seed"]), {})[row["metric"]] = row
    references = {agent: float(own[HEADLINE]["mean"]) for (agent, seed), own in agents.items() if not seed}
    ceiling = references.pop("planner")
    (baseline,) = references.values()
    lines = []
    for (agent, seed), own in agents.items():
        some = next(iter(own.values()))
        name = agent if not seed else f"{agent}, seed {seed}, {int(some['steps']):,} steps"
        between = relative(float(own[HEADLINE]["mean"]), baseline, ceiling) if seed else None
        cells = [_cell(own[m], digits) if m in own else "-" for m, (_, digits) in metrics.items()]
        lines.append([name, *cells, some["episodes"], "-" if between is None else f"{between:.2f}"])
    return markdown(["agent", *(title for title, _ in metrics.values()), "episodes", "relative"], lines)


def _cell(row: Mapping[str, str], digits: int) -> str:
    if row["mean"] == "":
        return "-"
    text = f"{float(row['mean']):.{digits}f}"
    if row["low"] == "":
        return text
    return f"{text} [{float(row['low']):.{digits}f}, {float(row['high']):.{digits}f}]"


def write_pages(path: pathlib.Path = SCORES, pages: pathlib.Path = PAGES) -> None:
    """Writes the tables of all tasks with scores into their pages."""
    from benchmarks import results

    rows = _rows(path)
    for task, (name, _) in TASKS.items():
        if any(row["task"] == task for row in rows):
            page = pages / name
            text = results.with_table(page.read_text(encoding="utf-8"), table(task, rows), MARKS)
            page.write_text(text, encoding="utf-8")


# Command line.


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(
        prog="python -m benchmarks.tasks", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    cli.add_argument("--task", choices=list(TASKS), help="environment")
    cli.add_argument("--out", type=pathlib.Path)
    cli.add_argument(
        "--train", nargs="+", type=pathlib.Path, default=[], help="banks to train on; default: no training"
    )
    default = settings.cache_dir("library", "validation", "bank.npz")
    cli.add_argument("--test", type=pathlib.Path, default=default, help="bank of other streets; default: validation")
    cli.add_argument("--train-scenes", type=int, help="only the first ones of each bank to train on; default: all")
    cli.add_argument("--alone", action="store_true", help="do not drive baseline and planner again")
    cli.add_argument("--camera", action="store_true", help="train a student with a camera, too")
    cli.add_argument("--teacher", type=pathlib.Path, help="without --train: policy folder of a teacher to score")
    cli.add_argument("--student", type=pathlib.Path, help="the same of a policy with a camera")
    cli.add_argument("--steps", type=int, default=20_000_000, help="env-steps of the teacher")
    cli.add_argument("--num-envs", type=int, default=4096)
    cli.add_argument("--episodes", type=int, default=256, help="number of episodes of each agent")
    cli.add_argument("--at-once", type=int, default=256, help="episodes that are driven in parallel")
    cli.add_argument("--impl", default="auto")
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as ctrl_dt=0.1")
    cli.add_argument("--train-env", type=option, nargs="*", default=[], help="those of the training alone, after --env")
    cli.add_argument(
        "--set", type=option, nargs="*", default=[], help="training options, such as teacher.learning_rate=0.001"
    )
    cli.add_argument("--add", type=pathlib.Path, metavar="RESULT", help="add a result.json to benchmarks/scores")
    cli.add_argument("--page", action="store_true", help="write the tables into docs/tasks")
    args = cli.parse_args(argv)
    if args.add is None and not args.page and (args.task is None or args.out is None):
        cli.error("found neither --task and --out nor --add or --page, needed one of them.")
    if args.alone and not driven_references(args.task):
        cli.error(f"--alone: found no scores of {args.task}'s baseline and planner in {SCORES.name}, needed them.")
    return args


def main(argv: Sequence[str] | None = None) -> int:
    args = arguments(argv)
    if args.add is not None:
        add(args.add)
    elif args.page:
        write_pages()
    else:
        from benchmarks.lib.unseen import begin, save_result

        log = begin(args.out)
        save_result(args.out, measure(args, log))
    return 0


if __name__ == "__main__":
    sys.exit(main())
