"""The engine in the six shipped streets: no hull and no contact is ever left out for lack of a slot."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from urbanverse_mjx.datatypes import SceneBank, traversable
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.jax_engine import JaxEngine
from urbanverse_mjx.simulation.parity.drives import ground_height

POSES = 10_000
#: Poses that are driven from in one batch.
BATCH = 500


@pytest.fixture(scope="module")
def engine(bank: SceneBank) -> JaxEngine:
    return JaxEngine(bank, make_coco("differential"), control_dt=0.2)


@pytest.fixture(scope="module")
def poses(bank: SceneBank, engine: JaxEngine) -> tuple[np.ndarray, np.ndarray]:
    """(POSES,) scenes and (POSES, nq) random places and headings on walkable ground, many of them inside of objects."""
    rng = np.random.default_rng(7)
    scene = rng.integers(0, bank.num_scenes, POSES).astype(np.int32)
    walkable = traversable(bank.map_kind)
    xy, z = np.zeros((POSES, 2)), np.zeros(POSES)
    for s in range(bank.num_scenes):
        cells = np.argwhere(walkable[s])
        mine = np.flatnonzero(scene == s)
        chosen = cells[rng.integers(0, len(cells), len(mine))]
        xy[mine] = bank.map_origin[s] + (chosen + rng.random(chosen.shape)) * float(bank.map_resolution)
        z[mine] = ground_height(bank, s, xy[mine])
    assert np.isfinite(z).all()
    qpos = np.tile(engine.physics.model.qpos0, (POSES, 1)).astype(np.float32)
    qpos[:, :2], qpos[:, 2] = xy, z + engine.robot.spawn_height
    qpos[:, 3:7] = rotations.from_yaw(rng.uniform(-np.pi, np.pi, POSES))
    return scene, qpos


@pytest.mark.extended
def test_every_hull_in_reach_finds_a_slot(
    bank: SceneBank, engine: JaxEngine, poses: tuple[np.ndarray, np.ndarray]
) -> None:
    scene, qpos = poses
    nearby, missing = jax.jit(jax.vmap(engine.find_slots))(scene, jnp.asarray(qpos[:, :3]))
    assert int(missing.max()) == 0
    # Streets with empty slots would not test the limit.
    assert np.asarray(nearby.valid)[:, : engine.num_slots].sum(1).max() >= engine.num_slots // 2


@pytest.mark.extended
@pytest.mark.parametrize("driven", [1_500, pytest.param(POSES, marks=pytest.mark.slow)])
def test_every_contact_of_a_control_step_finds_a_place(
    bank: SceneBank, engine: JaxEngine, poses: tuple[np.ndarray, np.ndarray], driven: int
) -> None:
    """Full speed ahead for one control step from each pose where the robot does not stand in an object."""
    scene, qpos = poses
    still = jnp.zeros((BATCH, engine.physics.model.nv))
    ahead = jnp.broadcast_to(engine.robot.command(jnp.array([engine.robot.max_speed, 0.0])), (BATCH, 4))
    begin, step = jax.jit(jax.vmap(engine.init)), jax.jit(jax.vmap(engine.step_and_record))
    free, hits, missed = 0, 0, 0
    for first in range(0, driven, BATCH):
        rows = slice(first, first + BATCH)
        after, record = step(begin(scene[rows], jnp.asarray(qpos[rows]), still), ahead)
        stands_free = ~np.asarray(record.hit)[:, 0]
        free += int(stands_free.sum())
        hits += int((np.asarray(after.contacts.hit) & stands_free).sum())
        missed += int(((np.asarray(after.slot_overflow) > 0) & stands_free).sum())
    assert missed == 0
    assert free > driven // 3
    assert hits > driven // 100
