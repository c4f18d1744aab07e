"""Movable bodies in Warp: implements `body_contact` and writes contacts to the arrays of MuJoCo Warp's solver.

MuJoCo Warp simulates them as free bodies after the robot's, whose frames are their principal axes; the objects that
they represent are data of each world.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them. Numbers that
# change in a loop are declared by the name of their type.
# ruff: noqa: RUF046, UP018
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from ..collision_slots import body_contact, body_slots
from .body_types import Bodies, BodyTable
from .contact import Hulls, Places, Slots, both_surfaces, outside_box, slide, write_contact
from .kernels import Masses, Tables, find_nearest
from .mujoco_warp_private import vec5

_PRISMS, _HULLS = wp.constant(body_slots.PRISMS), wp.constant(body_slots.HULLS)
_FAST = wp.constant(body_slots.MAX_BODY_SPEED)
_GROUND_CONTACTS = wp.constant(body_contact.GROUND_CONTACTS)
_OTHER_CONTACTS = wp.constant(body_contact.OTHER_CONTACTS)
_LIFT, _FIRST_DIRECTION = wp.constant(body_contact.LIFT), wp.constant(body_contact.FIRST_DIRECTION)
_TURN = wp.constant(2.0 * wp.pi / body_contact.GROUND_CONTACTS)
#: MuJoCo's defaults for every geom of a scene.
_SOLREF, _SOLIMP = wp.constant(wp.vec2(0.02, 1.0)), wp.constant(vec5(0.9, 0.95, 0.001, 0.5, 2.0))
#: m, height of a slot without a body over everything; kg and kg m^2 of it.
_NOWHERE, _NOBODY = wp.constant(1.0e3), wp.constant(1.0)

Picks = wp.types.vector(length=max(body_contact.GROUND_CONTACTS, body_contact.OTHER_CONTACTS), dtype=wp.int32)

wp.set_module_options({"enable_backward": False, "fast_math": False})


@wp.func
def multiplied(p: wp.vec4, q: wp.vec4) -> wp.vec4:
    """p q of quaternions wxyz."""
    return wp.vec4(
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@wp.func
def back(q: wp.vec4) -> wp.vec4:
    return wp.vec4(q[0], -q[1], -q[2], -q[3])


@wp.func
def matrix(q: wp.vec4) -> wp.mat33:
    return wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))


@wp.kernel
def begin_bodies(
    row_in: wp.array2d[int],
    object_index: wp.array2d[int],
    state: wp.array3d[float],
    origin: wp.array[wp.vec3],
    table: BodyTable,
    slots: Slots,
    masses: Masses,
    bodies: Bodies,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    warm: wp.array2d[float],
):
    """Reads which objects are awake and how they move; dim (n, W)."""
    w, b = wp.tid()
    row = row_in[w, b]
    bodies.row[w, b] = row
    number = bodies.first_body + b
    q, v = bodies.first_qpos + 7 * b, bodies.first_dof + 6 * b
    hulls = table.hull.shape[1]
    first = bodies.first_slot + b * hulls
    mass = _NOBODY
    inertia = wp.vec3(_NOBODY)
    place = wp.vec3(0.0, 0.0, _NOWHERE + 10.0 * float(b))
    turn = wp.vec4(1.0, 0.0, 0.0, 0.0)
    shape = int(-1)
    if row >= 0:
        shape = table.shape[row]
        mass = table.mass[row]
        inertia = mass * table.inertia[shape]
        place = wp.vec3(state[w, b, 0], state[w, b, 1], state[w, b, 2]) - origin[w]
        own = wp.vec4(state[w, b, 3], state[w, b, 4], state[w, b, 5], state[w, b, 6])
        turn = multiplied(own, table.turn[shape])
    masses.mass[w, number] = mass
    masses.inertia[w, number] = inertia
    masses.subtree[w, number] = mass
    bodies.invweight[w, number] = wp.vec2(1.0 / mass, 1.0)
    frame = wp.transpose(matrix(turn))
    for i in range(3):
        qpos[w, q + i] = place[i]
    for i in range(4):
        qpos[w, q + 3 + i] = turn[i]
    for i in range(3):
        linear = float(0.0)
        push = float(0.0)
        angular = float(0.0)
        twist = float(0.0)
        if row >= 0:
            linear = state[w, b, 7 + i]
            push = state[w, b, 13 + i]
            for k in range(3):
                angular += frame[i, k] * state[w, b, 10 + k]
                twist += frame[i, k] * state[w, b, 16 + k]
        qvel[w, v + i] = linear
        warm[w, v + i] = push
        qvel[w, v + 3 + i] = angular
        warm[w, v + 3 + i] = twist
    for h in range(hulls):
        slots.hull[w, first + h] = -1
        if row >= 0:
            slots.hull[w, first + h] = table.hull[shape, h]
            slots.owner[w, first + h] = object_index[w, b]
            slots.friction[w, first + h] = table.friction[row]


@wp.kernel
def find_near(
    tables: Tables,
    scene: wp.array[int],
    state: wp.array3d[float],
    taken: wp.array2d[int],
    control_dt: float,
    origin: wp.array[wp.vec3],
    table: BodyTable,
    bodies: Bodies,
):
    """The ground prisms (third index 0) and static hulls (1) near each body; dim (n, W, 2)."""
    w, b, group = wp.tid()
    row = bodies.row[w, b]
    first, number = int(0), int(_PRISMS)
    near = tables.prisms
    if group == 1:
        first = int(_PRISMS)
        number = int(_HULLS)
        near = tables.objects
    k = w * bodies.row.shape[1] + b
    if row >= 0:
        place = wp.vec3(state[w, b, 0], state[w, b, 1], state[w, b, 2])
        reach = table.radius[table.shape[row]] + _FAST * control_dt
        find_nearest(
            near, tables, scene[w], place, k, first, number, bodies.near_row, bodies.near_distance, reach, taken, w
        )
    for i in range(first, first + number):
        bodies.near_hull[w, b, i] = -1
        if row >= 0:
            q = bodies.near_row[k, i]
            if q >= 0:
                z = scene[w]
                bodies.near_hull[w, b, i] = near.hull[z, q]
                bodies.near_position[w, b, i] = near.position[z, q] - origin[w]
                bodies.near_rotation[w, b, i] = near.rotation[z, q]
                bodies.near_friction[w, b, i] = near.friction[z, q]


@wp.kernel
def place_bodies(table: BodyTable, xpos: wp.array2d[wp.vec3], xquat: wp.array2d[wp.quat], slots: Slots, bodies: Bodies):
    """Where the objects and their hulls are after a physics step; dim (n, W)."""
    w, b = wp.tid()
    row = bodies.row[w, b]
    if row < 0:
        return
    shape = table.shape[row]
    q = xquat[w, bodies.first_body + b]
    rotation = matrix(multiplied(wp.vec4(q[0], q[1], q[2], q[3]), back(table.turn[shape])))
    position = xpos[w, bodies.first_body + b] - rotation @ table.centre[shape]
    bodies.position[w, b] = position
    bodies.rotation[w, b] = rotation
    first = bodies.first_slot + b * table.hull.shape[1]
    for h in range(table.hull.shape[1]):
        slots.position[w, first + h] = position
        slots.rotation[w, first + h] = rotation


@wp.func
def depth_in(hulls: Hulls, hull: int, local: wp.vec3) -> wp.vec4:
    """Normal (3) of the plane farthest out and how far a point is outside of it, m; 0 for points outside the hull."""
    if outside_box(local, hulls.centre[hull], hulls.half[hull]) > 0.0:
        return wp.vec4(0.0)
    distance = float(-1.0e30)
    face = int(0)
    for p in range(hulls.plane_start[hull], hulls.plane_start[hull + 1]):
        height = wp.dot(hulls.normal[p], local) - hulls.offset[p]
        if height > distance:
            distance = height
            face = p
    if distance >= 0.0:
        return wp.vec4(0.0)
    n = hulls.normal[face]
    return wp.vec4(n[0], n[1], n[2], distance)


@wp.func
def depth_in_ground(hulls: Hulls, hull: int, local: wp.vec3) -> wp.vec4:
    """The same for a prism of the ground, whose top counts where it is near."""
    found = depth_in(hulls, hull, local)
    if found[3] < 0.0:
        top = int(hulls.plane_start[hull])
        for p in range(top, hulls.plane_start[hull + 1]):
            if hulls.normal[p][2] > hulls.normal[top][2]:
                top = p
        n = hulls.normal[top]
        height = wp.dot(n, local) - hulls.offset[top]
        if height > -_LIFT:
            return wp.vec4(n[0], n[1], n[2], height)
    return found


@wp.kernel
def find_depths(table: BodyTable, hulls: Hulls, slots: Slots, bodies: Bodies):
    """How deep each point of each body is in the ground and in anything else; dim (n, W, P)."""
    w, b, p = wp.tid()
    row = bodies.row[w, b]
    ground = wp.vec4(0.0)
    other = wp.vec4(0.0)
    ground_friction = float(0.0)
    other_friction = float(0.0)
    geom = bodies.ground
    if row >= 0:
        shape = table.shape[row]
        place = bodies.position[w, b] + bodies.rotation[w, b] @ (table.centre[shape] + table.points[shape, p])
        bodies.point[w, b, p] = place
        for k in range(_PRISMS):
            hull = bodies.near_hull[w, b, k]
            if hull >= 0:
                found = depth_in_ground(hulls, hull, place - bodies.near_position[w, b, k])
                if found[3] < ground[3]:
                    ground = found
                    ground_friction = bodies.near_friction[w, b, k]
        for k in range(_PRISMS, _PRISMS + _HULLS):
            hull = bodies.near_hull[w, b, k]
            if hull >= 0:
                frame = bodies.near_rotation[w, b, k]
                found = depth_in(hulls, hull, wp.transpose(frame) @ (place - bodies.near_position[w, b, k]))
                if found[3] < other[3]:
                    n = frame @ wp.vec3(found[0], found[1], found[2])
                    other = wp.vec4(n[0], n[1], n[2], found[3])
                    other_friction = bodies.near_friction[w, b, k]
                    geom = bodies.ground
        each = table.hull.shape[1]
        for k in range(bodies.row.shape[1] * each):
            hull = slots.hull[w, bodies.first_slot + k]
            if hull >= 0 and k // each != b:
                frame = bodies.rotation[w, k // each]
                found = depth_in(hulls, hull, wp.transpose(frame) @ (place - bodies.position[w, k // each]))
                if found[3] < other[3]:
                    n = frame @ wp.vec3(found[0], found[1], found[2])
                    other = wp.vec4(n[0], n[1], n[2], found[3])
                    other_friction = slots.friction[w, bodies.first_slot + k]
                    geom = bodies.first_geom + k // each
    bodies.ground_depth[w, b, p] = ground[3]
    bodies.ground_normal[w, b, p] = wp.vec3(ground[0], ground[1], ground[2])
    bodies.ground_friction[w, b, p] = ground_friction
    bodies.other_depth[w, b, p] = other[3]
    bodies.other_normal[w, b, p] = wp.vec3(other[0], other[1], other[2])
    bodies.other_friction[w, b, p] = other_friction
    bodies.other_geom[w, b, p] = geom


@wp.func
def _put(
    places: Places, w: int, geom: int, other: int, distance: float, point: wp.vec3, normal: wp.vec3, friction: float
):
    number = wp.atomic_add(places.count, w, 1)
    if number < places.room:
        k = w * places.room + number
        # No slot: whoever sums the robot's touches leaves it out.
        write_contact(places, k, -1, geom, other, distance, point - 0.5 * distance * normal, -normal)
        places.dim[k] = 3
        places.friction[k] = slide(friction)
        places.solref[k] = _SOLREF
        places.solimp[k] = _SOLIMP


@wp.kernel
def put_contacts(table: BodyTable, xpos: wp.array2d[wp.vec3], bodies: Bodies, places: Places):
    """Writes the outermost points on the ground and the deepest in anything else; dim (n, W)."""
    w, b = wp.tid()
    row = bodies.row[w, b]
    if row < 0:
        return
    number = bodies.point.shape[2]
    geom, friction = bodies.first_geom + b, table.friction[row]
    middle = xpos[w, bodies.first_body + b]
    picks = Picks(-1)
    for k in range(_GROUND_CONTACTS):
        angle = _FIRST_DIRECTION + _TURN * float(k)
        x, y = wp.cos(angle), wp.sin(angle)
        best = int(-1)
        farthest = float(-1.0e30)
        for p in range(number):
            if bodies.ground_depth[w, b, p] < 0.0:
                place = bodies.point[w, b, p] - middle
                out = x * place[0] + y * place[1]
                if out > farthest:
                    farthest = out
                    best = p
        again = int(0)
        for i in range(k):
            if picks[i] == best:
                again = 1
        picks[k] = best
        if best >= 0 and again == 0:
            _put(
                places,
                w,
                geom,
                bodies.ground,
                bodies.ground_depth[w, b, best],
                bodies.point[w, b, best],
                bodies.ground_normal[w, b, best],
                both_surfaces(bodies.least, friction, bodies.ground_friction[w, b, best]),
            )
    picks = Picks(-1)
    for k in range(_OTHER_CONTACTS):
        best = int(-1)
        deepest = float(0.0)
        for p in range(number):
            if bodies.other_depth[w, b, p] < deepest:
                again = int(0)
                for i in range(k):
                    if picks[i] == p:
                        again = 1
                if again == 0:
                    deepest = bodies.other_depth[w, b, p]
                    best = p
        picks[k] = best
        if best >= 0:
            _put(
                places,
                w,
                geom,
                bodies.other_geom[w, b, best],
                deepest,
                bodies.point[w, b, best],
                bodies.other_normal[w, b, best],
                both_surfaces(bodies.least, friction, bodies.other_friction[w, b, best]),
            )


@wp.kernel
def finish_bodies(
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    warm: wp.array2d[float],
    origin: wp.array[wp.vec3],
    table: BodyTable,
    bodies: Bodies,
    state: wp.array3d[float],
):
    """Writes how the bodies are now; dim (n, W)."""
    w, b = wp.tid()
    row = bodies.row[w, b]
    if row < 0:
        for i in range(state.shape[2]):
            state[w, b, i] = 0.0
        state[w, b, 3] = 1.0
        return
    q, v = bodies.first_qpos + 7 * b, bodies.first_dof + 6 * b
    turn = wp.vec4(qpos[w, q + 3], qpos[w, q + 4], qpos[w, q + 5], qpos[w, q + 6])
    own = multiplied(turn, back(table.turn[table.shape[row]]))
    frame = matrix(turn)
    for i in range(3):
        state[w, b, i] = qpos[w, q + i] + origin[w][i]
        state[w, b, 7 + i] = qvel[w, v + i]
        state[w, b, 13 + i] = warm[w, v + i]
        angular = float(0.0)
        twist = float(0.0)
        for k in range(3):
            angular += frame[i, k] * qvel[w, v + 3 + k]
            twist += frame[i, k] * warm[w, v + 3 + k]
        state[w, b, 10 + i] = angular
        state[w, b, 16 + i] = twist
    for i in range(4):
        state[w, b, 3 + i] = own[i]
