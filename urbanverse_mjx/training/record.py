"""`config.json` of a run folder: settings of the run, its segments, and the settings that a resumed run may change."""

import dataclasses
import datetime
import json
import pathlib
from collections.abc import Mapping
from typing import Any

import jax
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..envs import registry
from .config import default_ppo_config
from .policy import PolicySpec, package_versions, trained_scenes

FILE = "config.json"
#: PPO fields that a resumed run may change: duration and number of checkpoints.
MAY_CHANGE = ("num_timesteps", "num_checkpoints")


@dataclasses.dataclass(frozen=True)
class RunRequest:
    """Settings of a run by the caller; None and missing keys mean not given.

    Attributes:
      environment: registered name.
      preset: of the environment and of PPO.
      env_overrides, ppo_overrides: flat dotted keys, e.g. {"reward_config.scales.hit": -50}.
      num_timesteps, num_envs, seed: the PPO fields that have command-line options of their own; they win over
        `ppo_overrides`.
    """

    environment: str | None = None
    preset: str | None = None
    env_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    ppo_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    num_timesteps: int | None = None
    num_envs: int | None = None
    seed: int | None = None

    @property
    def ppo(self) -> dict[str, Any]:
        """All PPO settings as flat dotted keys."""
        own = {name: getattr(self, name) for name in ("num_timesteps", "num_envs", "seed")}
        return {**self.ppo_overrides, **{k: x for k, x in own.items() if x is not None}}


@dataclasses.dataclass(frozen=True)
class RunRecord:
    """The settings of a run.

    Attributes:
      environment: registered name.
      env, ppo: full configs as JSON holds them (tuples are lists); `ppo` with the newest segment's `MAY_CHANGE`.
      segments: one for the start and one for each resumption, in order: `from_steps` (env-steps done before it),
        `num_timesteps` and `num_checkpoints` asked for, `begun` (UTC), `devices`, `versions` and, where it was given,
        `start_from`. Runs from before segments were recorded have one with `from_steps` and `num_timesteps` alone.
    """

    environment: str
    env: dict[str, Any]
    ppo: dict[str, Any]
    segments: tuple[dict[str, Any], ...]

    @staticmethod
    def load(folder: pathlib.Path) -> "RunRecord":
        """Reads the record of a run folder.

        Raises:
          ValidationError: there is no record, or it is invalid.
        """
        path = folder / FILE
        if not path.is_file():
            raise ValidationError(
                f"run folder: found no {FILE} in {folder}, needed a folder that `urbanverse train` made."
            )
        body = v.mapping(v.read_json(path, "run record"), "run record", ["environment", "env", "ppo"], ["segments"])
        env, ppo = (_object(body[name], f"run record.{name}") for name in ("env", "ppo"))
        first = {"from_steps": 0, "num_timesteps": ppo.get("num_timesteps")}
        segments = v.items(body.get("segments") or (first,), "run record.segments")
        parts = tuple(_object(part, f"run record.segments[{k}]") for k, part in enumerate(segments))
        return RunRecord(v.text(body["environment"], "run record.environment"), env, ppo, parts)

    def save(self, folder: pathlib.Path) -> None:
        """Writes `config.json` atomically."""
        v.write_json(folder / FILE, dataclasses.asdict(self))

    def configs(self) -> tuple[str, ConfigDict, ConfigDict]:
        """Name of the environment, and new configs of it and of PPO."""
        return self.environment, ConfigDict(self.env), ConfigDict(self.ppo)


def _object(value: Any, where: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise v.fail(where, v.show(value), "a JSON object")
    return value


def configs_of(
    request: RunRequest, preset: str | None = None, environment: str = "CocoNav"
) -> tuple[str, ConfigDict, ConfigDict]:
    """Environment, its config and its training config for a new run; `preset` and `environment` are defaults of the
    request. Without a preset, it is `quick`, or `cpu` for an environment without `quick`.

    Raises:
      ValidationError: a name is unknown, or an override does not fit.
    """
    environment = request.environment or environment
    preset = request.preset or preset or ("quick" if "quick" in registry.presets(environment) else "cpu")
    overrides = dict(request.env_overrides)
    # As in `registry.load`, this key selects the base config.
    base = registry.get_default_config(environment, overrides.pop("preset", preset))
    env = registry.with_overrides(base, overrides)
    return environment, env, registry.with_overrides(default_ppo_config(preset, environment), request.ppo)


def resumed_configs(folder: pathlib.Path, request: RunRequest) -> tuple[str, ConfigDict, ConfigDict]:
    """Environment and configs of the run in `folder`, with the requested `MAY_CHANGE`.

    Raises:
      ValidationError: there is no run, or the request differs from the run's settings.
    """
    name, env, ppo = RunRecord.load(folder).configs()
    asked_env = registry.with_overrides(env, request.env_overrides)
    asked_ppo = registry.with_overrides(ppo, request.ppo)
    said = {"environment": request.environment, "preset": request.preset}
    had = {"environment": name, "preset": env.get("preset")}
    differences = [_difference(k, had[k], x) for k, x in said.items() if x not in (None, had[k])]
    differences += _differences("env", env, asked_env) + _differences("ppo", ppo, asked_ppo, MAY_CHANGE)
    _refuse(folder, differences)
    return name, env, asked_ppo


def begin_segment(
    folder: pathlib.Path,
    environment: str,
    env: ConfigDict,
    ppo: ConfigDict,
    from_steps: int,
    start_from: pathlib.Path | None = None,
) -> RunRecord:
    """Adds a segment to the record without writing it to a file. A resumed run has `from_steps` above 0.

    Raises:
      ValidationError: a resumed run has settings other than those of its record.
    """
    earlier: tuple[dict[str, Any], ...] = ()
    if from_steps:
        old = RunRecord.load(folder)
        name, old_env, old_ppo = old.configs()
        differences = [] if name == environment else [_difference("environment", name, environment)]
        differences += _differences("env", old_env, env) + _differences("ppo", old_ppo, ppo, MAY_CHANGE)
        _refuse(folder, differences)
        earlier = old.segments
    segment = {
        "from_steps": from_steps,
        **{name: ppo[name] for name in MAY_CHANGE},
        "begun": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "devices": f"{jax.device_count()} x {jax.devices()[0].device_kind}",
        "versions": package_versions(),
        **({} if start_from is None else {"start_from": str(start_from.absolute())}),
    }
    return RunRecord(environment, env.to_dict(), ppo.to_dict(), (*earlier, segment))


def check_scenes(trained: PolicySpec, env: Any) -> None:
    """Checks that `env` has exactly the scenes of a checkpoint.

    Raises:
      ValidationError: the scenes differ, or the same ids have other layouts.
    """
    ids = trained_scenes(env)
    hashes = env.bank.meta.get("hashes", {})
    other = sorted(set(ids) ^ set(trained.scene_ids))
    other += [s for s in ids if s not in other and trained.bank_hashes.get(s) != hashes.get(s)]
    if other:
        raise ValidationError(
            f"--resume: found a bank whose scenes are not those of the run (first {other[0]!r} of {len(other)} that "
            "differ), needed the same; build that bank again, or begin a new run with --start-from."
        )


def _plain(config: ConfigDict) -> dict[str, Any]:
    """Flat dotted keys -> JSON values."""

    def flat(value: Any, prefix: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            return {prefix: value}
        return {k: x for name, part in value.items() for k, x in flat(part, f"{prefix}.{name}".lstrip(".")).items()}

    return flat(json.loads(json.dumps(config.to_dict())), "")


def _differences(part: str, had: ConfigDict, asked: ConfigDict, may_change: tuple[str, ...] = ()) -> list[str]:
    ours, theirs = _plain(had), _plain(asked)
    keys = [k for k in sorted(ours.keys() | theirs.keys()) if k not in may_change]
    return [_difference(f"{part}.{k}", ours.get(k), theirs.get(k)) for k in keys if ours.get(k) != theirs.get(k)]


def _difference(name: str, had: Any, asked: Any) -> str:
    return f"{name} {v.show(asked)} where the run has {v.show(had)}"


def _refuse(folder: pathlib.Path, differences: list[str]) -> None:
    if differences:
        raise ValidationError(
            f"--resume: found {'; '.join(differences)}, needed what {folder / FILE} says (only the number of steps and "
            "of checkpoints may change); leave these options out, or begin a new run with --start-from."
        )
