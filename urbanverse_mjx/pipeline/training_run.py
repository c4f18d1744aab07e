"""Runs a training: bank, environment, imitation or PPO, and evaluation on held-out streets."""

import contextlib
import dataclasses
import pathlib
import shlex
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ..terminal import announce

if TYPE_CHECKING:
    from ..datatypes import PlacedBank, SceneBank
    from ..training.record import RunRequest
    from ..training.run import TrainingResult


#: Steps that behaviour cloning reads by default, each of a small dataset many times.
_CLONED_STEPS = 1_000_000


@dataclasses.dataclass(frozen=True)
class TrainOptions:
    """Folder, start, evaluation and processes of a run."""

    logdir: pathlib.Path = pathlib.Path("runs")
    """Parent folder of new run folders."""
    bank: pathlib.Path | None = None
    """Scene bank; default: the shipped streets' (to walk: the terrain), or the one that URBANVERSE_BANK names."""
    suffix: str = ""
    """Suffix of a new run folder's name."""
    resume: pathlib.Path | None = None
    """A run folder to continue: environment, configs and seed are those of its config.json, and other values are an
    error, except for --num-timesteps. Imitation continues bit-equal to an uninterrupted run; with Brax PPO the
    optimizer state is not restored and running episodes begin again."""
    start_from: pathlib.Path | None = None
    """A policy or run folder with the initial networks of a new run, e.g. of another robot. For the preset `best` they
    are those of the student; the preset `tune` needs it."""
    demonstrations: pathlib.Path | None = None
    """A dataset of `urbanverse record` whose actions the policy imitates (behaviour cloning) instead of a teacher's;
    for the presets `quick` and `best`."""
    num_episodes: int = 100
    """Number of fixed episodes of the final evaluation; 0 = none."""
    video: bool = True
    """Write an mp4 of a rollout."""
    coordinator: str | None = None
    """Training over several hosts: HOST:PORT of process 0; "auto" under Slurm, Open MPI and Kubernetes."""
    num_processes: int | None = None
    """Number of processes that train together (with --coordinator)."""
    process_id: int | None = None
    """Index of this process, from 0 (with --coordinator); only process 0 writes and evaluates."""


def train(
    request: "RunRequest | None" = None, options: TrainOptions | None = None, quiet: bool = True
) -> dict[str, Any]:
    """Trains a policy by imitation (presets `quick`, `best`) or Brax PPO; navigation policies are evaluated on unseen
    streets.

    Args:
      request: environment, preset and overrides (`urbanverse_mjx.training.record.RunRequest`); None for the defaults.
      quiet: whether to print no progress on standard error.

    Returns:
      metrics by agent if the policy was evaluated; environment, preset, steps, env_steps_per_second, the seconds of
      each part, and the run's folder.

    Raises:
      ValidationError: a name or key is unknown, or the request differs from the record of the resumed run.
    """
    from ..datatypes import ValidationError
    from ..datatypes import validation as v
    from ..envs import registry
    from ..training.config import check_numbers
    from ..training.record import RunRequest, configs_of, resumed_configs
    from ..training.run import join_processes

    request, options = request or RunRequest(), options or TrainOptions()
    if options.coordinator is not None:
        join_processes(options.coordinator, options.num_processes, options.process_id)
    if options.demonstrations is not None and options.resume is not None:
        raise ValidationError("--demonstrations: found it together with --resume, needed one of them.")
    configs = configs_of(request) if options.resume is None else resumed_configs(options.resume, request)
    if options.demonstrations is not None:
        configs = (*configs[:2], _cloning_config(configs[2], request, options))
    registry.check_numbers(configs[1])
    check_numbers(configs[2])
    v.integer(options.num_episodes, "--num-episodes", 0)
    if "/" in options.suffix or "\0" in options.suffix:
        raise v.fail("--suffix", v.show(options.suffix), "a part of a folder's name", "take another --logdir")
    with _folder(configs[0], options) as folder:
        try:
            return _train(*configs, folder, options, quiet)
        except KeyboardInterrupt:
            announce(_how_to_continue(folder), quiet)
            raise


def _how_to_continue(folder: pathlib.Path) -> str:
    from ..training.policy import FILE

    if any(folder.glob(f"**/checkpoints/**/{FILE}")):
        return f"to continue from the newest checkpoint: urbanverse train --resume {shlex.quote(str(folder))}"
    return f"no checkpoint was written yet: nothing in {folder} can be continued"


@contextlib.contextmanager
def _folder(environment: str, options: TrainOptions) -> Iterator[pathlib.Path]:
    """Context with the run's folder, locked by this process."""
    import jax

    from ..training.run_folder import at_work, new_run

    name = f"{environment}-{time.strftime('%Y%m%d-%H%M%S')}" + (f"-{options.suffix}" if options.suffix else "")
    if jax.process_index() > 0:
        yield options.resume or options.logdir / name
    elif options.resume is None:
        with new_run(options.logdir, name) as folder:
            yield folder
    else:
        with at_work(options.resume):
            yield options.resume


def _train(
    name: str, config: Any, ppo: Any, folder: pathlib.Path, options: TrainOptions, quiet: bool
) -> dict[str, Any]:
    from ..datatypes import ValidationError
    from ..envs import NavEnv, registry, wrap_for_training
    from ..training.devices import Devices
    from .evaluation import evaluate_policy

    begin = time.monotonic()
    imitates, in_stages = ppo.get("algorithm") == "dagger", "teacher" in ppo
    tunes = "finetune" in ppo and not in_stages
    source = ppo.get("demonstrations")
    if imitates and not (in_stages or tunes) and options.start_from is not None:
        raise ValidationError(
            f"preset {config.preset!r}: found --start-from, needed none: it imitates from random weights; take another "
            "preset."
        )
    if (in_stages or source is not None) and options.coordinator is not None:
        what = "--demonstrations" if source is not None else f"preset {config.preset!r}"
        raise ValidationError(f"{what}: found --coordinator, needed none: it trains in one process.")
    if options.start_from is not None and options.resume is not None:
        raise ValidationError("--start-from: found it together with --resume, needed one of them.")
    announce(f"run folder: {folder}", quiet)
    own, bank = _banks(name, config, ppo, options, quiet)
    env = registry.load(name, config=config, bank=own)
    if source is None:
        Devices.every().check_draws(wrap_for_training(env, config.episode_length).learns_episodes)
    if options.num_episodes and isinstance(env, NavEnv) and (bank is None or "test" not in bank.meta["splits"]):
        known = ", ".join(sorted({"train"} if bank is None else set(bank.meta["splits"])))
        raise ValidationError(
            f"--num-episodes: found {options.num_episodes} and a bank with scenes of the split {known} alone, needed "
            "some of the split test for the evaluation at the end; take --num-episodes 0, or add such scenes by "
            "`urbanverse scene join`."
        )
    built = time.monotonic()
    if in_stages:
        result = _teach_and_imitate(name, env, ppo, folder, options, quiet)
    elif tunes:
        with _places(env):
            result = _tune(name, env, bank, ppo, folder, options, quiet)
    elif source is not None:
        result = _clone(name, env, ppo, folder, pathlib.Path(source), options.resume is not None, quiet)
    elif imitates:
        with _places(env):
            result = _imitate(name, env, ppo, folder, options.resume is not None, quiet)
    else:
        from ..training.run import train as run

        result = run(name, env, ppo, folder, options.resume is not None, quiet, options.start_from)
    trained = time.monotonic()
    announce(f"trained {result.steps:,} steps, {result.steps_per_second:,.0f} env-steps/s", quiet)
    summary: dict[str, Any] = {}
    # Other tasks have separate evaluations: gaits are evaluated in C MuJoCo by python -m benchmarks.go2_gait.
    if options.num_episodes and result.policy is not None and isinstance(env, NavEnv) and bank is not None:
        summary = evaluate_policy(
            result.policy, bank, folder / "evaluation", options.num_episodes, ppo.seed, options.video, quiet
        )
        announce(f"report: {folder / 'evaluation' / 'report.md'}", quiet)
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


def _banks(
    name: str, config: Any, ppo: Any, options: TrainOptions, quiet: bool
) -> "tuple[SceneBank, SceneBank | None]":
    """The bank of a training, and the one of validation and evaluation, which is another one where scenes come and go;
    then `config.schedule.exchange_steps` gets its number.

    Raises:
      ValidationError: scenes are to come and go in a training that has no place for it; see also `bank_of` and
        `placed_banks`.
    """
    from ..datatypes import ValidationError
    from ..datatypes import validation as v
    from ..envs.navigation.places import spread_steps

    number = int(config.get("schedule", {}).get("places", 0))
    if not number:
        bank = bank_of(name, quiet, config.get("preset"), options.bank, config.get("scenes", "all"))
        return bank, bank
    what = f"preset {config.get('preset')!r}" if ppo.get("demonstrations") is None else "--demonstrations"
    if ppo.get("algorithm") != "dagger" or "teacher" in ppo or ppo.get("demonstrations") is not None:
        raise ValidationError(
            f"config.schedule.places: found {number} with {what}, needed 0: scenes come and go in trainings of the "
            "presets 'quick' and 'tune'; take one of them, or keep all scenes on the device."
        )
    own, bank = placed_banks(options.bank, config, number)
    if not config.schedule.exchange_steps:
        each = int(ppo.num_envs) * int(ppo.get("finetune", ppo).unroll_length)
        config.schedule.exchange_steps = spread_steps(own, int(ppo.num_timesteps), each)
    ids = v.counted(len(own.rows), "scenes")
    announce(f"{ids} in {number} places, another one every {config.schedule.exchange_steps:,} env-steps", quiet)
    return own, bank


def _places(env: Any) -> "contextlib.AbstractContextManager[object]":
    """What exchanges the scenes of an environment where they come and go."""
    from ..datatypes import PlacedBank
    from ..envs.navigation.places import ScenePlaces

    if not isinstance(env.bank, PlacedBank):
        return contextlib.nullcontext()
    return ScenePlaces(env, int(env.config.schedule.exchange_steps))


def _cloning_config(config: Any, request: "RunRequest", options: TrainOptions) -> Any:
    """Returns the imitation part of a preset's training config, with the dataset's path in it.

    Raises:
      ValidationError: the preset has no student.
    """
    from ..datatypes import ValidationError
    from ..training.cloning import cloning_config

    if config.get("algorithm") != "dagger":
        raise ValidationError(
            "--demonstrations: found a preset that trains by Brax PPO, needed one that trains by imitation: quick or "
            "best."
        )
    assert options.demonstrations is not None
    if "finetune" in config and "teacher" not in config:
        raise ValidationError(
            "--demonstrations: found the preset 'tune', which imitates nothing, needed quick or best."
        )
    own = cloning_config(config)
    own.demonstrations = str(options.demonstrations.absolute())
    # A small dataset is read many times anyway.
    defaults = {"epochs": 1, "num_timesteps": _CLONED_STEPS}
    own.update({k: x for k, x in defaults.items() if k not in request.ppo})
    return own.lock()


def _clone(
    name: str, env: Any, config: Any, folder: pathlib.Path, source: pathlib.Path, resume: bool, quiet: bool
) -> "TrainingResult":
    """Trains a student that imitates recorded episodes."""
    from ..datatypes import validation as v
    from ..training.cloning import Cloning
    from ..training.imitation import fit
    from .demonstrations import load_demonstrations, other_looks

    data = load_demonstrations(source, env)
    if other := other_looks(source, env):
        announce(f"warning: {other}")
    announce(
        f"{v.counted(data.begins.sum(), 'episodes')} with {v.counted(len(data.begins), 'steps')} in {source}", quiet
    )
    return fit(name, env, config, folder, Cloning(data, config), resume, quiet)


def _imitate(name: str, env: Any, config: Any, folder: pathlib.Path, resume: bool, quiet: bool) -> "TrainingResult":
    """Trains a student that imitates `RouteFollower`, which uses the route and the obstacles around the robot."""
    import jax

    from ..evaluation.route_follower import RouteFollower
    from ..training.imitation import distil

    follower = RouteFollower(env)
    return distil(
        name, env, config, folder, lambda _, state, key: jax.vmap(follower.act)(state.data), resume, quiet
    )  # fmt: skip


def _teach_and_imitate(
    name: str, env: Any, config: Any, folder: pathlib.Path, options: TrainOptions, quiet: bool
) -> "TrainingResult":
    """Trains a teacher, a student that imitates it, and fine-tunes by PPO; selects checkpoints on the bank's split
    `validation`."""
    from ..envs import registry
    from ..training.teacher_student import TeacherStudent

    def teacher_env() -> Any:
        return registry.load(name, config=env.config, config_overrides={"vision": False}, bank=env.bank)

    validator = _validator(env, config, quiet)
    training = TeacherStudent(name, env, teacher_env, config, folder.absolute(), validator, options.start_from, quiet)
    return training.train(options.resume is not None, lambda text: announce(text, quiet))


def _tune(
    name: str,
    env: Any,
    bank: "SceneBank | None",
    config: Any,
    folder: pathlib.Path,
    options: TrainOptions,
    quiet: bool,
) -> "TrainingResult":
    """Continues a student's training by PPO on the bank's streets; validates it on those of `bank`."""
    from ..envs import registry
    from ..training.tuning import tune

    resume, judge = options.resume is not None, env
    if bank is not None and bank is not env.bank and env.places is not None:
        # Streets that stay, with an engine and a renderer of their own.
        judge = registry.load(name, config=env.config, config_overrides={"scenes": "all"}, bank=bank)
    validator = _validator(judge, config, quiet)
    result = tune(name, env, config, folder.absolute(), options.start_from, resume, quiet, validator)
    if result.policy is not None and folder.absolute() not in result.policy.parents:
        announce(f"no checkpoint is as good as the initial policy, which is kept: {result.policy}", quiet)
    return result


def _validator(env: Any, config: Any, quiet: bool) -> Any:
    """Function from a student's network to a validation function of its parameters on the bank's split `validation`;
    None if there is none."""
    from ..evaluation.held_out import Suite

    ids = [env.bank.scene_ids[row] for row in env.bank.scenes_of("validation")]
    if not ids:
        announce("the bank has no split 'validation': the newest checkpoint is kept, not the best", quiet)
        return None
    suite = Suite.of(env.bank, {"validation": ids}, int(config.validation_episodes), [])
    return lambda student: suite.quick(env, student, ["validation"])


def bank_of(
    environment: str,
    quiet: bool = False,
    preset: str | None = None,
    path: pathlib.Path | None = None,
    scenes: "str | Sequence[str]" = "all",
) -> "SceneBank":
    """Loads the bank of the file `path`, or the default bank of an environment.

    Banks of this package are built into the cache if they are missing or outdated. The presets `quick` and `best` have
    more streets than the shipped ones. Of a folder (`datatypes.bank_shards`) only `scenes` and those of the splits
    validation and test are read, whatever else it holds.

    Raises:
      ValidationError: the file does not exist, no environment has this name, or its loader raises an error.
    """
    from .. import settings
    from ..envs import registry
    from .banks import ensure_default_bank, ensure_terrain_bank
    from .quick_bank import ensure_quick_bank

    load = registry.bank_loader(environment)
    if path is None and load is registry.load_default_bank:
        path = settings.chosen_bank_path()
    if path is not None:
        return _chosen_scenes(path, scenes)
    if load is registry.load_default_bank:
        return ensure_quick_bank(quiet) if preset in ("quick", "best") else ensure_default_bank(quiet=quiet)
    return ensure_terrain_bank() if load is registry.load_terrain_bank else load()


def placed_banks(path: pathlib.Path | None, config: Any, places: int) -> "tuple[PlacedBank, SceneBank | None]":
    """Opens a folder for a training whose scenes come and go.

    Args:
      config: of the environment: `scenes` and `schedule`.
      places: number of scenes on the device at a time.

    Returns:
      the places, and the scenes of the splits validation and test, which stay; None where there are none.

    Raises:
      ValidationError: there is no folder, or it has no more such scenes than places.
    """
    import numpy as np

    from .. import settings
    from ..datatypes import SPLITS, BankShards, PlacedBank, SceneBank, ValidationError
    from ..envs.navigation.scenarios import select_scenes

    path = path or settings.chosen_bank_path()
    if path is None or not path.is_dir():
        found = "no bank" if path is None else f"the bank {path}"
        raise ValidationError(
            f"config.schedule.places: found {found}, needed a folder of scenes (--bank streets.bank); write one by "
            "`urbanverse scene join`."
        )
    shards = BankShards(path)
    own = PlacedBank.open(shards, select_scenes(shards, config.scenes), places, int(config.schedule.seed))
    held = np.unique(np.concatenate([shards.scenes_of(split) for split in SPLITS[1:]]))
    return own, SceneBank.take(shards, held) if len(held) else None


def _chosen_scenes(path: pathlib.Path, scenes: "str | Sequence[str]") -> "SceneBank":
    """Loads a bank for a training: of a folder only `scenes`, and those of the splits validation and test.

    Args:
      scenes: see `envs.navigation.scenarios.select_scenes`.

    Raises:
      ValidationError: the file does not exist or is not a bank, or has no such scenes.
    """
    import numpy as np

    from ..datatypes import SPLITS, BankShards, SceneBank
    from ..envs.navigation.scenarios import select_scenes

    if not path.is_dir():
        return SceneBank.load(path)
    shards = BankShards(path)
    rows = [select_scenes(shards, scenes), *(shards.scenes_of(split) for split in SPLITS[1:])]
    return SceneBank.take(shards, np.unique(np.concatenate(rows)))
