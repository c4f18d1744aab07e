"""`urbanverse deploy` against the simulator as the robot: whatever fails, the robot stands within 0.3 s."""

import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import jax.numpy as jnp
import numpy as np
import psutil
import pytest

from tests.support.robot_policy import robot_policy
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.deployment.controller import Limits, Output
from urbanverse_mjx.deployment.log import LogWriter, read_log
from urbanverse_mjx.deployment.loop import Endpoints, drive
from urbanverse_mjx.deployment.messages import Image, Odometry
from urbanverse_mjx.deployment.replay import replay
from urbanverse_mjx.deployment.robot_side import CommandGate, RobotLink
from urbanverse_mjx.pipeline.robot_simulation import STEP, RealTime, SimulatedRobot

ROOT = pathlib.Path(__file__).parents[2]
#: s of the robot's clock in which it must stand.
LIMIT = 0.3
RECOVERY = 0.5
Send = Callable[[str, Odometry | Image], None]


class FineImage:
    """A renderer whose red, green and blue show x, y and heading, so that every motion changes it."""

    def __call__(self, scene: Any, xpos: Any, xquat: Any, *_: Any, **__: Any) -> dict[str, Any]:
        pose = jnp.stack([xpos[1, 0], xpos[1, 1], xquat[1, 3]]) * 700.0
        pixels = jnp.arange(12)[:, None, None] * 5 + jnp.arange(16)[None, :, None] + pose
        return {"rgb": (pixels % 256).astype(jnp.uint8)}


class Running:
    """A simulated robot in a thread, whose messages can be changed on their path.

    Attributes:
      fault: called with (kind, message) in place of sending it; None to send it.
      image: the last one that was sent without a fault.
      velocities: of every step.
    """

    def __init__(self, bank: SceneBank) -> None:
        task = {"ctrl_dt": STEP, "action_mode": "velocity", "episode_length": 10**6}
        ends = {"terminate_off_traversable": False, "terminate_on_hit": False, "success_radius": 0.0}
        env = unicycle_env(bank, task | ends, vision=True)
        env.renderer = FineImage()
        self.link = RobotLink("tcp://127.0.0.1:*", "tcp://127.0.0.1:*")
        self.fault: Send | None = None
        self.image: Image | None = None
        self.velocities: list[tuple[float, float]] = []
        self.robot = SimulatedRobot(env, 0, 0, self.link, publish=self._publish)
        self._changed, self._end = threading.Condition(), False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def address(self) -> tuple[str, str]:
        return self.link.endpoints[0], self.link.endpoints[1]

    def _publish(self, kind: str, message: Odometry | Image) -> None:
        if isinstance(message, Image) and self.fault is None:
            self.image = message
        (self.fault or (lambda _, m: self.link.publish(m)))(kind, message)

    def _run(self) -> None:
        clock = RealTime(STEP)
        while not self._end:
            self.robot.tick()
            with self._changed:
                self.velocities.append(self.robot.velocity)
                self._changed.notify_all()
            clock.wait()

    def new_master(self) -> None:
        """Forgets the process that drove."""
        self.link.gate = CommandGate()
        steps = len(self.velocities) + 2
        self.wait(lambda: len(self.velocities) >= steps)

    def wait(self, until: Callable[[], bool], seconds: float = 30.0) -> None:
        with self._changed:
            assert self._changed.wait_for(until, seconds)

    def wait_until_it_drives(self) -> None:
        self.wait(lambda: self.link.gate.last is not None and self.velocities[-1][0] > 0.5)

    def time_to_stand(self, cause: Callable[[], None], watched: float = 0.45) -> float:
        """s of the robot's clock from a cause to the last step that moved, within the next `watched` s."""
        began = len(self.velocities)
        cause()
        self.wait(lambda: len(self.velocities) >= began + round(watched / STEP))
        moved = [i for i, (v, w) in enumerate(self.velocities[began : began + round(watched / STEP)]) if v or w]
        return (moved[-1] + 1 if moved else 0) * STEP

    def close(self) -> None:
        self._end = True
        self._thread.join()
        self.link.close()


@pytest.fixture(scope="module")
def running(small_bank: SceneBank) -> Iterator[Running]:
    found = Running(small_bank)
    yield found
    found.close()


@pytest.fixture(scope="module")
def policy(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    return robot_policy(tmp_path_factory.mktemp("policy") / "policy.onnx")


def started(running: Running, policy: pathlib.Path, log: pathlib.Path) -> "subprocess.Popen[str]":
    """The command, on its way to a goal that is far away."""
    running.fault = None
    running.new_master()
    sensors, commands = (endpoint.rpartition(":")[2] for endpoint in running.address)
    code = (
        "import sys; from urbanverse_mjx.deployment import loop; from urbanverse_mjx.cli import main; "
        f"loop.Endpoints.of = lambda _: loop.Endpoints('tcp://127.0.0.1:{sensors}', 'tcp://127.0.0.1:{commands}'); "
        "sys.exit(main.main(sys.argv[1:]))"
    )
    words = ["deploy", str(policy), "--goal", "1e5", "0", "--log", str(log), "--recovery", str(RECOVERY)]
    return subprocess.Popen(
        [sys.executable, "-c", code, *words], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


@pytest.fixture
def deploy(running: Running, policy: pathlib.Path, tmp_path: pathlib.Path) -> Iterator[subprocess.Popen[str]]:
    """The command, driving the robot."""
    process = started(running, policy, tmp_path / "run.log")
    try:
        running.wait_until_it_drives()
        yield process
    finally:
        process.kill()
        print(process.communicate())
        running.fault = None


def policy_process(parent: int) -> int:
    (found,) = [p.pid for p in psutil.Process(parent).children() if "spawn_main" in " ".join(p.cmdline())]
    return found


@pytest.mark.extended
def test_a_killed_loop_leaves_a_log_that_replays(
    running: Running, deploy: subprocess.Popen[str], tmp_path: pathlib.Path
) -> None:
    child = psutil.Process(policy_process(deploy.pid))
    drove = len(running.velocities)
    running.wait(lambda: len(running.velocities) > drove + 1.3 / STEP)
    assert 0.0 < running.time_to_stand(deploy.kill) <= LIMIT
    child.wait(10.0)  # the policy's process does not outlive it
    log = tmp_path / "run.log"
    found = replay(log)
    assert (found["identical"], found["difference"], found["versions_differ"]) == (True, None, [])
    assert found["actions"] >= 6
    body = log.read_bytes()
    log.write_bytes(body[: len(body) // 2])
    half = replay(log)
    assert half["identical"]
    assert 0 < half["commands"] < found["commands"]
    log.write_bytes(body[:5000] + bytes([body[5000] ^ 1]) + body[5001:])
    with pytest.raises(ValidationError, match="found a damaged record at byte"):
        replay(log)
    assert_another_image_gives_another_action(log, body, found["actions"])


@pytest.mark.slow
def test_killed_at_any_moment_the_robot_stands_and_the_next_one_drives(
    running: Running, policy: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    """At ten moments, from the start of the process to some seconds of driving."""
    draw, begin = random.Random(0), time.monotonic()
    process = started(running, policy, tmp_path / "first.log")
    running.wait_until_it_drives()
    seconds = time.monotonic() - begin
    drove = 0
    for k in range(10):
        process.kill()
        process.communicate()
        log = tmp_path / f"{k}.log"
        process = started(running, policy, log)
        time.sleep(draw.uniform(0.0, seconds + 2.0))
        children = psutil.Process(process.pid).children(recursive=True)
        assert running.time_to_stand(process.kill) <= LIMIT
        assert psutil.wait_procs(children, timeout=10.0)[1] == []
        if log.is_file() and list(read_log(log)):
            found = replay(log)
            assert (found["identical"], found["difference"]) == (True, None)
            drove += found["actions"] > 0
    assert drove > 0
    process = started(running, policy, tmp_path / "last.log")
    running.wait_until_it_drives()
    process.send_signal(signal.SIGINT)
    assert json.loads(process.communicate(timeout=20.0)[0])["result"] == "interrupted"


def assert_another_image_gives_another_action(log: pathlib.Path, body: bytes, actions: int) -> None:
    """A log in which one pixel of an image is another one, with a checksum that fits."""
    log.write_bytes(body)
    records = list(read_log(log))
    images = [
        i for i, (fields, blob) in enumerate(records) if fields["event"] == "message" and blob.startswith(b"image")
    ]
    for i in images[len(images) // 2 :][:2]:  # one of two in a row is the policy's
        fields, blob = records[i]
        records[i] = fields, blob[:-264] + bytes([blob[-264] ^ 128]) + blob[-263:]
    log.unlink()
    writer = LogWriter(log)
    for fields, blob in records:
        writer.add(fields, blob)
    writer.close()
    found = replay(log)
    assert not found["identical"]
    assert 0 < found["actions"] < actions
    assert "request" in found["difference"]


@pytest.mark.extended
def test_a_loop_and_a_policy_that_hang_and_then_a_killed_policy(
    running: Running, deploy: subprocess.Popen[str]
) -> None:
    child = policy_process(deploy.pid)
    for hanging in (deploy.pid, child):
        assert 0.0 < running.time_to_stand(lambda pid=hanging: os.kill(pid, signal.SIGSTOP), 1.0) <= LIMIT
        os.kill(hanging, signal.SIGCONT)
        running.wait_until_it_drives()
    assert running.time_to_stand(lambda: os.kill(child, signal.SIGKILL)) <= LIMIT
    out, err = deploy.communicate(timeout=20.0)
    assert deploy.returncode == 1, err
    assert json.loads(out)["result"] == "policy lost"


def lose(kind: str) -> Callable[[Running], Send]:
    return lambda running: lambda k, message: None if k == kind or kind == "all" else running.link.publish(message)


def delay(kind: str, seconds: float) -> Callable[[Running], Send]:
    """Messages arrive later, in order."""

    def make(running: Running) -> Send:
        kept: list[tuple[int, Odometry | Image]] = []

        def send(k: str, message: Odometry | Image) -> None:
            if kind not in (k, "all"):
                running.link.publish(message)
                return
            kept.append((message.stamp_ns, message))
            while kept and kept[0][0] <= running.robot.stamp_ns - seconds * 1e9:
                running.link.publish(kept.pop(0)[1])

        return send

    return make


def tilted(message: Odometry) -> dict[str, object]:
    """The same heading, and a pitch of 0.5 rad."""
    w, _, _, z = message.orientation_wxyz
    cos, sin = np.cos(0.25), np.sin(0.25)
    return {"orientation_wxyz": [w * cos, -z * sin, w * sin, z * cos]}


def change(fields: Callable[[Odometry], dict[str, object]]) -> Callable[[Running], Send]:
    """Odometry with other values."""

    def make(running: Running) -> Send:
        def send(k: str, message: Odometry | Image) -> None:
            if isinstance(message, Odometry):
                parts = message.parts()
                running.link.publish_parts([parts[0], json.dumps({**json.loads(parts[1]), **fields(message)}).encode()])
            else:
                running.link.publish(message)

        return send

    return make


def freeze(running: Running) -> Send:
    """The camera repeats its image with new stamps."""

    def send(_: str, message: Odometry | Image) -> None:
        last = running.image  # read here, in the thread that sends it
        if isinstance(message, Image) and last is not None:
            message = Image(message.stamp_ns, message.fovy_rad, last.pixels)
        running.link.publish(message)

    return send


def garbage(running: Running) -> Send:
    """Random and wrong messages in place of all others."""
    draw = random.Random(0)

    def send(k: str, message: Odometry | Image) -> None:
        parts = message.parts()
        wrong = [
            [draw.randbytes(draw.randrange(200)) for _ in range(draw.randrange(1, 5))],
            [parts[0], draw.randbytes(40)],
            [parts[0], parts[1][: len(parts[1]) // 2]],
            [parts[0], b"[" * 4000],
            [parts[0], b'{"stamp_ns": 1e999}'],
            [b"image", b'{"stamp_ns":1,"height":4096,"width":4096,"fovy_rad":0}', b"short"],
            [b"command", *parts[1:]],
            [*parts, b""],
            [],
        ]
        running.link.publish_parts(draw.choice(wrong) or [b""])

    return send


def one_wrong_message(running: Running) -> Send:
    """A single message that cannot be read, among good ones."""
    left = [None]

    def send(_: str, message: Odometry | Image) -> None:
        if left:
            left.pop()
            running.link.publish_parts([b"odometry", b"{}"])
        running.link.publish(message)

    return send


def backwards(running: Running) -> Send:
    """Stamps that go back by a second."""

    def send(_: str, message: Odometry | Image) -> None:
        running.link.publish_parts([p.replace(b'"stamp_ns":', b'"stamp_ns":-') for p in message.parts()])

    return send


FAULTS: dict[str, tuple[Callable[[Running], Send], str]] = {
    "no image any more": (lose("image"), "stale image"),
    "no odometry any more": (lose("odometry"), "stale odometry"),
    "a cut cable": (lose("all"), "stale odometry"),
    "images half a second late": (delay("image", 0.5), "stale image"),
    "everything half a second late": (delay("all", 0.5), "stale"),
    "a frozen camera": (freeze, "stale image"),
    "garbage": (garbage, "bad message"),
    "one wrong message": (one_wrong_message, "bad message"),
    "stamps that go back": (backwards, "bad message"),
    "odometry that is no number": (change(lambda _: {"yaw_rate_radps": float("nan")}), "bad message"),
    "a robot that tips over": (change(tilted), "tilt"),
    "a robot that runs away": (change(lambda _: {"velocity_mps": [4.0, 0.0]}), "overspeed"),
}


@pytest.mark.extended
def test_every_fault_of_the_sensors_and_then_the_same_run_again_from_its_log(
    running: Running, deploy: subprocess.Popen[str], policy: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    taken = {}
    for name, (make, _) in FAULTS.items():
        running.wait_until_it_drives()
        fault = make(running)
        taken[name] = running.time_to_stand(lambda fault=fault: setattr(running, "fault", fault))
        running.fault = None
    running.wait_until_it_drives()
    assert {name: seconds for name, seconds in taken.items() if seconds > LIMIT} == {}
    assert running.time_to_stand(lambda: deploy.send_signal(signal.SIGTERM)) <= LIMIT
    assert running.link.gate.last is not None
    assert running.link.gate.last.reason == "interrupted"
    out, err = deploy.communicate(timeout=20.0)
    assert (deploy.returncode, json.loads(out)["result"]) == (130, "interrupted")
    faults = json.loads(out)["faults"]
    for name, (_, said) in FAULTS.items():
        assert any(key.startswith(said) for key in faults), (name, faults, err)
    done = subprocess.run(
        [sys.executable, "-m", "urbanverse_mjx.cli.main", "deploy", "--replay", str(tmp_path / "run.log")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    found = json.loads(done.stdout)
    assert (done.returncode, found["identical"], found["difference"]) == (0, True, None)
    assert found["actions"] >= len(FAULTS)
    assert found["commands"] > 500


def test_a_signal_between_an_event_and_its_decisions_leaves_a_log_that_replays(
    running: Running, policy: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    running.fault = None
    running.new_master()
    add, sent = LogWriter.add_outputs, []

    def interrupted(writer: LogWriter, outputs: list[Output]) -> None:
        if outputs and not sent and running.link.gate.last is not None:
            sent.append(outputs)
            os.kill(os.getpid(), signal.SIGTERM)
        add(writer, outputs)

    monkeypatch.setattr(LogWriter, "add_outputs", interrupted)
    log = tmp_path / "run.log"
    said = drive(policy, ((1e5, 0.0),), Endpoints(*running.address), Limits(), log, time_limit=20.0)
    assert (said["result"], len(sent)) == ("interrupted", 1)
    assert replay(log)["difference"] is None
