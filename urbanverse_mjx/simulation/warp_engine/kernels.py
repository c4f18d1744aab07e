"""Warp kernels around MuJoCo Warp's physics step: slots found and placed, states read and written, touches summed."""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them. Numbers that
# change in a loop are declared by the name of their type.
# ruff: noqa: RUF046, UP018
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from ..collision_slots.agent_slots import FIRST_OWNER
from .contact import Places, Slots, outside_box

_EMPTY = wp.constant(-1)
#: `Slots.owner` of the ground; what is less is an agent, see `agent_slots.FIRST_OWNER`.
_GROUND, _FIRST_AGENT = wp.constant(-1), wp.constant(FIRST_OWNER)

wp.set_module_options({"enable_backward": False, "fast_math": False})


@wp.struct
class Instances:
    """Hulls or ground prisms of all scenes; (Z, Q) each, grid (Z, X, Y, L). See `slots.InstanceTable`."""

    hull: wp.array2d[int]
    owner: wp.array2d[int]
    position: wp.array2d[wp.vec3]
    rotation: wp.array2d[wp.mat33]
    friction: wp.array2d[float]
    box_centre: wp.array2d[wp.vec3]
    box_half: wp.array2d[wp.vec3]
    grid: wp.array4d[int]


@wp.struct
class Tables:
    """The bank's scenes on the device: origin (Z,) m and cell m of the grids; reach m."""

    objects: Instances
    prisms: Instances
    origin: wp.array[wp.vec2]
    cell: float
    reach: float


@wp.struct
class Nearby:
    """What was found near n robots, objects first.

    row (n, C): instance, -1 = empty; distance (n, C) m to its box; missing (n, 2): hulls and prisms within reach that
    found no slot.
    """

    row: wp.array2d[int]
    distance: wp.array2d[float]
    missing: wp.array2d[int]


@wp.struct
class Touch:
    """Touches of n worlds summed over the physics steps of a control step; see `Contacts`. missed: contacts dropped;
    foot (n, F): N, normal forces on the feet; agent, agent_force: the agent that was touched hardest, and how hard.
    """

    force: wp.array[float]
    owner: wp.array[int]
    ground: wp.array[int]
    count: wp.array[int]
    missed: wp.array[int]
    foot: wp.array2d[float]
    agent: wp.array[int]
    agent_force: wp.array[float]


@wp.struct
class Robot:
    """Masses of the robot's B bodies as described; mass (B,) kg, inertia (B,) kg m^2, subtree (B,) kg."""

    mass: wp.array[float]
    inertia: wp.array[wp.vec3]
    subtree: wp.array[float]


@wp.struct
class Masses:
    """The same in each of n worlds, where MuJoCo Warp's model looks for them; (n, B)."""

    mass: wp.array2d[float]
    inertia: wp.array2d[wp.vec3]
    subtree: wp.array2d[float]


@wp.func
def whole_metres(centre: wp.vec3) -> wp.vec3:
    """The place next to the robot about which the physics runs."""
    return wp.vec3(wp.rint(centre[0]), wp.rint(centre[1]), 0.0)


@wp.func
def _cell_number(place: float, origin: float, cell: float, count: int) -> int:
    number = wp.floor((place - origin) / cell)
    if not wp.isfinite(number):
        number = 0.0
    return int(wp.clamp(number, 0.0, float(count - 1)))


@wp.func
def find_nearest(
    table: Instances,
    tables: Tables,
    z: int,
    place: wp.vec3,
    w: int,
    first: int,
    number: int,
    row: wp.array2d[int],
    distance: wp.array2d[float],
    reach: float,
    taken: wp.array2d[int],
    world: int,
) -> int:
    """Fills slots first..first+number of line w, nearest first; returns how many within reach (m) found none.

    taken (n, M): objects that are bodies in each world, whose hulls are left out.
    """
    i = _cell_number(place[0], tables.origin[z][0], tables.cell, table.grid.shape[1])
    j = _cell_number(place[1], tables.origin[z][1], tables.cell, table.grid.shape[2])
    found = int(0)
    for entry in range(table.grid.shape[3]):
        q = table.grid[z, i, j, entry]
        if q < 0:
            break  # a list ends with its first empty entry
        local = wp.transpose(table.rotation[z, q]) @ (place - table.box_centre[z, q])
        d = outside_box(local, wp.vec3(0.0), table.box_half[z, q])
        for m in range(taken.shape[1]):
            if taken[world, m] == table.owner[z, q]:
                d = 1.0e30
        if d <= reach:
            # Insertion from behind; of equals the one listed first stays first.
            k = wp.min(found, number)
            while k > 0 and distance[w, first + k - 1] > d:
                if k < number:
                    row[w, first + k] = row[w, first + k - 1]
                    distance[w, first + k] = distance[w, first + k - 1]
                k -= 1
            if k < number:
                row[w, first + k] = q
                distance[w, first + k] = d
            found += 1
    for k in range(wp.min(found, number), number):
        row[w, first + k] = _EMPTY
    return wp.max(found - number, 0)


@wp.kernel
def find_slots(
    tables: Tables,
    scene: wp.array[int],
    centre: wp.array[wp.vec3],
    num_objects: int,
    num_prisms: int,
    nearby: Nearby,
    taken: wp.array2d[int],
):
    """The hulls (second index 0) and ground prisms (1) nearest to each robot; dim (n, 2)."""
    w, group = wp.tid()
    if group == 0:
        nearby.missing[w, 0] = find_nearest(
            tables.objects,
            tables,
            scene[w],
            centre[w],
            w,
            0,
            num_objects,
            nearby.row,
            nearby.distance,
            tables.reach,
            taken,
            w,
        )
    else:
        nearby.missing[w, 1] = find_nearest(
            tables.prisms,
            tables,
            scene[w],
            centre[w],
            w,
            num_objects,
            num_prisms,
            nearby.row,
            nearby.distance,
            tables.reach,
            taken,
            w,
        )


@wp.kernel
def place_slots(
    tables: Tables, scene: wp.array[int], centre: wp.array[wp.vec3], num_objects: int, nearby: Nearby, slots: Slots
):
    """Puts the hulls that were found into the slots; dim (n, C)."""
    w, slot = wp.tid()
    z, q = scene[w], nearby.row[w, slot]
    if q < 0:
        slots.hull[w, slot] = _EMPTY
        return
    table = tables.prisms
    if slot < num_objects:
        table = tables.objects
    slots.hull[w, slot] = table.hull[z, q]
    slots.owner[w, slot] = table.owner[z, q]
    slots.position[w, slot] = table.position[z, q] - whole_metres(centre[w])
    slots.rotation[w, slot] = table.rotation[z, q]
    slots.friction[w, slot] = table.friction[z, q]


@wp.kernel
def begin(
    centre: wp.array[wp.vec3],
    qpos_in: wp.array2d[float],
    qvel_in: wp.array2d[float],
    warm_in: wp.array2d[float],
    ctrl_in: wp.array2d[float],
    friction_in: wp.array[float],
    mass_in: wp.array[float],
    robot: Robot,
    slots: Slots,
    masses: Masses,
    root: int,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    warm: wp.array2d[float],
    ctrl: wp.array2d[float],
    origin: wp.array[wp.vec3],
    touch: Touch,
    step: wp.array[int],
):
    """Reads the states; qpos[root:root+3] is the robot's place; dim n."""
    w = wp.tid()
    here = whole_metres(centre[w])
    origin[w] = here
    for i in range(qpos_in.shape[1]):
        qpos[w, i] = qpos_in[w, i]
    for k in range(3):
        qpos[w, root + k] = qpos_in[w, root + k] - here[k]
    for i in range(qvel_in.shape[1]):
        qvel[w, i] = qvel_in[w, i]
        warm[w, i] = warm_in[w, i]
    for i in range(ctrl.shape[1]):
        ctrl[w, i] = ctrl_in[w, i]
    slots.friction_scale[w] = friction_in[w]
    for b in range(masses.mass.shape[1]):
        masses.mass[w, b] = robot.mass[b] * mass_in[w]
        masses.inertia[w, b] = robot.inertia[b] * mass_in[w]
        masses.subtree[w, b] = robot.subtree[b] * mass_in[w]
    touch.force[w] = 0.0
    touch.owner[w] = _EMPTY
    touch.ground[w] = 0
    touch.count[w] = 0
    touch.missed[w] = 0
    for f in range(touch.foot.shape[1]):
        touch.foot[w, f] = 0.0
    touch.agent[w] = _EMPTY
    touch.agent_force[w] = 0.0
    step[w] = 0


@wp.kernel
def note(foot_of: wp.array[int], slots: Slots, row_force: wp.array2d[float], places: Places, touch: Touch):
    """Adds the touches of one physics step, robot against object or agent and no foot against the ground, and clears
    the places of the contacts; foot_of: which foot a geom is, -1 = none; dim n."""
    w = wp.tid()
    count = places.count[w]
    touched = int(0)
    strength = float(-1.0)
    strongest = int(_EMPTY)
    for number in range(wp.min(count, places.room)):
        k = w * places.room + number
        places.type[k] = 0
        if places.slot[k] < 0:
            continue  # a body against something else than the robot
        owner = slots.owner[w, places.slot[k]]
        foot = foot_of[places.geom[k][0]]
        force = float(0.0)
        for i in range(wp.max(2 * (places.dim[k] - 1), 1)):
            force += row_force[w, places.address[k, i]]
        if foot >= 0:
            touch.foot[w, foot] += force
        if owner != _GROUND or foot < 0:
            touched = 1
            if owner == _GROUND:
                touch.ground[w] = 1
            if owner <= _FIRST_AGENT and (force > touch.agent_force[w] or touch.agent[w] < 0):
                touch.agent[w] = _FIRST_AGENT - owner
                touch.agent_force[w] = force
            if force > strength:
                strength = force
                strongest = owner
    places.count[w] = 0
    if touched == 1:
        if strength > touch.force[w] or touch.count[w] == 0:
            touch.owner[w] = strongest
        touch.force[w] = wp.max(touch.force[w], strength)
        touch.count[w] += 1
    touch.missed[w] = wp.max(touch.missed[w], count - places.room)


@wp.kernel
def record(
    qpos: wp.array2d[float],
    origin: wp.array[wp.vec3],
    root: int,
    touch: Touch,
    step: wp.array[int],
    seen: wp.array[int],
    path: wp.array3d[float],
    hit: wp.array2d[int],
):
    """Writes where the robot is after a physics step, and whether it touched in it; dim n."""
    w = wp.tid()
    s = step[w]
    if s >= path.shape[1]:
        return
    for i in range(path.shape[2]):
        path[w, s, i] = qpos[w, i]
    for k in range(3):
        path[w, s, root + k] = qpos[w, root + k] + origin[w][k]
    before = int(0)
    if s > 0:
        before = seen[w]
    hit[w, s] = touch.count[w] - before
    seen[w] = touch.count[w]
    step[w] = s + 1


@wp.kernel
def finish(
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    warm: wp.array2d[float],
    xpos: wp.array2d[wp.vec3],
    xquat: wp.array2d[wp.quat],
    origin: wp.array[wp.vec3],
    root: int,
    touch: Touch,
    nearby: Nearby,
    qpos_out: wp.array2d[float],
    qvel_out: wp.array2d[float],
    warm_out: wp.array2d[float],
    xpos_out: wp.array2d[wp.vec3],
    xquat_out: wp.array2d[wp.vec4],
    force_out: wp.array[float],
    touch_out: wp.array2d[int],
    foot_out: wp.array2d[float],
):
    """Writes the new states; touch_out (n, 5): object, ground, physics steps with a touch, overflow, agent; foot_out
    (n, F): N, sums over the physics steps; dim n."""
    w = wp.tid()
    here = origin[w]
    for i in range(qpos_out.shape[1]):
        qpos_out[w, i] = qpos[w, i]
    for k in range(3):
        qpos_out[w, root + k] = qpos[w, root + k] + here[k]
    for i in range(qvel_out.shape[1]):
        qvel_out[w, i] = qvel[w, i]
        warm_out[w, i] = warm[w, i]
    for b in range(xpos_out.shape[1]):
        q = xquat[w, b]
        xquat_out[w, b] = wp.vec4(q[0], q[1], q[2], q[3])
        if b == 0:
            xpos_out[w, b] = xpos[w, b]
        else:
            xpos_out[w, b] = xpos[w, b] + here
    force_out[w] = touch.force[w]
    touch_out[w, 0] = wp.max(touch.owner[w], _EMPTY)
    touch_out[w, 1] = touch.ground[w]
    touch_out[w, 2] = touch.count[w]
    touch_out[w, 4] = touch.agent[w]
    for f in range(touch.foot.shape[1]):
        foot_out[w, f] = touch.foot[w, f]
    touch_out[w, 3] = nearby.missing[w, 0] + nearby.missing[w, 1] + touch.missed[w]
