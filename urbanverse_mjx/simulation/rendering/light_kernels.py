"""The rays that bake the light of streets; see `light_bake`."""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from . import street_kernels as k
from .street_kernels import Street, Views
from .street_light_native import CELL, TEXEL

#: m, from which on nothing hides the sky, because streets lit by it are as bright.
RANGE = 8.0
#: Light that comes from a surface at distance 0, as a share of the sky's; it grows to 1 at `RANGE`.
DARKEST = 0.1
#: Rays of a texel towards the sky, in other directions for each of 4 x 4 texels; rays around a cell.
SKY_RAYS, PATTERN, AROUND_RAYS = 16, 4, 48
#: Rays over the ground stand off by this, m: paint and joints between regions cast no shadow.
_STAND_OFF = 0.02
#: Surfaces above the ground that a ray down may meet before it.
_LAYERS = 256
#: Rays down begin so high, m.
_TOP = 400.0

_nearest_hit, _is_hidden = k.make_rays(False)


@wp.func
def _from_surface(distance: float) -> float:
    """Light of a surface at a distance, as a share of the sky's."""
    return DARKEST + (1.0 - DARKEST) * wp.min(distance * wp.static(1.0 / RANGE), 1.0)


@wp.kernel(module="unique", module_options=k.module_options(), enable_backward=False)
def bake_ground(
    first: int,
    street: Street,
    views: Views,
    root: int,
    is_ground: wp.array[int],
    origin: wp.vec2,
    width: int,
    sun: wp.vec3,
    suns: wp.array[wp.vec3],
    sky: wp.array[wp.vec3],
    light: wp.array2d[float],
):
    """dim texels; light (texels, 3): shares of sun and sky, and the ground's height, -1e6 where there is none."""
    i = first + wp.tid()
    column = i // width
    row = i % width
    x = origin[0] + (float(column) + 0.5) * TEXEL
    y = origin[1] + (float(row) + 0.5) * TEXEL
    light[i, 0] = 1.0
    light[i, 1] = 1.0
    light[i, 2] = -1.0e6
    down = wp.vec3(0.0, 0.0, -1.0)
    height = float(_TOP)
    on_ground = int(0)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
    for _layer in range(_LAYERS):
        hit = _nearest_hit(street, views, root, 0, wp.vec3(x, y, height), down, 2.0 * _TOP)
        if hit.object_row < 0:
            break
        height -= hit.distance
        if is_ground[hit.object_row] != 0:
            on_ground = 1
            break
        height -= 1.0e-3
    if on_ground == 0:
        return
    light[i, 2] = height
    if sun[2] > 0.0:
        total = float(0.0)  # noqa: UP018
        for s in range(4):
            corner = wp.vec3(
                x + (float(s % 2) - 0.5) * (0.5 * TEXEL), y + (float(s // 2) - 0.5) * (0.5 * TEXEL), height + _STAND_OFF
            )
            if not _is_hidden(street, views, root, 0, corner, suns[s]):
                total += 0.25
        light[i, 0] = total
    start = ((column % PATTERN) * PATTERN + row % PATTERN) * SKY_RAYS
    open = float(0.0)  # noqa: UP018
    for s in range(SKY_RAYS):
        hit = _nearest_hit(street, views, root, 0, wp.vec3(x, y, height + _STAND_OFF), sky[start + s], RANGE)
        if hit.object_row < 0:
            open += 1.0
        else:
            open += _from_surface(hit.distance)
    light[i, 1] = open * wp.static(1.0 / SKY_RAYS)


@wp.kernel(module="unique", module_options=k.module_options(), enable_backward=False)
def bake_grid(
    first: int,
    street: Street,
    views: Views,
    root: int,
    is_ground: wp.array[int],
    ground: wp.array3d[float],
    ground_origin: wp.vec2,
    sunlit: float,
    origin: wp.vec3,
    wide: int,
    deep: int,
    sun: wp.vec3,
    suns: wp.array[wp.vec3],
    around: wp.array[wp.vec3],
    light: wp.array2d[float],
):
    """dim cells; ground (X, Y, 3) of `bake_ground`; sunlit: the sun's share of the light of open ground; light
    (cells, 5): sun, mean and gradient (3) of the light around."""
    i = first + wp.tid()
    x = origin[0] + (float(i // (wide * deep)) + 0.5) * CELL
    y = origin[1] + (float((i // deep) % wide) + 0.5) * CELL
    z = origin[2] + (float(i % deep) + 0.5) * CELL
    column = wp.clamp(int((x - ground_origin[0]) / TEXEL), 0, ground.shape[0] - 1)
    row = wp.clamp(int((y - ground_origin[1]) / TEXEL), 0, ground.shape[1] - 1)
    # What stands on the ground reads cells around its foot too.
    z = wp.max(z, ground[column, row, 2] + 0.3)
    free = float(0.0)  # noqa: UP018
    for s in range(4):
        if sun[2] <= 0.0:
            free += 0.25
        else:
            corner = wp.vec3(
                x + (float(s % 2) - 0.5) * (0.5 * CELL),
                y + (float(s // 2) - 0.5) * (0.5 * CELL),
                z + wp.where(s == 0 or s == 3, 0.25 * CELL, -0.25 * CELL),
            )
            if not _is_hidden(street, views, root, 0, corner, suns[s]):
                free += 0.25
    mean = float(0.0)  # noqa: UP018
    gradient = wp.vec3(0.0)
    for s in range(AROUND_RAYS):
        value = float(1.0)  # noqa: UP018
        hit = _nearest_hit(street, views, root, 0, wp.vec3(x, y, z), around[s], RANGE)
        if hit.object_row >= 0:
            value = _from_surface(hit.distance)
            if is_ground[hit.object_row] != 0:
                # The sky's lower half is open ground in full light.
                there = wp.vec3(x, y, z) + around[s] * hit.distance
                column = wp.clamp(int((there[0] - ground_origin[0]) / TEXEL), 0, ground.shape[0] - 1)
                row = wp.clamp(int((there[1] - ground_origin[1]) / TEXEL), 0, ground.shape[1] - 1)
                value = sunlit * ground[column, row, 0] + (1.0 - sunlit) * ground[column, row, 1]
        mean += value
        gradient += around[s] * value
    light[i, 0] = free
    light[i, 1] = mean * wp.static(1.0 / AROUND_RAYS)
    # Light on a matte surface of a linear function of direction: mean + 2 <value direction> . normal.
    for a in range(3):
        light[i, 2 + a] = gradient[a] * wp.static(2.0 / AROUND_RAYS)
