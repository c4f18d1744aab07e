"""Warp functions that find what a ray meets in a still street with one robot in it.

Everything stands in tables of 16-byte rows, read with one load each. A street is a search tree over its objects, each
of which leads on into the tree of its mesh: one loop walks both, nearest first. Nothing is copied per world but the
poses of the robot's parts, which are met after the street, if a ray passes near them at all.
"""

# Kernels are Warp's language in Python's clothes; Warp itself checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

from typing import Any

import warp as wp
from mujoco_warp._src.ray import ray_box, ray_capsule, ray_cylinder, ray_ellipsoid, ray_sphere

from .street_native import BUILD_OPTIONS, any_hit, load, load_int, nearest

wp.set_module_options({"enable_backward": False, "extra_build_options": BUILD_OPTIONS})

# mujoco.mjtGeom
SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 2, 3, 4, 5, 6, 7
#: Rows of a triangle: first corner and whether it is the last of its leaf, then both edges from that corner.
TRIANGLE = 3
#: Rows of a thing (an object or a part of the robot): three of T_thing_world, colour and the root of its tree, then
#: texture, texels along its longer side, roughness and metalness.
THING = 5
#: Rows of a part of the robot: centre and radius of the ball around it in its frame; half sizes and kind of a
#: primitive; reflectance and emission.
PART = 3
#: Rows of a face: normal and a scalar each of three corners, then the UV of the second and third corner.
FACE = 4
#: Rows of a camera: eye, right and up as far as the picture reaches, back.
CAMERA = 4
#: Rows of a scene's light: coefficients of 1, x, y, z, xx, yy, xy, yz, xz of the normal, and one scalar each.
LIGHT = 9
#: Ray origins of shadows stand off the surface by this, m (as in MuJoCo Warp).
OFFSET = 1.0e-4


@wp.struct
class Hit:
    """Nearest surface; thing: row number, -1 = none; face: row number, -1 = no mesh; u, v: of the later corners."""

    distance: float
    thing: int
    face: int
    u: float
    v: float
    normal: wp.vec3


@wp.struct
class Street:
    """Where the tables of rows stand that all worlds share; num_objects: things before the first part of the robot."""

    nodes: wp.uint64
    triangles: wp.uint64
    faces: wp.uint64
    things: wp.uint64
    lights: wp.uint64
    parts: wp.uint64
    num_objects: int
    num_parts: int


@wp.struct
class Views:
    """Where the tables stand that are filled anew for each frame, one world after the other.

    cameras: 4 rows a world; poses: 3 rows of T_part_world a part; balls: P + 1, around the parts and around all of
    them; seen: P + 2, how many meshes and primitives are in view, and which.
    """

    cameras: wp.uint64
    poses: wp.uint64
    balls: wp.uint64
    seen: wp.uint64


@wp.func
def xyz(row: wp.vec4) -> wp.vec3:
    return wp.vec3(row[0], row[1], row[2])


@wp.func
def misses_ball(origin: wp.vec3, direction: wp.vec3, ball: wp.vec4) -> bool:
    """Whether a ray passes by a ball (centre, radius) or leads away from it."""
    to_centre = xyz(ball) - origin
    along = wp.dot(to_centre, direction)
    square = wp.length_sq(to_centre)
    inside = ball[3] * ball[3]
    return square - along * along > inside or (along < 0.0 and square > inside)


def _make_primitive(kinds: frozenset[int]) -> Any:
    """The ray against a primitive of one of the `kinds` in its own frame: (distance or -1, normal)."""

    @wp.func
    def primitive(kind: int, size: wp.vec3, origin: wp.vec3, direction: wp.vec3) -> tuple[float, wp.vec3]:
        distance = float(-1.0)  # noqa: UP018 (Warp takes a bare number for a constant)
        normal = wp.vec3(0.0)
        here = wp.vec3(0.0)
        straight = wp.identity(n=3, dtype=float)
        if wp.static(SPHERE in kinds):
            if kind == wp.static(SPHERE):
                distance, normal = ray_sphere(here, size[0] * size[0], origin, direction)
        if wp.static(CAPSULE in kinds):
            if kind == wp.static(CAPSULE):
                distance, normal = ray_capsule(here, straight, size, origin, direction)
        if wp.static(ELLIPSOID in kinds):
            if kind == wp.static(ELLIPSOID):
                distance, normal = ray_ellipsoid(here, straight, size, origin, direction)
        if wp.static(CYLINDER in kinds):
            if kind == wp.static(CYLINDER):
                distance, normal = ray_cylinder(here, straight, size, origin, direction)
        if wp.static(BOX in kinds):
            if kind == wp.static(BOX):
                distance, _sides, normal = ray_box(here, straight, size, origin, direction)
        return distance, normal

    return primitive


def make_trace(meshes: int, kinds: tuple[int, ...], shadow: bool) -> Any:
    """What a ray meets: trace(street, views, root, world, origin, direction, limit) -> Hit.

    Args:
      meshes: parts of the robot that are meshes; they come before those that are primitives.
      kinds: mujoco.mjtGeom of each part that is a primitive.
      shadow: any surface will do; else the nearest.
    """
    primitive, parts = _make_primitive(frozenset(kinds)), meshes + len(kinds)
    find = any_hit if shadow else nearest

    @wp.func
    def trace(
        street: Street, views: Views, root: int, world: int, origin: wp.vec3, direction: wp.vec3, limit: float
    ) -> Hit:
        first_pose = world * wp.static(3 * parts)
        first_ball = world * wp.static(parts + 1)
        first_seen = world * wp.static(parts + 2)
        meshes_met = int(0)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
        primitives_met = int(0)  # noqa: RUF046, UP018
        if wp.static(parts > 0):
            if wp.static(shadow):
                if not misses_ball(origin, direction, load(views.balls, first_ball + wp.static(parts))):
                    meshes_met = wp.static(meshes)
                    primitives_met = wp.static(len(kinds))
            else:
                meshes_met = load_int(views.seen, first_seen)
                primitives_met = load_int(views.seen, first_seen + 1)
        listed = views.seen + wp.uint64(4 * (first_seen + 2))
        found = find(
            street.nodes,
            street.triangles,
            street.things,
            views.poses,
            views.balls,
            listed,
            street.num_objects,
            first_pose,
            first_ball,
            meshes_met,
            root,
            origin,
            direction,
            limit,
        )
        best = Hit()
        best.thing = found[0]
        best.face = found[1]
        best.distance = wp.cast(found[2], wp.float32)
        best.u = wp.cast(found[3], wp.float32)
        best.v = wp.cast(found[4], wp.float32)
        if wp.static(len(kinds) > 0):
            for k in range(primitives_met):
                part = wp.static(meshes) + k
                if wp.static(not shadow):
                    part = load_int(views.seen, first_seen + wp.static(2 + meshes) + k)
                if not misses_ball(origin, direction, load(views.balls, first_ball + part)):
                    x = load(views.poses, first_pose + 3 * part)
                    y = load(views.poses, first_pose + 3 * part + 1)
                    z = load(views.poses, first_pose + 3 * part + 2)
                    o = wp.vec3(wp.dot(xyz(x), origin), wp.dot(xyz(y), origin), wp.dot(xyz(z), origin))
                    d = wp.vec3(wp.dot(xyz(x), direction), wp.dot(xyz(y), direction), wp.dot(xyz(z), direction))
                    shape = load(street.parts, PART * part + 1)
                    t, normal = primitive(int(shape[3]), xyz(shape), o + wp.vec3(x[3], y[3], z[3]), d)
                    if t >= 0.0 and t < best.distance and wp.dot(d, normal) < 0.0:
                        best.thing = street.num_objects + part
                        best.face = -1
                        best.distance = t
                        best.normal = normal
        return best

    return trace


@wp.func
def _put(table: wp.array[wp.vec4], row: int, v: wp.vec3, last: float):
    table[row] = wp.vec4(v[0], v[1], v[2], last)


@wp.kernel
def place(
    street: Street,
    shapes: wp.array[wp.vec4],
    body: wp.array[int],
    meshes: int,
    xpos: wp.array2d[wp.vec3],
    xquat: wp.array2d[wp.vec4],
    eye: wp.array[wp.vec3],
    quaternion: wp.array[wp.vec4],
    fovy: wp.array[float],
    aspect: float,
    hidden: float,
    cameras: wp.array[wp.vec4],
    poses: wp.array[wp.vec4],
    balls: wp.array[wp.vec4],
    seen: wp.array[int],
):
    """Fills the tables of `Views`; dim worlds.

    shapes: (3 P,) rows of T_body_part; `hidden`: height of a robot whose state blew up.
    """
    w = wp.tid()
    origin = eye[w]
    q = quaternion[w]
    turn = wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))
    if not (wp.isfinite(origin) and wp.isfinite(q)):
        origin = wp.vec3(0.0, 0.0, hidden)
        turn = wp.identity(n=3, dtype=float)
    up = wp.tan(0.5 * fovy[w])
    right = up * aspect
    _put(cameras, 4 * w, origin, up)
    _put(cameras, 4 * w + 1, right * wp.vec3(turn[0, 0], turn[1, 0], turn[2, 0]), 0.0)
    _put(cameras, 4 * w + 2, up * wp.vec3(turn[0, 1], turn[1, 1], turn[2, 1]), 0.0)
    _put(cameras, 4 * w + 3, wp.vec3(turn[0, 2], turn[1, 2], turn[2, 2]), 0.0)
    number = street.num_parts
    centre = wp.vec3(0.0)
    seen_meshes = int(0)  # noqa: RUF046, UP018
    seen_primitives = int(0)  # noqa: RUF046, UP018
    # Lengths of the normals of the picture's side planes.
    slant_x = wp.sqrt(1.0 + right * right)
    slant_y = wp.sqrt(1.0 + up * up)
    for i in range(number):
        p = xquat[w, body[i]]
        place = xpos[w, body[i]]
        frame = wp.quat_to_matrix(wp.quat(p[1], p[2], p[3], p[0]))
        # A state that blew up: the robot goes where nobody looks.
        if not (wp.isfinite(place) and wp.isfinite(p)):
            place = wp.vec3(0.0, 0.0, hidden)
            frame = wp.identity(n=3, dtype=float)
        for row in range(3):
            shape = shapes[3 * i + row]
            across = frame @ xyz(shape)
            _put(poses, 3 * (w * number + i) + row, across, shape[3] - wp.dot(across, place))
        ball = load(street.parts, PART * i)
        middle = place + frame @ xyz(ball)
        _put(balls, w * (number + 1) + i, middle, ball[3])
        centre += middle / float(number)
        local = (middle - origin) @ turn
        x = (wp.abs(local[0]) + local[2] * right) / slant_x
        y = (wp.abs(local[1]) + local[2] * up) / slant_y
        if x < ball[3] and y < ball[3] and local[2] < ball[3]:
            if i < meshes:
                seen[w * (number + 2) + 2 + seen_meshes] = i
                seen_meshes += 1
            else:
                seen[w * (number + 2) + 2 + meshes + seen_primitives] = i
                seen_primitives += 1
    seen[w * (number + 2)] = seen_meshes
    seen[w * (number + 2) + 1] = seen_primitives
    radius = float(0.0)  # noqa: UP018
    for i in range(number):
        b = balls[w * (number + 1) + i]
        radius = wp.max(radius, wp.length(xyz(b) - centre) + b[3])
    _put(balls, w * (number + 1) + number, centre, radius)


def module_options() -> dict[str, object]:
    """What a kernel that inlines these functions is built with."""
    return {"enable_backward": False, "fast_math": True, "extra_build_options": BUILD_OPTIONS}
