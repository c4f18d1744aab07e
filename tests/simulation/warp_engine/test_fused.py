"""The fused step: MuJoCo Warp's results, independent iterations, no races between lanes, refusals.

Parity with C MuJoCo is tested beside the other engines: `tests/simulation/parity`, `collision_slots/test_agent_slots`.
"""

import pathlib
import shutil
import subprocess
from typing import Any

import jax
import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank
from tests.support.engine_runs import CONTROL_DT, NUM_ENVS, assert_equal, roll, starts
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco, make_coco_parcel, make_go2
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.physics_model import make_physics_model
from urbanverse_mjx.simulation.warp_engine import WarpEngine
from urbanverse_mjx.simulation.warp_engine.fused import batch, build_program, kernel
from urbanverse_mjx.simulation.warp_engine.model import RobotModel, build_robot_model

LANES = pathlib.Path(__file__).with_name("fused_lanes.cpp")


@pytest.fixture(scope="module")
def engine(small_bank: SceneBank) -> WarpEngine:
    return WarpEngine(small_bank, make_coco("differential"), control_dt=CONTROL_DT, fused=True)


@pytest.fixture(scope="module")
def batched(engine: WarpEngine) -> Any:
    return jax.jit(jax.vmap(engine.step))


def robot_model(robot: RobotSpec) -> RobotModel:
    return build_robot_model(make_physics_model(robot), 8, 10)


def assert_as_mujoco_warp(engine: WarpEngine, bank: SceneBank, batched: Any, number: int) -> None:
    """Two seconds of drives into objects: contacts, forces, slots and the state that the next step begins with."""
    general = WarpEngine(bank, engine.robot, control_dt=CONTROL_DT)
    step = jax.jit(jax.vmap(general.step))
    state, ctrl = starts(engine, bank, number=number)
    touched = 0
    for _ in range(20):
        # From the same state every time: differences do not grow.
        expected, state = jax.device_get((step(state, ctrl), batched(state, ctrl)))
        for name in ("hit", "hit_object", "hit_ground"):
            np.testing.assert_array_equal(getattr(state.contacts, name), getattr(expected.contacts, name), name)
        np.testing.assert_allclose(state.contacts.hit_fraction, expected.contacts.hit_fraction)
        np.testing.assert_allclose(state.contacts.hit_force, expected.contacts.hit_force, rtol=5e-3, atol=0.5)
        np.testing.assert_allclose(state.contacts.foot_force, expected.contacts.foot_force, rtol=5e-3, atol=0.5)
        np.testing.assert_array_equal(state.slot_overflow, expected.slot_overflow)
        np.testing.assert_allclose(state.qpos, expected.qpos, atol=2e-4)
        np.testing.assert_allclose(state.qvel, expected.qvel, atol=5e-3)
        np.testing.assert_allclose(state.xpos, expected.xpos, atol=1e-4)
        np.testing.assert_allclose(state.xquat, expected.xquat, atol=2e-4)
        touched += int(state.contacts.hit.sum())
    assert touched > 5


def test_results_are_those_of_mujoco_warp(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    assert_as_mujoco_warp(engine, small_bank, batched, NUM_ENVS)


@pytest.mark.gpu
def test_a_warp_of_lanes_computes_what_one_does(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    """On CUDA, the step in 32 lanes against MuJoCo Warp's kernels there."""
    assert_as_mujoco_warp(engine, small_bank, batched, 24)
    ((shared, _),) = engine._devices.values()
    assert shared.device.is_cuda


def test_record_ends_where_the_step_ends(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    state, ctrl = starts(engine, small_bank)
    record_step = jax.jit(jax.vmap(engine.step_and_record))
    hits = 0
    for _ in range(20):
        after, record = record_step(state, ctrl)
        state = batched(state, ctrl)
        assert_equal(after, state)
        np.testing.assert_array_equal(record.qpos[:, -1], state.qpos)
        np.testing.assert_allclose(record.hit.mean(1), state.contacts.hit_fraction, atol=1e-6)
        hits += int(record.hit.sum())
    assert hits > 0


def test_envs_are_independent_and_nans_stay_where_they_are(
    engine: WarpEngine, small_bank: SceneBank, batched: Any
) -> None:
    state, ctrl = starts(engine, small_bank)
    together = roll(batched, state, ctrl, 4)
    alone = jax.jit(engine.step)
    one = jax.tree.map(lambda x: x[3], state)
    for _ in range(4):
        one = alone(one, ctrl[3])
    assert_equal(one, jax.tree.map(lambda x: x[3], together))
    spoilt = roll(batched, state._replace(qpos=state.qpos.at[2, 0].set(np.nan)), ctrl, 4)
    others = np.arange(NUM_ENVS) != 2
    assert_equal(*(jax.tree.map(lambda x: x[others], s) for s in (spoilt, together)))
    assert np.isnan(spoilt.qpos[2]).any()
    assert not spoilt.contacts.hit[2]


def test_iterations_of_a_loop_are_independent(
    engine: WarpEngine, small_bank: SceneBank, batched: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Loops that lanes divide give the same backwards, but for the order of sums: no iteration needs another one."""
    state, ctrl = starts(engine, small_bank)
    expected = roll(batched, state, ctrl, 20)
    assert np.asarray(expected.contacts.hit).any()
    monkeypatch.setattr(batch, "make_step", lambda source: kernel.make_step(source, "#define URBANVERSE_BACKWARDS\n"))
    backwards = WarpEngine(small_bank, engine.robot, control_dt=CONTROL_DT, fused=True)
    found = roll(jax.jit(jax.vmap(backwards.step)), state, ctrl, 20)
    np.testing.assert_array_equal(found.contacts.hit_object, expected.contacts.hit_object)
    np.testing.assert_allclose(found.qpos, expected.qpos, atol=1e-4)
    np.testing.assert_allclose(found.qvel, expected.qvel, atol=1e-3)


@pytest.mark.extended
@pytest.mark.skipif(shutil.which("g++") is None, reason="needs g++")
@pytest.mark.parametrize("make", [make_coco, make_go2, make_coco_parcel])
def test_lanes_do_not_race(make: Any, tmp_path: pathlib.Path) -> None:
    """Four lanes as threads under ThreadSanitizer: no race, and what one lane computes."""
    robot = make()
    program = build_program(robot_model(robot), 8, 12, 1)
    (tmp_path / "program.h").write_text(program.source, encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    qpos = (model.key_qpos[0] if model.nkey else model.qpos0).astype(np.float32)
    ctrl = np.full(model.nu, 15.0) if robot.name.startswith("coco") else qpos[7:]
    for name, values in {"numbers": program.numbers, "qpos": qpos, "ctrl": ctrl}.items():
        np.asarray(values, np.float32).tofile(tmp_path / name)
    found = {}
    for lanes in (1, 4):
        options = ["-DLANES_OF_TEST=4", "-fsanitize=thread", "-pthread"] if lanes > 1 else []
        binary = tmp_path / f"lanes{lanes}"
        subprocess.run(
            ["g++", "-std=c++17", "-O1", "-g", *options, f"-I{tmp_path}", str(LANES), "-o", str(binary)], check=True
        )
        done = subprocess.run([str(binary), str(tmp_path)], check=False, capture_output=True, text=True)
        if "FATAL: ThreadSanitizer" in done.stderr:
            pytest.skip("ThreadSanitizer does not run on this kernel")
        assert done.returncode == 0, done.stderr[-3000:]
        found[lanes] = np.array([[float(x) for x in line.split()] for line in done.stdout.splitlines()])
    assert found[1].shape[0] == 6
    assert found[1][-1, -1] > 0, "the block in front is touched"
    np.testing.assert_allclose(found[4], found[1], atol=2e-3, rtol=2e-3)


def edited(robot: RobotSpec, **options: float) -> RobotModel:
    """Its model with other fields; `build_program` refuses by fields."""
    model = robot_model(robot)
    for name, value in options.items():
        getattr(model.model, name)[-1] = value
    return model


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dof_frictionloss": 1.0}, "dry friction of joints"),
        ({"jnt_stiffness": 3.0}, "joint springs"),
        ({"actuator_gaintype": 2}, "other actuators"),
        ({"jnt_type": 9}, "other joints"),
        ({"jnt_type": 1, "actuator_gear": 1.0}, "turns a ball joint aslant"),
        ({"body_jntnum": 2}, "other joints"),
    ],
)
def test_forces_that_it_does_not_know_are_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(ValidationError, match=f"warp-fused.*{message}.*impl='warp'"):
        build_program(edited(make_coco(), **options), 24, 12, 0)


@pytest.mark.extended
def test_it_is_chosen_by_name_and_refuses_movable_objects() -> None:
    bank = box_bank(1)
    engine = make_engine(bank, make_coco(), impl="warp-fused", control_dt=CONTROL_DT)
    assert isinstance(engine, WarpEngine)
    assert engine._program is not None
    from urbanverse_mjx.simulation.collision_slots.body_slots import Sizes

    with pytest.raises(ValidationError, match=r"engine\.movable.*impl='warp'"):
        make_engine(bank, make_coco(), impl="warp-fused", control_dt=CONTROL_DT, movable=Sizes(bodies=2, awake=1))
