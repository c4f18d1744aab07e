"""A batch of worlds in MuJoCo Warp: what is theirs alone, and one control step of them."""

import functools
import warnings
from collections.abc import Callable, Sequence

import mujoco_warp as mjw
import numpy as np
import warp as wp

from . import warp_kernels as kernels
from .warp_model import DeviceModel

#: Pairs of a sphere and a slot whose boxes meet, per world; seven is usual among robots that push against something.
#: The worlds share one pool, which also holds all pairs of `_CROWDED` worlds.
_CANDIDATES, _CROWDED = 24, 4
#: Spheres whose centre is inside a hull, per world; they need the dear half of the collision search. One pool, too.
_SUNK = 4


class WorldBatch:
    """Worlds that are stepped together, with MuJoCo Warp's data and the launches of a physics step.

    On the CPU a batch runs on one core: Warp's tile kernels keep their scratch memory in one place per process.

    Args:
      shared: the model and the tables of the bank.
      number: worlds.
      num_contacts: contacts a world can hold.
      recorded: physics steps per control step that are recorded; 0 records none.
      graphs: whether the physics step is captured once and replayed, or launched kernel by kernel every time.
    """

    def __init__(self, shared: DeviceModel, number: int, num_contacts: int, recorded: int, graphs: bool) -> None:
        self.shared, self.number, self.recorded = shared, number, recorded
        slot_model = shared.slot_model
        model, num_slots = slot_model.model, slot_model.num_slots
        pairs = num_slots * (model.ngeom - num_slots)
        pool = min(number * pairs, max(number * _CANDIDATES, _CROWDED * pairs))
        self.model = shared.per_world(number)
        self.data = mjw.make_data(
            model,
            nworld=number,
            naconmax=pool,
            naccdmax=min(pool, max(number * _SUNK, pairs)),
            njmax=4 * num_contacts + int(np.count_nonzero(model.jnt_limited)),
        )
        # Nothing stands anywhere before the first call.
        self.model.geom_dataid.fill_(-1)
        shape = (number, num_slots)
        self.nearby = kernels.Nearby()
        self.nearby.row, self.nearby.owner = wp.empty(shape, dtype=int), wp.full(shape, -1, dtype=int)
        self.nearby.distance, self.nearby.missing = wp.empty(shape, dtype=float), wp.empty((number, 2), dtype=int)
        self.touch = kernels.Touch()
        self.touch.force = wp.zeros(number, dtype=float)
        for name in ("owner", "ground", "count", "missed"):
            setattr(self.touch, name, wp.zeros(number, dtype=int))
        self.origin = wp.zeros(number, dtype=wp.vec3)
        self.step_number, self.seen = wp.zeros(number, dtype=int), wp.zeros(number, dtype=int)
        self.path = wp.zeros((number, recorded, model.nq), dtype=float)
        self.hit = wp.zeros((number, recorded), dtype=int)
        self._substep, self._kinematics = self._physics_step, self._place_bodies
        if graphs:
            self._substep, self._kinematics = _captured(self._physics_step), _captured(self._place_bodies)

    @property
    def is_captured(self) -> bool:
        """Whether the physics step is a graph that is replayed."""
        return self._substep != self._physics_step

    def control_step(self, inputs: Sequence[wp.array], outputs: Sequence[wp.array], substeps: int) -> None:
        """Reads states, finds and places slots, runs the physics and writes the new states; see `WarpEngine._run`."""
        scene, centre, qpos, qvel, warm, ctrl = inputs
        slot_model, tables, data, model = self.shared.slot_model, self.shared.tables, self.data, self.model
        n, num_objects = self.number, slot_model.num_objects
        launch = functools.partial(wp.launch, device=self.shared.device)
        found = [tables, scene, centre, num_objects, slot_model.num_prisms, self.nearby]
        launch(kernels.find_slots, dim=(n, 2), inputs=found)
        geoms = [data.geom_xpos, data.geom_xmat]
        geoms += [model.geom_dataid, model.geom_size, model.geom_aabb, model.geom_rbound, model.geom_friction]
        launch(
            kernels.place_slots,
            dim=(n, slot_model.num_slots),
            inputs=[tables, scene, centre, num_objects, self.nearby, *geoms],
        )
        state = [data.qpos, data.qvel, data.qacc_warmstart, data.ctrl]
        here = [slot_model.root, *state, data.overflow, self.origin, self.touch, self.step_number]
        launch(kernels.begin, dim=n, inputs=[centre, qpos, qvel, warm, ctrl, *here])
        for _ in range(substeps):
            self._substep()
        self._kinematics()
        after = [*state[:3], data.xpos, data.xquat, data.overflow, self.origin, slot_model.root]
        launch(kernels.finish, dim=n, inputs=[*after, self.touch, self.nearby], outputs=list(outputs[:7]))
        if self.recorded:
            wp.copy(outputs[7], self.path)
            wp.copy(outputs[8], self.hit)

    def _physics_step(self) -> None:
        data, slot_model = self.data, self.shared.slot_model
        mjw.step(self.model, data)
        rows = [data.nefc, data.efc.type, data.efc.id, data.efc.force]
        contacts = [data.contact.efc_address, data.contact.dim, data.contact.geom]
        wp.launch(
            kernels.note,
            dim=self.number,
            inputs=[data.njmax, self.shared.is_foot, *rows, *contacts, self.nearby.owner, self.touch],
        )
        if self.recorded:
            wp.launch(
                kernels.record,
                dim=self.number,
                inputs=[
                    data.qpos,
                    self.origin,
                    slot_model.root,
                    self.touch,
                    self.step_number,
                    self.seen,
                    self.path,
                    self.hit,
                ],
            )

    def _place_bodies(self) -> None:
        mjw.kinematics(self.model, self.data)


def _captured(launches: Callable[[], None]) -> Callable[[], None]:
    """Records what `launches` launches, to be replayed without Python; `launches` itself where that is not possible."""
    # Kernels are compiled and loaded at their first launch, which a capture does not allow.
    launches()
    try:
        with wp.ScopedCapture() as capture:
            launches()
    except RuntimeError as error:
        warnings.warn(f"found no graph capture ({error}); physics steps are launched one by one, slowly", stacklevel=2)
        return launches
    graph = capture.graph
    return launches if graph is None else functools.partial(wp.capture_launch, graph)
