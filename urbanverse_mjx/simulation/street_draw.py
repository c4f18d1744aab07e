"""The kernel that draws still streets, specialised on what is asked for."""

# Kernels are Warp's language in Python's clothes; Warp itself checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

from typing import Any

import warp as wp
from mujoco_warp_pbr._src import color, envmap, texture

from . import street_kernels as k
from .render_context import OUTPUTS, Settings
from .street_kernels import FACE, LIGHT, THING, Hit, Street, Views

#: Rows of the bands in which a frame's pixels are drawn, column by column: a warp of the GPU draws 8x4 pixels, whose
#: rays read the same records.
_BAND = 8
#: Threads of a block, and blocks that a multiprocessor of the GPU shall hold at once: how many registers a thread has.
#: Tried on an H200, see docs/decisions/renderer.md.
BLOCK = (64, 8)


@wp.struct
class Surface:
    """What is seen where a ray ends."""

    normal: wp.vec3
    colour: wp.vec3


@wp.func
def sky_light(street: Street, scene: int, n: wp.vec3) -> wp.vec3:
    """Light of the sky on a matte white surface that faces `n`."""
    row = LIGHT * scene
    light = k.xyz(k.load(street.lights, row))
    light += k.xyz(k.load(street.lights, row + 1)) * n[0]
    light += k.xyz(k.load(street.lights, row + 2)) * n[1]
    light += k.xyz(k.load(street.lights, row + 3)) * n[2]
    light += k.xyz(k.load(street.lights, row + 4)) * (n[0] * n[0])
    light += k.xyz(k.load(street.lights, row + 5)) * (n[1] * n[1])
    light += k.xyz(k.load(street.lights, row + 6)) * (n[0] * n[1])
    light += k.xyz(k.load(street.lights, row + 7)) * (n[1] * n[2])
    light += k.xyz(k.load(street.lights, row + 8)) * (n[0] * n[2])
    return wp.max(light, wp.vec3(0.0))


@wp.func
def scalars(street: Street, scene: int, first: int) -> wp.vec3:
    """Three of a scene's nine scalars: sun direction 0, sunlight 3, sky number and yaw 6."""
    row = LIGHT * scene + first
    a = k.load(street.lights, row)
    b = k.load(street.lights, row + 1)
    c = k.load(street.lights, row + 2)
    return wp.vec3(a[3], b[3], c[3])


def _make_surface(parts: int, want_colour: bool) -> Any:
    """surface(street, views, world, textures, hit, direction, spread): the normal towards the viewer, and the colour.

    spread: angle between neighbouring rays.
    """

    @wp.func
    def surface(
        street: Street,
        views: Views,
        world: int,
        textures: wp.array[wp.Texture2D],
        hit: Hit,
        direction: wp.vec3,
        spread: float,
    ) -> Surface:
        out = Surface()
        row = hit.thing * THING
        x = k.load(street.things, row)
        y = k.load(street.things, row + 1)
        z = k.load(street.things, row + 2)
        if wp.static(parts > 0):
            part = hit.thing - street.num_objects
            if part >= 0:
                row = 3 * (world * wp.static(parts) + part)
                x = k.load(views.poses, row)
                y = k.load(views.poses, row + 1)
                z = k.load(views.poses, row + 2)
        normal = hit.normal
        a = wp.vec4(0.0)
        b = wp.vec4(0.0)
        c = wp.vec4(0.0)
        w = 1.0 - hit.u - hit.v
        if hit.face >= 0:
            a = k.load(street.faces, hit.face * FACE)
            b = k.load(street.faces, hit.face * FACE + 1)
            c = k.load(street.faces, hit.face * FACE + 2)
            normal = k.xyz(a) * w + k.xyz(b) * hit.u + k.xyz(c) * hit.v
        normal = wp.normalize(k.xyz(x) * normal[0] + k.xyz(y) * normal[1] + k.xyz(z) * normal[2])
        facing = wp.dot(normal, direction)
        out.normal = wp.where(facing > 0.0, -normal, normal)
        if wp.static(want_colour):
            out.colour = k.xyz(k.load(street.things, hit.thing * THING + 3))
            look = k.load(street.things, hit.thing * THING + 4)
            if hit.face >= 0 and look[0] >= 0.0:
                e = k.load(street.faces, hit.face * FACE + 3)
                uv = wp.vec2(b[3], c[3]) * w + wp.vec2(e[0], e[1]) * hit.u + wp.vec2(e[2], e[3]) * hit.v
                # a[3]: texture lengths per metre; look[1]: texels per texture length.
                cone = spread * hit.distance / wp.max(wp.abs(facing), 0.05)
                level = wp.log2(wp.max(cone * a[3] * look[1], 1.0e-8))
                texel = texture.sample(textures[int(look[0])], uv, level)
                out.colour = wp.cw_mul(out.colour, wp.vec3(texel[0], texel[1], texel[2]))
        return out

    return surface


def _make_shade(settings: Settings, trace_any: Any) -> Any:
    """shade(street, views, root, world, scene, point, normal, colour): light that leaves a matte surface."""
    sky, shadows = settings.sky, settings.shadows

    @wp.func
    def shade(
        street: Street,
        views: Views,
        root: int,
        world: int,
        scene: int,
        point: wp.vec3,
        normal: wp.vec3,
        colour: wp.vec3,
    ) -> wp.vec3:
        light = wp.vec3(0.0)
        if wp.static(sky):
            light = sky_light(street, scene, normal)
        else:
            light = k.xyz(k.load(street.lights, LIGHT * scene))
        sun = scalars(street, scene, 0)
        cosine = wp.dot(normal, sun)
        if cosine > 0.0:
            if wp.static(shadows):
                shadow = trace_any(street, views, root, world, point + normal * k.OFFSET, sun, 1.0e6)
                if shadow.thing >= 0:
                    cosine = 0.0
            light += scalars(street, scene, 3) * cosine
        return wp.cw_mul(colour, light)

    return shade


def build_draw_kernel(settings: Settings, meshes: int, kinds: tuple[int, ...], far: float) -> wp.Kernel:
    """The kernel for pictures of one size; dim (worlds, pixels). For the other arguments see `make_trace`."""
    height, width, samples, sky = settings.height, settings.width, settings.samples, settings.sky
    want_rgb, want_depth, want_category, want_object, want_normal = (name in settings.outputs for name in OUTPUTS)
    want_labels = want_category or want_object
    share = 1.0 / samples
    trace = k.make_trace(meshes, kinds, shadow=False)
    surface = _make_surface(meshes + len(kinds), want_rgb)
    shade = _make_shade(settings, k.make_trace(meshes, kinds, shadow=True) if settings.shadows else None)

    @wp.kernel(
        module="unique",
        module_options=k.module_options(),
        enable_backward=False,
        grid_stride=False,
        launch_bounds=BLOCK,
    )
    def draw(
        first: int,
        street: Street,
        views: Views,
        scenes: wp.array[int],
        roots: wp.array[int],
        textures: wp.array[wp.Texture2D],
        skies: wp.array[wp.Texture2D],
        labels: wp.array[wp.vec2i],
        rgb: wp.array4d[wp.uint8],
        depth_out: wp.array3d[float],
        category: wp.array3d[int],
        object: wp.array3d[int],
        normals: wp.array3d[wp.vec3],
    ):
        i, pixel = wp.tid()
        world = first + i
        scene = scenes[world]
        root = roots[scene]
        band = pixel // wp.static(width * _BAND)
        rows = wp.min(_BAND, height - band * _BAND)
        inner = pixel - band * wp.static(width * _BAND)
        px = inner // rows
        py = band * _BAND + inner % rows

        at = k.load(views.cameras, 4 * world)
        right = k.xyz(k.load(views.cameras, 4 * world + 1))
        up = k.xyz(k.load(views.cameras, 4 * world + 2))
        back = k.xyz(k.load(views.cameras, 4 * world + 3))
        origin = k.xyz(at)
        display = wp.vec3(0.0)
        for s in range(wp.static(samples * samples)):
            column = float(px * samples + s % samples) + 0.5
            row = float(py * samples + s // samples) + 0.5
            x = column * wp.static(2.0 / (samples * width)) - 1.0
            y = 1.0 - row * wp.static(2.0 / (samples * height))
            ahead = right * x + up * y - back
            # The picture's plane stands at distance 1.
            length = wp.length(ahead)
            direction = ahead / length
            hit = trace(street, views, root, world, origin, direction, wp.static(far) * length)
            out = Surface()
            radiance = wp.vec3(0.0)
            if hit.thing >= 0:
                if wp.static(want_rgb or want_normal):
                    # Neighbouring rays are this far apart in the picture's plane, and turned by this much of it.
                    gap = at[3] * wp.static(2.0 * share / height) / length
                    lean = x * wp.static(width / height) * at[3] / length
                    spread = gap * wp.sqrt(wp.max(1.0 - lean * lean, 0.0))
                    out = surface(street, views, world, textures, hit, direction, spread)
                if wp.static(want_rgb):
                    point = origin + direction * hit.distance
                    radiance = shade(street, views, root, world, scene, point, out.normal, out.colour)
            elif wp.static(want_rgb):
                if wp.static(sky):
                    look = scalars(street, scene, 6)
                    radiance = envmap.sample_radiance(skies[int(look[0])], direction, look[1], 0.0)
                else:
                    radiance = k.xyz(k.load(street.lights, LIGHT * scene))
            if s == 0:
                if wp.static(want_depth):
                    depth_out[world, py, px] = wp.where(hit.thing >= 0, hit.distance / length, 0.0)
                if wp.static(want_labels):
                    label = wp.vec2i(-1, -1)
                    if hit.thing >= 0:
                        label = labels[hit.thing]
                    if wp.static(want_object):
                        object[world, py, px] = label[0]
                    if wp.static(want_category):
                        category[world, py, px] = label[1]
                if wp.static(want_normal):
                    normals[world, py, px] = out.normal
            display += wp.min(wp.max(radiance, wp.vec3(0.0)), wp.vec3(1.0))
        if wp.static(want_rgb):
            mean = display * wp.static(share * share)
            rgb[world, py, px, 0] = wp.uint8(int(color.srgb_oetf(mean[0]) * 255.0 + 0.5))
            rgb[world, py, px, 1] = wp.uint8(int(color.srgb_oetf(mean[1]) * 255.0 + 0.5))
            rgb[world, py, px, 2] = wp.uint8(int(color.srgb_oetf(mean[2]) * 255.0 + 0.5))

    return draw

