"""Trains a privileged teacher and a camera student on many streets, and scores both on streets never trained on.

    python -m benchmarks.generalise --banks procedural.npz craftbench.npz --out runs/g --teacher-seconds 300
    python -m benchmarks.generalise --banks ... --out runs/g2 --teacher runs/g/teacher --memory 0

Streets of the first bank are trained on but for the last `--holdout`, which are the validation streets; CraftBench
and AutoBench, where a bank's path names them, are driven at the end. Writes log.jsonl, result.json, the teacher's
policy folder and student.msgpack.
"""

import argparse
import copy
import json
import pathlib
import sys
import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from ml_collections import ConfigDict

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank, bank_join
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.envs.navigation.draws import OFF, Randomization
from urbanverse_mjx.evaluation import benchmark
from urbanverse_mjx.evaluation.frozen import Protocol
from urbanverse_mjx.evaluation.rollouts import EpisodeSet, result_counts
from urbanverse_mjx.evaluation.scores import over_scenes


class TimeUp(Exception):
    """The seconds of a stage are over."""


def log(folder: pathlib.Path, begin: float, **values: Any) -> None:
    """Appends a line to log.jsonl and prints it."""
    line = json.dumps({"t": round(time.monotonic() - begin, 1), **values})
    with (folder / "log.jsonl").open("a", encoding="utf-8") as file:
        file.write(line + "\n")
    print(line, file=sys.stderr, flush=True)


def for_scoring(env: Any, bank: SceneBank) -> Any:
    """The same environment over other episode tables of the same scenes, with everything as the bank describes it."""
    other = copy.copy(env)
    other.bank = bank
    other._randomization = Randomization(ConfigDict(OFF))
    names = ("episode_start", "episode_goal", "episode_waypoints", "episode_num_waypoints")
    other._episodes = {name: jnp.asarray(getattr(bank, name)) for name in names}
    return other


def _one_device_pmap(function: Any, axis_name: Any = None, in_axes: Any = 0, donate_argnums: Any = (), **_: Any) -> Any:
    """`jax.pmap` on one device by jit and vmap: pmap itself cannot take constants as arguments."""
    return jax.jit(jax.vmap(function, in_axes=in_axes, axis_name=axis_name), donate_argnums=donate_argnums)


def make_validation(env: Any, student: Any, episodes: EpisodeSet, chunk: int = 20) -> Any:
    """params -> (share of episodes that arrive, by result) over fixed episodes, compiled once."""
    scenes, rows = jnp.asarray(episodes.scenes), jnp.asarray(episodes.episodes)
    start = jax.jit(lambda: jax.vmap(env.begin_at)(episodes.keys(), scenes, rows))

    @jax.jit
    def drive(params: Any, nav: Any, memory: Any) -> Any:
        def step(carry: Any, _: None) -> Any:
            nav, memory = carry
            obs = jax.vmap(env.observe)(nav)
            seen = {name: x[None] for name, x in obs.items()}
            action, memory, _ = student.apply(params, seen, memory, jnp.zeros((1, len(scenes)), bool))
            new = jax.vmap(lambda n, a: env.advance(n, a)[0])(nav, action[0])
            going = nav.result == 0
            nav = jax.tree.map(
                lambda a, b: (
                    jnp.where(going.reshape(-1, *[1] * (a.ndim - 1)), a, b)
                    if not jnp.issubdtype(a.dtype, jax.dtypes.prng_key)
                    else a
                ),
                new,
                nav,
            )
            return (nav, memory), None

        return jax.lax.scan(step, (nav, memory), None, length=chunk)[0]

    def validate(params: Any) -> dict[str, float]:
        nav, memory = start(), student.first_memory(len(scenes))
        for _ in range(-(-env.config.episode_length // chunk)):
            nav, memory = drive(params, nav, memory)
            if (np.asarray(nav.result) != 0).all():
                break
        result = np.asarray(nav.result)
        return {name: float((result == code).mean()) for name, code in (("success", 1), ("hit", 2), ("timeout", 6))}

    return validate


class Suite:
    """Episodes of the validation streets and of frozen benchmarks, driven side by side.

    Args:
      bank: all scenes. held: ids of the validation streets. count: episodes on them. names: of benchmarks.
    """

    def __init__(self, bank: SceneBank, held: list[str], count: int, names: list[str]) -> None:
        self.bank, self.sets, parts = bank, {"validation": set(held)}, []
        for name in names:
            runs = Protocol.load(settings.protocol_root() / f"{name}.json").on(self.bank, "full")
            self.bank, self.sets[name] = runs.bank, set(runs.scenes)
            parts.append(runs.episodes)
        rows = np.array([bank.scene_ids.index(name) for name in held], np.int32)
        each = -(-count // len(rows))
        places = [np.linspace(0, int(self.bank.num_episodes[r]) - 1, each).round().astype(np.int32) for r in rows]
        self.validation = EpisodeSet(np.repeat(rows, each), np.concatenate(places))
        seeds = np.arange(len(self.validation), dtype=np.uint32)
        parts.append(EpisodeSet(self.validation.scenes, self.validation.episodes, 0, seeds))
        arrays = [np.concatenate([getattr(part, k) for part in parts]) for k in ("scenes", "episodes")]
        self.episodes = EpisodeSet(arrays[0], arrays[1], 0, np.concatenate([part.seeds for part in parts]))

    def score(self, env: Any, name: str, agent: Any) -> dict[str, Any]:
        """The benchmark's table of one agent for each set."""
        count = len(self.episodes)
        results = benchmark.drive(for_scoring(env, self.bank), name, agent, self.episodes, False, count).results
        parts = {k: [r for r in results if r.scene in scenes] for k, scenes in self.sets.items()}
        return {
            k: {"summary": over_scenes(part), "ends": result_counts(part), "by_scene": benchmark.by_scene(part)}
            for k, part in parts.items()
        }


def train_teacher(args: argparse.Namespace, env: Any, out: pathlib.Path, begin: float) -> pathlib.Path:
    """PPO of the camera-less teacher until its seconds are over; returns its newest policy."""
    from urbanverse_mjx.training import run as training
    from urbanverse_mjx.training.config import default_ppo_config
    from urbanverse_mjx.training.policy import latest_policy

    config = default_ppo_config("fast").copy_and_resolve_references().unlock()
    config.num_envs, config.unroll_length = args.num_envs, 32
    config.minibatch = args.num_envs * 32 // 8
    config.num_timesteps = args.teacher_steps
    config.num_checkpoints = args.teacher_checkpoints
    config.discounting = 0.99
    config.seed = args.seed
    config.network = {"map_layers": ((32, 4, 2), (64, 4, 2)) if args.map else (), "hidden": (256, 256, 128)}
    save, limit = training.save_policy, time.monotonic() + args.teacher_seconds

    def limited(*given: Any) -> pathlib.Path:
        path = save(*given)
        log(out, begin, teacher_steps=given[2].steps)
        if time.monotonic() > limit:
            raise TimeUp
        return path

    training.save_policy = limited
    try:
        training.train("CocoNav", env, config, out / "teacher", quiet=True)
    except TimeUp:
        pass
    finally:
        training.save_policy = save
    rows = [json.loads(line) for line in (out / "teacher" / "log.jsonl").read_text().splitlines()]
    for row in rows[:: max(1, len(rows) // 12)] + rows[-1:]:
        chosen = {
            k: row[k] for k in ("step", "seconds", "episode/success", "episode/hit", "steps_per_second") if k in row
        }
        log(out, begin, **chosen)
    return latest_policy(out / "teacher")


def train_student(
    args: argparse.Namespace, env: Any, teach: Any, suite: Suite, begin: float, result: dict[str, Any]
) -> None:
    """DAgger until the student's seconds are over; its parameters and scores go to `args.out`."""
    from flax import serialization

    from urbanverse_mjx.training import dagger
    from urbanverse_mjx.training.policy import PolicySpec, save_student
    from urbanverse_mjx.training.student import StudentPolicy

    out = args.out
    log(out, begin, environment="student")
    config = dagger.default_dagger_config()
    config.num_envs, config.seed, config.network.memory = args.num_envs, args.seed, args.memory
    for text in args.set:
        name, value = text.split("=")
        config.update_from_flattened_dict({name: json.loads(value)})
    learner = dagger.Dagger(wrap_for_training(env, env.config.episode_length), teach, config)
    validate = make_validation(for_scoring(env, suite.bank), learner.student, suite.validation)

    def on_iteration(number: int, state: Any, said: dict[str, float]) -> None:
        if number % 10 == 1 or number < 4:
            log(out, begin, iteration=number, steps=number * learner.steps_per_iteration, **_rounded(said))
        if number % args.validate_every == 0:
            log(out, begin, iteration=number, validation=_rounded(validate(state.params)))
            (out / "student.msgpack").write_bytes(serialization.to_bytes(state.params))

    params = None
    if args.start is not None:
        params = serialization.msgpack_restore(args.start.read_bytes())
    state = dagger.run(learner, args.student_iterations, args.student_seconds, on_iteration, params)
    (out / "student.msgpack").write_bytes(serialization.to_bytes(state.params))
    spec = PolicySpec.of("CocoNav", env, config, int(state.steps) * learner.steps_per_iteration)
    save_student(out / "student", state.params, spec)
    result["steps"] = int(state.steps) * learner.steps_per_iteration
    params = state.params
    del state
    agent = StudentPolicy(learner.student, params)
    result["student"] = suite.score(env, "student", agent)
    log(out, begin, student={k: brief(x) for k, x in result["student"].items()}, steps=result["steps"])
    (out / "result.json").write_text(json.dumps(result))
    log(out, begin, done=True)


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--banks", nargs="+", type=pathlib.Path, required=True)
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--holdout", type=int, default=16)
    cli.add_argument("--teacher", type=pathlib.Path, help="a trained one; waited for until TEACHER/done exists")
    cli.add_argument("--teacher-seconds", type=float, default=300.0)
    cli.add_argument("--teacher-steps", type=int, default=100_000_000)
    cli.add_argument("--teacher-checkpoints", type=int, default=25)
    cli.add_argument("--no-map", dest="map", action="store_false")
    cli.add_argument("--student-seconds", type=float, default=700.0)
    cli.add_argument("--student-iterations", type=int, default=4000)
    cli.add_argument("--validate-every", type=int, default=60)
    cli.add_argument("--start", type=pathlib.Path, help="parameters of a student (student.msgpack) to go on from")
    cli.add_argument("--memory", type=int, default=256)
    cli.add_argument("--num-envs", type=int, default=4096)
    cli.add_argument("--seed", type=int, default=0)
    cli.add_argument("--impl", default="warp")
    cli.add_argument("--size", default="54x96")
    cli.add_argument("--validation-episodes", type=int, default=512)
    cli.add_argument("--set", nargs="*", default=[], help="dagger options, such as mirror=false")
    return cli.parse_args()


def main() -> int:
    args = arguments()
    # Tables of the scenes become arguments of what is compiled, in place of constants of hundreds of MB in it.
    if hasattr(jax.config, "jax_use_simplified_jaxpr_constants"):
        jax.config.update("jax_use_simplified_jaxpr_constants", True)
    jax.pmap = _one_device_pmap  # type: ignore[assignment]
    begin, out, result = time.monotonic(), args.out, {}
    out.mkdir(parents=True, exist_ok=True)
    banks = [SceneBank.load(path) for path in args.banks]
    names = [list(bank.scene_ids) for bank in banks]
    bank = bank_join.join(banks) if len(banks) > 1 else banks[0]
    trained, held = names[0][: -args.holdout], names[0][-args.holdout :]
    log(out, begin, loaded=bank.num_scenes, trained=len(trained), held=len(held))

    height, width = (int(n) for n in args.size.split("x"))
    overrides = {
        "preset": "fast",
        "impl": args.impl,
        "scenes": ",".join(trained),
        "observations.privileged_map": True,
        "observations.proprio": True,
        "vision": False,
        "vision_config.height": height,
        "vision_config.width": width,
    }
    known = [name for name in ("craftbench", "autobench") if any(name in str(path) for path in args.banks[1:])]
    suite = Suite(bank, held, args.validation_episodes, known)

    from urbanverse_mjx.training.policy import latest_policy, load_policy

    env = None
    if args.teacher is None:
        env = registry.load("CocoNav", config_overrides=overrides, bank=bank)
        log(out, begin, environment="teacher")
        folder = train_teacher(args, env, out, begin)
        (out / "teacher" / "done").write_text(str(folder.name))
    else:
        while not (args.teacher / "done").exists():
            time.sleep(1.0)
        folder = latest_policy(args.teacher)
    teach, spec = load_policy(folder)
    log(out, begin, teacher=str(folder), steps=spec.steps)
    if args.teacher is None:
        result["teacher"] = suite.score(env, "teacher", teach)
        log(out, begin, teacher={k: brief(x) for k, x in result["teacher"].items()})
    (out / "result.json").write_text(json.dumps(result))
    del env
    if args.student_seconds <= 0:
        return 0

    env = registry.load("CocoNav", config_overrides={**overrides, "vision": True}, bank=bank)
    train_student(args, env, teach, suite, begin, result)
    return 0


def brief(scores: dict[str, Any]) -> dict[str, Any]:
    """Success rate with its interval, and how episodes ended."""
    rate = scores["summary"]["SR"]
    return {k: round(rate[k], 1) for k in ("mean", "low", "high") if rate.get(k) is not None} | scores["ends"]


def _rounded(values: dict[str, float]) -> dict[str, float]:
    return {name: round(value, 4) for name, value in values.items()}


if __name__ == "__main__":
    sys.exit(main())
