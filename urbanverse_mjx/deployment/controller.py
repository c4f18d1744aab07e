"""Decides what a robot does, from the messages that arrive: the part of `urbanverse deploy` without sockets or clocks.

`Controller` is a function of its events alone, so that a log of them can be replayed to the bit. Every method returns
what is to be sent: requests to the policy's process, and commands to the robot.

A robot stands still unless nothing is wrong: `Controller.fault` lists what can be. Ages of odometry, images and actions
are differences of stamps of the robot's clock; the times of this machine's clock only bound how long the policy takes
and how long nothing may arrive.
"""

import collections
import dataclasses
import math

import numpy as np

from ..datatypes import ValidationError
from ..policies.onnx_agent import IMAGE
from .contract import Contract, Inputs, checked_actions, tilt_of, yaw_of
from .image_size import fit_image
from .messages import Command, Image, Odometry, decode

DRIVING, ARRIVED, LOST = "driving", "arrived", "policy lost"
#: m or rad, motion after which two images cannot be equal.
_MIN_MOTION = 0.02
#: Largest number of odometry messages in which this is looked for.
_MAX_TRACK = 200
#: Faults while the robot still has to begin, after which it need not wait before it drives.
_STARTING = ("no odometry", "no image", "no action")


@dataclasses.dataclass(frozen=True)
class Limits:
    """Limits within which a robot is driven.

    Attributes:
      max_speed: m/s, max_yaw_rate: rad/s; a faster command is slowed along the same curve. None for the policy's.
      max_tilt: rad, of the body's z axis from the vertical.
      odometry_age: s, after the stamp of the newest odometry, at which commands expire.
      image_age: s, the same for the newest image.
      answer_time: s, within which the policy's process must answer.
      recovery: s without a fault before the robot drives again.
      goal_radius: m, within which a goal is reached.
    """

    max_speed: float | None = None
    max_yaw_rate: float | None = None
    max_tilt: float = 0.35
    odometry_age: float = 0.2
    image_age: float = 0.25
    answer_time: float = 0.1
    recovery: float = 1.0
    goal_radius: float = 1.0


@dataclasses.dataclass(frozen=True)
class Request:
    """A question to the policy's process, answered in order.

    Attributes:
      number: counts from 1.
      inputs: observations (1, ...); None only asks whether the process is alive.
      begin: whether an episode begins, so that memory is reset.
    """

    number: int
    inputs: Inputs | None
    begin: bool = False


Output = Request | Command


class Controller:
    """Drives one robot along goals.

    Args:
      contract: of the policy.
      goals: (x, y) m in the odometry frame, in order; at least one.
      limits: see `Limits`.
      session: 16 hexadecimal digits.

    Attributes:
      faults: how often each fault stopped the robot.
      reason: `DRIVING`, `ARRIVED` or the present fault.
      actions: number of actions of the policy.
      refusal: why the newest message that was refused was refused; "" if none was.
    """

    def __init__(
        self, contract: Contract, goals: tuple[tuple[float, float], ...], limits: Limits, session: str
    ) -> None:
        self._contract, self._goals, self._limits, self._session = contract, goals, limits, session
        self._max_speed, self._max_turn = (
            own if told is None else min(told, own)
            for told, own in (
                (limits.max_speed, contract.robot.max_speed),
                (limits.max_yaw_rate, contract.robot.max_yaw_rate),
            )
        )
        self.faults: dict[str, int] = {}
        self.reason = "no odometry"
        self.actions = 0
        self.refusal = ""
        self.odometry: Odometry | None = None
        self._image: np.ndarray | None = None
        self._image_stamp = self._image_seen = -1
        self._image_bytes: np.ndarray | None = None
        #: Odometry since the first image with the content of the newest one.
        self._track: collections.deque[Odometry] = collections.deque(maxlen=_MAX_TRACK)
        self._repeats = False
        self._arrived_ns = 0  # of the newest odometry, by this machine's clock
        self._goal = 0
        self._action = np.zeros(2, np.float32)
        self._action_stamp: int | None = None
        self._due_stamp = 0
        self._begin = True
        self._asked: tuple[Request, int, int] | None = None  # with the times by both clocks
        self._requests = self._commands = 0
        self._lost = ""

        self._stopped = False  # by a fault, and has not driven since
        self._good_stamp: int | None = None  # of the first odometry without a fault since then
        self._named: set[str] = set()  # faults since the robot last drove

    @property
    def arrived(self) -> bool:
        """Whether the last goal was reached."""
        return self._goal >= len(self._goals)

    # Events.

    def message(self, parts: list[bytes], now_ns: int) -> list[Output]:
        """A message of the robot has arrived."""
        try:
            message = decode(parts)
            if isinstance(message, Odometry):
                self._take_odometry(message, now_ns)
            elif isinstance(message, Image):
                self._take_image(message)
            else:
                raise ValidationError("message: found a command, needed odometry or an image.")
        except ValidationError as error:
            self.refusal = str(error)
            return self._decide(now_ns, bad=True)
        if isinstance(message, Image):
            return self._decide(now_ns)
        outputs = self._ask(now_ns)
        return outputs + self._decide(now_ns, always=True)

    def answer(self, number: int, action: np.ndarray | None, now_ns: int) -> list[Output]:
        """The policy's process has answered a request; action: (1, 2), None for a request without inputs."""
        if self._asked is None or self._asked[0].number != number:
            return self.lost(f"an answer to request {number}, which was not asked", now_ns)
        request, _, stamp = self._asked
        self._asked = None
        if request.inputs is not None:
            try:
                self._action = checked_actions(np.zeros(0) if action is None else action)
            except ValidationError as error:
                return self.lost(str(error), now_ns)
            self.actions += 1
            if not self._recovering:
                self._action_stamp = stamp
        return self._decide(now_ns, always=request.inputs is not None)

    def lost(self, what: str, now_ns: int) -> list[Output]:
        """The policy's process has ended, or answers what it should not; it is not asked again."""
        self._lost = self._lost or what
        return self._decide(now_ns)

    def lapse(self, now_ns: int) -> list[Output]:
        """Nothing has arrived for a while."""
        return self._decide(now_ns)

    def stop(self, reason: str) -> list[Output]:
        """The last command: to stand still."""
        self.reason = reason
        return [] if self.odometry is None else [self._command(reason)]

    # State.

    def _take_odometry(self, message: Odometry, now_ns: int) -> None:
        if self.odometry is not None and message.stamp_ns <= self.odometry.stamp_ns:
            raise ValidationError(
                f"odometry: found the stamp {message.stamp_ns}, needed one after {self.odometry.stamp_ns}."
            )
        self.odometry, self._arrived_ns = message, now_ns
        self._track.append(message)
        while not self.arrived:
            x, y = self._goals[self._goal]
            if math.hypot(x - message.position_m[0], y - message.position_m[1]) >= self._limits.goal_radius:
                break
            self._goal += 1

    def _take_image(self, message: Image) -> None:
        if message.stamp_ns <= self._image_seen:
            raise ValidationError(f"image: found the stamp {message.stamp_ns}, needed one after {self._image_seen}.")
        self._image_seen = message.stamp_ns
        before = self._image_bytes
        same = before is not None and np.array_equal(before, message.pixels)
        # A camera that hangs may repeat its last image with new stamps; only a robot that stands sees the same twice.
        self._repeats = same and (self._repeats or self._moved(message.stamp_ns))
        if not same:
            self._image_bytes = message.pixels
            self._track = collections.deque((o for o in self._track if o.stamp_ns >= message.stamp_ns), _MAX_TRACK)
        if self._repeats or self._contract.size is None:
            return
        fovy = self._contract.robot.camera_fovy
        self._image = fit_image(message.pixels, message.fovy_rad, self._contract.size, fovy)
        self._image_stamp = message.stamp_ns

    def _moved(self, until_ns: int) -> bool:
        """Whether the robot has moved between the first image like the newest one and a stamp."""
        poses = [odometry for odometry in self._track if odometry.stamp_ns <= until_ns]
        if not poses:
            return False
        first, yaw = poses[0].position_m, yaw_of(poses[0].orientation_wxyz)
        return any(
            math.hypot(o.position_m[0] - first[0], o.position_m[1] - first[1]) > _MIN_MOTION
            or abs(math.remainder(yaw_of(o.orientation_wxyz) - yaw, math.tau)) > _MIN_MOTION
            for o in poses
        )

    @property
    def _recovering(self) -> bool:
        """Whether less than `Limits.recovery` seconds of odometry without a fault have come since the last fault."""
        if self._good_stamp is None or self.odometry is None:
            return self._stopped
        return self.odometry.stamp_ns - self._good_stamp < self._limits.recovery * 1e9

    @property
    def _sees(self) -> bool:
        return IMAGE in self._contract.observations

    def fault(self, now_ns: int, bad: bool = False) -> str:
        """What is wrong; "" if nothing is.

        Args:
          now_ns: this machine's clock.
          bad: whether the message that has just arrived was refused.
        """
        limits, odometry = self._limits, self.odometry
        if self._lost:
            return LOST
        if bad:
            return "bad message"
        if odometry is None:
            return "no odometry"
        if now_ns - self._arrived_ns > limits.odometry_age * 1e9:
            return "stale odometry"
        if tilt_of(odometry.orientation_wxyz) > limits.max_tilt:
            return "tilt"
        if math.hypot(*odometry.velocity_mps) > 1.25 * self._max_speed + 0.2:
            return "overspeed"
        return self._policy_fault(now_ns, odometry)

    def _policy_fault(self, now_ns: int, odometry: Odometry) -> str:
        limits = self._limits
        if self._sees and self._image is None:
            return "no image"
        if self._sees and odometry.stamp_ns - self._image_stamp > limits.image_age * 1e9:
            return "stale image"
        if self._asked is not None and now_ns - self._asked[1] > limits.answer_time * 1e9:
            return "policy late"
        if self._action_stamp is None:
            return "no action"
        if odometry.stamp_ns - self._action_stamp > self._contract.period_ns + limits.answer_time * 1e9:
            return "no action"
        return ""

    # Outputs.

    def _ask(self, now_ns: int) -> list[Output]:
        """The next request: an action at the policy's rate, otherwise whether the process is alive."""
        odometry = self.odometry
        assert odometry is not None
        if self._asked is not None or self._lost:
            return []
        inputs, fault = None, self.fault(now_ns)
        due = self._begin or odometry.stamp_ns >= self._due_stamp
        if due and fault in ("", "no action") and not (self.arrived or self._recovering):
            period = self._contract.period_ns
            self._due_stamp += period
            if self._begin or self._due_stamp <= odometry.stamp_ns:
                self._due_stamp = odometry.stamp_ns + period
            last = np.zeros(2, np.float32) if self._begin else self._action
            inputs = self._contract.inputs(odometry, self._goals[self._goal], last, self._image)
        self._requests += 1
        request = Request(self._requests, inputs, inputs is not None and self._begin)
        if inputs is not None:
            self._begin = False
        self._asked = (request, now_ns, odometry.stamp_ns)
        return [request]

    def _decide(self, now_ns: int, bad: bool = False, always: bool = False) -> list[Output]:
        """The command in the present state.

        Args:
          bad: whether the message that has just arrived was refused.
          always: whether to send a command even if the reason is as before.
        """
        fault = self.fault(now_ns, bad)
        if fault and fault not in _STARTING:
            self._stopped, self._good_stamp = True, None
            self._begin, self._action_stamp = True, None
        elif self._stopped and self._good_stamp is None and self.odometry is not None:
            self._good_stamp = self.odometry.stamp_ns
        if self.arrived and fault in ("", "no action"):
            reason = ARRIVED
        elif self._recovering and fault in ("", "no action"):
            reason = "recovering"
        elif fault:
            reason = fault
        else:
            reason = DRIVING
        changed, self.reason = reason != self.reason, reason
        if reason == DRIVING:
            self._stopped = False
            self._named.clear()
        elif fault and fault not in self._named and fault not in _STARTING:
            self._named.add(fault)
            self.faults[fault] = self.faults.get(fault, 0) + 1
        if self.odometry is None or not (changed or always):
            return []
        return [self._command(reason)]

    def _command(self, reason: str) -> Command:
        assert self.odometry is not None
        speed, turn = self._contract.velocity(self._action) if reason == DRIVING else (0.0, 0.0)
        share = min(1.0, self._max_speed / max(speed, 1e-9), self._max_turn / max(abs(turn), 1e-9))
        expires = self.odometry.stamp_ns + round(self._limits.odometry_age * 1e9)
        if self._sees and self._image_stamp >= 0:
            expires = min(expires, self._image_stamp + round(self._limits.image_age * 1e9))
        self._commands += 1
        return Command(self._session, self._commands, share * speed, share * turn, max(expires, 0), reason)
