"""From a policy folder to a gait file: the numbers that the policy gives, without Brax."""

import pathlib

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from brax.training.acme import running_statistics
from ml_collections import ConfigDict

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs.joystick.config import joystick_config
from urbanverse_mjx.envs.navigation.config import default_config
from urbanverse_mjx.robots import go2_body
from urbanverse_mjx.robots.gait import Gait
from urbanverse_mjx.training.config import default_ppo_config
from urbanverse_mjx.training.export_gait import export_gait
from urbanverse_mjx.training.policy import PolicySpec, initial_params, load_policy, save_policy

SEEN = {"history": [225], "privileged": [10]}


def _spec(environment: str, config: ConfigDict) -> PolicySpec:
    ppo = default_ppo_config("cpu", environment).to_dict()
    return PolicySpec(environment, config.to_dict(), ppo, SEEN, 12, ["flat-0"], {}, 4096, {"jax": "x"})


def save_walking_policy(folder: pathlib.Path) -> None:
    spec = _spec("Go2Joystick", joystick_config("cpu"))
    _, actor, critic = initial_params(SEEN, 12, ConfigDict(spec.ppo_config), 1)
    # First weights of the last layer are so small that any action would be near 0.
    out = actor["params"]["mean"]["out"]
    out["kernel"] = 50.0 * out["kernel"]
    # The statistics that Brax keeps and these networks do not use.
    sizes = {name: jnp.zeros(shape) for name, shape in SEEN.items()}
    save_policy(folder, (running_statistics.init_state(sizes), actor, critic), spec)


@pytest.mark.extended
def test_gait_acts_as_the_policy(tmp_path: pathlib.Path) -> None:
    save_walking_policy(tmp_path / "run" / "checkpoints")
    out = tmp_path / "gait.npz"
    export_gait(tmp_path / "run", {"wall_seconds": 5}).save(out)
    gait = Gait.load(out)
    assert gait.meta["wall_seconds"] == 5
    assert (gait.meta["robot"], gait.meta["steps"], gait.history, gait.control_dt) == ("go2", 4096, 5, 0.02)
    np.testing.assert_allclose(gait.stand, go2_body.stand_pose(), atol=1e-6)
    np.testing.assert_allclose(gait.scale, np.tile([0.4, 1.0, 1.0], 4), atol=1e-6)
    act, _ = load_policy(tmp_path / "run")
    seen = np.random.default_rng(0).normal(size=(5, 225)).astype(np.float32)
    expected = act({"history": jnp.asarray(seen), "privileged": jnp.zeros((5, 10))}, jax.random.key(0))
    found = gait.action(np, seen)
    np.testing.assert_allclose(found, np.asarray(expected), atol=1e-5)
    assert np.abs(found).max() > 0.1


def test_a_policy_that_drives_is_no_gait(tmp_path: pathlib.Path) -> None:
    _spec("CocoNav", default_config("cpu")).save(tmp_path)
    with pytest.raises(ValidationError, match="a policy of CocoNav"):
        export_gait(tmp_path)
