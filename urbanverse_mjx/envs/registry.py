"""Registry of environments by name, as in MuJoCo Playground; users can register their own."""

import functools
import math
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import jax
from ml_collections import ConfigDict

from .. import settings
from ..datatypes import SceneBank, ValidationError
from ..datatypes import validation as v
from ..robots import catalogue, legged
from .joystick import JoystickEnv
from .joystick.config import JOYSTICK_PRESETS, joystick_config, legged_joystick_config
from .joystick.make import make_joystick_env
from .joystick.ppo import joystick_ppo_config
from .navigation import NavEnv
from .navigation.config import PRESETS, catalogue_config, default_config, go2_nav_config, legged_nav_config
from .navigation.draws import CAMERA_NOISE, OFF
from .navigation.make import make_walking_env, make_wheeled_env
from .navigation.ppo import deliver_ppo_config, follow_route_ppo_config, ppo_config
from .navigation.tasks.config import (
    cross_street_config,
    deliver_config,
    drop_off_config,
    follow_person_config,
    follow_route_config,
    multi_robot_config,
    object_goal_config,
    social_nav_config,
)
from .playground import domain_randomize
from .types import StagedEnv

if TYPE_CHECKING:
    from mujoco import mjx

EnvMaker = Callable[[ConfigDict, SceneBank], StagedEnv[Any]]
ConfigMaker = Callable[[str], ConfigDict]
BankLoader = Callable[[], SceneBank]
# Quoted, because beartype would resolve unquoted names at import in the tests of shapes.
type DomainRandomizer = Callable[["mjx.Model", jax.Array], tuple["mjx.Model", "mjx.Model"]]


class _Entry(NamedTuple):
    make: EnvMaker
    make_config: ConfigMaker
    make_ppo_config: ConfigMaker
    load_bank: BankLoader
    preset: str
    presets: tuple[str, ...]
    about: str


_REGISTRY: dict[str, _Entry] = {}
_FOLLOWERS: list[Callable[[str], None]] = []


def register_environment(
    name: str,
    make: EnvMaker,
    make_config: ConfigMaker,
    load_bank: BankLoader | None = None,
    default_preset: str = "paper",
    presets: Sequence[str] = PRESETS,
    make_ppo_config: ConfigMaker = ppo_config,
    about: str = "",
) -> None:
    """Adds an environment.

    Args:
      name: new name in CamelCase.
      make: function (config, bank) -> environment.
      make_config: function preset name -> new config.
      load_bank: function that returns the default bank; default: the shipped streets.
      default_preset: preset to use if the user names none.
      presets: presets that both `make_config` and `make_ppo_config` accept.
      make_ppo_config: function preset name -> new training config; default: that of navigation.
      about: what the robot has to do, in a line.
    """
    if name in _REGISTRY:
        raise ValidationError(f"environment {name!r}: found it registered already, needed a new name.")
    load = load_bank or load_default_bank
    _REGISTRY[name] = _Entry(make, make_config, make_ppo_config, load, default_preset, tuple(presets), about)
    for follow in _FOLLOWERS:
        follow(name)


def on_registration(follow: Callable[[str], None]) -> None:
    """Calls a function with the name of every registered environment, now and whenever one is registered."""
    _FOLLOWERS.append(follow)
    for name in all_envs():
        follow(name)


def all_envs() -> tuple[str, ...]:
    """Names of all registered environments, also those registered after import."""
    return tuple(sorted(_REGISTRY))


def __getattr__(name: str) -> Any:
    if name == "ALL_ENVS":
        return all_envs()
    raise AttributeError(name)


def _entry(name: str) -> _Entry:
    if name not in _REGISTRY:
        hint = v.did_you_mean(name, _REGISTRY, cutoff=0.4) or "see registry.ALL_ENVS"
        raise v.fail("environment", repr(name), f"one of {', '.join(all_envs())}", hint)
    return _REGISTRY[name]


def presets(name: str) -> tuple[str, ...]:
    """The presets of an environment.

    Raises:
      ValidationError: no environment has this name.
    """
    return _entry(name).presets


def about(name: str) -> str:
    """What the robot of an environment has to do, in a line; "" if its registration did not say.

    Raises:
      ValidationError: no environment has this name.
    """
    return _entry(name).about


def get_default_config(name: str, preset: str | None = None) -> ConfigDict:
    """A fresh, locked config; None takes the environment's own default preset."""
    entry = _entry(name)
    return entry.make_config(preset or entry.preset)


def get_ppo_config(name: str, preset: str | None = None) -> ConfigDict:
    """A fresh, locked config of an environment's training; None takes the environment's own default preset.

    Raises:
      ValidationError: no environment has this name, or its training has no such preset.
    """
    entry = _entry(name)
    return entry.make_ppo_config(preset or entry.preset).lock()


def get_domain_randomizer(name: str) -> DomainRandomizer:
    """`randomization_fn` for Playground's and Brax's wrappers, in addition to `config.randomization`.

    Raises:
      ValidationError: no environment has this name.
    """
    _entry(name)
    return domain_randomize


def bank_loader(name: str) -> BankLoader:
    """Loader of an environment's default bank.

    Raises:
      ValidationError: no environment has this name.
    """
    return _entry(name).load_bank


#: Keys that configs of older policies lack, and what those were trained with.
_ADDED: dict[str, Any] = {
    "vision_config.light": "direct",
    "friction": "uniform",
    "observations.robot": False,
    "observations.clear_arcs": False,
    "schedule.places": 0,
    "schedule.exchange_steps": 0,
    **{f"randomization.{name}": OFF[name] for name in ("wet", "latency", *CAMERA_NOISE)},
}


def _complete(config: ConfigDict, key: str) -> None:
    """Adds a key of `_ADDED` to a config that has its section but not the key."""
    *sections, name = key.split(".")
    for section in sections:
        if section not in config:
            return
        config = config[section]
    if name not in config:
        config[name] = _ADDED[key]


def with_overrides(config: ConfigDict, overrides: Mapping[str, Any]) -> ConfigDict:
    """A copy of `config` with flat dotted keys replaced, e.g. {"reward_config.scales.hit": -50}.

    Raises:
      ValidationError: the config has no such key, or a value of another type.
    """
    copy = ConfigDict(config.to_dict())
    for key in _ADDED.keys() & overrides.keys():
        _complete(copy, key)
    copy.lock()
    for key, value in overrides.items():
        had = _value_of(copy, key)
        try:
            copy.update_from_flattened_dict({key: value})
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(had, ConfigDict):
                needed, hint = "one of its keys", f"write {key}.{next(iter(had), 'KEY')}"
            else:
                needed, hint = f"a value of the type of {had!r}, which it replaces", ""
            raise v.fail(f"config override {key!r}", v.show(value), needed, hint) from error
    return copy


def _value_of(config: ConfigDict, key: str) -> Any:
    """The value of a flat dotted key.

    Raises:
      ValidationError: there is none.
    """
    value: Any = config
    for k, name in enumerate(names := key.split(".")):
        if not isinstance(value, ConfigDict) or name not in value:
            section = f"{'.'.join(names[:k])!r}" if k else "the config"
            if not isinstance(value, ConfigDict):
                raise v.fail(f"config override {key!r}", f"no keys in {section}", f"{section} itself")
            known = sorted(value)
            found = f"no {name!r} in {section}"
            raise v.fail(f"config override {key!r}", found, f"one of {', '.join(known)}", v.did_you_mean(name, known))
        value = value[name]
    return value


def same_task(config: ConfigDict, name: str) -> ConfigDict:
    """Transfers the task of an environment's config to the robot of another environment: copies all common keys except
    those of the robot.

    Raises:
      ValidationError: the name is unknown, or the environment has another action or none of the config's presets.
    """
    theirs = get_default_config(name, config.preset)
    if "action_mode" not in theirs or "action_mode" not in config:
        raise ValidationError(f"environment {name!r}: found another task, needed one of navigation, such as CocoNav.")
    own = ("robot", "drive", "gait", "menagerie", "sim_dt")
    return ConfigDict({k: theirs[k] if k in own else config.get(k, _ADDED.get(k, x)) for k, x in theirs.items()}).lock()


@overload
def load(
    name: Literal["CocoNav", "Go2Nav"],
    config: ConfigDict | None = None,
    config_overrides: Mapping[str, Any] | None = None,
    bank: SceneBank | None = None,
) -> NavEnv: ...
@overload
def load(
    name: Literal["Go2Joystick"],
    config: ConfigDict | None = None,
    config_overrides: Mapping[str, Any] | None = None,
    bank: SceneBank | None = None,
) -> JoystickEnv: ...
@overload
def load(
    name: str,
    config: ConfigDict | None = None,
    config_overrides: Mapping[str, Any] | None = None,
    bank: SceneBank | None = None,
) -> StagedEnv[Any]: ...
def load(
    name: str,
    config: ConfigDict | None = None,
    config_overrides: Mapping[str, Any] | None = None,
    bank: SceneBank | None = None,
) -> StagedEnv[Any]:
    """Builds an environment.

    Args:
      name: a registered name, e.g. "CocoNav".
      config: config of `get_default_config`; None for that of the preset in `config_overrides`, or of the default
        preset.
      config_overrides: flat dotted keys; "preset" selects the base if `config` is None.
      bank: bank of scenes; None for the one that `urbanverse scene bank` (for locomotion: `scene terrain`) built last.

    Raises:
      ValidationError: a name or key is unknown, or a value is not possible.
    """
    entry = _entry(name)
    overrides = dict(config_overrides or {})
    if config is None:
        config = entry.make_config(overrides.pop("preset", entry.preset))
    config = with_overrides(config, overrides)
    check_numbers(config)
    return entry.make(config, bank if bank is not None else entry.load_bank())


def check_numbers(config: ConfigDict) -> None:
    """Refuses a config with numbers that no environment can have.

    Raises:
      ValidationError: a number is NaN or infinite, a time step is not positive, or an episode has no step.
    """
    _refuse_infinite(config.to_dict(), "config")
    for key in ("ctrl_dt", "sim_dt"):
        if key in config:
            v.number(config[key], f"config.{key}", above=0.0)
    if "episode_length" in config:
        v.integer(config.episode_length, "config.episode_length", 1)


def _refuse_infinite(value: Any, where: str) -> None:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            _refuse_infinite(inner, f"{where}.{key}")
    elif isinstance(value, list | tuple):
        for i, inner in enumerate(value):
            _refuse_infinite(inner, f"{where}[{i}]")
    elif isinstance(value, float) and not math.isfinite(value):
        raise v.fail(where, v.show(value), "a finite number")


def load_nav_env(name: str, config: ConfigDict, bank: SceneBank) -> NavEnv:
    """`load` for navigation environments.

    Raises:
      ValidationError: the environment has another task.
    """
    env = load(name, config=config, bank=bank)
    if not isinstance(env, NavEnv):
        raise ValidationError(f"environment {name!r}: found another task, needed one of navigation, such as CocoNav.")
    return env


def load_default_bank() -> SceneBank:
    """The bank of the six shipped streets in the cache, or that of `URBANVERSE_BANK`.

    Raises:
      ValidationError: it has not been built on this machine, or another bank took its place.
    """
    path = settings.default_bank_path()
    return _load_built(path, settings.chosen_bank_path() is None, "urbanverse scene bank` (or `make streets")


def load_terrain_bank() -> SceneBank:
    """The terrain bank in the cache.

    Raises:
      ValidationError: it has not been built on this machine, or another bank took its place.
    """
    return _load_built(settings.terrain_bank_path(), True, "urbanverse scene terrain")


def _load_built(path: pathlib.Path, keyed: bool, command: str) -> SceneBank:
    """Loads a bank that a command builds; `keyed`: the file's name contains a hash of its inputs."""
    if not path.exists():
        raise ValidationError(f"scene bank: found none at {path}, needed one; run `{command}`.")
    bank = SceneBank.load(path)
    if keyed and bank.key != settings.bank_key(path):
        raise ValidationError(f"{path}: found other scenes than those in its name, needed those; run `{command}`.")
    return bank


register_environment(
    "CocoNav", make_wheeled_env, default_config, about="COCO drives to a goal 10-30 m away on the pavement of a street"
)
register_environment(
    "Go2Nav", make_walking_env, go2_nav_config, about="Go2 walks to a goal 10-30 m away on the pavement of a street"
)
register_environment(
    "CocoSocialNav",
    make_wheeled_env,
    social_nav_config,
    about="COCO drives to a goal through a dense crowd without troubling people",
)
register_environment(
    "CocoFollowPerson",
    make_wheeled_env,
    follow_person_config,
    about="COCO keeps 1.5-3 m from one pedestrian through a crowd",
)
register_environment(
    "CocoFollowRoute",
    make_wheeled_env,
    follow_route_config,
    make_ppo_config=follow_route_ppo_config,
    about="COCO follows pavements and crosswalks with signals over 200 m",
)
register_environment(
    "CocoCrossStreet",
    make_wheeled_env,
    cross_street_config,
    about="COCO crosses a road where cars come, at crosswalks with stripes and without",
)
register_environment(
    "CocoObjectGoal",
    make_wheeled_env,
    object_goal_config,
    about="COCO finds a named object, such as the red postbox, and stops beside it",
)
register_environment(
    "CocoMultiRobot",
    make_wheeled_env,
    multi_robot_config,
    about="COCO delivers to and fro in a street that it shares with other COCOs",
)
register_environment(
    "CocoDeliver",
    make_wheeled_env,
    deliver_config,
    presets=tuple(name for name in PRESETS if name != "quick"),
    make_ppo_config=deliver_ppo_config,
    about="COCO with an arm drives up to a post and presses its doorbell",
)
register_environment(
    "CocoDropOff",
    make_wheeled_env,
    drop_off_config,
    presets=tuple(name for name in PRESETS if name != "quick"),
    make_ppo_config=deliver_ppo_config,
    about="COCO with an arm drives up to a box and drops a parcel into it",
)
register_environment(
    "Go2Joystick",
    make_joystick_env,
    joystick_config,
    load_terrain_bank,
    "fast",
    JOYSTICK_PRESETS,
    joystick_ppo_config,
    about="Go2 learns the gait that follows a commanded velocity",
)
for _robot in legged.NAMES:
    _legged = legged.row(_robot)
    if _legged.walk is not None:
        register_environment(
            legged.joystick_name(_robot),
            make_joystick_env,
            functools.partial(legged_joystick_config, _robot),
            load_terrain_bank,
            "fast",
            JOYSTICK_PRESETS,
            joystick_ppo_config,
            about=f"{_legged.title} learns the gait that follows a commanded velocity",
        )
    # A robot that walks has this task once its gait is shipped.
    if _robot != "go2" and (_legged.drive != "gait" or legged.gait_path(_robot).is_file()):
        register_environment(
            catalogue.environment_name(_robot),
            make_walking_env if _legged.drive == "gait" else make_wheeled_env,
            functools.partial(legged_nav_config, _robot),
            about=f"{_legged.title} ({_legged.kind}) moves to a goal 10-30 m away on the pavement of a street",
        )
for _robot in catalogue.NAMES:
    _row = catalogue.row(_robot)
    register_environment(
        catalogue.environment_name(_robot),
        make_walking_env if _row.drive == "balance" else make_wheeled_env,
        functools.partial(catalogue_config, _robot),
        about=f"{_row.title} ({_row.kind}) drives to a goal 10-30 m away on the pavement of a street",
    )
