"""Behaviour cloning from recorded demonstrations of the planner, and PPO from there, against PPO alone.

    python -m benchmarks.imitation record --train procedural/bank.npz places/bank.npz --holdout 8 9 \
        --demonstrations 1000 --seed 0 --out runs/recorded-0
    python -m benchmarks.imitation clone --recorded runs/recorded-0 --demonstrations 100 ... \
        --test validation/bank.npz --out runs/imitation-100-0
    python -m benchmarks.imitation ppo --start runs/imitation-100-0 ... --out runs/imitation-100-ppo-0
    python -m benchmarks.campaign --out OUT --gpus 2 --rows "imitation-*"
    python -m benchmarks.campaign --out OUT --add

`record` records with `urbanverse record` so many episodes in which the planner reaches its goal on the streets to train
on; the campaign runs it on the processor, because XLA compiles the planner with a recording for minutes on a GPU.
`clone` fits the student of the preset `best` to the first of them. `ppo` trains the same network by PPO: from the
policy of a folder of `clone`, or from random weights. `--samples` counts the env-steps of a row, those of its
demonstrations included, so every row of PPO has equally many. Both of these score the final parameters on the
validation streets, also with the camera covered, and write result.json; killed and started again all three go on.
"""

import argparse
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from benchmarks.lib.options import option, parsed_options
from benchmarks.lib.unseen import Log, Streets, begin, brief, load, save_result, steps_of
from urbanverse_mjx.datatypes import validation as v

if TYPE_CHECKING:
    from ml_collections import ConfigDict

ENVIRONMENT, PRESET = "CocoNav", "best"
#: Numbers of demonstrations of the table.
COUNTS = (10, 100, 1000)
#: Name in the campaign -> whether the demonstrations have noise, options of `clone`, and its name in the table.
VARIANTS = {
    "plain": (False, ("--last-action",), "without noise, sees its last action"),
    "noise": (True, ("--last-action",), "sees its last action"),
    "blind": (False, (), "without noise"),
}
#: Of PPO from random weights, whose actions must differ more than those of a student that drives already.
ALONE = ("noise=0.5", "learning_rate=0.0003", "critic_only=0")
DEMONSTRATIONS, DRIVEN, TRAINING = "demonstrations", "driven.json", "training"


def environment(args: argparse.Namespace, streets: Streets) -> Any:
    """The student's environment on the streets to train on."""
    from urbanverse_mjx.envs import registry

    overrides = {"preset": PRESET, "impl": args.impl, "scenes": ",".join(streets.train), **parsed_options(args.env)}
    return registry.load(ENVIRONMENT, config_overrides=overrides, bank=streets.bank)


def record(args: argparse.Namespace, streets: Streets, env: Any, log: Log) -> dict[str, int]:
    """Records demonstrations until there are as many successes as asked for; returns their episodes and frames, and
    the number of episodes that were driven."""
    from urbanverse_mjx import pipeline
    from urbanverse_mjx.pipeline.recording.action_noise import ActionNoise

    folder, file, wanted = args.out / DEMONSTRATIONS, args.out / DRIVEN, args.demonstrations
    chosen = ",".join(streets.train)
    overrides = {"impl": args.impl, "scenes": chosen, **parsed_options(args.env)}
    height, width, _ = env.observation_size["pixels/front"]
    driven = v.read_json(file, "driven episodes")["episodes"] if file.is_file() else wanted
    while True:
        v.write_json(file, {"episodes": driven})  # a smaller number would not continue this recording
        options = pipeline.RecordOptions(
            policy="planner",
            num_episodes=driven,
            preset=PRESET,
            scenes=chosen,
            env_overrides=overrides,
            num_envs=min(args.record_envs, wanted),
            size=(int(height), int(width)),
            only_successes=True,
            noise=ActionNoise(args.noise, args.noise_seconds),
            resume=True,
            seed=args.seed,
            quiet=True,
        )
        said = pipeline.record(folder, options, bank=streets.bank)
        log(driven=driven, **{k: said[k] for k in ("episodes", "frames", "seconds")})
        missing = wanted - said["episodes"]
        if missing <= 0:
            return {"episodes": said["episodes"], "frames": said["frames"], "driven": driven}
        driven += missing


def cloning(args: argparse.Namespace) -> "ConfigDict":
    """The config of `clone`."""
    from urbanverse_mjx.training.cloning import cloning_config
    from urbanverse_mjx.training.config import default_ppo_config

    config = cloning_config(default_ppo_config(PRESET))
    config.update({"num_envs": args.readers, "num_timesteps": args.cloning_steps, "num_checkpoints": 1})
    config.update({"epochs": 1, "seed": args.seed, "demonstrations": str(args.recorded / DEMONSTRATIONS)})
    config.network.last_action = args.last_action
    config.update_from_flattened_dict(parsed_options(args.set))
    return config


def ppo(args: argparse.Namespace, start: pathlib.Path | None, recorded: int) -> "ConfigDict":
    """The config of `ppo`.

    Args:
      start: the policy whose network goes on; None for random weights.
      recorded: env-steps of its demonstrations.
    """
    from ml_collections import ConfigDict

    from urbanverse_mjx.training.config import default_ppo_config
    from urbanverse_mjx.training.policy import PolicySpec

    config = ConfigDict(default_ppo_config("tune").to_dict())
    config.update({"num_envs": args.num_envs, "seed": args.seed, "num_checkpoints": 4})
    config.network.last_action = args.last_action
    if start is not None:
        config.network = ConfigDict(PolicySpec.load(start).ppo_config["network"])
    config.finetune.update_from_flattened_dict(parsed_options(args.set))
    each = args.num_envs * int(config.finetune.unroll_length)
    config.num_timesteps = (args.samples - recorded) // each * each
    if config.num_timesteps <= 0:
        needed = f"more than the {recorded:,} of the demonstrations and an iteration of {each:,}"
        raise v.fail("--samples", f"{args.samples:,}", needed)
    return config


def fitted(
    env: Any, config: "ConfigDict", folder: pathlib.Path, learner: Any, start: pathlib.Path | None = None
) -> pathlib.Path:
    """Trains in a run folder, or goes on with it; returns the final policy."""
    from urbanverse_mjx.training import iterative
    from urbanverse_mjx.training.imitation import fit
    from urbanverse_mjx.training.policy import latest_policy, load_compatible_student
    from urbanverse_mjx.training.run_folder import at_work

    student = None if start is None else load_compatible_student(start, env, config)
    each = learner.steps_per_iteration
    if steps_of(folder) < max(int(config.num_timesteps) // each, 1) * each:
        begun = iterative.begun(folder)
        folder.mkdir(parents=True, exist_ok=True)
        with at_work(folder):
            begin = learner.begin if student is None else lambda: learner.begin(student)
            fit(ENVIRONMENT, env, config, folder, learner, begun, quiet=True, begin=begin, start_from=start)
    return latest_policy(folder / "checkpoints")


def clone(args: argparse.Namespace, env: Any) -> tuple[pathlib.Path, dict[str, Any]]:
    """Clones the first recorded episodes; returns the policy, and what result.json says of it."""
    from urbanverse_mjx.pipeline.demonstrations import load_demonstrations
    from urbanverse_mjx.training.cloning import Cloning

    recorded = v.read_json(args.recorded / "result.json", "result of `record`")
    data, config = load_demonstrations(args.recorded / DEMONSTRATIONS, env, args.demonstrations), cloning(args)
    policy = fitted(env, config, args.out / TRAINING, Cloning(data, config))
    frames = len(data.begins)
    about = {"last_action": args.last_action, "cloning_steps": int(config.num_timesteps), "noise": recorded["noise"]}
    return policy, {"steps": frames, DEMONSTRATIONS: {"episodes": args.demonstrations, "frames": frames}, **about}


def tune(args: argparse.Namespace, env: Any) -> tuple[pathlib.Path, dict[str, Any]]:
    """Trains by PPO; returns the policy, and what result.json says of it."""
    from urbanverse_mjx.envs import wrap_for_training
    from urbanverse_mjx.training.finetune import Finetune
    from urbanverse_mjx.training.policy import latest_policy
    from urbanverse_mjx.training.tuning import no_labels

    start, recorded = None, {"episodes": 0, "frames": 0}
    if args.start is not None:
        start = latest_policy(args.start / TRAINING / "checkpoints")
        recorded = v.read_json(args.start / "result.json", "result of `clone`")[DEMONSTRATIONS]
    config = ppo(args, start, recorded["frames"])
    own = config.finetune.copy_and_resolve_references().unlock()
    own.num_envs, own.seed = int(config.num_envs), int(config.seed)
    learner = Finetune(wrap_for_training(env, env.config.episode_length), no_labels(env.action_size), config, own)
    policy = fitted(env, config, args.out / TRAINING, learner, start)
    return policy, {"steps": recorded["frames"] + int(config.num_timesteps), DEMONSTRATIONS: recorded}


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("role", choices=("record", "clone", "ppo"))
    cli.add_argument("--train", nargs="+", type=pathlib.Path, required=True, help="banks to train on")
    cli.add_argument("--holdout", nargs="+", type=int, default=[0], help="last scenes of each that are validation's")
    cli.add_argument("--train-scenes", type=int, help="only the first ones of each bank to train on; default: all")
    cli.add_argument("--test", nargs="*", type=pathlib.Path, default=[], help="banks to drive, such as validation's")
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--recorded", type=pathlib.Path, help="the folder of `record` whose first episodes are cloned")
    cli.add_argument("--demonstrations", type=int, default=100, help="episodes that reach their goal")
    cli.add_argument("--noise", type=float, default=0.2, help="on the planner's actions, see urbanverse record")
    cli.add_argument("--noise-seconds", type=float, default=0.5)
    cli.add_argument("--last-action", action="store_true", help="the student sees the action before")
    cli.add_argument("--record-envs", type=int, default=512, help="episodes that are driven at the same time")
    cli.add_argument("--cloning-steps", type=int, default=4_000_000, help="recorded steps to fit to, read repeatedly")
    cli.add_argument("--readers", type=int, default=256, help="sequences of an iteration of cloning")
    cli.add_argument("--start", type=pathlib.Path, help="a folder of `clone` from which PPO goes on")
    cli.add_argument("--samples", type=int, default=8_000_000, help="env-steps, with those of the demonstrations")
    cli.add_argument("--num-envs", type=int, default=4096, help="of PPO")
    cli.add_argument("--episodes", type=int, default=256, help="of each set of validation streets")
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as num_slots=8")
    cli.add_argument(
        "--set", type=option, nargs="*", default=[], help="options of the cloning, or of PPO, such as noise=0.5"
    )
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--impl", default="auto")
    args = cli.parse_args(argv)
    if args.demonstrations < 1:
        cli.error(f"--demonstrations: found {args.demonstrations}, needed at least 1")
    if args.role == "clone" and args.recorded is None:
        cli.error("clone: found no --recorded, needed a folder of `record`")
    return args


def main(argv: Sequence[str] | None = None) -> int:
    from urbanverse_mjx.evaluation import blank_image
    from urbanverse_mjx.training.policy import load_policy

    args = arguments(argv)
    args.out = args.out.absolute()
    log = begin(args.out)
    streets = load(args.train, args.test, args.holdout, args.episodes, log, args.train_scenes)
    env = environment(args, streets)
    if args.role == "record":
        found = record(args, streets, env, log)
        save_result(args.out, {DEMONSTRATIONS: found, "noise": args.noise})
        print(json.dumps(found))
        return 0
    streets.suite.check(env)
    policy, result = clone(args, env) if args.role == "clone" else tune(args, env)
    log(policy=policy.name, **{k: x for k, x in result.items() if k != DEMONSTRATIONS})
    agent = load_policy(policy)[0]
    for name, driver in (("student", agent), ("covered", blank_image(agent))):
        result[name] = streets.suite.score(env, name, driver)
        log(**{name: {k: brief(x) for k, x in result[name].items()}})
    save_result(args.out, result)
    print(json.dumps({k: x for k, x in result.items() if k not in ("student", "covered")}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
