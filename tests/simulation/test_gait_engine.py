"""A gait in the loop: Warp agrees with C MuJoCo, and the gait's history is kept."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.gaits import make_gait
from urbanverse_mjx.datatypes import Contacts, ValidationError
from urbanverse_mjx.evaluation.gait_walks import walk
from urbanverse_mjx.robots import gait_of, load, make_go2
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import pack_regions, region_scene, terrain_regions
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.gait_engine import GaitEngine, summed_contacts
from urbanverse_mjx.simulation.parity.c_mujoco import reference_model

#: m, after 0.2 and 0.4 s: two hundred times what was found, which is the rounding of float32.
APART = 2e-5


@pytest.mark.parametrize(
    ("name", "impl"),
    [
        # A gait of random numbers that shuffles.
        pytest.param("random", "warp", marks=pytest.mark.extended),
        pytest.param("mini_cheetah", "warp-fused", marks=pytest.mark.extended),
        pytest.param("b2", "warp-fused", marks=pytest.mark.extended),
        pytest.param("g1", "warp-fused", marks=pytest.mark.extended),
        pytest.param("mini_cheetah", "jax", marks=pytest.mark.slow),
        pytest.param("b2", "jax", marks=pytest.mark.slow),
        pytest.param("g1", "jax", marks=pytest.mark.slow),
    ],
)
def test_it_moves_as_in_c_mujoco(name: str, impl: str) -> None:
    """0.4 s under two commands."""
    robot = make_go2() if name == "random" else load(name)
    gait = make_gait(seed=1) if name == "random" else gait_of(robot)
    scene = region_scene("flat-0", terrain_regions("flat", 0))
    model = reference_model(scene_spec(scene), robot)
    qpos = np.tile(model.qpos0, (1, 1))
    qpos[0, 2], qpos[0, 7:] = robot.spawn_height + 0.01, gait.stand
    commands = np.array([[0.5, 0.0, 0.3], [0.2, -0.1, 0.0]])

    def constant(places: np.ndarray, yaws: np.ndarray, time: float) -> np.ndarray:
        return commands[[0 if time < 0.2 - 1e-9 else 1]]

    expected = walk([model], np.zeros(1, int), robot, gait, qpos, constant, 20, np.full(12, 30.0))
    bank = pack_regions([scene])
    engine = GaitEngine(make_engine(bank, robot, impl, gait.control_dt, num_slots=0), robot, gait, 0.2)
    sim = jax.jit(engine.init)(jnp.int32(0), qpos[0], jnp.zeros(18))
    # `walk` begins with a history of the first command, the engine with one of standing.
    assert sim.carry is not None
    told = sim.carry.history.at[:, 30:33].set(commands[0])
    sim = sim._replace(carry=sim.carry._replace(history=told))
    step = jax.jit(engine.step)
    for command, t in zip(commands, (9, 19), strict=True):
        sim = step(sim, command)
        np.testing.assert_allclose(sim.xpos[1], expected.position[0, t], atol=APART)
        weight = float(model.body_subtreemass[1]) * 9.81
        np.testing.assert_allclose(sim.contacts.foot_force.sum(), weight, rtol=0.6)
    # It moved its legs, and remembers how.
    assert np.abs(np.asarray(sim.carry.action)).max() > 0.05
    np.testing.assert_allclose(sim.carry.history[:, 30:33], np.tile(commands[1], (5, 1)))


def test_touches_of_short_steps_are_those_of_a_long_one() -> None:
    parts = Contacts(
        hit=jnp.array([False, True, True]),
        hit_object=jnp.array([-1, 4, 7]),
        hit_ground=jnp.array([False, False, False]),
        hit_force=jnp.array([0.0, 30.0, 20.0]),
        hit_fraction=jnp.array([0.0, 0.5, 1.0]),
        foot_force=jnp.array([[10.0, 0.0], [20.0, 0.0], [0.0, 3.0]]),
    )
    found = summed_contacts(parts)
    assert (bool(found.hit), int(found.hit_object), bool(found.hit_ground)) == (True, 4, False)
    assert (float(found.hit_force), float(found.hit_fraction)) == (30.0, 0.5)
    np.testing.assert_allclose(found.foot_force, [10.0, 1.0])


def test_steps_must_divide() -> None:
    with pytest.raises(ValidationError, match="multiple of the gait's"):
        GaitEngine(object(), make_go2(), make_gait(), 0.05)  # pyright: ignore[reportArgumentType]
