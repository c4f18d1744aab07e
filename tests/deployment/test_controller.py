"""Decisions of the controller on hand-made events; its inputs and velocities beside those of the environment."""

import json
import pathlib
import subprocess
import sys
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.robot_policy import SIZE, SPEED, YAW_RATE, robot_policy
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.cli import main
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.deployment.contract import Contract, tilt_of, yaw_of
from urbanverse_mjx.deployment.controller import Command, Controller, Limits, Request
from urbanverse_mjx.deployment.image_size import fit_image
from urbanverse_mjx.deployment.messages import Image, Odometry
from urbanverse_mjx.deployment.policy_process import load
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots.waypoint import pd_velocity

ROOT = pathlib.Path(__file__).parents[2]
MS = 10**6


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    return robot_policy(tmp_path_factory.mktemp("policy") / "policy.onnx")


@pytest.fixture(scope="module")
def contract(policy: pathlib.Path) -> Contract:
    return load(policy)[1]


class Driven:
    """A controller and a policy that answers 3 ms later with a given action, on a clock in ms."""

    def __init__(self, contract: Contract, goals: Any = ((50.0, 0.0),), limits: Limits | None = None) -> None:
        self.controller = Controller(contract, goals, limits or Limits(), "0" * 16)
        self.action = np.array([[1.0, 0.0]], np.float32)
        self.answers = True
        self.requests: list[tuple[int, Request]] = []
        self.commands: list[tuple[int, Command]] = []

    def tick(self, ms: int, x: float = 0.0, image: bool = True, velocity: float = 0.0, **other: Any) -> None:
        """Odometry, and an image before it if there is one, of the same stamp."""
        if image:
            pixels = np.full((*SIZE, 3), ms % 251, np.uint8)
            self._take(ms, self.controller.message(Image(ms * MS, 0.0, pixels).parts(), ms * MS))
        fields = {"orientation_wxyz": (1.0, 0.0, 0.0, 0.0), "yaw_rate_radps": 0.0, **other}
        message = Odometry(ms * MS, (x, 0.0, 0.0), velocity_mps=(velocity, 0.0), **fields)
        self._take(ms, self.controller.message(message.parts(), ms * MS))

    def _take(self, ms: int, outputs: list[Request | Command]) -> None:
        self.commands += [(ms, output) for output in outputs if isinstance(output, Command)]
        for output in outputs:
            if isinstance(output, Request):
                self.requests.append((ms, output))
                if self.answers:
                    action = None if output.inputs is None else self.action
                    self._take(ms + 3, self.controller.answer(output.number, action, (ms + 3) * MS))

    @property
    def last(self) -> Command:
        return self.commands[-1][1]


def test_the_policy_is_asked_at_its_rate_and_between_whether_it_lives(contract: Contract) -> None:
    driven = Driven(contract)
    for ms in range(1000, 3000, 20):
        driven.tick(ms, image=ms % 100 == 0)
    asked = [(ms, r) for ms, r in driven.requests if r.inputs is not None]
    assert [ms for ms, _ in asked] == list(range(1000, 3000, 200))
    assert [r.begin for _, r in asked] == [True] + [False] * 9
    assert len(driven.requests) == 100
    assert driven.last.reason == "driving"
    # The last action is among the inputs, and zero at the beginning.
    first, second = (r.inputs["proprio"] for _, r in asked[:2] if r.inputs is not None)
    np.testing.assert_array_equal(first[0], np.zeros(5))
    np.testing.assert_array_equal(second[0, 3:], driven.action[0])


def test_commands_expire_with_the_older_of_odometry_and_image(contract: Contract) -> None:
    driven = Driven(contract, limits=Limits(odometry_age=0.2, image_age=0.25))
    driven.tick(1000)
    assert driven.last.expires_ns == 1200 * MS
    driven.tick(1100, image=False)
    assert driven.last.expires_ns == 1250 * MS
    assert driven.last.speed_mps == SPEED
    driven.tick(1251, image=False)
    assert (driven.last.reason, driven.last.speed_mps) == ("stale image", 0.0)


def test_a_fault_holds_the_robot_for_the_recovery_time_and_begins_the_policy_anew(contract: Contract) -> None:
    driven = Driven(contract, limits=Limits(recovery=0.5))
    driven.tick(1000)
    tilt = (float(np.cos(0.2)), float(np.sin(0.2)), 0.0, 0.0)
    driven.tick(1020, orientation_wxyz=tilt)
    assert (driven.last.reason, driven.last.speed_mps) == ("tilt", 0.0)
    for ms in range(1040, 1540, 20):
        driven.tick(ms)
        assert (driven.last.reason, driven.last.speed_mps) == ("recovering", 0.0)
    driven.tick(1540)
    assert (driven.last.reason, driven.last.speed_mps) == ("driving", SPEED)
    assert [r.begin for _, r in driven.requests if r.inputs is not None] == [True, True]
    assert driven.controller.faults == {"tilt": 1}


def test_a_policy_that_is_late_or_answers_nonsense_stops_the_robot(contract: Contract) -> None:
    driven = Driven(contract)
    driven.tick(1000)
    driven.answers = False
    driven.tick(1020)
    driven.tick(1100)
    assert driven.last.reason == "driving"
    (late,) = driven.controller.lapse(1121 * MS)
    assert isinstance(late, Command)
    assert (late.reason, late.speed_mps) == ("policy late", 0.0)
    other = Driven(contract)
    other.action = np.array([[np.nan, 0.0]], np.float32)
    other.tick(1000)
    assert (other.last.reason, other.last.speed_mps) == ("policy lost", 0.0)
    other.tick(5000)
    assert (other.last.reason, other.last.speed_mps) == ("policy lost", 0.0)


def test_an_action_does_not_outlive_its_period(contract: Contract) -> None:
    """A controller that is given odometry in bursts, so that no request is due in time."""
    driven = Driven(contract)
    driven.tick(1000)
    driven.answers = False
    for ms in range(1010, 1310, 10):
        driven._take(1010, driven.controller.message(odometry_at(ms), 1010 * MS))
        driven._take(
            1010,
            driven.controller.message(Image(ms * MS, 0.0, np.full((*SIZE, 3), ms % 251, np.uint8)).parts(), 1010 * MS),
        )
    assert driven.last.speed_mps == SPEED
    driven._take(1010, driven.controller.message(odometry_at(1320), 1010 * MS))
    assert (driven.last.reason, driven.last.speed_mps) == ("no action", 0.0)


def odometry_at(ms: int) -> list[bytes]:
    return Odometry(ms * MS, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0), 0.0).parts()


def test_goals_are_driven_to_in_turn_and_the_last_one_ends_it(contract: Contract) -> None:
    driven = Driven(contract, goals=((5.0, 0.0), (0.0, 0.0), (9.0, 3.0)))
    seen = []
    for ms, x in ((1000, 0.0), (1200, 4.5), (1400, 1.5), (1600, 0.5), (1800, 8.0)):
        driven.tick(ms, x)
        inputs = driven.requests[-1][1].inputs
        assert inputs is not None
        seen.append(inputs["goal"][0].tolist())
    assert seen == [[5.0, 0.0], [-4.5, 0.0], [-1.5, 0.0], [8.5, 3.0], [1.0, 3.0]]
    assert not driven.controller.arrived
    driven._take(
        2000,
        driven.controller.message(
            Odometry(2000 * MS, (9.0, 2.5, 0.0), (1.0, 0, 0, 0), (1.0, 0), 0.0).parts(), 2000 * MS
        ),
    )
    assert (driven.controller.arrived, driven.last.reason, driven.last.speed_mps) == (True, "arrived", 0.0)


def test_limits_slow_the_robot_along_the_same_curve(contract: Contract) -> None:
    for limits, expected in (
        (Limits(), (1.2, 0.5)),
        (Limits(max_speed=0.6), (0.6, 0.25)),
        (Limits(max_yaw_rate=0.1), (0.24, 0.1)),
        (Limits(max_speed=9.0, max_yaw_rate=9.0), (1.2, 0.5)),
    ):
        driven = Driven(contract, limits=limits)
        x = 0.6
        driven.action = np.array([[x, x * np.tan(0.25)]], np.float32)
        driven.tick(1000)
        assert (driven.last.speed_mps, driven.last.yaw_rate_radps) == pytest.approx(expected, rel=1e-5)
    slow = Driven(contract, limits=Limits(max_speed=0.6))
    slow.tick(1000, velocity=0.9)
    assert slow.last.reason == "driving"
    slow.tick(1020, velocity=0.96)
    assert slow.last.reason == "overspeed"


def test_velocities_are_those_of_the_environment(contract: Contract, tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(0)
    actions = [*rng.uniform(-1.0, 1.0, (200, 2)), [0.0, 0.0], [5e-4, 5e-4], [-1.0, 0.0], [0.0, 1.0]]
    for action in actions:
        v, w = pd_velocity(jnp.asarray(action, jnp.float32), 0.2, SPEED, YAW_RATE)
        assert contract.velocity(action) == pytest.approx((float(v), float(w)), abs=2e-6)
    slow = load(robot_policy(tmp_path / "slow.onnx", rate_hz=1.0))[1]
    v, w = pd_velocity(jnp.array([1.0, 0.3]), 1.0, SPEED, YAW_RATE)
    assert slow.velocity([1.0, 0.3]) == pytest.approx((float(v), float(w)), abs=2e-6)
    velocity = load(robot_policy(tmp_path / "velocity.onnx", mode="velocity"))[1]
    assert velocity.velocity([-1.0, -0.5]) == (0.0, -0.5)
    assert velocity.velocity([3.0, 0.5]) == (SPEED, 0.5)


@pytest.mark.extended
def test_observations_are_those_of_the_environment(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    import jax

    env = unicycle_env(small_bank, {"observations.proprio": True, "goal_observation_limit": 4.0})
    contract = load(robot_policy(tmp_path / "limited.onnx", limit=4.0))[1]
    nav = env.begin_at(jax.random.key(0), jnp.int32(1), jnp.int32(3))
    for action in ([0.9, 0.3], [0.4, -0.8], [1.0, 1.0]):
        nav = env.advance(nav, jnp.array(action))[0]
        obs = env.observe(nav)
        q, p = nav.sim.xquat[1], nav.sim.xpos[1]
        proprio = np.asarray(obs["proprio"], np.float64)
        message = Odometry(
            1, tuple(map(float, p)), tuple(map(float, q)), tuple(proprio[:2].tolist()), float(proprio[2])
        )
        x, y = map(float, nav.goal[:2])
        image = np.zeros((*SIZE, 3), np.uint8)
        found = contract.inputs(message, (x, y), np.asarray(action, np.float32), image)
        np.testing.assert_allclose(found["goal"][0], obs["goal"], atol=1e-5)
        np.testing.assert_allclose(found["proprio"][0], obs["proprio"], atol=1e-6)


def test_yaw_and_tilt_of_random_quaternions() -> None:
    rng = np.random.default_rng(0)
    for q in rng.normal(size=(50, 4)):
        q /= np.linalg.norm(q)
        w, x, y, z = map(float, q)
        assert yaw_of((w, x, y, z)) == pytest.approx(float(rotations.yaw_of(q)), abs=1e-6)
        assert np.cos(tilt_of((w, x, y, z))) == pytest.approx(float(rotations.up_of(q)), abs=1e-6)


def test_an_image_is_cut_to_the_policys_field_of_view() -> None:
    """An image of the plane at distance 1, whose colour is the height there."""

    def seen(fovy: float, rows: int, columns: int) -> np.ndarray:
        up = np.tan(fovy / 2) * (1 - (2 * np.arange(rows) + 1) / rows)
        across = np.tan(fovy / 2) * columns / rows * ((2 * np.arange(columns) + 1) / columns - 1)
        grid = np.stack(np.meshgrid(up, across, indexing="ij"), -1)
        return np.clip(128 + 100 * np.concatenate([grid, 0 * grid[..., :1]], -1), 0, 255).astype(np.uint8)

    found = fit_image(seen(1.2, 480, 640), 1.2, (54, 72), 0.8)
    np.testing.assert_allclose(found.astype(int), seen(0.8, 54, 72), atol=1)
    exact = seen(0.8, 54, 96)
    assert fit_image(exact, 0.8, (54, 96), 0.8) is exact
    # Without a field of view the widest part of the right shape is taken.
    assert fit_image(seen(1.2, 480, 640), 0.0, (54, 96), 0.8).shape == (54, 96, 3)
    np.testing.assert_array_equal(
        fit_image(np.tile(exact, (1, 1, 1)).repeat(2, 0).repeat(2, 1), 0.0, (54, 96), 0.8), exact
    )
    with pytest.raises(ValidationError, match=r"found a camera that sees 0\.600 rad up and down"):
        fit_image(seen(0.6, 480, 640), 0.6, (54, 72), 0.8)


def test_the_command_needs_neither_jax_nor_mujoco(policy: pathlib.Path) -> None:
    """What it imports until it waits for a robot; whether other packages are installed does not matter."""
    code = (
        "import sys, importlib.metadata as m, json\n"
        "real = m.distribution\n"
        "def distribution(name):\n"
        "    if name not in ('numpy', 'onnxruntime', 'pillow', 'pyzmq', 'tyro'): raise m.PackageNotFoundError(name)\n"
        "    return real(name)\n"
        "m.distribution = distribution\n"
        "from urbanverse_mjx.cli import main\n"
        f"words = ['deploy', {str(policy)!r}, '--goal', '1', '0', '--time-limit', '0.1', '--robot', '127.0.0.1:9']\n"
        "status = main.main(words)\n"
        "print(json.dumps([status, *{n.partition('.')[0] for n in sys.modules}]))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    result, names = map(json.loads, done.stdout.splitlines())
    assert (names[0], result["result"], result["actions"]) == (0, "time limit", 0)
    assert not set(names) & {"jax", "flax", "brax", "mujoco", "warp", "scipy", "cv2", "ml_collections", "torch", "onnx"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--goal", "1", "2"], "found no policy"),
        (["POLICY"], "--goal: found 0 numbers"),
        (["POLICY", "--goal", "1", "2", "3"], "--goal: found 3 numbers"),
        (["POLICY", "--goal", "nan", "2"], "--goal: found nan"),
        (["POLICY", "--goal", "1", "2", "--image-age", "0"], "--image-age: found 0.0"),
        (["POLICY", "--goal", "1", "2", "--robot", "host:x"], "--robot: found 'host:x'"),
        (["POLICY", "--goal", "1", "2", "--log", "POLICY"], "needed a new file"),
        (["nowhere.onnx", "--goal", "1", "2"], "found no file nowhere.onnx"),
        (["--replay", "POLICY"], "needed a log of"),
        (["--replay", "nowhere.log"], "found no such file"),
    ],
)
def test_wrong_use_is_one_sentence(
    words: list[str], said: str, policy: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main.main(["deploy", *(str(policy) if word == "POLICY" else word for word in words)]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert said in err


def test_a_file_that_does_not_say_how_it_is_driven_is_refused(tmp_path: pathlib.Path) -> None:
    from tests.support.onnx_bytes import linear_policy

    path = tmp_path / "plain.onnx"
    path.write_bytes(linear_policy(np.eye(2)))
    with pytest.raises(ValidationError, match="found no description of the robot in its metadata"):
        load(path)
    with pytest.raises(ValidationError, match="found actions of mode 'joint'"):
        load(robot_policy(tmp_path / "joint.onnx", mode="joint"))
