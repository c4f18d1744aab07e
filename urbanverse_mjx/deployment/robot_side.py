"""The robot's side of the bridge: which velocity is in force, and the sockets.

`CommandGate` is what keeps a robot safe when the other side fails in any manner: a command counts until the robot's own
clock passes the time that stands in it.
"""

from collections.abc import Sequence
from typing import Any

from ..datatypes import ValidationError
from .messages import COMMAND_PORT, SENSOR_PORT, Command, Image, Odometry, decode

#: ns; commands that are in force for longer are ignored.
_MAX_DURATION = 10**9
#: ns without a command of the session in force, after which another session may drive.
_HANDOVER_TIME = 10**9
#: Messages that are taken in one call, so that a flood of them cannot hold the robot's loop.
_MOST_AT_ONCE = 1000


class CommandGate:
    """The velocity that is in force, from commands as they arrive.

    Attributes:
      refused: number of messages that were ignored: not commands, out of order, of another session, or in force for
        too long.
      last: the newest command, or None.
    """

    def __init__(self) -> None:
        self.refused = 0
        self.last: Command | None = None
        self._arrived_ns = 0

    def receive(self, parts: Sequence[bytes], now_ns: int) -> bool:
        """Takes a message; returns whether it is in force from now on. now_ns: the robot's clock."""
        try:
            command = decode(parts)
        except ValidationError:
            command = None
        if not isinstance(command, Command) or not self._is_next(command, now_ns):
            self.refused += 1
            return False
        self.last, self._arrived_ns = command, now_ns
        return True

    def _is_next(self, command: Command, now_ns: int) -> bool:
        if command.expires_ns > now_ns + _MAX_DURATION:
            return False
        if self.last is None or command.session != self.last.session:
            return self.last is None or now_ns - self._arrived_ns > _HANDOVER_TIME
        return command.sequence > self.last.sequence

    def velocity(self, now_ns: int) -> tuple[float, float]:
        """(m/s ahead, rad/s to the left) in force at a time of the robot's clock; zeros when the command expired."""
        if self.last is None or now_ns >= self.last.expires_ns:
            return 0.0, 0.0
        return self.last.speed_mps, self.last.yaw_rate_radps


class RobotLink:
    """Sockets of a robot: publishes odometry and images, takes commands.

    Args:
      sensors, commands: ZeroMQ endpoints to bind; the defaults listen to this machine alone.

    Attributes:
      gate: the commands.
      endpoints: what is bound, with the numbers of ports that were chosen for `tcp://127.0.0.1:*`.

    Raises:
      ValidationError: an endpoint cannot be bound.
    """

    def __init__(
        self, sensors: str = f"tcp://127.0.0.1:{SENSOR_PORT}", commands: str = f"tcp://127.0.0.1:{COMMAND_PORT}"
    ) -> None:
        import zmq

        self._context = zmq.Context()
        self._sensors, self._commands = (self._context.socket(kind) for kind in (zmq.PUB, zmq.SUB))
        self._sensors.set(zmq.SNDHWM, 100)
        self._commands.set(zmq.SUBSCRIBE, b"")
        self._commands.set(zmq.MAXMSGSIZE, 2**16)
        self._again, self._dont_wait = zmq.Again, zmq.DONTWAIT
        for socket, endpoint in ((self._sensors, sensors), (self._commands, commands)):
            socket.set(zmq.LINGER, 0)
            try:
                socket.bind(endpoint)
            except zmq.ZMQError as error:
                self.close()
                raise ValidationError(
                    f"{endpoint}: found the error {str(error)!r}, needed an address to bind."
                ) from error
        bound: list[Any] = [s.get(zmq.LAST_ENDPOINT) for s in (self._sensors, self._commands)]
        self.endpoints = tuple(endpoint.decode() for endpoint in bound)
        self.gate = CommandGate()

    def publish(self, message: Odometry | Image) -> None:
        """Publishes a message."""
        self._sensors.send_multipart(message.parts())

    def publish_parts(self, parts: Sequence[bytes]) -> None:
        """Sends the parts of a message as they are."""
        self._sensors.send_multipart(list(parts))

    def receive(self, now_ns: int) -> int:
        """Takes the commands that have arrived; returns their number. now_ns: the robot's clock."""
        taken = 0
        for _ in range(_MOST_AT_ONCE):
            try:
                parts = self._commands.recv_multipart(self._dont_wait)
            except self._again:
                break
            taken += self.gate.receive(parts, now_ns)
        return taken

    def close(self) -> None:
        """Closes the sockets."""
        for socket in (self._sensors, self._commands):
            socket.close()
        self._context.term()
