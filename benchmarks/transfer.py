"""Robustness of policies to what differs between this simulator and others: a stand-in for the paper's 16 real scenes.

    python -m benchmarks.transfer --out OUT                            # the two tables of docs/results.md
    python -m benchmarks.transfer --out OUT --policy runs/mine         # your policy in the same places
    python -m benchmarks.transfer --out OUT --policy mine.onnx --shifts all latency --places t12_lampposts
    python -m benchmarks.transfer --out OUT --policy pkg:agent --robot go2 --set latency='[0.3, 0.3]' grip='[0.2, 0.2]'
    python -m benchmarks.transfer --out OUT --policy mine.onnx --scenes FOLDER    # your own compiled scenes
    python -m benchmarks.transfer --out OUT --seconds 1200                        # what can be driven in 20 minutes
    python -m benchmarks.transfer --out OUT --add

No robot and no real street is involved. The robot drives in C MuJoCo through 16 places that no generator of this
project makes: eight composed by hand (`lib.transfer_places`) and eight distilled from noisy films of eight others
(`benchmarks.transfer_recordings`). `lib.shifts.Shifts` lists what is shifted, with units and sources; `--shifts` names
rows of its table `ALONE` ("none", "latency", ...), `all` for all together, and `--set` gives a shift of your own.
An episode ends at the goal (1 m), at a contact, off the traversable ground, by a fall, or after 60 s, as in the
benchmarks; episodes, start and draws are the same for all policies.

POLICY: go_to_goal, a policy folder (exported as ONNX into OUT), FILE.onnx, or module:callable (see
`evaluation.external.load_callable`), with the robot of its training or `--robot`.

Places are compiled into OUT/places once; those without space for routes are left out (left_out.json there). Every place
of a row is a task of one process, and finished episodes are kept in OUT/episodes, so that a stopped run continues, also
on another machine to which that folder was copied; the table of all policies comes first. A machine without what
compiling needs drives OUT/places of another one by `--scenes`.
MuJoCo's renderer needs off-screen OpenGL (MUJOCO_GL, by default egl; on machines without a GPU Mesa draws on the CPU).
OUT/result.json and the last line of stdout have the rates; `--add` writes the rows of the two tables into
benchmarks/scores/transfer.csv, for `make results`.
"""

import argparse
import dataclasses
import functools
import json
import math
import os
import pathlib
import re
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks import results
from benchmarks.lib import shifts as s
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.process_pool import results_as_completed

#: Policies of the first table with their robots; those of `SINGLE` have all rows of the second one too.
POLICIES = (
    ("go_to_goal", "coco"), ("coco_paper", "coco"), ("coco_best", "coco"), ("go_to_goal", "go2"), ("go2_best", "go2"),
)  # fmt: skip
SINGLE = (("coco_best", "coco"), ("go2_best", "go2"))
#: Other seeds of coco_best, of which the first table has rows.
SEEDS = (("best, seed 1", "coco"), ("best, seed 2", "coco"))
#: Policies that are not shipped any more, of which the tables have rows.
FORMER = (("coco_best, ideal sensors", "coco"), ("go2_best, ideal sensors", "go2"))
ROBOTS = {"CocoNav": "coco", "Go2Nav": "go2"}
EPISODES, HORIZON, RADIUS, PERIOD = 20, 60.0, 1.0, 0.2  # per place; s; m; s
SHIPPED = pathlib.Path(__file__).with_name("policies")
GRAPHS = pathlib.Path(__file__).with_name("transfer_graphs")
#: How an episode ends -> column of the rows.
ENDS = ("goal", "hit", "off_traversable", "fall", "timeout")


def all_shifts() -> dict[str, s.Shifts]:
    """Name -> shifts, of both tables."""
    return {"all": s.ALL, **s.ALONE}


# Policies.


@dataclasses.dataclass(frozen=True)
class TestedPolicy:
    """A policy as a worker process loads it.

    Attributes:
      name: in the tables. source: go_to_goal, module:callable or a file .onnx. robot: coco or go2.
    """

    name: str
    source: str
    robot: str


class GoToGoal:
    """A waypoint one metre ahead in the direction of the goal, as `evaluation.agents.go_to_goal`."""

    observations = ("goal",)

    def __call__(self, obs: Mapping[str, np.ndarray]) -> np.ndarray:
        goal = obs["goal"]
        return goal / np.maximum(np.linalg.norm(goal, axis=-1, keepdims=True), 1e-6)


def find_policy(policy: str, robot: str | None, out: pathlib.Path) -> TestedPolicy:
    """The policy to test as given on the command line; a policy folder is exported as ONNX first.

    Raises:
      ValidationError: there is no such policy.
    """
    if policy == "go_to_goal":
        return TestedPolicy(policy, policy, robot or "coco")
    path = pathlib.Path(policy)
    if not path.exists() and (SHIPPED / policy).is_dir():
        path = SHIPPED / policy
    if path.is_dir():
        from urbanverse_mjx.training.policy import PolicySpec, latest_policy

        folder = latest_policy(path)
        file = out / "policies" / f"{path.name}-{PolicySpec.load(folder).steps}.onnx"
        if not file.is_file():
            from urbanverse_mjx.training.export_onnx import export_onnx

            file.parent.mkdir(parents=True, exist_ok=True)
            export_onnx(path, file)
        return TestedPolicy(path.name, str(file), robot or _robot_of(file))
    if policy.endswith(".onnx"):
        return TestedPolicy(path.stem, policy, robot or _robot_of(path))
    if ":" in policy and not policy.startswith("zoo:"):
        return TestedPolicy(policy.replace(":", "."), policy, robot or "coco")
    shipped = ", ".join(sorted(p.parent.name for p in SHIPPED.glob("*/policy.json")))
    raise ValidationError(
        f"--policy: found {policy!r}, needed go_to_goal, a policy folder or one of {shipped}, FILE.onnx or "
        "module:callable."
    )


def _robot_of(path: pathlib.Path) -> str:
    from urbanverse_mjx.evaluation.onnx_policy import load_onnx

    record = load_onnx(path).record
    if record is None or record.environment not in ROBOTS:
        raise ValidationError(f"{path}: found no robot in its metadata, needed one; say --robot coco or --robot go2.")
    return ROBOTS[record.environment]


@dataclasses.dataclass(frozen=True)
class Task:
    """How a policy is asked: its agent, and what its training says about images, rate and actions."""

    agent: Any
    size: tuple[int, int] | None
    vision: Mapping[str, Any]
    period: float
    action_mode: str
    goal_limit: float


@functools.lru_cache(2)
def load_task(tested: TestedPolicy) -> Task:
    """Loads a policy in this process."""
    from urbanverse_mjx.evaluation.external import ExternalPolicy, load_callable
    from urbanverse_mjx.evaluation.onnx_policy import load_onnx

    if tested.source == "go_to_goal":
        policy = ExternalPolicy(GoToGoal(), GoToGoal.observations)
    elif tested.source.endswith(".onnx"):
        policy = load_onnx(pathlib.Path(tested.source))
    else:
        policy = load_callable(tested.source)
    if policy.privileged or policy.sees_goal:
        raise ValidationError(f"{tested.source}: found inputs that no sensor gives, needed image, goal and proprio.")
    record = policy.record
    config = {} if record is None else record.env_config
    mode = v.choice(config.get("action_mode", "waypoint"), f"{tested.source}: actions", ("waypoint", "velocity"))
    return Task(
        policy,
        (policy.size or (90, 160)) if policy.sees else None,
        config.get("vision_config", {}),
        PERIOD if record is None else 1.0 / record.rate_hz,
        mode,
        float(config.get("goal_observation_limit", 0.0)),
    )


# Episodes.


class Senses:
    """What a policy is told at each of its steps: shifted image, goal and own motion."""

    def __init__(self, world: Any, task: Task, conditions: s.Conditions) -> None:
        rng = functools.partial(np.random.default_rng, [*conditions.seed, 101])
        draws = [np.random.default_rng(child) for child in rng().bit_generator.seed_seq.spawn(3)]  # type: ignore
        self._world, self._task, self._conditions = world, task, conditions
        self._odometry = s.Odometry(world.pose, conditions.scale, conditions.turn, world.shifts.wander, draws[0])
        self._dropouts, self._pixels = s.Dropouts(world.shifts.dropped, draws[1]), draws[2]
        self.action = np.zeros(2, np.float32)

    def update(self) -> None:
        """Odometry of one tick."""
        self._odometry.update(self._world.pose)

    def observe(self, goal: np.ndarray) -> dict[str, np.ndarray]:
        """Observations (1, ...); goal: (2,) m."""
        pose, limit = self._odometry.pose, self._task.goal_limit
        c, sin = math.cos(pose[2]), math.sin(pose[2])
        dx, dy = goal - pose[:2]
        to = np.array([c * dx + sin * dy, c * dy - sin * dx])
        if 0.0 < limit < np.linalg.norm(to):
            to *= limit / np.linalg.norm(to)
        ahead, left, turn = self._world.velocity
        scale = self._conditions.scale
        obs = {
            "goal": to[None].astype(np.float32),
            "proprio": np.array([[scale * ahead, scale * left, turn, *self.action]], np.float32),
        }
        if self._task.size is not None:
            lost = self._dropouts.lost()
            obs["pixels/front"] = self._dropouts.seen(None if lost else self._frame())[None]
        return obs

    def _frame(self) -> np.ndarray:
        image = self._world.image()
        return s.exposed(image, self._conditions.exposure, self._world.shifts.noise, self._pixels)


def velocity_of(task: Task, robot: Any, action: np.ndarray) -> tuple[float, float]:
    """(m/s ahead, rad/s to the left) that an action (2,) means, as in `NavEnv`."""
    action = np.clip(np.nan_to_num(action), -1.0, 1.0)
    if task.action_mode == "velocity":
        return 0.5 * (float(action[0]) + 1.0) * robot.max_speed, float(action[1]) * robot.max_yaw_rate
    speed, turn = _compiled(robot.waypoint_to_velocity, task.period)(action)
    return float(speed), float(turn)


@functools.lru_cache(4)
def _compiled(waypoint_to_velocity: Callable[..., Any], period: float) -> Callable[[np.ndarray], Any]:
    """A robot's function as one program; as single operations of JAX it took a fifth of an episode's time."""
    import jax

    return jax.jit(lambda action: waypoint_to_velocity(action, period))


def drive(world: Any, task: Task, start: np.ndarray, goal: np.ndarray, conditions: s.Conditions) -> dict[str, Any]:
    """Drives one episode in a `street_world.World`.

    Args:
      start: (4,) x, y, z, yaw. goal: (3,) or (2,) m.

    Returns:
      end: of `ENDS`; hit: what was touched, or None; seconds, metres driven, metres left to the goal.
    """
    from benchmarks.lib.street_world import TICK

    world.begin(start, conditions)
    task.agent.begin(1)
    senses = Senses(world, task, conditions)
    commands = s.DelayLine(conditions.latency, (0.0, 0.0))
    ticks, metres, place = round(task.period / TICK), 0.0, world.pose[:2]
    goal, end = np.asarray(goal[:2], np.float64), "timeout"
    while world.time < HORIZON - 1e-9:
        action = np.asarray(task.agent(senses.observe(goal)), np.float32)[0]
        senses.action = np.clip(np.nan_to_num(action), -1.0, 1.0)
        commands.give(world.time, velocity_of(task, world.robot, action))
        for _ in range(ticks):
            world.drive(commands.at(world.time))
            senses.update()
        metres += float(np.linalg.norm(world.pose[:2] - place))
        place = world.pose[:2]
        ended = how_it_ends(world, goal)
        if ended is not None:
            end = ended
            break
    left = float(np.linalg.norm(goal - place))
    hit = world.hit if end == "hit" else None
    return {"end": end, "hit": hit, "seconds": round(world.time, 2), "metres": round(metres, 2), "left": round(left, 2)}


def how_it_ends(world: Any, goal: np.ndarray, radius: float = RADIUS) -> str | None:
    """The first of hit, fall, off the traversable ground and goal that holds; None if the episode goes on."""
    if world.hit is not None:
        return "hit"
    if world.fallen:
        return "fall"
    if world.off_traversable:
        return "off_traversable"
    return "goal" if np.linalg.norm(goal - world.pose[:2]) < radius else None


@functools.lru_cache(1)
def _world(folder: pathlib.Path, robot: str, lens: s.Shifts, size: Any, vision: str) -> Any:
    from benchmarks.lib.street_world import World

    return World.load(folder, robot, lens, size, json.loads(vision))


def drive_place(
    tested: TestedPolicy,
    shifts: s.Shifts,
    folder: pathlib.Path,
    episodes: int,
    file: pathlib.Path,
    until: float = math.inf,
) -> bool:
    """Drives evenly spaced episodes of a compiled scene in this process, and writes them to a file.

    After each episode those driven so far are in `unfinished(file)`, from which a later call continues.

    Args:
      until: s of `time.time`, after which no episode begins.

    Returns:
      whether all are driven.
    """
    if time.time() >= until:
        return False
    task = load_task(tested)
    world = _world(folder, tested.robot, shifts, task.size, json.dumps(dict(task.vision)))
    table = world.geometry.episodes
    rows = np.linspace(0, len(table) - 1, episodes).round().astype(int).tolist()
    part, body = unfinished(file), {"place": folder.name, "shifts": dataclasses.asdict(shifts)}
    found = _driven(part, body, rows)
    for row in rows[len(found) :]:
        if time.time() >= until:
            return False
        # The same draws for all policies; other ones in other places.
        seed = (int.from_bytes(folder.name.encode()[:4], "big"), row)
        done = drive(world, task, table.start[row], table.goal[row], shifts.draw(seed))
        found.append({"episode": row, **done})
        v.write_json(part, {**body, "episodes": found})
    v.write_json(file, {**body, "episodes": found})
    part.unlink(missing_ok=True)
    return True


def unfinished(file: pathlib.Path) -> pathlib.Path:
    """Where the first episodes of a task are kept until all are driven."""
    return file.with_suffix(".part.json")


def _driven(part: pathlib.Path, body: Mapping[str, Any], rows: Sequence[int]) -> list[dict[str, Any]]:
    """The episodes of a stopped run; none if they are not the first of these rows under these shifts."""
    done = v.read_json(part, "episodes") if part.is_file() else {"episodes": []}
    found = done.pop("episodes")
    alike = done == json.loads(json.dumps(body)) and [e["episode"] for e in found] == list(rows[: len(found)])
    return found if alike else []


# Places.


def place_names() -> tuple[str, ...]:
    """Ids of the 16 places: composed ones, then distilled ones."""
    from benchmarks.lib.transfer_places import DIRECT

    return *DIRECT, *sorted(p.parent.name for p in GRAPHS.glob("*/graph.json.gz"))


def place_graph(place: str) -> Any:
    """The graph of a place."""
    from benchmarks.lib.transfer_places import DIRECT
    from urbanverse_mjx.datatypes import SceneGraph

    v.choice(place, "--places", place_names())
    return DIRECT[place]().graph() if place in DIRECT else SceneGraph.load(GRAPHS / place / "graph.json.gz")


def compile_graph(graph: Any, folder: pathlib.Path) -> str:
    """Compiles the cousin 0 of a graph into a folder, if it is not there; returns why not, or ""."""
    from urbanverse_mjx.materialisation import index_of, materialise_cousin
    from urbanverse_mjx.pipeline.scenes import compile_layout

    key = folder.with_suffix(".key")
    if key.is_file() and key.read_text("utf-8") == graph.content_hash() and (folder / "metadata.json").is_file():
        return ""
    try:
        layout = materialise_cousin(graph, 0, 0).layout
        compile_layout(layout, index_of(layout), folder, freeze_unstable=True)
    except ValidationError as error:
        return str(error)
    v.write_atomically(key, lambda p: p.write_text(graph.content_hash(), encoding="utf-8"))
    return ""


def build_place(place: str, folder: pathlib.Path) -> str:
    """Compiles a place into a folder, if it is not there; returns why not, or ""."""
    return compile_graph(place_graph(place), folder)


def build_places(places: Sequence[str], out: pathlib.Path, workers: int) -> list[pathlib.Path]:
    """Compiles places into `out`; returns the folders of those that have space for routes.

    The others are named in left_out.json: a distilled graph may have ground that no robot can cross.

    Raises:
      ValidationError: no place can be compiled.
    """
    from urbanverse_mjx.assets.records.store import ensure_store

    ensure_store()
    tasks = [(place, out / place) for place in places]
    left_out: dict[str, str] = {}
    for number, (task, reason) in enumerate(results_as_completed(build_place, tasks, workers), 1):
        left_out |= {places[task]: reason} if reason else {}
        said = f"left out: {reason}" if reason else "compiled"
        print(f"{number}/{len(places)} places: {places[task]} {said}", file=sys.stderr, flush=True)
    v.write_json(out / "left_out.json", left_out)
    if len(left_out) == len(places):
        raise ValidationError(f"{places[0]}: {left_out[places[0]]}")
    return [out / place for place in places if place not in left_out]


# Runs.


def slug(name: str) -> str:
    """A name as part of a path."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def episode_file(out: pathlib.Path, tested: TestedPolicy, shift: str, place: str) -> pathlib.Path:
    """Where the episodes of a task are kept."""
    return out / "episodes" / f"{tested.name}-{tested.robot}" / slug(shift) / f"{place}.json"


def run(
    rows: Sequence[tuple[TestedPolicy, str, s.Shifts]],
    folders: Sequence[pathlib.Path],
    out: pathlib.Path,
    episodes: int,
    workers: int,
    until: float = math.inf,
) -> None:
    """Drives all rows in all places that are not done yet; a file with another number of episodes is driven again.

    until: s of `time.time`, after which no episode begins.
    """
    tasks = []
    for tested, shift, shifts in rows:
        for folder in folders:
            file = episode_file(out, tested, shift, folder.name)
            wanted = json.loads(json.dumps(dataclasses.asdict(shifts)))
            done = v.read_json(file, "episodes") if file.is_file() else {}
            if done.get("shifts") != wanted or len(done["episodes"]) != episodes:
                tasks.append((tested, shifts, folder, episodes, file, until))
    for number, (task, complete) in enumerate(results_as_completed(drive_place, tasks, workers), 1):
        file = tasks[task][4]
        if not complete:
            continue
        ends = [e["end"] for e in v.read_json(file, "episodes")["episodes"]]
        print(f"{number}/{len(tasks)} {file.relative_to(out)}: {ends.count('goal')}/{len(ends)}", file=sys.stderr)
        sys.stderr.flush()


def place_row(episodes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Sums over the episodes of one place."""
    ends = [e["end"] for e in episodes]
    sums = {k: round(sum(e[k] for e in episodes), 2) for k in ("metres", "seconds", "left")}
    return {"episodes": len(ends), **{end: ends.count(end) for end in ENDS}, **sums}


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Rates over places, with 95 % intervals from a bootstrap over places: SR in percent, and failures per 100 m."""
    n, good, metres = (np.array([float(r[k]) for r in rows]) for k in ("episodes", "goal", "metres"))
    at = np.random.default_rng(results.SEED).integers(0, len(rows), (results.DRAWS, len(rows)))

    def with_interval(top: np.ndarray, under: np.ndarray) -> list[float]:
        drawn = top[at].sum(1) / np.maximum(under[at].sum(1), 1e-9)
        low, high = np.percentile(drawn, [2.5, 97.5])
        return [round(float(x), 3) for x in (top.sum() / max(under.sum(), 1e-9), low, high)]

    return {
        "places": len(rows),
        "episodes": int(n.sum()),
        "SR": with_interval(100.0 * good, n),
        "failures_per_100m": with_interval(100.0 * (n - good), metres),
    }


def rows_of(out: pathlib.Path, tested: TestedPolicy, shift: str, places: Sequence[str]) -> list[dict[str, Any]]:
    """The rows of a policy and a shift that are there, one for each place."""
    files = {place: episode_file(out, tested, shift, place) for place in places}
    done = {place: v.read_json(file, "episodes") for place, file in files.items() if file.is_file()}
    return [{"place": place, **place_row(body["episodes"])} for place, body in done.items()]


def add(out: pathlib.Path, folder: pathlib.Path = results.SCORES) -> int:
    """Writes the rows of both tables that are there into transfer.csv; returns their number."""
    count = 0
    for name, robot in (*POLICIES, *SEEDS, *FORMER):
        for shift in all_shifts():
            rows = rows_of(out, TestedPolicy(name, "", robot), shift, place_names())
            about = {"policy": name, "robot": robot, "shift": shift}
            if rows:
                results.replace_rows(folder / "transfer.csv", about, [{**about, **row} for row in rows])
            count += len(rows)
    return count


# Command line.


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; argv: that of this process by default."""
    cli = argparse.ArgumentParser(
        prog="python -m benchmarks.transfer",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--policy", help="default: all of the tables")
    cli.add_argument("--robot", choices=sorted(ROBOTS.values()))
    cli.add_argument("--shifts", nargs="+", metavar="NAME", help=f"of {', '.join(all_shifts())}; default: every one")
    cli.add_argument(
        "--set", nargs="+", default=[], metavar="FIELD=JSON", help="a row `own` with these fields of Shifts"
    )
    cli.add_argument("--places", nargs="+", metavar="PLACE", help="default: all 16")
    cli.add_argument("--scenes", nargs="+", type=pathlib.Path, metavar="FOLDER", help="compiled scenes in their place")
    cli.add_argument("--episodes", type=int, default=EPISODES, help="in each place")
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes")
    cli.add_argument(
        "--seconds", type=float, default=math.inf, help="begin no episode after this time; default: no end"
    )
    cli.add_argument("--add", action="store_true", help="write the rows that are there into benchmarks/scores")
    return cli.parse_args(argv)


def _rows(args: argparse.Namespace) -> list[tuple[TestedPolicy, str, s.Shifts]]:
    known = all_shifts()
    if args.set:
        values = dict(part.partition("=")[::2] for part in args.set)
        fields = {f.name for f in dataclasses.fields(s.Shifts)}
        for name in values:
            v.choice(name, "--set", sorted(fields))
        own: dict[str, Any] = {}
        for name, text in values.items():
            value = v.parse_json(f'{{"value": {text}}}'.encode(), f"--set {name}")["value"]
            own[name] = tuple(value) if isinstance(value, list) else value
        known["own"] = s.Shifts(**own)
    names = list(args.shifts or (["own"] if args.set else known))
    for name in names:
        v.choice(name, "--shifts", tuple(known))
    if args.policy is not None:
        tested = find_policy(args.policy, args.robot, args.out)
        return [(tested, name, known[name]) for name in names]
    tested_policies = [find_policy(policy, robot, args.out) for policy, robot in POLICIES]
    # The table of all policies first, then row by row.
    return [
        (tested, name, known[name])
        for name in sorted(names, key=lambda name: name != "all")
        for tested in tested_policies
        if name == "all" or (tested.name, tested.robot) in SINGLE
    ]


def _main(args: argparse.Namespace) -> int:
    args.out = args.out.absolute()
    if args.add:
        print(json.dumps({"rows": add(args.out)}))
        return 0
    v.integer(args.episodes, "--episodes", 1)
    v.integer(args.workers, "--workers", 1)
    if args.seconds != math.inf:
        v.number(args.seconds, "--seconds", 0.0)
    until = time.time() + args.seconds
    rows = _rows(args)
    if args.scenes:
        from urbanverse_mjx.scene.folders import scene_folders

        folders = scene_folders(args.scenes)
    else:
        places = args.places or place_names()
        for place in places:
            v.choice(place, "--places", place_names())
        folders = build_places(places, args.out / "places", args.workers)
    run(rows, folders, args.out, args.episodes, args.workers, until)
    names = [folder.name for folder in folders]
    found: dict[str, Any] = {}
    for tested, shift, _ in rows:
        driven = rows_of(args.out, tested, shift, names)
        if not driven:
            continue
        done = summary(driven)
        found.setdefault(f"{tested.name} ({tested.robot})", {})[shift] = done
        print(f"{tested.name} ({tested.robot}), {shift}: {json.dumps(done)}", file=sys.stderr)
    v.write_json(args.out / "result.json", found)
    print(json.dumps(found))
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command."""
    args = arguments(argv)
    # Every process computes on one core; images come from MuJoCo's renderer or from ours on the CPU.
    os.environ |= {"OMP_NUM_THREADS": "1", "URBANVERSE_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    settings.use_compilation_cache()
    os.environ.setdefault("MUJOCO_GL", "egl")
    try:
        return _main(args)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
