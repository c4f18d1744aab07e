"""`EpisodeResult` (of one rollout) and `BenchmarkReport` (a summary of many, with their record)."""

import dataclasses
from typing import Any, ClassVar, Self

from . import validation as v
from .json_datatype import JsonDatatype

SCHEMA = "urbanverse.benchmark_report/1"
RESULTS = ("goal", "hit", "off_traversable", "fall", "non_finite", "timeout", "hit_agent", "lost", "stopped", "dropped")
#: A `hit` of the ground by a part of the robot other than a foot, which has other causes than that of an object.
HIT_GROUND = "hit_ground"
OUTCOMES = (*RESULTS, HIT_GROUND)


def outcome_of(result: str, hit_ground: bool) -> str:
    """One of `OUTCOMES`.

    Args:
      result: one of `RESULTS`.
      hit_ground: see `EpisodeResult.hit_ground`.
    """
    return HIT_GROUND if result == "hit" and hit_ground else result


@dataclasses.dataclass(frozen=True)
class EpisodeResult:
    """One evaluated episode.

    Attributes:
      agent: name of the policy.
      scene: scene id.
      episode: row of the scene's episode table; seed.
      result: one of `RESULTS`.
      steps: control steps.
      duration: s.
      route_completion: share of the route reached, [0, 1].
      distance_to_goal: m at the end.
      hit_time: share of the episode's time in contact with an object, [0, 1].
      path_length: m driven.
      route_length: m of the geodesic route.
      slot_overflow: hulls within reach that found no slot, summed over the episode (0 = physics complete).
      people_distance: m, least distance from the disc around the robot to a person's body.
      intimate_time: share of the episode's time within 0.45 m, [0, 1].
      speed_near_people: m/s, mean within 1.2 m, None where never so near. All None in a street without people.
      touches: how often contact with an object or an agent began; None in reports from before it was counted.
      hit_ground: whether the last control step had a contact of a part other than a foot with the ground and none with
        an object or an agent; None in reports from before it was recorded.
      task_scores: score -> value of a task beside point goals (`envs.navigation.tasks`); None for point goals.
    """

    agent: str
    scene: str
    episode: int
    seed: int
    result: str
    steps: int
    duration: float
    route_completion: float
    distance_to_goal: float
    hit_time: float
    path_length: float
    route_length: float
    slot_overflow: int
    people_distance: float | None = None
    intimate_time: float | None = None
    speed_near_people: float | None = None
    touches: int | None = None
    hit_ground: bool | None = None
    task_scores: dict[str, float] | None = None

    def __post_init__(self) -> None:
        where = f"episode {self.scene!r}/{self.episode}"
        v.text(self.agent, f"{where}.agent")
        v.text(self.scene, "episode.scene")
        v.choice(self.result, f"{where}.result", RESULTS)
        v.integer(self.episode, f"{where}.episode", 0)
        v.integer(self.seed, f"{where}.seed", 0)
        v.integer(self.steps, f"{where}.steps", 1)
        v.integer(self.slot_overflow, f"{where}.slot_overflow", 0)
        for name in ("route_completion", "hit_time"):
            v.number(getattr(self, name), f"{where}.{name}", 0.0, 1.0)
        for name in ("duration", "distance_to_goal", "path_length", "route_length"):
            v.number(getattr(self, name), f"{where}.{name}", 0.0)
        for name in ("people_distance", "intimate_time", "speed_near_people"):
            if getattr(self, name) is not None:
                v.number(getattr(self, name), f"{where}.{name}", 0.0)
        if self.touches is not None:
            v.integer(self.touches, f"{where}.touches", 0)
        if self.hit_ground is not None:
            v.boolean(self.hit_ground, f"{where}.hit_ground")
        for name, value in (self.task_scores or {}).items():
            v.number(value, f"{where}.task_scores.{name}")

    @property
    def outcome(self) -> str:
        """One of `OUTCOMES`."""
        return outcome_of(self.result, bool(self.hit_ground))

    @property
    def touched(self) -> bool:
        """Whether the robot ever touched something."""
        return self.result in ("hit", "hit_agent") or bool(self.touches)

    @property
    def success(self) -> bool:
        """Reached the goal without contact (the paper's SR), also where an episode continues after contact."""
        return self.result == "goal" and not self.touched

    @property
    def spl(self) -> float:
        """Success weighted by route length over the length driven (Anderson et al. 2018)."""
        return self.route_length / max(self.path_length, self.route_length, 1e-9) if self.success else 0.0

    def to_json(self) -> dict[str, Any]:
        found = dataclasses.asdict(self)
        if self.task_scores is None:
            del found["task_scores"]
        return found

    def to_row(self) -> dict[str, Any]:
        """The fields of `to_json` as columns of a table, with those of the task as task/NAME."""
        found = self.to_json()
        scores = found.pop("task_scores", {})
        return found | {f"task/{name}": value for name, value in scores.items()}

    @staticmethod
    def from_json(value: Any, where: str = "episode") -> "EpisodeResult":
        fields = dataclasses.fields(EpisodeResult)
        required = [f.name for f in fields if f.default is dataclasses.MISSING]
        return EpisodeResult(**v.mapping(value, where, required, [f.name for f in fields]))


@dataclasses.dataclass(frozen=True)
class BenchmarkReport(JsonDatatype):
    """Results of several agents on the same episodes.

    Attributes:
      title: of the report.
      summary: agent -> metric -> {"mean", "low", "high"} (95 % interval) or a number.
      episodes: every episode.
      record: everything that made them: versions, configs, hashes, seeds, command.
    """

    KIND: ClassVar[str] = "benchmark report"

    title: str
    summary: dict[str, dict[str, Any]]
    episodes: tuple[EpisodeResult, ...]
    record: dict[str, Any]

    def __post_init__(self) -> None:
        v.text(self.title, "report.title")
        if not isinstance(self.summary, dict) or not isinstance(self.record, dict):
            raise v.fail("report", "a summary or record that is no object", "JSON objects")
        object.__setattr__(self, "episodes", tuple(self.episodes))

    def to_json(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "title": self.title,
            "summary": self.summary,
            "episodes": [e.to_json() for e in self.episodes],
            "record": self.record,
        }

    @classmethod
    def from_json(cls, value: Any) -> Self:
        m = v.mapping(value, "report", ("schema", "title", "summary", "episodes", "record"))
        v.choice(m["schema"], "report.schema", (SCHEMA,))
        episodes = v.items(m["episodes"], "episodes")
        made = tuple(EpisodeResult.from_json(e, f"episodes[{i}]") for i, e in enumerate(episodes))
        return cls(m["title"], m["summary"], made, m["record"])
