"""Frozen protocols: the scenes and episodes of a benchmark in a file that never changes.

In:   a bank (`freeze`), or a file and a bank (`Protocol.load`, `Protocol.on`). Out: the file; the bank with the frozen
episodes in place of its tables, and the episodes to drive. When: once per benchmark; before every run.

A file holds the canonical hash of each scene, and start, goal, route and seed of every episode. A benchmark therefore
does not change when episode tables are planned again, and a changed scene is an error. The file also holds digests of
the scenes and robots (`pins`): a benchmark needs a new version if a map, hull, light or robot has changed. External
lists may omit the pins.
"""

import dataclasses
import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import RobotSpec, SceneBank, ValidationError
from ..datatypes import validation as v
from ..datatypes.hashing import content_hash
from .pins import changed_part, checked, robot_pin, scene_pins
from .rollouts import EpisodeSet

SCHEMA = "urbanverse.protocol/2"
#: Schema of lists without version, pins and robots.
_SCHEMA_BEFORE = "urbanverse.protocol/1"
#: Number of runs of the protocol `paper`, each of which drives every scene once (paper: "five runs per scene").
RUNS = 5
KINDS = ("paper", "full")
#: Conditions of new lists, and of those that name none because they were frozen before there were others.
CONDITIONS = {"vision_config.light": "baked", "friction": "materials"}
_CONDITIONS_BEFORE = {"vision_config.light": "direct", "friction": "uniform"}
#: Decimals of x, y, z (m) and yaw (rad) in a file: 1 mm and 0.1 mrad.
_DECIMALS = (3, 3, 3, 4)


@dataclasses.dataclass(frozen=True)
class FrozenEpisode:
    """One episode.

    Attributes:
      start: x, y, z of the ground (m), yaw (rad).
      goal: x, y, z (m) of the goal.
      way: waypoints x, y, z (m) of the shortest path, every 5 m and the goal.
      length: m, length of the route.
      seed: seed of the episode's random draws.
    """

    start: tuple[float, ...]
    goal: tuple[float, ...]
    way: tuple[tuple[float, ...], ...]
    length: float
    seed: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", v.vector(self.start, "episode.start", 4))
        object.__setattr__(self, "goal", v.vector(self.goal, "episode.goal", 3))
        way = tuple(v.vector(p, f"episode.way[{i}]", 3) for i, p in enumerate(v.items(self.way, "episode.way", 1)))
        object.__setattr__(self, "way", way)
        v.number(self.length, "episode.length", above=0.0)
        v.integer(self.seed, "episode.seed", 0)


@dataclasses.dataclass(frozen=True)
class FrozenScene:
    """The episodes of one scene.

    Attributes:
      hash: canonical hash of its layout.
      pins: result of `pins.scene_pins`; empty in lists without pins.
    """

    id: str
    hash: str
    episodes: tuple[FrozenEpisode, ...]
    pins: Mapping[str, Any] = dataclasses.field(default_factory=dict)

    def __post_init__(self) -> None:
        v.text(self.id, "scene.id")
        v.text(self.hash, f"scene {self.id!r}.hash")
        object.__setattr__(self, "episodes", tuple(self.episodes))


@dataclasses.dataclass(frozen=True)
class Protocol:
    """A benchmark.

    Attributes:
      name: name, e.g. "craftbench".
      paper_scenes: ids of the scenes that the protocol `paper` drives.
      scenes: all scenes, which the protocol `full` drives.
      version: version of the benchmark, which is raised when its scenes or robots change.
      robots: environment -> digest of its robot by `pins.robot_pin`; other robots are allowed too.
      conditions: key of the environment's config -> value with which the benchmark was frozen; see `CONDITIONS`.
    """

    name: str
    paper_scenes: tuple[str, ...]
    scenes: tuple[FrozenScene, ...]
    version: int = 1
    robots: Mapping[str, str] = dataclasses.field(default_factory=dict)
    conditions: Mapping[str, str] = dataclasses.field(default_factory=lambda: dict(_CONDITIONS_BEFORE))

    def __post_init__(self) -> None:
        v.text(self.name, "protocol.name")
        v.integer(self.version, "protocol.version", 1)
        object.__setattr__(self, "paper_scenes", tuple(self.paper_scenes))
        object.__setattr__(self, "scenes", tuple(self.scenes))
        ids = [s.id for s in self.scenes]
        if not ids or len(set(ids)) != len(ids):
            raise v.fail(f"protocol {self.name!r}", f"{len(ids)} scenes, {len(set(ids))} names", "scenes, named once")
        for scene in self.paper_scenes:
            v.choice(scene, f"protocol {self.name!r}.paper_scenes", ids)

    def content_hash(self) -> str:
        """Canonical hash of name, scenes and episodes, without pins; lists with the same hash have the same
        episodes."""
        scenes = [
            {"id": s.id, "hash": s.hash, "episodes": [dataclasses.asdict(e) for e in s.episodes]} for s in self.scenes
        ]
        return content_hash({"name": self.name, "paper_scenes": self.paper_scenes, "scenes": scenes})

    @property
    def _materials(self) -> bool:
        """Whether the friction of the ground's materials is part of the benchmark."""
        return self.conditions["friction"] == "materials"

    def to_json(self) -> dict[str, Any]:
        body = dataclasses.asdict(self)
        scenes = body.pop("scenes")
        if body["conditions"] == _CONDITIONS_BEFORE:
            del body["conditions"]
        return {"schema": SCHEMA, "hash": self.content_hash(), **body, "scenes": scenes}

    def pinned(self, bank: SceneBank, robots: Mapping[str, RobotSpec]) -> "Protocol":
        """The list with the pins of the current scenes of a bank and of some robots by environment.

        Raises:
          ValidationError: a scene is missing or has changed.
        """
        self._check_hashes(bank, self.scenes)
        rows = [bank.scene_ids.index(s.id) for s in self.scenes]
        found = [scene_pins(bank, row, self._materials) for row in rows]
        scenes = tuple(dataclasses.replace(s, pins=pins) for s, pins in zip(self.scenes, found, strict=True))
        return dataclasses.replace(self, scenes=scenes, robots={name: robot_pin(r) for name, r in robots.items()})

    def check_robot(self, environment: str, robot: RobotSpec) -> None:
        """Raises an error if a robot has changed since the list was frozen; environments that it does not name are
        accepted.

        Raises:
          ValidationError: the robot has changed.
        """
        frozen = self.robots.get(environment)
        if frozen is not None and frozen != robot_pin(robot):
            raise ValidationError(
                f"{environment}: found another robot {robot.name!r} than version {self.version} of benchmark "
                f"{self.name!r} was frozen with; results do not compare. Use the code of that version, or freeze a new "
                "version with `python -m benchmarks.freeze`."
            )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file with one episode per line, so that differences are readable."""
        body = self.to_json()
        scenes = []
        for scene in body.pop("scenes"):
            rows = ",\n".join("   " + json.dumps(e, separators=(",", ":")) for e in scene.pop("episodes"))
            scenes.append(f'  {json.dumps(scene)[:-1]}, "episodes": [\n{rows}\n  ]}}')
        joined = ",\n".join(scenes)
        text = f'{json.dumps(body)[:-1]}, "scenes": [\n{joined}\n]}}\n'
        v.write_atomically(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))

    @staticmethod
    def load(path: str | os.PathLike[str]) -> "Protocol":
        """Reads a file.

        Raises:
          ValidationError: the file is not a protocol, or its content does not match its hash.
        """
        m = v.mapping(
            v.read_json(path, "protocol"),
            "protocol",
            ("schema", "hash", "name", "paper_scenes", "scenes"),
            ("version", "robots", "conditions"),
        )
        v.choice(m["schema"], "protocol.schema", (SCHEMA, _SCHEMA_BEFORE))
        scenes = []
        for i, value in enumerate(v.items(m["scenes"], "protocol.scenes")):
            s = v.mapping(value, f"protocol.scenes[{i}]", ("id", "hash", "episodes"), ("pins",))
            names = [f.name for f in dataclasses.fields(FrozenEpisode)]
            rows = [FrozenEpisode(**v.mapping(e, f"scene {s['id']!r}", names)) for e in v.items(s["episodes"], "rows")]
            pins = checked(s["pins"], f"scene {s['id']!r}.pins") if s.get("pins") else {}
            scenes.append(FrozenScene(s["id"], s["hash"], tuple(rows), pins))
        named = v.mapping(m.get("robots", {}), "protocol.robots", (), m.get("robots", {}))
        robots = {name: v.text(pin, f"protocol.robots.{name}") for name, pin in named.items()}
        conditions = dict(_CONDITIONS_BEFORE)
        for key, value in v.mapping(m.get("conditions", {}), "protocol.conditions", (), tuple(CONDITIONS)).items():
            conditions[key] = v.text(value, f"protocol.conditions.{key}")
        paper = tuple(m["paper_scenes"])
        found = Protocol(m["name"], paper, tuple(scenes), m.get("version", 1), robots, conditions)
        if found.content_hash() != m["hash"]:
            raise v.fail(
                str(path), "episodes that do not fit their hash", "a list as it was frozen", "restore the file from git"
            )
        return found

    def on(self, bank: SceneBank, kind: str = "full", limit: int | None = None) -> "Runs":
        """Puts the frozen episodes into a bank.

        Args:
          kind: "paper": `RUNS` runs over `paper_scenes`, one episode each; "full": every episode of every scene.
          limit: use only the first `limit` scenes.

        Raises:
          ValidationError: the kind is unknown, or a scene is missing or has changed.
        """
        v.choice(kind, "protocol", KINDS)
        scenes = [s for s in self.scenes if kind == "full" or s.id in self.paper_scenes][:limit]
        self._check_hashes(bank, scenes)
        for scene in scenes:
            row = bank.scene_ids.index(scene.id)
            part = changed_part(scene.pins, scene_pins(bank, row, self._materials)) if scene.pins else None
            if part is not None:
                raise ValidationError(
                    f"scene {scene.id!r}: found other {part} than version {self.version} of benchmark {self.name!r} "
                    "was frozen with; results do not compare. Build the scenes with the code of that version."
                )
        count = [RUNS if kind == "paper" else len(s.episodes) for s in scenes]
        for scene, wanted in zip(scenes, count, strict=True):
            if len(scene.episodes) < wanted:
                raise ValidationError(
                    f"scene {scene.id!r}: found {len(scene.episodes)} frozen episodes, needed {wanted}."
                )
        rows = [bank.scene_ids.index(s.id) for s in scenes]
        number = np.concatenate([np.arange(n) for n in count])
        which = np.repeat(np.array(rows, np.int32), count)
        seeds = [s.episodes[i].seed for s, n in zip(scenes, count, strict=True) for i in range(n)]
        episodes = EpisodeSet(which, number.astype(np.int32), 0, np.array(seeds, np.uint32))
        return Runs(self, kind, tuple(s.id for s in scenes), _with_episodes(bank, rows, scenes), episodes)

    def _check_hashes(self, bank: SceneBank, scenes: Sequence[FrozenScene]) -> None:
        hashes = bank.meta.get("hashes", {})
        for scene in scenes:
            if scene.id not in bank.scene_ids:
                raise ValidationError(
                    f"benchmark {self.name!r}: found no scene {scene.id!r} in the bank, needed it; build the bank with "
                    "the command of this version."
                )
            if hashes.get(scene.id) != scene.hash:
                raise ValidationError(
                    f"scene {scene.id!r}: found hash {str(hashes.get(scene.id))[:12]}, needed {scene.hash[:12]} as "
                    f"benchmark {self.name!r} was frozen; build the scenes of that version."
                )


@dataclasses.dataclass(frozen=True)
class Runs:
    """A protocol applied to a bank.

    Attributes:
      kind: see `KINDS`.
      scenes: ids of the scenes.
      bank: bank with the frozen episode tables.
      episodes: the episodes; in `paper`, the run of an episode is its number within its scene.
    """

    protocol: Protocol
    kind: str
    scenes: tuple[str, ...]
    bank: SceneBank
    episodes: EpisodeSet


def _with_episodes(bank: SceneBank, rows: Sequence[int], scenes: Sequence[FrozenScene]) -> SceneBank:
    """Replaces the episode tables of some scenes in a bank; tables of other scenes are truncated to the same size if
    needed."""
    most = max(len(s.episodes) for s in scenes)
    longest = max(max(len(e.way) for e in s.episodes) for s in scenes)
    longest = max(longest, bank.episode_waypoints.shape[2])

    def table(old: np.ndarray, *more: int) -> np.ndarray:
        new = np.zeros((bank.num_scenes, most, *more), old.dtype)
        part = old[:, :most]
        new[:, : part.shape[1]] = part
        return new

    start, goal = table(bank.episode_start, 4), table(bank.episode_goal, 3)
    number, length = table(bank.episode_num_waypoints), table(bank.episode_length)
    old = bank.episode_waypoints
    old = np.concatenate([old, np.repeat(old[:, :, -1:], longest - old.shape[2], 2)], 2)
    way, total = table(old, longest, 3), np.minimum(bank.num_episodes, most)
    for row, scene in zip(rows, scenes, strict=True):
        for k, episode in enumerate(scene.episodes):
            start[row, k], goal[row, k], length[row, k] = episode.start, episode.goal, episode.length
            number[row, k] = len(episode.way)
            way[row, k] = [*episode.way, *[episode.way[-1]] * (longest - len(episode.way))]
        total[row] = len(scene.episodes)
    return dataclasses.replace(
        bank,
        episode_start=start,
        episode_goal=goal,
        episode_waypoints=way,
        episode_num_waypoints=number,
        episode_length=length,
        num_episodes=total,
    )


def freeze(
    name: str, bank: SceneBank, count: int, seed: int, extra: Sequence[str] = (), half: float | None = None
) -> Protocol:
    """Makes a protocol with `count` episodes of every scene of a bank, evenly spaced in its table, in random order.

    Args:
      extra: ids of scenes that the protocol `paper` leaves out.
      half: m; use only paths within this distance of the scene's beginning along its longer side (half a street).

    Raises:
      ValidationError: there are too few episodes, the bank has no hashes, or an id in `extra` is unknown.
    """
    v.integer(count, "episodes of a scene", RUNS)
    for scene in extra:
        v.choice(scene, "extra scenes", bank.scene_ids)
    scenes = []
    for row, scene in enumerate(bank.scene_ids):
        if scene not in bank.meta.get("hashes", {}):
            raise v.fail(f"bank: scene {scene!r}", "no hash", "a bank that was packed from compiled scenes")
        rows = np.arange(int(bank.num_episodes[row])) if half is None else half_rows(bank, row, half)
        if len(rows) < count:
            raise v.fail(f"scene {scene!r}", f"{len(rows)} episodes that fit", f"at least {count}")
        rows = rows[np.linspace(0, len(rows) - 1, count).round().astype(int)]
        rng = np.random.default_rng([seed, *content_hash([name, scene]).encode()[:16]])
        rows = rng.permutation(rows)
        seeds = rng.integers(0, 2**31, count)
        episodes = tuple(_episode(bank, row, int(k), int(s)) for k, s in zip(rows, seeds, strict=True))
        scenes.append(FrozenScene(scene, bank.meta["hashes"][scene], episodes))
    paper = tuple(s.id for s in scenes if s.id not in extra)
    return Protocol(name, paper, tuple(scenes), conditions=CONDITIONS)


def half_rows(bank: SceneBank, scene: int, half: float) -> np.ndarray:
    """(n,) rows of a scene's table whose paths stay within the first half of its longer side, and within `half` m."""
    number = int(bank.num_episodes[scene])
    places = np.concatenate(
        [bank.episode_start[scene, :number, None, :2], bank.episode_waypoints[scene, :number, :, :2]], 1
    )
    axis = int(np.ptp(places.reshape(-1, 2), axis=0).argmax())
    along = places[..., axis] - places[..., axis].min()
    return np.flatnonzero(along.max(1) <= min(half, along.max() / 2.0))


def _episode(bank: SceneBank, scene: int, row: int, seed: int) -> FrozenEpisode:
    def place(values: np.ndarray) -> tuple[float, ...]:
        return tuple(round(float(x), d) for x, d in zip(values, _DECIMALS, strict=False))

    way = bank.episode_waypoints[scene, row, : int(bank.episode_num_waypoints[scene, row])]
    return FrozenEpisode(
        start=place(bank.episode_start[scene, row]),
        goal=place(bank.episode_goal[scene, row]),
        way=tuple(place(p) for p in way),
        length=round(float(bank.episode_length[scene, row]), 3),
        seed=seed,
    )
