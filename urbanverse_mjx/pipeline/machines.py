"""Loads a policy by name or file together with its environment, for viewers and recorders."""

import pathlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..datatypes import SceneBank, ValidationError

if TYPE_CHECKING:
    from ..viewer.session import Machine

#: (height, width) px of the camera image for a policy without images.
IMAGE_SIZE = (90, 160)


def load_machine(
    policy: str,
    bank: SceneBank,
    people: bool = False,
    env_name: str | None = None,
    preset: str = "cpu",
    image_size: tuple[int, int] | None = IMAGE_SIZE,
    overrides: Mapping[str, Any] | None = None,
) -> "Machine":
    """Makes an environment over all scenes of a bank, without randomisation, and loads the policy.

    Args:
      policy: zero, random, go_to_goal, planner, a policy or run folder, or FILE.onnx.
      people: whether there are moving people and vehicles.
      env_name: environment whose robot is driven; None for that of the policy's training, CocoNav for scripted
        policies.
      preset: preset of the environment, for policies without one.
      image_size: (height, width) in pixels of the camera image for policies without images; None for no image.
      overrides: flat dotted keys of the environment's config, over those of the policy or preset.

    Raises:
      ValidationError: the policy does not exist, or has another task.
    """
    from ..envs import registry
    from ..evaluation.agents import BASELINES
    from ..evaluation.task_agents import planner_of
    from ..viewer.session import Machine, NamedPolicy

    overrides = overrides or {}
    if policy in BASELINES or policy == "planner":
        config = registry.with_overrides(_fresh_config(env_name, people, preset, image_size), overrides)
        env = registry.load_nav_env(env_name or "CocoNav", config, bank)
        return Machine(env, NamedPolicy(policy, planner_of(env) if policy == "planner" else BASELINES[policy]))
    path = pathlib.Path(policy).expanduser()
    if policy.endswith(".onnx"):
        return _onnx_machine(path, bank, people, env_name, preset, image_size, overrides)
    if not path.is_dir():
        known = ", ".join((*BASELINES, "planner"))
        raise ValidationError(f"--policy: found {policy!r}, needed one of {known}, a policy folder or an ONNX file.")
    from ..training.policy import latest_policy, load_policy
    from ..training.policy_files import content_sha256

    folder = latest_policy(path)
    agent, spec = load_policy(folder)
    name, config = _trained_config(spec.environment, spec.env_config, people, env_name)
    config = registry.with_overrides(config, overrides)
    named = NamedPolicy(path.name, agent, loaded=folder.name, sha256=content_sha256(folder))
    return Machine(registry.load_nav_env(name, config, bank), named)


def _onnx_machine(
    path: pathlib.Path,
    bank: SceneBank,
    people: bool,
    env_name: str | None,
    preset: str,
    image_size: tuple[int, int] | None,
    overrides: Mapping[str, Any],
) -> "Machine":
    from ..envs import registry
    from ..evaluation.onnx_policy import content_sha256, load_onnx
    from ..policies.onnx_agent import PROPRIO
    from ..viewer.session import Machine, NamedPolicy

    policy = load_onnx(path)
    if policy.record is not None:
        name, config = _trained_config(policy.record.environment, policy.record.env_config, people, env_name)
    else:
        size = policy.size or (image_size or IMAGE_SIZE if policy.sees else image_size)
        name, config = env_name or "CocoNav", _fresh_config(env_name, people, preset, size)
        config = registry.with_overrides(config, {"observations.proprio": PROPRIO in policy.observations})
    config = registry.with_overrides(config, overrides)
    named = NamedPolicy(path.name, policy, outside=True, loaded=path.name, sha256=content_sha256(path))
    return Machine(registry.load_nav_env(name, config, bank), named)


def _fresh_config(env_name: str | None, people: bool, preset: str, size: tuple[int, int] | None) -> Any:
    from ..envs import registry
    from .evaluation import evaluation_config

    name = env_name or "CocoNav"
    config = registry.get_default_config(name, preset)
    if "goal_mode" not in config:
        raise ValidationError(
            f"--env-name: found {name!r}, whose robot has no goal to drive to, needed a navigation environment such as "
            "CocoNav or Go2Nav."
        )
    config = evaluation_config(name, config.to_dict(), "all", people)
    if size is None:
        return registry.with_overrides(config, {"vision": False})
    height, width = size
    return registry.with_overrides(
        config, {"vision": True, "vision_config.height": height, "vision_config.width": width}
    )


def _trained_config(environment: str, trained: Any, people: bool, env_name: str | None) -> tuple[str, Any]:
    """The name and config of a policy's environment, with the engine for this machine."""
    from ml_collections import ConfigDict

    from ..envs import registry
    from .evaluation import evaluation_config

    config, name = ConfigDict(dict(trained)), env_name or environment
    if name != environment:
        config = registry.same_task(config, name)
    config = evaluation_config(name, config.to_dict(), "all", people)
    return name, registry.with_overrides(config, {"impl": "auto"})
