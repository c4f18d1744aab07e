"""Robots that the page offers follow held keys: COCO, the wheelchair, one that a user has described, the Go2."""

import json
import pathlib
import types
from typing import Any

import numpy as np
import pytest

from tests.robots.test_coco_drive import Controller, ground
from tests.robots.test_description import WHEELCHAIR, blocks
from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.evaluation.gait_walks import walk
from urbanverse_mjx.pipeline.machines import load_machine
from urbanverse_mjx.robots import gait_of, load, make_coco
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.scene.terrain import region_scene, terrain_regions
from urbanverse_mjx.simulation.parity.c_mujoco import reference_model
from urbanverse_mjx.viewer.session import Machine, Session
from urbanverse_mjx.viewer.teleop import Inputs, Teleop

DT = 0.2
#: Held keys -> shares of full speed and full turn to the left.
HELD = {
    ("KeyW",): (1.0, 0.0),
    ("KeyW", "ShiftLeft"): (0.5, 0.0),
    ("KeyA",): (0.0, 1.0),
    ("KeyW", "KeyD", "ShiftRight"): (0.5, -0.5),
    (): (0.0, 0.0),
}


@pytest.fixture
def tug(tmp_path: pathlib.Path) -> pathlib.Path:
    """The robot of docs/tutorials/own_robot.md."""
    for name, language in (("tug.xml", "xml"), ("robot.json", "json"), ("parts/crate.obj", "obj")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(blocks(language)[0])
    return tmp_path


def described(name: str, tug: pathlib.Path) -> RobotSpec:
    return make_coco() if name == "coco" else load(tug if name == "tug" else name)


def velocity_of(robot: RobotSpec, mode: str, action: np.ndarray) -> list[float]:
    """m/s and rad/s, as the environment reads an action."""
    if mode == "waypoint":
        return [float(x) for x in robot.waypoint_to_velocity(action, DT)]
    return [0.5 * (float(action[0]) + 1.0) * robot.max_speed, float(action[1]) * robot.max_yaw_rate]


@pytest.mark.parametrize("mode", ["waypoint", "velocity"])
@pytest.mark.parametrize("name", ["coco", WHEELCHAIR, "tug"])
def test_held_keys_become_the_robots_velocity(name: str, mode: str, tug: pathlib.Path) -> None:
    """In C MuJoCo on flat ground, by the action that the page passes to the environment."""
    robot = described(name, tug)
    env: Any = types.SimpleNamespace(robot=robot, dt=DT, config=types.SimpleNamespace(action_mode=mode))
    machine: Any = types.SimpleNamespace(env=env)
    for held, (speed, turn) in HELD.items():
        action = Machine.action_of(machine, Inputs(frozenset(held)).command())
        assert np.abs(action).max() <= 1.0
        velocity = velocity_of(robot, mode, action)
        controller = Controller(robot, ground([(-30.0, 30.0, 0.0, 0.0)], half_width=30.0))
        controller.drive(velocity[0], velocity[1], 3.0)
        root = controller.data.body(f"robot/{robot.root_body}")
        v = float(root.xmat.reshape(3, 3)[:, 0] @ controller.data.qvel[:3])
        # A turn on the spot is a point 5 mm ahead, and tyres slip in a bend.
        assert v == pytest.approx(speed * robot.max_speed, abs=0.06 * robot.max_speed), held
        wanted = turn * robot.max_yaw_rate
        assert controller.data.qvel[5] == pytest.approx(wanted, abs=0.2 * abs(wanted) + 0.02), held


@pytest.mark.extended
@pytest.mark.parametrize("mode", ["waypoint", "velocity"])
@pytest.mark.parametrize("name", ["go2", "b2", "g1"])
def test_held_keys_become_the_velocity_of_a_gait(name: str, mode: str) -> None:
    """Robots with a shipped gait, in C MuJoCo on flat ground, by the action that the page passes."""
    robot = load(name)
    gait = gait_of(robot)
    env: Any = types.SimpleNamespace(robot=robot, dt=DT, config=types.SimpleNamespace(action_mode=mode))
    machine: Any = types.SimpleNamespace(env=env)
    actions = [Machine.action_of(machine, Inputs(frozenset(held)).command()) for held in HELD]
    commands = np.array([robot.command(np.array(velocity_of(robot, mode, a), np.float32)) for a in actions])
    model = reference_model(scene_spec(region_scene("flat-0", terrain_regions("flat", 0))), robot)
    stand = model.qpos0.copy()
    stand[2], stand[7:] = robot.spawn_height + 0.005, gait.stand
    steps = round(4.0 / gait.control_dt)
    limits = np.full(len(gait.stand), np.inf)
    number = len(HELD)
    first = np.tile(stand, (number, 1))
    found = walk([model], np.zeros(number, int), robot, gait, first, lambda *_: commands, steps, limits)
    assert not found.fell.any()
    # Mean of the last two seconds: a trot swings about its speed.
    velocity = found.velocity[:, steps // 2 :].mean(1)
    for (held, (speed, turn)), (ahead, left, yaw_rate) in zip(HELD.items(), velocity, strict=True):
        if (name, held) == ("g1", ("KeyA",)):
            turn = 0.0  # it hardly turns on the spot, see docs/robots.md
        assert ahead == pytest.approx(speed * robot.max_speed, abs=0.1 * robot.max_speed), held
        assert abs(left) < 0.1 * robot.max_speed, held
        assert yaw_rate == pytest.approx(turn * robot.max_yaw_rate, abs=0.1 * robot.max_yaw_rate), held


@pytest.mark.slow
@pytest.mark.parametrize("name", [WHEELCHAIR, "tug", "go2"])
def test_a_street_is_driven_by_keys_that_take_over_from_nobody(
    name: str, tug: pathlib.Path, small_bank: SceneBank
) -> None:
    """`urbanverse view --policy zero --playground-config-overrides '{"robot": ...}'`, and with `--env-name Go2Nav`,
    without its page: the environment with the robot's physics, its messages, and the steps between them."""
    robot, env_name = described(name, tug), None
    overrides = {"terminate_on_hit": False, "terminate_off_traversable": False, "success_radius": 1e-3, "impl": "jax"}
    if name == "go2":
        env_name = "Go2Nav"
    else:
        overrides |= {"robot": str(tug) if name == "tug" else name, "sim_dt": robot.physics_timestep}
    machine = load_machine("zero", small_bank, env_name=env_name, image_size=None, overrides=overrides)
    assert machine.env.robot.name == robot.name
    session, teleop = Session(machine, 0, [3]), Teleop(give_back_after=0.5)
    root = machine.env.mj_model.body(machine.env.robot.root_body).id
    now = 0.0

    def hold(seconds: float, *keys: str) -> tuple[float, float]:
        """Distance driven (m), and yaw rate at the end (rad/s)."""
        nonlocal now
        start = np.asarray(session.frames[-1].nav.sim.xpos)[0, root, :2]
        for _ in range(round(seconds / machine.env.dt)):
            message = json.dumps({"keys": keys, "axes": [], "buttons": [], "age": 0})
            teleop.receive(1, Inputs.parse(message), now)
            command = teleop.command(now)
            session.step({} if command is None else {0: machine.action_of(command)})
            now += machine.env.dt
        sim = session.frames[-1].nav.sim
        gone = np.linalg.norm(np.asarray(sim.xpos)[0, root, :2] - start)
        return float(gone), float(np.asarray(sim.qvel)[0, 5])

    assert hold(0.4)[0] < 0.02
    assert hold(1.6, "KeyW")[0] > 0.4 * robot.max_speed * 1.6
    assert hold(1.4, "KeyA")[1] > 0.5 * robot.max_yaw_rate
    gone, turn = hold(1.0)
    assert gone < 0.5 * robot.max_speed
    assert abs(turn) < 0.1
    driven = session.by_hand(len(session) - 1)
    assert driven.tolist() == [False] * 2 + [True] * 15 + [True] * 2 + [False] * 3
