"""Where most hulls and prisms come within reach: no slot and no contact is missed, and contacts are C MuJoCo's."""

import pathlib
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support import dense_poses
from tests.support.box_bank import box_scene, box_skies, ragged_regions
from urbanverse_mjx import robots, settings
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.robots.go2_body import stand_pose
from urbanverse_mjx.scene import CompiledScene, pack_bank
from urbanverse_mjx.scene.bank import pack
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco

#: Poses that are driven from in one batch.
BATCH = 250
#: m between the distances of an engine and C MuJoCo's; deep in an edge C MuJoCo's own search ends 0.1 mm short.
DISTANCE = 2e-4


def compare(found: np.ndarray, expected: np.ndarray) -> None:
    """Every touch that is deeper than rounding is one of the other side's, as deep."""
    for a, b in ((found, expected), (expected, found)):
        for pose, sphere, distance in a[a[:, 2] < -2 * DISTANCE]:
            same = b[(b[:, 0] == pose) & (b[:, 1] == sphere), 2]
            assert np.abs(same - distance).min(initial=np.inf) < DISTANCE, (pose, sphere, distance, same)


def missed_ahead(engine: Any, scene: np.ndarray, qpos: np.ndarray, steps: int) -> int:
    """The most slots and contacts missed in a control step, full speed ahead from rest."""
    ahead = engine.robot.command(jnp.array([engine.robot.max_speed, 0.0]))
    if engine.robot.name == "go2":
        ahead = jnp.array(stand_pose())  # its gait is none of the engine's
    begin, step = jax.jit(jax.vmap(engine.init)), jax.jit(jax.vmap(engine.step, in_axes=(0, None)))
    worst = 0
    for first in range(0, len(scene), BATCH):
        rows = np.arange(first, first + BATCH) % len(scene)
        state = begin(scene[rows], qpos[rows], jnp.zeros((BATCH, engine.physics.model.nv)))
        for _ in range(steps):
            state = step(state, ahead)
            worst = max(worst, int(state.slot_overflow.max()))
    return worst


def prove(
    bank: SceneBank, specs: Sequence[mujoco.MjSpec], robot: RobotSpec, number: int, impls: Sequence[str]
) -> dict[str, Any]:
    """Checks both engines at the densest poses; returns how many were free and how many contacts there were."""
    control_dt = 0.02 if robot.name == "go2" else 0.2
    models = [c_mujoco.reference_model(spec, robot) for spec in specs]
    engines = {impl: make_engine(bank, robot, impl=impl, control_dt=control_dt) for impl in ("jax", "warp")}
    warp = engines["warp"]
    assert warp.num_prism_slots > 8
    scene, place = dense_poses.densest_places(bank, warp.reach, number)
    posture = stand_pose() if robot.name == "go2" else ()
    qpos, free = dense_poses.settled(bank, robot, models, scene, place, posture)
    scene, qpos = scene[free], qpos[free]
    expected = dense_poses.in_c_mujoco(models, warp.physics.spheres.name, scene, qpos)
    for impl, contacts_of in (("jax", dense_poses.in_jax_engine), ("warp", dense_poses.in_warp_engine)):
        found, missed = contacts_of(engines[impl], scene, qpos)
        assert missed == 0, impl
        compare(found, expected)
    for impl in impls:
        assert missed_ahead(engines[impl], scene, qpos, steps=3 if robot.name != "go2" else 1) == 0, impl
    return {
        "free": int(free.sum()),
        "contacts": len(expected),
        "most": int(np.bincount(expected[:, 0].astype(int)).max()),
    }


@pytest.mark.extended
@pytest.mark.mjx
def test_no_contact_is_missed_on_ragged_ground() -> None:
    geometry = box_scene(0, num_objects=80, regions=ragged_regions(0))
    bank = pack([geometry], ["train"], box_skies())
    done = prove(bank, [scene_spec(geometry)], robots.make_coco("differential"), 150, ["warp"])
    assert done["free"] > 50
    assert done["contacts"] > 4.2 * done["free"], "wheels stand on several pieces at once"


@pytest.mark.mjx
@pytest.mark.slow
@pytest.mark.parametrize("name", ["coco", "go2", "wheelchair"])
def test_no_contact_is_missed_in_the_densest_poses_of_distilled_streets(name: str) -> None:
    """The library's AutoBench, whose ground was distilled: 10,000 poses."""
    folders = sorted(pathlib.Path(settings.cache_dir("library", "autobench")).glob("scenes/*"))
    if not folders:
        pytest.skip("needs `urbanverse scene library autobench`")
    robot = {"coco": robots.make_coco, "go2": robots.make_go2, "wheelchair": lambda: robots.load("wheelchair")}[name]()
    specs = [scene_spec(CompiledScene.load(folder).geometry) for folder in folders]
    done = prove(pack_bank(folders, ["test"] * len(folders)), specs, robot, 10_000, ["jax", "warp"])
    assert done["free"] > 1_000
