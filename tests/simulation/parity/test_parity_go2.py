"""The Go2 in both engines against C MuJoCo: standing, stepping in place, landing on a kerb and a slope.

Legs in contact are chaotic, so differences are asked for over short times.
"""

import functools

import numpy as np
import pytest

from urbanverse_mjx.datatypes import GroundRegion, SceneBank
from urbanverse_mjx.robots import make_go2
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import pack_regions, region_scene
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco

CONTROL_DT, STEPS = 0.02, 30
#: m: before any foot has touched; 0.1 s and 0.6 s after the start (the fall from 2 cm ends after 0.07 s).
FLIGHT, LANDED, LATER = 2e-5, 5e-4, 1e-2


def _regions(shape: str) -> list[GroundRegion]:
    left = ((-8.0, -8.0), (0.05, -8.0), (0.05, 8.0), (-8.0, 8.0))
    right = ((0.05, -8.0), (8.0, -8.0), (8.0, 8.0), (0.05, 8.0))
    high = {"level": (0.0, 0.0, 0.0), "kerb": (0.0, 0.0, 0.06), "slope": (0.2, 0.0, -0.01)}[shape]
    return [GroundRegion("low", "road", left, (0.0, 0.0, 0.0)), GroundRegion("high", "sidewalk", right, high)]


SHAPES = ("level", "kerb", "slope")


@functools.cache
def _walks() -> tuple[SceneBank, c_mujoco.Drives, c_mujoco.Trace]:
    """Six robots on three grounds: one holds its pose, one trots in place with open loop."""
    robot = make_go2()
    scenes = [region_scene(shape, _regions(shape)) for shape in SHAPES]
    models = [c_mujoco.reference_model(scene_spec(scene), robot) for scene in scenes]
    qpos = np.tile(models[0].qpos0, (6, 1)).astype(np.float32)
    stand = np.array(make_stand())
    qpos[:, 7:] = stand
    qpos[:, 2] += 0.02 + np.repeat([0.0, 0.06, 0.07], 2)
    ctrl = np.tile(stand, (STEPS, 6, 1)).astype(np.float32)
    lift = np.maximum(np.sin(2 * np.pi * 2.5 * CONTROL_DT * np.arange(STEPS)), 0.0)[:, None]
    ctrl[:, 1::2, 1] += 0.4 * lift
    ctrl[:, 1::2, 2] -= 0.8 * lift
    ctrl[:, 1::2, 10] += 0.4 * lift
    ctrl[:, 1::2, 11] -= 0.8 * lift
    drives = c_mujoco.Drives(np.repeat(np.arange(3, dtype=np.int32), 2), qpos, ctrl)
    return pack_regions(scenes), drives, c_mujoco.drive_reference(models, robot, drives, CONTROL_DT)


def make_stand() -> tuple[float, ...]:
    from urbanverse_mjx.robots.go2_body import stand_pose

    return stand_pose()


@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused"])
def test_steps_are_those_of_c_mujoco(impl: str) -> None:
    bank, drives, expected = _walks()
    engine = make_engine(bank, make_go2(), impl=impl, control_dt=CONTROL_DT, num_slots=0)
    found = c_mujoco.drive_engine(engine, bank, drives)
    apart = np.abs(found.qpos - expected.qpos).max(-1)
    assert apart[:, :8].max() < FLIGHT
    assert apart[:, :20].max() < LANDED
    assert apart.max() < LATER
    np.testing.assert_array_equal(found.hit, expected.hit)
