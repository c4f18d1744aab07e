"""Measures the throughput of crowd avoidance alone, in agent-steps per second, and of environments with crowds.

    python -m benchmarks.crowds --json

steps crowds on a periodic square, each agent with a random direction, and prints one JSON line for each size
`ENVSxAGENTSxNEIGHBOURS` as soon as it is measured: agent-steps/s (median over the repeats; `*_spread` is (slowest -
fastest) / median), seconds to compile, and with --parts the seconds of a step for neighbour search, half-planes, the
programs and the resolution of collisions, each run alone over the same state. It needs numpy and jax, no bank and no
scene.

`--environment` measures, instead, env-steps/s of CocoNav with the crowd of its scenario `dynamic` and without, in turn
in one run (sizes: --envs, --pixels, --env-steps, --preset, --impl); with `--movable 8` also with that many movable
objects in addition to the crowd, at most --awake of them at once (--push: hits end no episode). `--minutes 10000`
simulates crowds without a robot for that many agent-minutes, and reports the deepest overlap, agents inside obstacles
and stuck agents. Both need a bank (--bank, or the one that `urbanverse scene bank` built).

`--mix walkers` are pedestrians; in `--mix street` an eighth of the agents are wheelchairs,
scooters, cyclists and cars, which pays for capsules and controls; `--walls 4` adds as many flats around every agent.
"""

import argparse
import dataclasses
import functools
import json
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.lib import memory, timing
from urbanverse_mjx.crowds import (
    KINDS,
    AgentKind,
    Bodies,
    Grid,
    HalfPlanes,
    Options,
    PreferredVelocity,
    Traits,
    disturbed,
    half_planes,
    linear_program,
    make_step,
    num_long,
    num_wheeled,
    orca,
    resolve_collisions,
    traits_of,
)
from urbanverse_mjx.datatypes import ValidationError

CPU_SIZES = ("64x32x8", "256x32x8", "1024x32x8", "64x128x8")
GPU_SIZES = ("4096x32x8", "1024x32x8", "16384x32x8", "4096x16x8", "4096x32x4", "4096x32x10", "4096x64x8", "1024x128x8")
MIXES = ("walkers", "street")


@dataclasses.dataclass(frozen=True)
class Case:
    """One case: envs, agents per env, neighbours per agent, and further fixed options."""

    envs: int
    agents: int
    neighbours: int
    mix: str
    walls: int
    grid: bool
    density: float

    def kinds(self) -> tuple[AgentKind, ...]:
        other = self.agents // 8 if self.mix == "street" else 0
        kinds = [KINDS["pedestrian"]] * (self.agents - other)
        kinds += [KINDS[("wheelchair", "scooter", "cyclist", "car")[i % 4]] for i in range(other)]
        return tuple(sorted(kinds, key=lambda kind: kind.wheeled))

    @property
    def side(self) -> float:
        """m, of the square."""
        return (self.agents / self.density) ** 0.5

    def options(self, dt: float) -> Options:
        grid = Grid(cell=4.0, cells=max(3, round(self.side / 4.0) + 1)) if self.grid else None
        street = self.mix == "street"
        return Options(dt, self.neighbours, num_wheeled(self.kinds()), discs_only=not street, grid=grid)


def numbers(size: str) -> tuple[int, int, int]:
    """Parses envs, agents and neighbours from a size such as 4096x32x8."""
    envs, agents, neighbours = (int(part) for part in size.split("x"))
    return envs, agents, neighbours


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.crowds", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--sizes", nargs="+", metavar="ENVSxAGENTSxNEIGHBOURS", help="default: by device")
    parser.add_argument("--mix", choices=MIXES, nargs="+", default=["walkers"])
    parser.add_argument("--walls", type=int, nargs="+", default=[0], help="flats around every agent")
    parser.add_argument("--grid", action="store_true", help="look for neighbours in a grid instead of comparing all")
    parser.add_argument("--density", type=float, default=0.15, help="agents per m²")
    parser.add_argument("--steps", type=int, default=50, help="steps in one timed run")
    parser.add_argument("--repeats", type=int, default=5, help="timed runs")
    parser.add_argument("--dt", type=float, default=0.1, help="seconds of a step")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--parts", action="store_true", help="time the parts of a step, too")
    parser.add_argument("--environment", action="store_true", help="env-steps/s of CocoNav with a crowd and without")
    parser.add_argument("--bank", help="bank file of --environment and --minutes; default: the shipped streets")
    parser.add_argument("--envs", type=int, default=1024, help="of --environment")
    parser.add_argument("--pixels", default="135x240", help="HxW or none, of --environment")
    parser.add_argument("--env-steps", type=int, default=20, help="control steps in one timed run of --environment")
    parser.add_argument("--preset", default="paper", help="of --environment")
    parser.add_argument("--impl", default="auto", help="engine of --environment")
    parser.add_argument("--movable", type=int, default=0, help="objects that can be pushed, of --environment")
    parser.add_argument("--awake", type=int, default=3, help="how many of them can move at once")
    parser.add_argument("--push", action="store_true", help="hits end no episode of --environment")
    parser.add_argument("--minutes", type=float, default=0.0, help="agent-minutes of crowds without robot")
    parser.add_argument("--crowd-envs", type=int, default=64, help="envs of --minutes")
    parser.add_argument("--scenes", type=int, default=None, help="first so many scenes of the bank")
    parser.add_argument("--json", action="store_true", help="print JSON lines")
    arguments = parser.parse_args(argv)
    sizes = arguments.sizes or (CPU_SIZES if jax.default_backend() == "cpu" else GPU_SIZES)
    try:
        arguments.cases = [
            Case(*numbers(size), mix, walls, arguments.grid, arguments.density)
            for mix in arguments.mix
            for walls in arguments.walls
            for size in sizes
        ]
    except (TypeError, ValueError):
        parser.error(f"--sizes: found {' '.join(sizes)!r}, needed ENVSxAGENTSxNEIGHBOURS such as 4096x32x8")
    if any(min(c.envs, c.agents - 1, c.neighbours) < 1 for c in arguments.cases):
        parser.error("--sizes: needed at least 1 env, 2 agents and 1 neighbour")
    if (
        min(arguments.steps, arguments.repeats, arguments.envs, arguments.env_steps, arguments.crowd_envs) < 1
        or arguments.density <= 0
    ):
        parser.error("--steps, --repeats and --density must be positive")
    return arguments


def start(case: Case, seed: int) -> tuple[Bodies, Traits, Any]:
    """Returns bodies and traits (E, A) on a jittered lattice, and their directions (E, A) rad."""
    rng = np.random.default_rng(seed)
    shape = (case.envs, case.agents)
    rows = int(np.ceil(case.agents**0.5))
    spacing = case.side / rows
    cell = np.stack([rng.permutation(rows * rows)[: case.agents] for _ in range(case.envs)])
    x, y = ((c + 0.5 + rng.uniform(-0.2, 0.2, shape)) * spacing for c in (cell % rows, cell // rows))
    heading = rng.uniform(-np.pi, np.pi, shape)
    zero = np.zeros(shape)
    bodies = Bodies(*(jnp.asarray(a, jnp.float32) for a in (x, y, zero, zero, heading)))
    column = Traits(*(a[:, 0] for a in traits_of(case.kinds())))
    traits = jax.tree.map(lambda a: jnp.broadcast_to(a, shape), column)
    return bodies, traits, bodies.heading


def fence(case: Case, bodies: Bodies, traits: Traits, end: float) -> HalfPlanes:
    """Returns half-planes (M, A) at the sides of the square for one env, for the discs at the front (end 1) or the rear
    (-1)."""
    angle = 2.0 * np.pi * np.arange(case.walls) / max(case.walls, 1)
    mx, my = (jnp.asarray(f(angle), jnp.float32)[:, None] for f in (np.cos, np.sin))
    half = 0.5 * case.side
    x = bodies.x + end * traits.half_length * jnp.cos(bodies.heading)
    y = bodies.y + end * traits.half_length * jnp.sin(bodies.heading)
    space = half - mx * (x - half) - my * (y - half)
    ones = jnp.ones_like(space)
    return half_planes.towards_walls((mx * ones, my * ones), space, traits.radius, traits.wall_horizon)


def stepper(case: Case, dt: float, seed: int) -> Any:
    """Returns a function (bodies, traits, directions, number of steps) -> bodies."""
    step, collisions = make_step(case.options(dt)), resolve_collisions.make_resolve_collisions(num_long(case.kinds()))
    rolling = num_wheeled(case.kinds())

    def one(bodies: Bodies, traits: Traits, direction: Any, key: Any) -> Bodies:
        speed = 0.8 * traits.limit
        preferred_velocity = disturbed(
            PreferredVelocity(speed * jnp.cos(direction), speed * jnp.sin(direction), direction), key
        )
        rear = HalfPlanes(*(a[:, case.agents - rolling :] for a in fence(case, bodies, traits, -1.0)))
        front = fence(case, bodies, traits, 1.0)
        new, _ = step(bodies, traits, preferred_velocity, front, rear)
        new = collisions(bodies, new, traits, resolve_collisions.keeps_off(front, rear, bodies, new, traits))
        return new._replace(x=jnp.mod(new.x, case.side), y=jnp.mod(new.y, case.side))

    def steps(bodies: Bodies, traits: Traits, direction: Any, number: int) -> Bodies:
        def body(b: Bodies, key: Any) -> tuple[Bodies, None]:
            return jax.vmap(one)(b, traits, direction, jax.random.split(key, case.envs)), None

        return jax.lax.scan(body, bodies, jax.random.split(jax.random.key(seed), number))[0]

    return steps


def parts(case: Case, bodies: Bodies, traits: Traits, direction: Any, arguments: argparse.Namespace) -> dict[str, Any]:
    """Returns the seconds per step of each part alone, from the final state of the timed run."""
    options = case.options(arguments.dt)
    walls = jax.vmap(lambda b, t: fence(case, b, t, 1.0), out_axes=-1)(bodies, traits)
    bodies, traits = jax.tree.map(lambda a: a.T, (bodies, traits))
    speed = 0.8 * traits.limit
    preferred_velocity = (speed * jnp.cos(direction.T)).reshape(-1), (speed * jnp.sin(direction.T)).reshape(-1)
    search = timing.compile_(lambda b, t: orca.look_around(b, t, case.agents, options), bodies, traits)
    near = search.call(bodies, traits)
    build = timing.compile_(lambda b, t, n: orca.permitted(b, t, case.agents, n, options), bodies, traits, near)
    lines = linear_program.join(walls, build.call(bodies, traits, near)[0])
    flat = HalfPlanes(*(a.reshape(a.shape[0], -1) for a in lines))
    limit = traits.limit.reshape(-1)
    first = timing.compile_(linear_program.nearest_permitted, flat, limit, *preferred_velocity)
    both = timing.compile_(
        lambda a, b, *c: linear_program.solve(a, case.walls, b, *c), flat, limit, *preferred_velocity
    )
    allowed = jnp.ones(bodies.x.shape, bool)
    resolved = functools.partial(resolve_collisions.resolved, num_long=num_long(case.kinds()))
    last = timing.compile_(resolved, bodies, bodies, traits, allowed)
    failed = first.call(flat, limit, *preferred_velocity)[2]
    samples = timing.time_in_turn(
        {
            "look_around": lambda: search.call(bodies, traits),
            "half_planes": lambda: build.call(bodies, traits, near),
            "first_program": lambda: first.call(flat, limit, *preferred_velocity),
            "both_programs": lambda: both.call(flat, limit, *preferred_velocity),
            "settle": lambda: last.call(bodies, bodies, traits, allowed),
        },
        arguments.repeats,
    )
    return {
        "seconds_per_step": {name: float(f"{sample.median:.4g}") for name, sample in samples.items()},
        "share_in_second_program": float(np.mean(np.asarray(failed) < flat.offset.shape[0])),
    }


def measure(case: Case, arguments: argparse.Namespace) -> dict[str, Any]:
    bodies, traits, direction = start(case, arguments.seed)
    steps = stepper(case, arguments.dt, arguments.seed)
    run = timing.compile_(lambda b, t, d: steps(b, t, d, arguments.steps), bodies, traits, direction)
    bodies = run.call(bodies, traits, direction)
    sample = timing.time_(run.call, bodies, traits, direction, repeats=arguments.repeats)
    result = {
        "benchmark": "crowds",
        **dataclasses.asdict(case),
        "steps": arguments.steps,
        "dt": arguments.dt,
        "agent_steps_per_s": float(f"{sample.rate(case.envs * case.agents * arguments.steps):.4g}"),
        "agent_steps_per_s_spread": float(f"{sample.spread:.3g}"),
        "seconds_per_step": float(f"{sample.median / arguments.steps:.4g}"),
        "compile_s": float(f"{run.seconds:.3g}"),
        "finite": bool(np.isfinite(np.asarray(bodies.x)).all()),
        "peak_device_mib": memory.jax_mib()[1],
        "device": jax.devices()[0].device_kind if jax.default_backend() != "cpu" else "cpu",
        "jax": jax.__version__,
    }
    if arguments.parts:
        result["parts"] = parts(case, bodies, traits, direction, arguments)
    return result


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    jobs = [functools.partial(measure, case, arguments) for case in arguments.cases]
    if arguments.environment or arguments.minutes > 0.0:
        from benchmarks.lib import crowd_streets

        jobs = [functools.partial(crowd_streets.environment, arguments)] if arguments.environment else []
        if arguments.minutes > 0.0:
            jobs.append(functools.partial(crowd_streets.agent_minutes, arguments))
    for job in jobs:
        try:
            result = job()
        except ValidationError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        if arguments.json:
            print(json.dumps(result), flush=True)
        else:
            print(", ".join(f"{name}: {json.dumps(value)}" for name, value in result.items()), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
