"""Trains a privileged teacher, then a camera student by imitation and PPO, and scores both on unseen streets.

    python -m benchmarks.generalise teacher --train procedural/bank.npz --test craftbench/bank.npz --out runs/teacher
    python -m benchmarks.generalise student --train procedural/bank.npz --test craftbench/bank.npz --out runs/student \
        --teacher runs/teacher

The last `--holdout` streets of each bank to train on are validation streets, as is a bank to test named `validation`;
other banks to test are driven at the end alone, by their frozen protocols. A bank's name is that of its folder. A
student that is started beside its teacher compiles while it waits for it. Writes log.jsonl, result.json and policy
folders to `--out`.
"""

import argparse
import json
import pathlib
import sys
import threading
import time
from typing import Any

import jax
from ml_collections import ConfigDict

from benchmarks.lib.options import option, parsed_options
from benchmarks.lib.unseen import Log, begin, brief, load, named_scenes, save_result, steps_of
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.evaluation import blank_image
from urbanverse_mjx.evaluation.held_out import Suite

SAVED_AS = {"student": "student", "finetune": "finetuned"}
"""Folder in `--out` of a stage's best parameters so far."""


class TimeUp(Exception):
    """Raised when the time of a stage is over."""


def teacher_config(args: argparse.Namespace) -> ConfigDict:
    """Returns the PPO config of the teacher without camera."""
    from urbanverse_mjx.training.config import default_ppo_config

    config = default_ppo_config("fast").copy_and_resolve_references().unlock()
    config.num_envs, config.unroll_length = args.num_envs, 32
    config.minibatch = args.num_envs * 32 // 8
    config.num_timesteps = args.steps or 100_000_000
    config.num_checkpoints = args.checkpoints
    config.discounting = 0.99
    config.seed = args.seed
    config.network = {"map_layers": ((32, 4, 2), (64, 4, 2)) if args.map else (), "hidden": (256, 256, 128)}
    return config


def train_teacher(args: argparse.Namespace, env: Any, log: Log) -> pathlib.Path:
    """Trains with PPO until the time is over; returns the newest policy."""
    from urbanverse_mjx.training import run as training
    from urbanverse_mjx.training.policy import latest_policy

    save, limit = training.save_policy, time.monotonic() + args.seconds

    def limited(*given: Any) -> pathlib.Path:
        path = save(*given)
        log(teacher_steps=given[2].steps)
        if time.monotonic() > limit:
            raise TimeUp
        return path

    training.save_policy = limited
    try:
        training.train(args.environment, env, teacher_config(args), args.out / "training", quiet=True)
    except TimeUp:
        pass
    finally:
        training.save_policy = save
    rows = [json.loads(line) for line in (args.out / "training" / "log.jsonl").read_text().splitlines()]
    for row in rows[:: max(1, len(rows) // 12)] + rows[-1:]:
        log(**{k: row[k] for k in ("step", "seconds", "episode/success", "steps_per_second") if k in row})
    return latest_policy(args.out / "training")


class StudentTraining:
    """Imitation, then PPO; each stage keeps the parameters with the best score on the validation streets."""

    def __init__(self, args: argparse.Namespace, env: Any, suite: Suite, log: Log) -> None:
        from urbanverse_mjx.training import dagger, finetune
        from urbanverse_mjx.training.policy import initial_params, network_factory

        self.args, self.env, self.suite, self.log = args, env, suite, log
        self.dagger_config = dagger.default_dagger_config()
        self.dagger_config.update({"num_envs": args.num_envs, "seed": args.seed})
        self.dagger_config.network.memory = args.memory
        self.finetune_config = finetune.default_finetune_config()
        self.finetune_config.update({"num_envs": args.num_envs, "seed": args.seed + 1})
        for config, options in ((self.dagger_config, args.set), (self.finetune_config, args.set_finetune)):
            config.update_from_flattened_dict(parsed_options(options))
        sizes = {name: tuple(shape) for name, shape in env.observation_size.items()}
        teacher = teacher_config(args)
        from brax.training.agents.ppo import networks as ppo_networks

        make = ppo_networks.make_inference_fn(network_factory(teacher)(sizes, env.action_size))

        def teach(params: Any, state: Any, key: Any) -> Any:
            return make((None, params, None), deterministic=True)(state.obs, key)[0]

        _, actor, _ = initial_params(sizes, env.action_size, teacher, 0)
        wrapped = wrap_for_training(env, env.config.episode_length)
        self.imitation = dagger.Dagger(wrapped, teach, self.dagger_config, actor)
        self.ppo = finetune.Finetune(wrapped, teach, self.dagger_config, self.finetune_config, actor)
        self.validation = [name for name in suite.scenes if name.startswith("validation")]
        self.rates = suite.quick(env, self.imitation.student, self.validation)
        self.steps = 0

    def compile_finetune(self) -> threading.Thread:
        """Compiles the PPO stage in a thread during the imitation."""
        shapes = jax.eval_shape(self.imitation.begin).params

        def work() -> None:
            self.ppo.compile(shapes)
            self.log(compiled="finetune")

        thread = threading.Thread(target=work)
        thread.start()
        return thread

    def stage(self, name: str, learner: Any, state: Any, seconds: float, iterations: int) -> Any:
        """Runs the iterations of a stage; returns the actor's parameters with the best score on the validation
        streets."""
        from urbanverse_mjx.training import sequences

        best: list[Any] = [-1.0, None]
        judged: set[int] = set()

        def validate(number: int, state: Any) -> None:
            if number in judged:
                return
            judged.add(number)
            rates = self.rates(learner.actor(state))
            mean = sum(rates.values()) / len(rates)
            if mean > best[0]:
                best[:] = mean, jax.device_get(learner.actor(state))
                self.save(SAVED_AS[name], best[1], self.steps + number * learner.steps_per_iteration)
            self.log(stage=name, iteration=number, **_rounded(rates), best=round(best[0], 4))

        def on_iteration(number: int, state: Any, reported: dict[str, float]) -> None:
            steps = number * learner.steps_per_iteration
            if number % 10 == 1 or number < 4:
                self.log(stage=name, iteration=number, steps=steps, **_rounded(reported))
            if number % every == 0:
                validate(number, state)

        every = self.args.validate_every if name == "student" else max(self.args.validate_every // 2, 1)
        if name == "finetune":
            validate(0, state)
        state = sequences.run(learner, iterations, seconds, on_iteration, state)
        validate(int(state.steps), state)
        self.steps += int(state.steps) * learner.steps_per_iteration
        return best[1]

    def save(self, name: str, params: Any, steps: int) -> None:
        from urbanverse_mjx.training.policy import PolicySpec, save_student

        said = ConfigDict(self.dagger_config.to_dict() | {"finetune": self.finetune_config.to_dict()})
        config = said if name == SAVED_AS["finetune"] else self.dagger_config
        save_student(self.args.out / name, params, PolicySpec.of(self.args.environment, self.env, config, steps))

    def start(self) -> Any:
        """Returns the parameters of `--start`, or None."""
        from flax import serialization

        from urbanverse_mjx.training.policy import latest_policy, load_student

        path = self.args.start
        if path is None:
            return None
        if path.is_dir():
            return load_student(latest_policy(path))
        return serialization.msgpack_restore(path.read_bytes())

    def wait_for_teacher(self) -> None:
        """Loads the teacher's parameters once its run is done; without a teacher its network stays untrained."""
        from urbanverse_mjx.training.policy import latest_policy, load_params

        if self.args.teacher is None:
            return
        while not (self.args.teacher / "done").exists():
            time.sleep(0.5)
        folder = latest_policy(self.args.teacher / "training")
        self.log(teacher=folder.name)
        actor = jax.tree.map(jax.numpy.asarray, load_params(folder)[1])
        self.imitation.teacher_params = self.ppo.teacher_params = actor

    def run(self) -> dict[str, Any]:
        """Returns the parameters of each stage by name, or the initial ones if no stage has time."""
        args = self.args
        start = best = self.start()
        made: dict[str, Any] = {}
        if args.seconds > 0:
            self.imitation.compile()
            self.log(compiled="imitation")
            self.wait_for_teacher()
            thread = self.compile_finetune() if args.finetune_seconds > 0 else None
            state = self.imitation.begin(start)
            best = self.stage("student", self.imitation, state, args.seconds, args.steps or 100_000)
            del state
            made["student"] = best
            if thread is not None:
                thread.join()
        else:
            self.wait_for_teacher()
        if args.finetune_seconds > 0:
            state = self.ppo.begin(best)
            iterations = args.finetune_steps or 100_000
            made["finetuned"] = self.stage("finetune", self.ppo, state, args.finetune_seconds, iterations)
        return made or {"start": start}


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("role", choices=("teacher", "student"))
    cli.add_argument("--train", nargs="+", type=pathlib.Path, required=True, help="banks to train on")
    cli.add_argument("--test", nargs="*", type=pathlib.Path, default=[], help="banks of frozen benchmarks")
    cli.add_argument("--scenes", nargs="+", help="ids of the scenes to train on; default: all but those held out")
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--environment", default="CocoNav")
    cli.add_argument(
        "--holdout", nargs="+", type=int, default=[16], help="of each bank to train on; 0 where none stands"
    )
    cli.add_argument("--teacher", type=pathlib.Path, help="its --out; waited for until it is done; none: no anchor")
    cli.add_argument("--no-map", dest="map", action="store_false", help="a teacher without the map of its surroundings")
    cli.add_argument("--seconds", type=float, default=300.0, help="of training")
    cli.add_argument("--steps", type=int, help="at most: env-steps of a teacher, iterations of a student")
    cli.add_argument("--checkpoints", type=int, default=25)
    cli.add_argument("--finetune-seconds", type=float, default=0.0, help="of PPO after the imitation")
    cli.add_argument("--finetune-steps", type=int, help="iterations at most")
    cli.add_argument("--validate-every", type=int, default=60, help="iterations")
    cli.add_argument("--validation-episodes", type=int, default=256, help="of each set of validation streets")
    cli.add_argument("--start", type=pathlib.Path, help="a student to go on from: msgpack or policy folder")
    cli.add_argument("--memory", type=int, default=0)
    cli.add_argument("--covered", action="store_true", help="score the last student with its camera covered too")
    cli.add_argument("--num-envs", type=int, default=4096)
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--impl", default="warp")
    cli.add_argument("--size", default="54x96")
    cli.add_argument("--env", type=option, nargs="*", default=[], help="environment options, such as ctrl_dt=0.1")
    cli.add_argument("--set", type=option, nargs="*", default=[], help="options of the imitation, such as mirror=false")
    cli.add_argument("--set-finetune", type=option, nargs="*", default=[], help="options of the PPO after it")
    return cli.parse_args()


def main() -> int:
    args = arguments()
    log = begin(args.out)
    bank, chosen, suite = load(args.train, args.test, args.holdout, args.validation_episodes, log)
    chosen = named_scenes(args.scenes, chosen)
    height, width = (int(n) for n in args.size.split("x"))
    overrides = {
        "preset": "fast",
        "impl": args.impl,
        "scenes": ",".join(chosen),
        "observations.privileged_map": True,
        "observations.proprio": True,
        "vision": args.role == "student",
        "vision_config.height": height,
        "vision_config.width": width,
    }
    overrides |= parsed_options(args.env)
    env = registry.load(args.environment, config_overrides=overrides, bank=bank)
    suite.check(env)
    log(environment=args.role)
    result: dict[str, Any] = {"trained_on": sorted(chosen)}
    if args.role == "teacher":
        from urbanverse_mjx.training.policy import load_policy

        folder = train_teacher(args, env, log)
        (args.out / "done").write_text(folder.name)
        agents = {"teacher": load_policy(folder)[0]}
        result["steps"] = steps_of(args.out / "training")
    else:
        from urbanverse_mjx.training.student import StudentPolicy

        training = StudentTraining(args, env, suite, log)
        agents = {k: StudentPolicy(training.imitation.student, p) for k, p in training.run().items()}
        result["steps"] = training.steps
        if args.covered:
            agents = {"covered": blank_image(list(agents.values())[-1]), **agents}
    for name, agent in reversed(agents.items()):
        result[name] = suite.score(env, name, agent)
        log(**{name: {k: brief(x) for k, x in result[name].items()}})
    save_result(args.out, result)
    log(done=True)
    return 0


def _rounded(values: dict[str, float]) -> dict[str, float]:
    return {name: round(value, 4) for name, value in values.items()}


if __name__ == "__main__":
    sys.exit(main())
