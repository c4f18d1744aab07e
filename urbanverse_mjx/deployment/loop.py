"""The loop of `urbanverse deploy`: takes messages and answers as they come, lets the `Controller` decide, and sends.

In:   a policy's file, goals, the addresses of a robot. Out: commands, a log, and a summary. When: until the last goal
is reached, the time is over, the policy's process is lost, or a signal comes.
"""

import contextlib
import dataclasses
import hashlib
import importlib.metadata
import math
import pathlib
import secrets
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from .controller import ARRIVED, DRIVING, LOST, Command, Controller, Limits, Output
from .log import LogWriter
from .messages import COMMAND_PORT, MAX_PART, SENSOR_PORT
from .policy_process import PolicyProcess

#: ms without a message after which the controller is called with none.
_POLL_TIMEOUT = 10
#: s that commands are still sent after the goal, and the speed (m/s) below which the robot stands.
_STOPPING_TIME, _STANDING_SPEED = 2.0, 0.05
#: Messages that are taken at once.
_MOST_AT_ONCE = 100
#: ms that sockets wait at the end for the last command to be sent.
_LINGER_TIME = 200


@dataclasses.dataclass(frozen=True)
class Endpoints:
    """ZeroMQ endpoints of a robot: where it publishes odometry and images, and where it takes commands."""

    sensors: str
    commands: str

    @staticmethod
    def of(host: str) -> "Endpoints":
        """Those of a robot with the default ports; host: HOST, or HOST:PORT with the next port for commands.

        Raises:
          ValidationError: the port is not a number from 1 to 65534.
        """
        name, _, port = host.partition(":")
        if not name or (port and not (port.isascii() and port.isdigit() and 0 < int(port) < 65535)):
            raise ValidationError(f"--robot: found {host!r}, needed ros, HOST or HOST:PORT.")
        first = int(port) if port else SENSOR_PORT
        return Endpoints(f"tcp://{name}:{first}", f"tcp://{name}:{first + 1 if port else COMMAND_PORT}")


def versions() -> dict[str, str]:
    """Versions of the packages that compute actions."""
    return {name: importlib.metadata.version(name) for name in ("numpy", "onnxruntime", "pillow")}


class _Stopped(Exception):
    """A second signal asked to stop."""


@contextlib.contextmanager
def _signals() -> Iterator[threading.Event]:
    """Gives an event that a signal sets. It does not raise, because between an event and its decisions it would leave a
    log that no replay agrees with; only a second signal does, in case the loop does not get to look."""
    stopped = threading.Event()

    def stop(*_: Any) -> None:
        if stopped.is_set():
            raise _Stopped
        stopped.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class _Loop:
    def __init__(
        self,
        controller: Controller,
        policy: PolicyProcess,
        endpoints: Endpoints,
        log: LogWriter,
        say: Callable[[str], None] | None,
    ):
        import zmq

        self.controller, self._policy, self._log, self._say = controller, policy, log, say
        self._context = zmq.Context()
        self._sensors, self._commands = (self._context.socket(kind) for kind in (zmq.SUB, zmq.PUB))
        self._sensors.set(zmq.SUBSCRIBE, b"")
        self._sensors.set(zmq.MAXMSGSIZE, MAX_PART)
        for socket, endpoint in ((self._sensors, endpoints.sensors), (self._commands, endpoints.commands)):
            socket.set(zmq.LINGER, _LINGER_TIME)
            try:
                socket.connect(endpoint)
            except zmq.ZMQError as error:
                raise ValidationError(f"--robot: found {endpoint} ({error}), needed ros, HOST or HOST:PORT.") from error
        self._poller = zmq.Poller()
        self._poller.register(self._sensors, zmq.POLLIN)
        self._poller.register(policy.fileno(), zmq.POLLIN)
        self._again, self._dont_wait = zmq.Again, zmq.DONTWAIT
        self._said: set[str] = set()

    def run(self, time_limit: float | None) -> str:
        """Returns the result: arrived, time limit, policy lost or interrupted."""
        end = None if time_limit is None else time.monotonic() + time_limit
        arrived_at = None
        try:
            with _signals() as stopped:
                while True:
                    self._turn(stopped)
                    if stopped.is_set():
                        return "interrupted"
                    found = self.controller.odometry
                    if self.controller.reason == LOST:
                        return LOST
                    if end is not None and time.monotonic() >= end:
                        return "time limit"
                    if self.controller.reason == ARRIVED and found is not None:
                        arrived_at = arrived_at or time.monotonic()
                        stands = math.hypot(*found.velocity_mps) < _STANDING_SPEED
                        if stands or time.monotonic() - arrived_at > _STOPPING_TIME:
                            return "arrived"
        except _Stopped:
            return "interrupted"

    def _turn(self, stopped: threading.Event) -> None:
        ready = dict(self._poller.poll(_POLL_TIMEOUT))
        if self._policy.fileno() in ready:
            self._take_answers()
        taken = 0
        while taken < _MOST_AT_ONCE and not stopped.is_set():
            try:
                parts = self._sensors.recv_multipart(self._dont_wait)
            except self._again:
                break
            taken += 1
            now = time.monotonic_ns()
            self._log.add({"event": "message", "t_ns": now, "sizes": [len(p) for p in parts]}, b"".join(parts))
            self._send(self.controller.message(parts, now))
        if not ready:
            now = time.monotonic_ns()
            self._log.add({"event": "lapse", "t_ns": now})
            self._send(self.controller.lapse(now))

    def _take_answers(self) -> None:
        try:
            while (found := self._policy.receive()) is not None:
                number, action = found
                now, shape, blob = time.monotonic_ns(), None, b""
                if action is not None:
                    action = np.ascontiguousarray(action, np.float32)
                    shape, blob = list(action.shape), action.tobytes()
                self._log.add({"event": "answer", "t_ns": now, "number": number, "shape": shape}, blob)
                self._send(self.controller.answer(number, action, now))
        except EOFError:
            now, what = time.monotonic_ns(), "the process ended"
            self._log.add({"event": "lost", "t_ns": now, "what": what})
            self._send(self.controller.lost(what, now))

    def _send(self, outputs: list[Output]) -> None:
        self._log.add_outputs(outputs)
        for output in outputs:
            if isinstance(output, Command):
                self._commands.send_multipart(output.parts())
            else:
                self._policy.ask(output)
        reason = self.controller.reason
        if reason not in self._said:
            self._said = {reason} if reason == DRIVING else {reason, *self._said} - {DRIVING}
            detail = f" ({self.controller.refusal})" if reason == "bad message" else ""
            if self._say is not None:
                self._say(reason + detail)

    def stop(self, reason: str) -> None:
        """Sends the last command."""
        self._log.add({"event": "stop", "reason": reason})
        self._send(self.controller.stop(reason))

    def close(self) -> None:
        self._sensors.close(0)
        self._commands.close()
        self._context.term()


def drive(
    path: pathlib.Path,
    goals: tuple[tuple[float, float], ...],
    endpoints: Endpoints,
    limits: Limits,
    log: pathlib.Path | None = None,
    time_limit: float | None = None,
    say: Callable[[str], None] | None = None,
) -> dict[str, Any]:
    """Drives a robot to goals, one after another.

    Args:
      path: ONNX file of `urbanverse export-onnx`.
      goals: (x, y) m in the odometry frame.
      log: file to write, see `log`.
      time_limit: s after which to stop.
      say: called when the robot drives, and with every reason to stand, once until it drives again.

    Returns:
      result: arrived, time limit, policy lost or interrupted; faults: how often each began; actions: their number;
      inference_ms: median and 99th percentile of the time that the policy took.

    Raises:
      ValidationError: the file is no policy that can be driven so, an address is wrong, or the log's file exists.
    """
    path = path.expanduser()
    policy = PolicyProcess.start(path)
    try:
        writer = LogWriter(log)
        try:
            session = secrets.token_hex(8)
            controller = Controller(policy.contract, goals, limits, session)
            writer.add(
                {
                    "event": "begin",
                    "policy": str(path.absolute()),
                    "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
                    "goals": [list(goal) for goal in goals],
                    "limits": dataclasses.asdict(limits),
                    "session": session,
                    "versions": versions(),
                }
            )
            loop = _Loop(controller, policy, endpoints, writer, say)
            try:
                result = loop.run(time_limit)
                loop.stop(result)
            finally:
                loop.close()
        finally:
            writer.close()
    finally:
        policy.close()
    times = np.array(policy.seconds or [0.0]) * 1e3
    taken = {"median": round(float(np.median(times)), 3), "p99": round(float(np.percentile(times, 99)), 3)}
    return {
        "result": result,
        "faults": controller.faults,
        "actions": controller.actions,
        "inference_ms": taken if policy.seconds else None,
    }
