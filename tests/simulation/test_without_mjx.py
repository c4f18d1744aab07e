"""Warp without MJX: what is computed in its place, and an environment in a process that cannot import it."""

import subprocess
import sys

import jax
import mujoco
import numpy as np
import pytest

from urbanverse_mjx.robots import make_coco, make_go2
from urbanverse_mjx.simulation import kinematics

#: A chain with every kind of joint, anchors off the bodies' origins, and a body without a joint.
CHAIN = """
<mujoco><worldbody><body pos="1 2 3"><freejoint/><geom size=".1"/>
 <body pos=".1 .2 .3" quat=".8 .6 0 0"><geom size=".1"/>
  <joint type="hinge" axis="1 2 -1" pos=".1 0 .2" ref="20"/>
  <body pos="0 .3 0"><geom size=".1"/>
   <joint type="slide" axis="0 1 1" ref=".1"/><joint type="hinge" axis="0 0 1" pos="0 .2 0"/>
   <body pos=".2 0 0" quat="0 1 0 0"><geom size=".1"/>
    <body pos="0 0 .4"><joint type="ball" pos=".1 .1 0"/><geom size=".1"/></body></body></body></body>
 <body pos="-.2 0 0"><joint type="hinge" axis="0 1 0"/><geom size=".1"/></body></body></worldbody></mujoco>
"""

RUN = """
import sys
sys.modules["mujoco.mjx"] = None
import jax, numpy as np
from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.envs import registry

settings, bank = {"vision": False}, box_bank(2, seed=0)
for impl in ("warp", "warp-fused"):
    env = registry.load("CocoNav", config_overrides={**settings, "impl": impl}, bank=bank)
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 3))
    before = np.array(state.data.qpos)
    step = jax.jit(jax.vmap(env.step))
    for _ in range(5):
        state = step(state, np.tile(np.float32([1.0, 0.0]), (3, 1)))
    moved = np.linalg.norm(np.array(state.data.qpos)[:, :2] - before[:, :2], axis=1)
    assert np.isfinite(np.array(state.data.qpos)).all(), impl
    assert moved.max() > 0.1, (impl, moved)
try:
    registry.load("CocoNav", config_overrides={**settings, "impl": "jax"}, bank=bank)
except ValidationError as error:
    assert "mujoco-mjx" in str(error)
else:
    raise AssertionError("the jax engine ran without MJX")
print("drove")
"""


@pytest.mark.parametrize("name", ["coco", "go2", "chain"])
def test_kinematics_are_those_of_c_mujoco(name: str) -> None:
    mjcf = CHAIN if name == "chain" else (make_coco() if name == "coco" else make_go2()).mjcf
    model = mujoco.MjModel.from_xml_string(mjcf)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    qpos = (model.qpos0 + rng.uniform(-1, 1, (20, model.nq))).astype(np.float32)
    found = jax.jit(jax.vmap(lambda q: kinematics.forward(model, q)))(qpos)
    for i, start in enumerate(qpos):
        data.qpos[:] = start
        mujoco.mj_kinematics(model, data)
        mujoco.mj_normalizeQuat(model, data.qpos)
        for ours, theirs in zip(found, (data.qpos, data.xpos, data.xquat), strict=True):
            np.testing.assert_allclose(np.array(ours[i]), theirs, atol=3e-6)


@pytest.mark.extended
def test_environments_on_warp_run_where_mjx_cannot_be_imported() -> None:
    done = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[-1] == "drove"
