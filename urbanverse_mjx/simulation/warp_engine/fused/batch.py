"""A batch of worlds whose control step is three launches: slots found, slots placed, all physics steps."""

import concurrent.futures
import functools
import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from ....datatypes import AgentShapes
from ....settings import num_threads
from ...threads import run_all
from .. import contact, kernels
from ..model import DeviceModel
from . import native
from .kernel import Agents, make_step
from .program import RobotProgram

#: Least number of worlds that are worth a thread of their own.
_WORTH_A_THREAD = 8


@functools.cache
def _pool() -> concurrent.futures.ThreadPoolExecutor:
    return concurrent.futures.ThreadPoolExecutor(num_threads(), "physics")


class FusedBatch:
    """Worlds that are stepped together; the counterpart of `WorldBatch`. On a CPU they are divided among threads.

    Args:
      shared: the tables of the bank.
      program: of the robot, for these numbers.
      number: worlds.
      num_objects, num_prisms: slots of either kind.
      agents: shapes of the agents; None = none.
      iterations, line_steps: of the solver.
    """

    def __init__(
        self,
        shared: DeviceModel,
        program: RobotProgram,
        number: int,
        num_objects: int,
        num_prisms: int,
        agents: AgentShapes | None,
        iterations: int,
        line_steps: int,
    ) -> None:
        self.shared, self.number = shared, number
        self.num_objects, self.num_prisms = num_objects, num_prisms
        self.solver = [iterations, line_steps]
        pieces = max(min(num_threads(), number // _WORTH_A_THREAD), 1) if shared.device.is_cpu else 1
        ends = np.linspace(0, number, pieces + 1).astype(int).tolist()
        self.pieces = list(itertools.pairwise(ends))
        self.robot = wp.array(program.numbers, dtype=float)
        self.step = make_step(program.source)
        self.compiled = False
        shape = (number, num_objects + num_prisms)
        self.nearby = kernels.Nearby()
        self.nearby.row, self.nearby.distance = wp.empty(shape, dtype=int), wp.empty(shape, dtype=float)
        self.nearby.missing = wp.empty((number, 2), dtype=int)
        self.slots = contact.Slots()
        self.slots.hull, self.slots.owner = wp.full(shape, -1, dtype=int), wp.full(shape, -1, dtype=int)
        self.slots.position, self.slots.rotation = wp.zeros(shape, dtype=wp.vec3), wp.zeros(shape, dtype=wp.mat33)
        self.slots.friction, self.slots.least = wp.zeros(shape, dtype=float), int(shared.materials)
        self.nothing = wp.zeros((number, 0), dtype=int)
        self.agents = Agents()
        self.has_agents = agents is not None
        if agents is not None:
            self.agents.radius, self.agents.half, self.agents.height = (wp.array(a, dtype=float) for a in agents)

    def control_step(self, inputs: Sequence[wp.array], outputs: Sequence[wp.array], substeps: int) -> None:
        """Reads states, finds slots, runs the physics and writes the new states; see `WarpEngine._run`."""
        scene, centre, qpos, qvel, warm, ctrl, friction, mass, *others = inputs
        device: Any = self.shared.device
        where = [self.shared.tables, scene, centre, self.num_objects]
        find = [*where, self.num_prisms, self.nearby, self.nothing]
        wp.launch(kernels.find_slots, dim=(self.number, 2), inputs=find, device=device)
        place = [*where, self.nearby, self.slots]
        wp.launch(kernels.place_slots, dim=self.slots.hull.shape, inputs=place, device=device)
        agents = self.agents
        if self.has_agents:
            agents.place, agents.turn, agents.velocity, agents.turn_rate, agents.present = others
        own = [self.robot, self.shared.hulls, self.slots, self.nearby, agents, substeps, *self.solver]
        arguments = [*own, centre, qpos, qvel, warm, ctrl, friction, mass, *outputs]
        jobs = [functools.partial(self._advance, first, last, arguments) for first, last in self.pieces]
        # The first launch compiles the kernel, which threads must not do at the same time.
        while jobs and (len(jobs) == 1 or not self.compiled):
            jobs.pop(0)()
            self.compiled = True
        if jobs:
            run_all(_pool(), jobs)

    def _advance(self, first: int, last: int, arguments: list[object]) -> None:
        wp.launch_tiled(
            self.step,
            dim=[last - first],
            inputs=[first, *arguments],
            block_dim=native.LANES,
            device=self.shared.device,
        )
