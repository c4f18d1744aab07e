"""All names used of mujoco-warp-pbr's private modules; no other module imports these.

Its public functions render its own worlds. Here, streets share one tree and differ by tables, so the kernels of this
package call its Warp functions for materials, prefiltered skies and tone mapping, and its functions that build their
tables.

Raises:
  ValidationError: the installed version lacks one of them.
"""

from ..private_modules import missing

#: The version that these names were taken from; `pyproject.toml` asks for it.
NEEDED = "==0.2.0"

try:
    # Warp functions: the lobe of a light, and the shading of a glTF material for a direction.
    from mujoco_warp_pbr._src.brdf import specular_lobe

    # The display's transfer function and its inverse, and the tone curve of `shading="pbr"`.
    from mujoco_warp_pbr._src.color import srgb_oetf, srgb_to_linear, tonemap_pbr_neutral

    # Skies: blurred copies, diffuse light as spherical harmonics, and Warp functions that read them.
    from mujoco_warp_pbr._src.envmap import _prefilter as prefilter_sky
    from mujoco_warp_pbr._src.envmap import _sh9_irradiance as sky_harmonics
    from mujoco_warp_pbr._src.envmap import eval_sh9, rotate_yaw, sample_radiance, sample_specular, texel_angle

    # The table of a material's lobes by roughness and angle.
    from mujoco_warp_pbr._src.ibl import build_dfg_lut

    # Data of its own renderer for each environment: the benchmark that compares with it needs the groups.
    from mujoco_warp_pbr._src.kernel_inputs import BAKE_GROUPS

    # Materials of a MuJoCo model by geom, and the Warp struct and function that split one into lobes.
    from mujoco_warp_pbr._src.material import Surface as GlossySurface
    from mujoco_warp_pbr._src.material import effective_geom_rgba, resolve_geom_materials, shading_lobes

    # Reads a texture at a mip level.
    from mujoco_warp_pbr._src.texture import sample as sample_texture

    # How its C++ for reading Warp's trees (`wp.mjpbr_bvh_node`) is compiled.
    from mujoco_warp_pbr._src.traverse import BUILD_OPTIONS
except ImportError as error:
    raise missing("mujoco-warp-pbr", NEEDED, "materials, skies and search trees", error) from error

__all__ = [
    "BAKE_GROUPS",
    "BUILD_OPTIONS",
    "GlossySurface",
    "build_dfg_lut",
    "effective_geom_rgba",
    "eval_sh9",
    "prefilter_sky",
    "resolve_geom_materials",
    "rotate_yaw",
    "sample_radiance",
    "sample_specular",
    "sample_texture",
    "shading_lobes",
    "sky_harmonics",
    "specular_lobe",
    "srgb_oetf",
    "srgb_to_linear",
    "texel_angle",
    "tonemap_pbr_neutral",
]
