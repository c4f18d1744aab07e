"""Replays a log: the same events give the same decisions and the same actions, to the bit, or the first difference is
told."""

import hashlib
import itertools
import pathlib
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from .controller import Controller, Limits, Output, Request
from .log import read_log, record_of
from .loop import versions
from .policy_process import answer, load


class _Replay:
    def __init__(self, path: pathlib.Path, policy: pathlib.Path | None) -> None:
        self._records = read_log(path)
        begin, _ = next(self._records, ({}, b""))
        if begin.get("event") != "begin":
            raise ValidationError(f"{path}: found a log without a beginning, needed one of `urbanverse deploy --log`.")
        file = pathlib.Path(begin["policy"]) if policy is None else policy
        self._agent, contract = load(file)
        if hashlib.sha256(file.read_bytes()).hexdigest() != begin["sha256"]:
            raise ValidationError(f"{file}: found another policy than that of {path}, needed the same file.")
        goals = tuple((float(x), float(y)) for x, y in begin["goals"])
        self._controller = Controller(contract, goals, Limits(**begin["limits"]), begin["session"])
        self._asked: dict[int, Request] = {}
        #: Decisions of this replay that are not yet compared.
        self._decided: list[tuple[dict[str, Any], bytes]] = []
        self.versions = begin["versions"]
        self.counts = {"messages": 0, "actions": 0, "commands": 0}
        self.difference: str | None = None

    def run(self) -> None:
        for number, (fields, blob) in enumerate(self._records, 1):
            event = fields["event"]
            if event in ("request", "command"):
                self.counts["commands"] += event == "command"
                mine = self._decided.pop(0) if self._decided else ({}, b"")
                found = "" if mine == (fields, blob) else f"{_shown(*mine)}, needed {_shown(fields, blob)}"
            else:
                missed = self._decided[:1]
                found = f"{_shown(*missed[0])}, needed nothing" if missed else self._event(event, fields, blob)
            if found:
                self.difference = f"record {number}: found {found}"
                return

    def _event(self, event: str, fields: dict[str, Any], blob: bytes) -> str:
        """Gives an event to the controller; returns how the policy's answer differs, "" if it does not."""
        controller, now = self._controller, fields.get("t_ns", 0)
        if event == "message":
            self.counts["messages"] += 1
            ends = np.cumsum([0, *fields["sizes"]])
            self._take(controller.message([blob[a:b] for a, b in itertools.pairwise(ends)], now))
        elif event == "answer":
            shape = fields["shape"]
            action = None if shape is None else np.frombuffer(blob, np.float32).reshape(shape)
            request = self._asked.pop(fields["number"], None)
            mine = None if request is None else answer(self._agent, request)
            if action is not None:
                self.counts["actions"] += 1
                if mine is None or np.asarray(mine, np.float32).tobytes() != blob:
                    return f"the action {None if mine is None else mine.tolist()}, needed {action.tolist()}"
            self._take(controller.answer(fields["number"], action, now))
        elif event == "lost":
            self._take(controller.lost(fields["what"], now))
        elif event == "lapse":
            self._take(controller.lapse(now))
        else:
            self._take(controller.stop(fields["reason"]))
        return ""

    def _take(self, outputs: list[Output]) -> None:
        self._asked |= {o.number: o for o in outputs if isinstance(o, Request)}
        self._decided = [record_of(o) for o in outputs]


def _shown(fields: dict[str, Any], blob: bytes) -> str:
    return "no decision" if not fields else f"{fields['event']} {blob.decode() or fields}"


def replay(path: pathlib.Path, policy: pathlib.Path | None = None) -> dict[str, Any]:
    """Replays a log of `drive`.

    Args:
      policy: its ONNX file, if it is no longer where it was.

    Returns:
      identical: whether every request, action and command was the same to the bit; difference: the first one that was
      not, or None; messages, actions, commands: numbers of those compared; versions_differ: packages that computed the
      log in another version.

    Raises:
      ValidationError: the file is no log or is damaged, or the policy is another one.
    """
    done = _Replay(path, policy)
    done.run()
    mine = versions()
    return {
        "identical": done.difference is None,
        "difference": done.difference,
        **done.counts,
        "versions_differ": sorted(k for k in mine if mine[k] != done.versions.get(k)),
    }
