"""The kernel that draws still streets, specialised on what is asked for."""

# Kernels are Warp's language in Python's clothes; Warp itself checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

from typing import Any

import warp as wp
from mujoco_warp_pbr._src import color, envmap

from . import street_kernels as k
from .street_kernels import Face, Light, Look, Part, Slot

#: Rows of the bands in which a frame's pixels are drawn, column by column: neighbouring rays read the same records.
_BAND = 8


def build_draw_kernel(
    height: int, width: int, outputs: tuple[str, ...], shadows: bool, sky: bool, samples: int, far: float, robot: bool
) -> wp.Kernel:
    """The kernel for pictures of one size; dim (worlds, pixels). `outputs`: what is written, see `Renderer`."""
    want_rgb, want_depth, want_normal = "rgb" in outputs, "depth" in outputs, "normal" in outputs
    want_object, want_category = "object" in outputs, "category" in outputs
    share = 1.0 / samples
    options: dict[str, Any] = k.module_options()

    @wp.func
    def ray(turn: wp.mat33, half: float, column: int, row: int, n: int) -> wp.vec3:
        """Unit direction through cell (column, row) of a picture cut n times finer, in the world."""
        x = (2.0 * (float(column) + 0.5) / float(n * width) - 1.0) * half * wp.static(width / height)
        y = (1.0 - 2.0 * (float(row) + 0.5) / float(n * height)) * half
        return turn @ wp.normalize(wp.vec3(x, y, -1.0))

    @wp.kernel(module="unique", module_options=options, enable_backward=False, grid_stride=False)
    def draw(
        first: int,
        tree: wp.uint64,
        roots: wp.array[int],
        slots: wp.array[Slot],
        faces: wp.array[Face],
        looks: wp.array[Look],
        textures: wp.array[wp.Texture2D],
        lights: wp.array[Light],
        skies: wp.array[wp.Texture2D],
        harmonics: wp.array2d[wp.vec3],
        parts: wp.array[Part],
        position: wp.array2d[wp.vec3],
        rotation: wp.array2d[wp.mat33],
        balls: wp.array2d[wp.vec4],
        scene: wp.array[int],
        eye: wp.array[wp.vec3],
        quaternion: wp.array[wp.vec4],
        fovy: wp.array[float],
        robot_label: int,
        rgb: wp.array4d[wp.uint8],
        depth: wp.array3d[float],
        category: wp.array3d[int],
        object: wp.array3d[int],
        normals: wp.array3d[wp.vec3],
    ):
        i, pixel = wp.tid()
        w = first + i
        z = scene[w]
        band = pixel // wp.static(width * _BAND)
        rows = wp.min(_BAND, height - band * _BAND)
        inner = pixel - band * wp.static(width * _BAND)
        px = inner // rows
        py = band * _BAND + inner % rows

        origin = eye[w]
        q = quaternion[w]
        turn = wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))
        if not (wp.isfinite(origin) and wp.isfinite(q)):
            origin = wp.vec3(0.0, 0.0, -1.0e4)
            turn = wp.identity(n=3, dtype=float)
        half = wp.tan(0.5 * fovy[w])
        axis = wp.vec3(-turn[0, 2], -turn[1, 2], -turn[2, 2])
        light = lights[z]
        spread = wp.length(ray(turn, half, px + 1, py, 1) - ray(turn, half, px, py, 1)) * share
        display = wp.vec3(0.0)
        for s in range(wp.static(samples * samples)):
            column = px * samples + s % samples
            row = py * samples + s // samples
            direction = ray(turn, half, column, row, samples)
            limit = far / wp.max(wp.dot(direction, axis), 1.0e-6)
            hit = k.nearest_slot(tree, roots[z], slots, origin, direction, limit)
            if wp.static(robot):
                if not k.misses_ball(origin, direction, balls[w, parts.shape[0]]):
                    hit = k.nearest_part(parts, balls, position, rotation, w, slots.shape[0], origin, direction, hit)
            number = int(-1)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
            kind = int(-1)  # noqa: RUF046, UP018
            normal = wp.vec3(0.0)
            radiance = light.even
            if hit.index < 0:
                if wp.static(sky and want_rgb):
                    radiance = envmap.sample_radiance(skies[light.sky], direction, light.yaw, 0.0)
            else:
                face = int(-1)  # noqa: RUF046, UP018
                look = int(0)  # noqa: RUF046, UP018
                frame = wp.identity(n=3, dtype=float)
                if hit.index < slots.shape[0]:
                    slot = slots[hit.index]
                    number = slot.number
                    kind = slot.category
                    face = slot.face + hit.face
                    look = slot.look
                    frame = slot.rotation
                else:
                    part = parts[hit.index - slots.shape[0]]
                    number = robot_label
                    kind = robot_label
                    look = part.look
                    if hit.face >= 0:
                        face = part.face + hit.face
                        frame = rotation[w, hit.index - slots.shape[0]]
                if wp.static(want_rgb or want_normal):
                    normal = hit.normal
                    colour = looks[look]
                    albedo = colour.colour
                    if face >= 0:
                        corners = faces[face]
                        smooth = frame @ k.corner_normal(corners, hit.u, hit.v)
                        if wp.length_sq(smooth) > 0.0:
                            normal = wp.normalize(smooth)
                        if wp.static(want_rgb):
                            if colour.texture >= 0:
                                cone = spread * hit.distance / wp.max(wp.abs(wp.dot(hit.normal, direction)), 0.05)
                                albedo = k.texel(corners, colour, textures, hit.u, hit.v, cone)
                    if wp.dot(normal, direction) > 0.0:
                        normal = -normal
                    if wp.static(want_rgb):
                        total = light.even
                        if wp.static(sky):
                            total = envmap.eval_sh9(harmonics, light.sky, envmap.rotate_yaw(normal, -light.yaw))
                        cosine = wp.dot(normal, light.sun)
                        if cosine > 0.0:
                            if wp.static(shadows):
                                start = origin + direction * hit.distance + normal * k.OFFSET
                                if k.any_slot(tree, roots[z], slots, start, light.sun):
                                    cosine = 0.0
                                if wp.static(robot):
                                    if cosine > 0.0:
                                        if k.any_part(parts, balls, position, rotation, w, start, light.sun):
                                            cosine = 0.0
                            total += light.sunlight * cosine
                        radiance = wp.cw_mul(albedo, total)
            if s == 0:
                if wp.static(want_depth):
                    distance = float(0.0)  # noqa: UP018
                    if hit.index >= 0:
                        distance = hit.distance * wp.dot(direction, axis)
                    depth[w, py, px] = distance
                if wp.static(want_object):
                    object[w, py, px] = number
                if wp.static(want_category):
                    category[w, py, px] = kind
                if wp.static(want_normal):
                    normals[w, py, px] = normal
            display += wp.min(wp.max(radiance, wp.vec3(0.0)), wp.vec3(1.0))
        if wp.static(want_rgb):
            mean = display * wp.static(share * share)
            rgb[w, py, px, 0] = wp.uint8(int(color.srgb_oetf(mean[0]) * 255.0 + 0.5))
            rgb[w, py, px, 1] = wp.uint8(int(color.srgb_oetf(mean[1]) * 255.0 + 0.5))
            rgb[w, py, px, 2] = wp.uint8(int(color.srgb_oetf(mean[2]) * 255.0 + 0.5))

    return draw
