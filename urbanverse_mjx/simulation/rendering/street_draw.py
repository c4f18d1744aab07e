"""The kernel that draws static streets, specialised on the requested outputs and options."""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import math

import warp as wp

from . import street_kernels as k
from .pbr_private import srgb_oetf
from .settings import OUTPUTS, Scan, Settings
from .street_kernels import Street, Views
from .street_light import exposure
from .street_native import as_hit
from .street_packets import found_at, hit_index
from .street_shade import Skies, Surface, make_background, make_display, make_shade, make_surface

#: Rows of the bands in which a frame's pixels are drawn, column by column: a warp of the GPU draws 8x4 pixels, whose
#: rays read the same records.
_BAND = 8
#: Threads of a block, and blocks that a multiprocessor of the GPU shall hold at once: how many registers a thread has.
#: Tried on an H200, see docs/decisions/renderer.md.
BLOCK = (64, 14)


def build_draw_kernel(
    settings: Settings, far: float, sky_width: int, packets: bool, objects_of_place: int = 0
) -> wp.Kernel:
    """The kernel for images of one size; dim (worlds, pixels).

    far: m, end of all rays; sky_width: texels around a sky; packets: the rays' first hits are already in `hits`;
    objects_of_place: rows of the object table of each scene, whose objects' appearances do not depend on the other
    scenes then; 0 = the rows of all scenes stand together.
    """
    height, width, samples = settings.height, settings.width, settings.samples
    want_rgb, want_depth, want_category, want_object, want_normal = (name in settings.outputs for name in OUTPUTS)
    want_labels = want_category or want_object
    share = 1.0 / samples
    appearance = settings.appearance
    moved = settings.bodies > 0
    scans = settings.scan is not None
    scan = settings.scan or Scan(0.0, 0.0, far)
    far = scan.range
    ring = (scan.upper - scan.lower) / max(height - 1, 1)
    uneven, angles = len(scan.elevations) > 0, scan.elevations or (0.0,)
    elevations = wp.types.vector(length=len(angles), dtype=wp.float32)(*angles)
    baked = settings.light == "baked"
    nearest_hit, is_hidden = k.make_rays(moved)
    surface = make_surface(want_rgb, settings.shading == "pbr", moved)
    shade = make_shade(settings, is_hidden)
    background, display = make_background(settings, sky_width), make_display(settings)

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
        skies: Skies,
        labels: wp.array[wp.vec2i],
        appearance_seeds: wp.array[int],
        rgb: wp.array4d[wp.uint8],
        depth_out: wp.array3d[float],
        category: wp.array3d[int],
        object: wp.array3d[int],
        normals: wp.array3d[wp.vec3],
        hits: wp.uint64,
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
        total = wp.vec3(0.0)
        for s in range(wp.static(samples * samples)):
            column = float(px * samples + s % samples) + 0.5
            row = float(py * samples + s // samples) + 0.5
            x = column * wp.static(2.0 / (samples * width)) - 1.0
            y = 1.0 - row * wp.static(2.0 / (samples * height))
            ahead = right * x + up * y - back
            if wp.static(scans):
                azimuth = wp.static(math.pi) - (float(px) + 0.5) * wp.static(2.0 * math.pi / width)
                elevation = wp.static(scan.upper) - float(py) * wp.static(ring)
                if wp.static(uneven):
                    elevation = wp.static(elevations)[py]
                level = wp.cos(elevation)
                ahead = up * wp.sin(elevation) - back * (level * wp.cos(azimuth)) - right * (level * wp.sin(azimuth))
            # The image's plane stands at distance 1.
            length = wp.length(ahead)
            direction = ahead / length
            # Neighbouring rays are this far apart in the image's plane, and turned by this much of it.
            gap = at[3] * wp.static(2.0 * share / height) / length
            lean = x * wp.static(width / height) * at[3] / length
            spread = gap * wp.sqrt(wp.max(1.0 - lean * lean, 0.0))
            if wp.static(packets):
                index = hit_index(
                    wp.static(width * samples),
                    wp.static(height * samples),
                    i,
                    px * samples + s % samples,
                    py * samples + s // samples,
                )
                hit = as_hit(found_at(hits, index))
            else:
                hit = nearest_hit(street, views, root, world, origin, direction, wp.static(far) * length)
            seen = Surface()
            radiance = wp.vec3(0.0)
            obj = hit.object_row
            if wp.static(moved):
                if obj >= 0:
                    obj = k.object_of(street, views, world, hit.object_row)
            if hit.object_row >= 0:
                if wp.static(want_rgb or want_normal):
                    seen = surface(street, views, world, textures, hit, direction, spread)
                if wp.static(want_rgb):
                    if wp.static(appearance > 0.0):
                        if obj < street.num_objects:
                            number = obj
                            if wp.static(objects_of_place > 0):
                                number = obj - scene * wp.static(objects_of_place)
                            tint = k.factors(appearance_seeds[world], number, wp.static(appearance))
                            seen.colour = wp.min(wp.cw_mul(seen.colour, tint), wp.vec3(1.0))
                    point = origin + direction * hit.distance
                    radiance = shade(street, views, skies, root, world, scene, point, direction, seen)
            elif wp.static(want_rgb):
                radiance = background(street, skies, scene, direction, spread)
            if s == 0:
                if wp.static(want_depth):
                    depth_out[world, py, px] = wp.where(hit.object_row >= 0, hit.distance / length, 0.0)
                if wp.static(want_labels):
                    label = wp.vec2i(-1, -1)
                    if hit.object_row >= 0:
                        label = labels[obj]
                    if wp.static(want_object):
                        object[world, py, px] = label[0]
                    if wp.static(want_category):
                        category[world, py, px] = label[1]
                if wp.static(want_normal):
                    normals[world, py, px] = seen.normal
            if wp.static(want_rgb):
                if wp.static(appearance > 0.0):
                    radiance = wp.cw_mul(radiance, k.factors(appearance_seeds[world], -1, wp.static(appearance)))
                if wp.static(baked):
                    radiance = radiance * exposure(street, scene)
                total += display(radiance)
        if wp.static(want_rgb):
            mean = total * wp.static(share * share)
            rgb[world, py, px, 0] = wp.uint8(int(srgb_oetf(mean[0]) * 255.0 + 0.5))
            rgb[world, py, px, 1] = wp.uint8(int(srgb_oetf(mean[1]) * 255.0 + 0.5))
            rgb[world, py, px, 2] = wp.uint8(int(srgb_oetf(mean[2]) * 255.0 + 0.5))

    return draw
