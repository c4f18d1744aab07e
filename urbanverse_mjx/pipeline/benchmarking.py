"""Evaluates a policy on a frozen benchmark and writes tables, results and images to a folder."""

import dataclasses
import json
import os
import pathlib
import subprocess
import time
from collections.abc import Mapping
from typing import Any, Literal

from .. import settings
from ..datatypes import RobotSpec, SceneBank, ValidationError
from ..datatypes import validation as v
from ..progress import COMPILING, Progress


@dataclasses.dataclass(frozen=True)
class BenchmarkOptions:
    """The benchmark, policy and options."""

    policy: str = "planner"
    """zero, random, go_to_goal, planner (with full knowledge of the scene), a policy folder, module:callable,
    FILE.onnx, or with --weights a published model: zoo:gnm, vint, nomad, citywalker, s2e, mimic, and zoo:urbanverse
    for a file of export-onnx."""
    weights: pathlib.Path | None = None
    """ONNX file of a published model, or the folder with its files; with --policy zoo:NAME."""
    protocol: Literal["paper", "full"] = "paper"
    """paper: 5 runs over ten scenes; full: every frozen episode of every scene, intervals over scenes."""
    contact: Literal["both", "ends", "goes_on"] = "both"
    """Whether contact ends an episode, or is counted while the episode continues."""
    impl: Literal["auto", "jax", "warp", "warp-fused"] = "auto"
    """Engine; auto: warp on CUDA, else jax."""
    env_name: str | None = None
    """Environment whose robot is driven, e.g. Go2Nav; default: that of the policy, else CocoNav."""
    preset: str = "paper"
    """Preset of the environment, for policies without one."""
    dynamic: bool = False
    """With moving people and vehicles."""
    scenes: int | None = None
    """Use only the first scenes, up to this number."""
    env_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    """Flat dotted keys of the environment's config, such as the robot; they are listed in the report and the record."""
    at_once: int = 128
    """Number of parallel episodes."""
    pictures: bool = True
    """Draw the routes of every scene from above."""


@dataclasses.dataclass(frozen=True)
class BenchmarkRun:
    """A finished benchmark: its folder, and the text of its `report.md`."""

    folder: pathlib.Path
    page: str


def benchmark(
    name: str,
    out: str | os.PathLike[str] | None = None,
    options: BenchmarkOptions | None = None,
    bank: str | os.PathLike[str] | None = None,
    quiet: bool = True,
) -> BenchmarkRun:
    """Scores a policy on a frozen benchmark and writes report.md, results and images into a folder.

    Args:
      name: autobench, craftbench, autobench_v2, craftbench_v2, shipped, validation, or a file of `python -m
        benchmarks.freeze`.
      out: output folder; None for runs/NAME-POLICY.
      bank: the scenes; None for those that `build_library` (shipped: `ensure_default_bank`) builds into the cache.
      quiet: whether to show no progress bars on standard error.

    Raises:
      ValidationError: the benchmark, policy or bank does not exist, the bank's scenes are not those of the benchmark,
        or an override changes a setting that the benchmark fixes.
    """
    from ..evaluation.frozen import Protocol

    options = options or BenchmarkOptions()
    v.integer(options.at_once, "--at-once", 1)
    if options.weights is not None and not options.policy.startswith("zoo:"):
        raise ValidationError(f"--weights: found it beside --policy {options.policy}, needed --policy zoo:NAME.")
    if options.scenes is not None:
        v.integer(options.scenes, "--scenes", 1)
    protocol = Protocol.load(protocol_file(name))
    scenes = SceneBank.load(bank) if bank else benchmark_bank(protocol.name, quiet)
    runs = protocol.on(scenes, options.protocol, options.scenes)
    named = f"{protocol.name}-{pathlib.Path(options.policy).stem.replace(':', '-')}"
    folder = pathlib.Path("runs") / named if out is None else pathlib.Path(out)
    return BenchmarkRun(folder, _run(options, runs, folder, quiet))


def protocol_file(name: str) -> pathlib.Path:
    """The file of a benchmark by its name, or by its path.

    Raises:
      ValidationError: there is none.
    """
    if name.endswith(".json"):
        return pathlib.Path(name)
    folder = settings.protocol_root()
    known = sorted(p.stem for p in folder.glob("*.json"))
    if name not in known:
        raise ValidationError(
            f"benchmark: found {name!r}, needed one of {', '.join(known)}, or a .json file that `python -m "
            "benchmarks.freeze` makes of a bank (docs/tutorials/benchmark.md)."
        )
    return folder / f"{name}.json"


def benchmark_bank(name: str, quiet: bool = False) -> SceneBank:
    """The bank of a benchmark by its name; a suffix `_half` does not change it."""
    name = name.removesuffix("_half")
    if name == "shipped":
        from .banks import ensure_default_bank

        return ensure_default_bank(quiet)
    from ..scene import library

    home = settings.cache_dir("library", name)
    path = library.bank_in(home)
    if path is None:
        raise ValidationError(
            f"benchmark {name!r}: found no bank at {home / library.BANK}, needed its scenes; run "
            f"`urbanverse scene library {name}` or say which file with --bank."
        )
    return SceneBank.load(path)


def pinned_robots() -> dict[str, RobotSpec]:
    """The robots that benchmarks are frozen with, by environment."""
    from ..envs import registry
    from ..envs.robot import make_robot

    return {name: make_robot(registry.get_default_config(name)) for name in ("CocoNav", "Go2Nav")}


def _run(options: BenchmarkOptions, runs: Any, out: pathlib.Path, quiet: bool) -> str:
    """Drives the episodes, writes all results to `out`, and returns the report."""
    from ..evaluation import benchmark

    contacts = benchmark.CONTACTS if options.contact == "both" else (options.contact,)
    tables, scenes, seconds, privileged = {}, {}, {}, False
    title = f"{runs.protocol.name} version {runs.protocol.version}, protocol {runs.kind}: {options.policy}"
    for contact in contacts:
        began = time.monotonic()
        env, policy, batched, name, where = _prepare(options, runs, contact)
        outcome = _drive(options, runs, contact, env, policy, batched, name, quiet)
        privileged = where["privileged"]
        record = {**_record(options, runs, env, contact), "policy": where}
        tables[contact] = {name: benchmark.write_outcome(out / contact, title, runs, outcome, record)}
        scenes[contact] = benchmark.by_scene(outcome.results)
        if options.pictures:
            _draw(runs, outcome, out / contact)
        seconds[contact] = round(time.monotonic() - began, 1)
    # In a separate file, because all other files are reproducible.
    v.write_json(out / "timing.json", seconds)
    how = {
        "paper": "Means over runs ± standard error over runs. The rows of scenes pool the episodes of all runs, so "
        "their failures / 100 m and m/s, which are ratios of sums, differ from the means over runs.",
        "full": "Means over episodes ± standard error, [95 % interval], both from a bootstrap over scenes.",
    }[runs.kind]
    if privileged:
        how += "\n\nprivileged: true. The policy has data that no sensor of the robot measures."
    if options.env_overrides:
        how += f"\n\nConfig overrides: `{json.dumps(dict(options.env_overrides))}`."
    page = benchmark.to_markdown(title, tables, scenes, how)
    benchmark.write_page(out, page)
    return page


def _prepare(options: BenchmarkOptions, runs: Any, contact: str) -> tuple[Any, Any, bool, str, dict[str, Any]]:
    """Makes the environment and the policy; also returns whether the policy is called outside JAX, its name, and its
    record."""
    from ..evaluation.agents import BASELINES
    from ..evaluation.task_agents import planner_of

    name, path = options.policy, pathlib.Path(options.policy)
    if name in BASELINES or name == "planner":
        config = _config(options, runs, contact, False)
        env = _env(runs, options.env_name or "CocoNav", config)
        policy = planner_of(env) if name == "planner" else BASELINES[name]
        return env, policy, False, name, {"name": name, "privileged": name == "planner"}
    if name.startswith("zoo:"):
        return _prepare_zoo(options, runs, contact)
    if name.endswith(".onnx") or (":" in name and not path.exists()):
        return _prepare_external(options, runs, contact)
    if not path.is_dir():
        known = ", ".join((*BASELINES, "planner"))
        raise ValidationError(
            f"--policy: found {name!r}, needed one of {known}, a policy folder, module:callable or a .onnx file."
        )
    from ..training.policy import latest_policy, load_policy

    folder = latest_policy(path)
    act, spec = load_policy(folder)
    sees = any(k.startswith("pixels/") for k in spec.observations)
    env = _trained_env(options, runs, contact, sees, spec.environment, spec.env_config)
    where = {"name": str(options.policy), "privileged": False, "steps": spec.steps, "versions": spec.versions}
    return env, act, False, _title_of(folder), where


def _title_of(policy: pathlib.Path) -> str:
    """The name of a policy folder in tables: RUN/STEPS for a checkpoint of a run, else that of the folder."""
    whole = policy.resolve()
    return f"{whole.parents[1].name}/{whole.name}" if whole.parent.name == "checkpoints" else whole.name


def _prepare_external(options: BenchmarkOptions, runs: Any, contact: str) -> tuple[Any, Any, bool, str, dict[str, Any]]:
    """`_prepare` for an ONNX file or a Python callable."""
    from ..envs import registry
    from ..evaluation.external import load_callable
    from ..evaluation.onnx_policy import load_onnx
    from ..policies.onnx_agent import PROPRIO

    name, path = options.policy, pathlib.Path(options.policy)
    policy = load_onnx(path) if name.endswith(".onnx") else load_callable(name)
    where = {"name": name, "privileged": policy.privileged, "observations": list(policy.observations)}
    if policy.record is not None:
        record = policy.record
        where |= {"steps": record.steps, "versions": dict(record.versions)}
        env = _trained_env(options, runs, contact, policy.sees, record.environment, record.env_config)
    else:
        config = _config(options, runs, contact, policy.sees, policy.size)
        if PROPRIO in policy.observations:
            config = registry.with_overrides(config, {"observations.proprio": True})
        env = _env(runs, options.env_name or "CocoNav", config)
    return env, policy, True, path.stem if name.endswith(".onnx") else name, where


def _prepare_zoo(options: BenchmarkOptions, runs: Any, contact: str) -> tuple[Any, Any, bool, str, dict[str, Any]]:
    """`_prepare` for a published model, at its own rate and with images of its size."""
    from ..envs import registry
    from ..evaluation.external import ExternalPolicy
    from ..policies.zoo import CONTRACTS, zoo_agent

    name, weights = options.policy.removeprefix("zoo:"), options.weights
    v.choice(name, "--policy zoo:", (*CONTRACTS, "urbanverse"))
    if weights is None:
        raise ValidationError(f"--weights: found nothing, needed the ONNX file of zoo:{name}.")
    if name == "urbanverse":
        if weights.suffix != ".onnx":
            raise ValidationError(f"--weights: found {weights}, needed a .onnx file of `urbanverse export-onnx`.")
        chosen = dataclasses.replace(options, policy=str(weights), weights=None)
        env, policy, batched, _, where = _prepare_external(chosen, runs, contact)
        return env, policy, batched, f"zoo:{name}", {**where, "name": options.policy, "weights": str(weights)}
    contract, environment = CONTRACTS[name], options.env_name or "CocoNav"
    task = registry.get_default_config(environment, options.preset)
    overrides = {"ctrl_dt": 1.0 / contract.rate_hz, "observations.proprio": True, "vision_config.depth": False}
    task = registry.with_overrides(task, overrides).to_dict()
    config = _config(options, runs, contact, True, contract.size, task, environment)
    env = _env(runs, environment, config)
    agent = zoo_agent(name, weights, env.robot.max_speed, env.robot.max_yaw_rate, env.dt)
    where = {
        "name": options.policy,
        "weights": str(weights),
        "privileged": False,
        "observations": [*agent.observations, *(["image at the goal"] if agent.sees_goal else [])],
        "contract": dataclasses.asdict(contract),
    }
    return env, ExternalPolicy(agent, agent.observations, contract.size), True, options.policy, where


def _trained_env(
    options: BenchmarkOptions, runs: Any, contact: str, sees: bool, environment: str, trained: Mapping[str, Any]
) -> Any:
    """The benchmark's task with the observations of a trained policy, for its robot or that of `options.env_name`."""
    from ml_collections import ConfigDict

    from ..envs import registry

    chosen, own = options.env_name or environment, ConfigDict(dict(trained))
    if chosen != environment:
        own = registry.same_task(own, chosen)
    config = _config(options, runs, contact, sees, trained=own.to_dict(), environment=chosen)
    return _env(runs, chosen, config)


def _env(runs: Any, environment: str, config: Any) -> Any:
    """Makes the environment; its default robot is that with which the benchmark was frozen, but a config may name
    another one."""
    from ..envs import registry

    env = registry.load_nav_env(environment, config, runs.bank)
    default = registry.get_default_config(environment)
    if all(config.get(key) == default.get(key) for key in ("robot", "drive")):
        runs.protocol.check_robot(environment, env.robot)
    return env


#: s, longest episode (paper: a fixed horizon of 60 s).
HORIZON = 60.0


def _config(
    options: BenchmarkOptions,
    runs: Any,
    contact: str,
    sees: bool,
    size: tuple[int, int] | None = None,
    trained: dict[str, Any] | None = None,
    environment: str | None = None,
) -> Any:
    """The config of the benchmark's task with the observations of the policy."""
    from ..envs import registry
    from .evaluation import evaluation_config

    environment = environment or options.env_name or "CocoNav"
    values = trained or registry.get_default_config(environment, options.preset).to_dict()
    config = evaluation_config(environment, values, ",".join(runs.scenes), options.dynamic)
    # A trained policy sees what its training showed, as with the size of its images.
    seen = {k: x for k, x in runs.protocol.conditions.items() if not (trained and k.startswith("vision_config."))}
    config = registry.with_overrides(config, seen)
    fresh = registry.get_default_config(environment, "paper")
    task = {
        "impl": options.impl,
        "episode_length": round(HORIZON / config.ctrl_dt),
        "terminate_on_hit": contact == "ends",
        "terminate_off_traversable": True,
        "success_radius": fresh.success_radius,
        "success_after_step": fresh.success_after_step,
        "vision": sees,
    }
    if size is not None:
        task |= {"vision_config.height": size[0], "vision_config.width": size[1]}
    taken = sorted(set(task) & set(options.env_overrides))
    if taken:
        raise ValidationError(
            f"--playground-config-overrides: found {', '.join(taken)}, which the benchmark fixes, needed other keys; "
            "for another task take `urbanverse evaluate`."
        )
    return registry.with_overrides(config, {**options.env_overrides, **task})


def _drive(
    options: BenchmarkOptions,
    runs: Any,
    contact: str,
    env: Any,
    policy: Any,
    batched: bool,
    name: str,
    quiet: bool,
) -> Any:
    from ..evaluation import benchmark

    with Progress(quiet) as progress:
        task = f"{name}, contact {contact.replace('_', ' ')}"
        report = progress.task(task, len(runs.episodes), unit="episodes", note=COMPILING)
        return benchmark.drive(
            env, name, policy, runs.episodes, batched, options.at_once, lambda ended, _: report(ended, note="")
        )


def _record(options: BenchmarkOptions, runs: Any, env: Any, contact: str) -> dict[str, Any]:
    """All inputs of a result, without times."""
    import jax

    from ..training.policy import package_versions

    return {
        "benchmark": runs.protocol.name,
        "version": runs.protocol.version,
        "protocol": runs.kind,
        "list": runs.protocol.content_hash(),
        "scenes": {s.id: s.hash for s in runs.protocol.scenes if s.id in runs.scenes},
        "seeds": [int(s) for s in runs.episodes.seeds],
        "contact": contact,
        **({"overrides": dict(options.env_overrides)} if options.env_overrides else {}),
        "config": env.config.to_dict(),
        "engine": type(env.engine).__name__,
        "device": f"{jax.devices()[0].platform}: {jax.devices()[0].device_kind}",
        "commit": code_commit(),
        "versions": package_versions(),
        "at_once": options.at_once,
    }


def code_commit() -> str:
    """The commit of this code, with "+" if files were changed since; "unknown" outside a clone."""
    folder = pathlib.Path(__file__).resolve().parents[2]

    def git(*words: str) -> str:
        command = ["git", "-C", str(folder), *words]
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=20)
        return done.stdout.strip()

    try:
        if not (folder / ".git").exists():
            return "unknown"
        changed = git("status", "--porcelain", "--untracked-files=no")
        return git("rev-parse", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def _draw(runs: Any, outcome: Any, folder: pathlib.Path) -> None:
    import numpy as np
    from PIL import Image

    from ..viz.routes import route_image

    for scene in runs.scenes:
        number = runs.bank.scene_ids.index(scene)
        rows = [i for i, r in enumerate(outcome.results) if r.scene == scene]
        goals = np.array([runs.bank.episode_goal[number, outcome.results[i].episode, :2] for i in rows])
        trajectories, ends = [outcome.trajectories[i] for i in rows], [outcome.results[i].result for i in rows]
        image = Image.fromarray(route_image(runs.bank, number, trajectories, ends, goals))

        def save(path: pathlib.Path, image: Image.Image = image) -> None:
            image.save(path, "PNG", optimize=True)

        v.write_atomically(folder / f"routes_{scene}.png", save)
