"""Warp functions for the first hit of a ray in a static street with one robot in it.

All data are in tables of 16-byte rows, read with one load each. A street is a search tree over its objects, each of
which leads on into the tree of its mesh: one loop traverses both, nearest first. Only the poses of the robot's parts
are copied per world; these are tested after the street, if a ray passes near them.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

from typing import Any

import warp as wp

from .street_native import BUILD_OPTIONS, Hit, as_hit, load, make_walks

wp.set_module_options({"enable_backward": False, "extra_build_options": BUILD_OPTIONS})

#: Rows of an object (one of the street or a part of the robot): three of T_object_world, colour, then texture, texels
#: along its longer side, roughness and metalness.
OBJECT = 5
#: Rows of an entry, to which the leaves of a street's tree lead: three of T_object_world, then the reference at which a
#: ray begins in the trees of the meshes, and `LEAF` + the object. Each object has one for its whole mesh, which has the
#: object's number; those of parts of large objects follow.
ENTRY = 4
#: Rows of a part of the robot: centre and radius of the ball around it in its frame; reflectance and emission.
PART = 2
#: Rows of a face: normal and a scalar each of three corners, then the UV of the second and third corner.
FACE = 4
#: Rows of a camera: position, right and up as far as the image reaches, back.
CAMERA = 4
#: Rows of a scene's light: coefficients of 1, x, y, z, xx, yy, xy, yz, xz of the normal, and one scalar each.
LIGHT = 9
#: Ray origins of shadows stand off the surface by this, m (as in MuJoCo Warp).
OFFSET = 1.0e-4


@wp.func
def factors(appearance_seed: int, obj: int, share: float) -> wp.vec3:
    """How much brighter each channel of an object (-1: of the light) is in an appearance than as described; seed 0: not
    at all.

    The three share a factor within 1 +- share, and have their own within 1 +- share / 2.
    """
    if appearance_seed == 0:
        return wp.vec3(1.0)
    state = wp.rand_init(appearance_seed, obj + 1)
    whole = 1.0 + share * (2.0 * wp.randf(state) - 1.0)
    red = 1.0 + share * (wp.randf(state) - 0.5)
    green = 1.0 + share * (wp.randf(state) - 0.5)
    blue = 1.0 + share * (wp.randf(state) - 0.5)
    return wp.vec3(whole * red, whole * green, whole * blue)


@wp.struct
class Street:
    """Where the tables of rows stand that all worlds share; num_objects: objects before the first part of the robot;
    balls: around each of them in its frame; num_bodies: the last parts, which are objects of the street that moved.

    sheets, texels, cells: baked light, see `street_light`; num_shades: moving bodies that shade what is around them.
    """

    nodes: wp.uint64
    triangles: wp.uint64
    faces: wp.uint64
    object_rows: wp.uint64
    entries: wp.uint64
    lights: wp.uint64
    parts: wp.uint64
    balls: wp.uint64
    sheets: wp.uint64
    texels: wp.uint64
    cells: wp.uint64
    num_objects: int
    num_parts: int
    num_bodies: int
    num_shades: int


@wp.struct
class Views:
    """Where the tables stand that are filled anew for each frame, one world after the other.

    cameras: 4 rows a world; poses: 3 rows of T_part_world a part; balls: P + 1, around the parts and around all of
    them; seen: P + 1, how many parts are in view, and which; moved: the object that each body is, -1 = none; shades: 3
    rows of T_unit_world a shade; shaded: S + 1, how many shades are near, and which.
    """

    cameras: wp.uint64
    poses: wp.uint64
    balls: wp.uint64
    seen: wp.uint64
    moved: wp.uint64
    shades: wp.uint64
    shaded: wp.uint64


@wp.func
def xyz(row: wp.vec4) -> wp.vec3:
    return wp.vec3(row[0], row[1], row[2])


@wp.func_native("""
    return reinterpret_cast<const int*>(table)[index];
""")
def number_at(table: wp.uint64, index: int) -> int:
    """An entry of a table of whole numbers."""


def make_rays(moved: bool) -> tuple[Any, Any]:
    """`nearest_hit` and `is_hidden`; moved: objects of the street may have moved."""
    nearest, any_hit = make_walks(moved)

    @wp.func
    def nearest_hit(
        street: Street, views: Views, root: int, world: int, origin: wp.vec3, direction: wp.vec3, limit: float
    ) -> Hit:
        """First hit of a ray with the street below `root` and with the robot's parts in the camera's view."""
        first = world * (street.num_parts + 1)
        found = nearest(
            street.nodes,
            street.triangles,
            street.entries,
            views.poses + wp.uint64(48 * world * street.num_parts),
            views.balls + wp.uint64(16 * first),
            views.seen + wp.uint64(4 * first),
            views.moved + wp.uint64(4 * world * street.num_bodies),
            street.num_objects,
            street.num_parts - street.num_bodies,
            street.num_bodies,
            root,
            origin,
            direction,
            limit,
        )
        return as_hit(found)

    @wp.func
    def is_hidden(street: Street, views: Views, root: int, world: int, origin: wp.vec3, direction: wp.vec3) -> bool:
        """Whether anything of the street below `root` or any part of the robot hides the far end of a ray."""
        return any_hit(
            street.nodes,
            street.triangles,
            street.entries,
            views.poses + wp.uint64(48 * world * street.num_parts),
            views.balls + wp.uint64(16 * world * (street.num_parts + 1)),
            views.moved + wp.uint64(4 * world * street.num_bodies),
            street.num_objects,
            street.num_parts - street.num_bodies,
            street.num_bodies,
            street.num_parts,
            root,
            origin,
            direction,
        )

    return nearest_hit, is_hidden


@wp.func
def object_of(street: Street, views: Views, world: int, obj: int) -> int:
    """The object that a ray met, where a part may be a moved object of the street."""
    body = obj - street.num_objects - street.num_parts + street.num_bodies
    if body < 0:
        return obj
    return number_at(views.moved, world * street.num_bodies + body)


@wp.func
def _put(table: wp.array[wp.vec4], row: int, v: wp.vec3, last: float):
    table[row] = wp.vec4(v[0], v[1], v[2], last)


@wp.kernel
def place(
    street: Street,
    shapes: wp.array[wp.vec4],
    body: wp.array[int],
    xpos: wp.array2d[wp.vec3],
    xquat: wp.array2d[wp.vec4],
    camera_position: wp.array[wp.vec3],
    quaternion: wp.array[wp.vec4],
    fovy: wp.array[float],
    aspect: float,
    hidden: float,
    cameras: wp.array[wp.vec4],
    poses: wp.array[wp.vec4],
    balls: wp.array[wp.vec4],
    seen: wp.array[int],
    scene: wp.array[int],
    slot: wp.array2d[int],
    object_of_slot: wp.array2d[int],
    moved: wp.array[int],
    all_around: int,
):
    """Fills the tables of `Views`; dim worlds.

    shapes: (3 P,) rows of T_body_part; `hidden`: height of a robot whose state is not finite; slot (worlds, bodies):
    moved objects, -1 = none, whose objects are object_of_slot (Z, N); all_around: 1 where rays lead to all sides.
    """
    w = wp.tid()
    origin = camera_position[w]
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
    in_view = int(0)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
    # Lengths of the normals of the image's side planes.
    slant_x = wp.sqrt(1.0 + right * right)
    slant_y = wp.sqrt(1.0 + up * up)
    for i in range(number):
        p = xquat[w, body[i]]
        place = xpos[w, body[i]]
        frame = wp.quat_to_matrix(wp.quat(p[1], p[2], p[3], p[0]))
        # A state that is not finite: the robot is drawn far outside the view.
        if not (wp.isfinite(place) and wp.isfinite(p)):
            place = wp.vec3(0.0, 0.0, hidden)
            frame = wp.identity(n=3, dtype=float)
        for row in range(3):
            shape = shapes[3 * i + row]
            across = frame @ xyz(shape)
            _put(poses, 3 * (w * number + i) + row, across, shape[3] - wp.dot(across, place))
        ball = load(street.parts, PART * i)
        k = i - number + street.num_bodies
        absent = int(0)  # noqa: RUF046, UP018
        if k >= 0:
            obj = int(-1)  # noqa: RUF046, UP018
            if slot[w, k] >= 0:
                obj = object_of_slot[scene[w], slot[w, k]]
            moved[w * street.num_bodies + k] = obj
            if obj >= 0:
                ball = load(street.balls, obj)
            else:
                # It is out of view, and does not enlarge the bounding sphere of all parts.
                absent = 1
                place = xyz(balls[w * (number + 1)])
        middle = place + frame @ xyz(ball)
        _put(balls, w * (number + 1) + i, middle, ball[3])
        centre += middle / float(number)
        local = (middle - origin) @ turn
        x = (wp.abs(local[0]) + local[2] * right) / slant_x
        y = (wp.abs(local[1]) + local[2] * up) / slant_y
        if (all_around == 1 or (x < ball[3] and y < ball[3] and local[2] < ball[3])) and absent == 0:
            in_view += 1
            seen[w * (number + 1) + in_view] = i
    seen[w * (number + 1)] = in_view
    radius = float(0.0)  # noqa: UP018
    for i in range(number):
        b = balls[w * (number + 1) + i]
        radius = wp.max(radius, wp.length(xyz(b) - centre) + b[3])
    _put(balls, w * (number + 1) + number, centre, radius)


def module_options() -> dict[str, object]:
    """Build options of a kernel that inlines these functions."""
    return {"enable_backward": False, "fast_math": True, "extra_build_options": BUILD_OPTIONS}
