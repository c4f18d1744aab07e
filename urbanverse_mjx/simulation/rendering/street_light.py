"""Baked light of static streets: lookups of the tables that `light_bake` makes, and the shade of what moves.

The ground has a map of texels over x and y with the unhidden share of the sun and of the sky. Everything else reads a
coarse grid in space: the unhidden share of the sun, and of the light around as a function of the normal. Robots, agents
and moved objects are ellipsoids that hide the sun and the sky of surfaces near them.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false
# pyright: reportInvalidTypeForm=false

import warp as wp

from . import street_kernels as k
from .street_kernels import Street, Views
from .street_light_native import SHEET

#: Rows of a shade: three of T_unit_world, where the unit ball stands for the ellipsoid.
SHADE = 3
#: m from the camera within which moving bodies shade what is around them.
REACH = 25.0


@wp.func_native("""
    float sun, sky;
    urbanverse::ground_light(sheet, texels, x, y, sun, sky);
    return wp::vec_t<2, wp::float32>(sun, sky);
""")
def ground_light(sheet: wp.uint64, texels: wp.uint64, x: float, y: float) -> wp.vec2:
    """Unhidden shares of sun and sky of the ground at (x, y)."""


@wp.func_native("""
    float sun, sky;
    urbanverse::space_light(
        sheet, cells, point[0], point[1], point[2], normal[0], normal[1], normal[2], sun, sky);
    return wp::vec_t<2, wp::float32>(sun, sky);
""")
def space_light(sheet: wp.uint64, cells: wp.uint64, point: wp.vec3, normal: wp.vec3) -> wp.vec2:
    """Unhidden shares of sun and sky of a surface at a place."""


@wp.func
def exposure(street: Street, scene: int) -> float:
    """Factor on all light of a scene."""
    row = k.load(street.sheets, SHEET * scene)
    return row[2]


@wp.func
def baked_light(street: Street, scene: int, point: wp.vec3, normal: wp.vec3, on_ground: bool) -> wp.vec2:
    """Unhidden shares of sun and sky of a surface."""
    sheet = street.sheets + wp.uint64(16 * SHEET * scene)
    if on_ground:
        return ground_light(sheet, street.texels, point[0], point[1])
    return space_light(sheet, street.cells, point, normal)


@wp.func
def moving_shade(street: Street, views: Views, world: int, point: wp.vec3, sun: wp.vec3) -> wp.vec2:
    """Shares of sun and sky that what moves leaves to a surface."""
    first = world * (street.num_shades + 1)
    count = k.number_at(views.shaded, first)
    left = wp.vec2(1.0, 1.0)
    for i in range(count):
        row = SHADE * (world * street.num_shades + k.number_at(views.shaded, first + 1 + i))
        x = k.load(views.shades, row)
        y = k.load(views.shades, row + 1)
        z = k.load(views.shades, row + 2)
        # In the frame in which the ellipsoid is a unit ball.
        at = wp.vec3(
            x[0] * point[0] + x[1] * point[1] + x[2] * point[2] + x[3],
            y[0] * point[0] + y[1] * point[1] + y[2] * point[2] + y[3],
            z[0] * point[0] + z[1] * point[1] + z[2] * point[2] + z[3],
        )
        square = wp.dot(at, at)
        toward = wp.vec3(wp.dot(k.xyz(x), sun), wp.dot(k.xyz(y), sun), wp.dot(k.xyz(z), sun))
        along = -wp.dot(at, toward) / wp.dot(toward, toward)
        passing = square + wp.max(along, 0.0) * wp.dot(at, toward)
        # Full shade within 0.7 of the outline, none from 1.2 on.
        hidden = wp.clamp((1.44 - passing) * wp.static(1.0 / (1.44 - 0.49)), 0.0, 1.0)
        near = wp.clamp((3.6 - square) * wp.static(1.0 / 2.6), 0.0, 1.0)
        left[0] = left[0] * (1.0 - hidden)
        left[1] = left[1] * (1.0 - 0.75 * near * near)
    return left


@wp.kernel(module="unique", module_options=k.module_options(), enable_backward=False)
def place_shades(
    street: Street,
    views: Views,
    body: wp.array[int],
    boxes: wp.array2d[wp.vec3],
    object_boxes: wp.array2d[wp.vec3],
    xpos: wp.array2d[wp.vec3],
    xquat: wp.array2d[wp.vec4],
    camera_position: wp.array[wp.vec3],
    shades: wp.array[wp.vec4],
    shaded: wp.array[int],
):
    """Fills `Views.shades` and `Views.shaded`; dim worlds.

    body (S,), boxes (S, 2): whose frame each shade stands in, and centre and half size of its box there; the last of
    them are moved objects, whose boxes are object_boxes (objects, 2).
    """
    w = wp.tid()
    number = street.num_shades
    first = w * (number + 1)
    count = int(0)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
    for i in range(number):
        place = xpos[w, body[i]]
        q = xquat[w, body[i]]
        centre = boxes[i, 0]
        half = boxes[i, 1]
        known = wp.isfinite(place) and wp.isfinite(q)
        moved = i - number + street.num_bodies
        if moved >= 0:
            obj = k.number_at(views.moved, w * street.num_bodies + moved)
            if obj >= 0:
                centre = object_boxes[obj, 0]
                half = object_boxes[obj, 1]
            else:
                known = False
        if known and wp.length_sq(place - camera_position[w]) < wp.static(REACH * REACH):
            turn = wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))
            for a in range(3):
                axis = wp.vec3(turn[0, a], turn[1, a], turn[2, a]) / half[a]
                last = -wp.dot(axis, place) - centre[a] / half[a]
                shades[SHADE * (w * number + i) + a] = wp.vec4(axis[0], axis[1], axis[2], last)
            count += 1
            shaded[first + count] = i
    shaded[first] = count
