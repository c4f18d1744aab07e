"""Environments by name, as in MuJoCo Playground; others can register their own from outside the package."""

import difflib
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import mujoco
from ml_collections import ConfigDict

from .. import settings
from ..datatypes import AgentShapes, NounError, RobotSpec, SceneBank
from .joystick import JoystickEnv
from .joystick.config import JOYSTICK_PRESETS, joystick_config
from .navigation import NavEnv
from .navigation.config import PRESETS, default_config, go2_nav_config
from .navigation.living import slot_kinds, slot_looks, slot_shapes
from .navigation.movables import body_sizes
from .navigation.scenarios import bank_for, scenario_of

EnvMaker = Callable[[ConfigDict, SceneBank], Any]
ConfigMaker = Callable[[str], ConfigDict]
BankLoader = Callable[[], SceneBank]


class _Entry(NamedTuple):
    make: EnvMaker
    make_config: ConfigMaker
    load_bank: BankLoader
    preset: str
    presets: tuple[str, ...]


_REGISTRY: dict[str, _Entry] = {}


def register_environment(
    name: str,
    make: EnvMaker,
    make_config: ConfigMaker,
    load_bank: BankLoader | None = None,
    default_preset: str = "paper",
    presets: Sequence[str] = PRESETS,
) -> None:
    """Adds an environment.

    Args:
      name: CamelCase, new.
      make: (config, bank) -> environment.
      make_config: preset name -> a fresh config.
      load_bank: -> the bank where the user gives none; default: the shipped streets.
      default_preset: where the user names none. presets: all that `make_config` takes.
    """
    if name in _REGISTRY:
        raise NounError(f"environment {name!r}: found it registered already, needed a new name.")
    _REGISTRY[name] = _Entry(make, make_config, load_bank or load_default_bank, default_preset, tuple(presets))


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
        raise NounError(f"environment: found {name!r}, needed one of {', '.join(all_envs())}; {hint}")
    return _REGISTRY[name]


def presets(name: str) -> tuple[str, ...]:
    """The presets of an environment.

    Raises:
      NounError: no environment has this name.
    """
    return _entry(name).presets


def get_default_config(name: str, preset: str | None = None) -> ConfigDict:
    """A fresh, locked config; None takes the environment's own default preset."""
    entry = _entry(name)
    return entry.make_config(preset or entry.preset)


def with_overrides(config: ConfigDict, overrides: Mapping[str, Any]) -> ConfigDict:
    """A copy of `config` with flat dotted keys replaced, e.g. {"reward_config.scales.hit": -50}."""
    copy = ConfigDict(config.to_dict()).lock()
    for key, value in overrides.items():
        try:
            copy.update_from_flattened_dict({key: value})
        except (KeyError, TypeError, ValueError) as error:
            raise NounError(f"config override {key!r}: found {value!r}, which does not fit ({error}).") from error
    return copy


def same_task(config: ConfigDict, name: str) -> ConfigDict:
    """The task of one environment's config for the robot of another: all that both have but what a robot is made of.

    Raises:
      NounError: unknown name, or an environment with another action or none of the config's presets.
    """
    theirs = get_default_config(name, config.preset)
    if "action_mode" not in theirs or "action_mode" not in config:
        raise NounError(f"environment {name!r}: found another task, needed one of navigation, such as CocoNav.")
    own = ("robot", "drive", "gait", "menagerie", "sim_dt")
    return ConfigDict({k: theirs[k] if k in own else config.get(k, x) for k, x in theirs.items()}).lock()


def load(
    name: str,
    config: ConfigDict | None = None,
    config_overrides: Mapping[str, Any] | None = None,
    bank: SceneBank | None = None,
) -> Any:
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


def load_default_bank() -> SceneBank:
    """The bank of the six streets in the cache, or the one that `URBANVERSE_BANK` names.

    Raises:
      NounError: it has not been built on this machine, or another bank took its place.
    """
    path = settings.default_bank_path()
    return _load_built(path, settings.chosen_bank_path() is None, "urbanverse scene bank` (or `make streets")


def load_terrain_bank() -> SceneBank:
    """The terrain in the cache.

    Raises:
      NounError: it has not been built on this machine, or another bank took its place.
    """
    return _load_built(settings.terrain_bank_path(), True, "urbanverse scene terrain")


def _load_built(path: pathlib.Path, keyed: bool, command: str) -> SceneBank:
    """A bank that a command builds; `keyed` where the file's name says what it is made of."""
    if not path.is_file():
        raise NounError(f"scene bank: found none at {path}, needed one; run `{command}`.")
    bank = SceneBank.load(path)
    if keyed and bank.key != settings.bank_key(path):
        raise NounError(f"{path}: found other scenes than its name says, needed those; run `{command}`.")
    return bank


def make_robot(config: ConfigDict) -> RobotSpec:
    """The robot a config names: "coco", "go2", "wheelchair", or a robot.json of one's own (see `robots.load`)."""
    from .. import robots

    if config.robot == "go2":
        return robots.make_go2(config.get("menagerie") or None)
    if config.robot == "coco":
        return robots.make_coco(drive=config.drive)
    return robots.load(config.robot)


def _check_fit(config: ConfigDict, robot: RobotSpec) -> None:
    """Raises `NounError` where a robot and a navigation config do not go together."""
    if config.sim_dt > robot.physics_timestep + 1e-9:
        raise NounError(
            f"config.sim_dt: found {config.sim_dt:g} s, needed at most the {robot.physics_timestep:g} s that the MJCF "
            f"of {robot.name!r} asks for; override sim_dt."
        )
    told, motors = robot.command(jnp.zeros(2)).shape[0], mujoco.MjModel.from_xml_string(robot.mjcf).nu
    if "gait" not in config and told != motors:
        raise NounError(
            f"config.robot: found {robot.name!r}, which walks by a gait, needed a robot on wheels; take Go2Nav with "
            "robot and gait overridden."
        )


def make_nav_engine(
    config: ConfigDict,
    bank: SceneBank,
    robot: RobotSpec,
    num_slots: int,
    agents: AgentShapes | None = None,
    movable: dict[str, int] | None = None,
) -> Any:
    """The engine that a navigation config asks for, with a gait in it where the robot walks.

    Raises:
      NounError: moving agents around a robot with a gait, which no engine knows yet.
    """
    from ..simulation.engines import make_engine
    from ..simulation.slots.body_slots import Sizes

    options = {"impl": config.impl, "physics_dt": config.sim_dt, "num_slots": num_slots}
    if "gait" not in config:
        options["movable"] = None if movable is None else Sizes(**movable)
        return make_engine(bank, robot, control_dt=config.ctrl_dt, agents=agents, **options)
    if agents is not None:
        raise NounError("config.scenario: found 'dynamic' for a robot with a gait, needed 'clean' or 'static'.")
    from ..robots.go2 import load_gait
    from ..simulation.gait_engine import GaitEngine

    gait = load_gait(config.gait or None)
    engine = make_engine(bank, robot, control_dt=gait.control_dt, **options)
    return GaitEngine(engine, robot, gait, config.ctrl_dt)


def make_nav_env(config: ConfigDict, bank: SceneBank) -> NavEnv:
    """A `NavEnv` with the engine and the renderer its config asks for."""
    scenario = scenario_of(config)
    bank = bank_for(scenario, bank)
    kinds = slot_kinds(config.crowd) if scenario == "dynamic" else ()
    robot = make_robot(config)
    if abs(config.ctrl_dt / config.sim_dt - round(config.ctrl_dt / config.sim_dt)) > 1e-6:
        raise NounError(
            f"config.ctrl_dt: found {config.ctrl_dt} s with sim_dt {config.sim_dt} s, needed a whole number of steps."
        )
    if "gait" in config and config.action_mode == "joint":
        raise NounError("config.action_mode: found 'joint' for a robot with a gait, needed 'waypoint' or 'velocity'.")
    _check_fit(config, robot)
    movable = body_sizes(config)
    engine = make_nav_engine(config, bank, robot, config.num_slots, slot_shapes(kinds) if kinds else None, movable)
    renderer = None
    if config.vision:
        from ..simulation.rendering.renderer import Renderer

        view = config.vision_config
        outputs = ("rgb", "depth") if view.depth else ("rgb",)
        renderer = Renderer(
            bank,
            robot,
            view.height,
            view.width,
            outputs=outputs,
            sky=view.sky,
            shadows=view.shadows,
            shading=view.shading,
            appearance=config.randomization.appearance,
            agents=slot_looks(kinds, bank),
            bodies=0 if movable is None else movable["bodies"],
        )
    return NavEnv(config, bank, robot, engine, renderer)


def make_joystick_env(config: ConfigDict, bank: SceneBank) -> JoystickEnv:
    """A `JoystickEnv` with the engine its config asks for; nothing is drawn."""
    from ..simulation.engines import make_engine

    robot = make_robot(config)
    engine = make_engine(
        bank,
        robot,
        impl=config.impl,
        control_dt=config.ctrl_dt,
        physics_dt=config.sim_dt,
        num_slots=0,
        **config.engine,
    )
    return JoystickEnv(config, bank, robot, engine)


register_environment("CocoNav", make_nav_env, default_config)
register_environment("Go2Nav", make_nav_env, go2_nav_config)
register_environment("Go2Joystick", make_joystick_env, joystick_config, load_terrain_bank, "fast", JOYSTICK_PRESETS)
