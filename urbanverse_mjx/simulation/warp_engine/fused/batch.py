"""A batch of worlds whose control step is three launches: slots found, slots placed, all physics steps."""

from collections.abc import Sequence
from typing import Any

import warp as wp

from ....datatypes import AgentShapes
from .. import contact, kernels
from ..model import DeviceModel
from . import native
from .kernel import Agents, make_step
from .program import RobotProgram


class FusedBatch:
    """Worlds that are stepped together; the counterpart of `WorldBatch`.

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
        self.robot = wp.array(program.numbers, dtype=float)
        self.step = make_step(program.source)
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
        state = [centre, qpos, qvel, warm, ctrl, friction, mass]
        wp.launch_tiled(
            self.step, dim=[self.number], inputs=[*own, *state, *outputs], block_dim=native.LANES, device=device
        )
