"""Teleoperation: converts inputs of a person to commands, and handles taking over from a policy and returning control.

In:   messages of browsers (`Inputs`): held keys, the gamepad's axes and buttons. Out:  a `Command` for every control
step, or None while the policy drives. When: messages come from the socket's thread, commands are requested by the
page's loop; no clock is read here.
"""

import collections
import dataclasses
import json
import threading
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..datatypes import validation as v

#: s after which a browser's last message expires and the robot is stopped. Including one control step of 0.2 s it stops
#: within 0.3 s; browsers send 40 messages a second.
MESSAGE_LIFETIME = 0.1
#: Share of a stick's range around its centre that is ignored, see `without_dead_zone`.
DEAD_ZONE = 0.15
#: Factor of the command while Shift is held.
SLOW_FACTOR = 0.5
#: Number of events for the median latency.
_LATENCIES = 50
#: Names of keys by their place on the keyboard (`KeyboardEvent.code`) -> share of full (speed, turn to the left).
DRIVE_KEYS = {
    "KeyW": (1.0, 0.0),
    "ArrowUp": (1.0, 0.0),
    "KeyS": (-1.0, 0.0),
    "ArrowDown": (-1.0, 0.0),
    "KeyA": (0.0, 1.0),
    "ArrowLeft": (0.0, 1.0),
    "KeyD": (0.0, -1.0),
    "ArrowRight": (0.0, -1.0),
}
SLOW_KEYS = ("ShiftLeft", "ShiftRight")
#: Key, and button of a gamepad with the standard layout (A, or a cross), that take over and give back.
SWITCH_KEY, SWITCH_BUTTON = "KeyT", 0
#: Axes of the left stick: to the right, backwards.
_STICK = (0, 1)
_MAX_MESSAGE = 4096


class Command(NamedTuple):
    """Shares of the robot's full speed, in [0, 1], and of its full turn to the left, in [-1, 1]."""

    speed: float
    turn: float


STOP = Command(0.0, 0.0)


@dataclasses.dataclass(frozen=True)
class Inputs:
    """Inputs held by a person at one time.

    Attributes:
      keys: held, by `KeyboardEvent.code`.
      axes, buttons: of the gamepad; empty where there is none.
      age: s from the event that this message reports to its sending; None where it only repeats what is held.
    """

    keys: frozenset[str] = frozenset()
    axes: tuple[float, ...] = ()
    buttons: tuple[bool, ...] = ()
    age: float | None = None

    @staticmethod
    def parse(message: str | bytes) -> "Inputs":
        """Reads a browser's message: {"keys": [..], "axes": [..], "buttons": [..], "age": ms or null}.

        Raises:
          ValidationError: something else.
        """
        if len(message) > _MAX_MESSAGE:
            raise v.fail("message", f"{len(message)} bytes", f"at most {_MAX_MESSAGE}")
        try:
            body = json.loads(message)
        except ValueError as error:
            raise v.fail("message", "no JSON", "an object") from error
        if not isinstance(body, Mapping):
            raise v.fail("message", v.show(body), "an object")
        axes = [
            v.number(x, "message.axes", minimum=-1.0, maximum=1.0) for x in v.items(body.get("axes"), "message.axes")
        ]
        age = body.get("age")
        return Inputs(
            frozenset(v.text(key, "message.keys") for key in v.items(body.get("keys"), "message.keys")),
            tuple(axes),
            tuple(bool(x) for x in v.items(body.get("buttons"), "message.buttons")),
            None if age is None else 1e-3 * v.number(age, "message.age", minimum=0.0),
        )

    @property
    def moves(self) -> bool:
        """Returns whether a driving key is held, or the stick is outside its dead zone."""
        return not self.keys.isdisjoint(DRIVE_KEYS) or any(self._stick())

    @property
    def switch(self) -> bool:
        """Whether the key or button that takes over and gives back is held."""
        return SWITCH_KEY in self.keys or (len(self.buttons) > SWITCH_BUTTON and self.buttons[SWITCH_BUTTON])

    def command(self) -> Command:
        """Returns the command of keys and stick together. No robot drives backwards; the backward key cancels the
        forward key."""
        # Two keys of the same direction are one.
        held = {DRIVE_KEYS[key] for key in self.keys if key in DRIVE_KEYS}
        right, back = self._stick()
        speed, turn = sum(s for s, _ in held) - back, sum(t for _, t in held) - right
        factor = 1.0 if self.keys.isdisjoint(SLOW_KEYS) else SLOW_FACTOR
        return Command(factor * min(max(speed, 0.0), 1.0), factor * min(max(turn, -1.0), 1.0))

    def _stick(self) -> tuple[float, float]:
        if len(self.axes) <= max(_STICK):
            return 0.0, 0.0
        return without_dead_zone(self.axes[_STICK[0]], self.axes[_STICK[1]])


def without_dead_zone(x: float, y: float, zone: float = DEAD_ZONE) -> tuple[float, float]:
    """A stick's place in [-1, 1] each; 0 within the zone around the centre, from whose edge on it grows steadily to 1.

    An axis of its own has a zone too, so that a stick that is pushed ahead by hand drives straight.
    """

    def scaled(value: float) -> float:
        beyond = max(0.0, (min(abs(value), 1.0) - zone) / (1.0 - zone))
        return beyond if value > 0.0 else -beyond if beyond else 0.0

    return scaled(x), scaled(y)


@dataclasses.dataclass
class _Browser:
    """One connected browser: its last message and when it came."""

    inputs: Inputs
    received: float


def _forget_keys(browser: _Browser) -> None:
    """Lets driving keys that are still held in a browser's next message count as newly pressed."""
    others = browser.inputs.keys - DRIVE_KEYS.keys()
    browser.inputs = dataclasses.replace(browser.inputs, keys=others)


class Teleop:
    """Decides whether the policy or a person at one of the browsers drives.

    A newly pressed key that drives, or the switch (T, or A on a gamepad), takes over. The switch gives back, and so do
    some seconds without input; where a page hung for so long, a key that is held when it answers again takes over. A
    stick alone does not take over: it may be off centre. One browser drives at a time.

    Args:
      give_back_after: s without input after which the policy drives again; 0 = only by the switch.
    """

    def __init__(self, give_back_after: float = 2.0) -> None:
        self.give_back_after = give_back_after
        self._lock = threading.Lock()
        self._browsers: dict[int, _Browser] = {}
        self._owner: int | None = None
        self._moved = -np.inf
        self._tapped: set[str] = set()
        self._events: list[float] = []
        self._commanded: list[float] = []
        self._latencies: collections.deque[float] = collections.deque(maxlen=_LATENCIES)

    def receive(self, browser: int, inputs: Inputs, now: float, delay: float = 0.0) -> None:
        """Takes a browser's message.

        Args:
          browser: its number.
          inputs: the message.
          now: s, a steady clock.
          delay: s that the message was under way.
        """
        with self._lock:
            before = self._browsers[browser].inputs if browser in self._browsers else Inputs()
            self._browsers[browser] = _Browser(inputs, now)
            pressed = inputs.keys - before.keys
            switched = inputs.switch and not before.switch
            if self._owner is None and (switched or not pressed.isdisjoint(DRIVE_KEYS)):
                self._owner, self._moved = browser, now
                self._tapped, self._events, self._commanded = set(), [], []
            elif self._owner == browser and switched:
                self._owner = None
            if self._owner != browser:
                return
            if inputs.moves:
                self._moved = now
            self._tapped |= pressed & DRIVE_KEYS.keys()
            if inputs.age is not None:
                self._events.append(now - inputs.age - delay)

    def leave(self, browser: int) -> None:
        """Removes a browser whose connection has ended; if it drove, the robot stops."""
        with self._lock:
            self._browsers.pop(browser, None)

    def give_back(self) -> None:
        """Lets the policy drive."""
        with self._lock:
            self._owner = None

    def begin_episode(self, held_keys: bool = False) -> None:
        """Lets the policy drive another episode, whose latency is measured anew.

        Args:
          held_keys: a driving key that is still held from before takes over with its browser's next message.
        """
        with self._lock:
            self._owner = None
            self._tapped, self._events, self._commanded = set(), [], []
            self._latencies.clear()
            if held_keys:
                for browser in self._browsers.values():
                    _forget_keys(browser)

    @property
    def held(self) -> bool:
        """Whether a person drives."""
        return self._owner is not None

    @property
    def ignores_key(self) -> bool:
        """Whether the policy drives and a driving key is held: it was pressed before the policy took over, and takes
        over only when it is released and pressed again."""
        with self._lock:
            held = (browser.inputs.keys for browser in self._browsers.values())
            return self._owner is None and not all(keys.isdisjoint(DRIVE_KEYS) for keys in held)

    def command(self, now: float) -> Command | None:
        """Returns the person's command for the next step, or None while the policy drives.

        A key that was pressed and released since the last call counts once more: steps are longer than taps.
        """
        with self._lock:
            if self._owner is None:
                return None
            browser = self._browsers.get(self._owner)
            fresh = browser is not None and now - browser.received <= MESSAGE_LIFETIME
            if fresh and browser is not None and browser.inputs.moves:
                self._moved = now
            if self.give_back_after and now - self._moved > self.give_back_after:
                self._owner = None
                if browser is not None:
                    # Only of a browser that sent nothing is a key held still: it hung, and the person drives on.
                    _forget_keys(browser)
                return None
            tapped, self._tapped = self._tapped, set()
            self._commanded, self._events = self._commanded + self._events, []
            if not fresh or browser is None:
                return STOP
            return dataclasses.replace(browser.inputs, keys=browser.inputs.keys | tapped).command()

    def forget(self) -> None:
        """Excludes earlier inputs from the latency, for example after compilation."""
        with self._lock:
            self._events, self._commanded = [], []

    def applied(self, now: float) -> None:
        """Notes that the last `command` has reached the robot."""
        with self._lock:
            self._latencies.extend(max(0.0, now - event) for event in self._commanded)
            self._commanded = []

    @property
    def latency(self) -> float | None:
        """s from a key's or gamepad's event to the end of the step with it: median of the last 50; None without any."""
        with self._lock:
            return float(np.median(self._latencies)) if self._latencies else None


def interventions(by_hand: Sequence[bool] | np.ndarray) -> int:
    """Returns how often a person took over in an episode; by_hand: (T,) whether a person drove each step."""
    flags = np.asarray(by_hand, bool)
    return int((flags & ~np.concatenate([[False], flags[:-1]])).sum())


def status(teleop: Teleop, by_hand: np.ndarray, dt: float) -> dict[str, Any]:
    """Returns a page's status of an episode: interventions, their seconds, and the latency in ms (None without any)."""
    latency = teleop.latency
    return {
        "interventions": interventions(by_hand),
        "seconds": round(float(np.sum(by_hand)) * dt, 1),
        "latency": None if latency is None else round(1e3 * latency),
    }
