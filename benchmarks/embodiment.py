"""One policy for many robots, told their size and dynamics, against policies of single robots.

    python -m benchmarks.embodiment train --robots husky mir hunter --train procedural/bank.npz --out runs/shared
    python -m benchmarks.embodiment train --robots husky mir hunter --not-told ... --out runs/untold
    python -m benchmarks.embodiment train --robots husky --train procedural/bank.npz --out runs/husky
    python -m benchmarks.embodiment score --robot husky --shared runs/shared --untold runs/untold --own runs/husky \
        --test validation/bank.npz --out runs/score-husky
    python -m benchmarks.campaign --out OUT --gpus 2 --gpu-memory 130 --rows "embodiment-*" --seeds 0
    python -m benchmarks.embodiment --add runs/score-husky/result.json
    python -m benchmarks.embodiment --page

`train` trains one privileged policy (no camera) on all robots named, with equally many env-steps of each
(`training.shared_ppo`); with one robot it is a policy of that robot. With `--not-told` it is not told which robot it
drives. Killed and started again, it goes on. `score` drives go_to_goal and the policies with one robot on evenly spaced
episodes of the bank to test on, the same for every robot and agent, without randomisation; with `--planner` the planner
with full knowledge too, which takes minutes to build. Both write log.jsonl and result.json to `--out`. `--add` writes
the rows of a result of `score` into benchmarks/scores/embodiment.csv, and `--page` those rows into docs/robots.md.
"""

import argparse
import csv
import json
import pathlib
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from benchmarks import results, robots
from benchmarks.lib.options import option, parsed_options
from benchmarks.lib.tables import markdown
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.robots import catalogue

if TYPE_CHECKING:
    from benchmarks.lib.unseen import Log
    from urbanverse_mjx.envs import NavEnv

#: Robots of the shared policy, and others with which it is only driven: skid steering, differential, Ackermann.
TRAINED = (
    *("coco", "husky", "jackal", "panther", "courier", "tracked", "hunter", "racecar", "mir", "dingo", "rmp", "vogui"),
    *("whill", "kickscooter"),
)
HELD_OUT = ("scout", "pmb2", "mobility")
#: Agent -> head of its column. `planner` stands where it was driven in the same episodes.
AGENTS = {
    "go_to_goal": "go_to_goal",
    "own": "own policy",
    "shared": "shared, told",
    "untold": "shared, not told",
}
PLANNER = "planner"
#: Policies that have a seed, with the option that names their folder.
POLICIES = ("shared", "untold", "own")
SCORES = pathlib.Path(__file__).with_name("scores") / "embodiment.csv"
PAGE = pathlib.Path(__file__).parents[1] / "docs" / "robots.md"
MARKS = "<!-- embodiment: python -m benchmarks.embodiment --page -->", "<!-- end of embodiment -->"
ENDS = ("goal", "hit", "off_traversable", "fall", "timeout", "non_finite")
COLUMNS = ("robot", "agent", "seed", "steps", "episodes", *ENDS, "RC")
TRAINING, PRESET = "training", "fast"
NOT_RUN = "Not run yet."


def environment_of(robot: str) -> tuple[str, dict[str, Any]]:
    """Name of a robot's environment, and the overrides that make it that robot's."""
    found = robots.OTHERS.get(robot)
    return found if found is not None else (catalogue.environment_name(robot), {})


def make_env(robot: str, bank: SceneBank, scenes: Sequence[str], impl: str, options: Mapping[str, Any]) -> "NavEnv":
    """The environment of a robot without camera, whose policy is told the robot."""
    from urbanverse_mjx.envs import registry

    name, own = environment_of(robot)
    config = registry.get_default_config(name, PRESET)
    given = {"impl": impl, "scenes": ",".join(scenes), "vision": False, "observations.robot": True}
    return registry.load_nav_env(name, registry.with_overrides(config, {**given, **own, **options}), bank)


def make_envs(args: argparse.Namespace, log: "Log") -> list["NavEnv"]:
    """The environments of all robots, on the first scenes of the banks to train on."""
    import concurrent.futures

    from benchmarks.lib.banks import first_scenes, joined

    banks = [SceneBank.load(path) for path in args.train]
    if args.train_scenes is not None:
        banks = [first_scenes(bank, min(args.train_scenes, bank.num_scenes)) for bank in banks]
    bank = joined(banks)
    log(loaded=bank.num_scenes)

    def make(robot: str) -> "NavEnv":
        env = make_env(robot, bank, bank.scene_ids, args.impl, parsed_options(args.env))
        log(made=robot)
        return env

    # The first one alone makes what all engines share.
    first = make(args.robots[0])
    with concurrent.futures.ThreadPoolExecutor(args.threads) as pool:
        return [first, *pool.map(make, args.robots[1:])]


def train(args: argparse.Namespace, log: "Log") -> dict[str, Any]:
    """Trains, or goes on; returns what result.json says of it."""
    from benchmarks.lib.unseen import steps_of
    from urbanverse_mjx.training import iterative
    from urbanverse_mjx.training.run_folder import at_work
    from urbanverse_mjx.training.shared_ppo import shared_ppo_config, train_shared

    config = shared_ppo_config(args.robots, not args.not_told)
    each = len(args.robots) * args.num_envs * int(config.unroll_length)
    config.update({"num_envs": args.num_envs, "seed": args.seed, "num_checkpoints": args.checkpoints})
    config.update_from_flattened_dict(parsed_options(args.set))
    config.num_timesteps = len(args.robots) * args.steps
    folder = args.out / TRAINING
    if steps_of(folder) < max(int(config.num_timesteps) // each, 1) * each:
        begun = iterative.begun(folder)
        envs = make_envs(args, log)
        folder.mkdir(parents=True, exist_ok=True)
        with at_work(folder):
            found = train_shared(
                environment_of(args.robots[0])[0], envs, config, folder, begun, quiet=True, threads=args.threads
            )
        log(steps=found.steps, seconds=round(found.seconds, 1), steps_per_second=round(found.steps_per_second))
    return {"robots": list(args.robots), "told": not args.not_told, "seed": args.seed, "steps": steps_of(folder)}


def score(args: argparse.Namespace, log: "Log") -> dict[str, Any]:
    """Drives all agents with a robot; returns what result.json says of it."""
    from urbanverse_mjx.envs.navigation.draws import OFF
    from urbanverse_mjx.evaluation import BASELINES, result_counts
    from urbanverse_mjx.evaluation.held_out import Suite
    from urbanverse_mjx.evaluation.planner import Planner
    from urbanverse_mjx.evaluation.rollouts import Rollout
    from urbanverse_mjx.training.policy import PolicySpec, latest_policy, load_policy

    bank = SceneBank.load(args.test)
    env = make_env(args.robot, bank, bank.scene_ids, args.impl, {**parsed_options(args.env), "randomization": OFF})
    episodes = Suite.of(bank, {"test": list(bank.scene_ids)}, args.episodes, []).episodes["test"]
    agents: dict[str, Any] = {"go_to_goal": BASELINES["go_to_goal"]}
    about: dict[str, dict[str, Any]] = {"go_to_goal": {}}
    for name, folder in policies_of(args).items():
        policy = latest_policy(folder / TRAINING / "checkpoints")
        agents[name] = load_policy(policy)[0]
        said = PolicySpec.load(policy)
        about[name] = {"seed": int(said.ppo_config["seed"]), "steps": said.steps, "robots": said.ppo_config["robots"]}
    if args.planner:
        agents[PLANNER], about[PLANNER] = Planner(env), {}
    log(robot=args.robot, agents=list(agents), episodes=len(episodes))
    driven, _ = Rollout(env).run(agents, episodes)
    found: dict[str, Any] = {}
    for name in agents:
        own = [result for result in driven if result.agent == name]
        completion = sum(result.route_completion for result in own) / len(own)
        found[name] = {**about[name], "episodes": len(own), "ends": result_counts(own), "RC": round(completion, 4)}
        log(agent=name, **found[name]["ends"])
    return {"robot": args.robot, "agents": found}


def policies_of(args: argparse.Namespace) -> dict[str, pathlib.Path]:
    """Agent -> folder of `train`, of the command line."""
    return {name: getattr(args, name) for name in POLICIES if getattr(args, name) is not None}


# Tables.


def add(result: pathlib.Path, path: pathlib.Path = SCORES) -> None:
    """Writes the rows of a result of `score`; those of its robot, agents and seeds are replaced."""
    body = v.read_json(result, "result")
    for agent, found in body["agents"].items():
        about = {"robot": body["robot"], "agent": agent, "seed": found.get("seed", "")}
        ends = {end: found["ends"].get(end, 0) for end in ENDS}
        row = {**about, "steps": found.get("steps", ""), "episodes": found["episodes"], **ends, "RC": found["RC"]}
        results.replace_rows(path, about, [row])


class Tally:
    """Successes of an agent with a robot, over all seeds."""

    def __init__(self) -> None:
        self.won = self.episodes = 0

    @property
    def rate(self) -> float:
        """Success rate in [0, 1]."""
        return self.won / self.episodes

    def text(self) -> str:
        """Percent with Wilson's 95 % interval."""
        from urbanverse_mjx.evaluation.metrics import wilson_interval

        low, high = wilson_interval(self.won, self.episodes)
        return f"{100 * self.rate:.0f} [{100 * low:.0f}, {100 * high:.0f}]"


def tallies(path: pathlib.Path = SCORES) -> dict[str, dict[str, Tally]]:
    """Robot -> agent -> successes. The planner's are those of benchmarks/scores/robots.csv where it did not drive
    these episodes."""
    found: dict[str, dict[str, Tally]] = {}
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            tally = found.setdefault(row["robot"], {}).setdefault(row["agent"], Tally())
            tally.won += int(row["goal"])
            tally.episodes += int(row["episodes"])
    for robot, measured in robots.kept().items():
        planned = measured.get("planner")
        if robot in found and planned and PLANNER not in found[robot]:
            tally = found[robot][PLANNER] = Tally()
            tally.won, tally.episodes = int(planned["ends"].get("goal", 0)), int(planned["episodes"])
    return found


def halfway(found: Mapping[str, Tally], agent: str) -> bool | None:
    """Whether an agent is at least halfway from go_to_goal to the planner; None where one of them is missing."""
    if not {agent, "go_to_goal", PLANNER} <= set(found):
        return None
    return 2.0 * found[agent].rate >= found["go_to_goal"].rate + found[PLANNER].rate


def table(found: Mapping[str, Mapping[str, Tally]]) -> str:
    """Markdown: success rates by robot and agent, their means, and how many robots a policy drives."""
    if not found:
        return NOT_RUN
    head = ["robot", *AGENTS.values(), PLANNER]
    columns = (*AGENTS, PLANNER)
    lines, said = [], []
    for title, names in (("in the training", TRAINED), ("held out", HELD_OUT)):
        own = [name for name in names if name in found]
        for name in own:
            cells = [found[name][agent].text() if agent in found[name] else "" for agent in columns]
            lines.append([f"`{name}`" if title == "in the training" else f"`{name}`, held out", *cells])
        means = []
        for agent in columns:
            rates = [found[name][agent].rate for name in own if agent in found[name]]
            means.append(f"{100 * sum(rates) / len(rates):.1f}" if own and len(rates) == len(own) else "")
        if own:
            lines.append([f"mean of {len(own)} {title}", *means])
        for agent in ("shared", "untold", "own"):
            judged = [reached for name in own if (reached := halfway(found[name], agent)) is not None]
            if judged:
                said.append(f"* {AGENTS[agent]}: {sum(judged)} of {len(judged)} robots {title}")
    text = markdown(head, lines)
    if said:
        text += "\n\nAt least halfway from go_to_goal to the planner:\n\n" + "\n".join(said)
    return text


def write_page(path: pathlib.Path = SCORES, page: pathlib.Path = PAGE) -> None:
    """Writes the table of docs/robots.md."""
    text = results.with_table(page.read_text(encoding="utf-8"), table(tallies(path)), MARKS)
    page.write_text(text, encoding="utf-8")


# Command line.


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(
        prog="python -m benchmarks.embodiment",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    cli.add_argument("role", nargs="?", choices=("train", "score"))
    cli.add_argument("--out", type=pathlib.Path)
    cli.add_argument("--robots", nargs="+", default=list(TRAINED), help="to train on; default: all but those held out")
    cli.add_argument("--not-told", action="store_true", help="the policy is not told which robot it drives")
    cli.add_argument("--train", nargs="+", type=pathlib.Path, default=[], help="banks to train on")
    cli.add_argument("--train-scenes", type=int, help="only the first ones of each bank to train on; default: all")
    cli.add_argument("--steps", type=int, default=1_400_000, help="env-steps of each robot")
    cli.add_argument("--num-envs", type=int, default=1024, help="of each robot")
    cli.add_argument("--checkpoints", type=int, default=2)
    cli.add_argument("--threads", type=int, default=settings.num_threads(), help="robots that are compiled at once")
    cli.add_argument("--robot", help="of `score`")
    for name in POLICIES:
        cli.add_argument(f"--{name}", type=pathlib.Path, help="of `score`: folder of `train`")
    cli.add_argument("--planner", action="store_true", help="`score` drives the planner, too")
    default = settings.cache_dir("library", "validation", "bank.npz")
    cli.add_argument("--test", type=pathlib.Path, default=default, help="bank of other streets; default: validation")
    cli.add_argument("--episodes", type=int, default=128, help="number of episodes of each agent")
    cli.add_argument("--impl", default="auto")
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as ctrl_dt=0.1")
    cli.add_argument("--set", type=option, nargs="*", default=[], help="training options, such as minibatches=4")
    cli.add_argument("--add", type=pathlib.Path, metavar="RESULT", help="add a result.json to benchmarks/scores")
    cli.add_argument("--page", action="store_true", help="write the table into docs/robots.md")
    args = cli.parse_args(argv)
    if args.add is not None or args.page:
        return args
    if args.role is None or args.out is None:
        cli.error("found neither a role and --out nor --add or --page, needed one of them.")
    if args.role == "train" and not args.train:
        cli.error("train: found no --train, needed banks to train on.")
    named = args.robots if args.role == "train" else [args.robot]
    unknown = [name for name in named if name not in (*catalogue.NAMES, *robots.OTHERS)]
    if unknown:
        named_by = "--robots" if args.role == "train" else "--robot"
        known = ", ".join((*robots.OTHERS, *catalogue.NAMES))
        cli.error(f"{named_by}: found {v.show(unknown[0])}, needed names of {known}.")
    return args


def main(argv: Sequence[str] | None = None) -> int:
    args = arguments(argv)
    if args.add is not None:
        add(args.add)
    elif args.page:
        write_page()
    else:
        from benchmarks.lib.unseen import begin, save_result

        args.out = args.out.absolute()
        log = begin(args.out)
        result = train(args, log) if args.role == "train" else score(args, log)
        save_result(args.out, result)
        print(json.dumps({k: x for k, x in result.items() if k != "agents"}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
