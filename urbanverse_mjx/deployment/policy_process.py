"""The process that runs the policy, and the end of the pipe that asks it.

A policy that hangs or crashes must not hold up the loop that stops the robot, so it runs in a process of its own.
"""

import dataclasses
import multiprocessing
import pathlib
import signal
import time
from typing import Any

import numpy as np

from ..datatypes import ValidationError
from ..policies.onnx_agent import OnnxAgent
from ..process_pool import end_with_parent
from .contract import Contract
from .controller import Request

#: s until a process must have loaded its policy.
_START_TIMEOUT = 120.0


def load(path: pathlib.Path) -> tuple[OnnxAgent, Contract]:
    """A policy and its contract.

    Raises:
      ValidationError: see `OnnxAgent` and `Contract.of`.
    """
    agent = OnnxAgent(path)
    return agent, Contract.of(agent.record, agent.observations, str(path))


def answer(agent: OnnxAgent, request: Request) -> np.ndarray | None:
    """The action (1, 2) for a request, or None without inputs."""
    if request.inputs is None:
        return None
    if request.begin:
        agent.begin(1)
    return agent(request.inputs)


def _serve(pipe: Any, path: pathlib.Path) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    try:
        agent, contract = load(path)
    except ValidationError as error:
        pipe.send(str(error))
        return
    # onnxruntime prepares some kernels in the first call.
    height, width = contract.size or (1, 1)
    shapes = {"pixels/front": (1, height, width, 3), "goal": (1, 2), "proprio": (1, 5)}
    types = {"pixels/front": np.uint8}
    agent({k: np.zeros(shapes[k], types.get(k, np.float32)) for k in contract.observations})
    agent.begin(1)
    pipe.send(contract)
    while True:
        try:
            request = pipe.recv()
        except EOFError:
            return
        began = time.perf_counter()
        action = answer(agent, request)
        pipe.send((request.number, action, time.perf_counter() - began))


@dataclasses.dataclass
class PolicyProcess:
    """A process that runs a policy.

    Attributes:
      contract: of the policy.
      seconds: how long each action took.
    """

    contract: Contract
    seconds: list[float]
    _process: Any
    _pipe: Any

    @staticmethod
    def start(path: pathlib.Path) -> "PolicyProcess":
        """Starts a process, and waits until it has loaded the policy.

        Raises:
          ValidationError: the policy cannot be driven, or the process ended.
        """
        context = multiprocessing.get_context("spawn")
        own, other = context.Pipe()
        process = context.Process(target=_serve, args=(other, path), name="urbanverse-policy", daemon=True)
        process.start()
        other.close()
        try:
            found = (
                own.recv() if own.poll(_START_TIMEOUT) else f"{path}: found no policy loaded in {_START_TIMEOUT:g} s."
            )
        except EOFError:
            found = f"{path}: found that the policy's process ended while it was loading."
        if not isinstance(found, Contract):
            process.kill()
            raise ValidationError(found)
        return PolicyProcess(found, [], process, own)

    @property
    def pid(self) -> int:
        return self._process.pid

    def fileno(self) -> int:
        """For polling; readable when an answer has come or the process has ended."""
        return self._pipe.fileno()

    def ask(self, request: Request) -> None:
        """Sends a request; does nothing if the process has ended."""
        try:
            self._pipe.send(request)
        except OSError:
            pass  # the next `receive` tells

    def receive(self) -> tuple[int, np.ndarray | None] | None:
        """The answer that has come: (number of the request, action).

        Returns:
          None if there is none.

        Raises:
          EOFError: the process has ended.
        """
        try:
            if not self._pipe.poll():
                return None
            number, action, seconds = self._pipe.recv()
        except OSError as error:
            raise EOFError from error
        if action is not None:
            self.seconds.append(seconds)
        return number, action

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.join()
        self._pipe.close()
