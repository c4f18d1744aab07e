"""Measures crowds in streets: their cost in an environment, and statistics of a long run without one."""

import argparse
import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.lib import cases, measure, timing
from benchmarks.throughput import load_env
from urbanverse_mjx.crowds import Bodies, free_space
from urbanverse_mjx.crowds.crowd import Crowd, CrowdModel, make_tables
from urbanverse_mjx.crowds.kinds import SURFACES
from urbanverse_mjx.crowds.spawning import Observer
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import registry
from urbanverse_mjx.envs.navigation.dynamic import slot_kinds
from urbanverse_mjx.envs.registry import load_default_bank
from urbanverse_mjx.geometry.grids import cell_of
from urbanverse_mjx.simulation.collision_slots import body_slots

#: s after which an agent with a goal that has hardly moved counts as stuck, and m, tolerated overlap of bodies.
STUCK, OVERLAP = 20.0, 0.02


def _scenarios(arguments: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """Name of each environment that is timed, and its overrides; the first is the reference for the others."""
    ends = {"scenes": "all", "terminate_on_hit": not arguments.push}
    found = {
        "static": {"scenario": "static", **ends},
        "dynamic": {"scenario": "dynamic", "movable.bodies": 0, **ends},
    }
    if arguments.movable:
        sizes = {"movable.bodies": arguments.movable, "movable.awake": min(arguments.awake, arguments.movable)}
        found["movable"] = {"scenario": "dynamic", **sizes, **ends}
    return found


def environment(arguments: argparse.Namespace) -> dict[str, Any]:
    """Env-steps/s with and without a crowd, and with objects that can be pushed beside it, timed in turn."""
    runs, calls, figures = {}, {}, {}
    for scenario, overrides in _scenarios(arguments).items():
        case = cases.Case(
            preset=arguments.preset,
            impl=arguments.impl,
            num_envs=arguments.envs,
            pixels=arguments.pixels,
            bank=arguments.bank,
            scenes=arguments.scenes,
            overrides=overrides,
            measure=("step",),
            steps=arguments.env_steps,
            repeats=1,
        )
        runs[scenario] = measure.start(load_env(case), case)
        figures[scenario], calls[scenario] = measure.step(runs[scenario])
    samples = timing.time_in_turn(calls, arguments.repeats)
    count = arguments.env_steps * arguments.envs
    env = runs["dynamic"].env
    return {
        "benchmark": "crowd_environment",
        "envs": arguments.envs,
        "pixels": arguments.pixels,
        "preset": arguments.preset,
        "impl": type(env.engine).__name__,
        "agents": len(env.dynamic.kinds),
        "movable": arguments.movable,
        "steps": arguments.env_steps,
        **{f"{name}_env_steps_per_s": float(f"{s.rate(count):.4g}") for name, s in samples.items()},
        **{f"{name}_spread": float(f"{s.spread:.3g}") for name, s in samples.items()},
        **{
            f"{name}_to_static": float(f"{samples['static'].median / sample.median:.3g}")
            for name, sample in samples.items()
            if name != "static"
        },
        **_moving_bodies(runs.get("movable")),
        "compile_s": {name: {k: round(s, 1) for k, s in run.compile_s.items()} for name, run in runs.items()},
        "ended_share": {name: round(f["ended_share"], 4) for name, f in figures.items()},
        "slot_overflow": {name: f["slot_overflow"] for name, f in figures.items()},
        "device": jax.devices()[0].device_kind,
    }


def _moving_bodies(run: measure.Run | None) -> dict[str, Any]:
    """Returns the mean number of objects per env that moved in the timed steps, and of displaced ones."""
    if run is None:
        return {}
    bodies = run.sims.bodies
    home = jnp.asarray(run.env.bank.slot_position)[run.sims.scene[..., None], jnp.maximum(bodies.object_index, 0)]
    there = bodies.object_index >= 0
    moving = there & (jnp.linalg.norm(bodies.velocity, axis=-1) > body_slots.REST_SPEED)
    moved = there & (jnp.linalg.norm(bodies.position - home, axis=-1) > 0.01)
    return {name: round(float(x.sum(-1).mean()), 3) for name, x in (("moving", moving), ("moved", moved))}


def _segment_gap(bodies: Bodies, half: Any, radius: Any) -> Any:
    """(A, A) m between the bodies (discs along segments) of one env; negative where they overlap, inf on the diagonal.

    Segments that cross have an end within each other's width, whose overlap is computed here.
    """
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    gap = jnp.full((len(radius), len(radius)), jnp.inf)
    for end in (-1.0, 1.0):
        ex, ey = bodies.x + end * half * cos, bodies.y + end * half * sin
        dx, dy = ex[:, None] - bodies.x, ey[:, None] - bodies.y
        along = jnp.clip(dx * cos + dy * sin, -half, half)
        distance = jnp.hypot(dx - along * cos, dy - along * sin)
        gap = jnp.minimum(gap, jnp.minimum(distance, distance.T))
    return jnp.where(jnp.eye(len(radius), dtype=bool), jnp.inf, gap - radius[:, None] - radius)


def _clearances(bank: SceneBank, scenes: list[int]) -> tuple[dict[str, Any], Any]:
    """Surface -> (Z, X, Y) m to the next cell that is not free, and (Z, 2) m where the maps begin."""
    spaces = [free_space.free_spaces(bank, z) for z in scenes]
    tables = {name: jnp.asarray(np.stack([s[name].distance() for s in spaces])) for name in SURFACES}
    return tables, jnp.asarray(np.stack([s["foot"].origin for s in spaces]), jnp.float32)


def agent_minutes(arguments: argparse.Namespace) -> dict[str, Any]:
    """Simulates a long run without a robot; returns overlaps, agents inside obstacles, and stuck agents."""
    bank = SceneBank.load(arguments.bank) if arguments.bank else load_default_bank()
    scenes = list(range(bank.num_scenes))[: arguments.scenes]
    kinds = slot_kinds(registry.get_default_config("CocoNav").crowd)
    model = CrowdModel(make_tables(bank, scenes), kinds)
    clear, origin = _clearances(bank, scenes)
    radius, half = (jnp.array([getattr(k, n) for k in model.kinds], jnp.float32) for n in ("radius", "half_length"))
    nobody = Observer(jnp.float32(0), jnp.float32(0), jnp.float32(0), jnp.array(False))
    envs, still = arguments.crowd_envs, jnp.zeros(())
    steps = int(np.ceil(arguments.minutes * 60.0 / (model.dt * envs * len(kinds))))
    place = jnp.arange(envs) % len(scenes)
    rows = {name: np.flatnonzero([k.surface == name for k in model.kinds]) for name in SURFACES}

    def room(crowd: Crowd, scene: Any) -> Any:
        """(A,) m from the worse end of each body's axis to the next cell that is not free."""
        found = jnp.full(len(kinds), jnp.inf)
        for name, some in rows.items():
            for end in (-1.0, 1.0):
                body, reach = crowd.bodies, end * half
                xy = jnp.stack([body.x + reach * jnp.cos(body.heading), body.y + reach * jnp.sin(body.heading)], -1)
                cell = cell_of(xy[some], origin[scene], free_space.CELL, clear[name].shape[1:])
                found = found.at[some].min(clear[name][scene, cell[:, 0], cell[:, 1]])
        return found

    def one(crowd: Crowd, scene: Any, key: Any) -> tuple[Crowd, Any]:
        new = model.step(crowd, scene, nobody, (still, still), key)
        both = new.present[:, None] & new.present
        gap = jnp.where(both, _segment_gap(new.bodies, half, radius), jnp.inf)
        free = jnp.where(new.present, room(new, scene), jnp.inf)
        counts = (new.present.sum(), (gap.min(1) < -OVERLAP).sum(), (free <= 0.0).sum(), (new.still > STUCK).sum())
        return new, (*counts, jnp.maximum(-gap.min(), 0.0), jnp.maximum((radius - free).max(), 0.0))

    def step(carry: Any, key: Any) -> tuple[Any, None]:
        crowds, sums, worst, ever = carry
        crowds, (*counts, deep, sunk) = jax.vmap(one)(crowds, place, jax.random.split(key, envs))
        sums = tuple(s + c.sum().astype(jnp.float32) for s, c in zip(sums, counts, strict=True))
        worst = tuple(jnp.maximum(w, d.max()) for w, d in zip(worst, (deep, sunk), strict=True))
        return (crowds, sums, worst, ever | (crowds.still > STUCK)), None

    keys = jax.random.split(jax.random.key(arguments.seed), envs)
    crowds = jax.jit(jax.vmap(lambda k, z: model.init(k, z, nobody)))(keys, place)
    zero = jnp.zeros(())
    carry = (crowds, (zero,) * 4, (zero,) * 2, jnp.zeros((envs, len(kinds)), bool))
    run = jax.jit(lambda c, k: jax.lax.scan(step, c, k)[0])
    begin, chunk = time.perf_counter(), min(steps, 300)
    for i in range(-(-steps // chunk)):
        carry = run(carry, jax.random.split(jax.random.fold_in(jax.random.key(arguments.seed + 1), i), chunk))
    crowds, (present, overlaps, inside, stuck), (deep, sunk), ever = jax.device_get(carry)
    return {
        "benchmark": "crowd_minutes",
        "scenes": [bank.scene_ids[z] for z in scenes],
        "envs": envs,
        "agents": len(kinds),
        "agent_minutes": round(float(present) * model.dt / 60.0, 1),
        "overlap_share": float(overlaps / present),
        "deepest_overlap_m": round(float(deep), 4),
        "inside_obstacle_share": float(inside / present),
        "body_in_blocked_cells_m": round(float(sunk), 3),
        "stuck_share": float(stuck / present),
        "ever_stuck_share": float(ever[crowds.present].mean()),
        "goals_reached": int(crowds.arrived.sum()),
        "seconds": round(time.perf_counter() - begin, 1),
        "device": jax.devices()[0].device_kind,
    }
