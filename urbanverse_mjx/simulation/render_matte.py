"""A matte megakernel for mujoco-warp-pbr: its rays, cameras, textures and sky, but diffuse light alone.

On the CPU the highlights of mujoco-warp-pbr's own kernel cost as much as finding what a ray hits: 534 instead of 367
frames/s a core without them (36x64, 110 slots, sky). A street is matte; what is lost is the gloss of cars and windows.
"""

import math
from typing import Any

import mujoco_warp as mjw
import mujoco_warp_pbr as pbr
import warp as wp
from mujoco_warp_pbr._src import camera, color, envmap, kernel_inputs, lights, material, trace


def build_matte_kernel(model: mjw.Model, context: pbr.PbrRenderContext) -> tuple[wp.Kernel, Any]:
    """For contexts with one camera that renders RGB.

    Returns:
      the kernel, with the arguments of mujoco-warp-pbr's own, and the key under which a context keeps it.
    """
    base = context.base
    values = kernel_inputs.settings_values(context)
    resolve = kernel_inputs.make_resolve_settings(context, values)
    trace_closest, trace_any = trace.make_trace(
        base.geom_ray_types, base.enable_backface_culling, context.ordered_traversal
    )
    primary_ray, pixel_cone = camera.make_camera_rays(False)
    eval_surface = material.make_eval_surface(base.geom_ray_types)
    guides, has_sky, shadows = bool(context.render_guides), bool(context.has_env), bool(context.use_shadows)
    rays = int(context.samples_per_pixel)

    @wp.func
    def irradiance(
        geo: trace.Geometry,
        lit: lights.Lights,
        env: kernel_inputs.Environment,
        s: kernel_inputs.Settings,
        worldid: int,
        point: wp.vec3,
        normal: wp.vec3,
    ) -> wp.vec3:
        """Light of sky and sun on a surface, divided by pi."""
        total = env.ambient_radiance[worldid]
        if wp.static(has_sky):
            e, yaw, scale = kernel_inputs.env_lookup(env, worldid)
            total += envmap.eval_sh9(env.env_sh, e, envmap.rotate_yaw(normal, -yaw)) * scale
        to_sun = -lit.light_xdir[worldid, 0]
        cosine = wp.dot(normal, to_sun)
        if cosine > 0.0:
            visible = float(1.0)  # noqa: UP018 (Warp takes a bare number for a constant)
            if wp.static(shadows):
                start = point + normal * wp.static(trace.RAY_OFFSET)
                if trace_any(geo, worldid, start, to_sun, wp.static(trace.UNBOUNDED_SHADOW_DIST)):
                    visible = 0.0
            total += lit.light_diffuse[worldid, 0] * (cosine * visible * wp.static(1.0 / math.pi))
        return total

    options = kernel_inputs.module_options(context)

    @wp.kernel(module="unique", enable_backward=False, grid_stride=False, module_options=options)
    def render_matte(
        geo: trace.Geometry,
        mats: material.Materials,
        lit: lights.Lights,
        cams: kernel_inputs.Cameras,
        env: kernel_inputs.Environment,
        seed: int,
        out: kernel_inputs.Outputs,
    ):
        i, j = wp.tid()
        s = resolve(env)
        worldid, rayid = camera.thread_ids(s.render_order, i, j)
        pix = camera.setup_pixel(cams, out, s, worldid, rayid)
        if pix.camid == -1:
            return
        spread, width = pixel_cone(cams, pix, s)
        share = wp.static(1.0 / rays)
        display = wp.vec3(0.0)
        adr = out.rgb_adr[pix.camid] + pix.pixelid
        for k in range(wp.static(rays * rays)):
            column = k % wp.static(rays)
            row = k // wp.static(rays)
            origin, direction, max_dist, axis = primary_ray(cams, pix, wp.static(rays), column, row, s)
            hit = trace_closest(geo, worldid, origin, direction, max_dist)
            radiance = env.background
            base_color = wp.vec3(0.0)
            normal = wp.vec3(0.0)
            if hit.geom_id == -1:
                if wp.static(has_sky):
                    e, yaw, scale = kernel_inputs.env_lookup(env, worldid)
                    radiance = envmap.sample_radiance(env.env_radiance[e], direction, yaw, 0.0) * scale
            else:
                point = origin + direction * hit.dist
                cone = (width + spread * hit.dist) * share
                surface, normal = eval_surface(geo, mats, s, worldid, hit, point, direction, cone)
                base_color = surface.base_color
                light = irradiance(geo, lit, env, s, worldid, point, normal)
                radiance = wp.cw_mul(base_color, light) + surface.emissive
            if k == 0:
                kernel_inputs.write_geometry(
                    out, worldid, pix.camid, pix.pixelid, hit, axis, pix.want_depth, pix.want_seg
                )
                if wp.static(guides):
                    kernel_inputs.write_guides(out, worldid, adr, base_color, normal)
            display += color.display_transform(radiance * env.exposure[0], s.tone_mapper)
        out.rgb[worldid, adr] = color.encode_display(display * (share * share))

    return render_matte, kernel_inputs.kernel_key(model, context, values)
