"""Exports a trained locomotion policy as `Gait`, a file that needs neither Brax nor the environment."""

import pathlib
from typing import Any

import numpy as np
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..envs.joystick.legs import Legs
from ..envs.robot import make_robot
from ..robots.gait import Gait
from .policy import PolicySpec, latest_policy, load_params


def export_gait(source: pathlib.Path, meta: dict[str, Any] | None = None) -> Gait:
    """Makes a gait from the actor of the newest policy under `source`.

    Args:
      meta: additional metadata, such as the duration of the training.

    Raises:
      ValidationError: there is no policy, or it belongs to another task.
    """
    folder = latest_policy(source)
    spec = PolicySpec.load(folder)
    config = ConfigDict(spec.env_config)
    if "history" not in spec.observations or "actor_hidden" not in spec.ppo_config["network"]:
        raise ValidationError(
            f"export-gait: found a policy of {spec.environment} in {folder}, needed one of a walking task."
        )
    layers = load_params(folder)[1]["params"]["mean"]
    names = [*sorted((n for n in layers if n.startswith("hidden_")), key=lambda n: int(n.split("_")[1])), "out"]
    kernels, biases = (tuple(np.asarray(layers[n][part], np.float32) for n in names) for part in ("kernel", "bias"))
    # The last layer outputs the means; the standard deviations are a separate parameter.
    legs = Legs(make_robot(config), tuple(config.action_scale))
    facts = {
        "robot": config.robot,
        "environment": spec.environment,
        "steps": spec.steps,
        "seed": int(spec.ppo_config["seed"]),
        "versions": spec.versions,
        **(meta or {}),
    }
    stand, scale = np.asarray(legs.stand), np.asarray(legs.scale)
    return Gait(kernels, biases, stand, scale, int(config.history), float(config.ctrl_dt), facts)
