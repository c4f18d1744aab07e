"""Right of way at crosswalks: pedestrians wait for a gap, vehicles stop for pedestrians; where there are signals, both
obey them.

In:   the scene's crosswalks, bodies, their headings. Out: which agents wait, and the largest speed of each vehicle.
When: the table once per scene; the rest every crowd step, before `orca`, inside jit.
"""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from ..datatypes import KIND_INDEX
from ..geometry.grids import cell_of
from .bodies import Bodies
from .free_space import CELL, FreeSpace

#: Cells of the free space along a cell of the table.
POOL = 4
#: Phases of a crosswalk: without a signal, or people may begin to cross, may only finish, may not be on it.
UNSIGNALLED, WALK, CLEAR, STOP = range(4)
#: m ahead, distances at which a vehicle looks for a crosswalk.
_LOOKAHEAD_STEPS = np.arange(1.0, 25.0, 1.0, dtype=np.float32)


@dataclasses.dataclass(frozen=True)
class CrossingOptions:
    """Options of the behaviour at crosswalks.

    The clearance time is from the Highway Capacity Manual (2000), the braking is half of AASHTO's 3.4 m/s² for
    emergencies; the other values are chosen manually.

    Attributes:
      decision_distance: m ahead of the crosswalk at which a pedestrian decides.
      clearance_time: s, added to the walker's crossing time: start-up and end clearance.
      stopped_speed: m/s; slower vehicles count as stopped.
      stop_distance: m between a stopped vehicle's front and the crosswalk.
      braking: m/s², deceleration of a vehicle for a pedestrian.
      robot_distance: m from a robot's centre to a crosswalk ahead of it at which it waits to cross: that of a
        pedestrian and half the length of a delivery robot.
    """

    decision_distance: float = 0.8
    clearance_time: float = 3.0
    stopped_speed: float = 0.8
    stop_distance: float = 1.0
    braking: float = 1.7
    robot_distance: float = 1.3


OPTIONS = CrossingOptions()


class Crossings(NamedTuple):
    """Crosswalks of all scenes.

    Attributes:
      number: (Z, X, Y) u8, 0 = none.
      origin: (Z, 2) f32 m.
      width: (Z, 256) f32 m, length of the path across each.
    """

    number: Any
    origin: Any
    width: Any


class Precedence(NamedTuple):
    """Signals and the robot's rights, in one env.

    Attributes:
      phase: (256,) i32, phase of each crosswalk by its number.
      x, y, heading: () m and rad, the robot's pose.
      walks: () bool, whether drivers stop for the robot at crosswalks as for a pedestrian.
    """

    phase: Any
    x: Any
    y: Any
    heading: Any
    walks: Any


def make_crossings(spaces: Sequence[FreeSpace]) -> Crossings:
    """The table of several scenes."""
    numbers, widths = [], []
    for space in spaces:
        mask = space.kind[: space.kind.shape[0] // POOL * POOL : POOL, : space.kind.shape[1] // POOL * POOL : POOL]
        label, count = ndimage.label(mask == KIND_INDEX["crosswalk"], np.ones((3, 3)))
        width = np.zeros(256, np.float32)
        for number, box in enumerate(ndimage.find_objects(label)[:255], start=1):
            # People walk along a crosswalk's longer side; the crossing is at most as long as the diagonal of its box.
            sides = [(s.stop - s.start) * POOL * CELL for s in box]
            width[number] = max(sides)
        numbers.append(np.where(label < 256, label, 0).astype(np.uint8))
        widths.append(width)
        del count
    size = np.max([n.shape for n in numbers], axis=0)
    padded = [np.pad(n, [(0, size[k] - n.shape[k]) for k in (0, 1)]) for n in numbers]
    origin = np.stack([space.origin for space in spaces]).astype(np.float32)
    return Crossings(jnp.asarray(np.stack(padded)), jnp.asarray(origin), jnp.asarray(np.stack(widths)))


def crossing_at(table: Crossings, scene: Any, x: Any, y: Any) -> Any:
    """i32, number of the crosswalk at points (...) m; 0 if there is none."""
    origin, side = table.origin[scene], POOL * CELL
    i = cell_of(x, origin[0], side)
    j = cell_of(y, origin[1], side)
    columns, rows = table.number.shape[1:]
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    number = table.number[scene, jnp.clip(i, 0, columns - 1), jnp.clip(j, 0, rows - 1)]
    return jnp.where(inside, number.astype(jnp.int32), 0)


class Order(NamedTuple):
    """Attributes: wait: (A,) bool, whether a pedestrian waits at the kerb. limit: (A,) m/s, for vehicles; infinite for
    others.
    """

    wait: Any
    limit: Any


def give_way(
    table: Crossings,
    scene: Any,
    bodies: Bodies,
    course: Any,
    speed: Any,
    walks: Any,
    front: Any,
    present: Any,
    rights: Precedence | None = None,
) -> Order:
    """Right of way at crosswalks, for the bodies (A,) of one env.

    A pedestrian at the kerb crosses when every approaching vehicle needs longer to arrive than the crossing takes, or
    has stopped. A vehicle stops before a crosswalk with a pedestrian on or at it, if its braking distance allows. At a
    signal a pedestrian begins only in the phase `WALK`, and vehicles stop until the phase `STOP` as for a pedestrian;
    in that phase they stop for those on the crosswalk, not for those who wait.

    Args:
      course: (A,) rad, direction of each agent's route.
      speed: (A,) m/s, preferred.
      walks: (A,) bool, whether an agent is on foot or on the pavement.
      front: (A,) m, distance from centre to front.
      present: (A,) bool.
      rights: signals and the robot, or None for neither.
    """
    here = crossing_at(table, scene, bodies.x, bodies.y)
    cos, sin = jnp.cos(course), jnp.sin(course)
    ahead = crossing_at(
        table, scene, bodies.x + OPTIONS.decision_distance * cos, bodies.y + OPTIONS.decision_distance * sin
    )
    at_kerb = walks & present & (here == 0) & (ahead > 0)
    on_it = walks & present & (here > 0)
    wanted = jnp.where(on_it, here, jnp.where(at_kerb, ahead, -1))
    # Drivers: the first crosswalk ahead and how far it is from the front.
    drives = ~walks & present
    cos, sin = jnp.cos(bodies.heading), jnp.sin(bodies.heading)
    seen = crossing_at(
        table, scene, bodies.x + _LOOKAHEAD_STEPS[:, None] * cos, bodies.y + _LOOKAHEAD_STEPS[:, None] * sin
    )
    first = jnp.argmax(seen > 0, axis=0)
    coming = jnp.where(drives & (here == 0), jnp.take_along_axis(seen, first[None], axis=0)[0], 0)
    gap = jnp.asarray(_LOOKAHEAD_STEPS)[first] - 1.0 - front
    going = jnp.sqrt(bodies.vx * bodies.vx + bodies.vy * bodies.vy)
    arrives = jnp.maximum(gap, 0.0) / jnp.maximum(going, 0.1)
    needs = table.width[scene, ahead] / jnp.maximum(speed, 0.1) + OPTIONS.clearance_time
    same = coming[:, None] == ahead[None]
    threatened = (
        same & (coming > 0)[:, None] & (arrives[:, None] < needs[None]) & (going > OPTIONS.stopped_speed)[:, None]
    )
    # A vehicle on the crosswalk itself also blocks it.
    threatened |= drives[:, None] & (here > 0)[:, None] & (here[:, None] == ahead[None])
    wait = at_kerb & threatened.any(0)
    busy = ((wanted[None] == coming[:, None]) & (coming > 0)[:, None]).any(1)
    if rights is not None:
        signal = rights.phase[ahead]
        wait |= at_kerb & (signal != UNSIGNALLED) & (signal != WALK)
        phase = rights.phase[coming]
        on_foot = ((here[None] == coming[:, None]) & on_it[None]).any(1)
        lights = (phase == WALK) | (phase == CLEAR)
        busy = jnp.where(phase == STOP, on_foot, busy | lights) | _robot_crosses(table, scene, rights, coming)
        busy &= coming > 0
    stop = busy & (going * going < 2.0 * 2.0 * OPTIONS.braking * jnp.maximum(gap, 0.0))
    limit = jnp.sqrt(2.0 * OPTIONS.braking * jnp.maximum(gap - OPTIONS.stop_distance, 0.0))
    return Order(wait, jnp.where(stop, limit, jnp.inf))


def _robot_crosses(table: Crossings, scene: Any, rights: Precedence, coming: Any) -> Any:
    """(A,) bool, whether vehicles that come to crosswalks (A,) have to stop for the robot: on one, or at a kerb and
    heading to it, there not in the phase `STOP`."""
    x, y = rights.x, rights.y
    here = crossing_at(table, scene, x, y)
    reach = OPTIONS.robot_distance
    ahead = crossing_at(table, scene, x + reach * jnp.cos(rights.heading), y + reach * jnp.sin(rights.heading))
    waits = (here == 0) & (ahead == coming) & (rights.phase[ahead] != STOP)
    return rights.walks & ((here == coming) | waits)
