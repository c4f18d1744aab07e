"""Warp functions for the colour of a hit: materials, sun and sky, with or without gloss.

Gloss is mujoco-warp-pbr's: its functions of a glTF material, of blurred skies and of tone are called here as they are.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

from typing import Any

import warp as wp

from . import street_kernels as k
from .pbr_private import (
    GlossySurface,
    sample_radiance,
    sample_specular,
    sample_texture,
    shading_lobes,
    specular_lobe,
    srgb_to_linear,
    tonemap_pbr_neutral,
)
from .settings import PBR_EXPOSURE, PLAIN_SKY, Settings
from .street_kernels import FACE, LIGHT, OBJECT, PART, Street, Views
from .street_light import baked_light, moving_shade
from .street_native import Hit

#: Colour of the flat sky in linear light.
_FLAT = tuple(float(x) for x in srgb_to_linear(PLAIN_SKY[:3]))


@wp.struct
class Surface:
    """The surface at the end of a ray; emission: emitted share of its colour on the display; kind: 0 = an object of the
    street, 1 = its ground, 2 = what moves."""

    normal: wp.vec3
    colour: wp.vec3
    roughness: float
    metallic: float
    reflectance: float
    emission: float
    kind: int


@wp.struct
class Skies:
    """Textures of the skies; blurred: copies for gloss, one layer a roughness; lobes: mujoco-warp-pbr's table."""

    radiance: wp.array[wp.Texture2D]
    blurred: wp.array[wp.Texture3D]
    lobes: wp.Texture2D


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


def make_surface(want_colour: bool, gloss: bool, moved: bool) -> Any:
    """surface(street, views, world, textures, hit, direction, spread): the surface at the hit.

    spread: angle between neighbouring rays; moved: objects of the street may have moved.
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
        row = hit.object_row * OBJECT
        x = k.load(street.object_rows, row)
        y = k.load(street.object_rows, row + 1)
        z = k.load(street.object_rows, row + 2)
        part = hit.object_row - street.num_objects
        if part >= 0:
            row = 3 * (world * street.num_parts + part)
            x = k.load(views.poses, row)
            y = k.load(views.poses, row + 1)
            z = k.load(views.poses, row + 2)
        a = k.load(street.faces, hit.face * FACE)
        b = k.load(street.faces, hit.face * FACE + 1)
        c = k.load(street.faces, hit.face * FACE + 2)
        w = 1.0 - hit.u - hit.v
        normal = k.xyz(a) * w + k.xyz(b) * hit.u + k.xyz(c) * hit.v
        normal = wp.normalize(k.xyz(x) * normal[0] + k.xyz(y) * normal[1] + k.xyz(z) * normal[2])
        facing = wp.dot(normal, direction)
        out.normal = wp.where(facing > 0.0, -normal, normal)
        if wp.static(want_colour):
            obj = hit.object_row
            if wp.static(moved):
                obj = k.object_of(street, views, world, hit.object_row)
            out.colour = k.xyz(k.load(street.object_rows, obj * OBJECT + 3))
            surface = k.load(street.object_rows, obj * OBJECT + 4)
            if surface[0] >= 0.0:
                e = k.load(street.faces, hit.face * FACE + 3)
                uv = wp.vec2(b[3], c[3]) * w + wp.vec2(e[0], e[1]) * hit.u + wp.vec2(e[2], e[3]) * hit.v
                # a[3]: texture lengths per metre; surface[1]: texels per texture length.
                cone = spread * hit.distance / wp.max(wp.abs(facing), 0.05)
                level = wp.log2(wp.max(cone * a[3] * wp.abs(surface[1]), 1.0e-8))
                texel = sample_texture(textures[int(surface[0])], uv, level)
                out.colour = wp.cw_mul(out.colour, wp.vec3(texel[0], texel[1], texel[2]))
            # Of the ground, texels are negative.
            out.kind = wp.where(part >= 0, 2, wp.where(surface[1] < 0.0, 1, 0))
            if wp.static(gloss):
                out.roughness = surface[2]
                out.metallic = surface[3]
                out.reflectance = 0.5  # of glTF materials
                if part >= 0:
                    extra = k.load(street.parts, PART * part + 1)
                    out.reflectance = extra[0]
                    out.emission = extra[1]
        return out

    return surface


def _make_unhidden(settings: Settings) -> Any:
    """unhidden(street, views, world, scene, point, surface, sun): shares of sun and sky that reach a surface; that of
    the sun is 1 where shadows are traced."""
    baked, shadows = settings.light == "baked", settings.shadows

    @wp.func
    def unhidden(
        street: Street, views: Views, world: int, scene: int, point: wp.vec3, surface: Surface, sun: wp.vec3
    ) -> wp.vec2:
        if wp.static(not baked):
            return wp.vec2(1.0, 1.0)
        left = baked_light(street, scene, point, surface.normal, surface.kind == 1)
        if surface.kind < 2:
            left = wp.cw_mul(left, moving_shade(street, views, world, point, sun))
        if wp.static(shadows):
            left[0] = 1.0
        return left

    return unhidden


def make_shade(settings: Settings, is_hidden: Any) -> Any:
    """shade(street, views, skies, root, world, scene, point, direction, surface): light that leaves towards the camera.

    is_hidden: of `street_kernels.make_rays`.
    """
    sky, shadows, gloss = settings.sky, settings.shadows, settings.shading == "pbr"
    unhidden = _make_unhidden(settings)

    @wp.func
    def sunlight(
        street: Street, views: Views, root: int, world: int, scene: int, point: wp.vec3, normal: wp.vec3, sun: wp.vec3
    ) -> wp.vec3:
        """Light of the sun on a matte white surface."""
        cosine = wp.dot(normal, sun)
        if cosine <= 0.0:
            return wp.vec3(0.0)
        if wp.static(shadows):
            if is_hidden(street, views, root, world, point + normal * k.OFFSET, sun):
                return wp.vec3(0.0)
        return scalars(street, scene, 3) * cosine

    @wp.func
    def shade(
        street: Street,
        views: Views,
        skies: Skies,
        root: int,
        world: int,
        scene: int,
        point: wp.vec3,
        direction: wp.vec3,
        surface: Surface,
    ) -> wp.vec3:
        normal = surface.normal
        even = k.xyz(k.load(street.lights, LIGHT * scene))
        around = even
        if wp.static(sky):
            around = sky_light(street, scene, normal)
        sun = scalars(street, scene, 0)
        left = unhidden(street, views, world, scene, point, surface, sun)
        direct = sunlight(street, views, root, world, scene, point, normal, sun) * left[0]
        around = around * left[1]
        if wp.static(not gloss):
            return wp.cw_mul(surface.colour, around + direct)
        facing = wp.max(-wp.dot(normal, direction), 1.0e-4)
        seen = GlossySurface()
        seen.base_color = surface.colour
        seen.metallic = surface.metallic
        seen.perceptual_roughness = surface.roughness
        seen.reflectance = surface.reflectance
        lobes = shading_lobes(skies.lobes, seen, facing)
        mirrored = even
        if wp.static(sky):
            sky_row = scalars(street, scene, 6)
            number = int(sky_row[0])
            softness = lobes.alpha * lobes.alpha
            ahead = direction + normal * (2.0 * facing)
            ahead = wp.normalize(ahead * (1.0 - softness) + normal * softness)
            mirrored = sample_specular(
                skies.radiance[number], skies.blurred[number], ahead, sky_row[1], lobes.perceptual_roughness
            )
        mirrored = mirrored * left[1]
        light = wp.cw_mul(lobes.diffuse_color, around + direct)
        light += wp.cw_mul(mirrored, wp.cw_mul(lobes.spec_albedo, lobes.energy_comp))
        if wp.length_sq(direct) > 0.0:
            middle = wp.normalize(sun - direction)
            level = wp.max(wp.dot(normal, middle), 0.0)
            lobe = specular_lobe(
                lobes.f0, lobes.alpha, level, facing, wp.dot(normal, sun), wp.max(wp.dot(sun, middle), 0.0)
            )
            # `direct` is over pi, as a matte surface scatters it.
            light += wp.cw_mul(wp.cw_mul(lobe, lobes.energy_comp), direct) * wp.static(wp.pi)
        return light + surface.colour * (surface.emission * wp.static(1.0 / PBR_EXPOSURE))

    return shade


def make_background(settings: Settings, sky_width: int) -> Any:
    """background(street, skies, scene, direction, spread): light from the sky."""
    sky, gloss = settings.sky, settings.shading == "pbr"

    @wp.func
    def background(street: Street, skies: Skies, scene: int, direction: wp.vec3, spread: float) -> wp.vec3:
        if wp.static(sky):
            sky_row = scalars(street, scene, 6)
            level = float(0.0)  # noqa: UP018 (Warp takes a bare number for a constant)
            if wp.static(gloss):
                level = wp.log2(wp.max(spread * wp.static(sky_width / (2.0 * wp.pi)), 1.0e-8))
            return sample_radiance(skies.radiance[int(sky_row[0])], direction, sky_row[1], level)
        if wp.static(gloss):
            return wp.static(wp.vec3(*_FLAT)) * wp.static(1.0 / PBR_EXPOSURE)
        return k.xyz(k.load(street.lights, LIGHT * scene))

    return background


def make_display(settings: Settings) -> Any:
    """display(radiance): the displayed colour, in linear light."""
    gloss = settings.shading == "pbr"

    @wp.func
    def display(radiance: wp.vec3) -> wp.vec3:
        shown = wp.max(radiance, wp.vec3(0.0))
        if wp.static(gloss):
            shown = tonemap_pbr_neutral(shown * wp.static(PBR_EXPOSURE))
        return wp.min(wp.max(shown, wp.vec3(0.0)), wp.vec3(1.0))

    return display
