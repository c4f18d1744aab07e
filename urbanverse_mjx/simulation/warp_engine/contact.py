"""Contacts of spheres with convex hulls in Warp, written to the arrays of MuJoCo Warp's solver.

The rules are those of `hull_contact`: the face plane farthest out holds the nearest point if the foot of the sphere's
centre on it lies in the body; else the nearest point is on an edge. Every world has places for contacts of its own, so
that no world can take another's.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them. Numbers that
# change in a loop are declared by the name of their type.
# ruff: noqa: UP018
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from .mujoco_warp_private import ContactType, make_frame, vec5

#: m, tolerance of the test whether the projection of a point lies on a face (float32 over tens of metres).
_FOOT_TOLERANCE = wp.constant(1e-5)
#: m; within this distance of an edge the direction is undefined, and the face's normal is used.
_ON_EDGE = wp.constant(1e-6)
_ACTIVE = wp.constant(int(ContactType.CONSTRAINT))
#: Torsional and rolling friction, MuJoCo's defaults; no contact here uses them.
_TORSION, _ROLLING = wp.constant(0.005), wp.constant(0.0001)

wp.set_module_options({"enable_backward": False, "fast_math": False})


@wp.struct
class Hulls:
    """T hulls: planes[plane_start[t] : plane_start[t + 1]] (unit normal, offset), edges alike (start, way), boxes."""

    plane_start: wp.array[int]
    normal: wp.array[wp.vec3]
    offset: wp.array[float]
    edge_start: wp.array[int]
    start: wp.array[wp.vec3]
    edge: wp.array[wp.vec3]
    centre: wp.array[wp.vec3]
    half: wp.array[wp.vec3]


@wp.struct
class Spheres:
    """S collision spheres; see `physics_model.SphereTable`."""

    geom: wp.array[int]
    radius: wp.array[float]
    friction: wp.array[float]
    own_friction: wp.array[int]
    slippery: wp.array[int]
    solref: wp.array[wp.vec2]
    solimp: wp.array[vec5]


@wp.struct
class Slots:
    """C hulls near each of n worlds; hull (n, C): row of the table, -1 = empty; owner (n, C): object, -1 = ground;
    geom (n, C): the geom that stands for it in contacts.

    friction_scale (n,): factor on the friction of each contact of a world; least: 1 where the smaller coefficient of
    two surfaces counts.
    """

    hull: wp.array2d[int]
    owner: wp.array2d[int]
    geom: wp.array2d[int]
    position: wp.array2d[wp.vec3]
    rotation: wp.array2d[wp.mat33]
    friction: wp.array2d[float]
    friction_scale: wp.array[float]
    least: int


@wp.struct
class Places:
    """Where contacts go: `Data.contact`'s arrays (n * M,), M = room per world; count (n,); slot (n * M,)."""

    count: wp.array[int]
    room: int
    slot: wp.array[int]
    type: wp.array[int]
    dim: wp.array[int]
    geom: wp.array[wp.vec2i]
    dist: wp.array[float]
    pos: wp.array[wp.vec3]
    frame: wp.array[wp.mat33]
    friction: wp.array[vec5]
    solref: wp.array[wp.vec2]
    solimp: wp.array[vec5]
    address: wp.array2d[int]


@wp.func
def outside_box(point: wp.vec3, centre: wp.vec3, half: wp.vec3) -> float:
    """m from a point to a box in the box's own frame; 0 inside, far for what is no point."""
    if not wp.isfinite(wp.dot(point, point)):
        return 1.0e30
    out = wp.vec3(
        wp.max(wp.abs(point[0] - centre[0]) - half[0], 0.0),
        wp.max(wp.abs(point[1] - centre[1]) - half[1], 0.0),
        wp.max(wp.abs(point[2] - centre[2]) - half[2], 0.0),
    )
    return wp.length(out)


@wp.func
def hull_distance(hulls: Hulls, hull: int, point: wp.vec3, limit: float) -> wp.vec4:
    """Direction (3) and distance (m) from the hull to a point in its frame; beyond `limit` a lower bound will do."""
    first, last = hulls.plane_start[hull], hulls.plane_start[hull + 1]
    distance = float(-1.0e30)
    face = int(first)
    for p in range(first, last):
        height = wp.dot(hulls.normal[p], point) - hulls.offset[p]
        if height > distance:
            distance = height
            face = p
    normal = hulls.normal[face]
    if distance > 0.0 and distance < limit:
        foot = point - distance * normal
        outside = float(0.0)
        for p in range(first, last):
            outside = wp.max(outside, wp.dot(hulls.normal[p], foot) - hulls.offset[p])
        if outside > _FOOT_TOLERANCE:
            nearest = float(1.0e30)
            direction = wp.vec3(0.0, 0.0, 0.0)
            for e in range(hulls.edge_start[hull], hulls.edge_start[hull + 1]):
                # Differences before squares, because ground prisms are tens of metres long.
                offset, edge = point - hulls.start[e], hulls.edge[e]
                away = offset - wp.clamp(wp.dot(offset, edge) / wp.dot(edge, edge), 0.0, 1.0) * edge
                square = wp.dot(away, away)
                if square < nearest:
                    nearest = square
                    direction = away
            distance = wp.sqrt(nearest)
            if distance > _ON_EDGE:
                normal = direction / distance
    return wp.vec4(normal[0], normal[1], normal[2], distance)


@wp.func
def both_surfaces(least: int, own: float, other: float) -> float:
    """See `static_slots.both_surfaces`."""
    return wp.where(least != 0, wp.min(own, other), wp.max(own, other))


@wp.func
def slide(friction: float) -> vec5:
    """The friction of a contact that slides with so much of it."""
    return vec5(friction, friction, _TORSION, _ROLLING, _ROLLING)


@wp.func
def write_contact(
    places: Places, k: int, c: int, geom: int, other: int, distance: float, position: wp.vec3, inward: wp.vec3
):
    """Place k: a contact of two geoms, the second in slot c (-1: in none)."""
    places.slot[k] = c
    places.type[k] = _ACTIVE
    places.geom[k] = wp.vec2i(geom, other)
    places.dist[k] = distance
    places.pos[k] = position
    # MuJoCo's normal points from the first geom to the second.
    places.frame[k] = make_frame(inward)
    for i in range(places.address.shape[1]):
        places.address[k, i] = -1


@wp.func
def put_contact(
    spheres: Spheres,
    slots: Slots,
    places: Places,
    w: int,
    s: int,
    c: int,
    distance: float,
    point: wp.vec3,
    inward: wp.vec3,
):
    """A contact of sphere s with what stands in slot c, if world w has a place left; all are counted."""
    number = wp.atomic_add(places.count, w, 1)
    if number < places.room:
        k = w * places.room + number
        write_contact(places, k, c, spheres.geom[s], slots.geom[w, c], distance, point, inward)
        friction = float(spheres.friction[s])
        if spheres.own_friction[s] == 0:
            friction = both_surfaces(slots.least, friction, slots.friction[w, c])
        friction *= slots.friction_scale[w]
        places.dim[k] = 3 - 2 * spheres.slippery[s]
        places.friction[k] = slide(friction)
        places.solref[k] = spheres.solref[s]
        places.solimp[k] = spheres.solimp[s]


@wp.kernel
def find_contacts(hulls: Hulls, spheres: Spheres, slots: Slots, geom_xpos: wp.array2d[wp.vec3], places: Places):
    """Writes the contacts of all pairs; dim (n, C)."""
    w, c = wp.tid()
    hull = slots.hull[w, c]
    if hull < 0:
        return
    position, rotation = slots.position[w, c], slots.rotation[w, c]
    middle, half = hulls.centre[hull], hulls.half[hull]
    for s in range(spheres.geom.shape[0]):
        radius = spheres.radius[s]
        centre = geom_xpos[w, spheres.geom[s]]
        local = wp.transpose(rotation) @ (centre - position)
        if outside_box(local, middle, half) < radius:
            found = hull_distance(hulls, hull, local, radius)
            distance = found[3] - radius
            if distance < 0.0:
                inward = rotation @ wp.vec3(-found[0], -found[1], -found[2])
                point = centre + inward * (radius + 0.5 * distance)
                put_contact(spheres, slots, places, w, s, c, distance, point, inward)
