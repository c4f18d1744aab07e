"""Teleoperation without a browser: commands, taking over and giving back, the deadman's switch, latency, the socket."""

import io
import json
import re
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator

import numpy as np
import pytest
import viser
from PIL import Image
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from tests.support.unicycle import unicycle_env
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.evaluation.agents import BASELINES
from urbanverse_mjx.viewer.front import Front, served
from urbanverse_mjx.viewer.session import Machine, NamedPolicy, Session
from urbanverse_mjx.viewer.teleop import (
    DEAD_ZONE,
    MESSAGE_LIFETIME,
    STOP,
    Command,
    Inputs,
    Teleop,
    interventions,
    without_dead_zone,
)


def keys(*names: str, age: float | None = None) -> Inputs:
    return Inputs(frozenset(names), age=age)


def pad(x: float = 0.0, y: float = 0.0, switch: bool = False) -> Inputs:
    return Inputs(axes=(x, y), buttons=(switch, False))


# What is held becomes a command.


@pytest.mark.parametrize(
    ("held", "command"),
    [
        ((), (0.0, 0.0)),
        (("KeyW",), (1.0, 0.0)),
        (("ArrowUp",), (1.0, 0.0)),
        (("KeyW", "ArrowUp"), (1.0, 0.0)),
        (("KeyA",), (0.0, 1.0)),
        (("ArrowRight",), (0.0, -1.0)),
        (("KeyW", "KeyD"), (1.0, -1.0)),
        (("KeyA", "KeyD"), (0.0, 0.0)),
        (("KeyS",), (0.0, 0.0)),
        (("KeyW", "KeyS"), (0.0, 0.0)),
        (("KeyS", "KeyA"), (0.0, 1.0)),
        (("KeyW", "KeyA", "ShiftLeft"), (0.5, 0.5)),
        (("KeyQ", "Space"), (0.0, 0.0)),
    ],
)
def test_keys(held: tuple[str, ...], command: tuple[float, float]) -> None:
    assert keys(*held).command() == command


def test_the_stick_is_ahead_at_minus_one_and_turns_left_at_minus_one() -> None:
    assert pad(0.0, -1.0).command() == (1.0, 0.0)
    assert pad(-1.0, 0.0).command() == (0.0, 1.0)
    assert pad(0.0, 1.0).command() == STOP
    # With a key, both together and no more than all.
    both = Inputs(frozenset({"KeyW", "KeyA"}), (-1.0, -1.0), ())
    assert both.command() == (1.0, 1.0)
    # A gamepad of one axis has no stick.
    assert Inputs(axes=(1.0,)).command() == STOP


def test_the_dead_zone_is_still_and_grows_steadily_from_its_edge() -> None:
    for value in (0.0, 0.5 * DEAD_ZONE, -DEAD_ZONE):
        assert without_dead_zone(value, value) == (0.0, 0.0)
    edge = without_dead_zone(DEAD_ZONE + 1e-3, 0.0)[0]
    assert 0.0 < edge < 0.01
    values = [without_dead_zone(x, 0.0)[0] for x in np.linspace(-1.0, 1.0, 41)]
    assert values == sorted(values)
    assert (values[0], values[-1]) == (-1.0, 1.0)
    assert without_dead_zone(0.1, -0.6)[0] == 0.0
    assert not pad(0.1, -0.1).moves
    assert pad(0.0, -0.5).moves


@pytest.mark.parametrize("mode", ["waypoint", "velocity"])
def test_a_robot_drives_as_it_is_commanded(small_bank: SceneBank, mode: str) -> None:
    """The kinematic robot has the commanded velocity after one step."""
    env = unicycle_env(small_bank, {"action_mode": mode, "vision": False})
    machine = Machine(env, NamedPolicy("zero", BASELINES["zero"]))
    session = Session(machine, 0, [3])
    for command in (Command(1.0, 0.0), Command(0.0, -1.0), Command(1.0, 1.0), Command(0.4, -0.3), STOP):
        frame = session.step({0: machine.action_of(command)})
        speed = np.linalg.norm(np.asarray(frame.nav.sim.qvel)[0, :2])
        # In the mode of waypoints a turn on the spot is a point 5 mm ahead.
        assert speed == pytest.approx(command.speed * env.robot.max_speed, abs=0.02)
        assert float(frame.nav.sim.qvel[0, 5]) == pytest.approx(command.turn * env.robot.max_yaw_rate, abs=1e-3)
        assert frame.reward[0] != 0.0
    assert session.by_hand(5).tolist() == [True] * 5


def test_joints_are_not_driven_by_hand(small_bank: SceneBank) -> None:
    env = unicycle_env(small_bank, {"vision": False})
    env.config.unlock()
    env.config.action_mode = "joint"
    with pytest.raises(ValidationError, match="action_mode: found 'joint', needed 'waypoint' or 'velocity'"):
        Machine(env, NamedPolicy("zero", BASELINES["zero"])).action_of(STOP)


# Taking over and giving back.


def test_a_pressed_key_takes_over_and_its_release_stops() -> None:
    teleop = Teleop(give_back_after=2.0)
    teleop.receive(1, keys(), 0.0)
    assert teleop.command(0.01) is None
    teleop.receive(1, keys("KeyW"), 0.1)
    assert teleop.held
    assert teleop.command(0.12) == (1.0, 0.0)
    teleop.receive(1, keys(), 0.2)
    assert teleop.command(0.22) == STOP
    teleop.receive(1, keys("KeyA"), 0.3)
    assert teleop.command(0.31) == (0.0, 1.0)


def test_seconds_without_a_key_give_back() -> None:
    teleop = Teleop(give_back_after=2.0)
    teleop.receive(1, keys("KeyW"), 0.0)
    for t in np.arange(0.0, 5.0, 0.05):
        teleop.receive(1, keys("KeyW"), float(t))
        assert teleop.command(float(t)) == (1.0, 0.0)
    teleop.receive(1, keys(), 5.0)
    assert teleop.command(6.9) == STOP
    assert teleop.command(7.01) is None
    assert not teleop.held


def test_a_key_that_was_held_all_the_time_drives_on_when_a_page_that_hung_answers_again() -> None:
    teleop = Teleop(give_back_after=2.0)
    teleop.receive(1, keys("KeyW"), 0.0)
    assert teleop.command(0.01) == (1.0, 0.0)
    assert teleop.command(1.9) == STOP
    assert teleop.command(2.1) is None
    teleop.receive(1, keys("KeyW"), 3.0)
    assert teleop.command(3.01) == (1.0, 0.0)
    # Given back by the switch, the key is ignored until it is pressed again.
    teleop.receive(1, keys("KeyW", "KeyT"), 3.1)
    teleop.receive(1, keys("KeyW"), 9.0)
    assert teleop.command(9.01) is None
    # Nothing is held: nobody drives.
    teleop.receive(1, keys(), 9.1)
    teleop.receive(1, keys("KeyW"), 9.2)
    teleop.receive(1, keys(), 9.3)
    assert teleop.command(20.0) is None
    teleop.receive(1, keys(), 21.0)
    assert teleop.command(21.0) is None


def test_with_zero_seconds_only_the_switch_gives_back() -> None:
    teleop = Teleop(give_back_after=0.0)
    teleop.receive(1, keys("KeyW"), 0.0)
    teleop.receive(1, keys(), 0.1)
    assert teleop.command(1e6) == STOP
    teleop.receive(1, keys("KeyT"), 1e6)
    assert teleop.command(1e6) is None


@pytest.mark.parametrize("switch", [keys("KeyT"), pad(switch=True)])
def test_the_switch_takes_over_and_gives_back_once_for_each_press(switch: Inputs) -> None:
    teleop = Teleop()
    for press in range(4):
        for _ in range(3):  # the same press, reported again
            teleop.receive(1, switch, 0.1 * press)
            assert teleop.held == (press % 2 == 0)
        teleop.receive(1, pad(), 0.1 * press + 0.05)
        assert teleop.held == (press % 2 == 0)


def test_a_stick_off_centre_does_not_take_over_but_drives_once_the_button_has() -> None:
    teleop = Teleop()
    teleop.receive(1, pad(0.0, -1.0), 0.0)
    assert teleop.command(0.0) is None
    teleop.receive(1, pad(0.0, -1.0, switch=True), 0.1)
    assert teleop.command(0.1) == (1.0, 0.0)
    # Only a key that is pressed anew takes over again after giving back.
    teleop.receive(1, Inputs(frozenset({"KeyW"}), (), ()), 0.2)
    teleop.receive(1, keys("KeyW", "KeyT"), 0.3)
    teleop.receive(1, keys("KeyW"), 0.4)
    assert teleop.command(0.4) is None
    assert teleop.ignores_key
    teleop.receive(1, keys("KeyW", "KeyA"), 0.5)
    assert teleop.held
    assert not teleop.ignores_key


def test_another_episode_is_driven_by_a_key_held_from_before_only_where_it_says_so() -> None:
    for held_keys in (False, True):
        teleop = Teleop()
        teleop.receive(1, keys("KeyW", "ShiftLeft", age=0.0), 0.0)
        teleop.command(0.0)
        teleop.applied(0.3)
        assert teleop.latency == pytest.approx(0.3)
        teleop.begin_episode(held_keys)
        # The latency of the last episode, in another street with another robot, says nothing about this one.
        assert teleop.latency is None
        assert teleop.command(0.31) is None
        teleop.receive(1, keys("KeyW", "ShiftLeft"), 0.32)
        assert teleop.command(0.33) == ((0.5, 0.0) if held_keys else None)
        assert teleop.ignores_key != held_keys
        teleop.receive(1, keys("ShiftLeft"), 0.34)
        assert not teleop.ignores_key


def test_a_held_switch_does_not_switch_in_another_episode() -> None:
    teleop = Teleop()
    teleop.receive(1, keys("KeyT"), 0.0)
    teleop.begin_episode(held_keys=True)
    teleop.receive(1, keys("KeyT"), 0.1)
    assert not teleop.held


def test_a_second_browser_neither_drives_nor_gives_back() -> None:
    teleop = Teleop()
    teleop.receive(1, keys("KeyW"), 0.0)
    teleop.receive(2, keys("KeyA", "KeyT"), 0.01)
    assert teleop.command(0.02) == (1.0, 0.0)
    teleop.leave(2)
    assert teleop.command(0.03) == (1.0, 0.0)


@pytest.mark.parametrize("leaves", [False, True])
def test_the_robot_stops_within_three_tenths_of_a_second_of_the_last_message(leaves: bool) -> None:
    """Control steps of 0.2 s, at any phase against the messages; the policy drives again after the usual seconds."""
    for phase in np.linspace(0.0, 0.2, 21):
        teleop, last = Teleop(give_back_after=1.0), 1.0
        for t in np.arange(0.0, last + 1e-9, 0.025):
            teleop.receive(7, keys("KeyW", "KeyA"), float(t))
        if leaves:
            teleop.leave(7)
        moved_until = 0.0
        for step in np.arange(last - phase, last + 3.0, 0.2):
            command = teleop.command(float(step))
            if command is not None and command != STOP:
                moved_until = step + 0.2
        assert moved_until <= last + 0.3 + 1e-9
        assert command is None
    assert MESSAGE_LIFETIME > 2 * 0.025


def test_a_tap_between_two_steps_counts_once() -> None:
    teleop = Teleop()
    teleop.receive(1, keys("KeyW"), 0.0)
    teleop.receive(1, keys(), 0.05)
    assert teleop.command(0.1) == (1.0, 0.0)
    assert teleop.command(0.12) == STOP
    # One of before a later takeover does not.
    teleop.receive(1, keys("KeyA"), 0.2)
    teleop.give_back()
    teleop.receive(1, keys("KeyT"), 0.3)
    assert teleop.command(0.3) == STOP


def test_latency_is_the_median_from_the_event_to_the_applied_action() -> None:
    teleop = Teleop()
    assert teleop.latency is None
    teleop.receive(1, keys("KeyW", age=0.010), 1.0, delay=0.005)
    teleop.command(1.1)
    teleop.receive(1, keys("KeyA", age=0.0), 1.15)  # during the step: it belongs to the next
    teleop.applied(1.2)
    assert teleop.latency == pytest.approx(0.215)
    teleop.command(1.25)
    teleop.applied(1.25)
    assert teleop.latency == pytest.approx(np.median([0.215, 0.1]))
    # Repeated states are no events, and an event counts once.
    teleop.receive(1, keys("KeyA"), 1.3)
    teleop.command(1.3)
    teleop.applied(9.0)
    assert teleop.latency == pytest.approx(np.median([0.215, 0.1]))
    for k in range(50):
        teleop.receive(1, keys("KeyA", age=0.0), 10.0 + k)
        teleop.command(10.0 + k)
        teleop.applied(10.04 + k)
    assert teleop.latency == pytest.approx(0.04)
    teleop.receive(1, keys("KeyA", age=0.0), 90.0)
    teleop.forget()
    teleop.command(190.0)
    teleop.applied(190.0)
    assert teleop.latency == pytest.approx(0.04)


def test_interventions_are_counted_by_their_beginnings() -> None:
    assert interventions([]) == 0
    assert interventions([False] * 3) == 0
    assert interventions([True, True, False, True, False]) == 2


# The socket.


@pytest.mark.parametrize(
    "message",
    [
        "no",
        "[]",
        '{"keys": "KeyW", "axes": [], "buttons": []}',
        '{"keys": [1], "axes": [], "buttons": []}',
        '{"keys": [], "axes": [NaN], "buttons": []}',
        '{"keys": [], "axes": [1.5], "buttons": []}',
        '{"keys": [], "axes": []}',
        '{"keys": [], "axes": [], "buttons": [], "age": -1}',
        json.dumps({"keys": ["K" * 5000], "axes": [], "buttons": []}),
    ],
)
def test_a_message_that_is_none_is_refused(message: str) -> None:
    with pytest.raises(ValidationError, match="message"):
        Inputs.parse(message)


def test_a_message_is_read() -> None:
    body = {"keys": ["KeyW"], "axes": [0.5, -1], "buttons": [True, False], "age": 12}
    assert Inputs.parse(json.dumps(body)) == Inputs(frozenset({"KeyW"}), (0.5, -1.0), (True, False), 0.012)


@pytest.fixture
def front() -> Iterator[tuple[viser.ViserServer, Front, Teleop]]:
    teleop = Teleop(give_back_after=60.0)
    with served("127.0.0.1", 0, teleop) as (server, front):
        yield server, front, teleop


def wait(until: Callable[[], bool]) -> None:
    end = time.monotonic() + 20.0
    while not until():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_inputs_come_through_the_socket_and_states_go_back(front: tuple[viser.ViserServer, Front, Teleop]) -> None:
    _, page, teleop = front
    page.state = lambda: {"who": "you drive"}
    held = json.dumps({"keys": ["KeyW"], "axes": [], "buttons": [], "age": 1.0})
    address = page.address.replace("http", "ws") + "/drive"
    with connect(address, proxy=None) as socket:
        assert json.loads(socket.recv(timeout=10.0)) == {"who": "you drive", "library": False}
        socket.send(held)
        wait(lambda: teleop.held)
        socket.send(held)
        wait(lambda: teleop.command(time.monotonic()) == (1.0, 0.0) or socket.send(held) is not None)
    # The browser has left: the robot stops at once.
    wait(lambda: not teleop._browsers)
    assert teleop.command(time.monotonic()) == STOP
    with connect(address, proxy=None) as socket:
        socket.send("no")
        with pytest.raises(ConnectionClosed, match="found no JSON"):
            list(socket)


def test_the_camera_is_sent_while_a_headset_looks(front: tuple[viser.ViserServer, Front, Teleop]) -> None:
    _, page, _ = front
    shown = np.zeros((8, 12, 3), np.uint8)
    shown[:, :6] = 200, 40, 40
    images: list[np.ndarray | None] = [None]
    page.camera = lambda: images[-1]
    assert not page.watched
    with connect(page.address.replace("http", "ws") + "/camera", proxy=None) as socket:
        wait(lambda: page.watched)
        with pytest.raises(TimeoutError):
            socket.recv(timeout=0.3)
        images.append(shown)
        body = socket.recv(timeout=10.0)
        assert isinstance(body, bytes)
        found = np.asarray(Image.open(io.BytesIO(body))).astype(int)
        assert np.abs(found[:, [0, 11]] - shown[:, [0, 11]]).max() < 30, "red on the left"
        with pytest.raises(TimeoutError):
            socket.recv(timeout=0.3)  # the same image is not sent again
        images.append(255 - shown)
        assert np.asarray(Image.open(io.BytesIO(bytes(socket.recv(timeout=10.0))))).mean() > 128  # type: ignore[arg-type]
    wait(lambda: not page.watched)


def test_a_page_that_shows_no_street_yet_says_so() -> None:
    """A first start compiles streets for minutes, while the port already answers."""
    with served("127.0.0.1", 0, Teleop()) as (_, front):
        with connect(f"ws://127.0.0.1:{front.port}/drive", proxy=None) as socket:
            state = json.loads(socket.recv(5.0))
        shown = set(re.findall(r"\bstate\.(\w+)", urllib.request.urlopen(front.address).read().decode()))
    assert state["who"] == "loading"
    assert shown <= set(state)  # otherwise the page's script fails


def test_the_page_and_visers_own_come_from_one_port(front: tuple[viser.ViserServer, Front, Teleop]) -> None:
    server, page, _ = front

    def get(path: str) -> bytes:
        return urllib.request.urlopen(page.address + path, timeout=10.0).read()

    assert b'src="viser/"' in get("/")
    for script in re.findall(rb'<script src="([^"]+)"', get("/")):
        assert get(f"/{script.decode()}").startswith(b'"use strict"')
    assert get("/viser/?x=1") == urllib.request.urlopen(f"http://127.0.0.1:{server.get_port()}/", timeout=10.0).read()
    for missing in ("/viser/nothing.js", "/nothing", "/viser/../../secret"):
        with pytest.raises(urllib.error.HTTPError, match="404"):
            get(missing)
    # A client of another version is refused as viser refuses it.
    address = page.address.replace("http", "ws")
    old = [Subprotocol("viser-v0.0.1")]
    with (
        connect(f"{address}/viser", proxy=None, subprotocols=old) as socket,
        pytest.raises(ConnectionClosed, match="1002"),
    ):
        list(socket)
    with (
        connect(f"{address}/elsewhere", proxy=None) as socket,
        pytest.raises(ConnectionClosed, match="found no /elsew"),
    ):
        socket.recv(timeout=10.0)


def test_a_taken_port_is_refused(front: tuple[viser.ViserServer, Front, Teleop]) -> None:
    port = front[1].port
    with pytest.raises(ValidationError, match=f"--port: found {port} on 127.0.0.1 taken"):
        with served("127.0.0.1", port, Teleop()):
            pass
