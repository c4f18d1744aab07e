"""Throughput of the whole environment step and of its parts.

    python -m benchmarks.throughput --impl jax --num-envs 64 --pixels 36x64 --json

prints one JSON line: env-steps/s with auto-reset and one frame a step, as PPO sees it; the seconds of a step that
physics and render take when run alone over the same states, and the rest; compile seconds; peak memory; and the
physics alone in the dearest places of the bank (robots driven into what stands nearest), with its cost as a ratio to
the same robot on the same ground without hull slots. Every figure is the median over the repeats; `*_spread` is
(slowest - fastest) / median. Without --json the same is printed one figure a line.
"""

import argparse
import importlib.metadata
import json
import os
import pathlib
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks import _placing, _timing
from urbanverse_mjx.datatypes import NounError, SceneBank
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.simulation.engines import IMPLS, make_engine

PACKAGES = ("urbanverse_mjx", "jax", "mujoco", "mujoco-mjx", "mujoco-warp", "mujoco-warp-pbr", "warp-lang")


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.throughput", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--impl", choices=IMPLS, default="auto")
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--pixels", default="36x64", metavar="HxW", help="height and width of the frame")
    parser.add_argument("--env", default="CocoNav")
    parser.add_argument("--preset", default="cpu")
    parser.add_argument("--steps", type=int, default=20, help="control steps in one timed run")
    parser.add_argument("--repeats", type=int, default=5, help="timed runs")
    parser.add_argument("--bank", type=pathlib.Path, help="a bank file (default: the shipped streets)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true", help="print one JSON line")
    arguments = parser.parse_args(argv)
    for name in ("num_envs", "steps", "repeats"):
        if getattr(arguments, name) < 1:
            parser.error(f"--{name.replace('_', '-')} must be at least 1")
    try:
        arguments.height, arguments.width = (int(part) for part in arguments.pixels.split("x"))
    except ValueError:
        parser.error(f"--pixels: found {arguments.pixels!r}, needed HEIGHTxWIDTH such as 36x64")
    return arguments


def load_env(arguments: argparse.Namespace) -> Any:
    overrides = {
        "preset": arguments.preset,
        "impl": arguments.impl,
        "vision_config.height": arguments.height,
        "vision_config.width": arguments.width,
    }
    # Scenes are compiled only where no bank is given: a GPU machine brings its own and has no CoACD or trimesh.
    if arguments.bank:
        bank = SceneBank.load(arguments.bank)
    else:
        from urbanverse_mjx.cli.scene import ensure_default_bank

        bank = ensure_default_bank(quiet=True)
    return registry.load(arguments.env, config_overrides=overrides, bank=bank)


def command(env: Any, waypoint: jax.Array) -> jax.Array:
    """(nu,) actuator commands towards a waypoint (2,) m in the body frame."""
    return env.robot.command(jnp.stack(env.robot.waypoint_to_velocity(waypoint, env.dt)))


def drive_with(engine: Any) -> Any:
    """A function (states, commands (T, n, nu)) -> (states, (T, n) bool hit) that runs the physics alone."""

    def drive(sim: Any, ctrl: Any) -> tuple[Any, Any]:
        return jax.lax.scan(lambda s, u: ((new := jax.vmap(engine.step)(s, u)), new.contacts.hit), sim, ctrl)

    return drive


def measure_step(env: Any, arguments: argparse.Namespace) -> tuple[dict[str, Any], _timing.Compiled]:
    """The whole step, and physics and rendering alone over states of the same kind; also the compiled physics."""
    steps, num_envs = arguments.steps, arguments.num_envs
    wrapped = wrap_for_training(env, env.config.episode_length)
    keys = jax.random.split(jax.random.key(arguments.seed), num_envs)
    begin = _timing.compile_(wrapped.reset, keys)
    state = begin.call(keys)
    # Forward with a random turn: what an untrained policy does once it moves, so that episodes end by hits, too.
    actions = jax.random.uniform(jax.random.key(arguments.seed + 1), (steps, num_envs, 2), minval=-1.0, maxval=1.0)
    actions = actions.at[..., 0].set(0.5 + 0.5 * actions[..., 0])
    ctrl = jax.vmap(jax.vmap(lambda waypoint: command(env, waypoint)))(actions)

    def whole(state: Any) -> tuple[Any, Any]:
        return jax.lax.scan(lambda s, a: (wrapped.step(s, a), (s.data.sim, s.metrics["slot_overflow"])), state, actions)

    def render(sims: Any) -> Any:
        def frame(total: Any, sim: Any) -> tuple[Any, None]:
            pixels = jax.vmap(env.renderer)(sim.scene, sim.xpos, sim.xquat)["rgb"]
            # A sum over a few pixels keeps the frame alive at no cost.
            return total + pixels[:, 0, 0].astype(jnp.float32).sum(), None

        return jax.lax.scan(frame, jnp.float32(0.0), sims)[0]

    step = _timing.compile_(whole, state)
    warm, (sims, _) = step.call(state)  # leaves the first, all at rest, behind
    physics = _timing.compile_(drive_with(env.engine), warm.data.sim, ctrl)
    frames = _timing.compile_(render, sims)
    samples = _timing.time_in_turn(
        {
            "total": lambda: step.call(warm),
            "physics": lambda: physics.call(warm.data.sim, ctrl),
            "render": lambda: frames.call(sims),
        },
        arguments.repeats,
    )
    overflow = float(step.call(warm)[1][1].max())
    seconds = {name: sample.median / steps for name, sample in samples.items()}
    seconds["rest"] = seconds["total"] - seconds["physics"] - seconds["render"]
    compiled = {"reset": begin, "step": step, "physics": physics, "render": frames}
    return {
        "env_steps_per_s": samples["total"].rate(steps * num_envs),
        "env_steps_per_s_spread": samples["total"].spread,
        "seconds_per_step": seconds,
        "seconds_per_step_spread": {name: sample.spread for name, sample in samples.items()},
        "share": {name: seconds[name] / seconds["total"] for name in ("physics", "render", "rest")},
        "compile_s": {name: part.seconds for name, part in compiled.items()},
        "slot_overflow": overflow,
    }, physics


def measure_physics(env: Any, arguments: argparse.Namespace, physics: _timing.Compiled) -> dict[str, Any]:
    """Physics alone with robots driven into what stands nearest, and the same robot without hull slots."""
    steps, num_envs = arguments.steps, arguments.num_envs
    config, robot = env.config, env.robot
    poses = _placing.crowded_poses(env.bank, robot, num_envs, config.ctrl_dt)
    qpos = np.tile(env.mj_model.qpos0, (num_envs, 1))
    qpos[:, :3] = poses.position + np.array([0.0, 0.0, robot.spawn_height])
    qpos[:, 3], qpos[:, 4:6], qpos[:, 6] = np.cos(poses.yaw / 2), 0.0, np.sin(poses.yaw / 2)
    ahead = command(env, jnp.array([1.0, 0.0]))
    ctrl = jnp.broadcast_to(ahead, (steps, num_envs, *ahead.shape))
    bare = make_engine(
        env.bank, robot, impl=config.impl, control_dt=config.ctrl_dt, physics_dt=config.sim_dt, num_slots=0
    )
    start = (jnp.asarray(poses.scene), jnp.asarray(qpos), jnp.zeros((num_envs, env.mj_model.nv)))
    first = {name: jax.jit(jax.vmap(engine.init))(*start) for name, engine in (("active", env.engine), ("bare", bare))}
    without = _timing.compile_(drive_with(bare), first["bare"], ctrl)
    calls = {"active": physics.call, "bare": without.call}
    # Drive up to the obstacle first: the timed part is spent pushing against it.
    pushing = {name: call(first[name], ctrl)[0] for name, call in calls.items()}
    samples = _timing.time_in_turn(
        {name: lambda name=name: calls[name](pushing[name], ctrl) for name in calls}, arguments.repeats
    )
    count = steps * env.n_substeps * num_envs
    return {
        "physics_steps_per_s": samples["active"].rate(count),
        "physics_steps_per_s_spread": samples["active"].spread,
        "no_slots_physics_steps_per_s": samples["bare"].rate(count),
        "cost_ratio_to_no_slots": samples["active"].median / samples["bare"].median,
        "num_slots": int(config.num_slots),
        "hulls_in_reach_at_start": float(poses.in_reach.mean()),
        "share_of_envs_in_contact": float(np.asarray(calls["active"](pushing["active"], ctrl)[1]).mean()),
        "compile_s": without.seconds,
    }


def describe(env: Any, arguments: argparse.Namespace) -> dict[str, Any]:
    """What was measured, on what."""
    return {
        "benchmark": "throughput",
        "env": arguments.env,
        "preset": arguments.preset,
        "impl": arguments.impl,
        "num_envs": arguments.num_envs,
        "pixels": [arguments.height, arguments.width],
        "physics_steps_per_env_step": env.n_substeps,
        "steps": arguments.steps,
        "repeats": arguments.repeats,
        "scenes": [env.bank.scene_ids[i] for i in env.scenes],
        "device": jax.devices()[0].device_kind if jax.default_backend() != "cpu" else "cpu",
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "python": ".".join(map(str, sys.version_info[:3])),
        "versions": {name: importlib.metadata.version(name) for name in PACKAGES},
    }


def rounded(value: Any) -> Any:
    """Four significant digits: no timing holds more."""
    if isinstance(value, dict):
        return {name: rounded(part) for name, part in value.items()}
    return float(f"{value:.4g}") if isinstance(value, float) else value


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        env = load_env(arguments)
        result, physics = measure_step(env, arguments)
        result["physics_active"] = measure_physics(env, arguments, physics)
    except NounError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    result["memory"] = {"peak_rss_mib": _timing.peak_rss_mib(), "peak_device_mib": _timing.peak_device_mib()}
    result = {**describe(env, arguments), **rounded(result)}
    if arguments.json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name}: {json.dumps(value)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
