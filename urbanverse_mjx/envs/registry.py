"""Environments by name, as in MuJoCo Playground; others can register their own from outside the package."""

import difflib
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import jax
from ml_collections import ConfigDict

from .. import settings
from ..datatypes import SceneBank, ValidationError
from .joystick import JoystickEnv
from .joystick.config import JOYSTICK_PRESETS, joystick_config
from .joystick.make import make_joystick_env
from .joystick.ppo import joystick_ppo_config
from .navigation import NavEnv
from .navigation.config import PRESETS, default_config, go2_nav_config
from .navigation.make import make_walking_env, make_wheeled_env
from .navigation.ppo import ppo_config
from .playground import domain_randomize
from .types import StagedEnv

if TYPE_CHECKING:
    from mujoco import mjx

EnvMaker = Callable[[ConfigDict, SceneBank], StagedEnv[Any]]
ConfigMaker = Callable[[str], ConfigDict]
BankLoader = Callable[[], SceneBank]
# Quoted, since beartype resolves unquoted names when the tests of shapes import this module.
type DomainRandomizer = Callable[["mjx.Model", jax.Array], tuple["mjx.Model", "mjx.Model"]]


class _Entry(NamedTuple):
    make: EnvMaker
    make_config: ConfigMaker
    make_ppo_config: ConfigMaker
    load_bank: BankLoader
    preset: str
    presets: tuple[str, ...]


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
) -> None:
    """Adds an environment.

    Args:
      name: CamelCase, new.
      make: (config, bank) -> environment.
      make_config: preset name -> a fresh config.
      load_bank: -> the bank where the user gives none; default: the shipped streets.
      default_preset: where the user names none.
      presets: all that both makers of configs take.
      make_ppo_config: preset name -> a fresh config of its training; default: navigation's.
    """
    if name in _REGISTRY:
        raise ValidationError(f"environment {name!r}: found it registered already, needed a new name.")
    load = load_bank or load_default_bank
    _REGISTRY[name] = _Entry(make, make_config, make_ppo_config, load, default_preset, tuple(presets))
    for follow in _FOLLOWERS:
        follow(name)


def on_registration(follow: Callable[[str], None]) -> None:
    """Calls a function with the name of every registered environment, now and whenever one is added."""
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
        near = difflib.get_close_matches(name, _REGISTRY, 1, 0.4)
        hint = f"did you mean {near[0]!r}?" if near else "see registry.ALL_ENVS"
        raise ValidationError(f"environment: found {name!r}, needed one of {', '.join(all_envs())}; {hint}")
    return _REGISTRY[name]


def presets(name: str) -> tuple[str, ...]:
    """The presets of an environment.

    Raises:
      ValidationError: no environment has this name.
    """
    return _entry(name).presets


def get_default_config(name: str, preset: str | None = None) -> ConfigDict:
    """A fresh, locked config; None takes the environment's own default preset."""
    entry = _entry(name)
    return entry.make_config(preset or entry.preset)


def get_ppo_config(name: str, preset: str | None = None) -> ConfigDict:
    """A fresh, locked config of an environment's training; None takes the environment's own default preset.

    Raises:
      ValidationError: no environment has this name, or its training no such preset.
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


def with_overrides(config: ConfigDict, overrides: Mapping[str, Any]) -> ConfigDict:
    """A copy of `config` with flat dotted keys replaced, e.g. {"reward_config.scales.hit": -50}."""
    copy = ConfigDict(config.to_dict()).lock()
    for key, value in overrides.items():
        try:
            copy.update_from_flattened_dict({key: value})
        except (KeyError, TypeError, ValueError) as error:
            raise ValidationError(f"config override {key!r}: found {value!r}, which does not fit ({error}).") from error
    return copy


def same_task(config: ConfigDict, name: str) -> ConfigDict:
    """The task of one environment's config for the robot of another: all common keys except those of the robot.

    Raises:
      ValidationError: unknown name, or an environment with another action or none of the config's presets.
    """
    theirs = get_default_config(name, config.preset)
    if "action_mode" not in theirs or "action_mode" not in config:
        raise ValidationError(f"environment {name!r}: found another task, needed one of navigation, such as CocoNav.")
    own = ("robot", "drive", "gait", "menagerie", "sim_dt")
    return ConfigDict({k: theirs[k] if k in own else config.get(k, x) for k, x in theirs.items()}).lock()


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
      config: from `get_default_config`; None takes the default of the preset in `config_overrides`, or of its own.
      config_overrides: flat dotted keys; "preset" picks the base when `config` is None.
      bank: scenes; None loads the bank that `urbanverse scene bank` (to walk: `scene terrain`) built last.
    """
    entry = _entry(name)
    overrides = dict(config_overrides or {})
    if config is None:
        config = entry.make_config(overrides.pop("preset", entry.preset))
    return entry.make(with_overrides(config, overrides), bank if bank is not None else entry.load_bank())


def load_nav_env(name: str, config: ConfigDict, bank: SceneBank) -> NavEnv:
    """`load` of an environment that navigates.

    Raises:
      ValidationError: one of another task.
    """
    env = load(name, config=config, bank=bank)
    if not isinstance(env, NavEnv):
        raise ValidationError(f"environment {name!r}: found another task, needed one of navigation, such as CocoNav.")
    return env


def load_default_bank() -> SceneBank:
    """The bank of the six streets in the cache, or the one that `URBANVERSE_BANK` names.

    Raises:
      ValidationError: it has not been built on this machine, or another bank took its place.
    """
    path = settings.default_bank_path()
    return _load_built(path, settings.chosen_bank_path() is None, "urbanverse scene bank` (or `make streets")


def load_terrain_bank() -> SceneBank:
    """The terrain in the cache.

    Raises:
      ValidationError: it has not been built on this machine, or another bank took its place.
    """
    return _load_built(settings.terrain_bank_path(), True, "urbanverse scene terrain")


def _load_built(path: pathlib.Path, keyed: bool, command: str) -> SceneBank:
    """A bank that a command builds; `keyed` where the file's name has a hash of its inputs."""
    if not path.is_file():
        raise ValidationError(f"scene bank: found none at {path}, needed one; run `{command}`.")
    bank = SceneBank.load(path)
    if keyed and bank.key != settings.bank_key(path):
        raise ValidationError(f"{path}: found other scenes than those in its name, needed those; run `{command}`.")
    return bank


register_environment("CocoNav", make_wheeled_env, default_config)
register_environment("Go2Nav", make_walking_env, go2_nav_config)
register_environment(
    "Go2Joystick",
    make_joystick_env,
    joystick_config,
    load_terrain_bank,
    "fast",
    JOYSTICK_PRESETS,
    joystick_ppo_config,
)
