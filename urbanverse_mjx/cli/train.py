"""`urbanverse train`: bank, training, evaluation on unseen streets, report and video; the result as one JSON line."""

import dataclasses
import json
import pathlib
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from ._options import json_object

if TYPE_CHECKING:
    from ..training.record import RunRequest


@dataclasses.dataclass(frozen=True)
class TrainArgs:
    """Train a policy with Brax PPO; one that navigates is evaluated on streets it has never seen.

    The last line on stdout is one JSON object: SR, CT, RC (%), DTG (m) with 95 % intervals for each agent.
    """

    env_name: str | None = None
    """Registered environment; default CocoNav."""
    preset: str | None = None
    """cpu (a laptop, the default), fast (a GPU); to navigate also paper and urbansim_v0_1."""
    num_timesteps: int | None = None
    """Env-steps in all; default of the preset."""
    num_envs: int | None = None
    """Parallel envs; default of the preset."""
    seed: int | None = None
    """Of the networks, episodes and the evaluation's draw; default 0."""
    env_overrides: Annotated[str, tyro.conf.arg(name="playground-config-overrides")] = "{}"
    """JSON of flat dotted env config keys, e.g. '{"reward_config.scales.hit": -10}'."""
    ppo_overrides: str = "{}"
    """JSON of flat dotted PPO config keys, e.g. '{"learning_rate": 1e-3}'."""
    logdir: pathlib.Path = pathlib.Path("runs")
    """Where new run folders go."""
    suffix: str = ""
    """Added to a new run folder's name."""
    resume: pathlib.Path | None = None
    """A run folder to go on with after a kill: environment, configs and seed are those of its config.json, and options
    that say otherwise are refused, but for --num-timesteps. Adam's moments and running episodes start anew."""
    start_from: pathlib.Path | None = None
    """A policy or run folder whose networks a new run begins with, e.g. one trained with another robot."""
    num_episodes: int = 100
    """Fixed episodes of the final evaluation; 0 = none."""
    video: bool = True
    """Write an mp4 of a rollout."""
    quiet: bool = False
    """No progress bars."""
    coordinator: str | None = None
    """Training over several hosts: HOST:PORT of process 0; "auto" under Slurm, Open MPI and Kubernetes."""
    num_processes: int | None = None
    """How many processes train together (with --coordinator)."""
    process_id: int | None = None
    """Which of them this is, from 0 (with --coordinator); only process 0 writes and evaluates."""


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse train`."""
    args = tyro.cli(TrainArgs, args=list(argv), prog="urbanverse train")
    print(json.dumps(run(args)))
    return 0


def run(args: TrainArgs) -> dict[str, Any]:
    """Trains and evaluates; returns what is printed."""
    from ..envs import registry
    from ..pipeline import ensure_default_bank, ensure_terrain_bank, evaluation
    from ..training.record import configs_of, resumed_configs
    from ..training.run import join_processes, train

    begin = time.monotonic()
    if args.coordinator is not None:
        join_processes(args.coordinator, args.num_processes, args.process_id)
    request = _request(args)
    if args.resume is None:
        name, config, ppo = configs_of(request)
        folder = args.logdir / _folder_name(name, args)
    else:
        folder = args.resume
        name, config, ppo = resumed_configs(folder, request)
    walks = name.endswith("Joystick")
    bank = ensure_terrain_bank() if walks else ensure_default_bank(quiet=args.quiet)
    _say(f"run folder: {folder}", args)
    env = registry.load(name, config=config, bank=bank)
    built = time.monotonic()
    result = train(name, env, ppo, folder, args.resume is not None, args.quiet, args.start_from)
    trained = time.monotonic()
    _say(f"trained {result.steps:,} steps, {result.steps_per_second:,.0f} env-steps/s", args)
    summary: dict[str, Any] = {}
    # A gait is judged in C MuJoCo: python -m benchmarks.go2_gait.
    if args.num_episodes and result.policy is not None and not walks:
        summary = evaluation.evaluate_policy(
            result.policy, bank, folder / "evaluation", args.num_episodes, ppo.seed, args.video, args.quiet
        )
        _say(f"report: {folder / 'evaluation' / 'report.md'}", args)
    return {
        **summary,
        "environment": name,
        "preset": config.get("preset"),
        "steps": result.steps,
        "env_steps_per_second": round(result.steps_per_second, 1),
        "seconds": {
            "prepare": round(built - begin, 1),
            "train": round(trained - built, 1),
            "evaluate": round(time.monotonic() - trained, 1),
        },
        "folder": str(folder),
    }


def _request(args: TrainArgs) -> "RunRequest":
    from ..training.record import RunRequest

    return RunRequest(
        environment=args.env_name,
        preset=args.preset,
        env_overrides=json_object(args.env_overrides, "--playground-config-overrides"),
        ppo_overrides=json_object(args.ppo_overrides, "--ppo-overrides"),
        num_timesteps=args.num_timesteps,
        num_envs=args.num_envs,
        seed=args.seed,
    )


def _folder_name(environment: str, args: TrainArgs) -> str:
    stamp = time.strftime("%Y%m%d-%H%M%S")
    return f"{environment}-{stamp}" + (f"-{args.suffix}" if args.suffix else "")


def _say(text: str, args: TrainArgs) -> None:
    if not args.quiet:
        print(text, file=sys.stderr, flush=True)
