"""The renderer's data of a bank's scenes: textures, skies, boxes and suns."""

import dataclasses
import weakref
from collections.abc import Sequence

import numpy as np
import warp as wp

from ...datatypes import SceneBank, array_file
from ...geometry import rotations
from .pbr_private import prefilter_sky, sky_harmonics, srgb_to_linear

#: Warp reads textures in software on the CPU, one channel and one mip level after the other: numbers of 32 bits, the
#: nearest mip level and the nearest texel of the blurred skies draw the same street 24 % faster (368 instead of 302
#: frames/s a core, 36x64, 110 slots, shading pbr).
_LINEAR, _NEAREST = wp.TextureFilterMode.LINEAR, wp.TextureFilterMode.CLOSEST
#: The blurred copies of a sky for reflections of rough surfaces: width, roughness levels, samples a texel. Streets are
#: rough, so 64 texels around (5.6 degrees) suffice; sharper reflections read the sky itself.
BLUR_WIDTH, BLUR_LEVELS, BLUR_SAMPLES = 64, 8, 128


#: Name of a device -> digest of an image -> its texture, as long as a renderer holds it.
_uploaded: dict[str, weakref.WeakValueDictionary[str, wp.Texture2D]] = {}


@dataclasses.dataclass(frozen=True)
class Skies:
    """Sky textures of a bank, in the form in which a pbr context takes them.

    radiance, prefiltered: (S,) Warp texture arrays, the latter None without gloss; sh: (S, 9) diffuse light as
    spherical harmonics; width: texels around; owners: the texture objects, which live as long as this does.
    """

    radiance: wp.array
    prefiltered: wp.array | None
    sh: wp.array
    width: int
    owners: tuple[object, ...]


def upload_textures(images: Sequence[np.ndarray]) -> tuple[list[wp.Texture2D], np.ndarray]:
    """Images (H, W, channels) u8 in linear light, with mip levels, and their (number, 2) widths and heights.

    Equal ones are one object, also those of another renderer of this process: joined banks hold the textures of the
    same assets again, two fifths of all in five sets, and a training, its validation and a recording draw the same
    streets.
    """
    device = wp.get_device()
    known = _uploaded.setdefault(device.alias, weakref.WeakValueDictionary())
    textures: list[wp.Texture2D] = []
    for image in images:
        digest = digest_of(image)
        texture = known.get(digest)
        if texture is None:
            texture = known[digest] = make_texture(mip_levels(linear_texels(image, device.is_cpu)))
        textures.append(texture)
    return textures, texture_sizes(images)


def texture_sizes(images: Sequence[np.ndarray]) -> np.ndarray:
    """(number, 2) f32: widths and heights of images (H, W, channels)."""
    return np.array([(image.shape[1], image.shape[0]) for image in images], np.float32).reshape(-1, 2)


def digest_of(image: np.ndarray) -> str:
    """A hash of an image's shape and numbers."""
    return array_file.key_of((), {"image": image})


def linear_texels(image: np.ndarray, on_host: bool) -> np.ndarray:
    """(H, W, 4) of an image (H, W, channels) u8 in linear light: f32 for a texture on the host, else f16."""
    to_linear = srgb_to_linear(np.arange(256) / 255.0).astype(np.float32 if on_host else np.float16)
    texels = np.ones((*image.shape[:2], 4), to_linear.dtype)
    texels[..., :3] = to_linear[image[..., :3]]
    return texels


def mip_levels(texels: np.ndarray) -> list[np.ndarray]:
    """(H, W, 4) texels, and copies of half the size each down to one texel, as Warp makes them: means of pairs in
    single floats, without the last row or column of an odd number."""
    levels = [np.ascontiguousarray(texels)]
    while max(levels[-1].shape[:2]) > 1:
        found = levels[-1].astype(np.float32, copy=False)
        for axis in (1, 0):
            if found.shape[axis] > 1:
                pairs = found.shape[axis] // 2
                found = np.moveaxis(found, axis, 0)
                found = np.moveaxis((found[0 : 2 * pairs : 2] + found[1 : 2 * pairs : 2]) * np.float32(0.5), 0, axis)
        levels.append(np.ascontiguousarray(found, texels.dtype))
    return levels


class _Texture(wp.Texture2D):
    """A texture whose mip levels are given; Warp would make them from the first with each upload.

    The method that this replaces is private: where Warp has another, it makes the same levels itself.
    """

    def __init__(self, levels: Sequence[np.ndarray]) -> None:
        self._given = list(levels)
        super().__init__(
            self._given[0],
            filter_mode=_LINEAR,
            address_mode=wp.TextureAddressMode.WRAP,
            num_mip_levels=0,
            mip_filter_mode=_NEAREST if wp.get_device().is_cpu else _LINEAR,
        )
        self._given.clear()

    def _generate_mipmap_chain(self, data_np: np.ndarray) -> list[np.ndarray]:
        del data_np
        return self._given


def make_texture(levels: Sequence[np.ndarray]) -> wp.Texture2D:
    """The texture of `mip_levels` on Warp's current device."""
    return _Texture(levels)


def _blurred(radiance: wp.Texture2D, width: int, height: int) -> wp.Texture3D:
    """The sky blurred by the GGX lobe of each of `BLUR_LEVELS` roughnesses."""
    stack = wp.zeros((BLUR_LEVELS, BLUR_WIDTH // 2, BLUR_WIDTH, 4), dtype=wp.float16)
    wp.launch(
        prefilter_sky,
        dim=stack.shape[:3],
        inputs=[radiance, width, height, BLUR_SAMPLES, 0],
        outputs=[stack],
    )
    clamp, on_host = wp.TextureAddressMode.CLAMP, wp.get_device().is_cpu
    return wp.Texture3D(
        stack.numpy().astype(np.float32) if on_host else stack,
        filter_mode=_NEAREST if on_host else _LINEAR,
        address_mode_u=wp.TextureAddressMode.WRAP,
        address_mode_v=clamp,
        address_mode_w=clamp,
    )


def build_skies(radiance: np.ndarray, glossy: bool) -> Skies:
    """Uploads (S, H, W, 3) panoramas in the bank's layout (which is also that of mujoco-warp-pbr), equal ones once."""
    maps, stacks, harmonics = [], [], []
    known: dict[str, int] = {}
    height, width = radiance.shape[1:3]
    on_host = wp.get_device().is_cpu
    for number, image in enumerate(radiance):
        same = known.setdefault(digest_of(image), number)
        if same < number:
            for rows in (maps, stacks if glossy else [], harmonics):
                rows.extend(rows[same : same + 1])
            continue
        rgba = np.concatenate([image, np.ones((height, width, 1), np.float32)], -1)
        texture = wp.Texture2D(
            rgba.astype(np.float32 if on_host else np.float16),
            filter_mode=_LINEAR,
            address_mode_u=wp.TextureAddressMode.WRAP,
            address_mode_v=wp.TextureAddressMode.CLAMP,
            num_mip_levels=0,
            mip_filter_mode=_NEAREST if on_host else _LINEAR,
        )
        maps.append(texture)
        if glossy:
            stacks.append(_blurred(texture, width, height))
        harmonics.append(sky_harmonics(image))
    return Skies(
        radiance=wp.array(maps, dtype=wp.Texture2D),
        prefiltered=wp.array(stacks, dtype=wp.Texture3D) if glossy else None,
        sh=wp.array(np.stack(harmonics), dtype=wp.vec3),
        width=width,
        owners=(*maps, *stacks),
    )


def slot_boxes(bank: SceneBank) -> tuple[np.ndarray, np.ndarray]:
    """(Z, N, 3) lower and upper corners, m, of the box around each slot's mesh in the world; 0 for empty slots."""
    lower = np.zeros(bank.slot_position.shape)
    upper = np.zeros(bank.slot_position.shape)
    start, flat = bank.mesh_vertex_start, bank.slot_mesh.ravel()
    # All slots with the same mesh at once.
    order = np.argsort(flat, kind="stable")
    for slots in np.split(order, np.flatnonzero(np.diff(flat[order])) + 1):
        mesh = flat[slots[0]]
        if mesh < 0:
            continue
        z, n = np.divmod(slots, bank.slot_mesh.shape[1])
        rotation = rotations.matrix_f64(bank.slot_quaternion[z, n])
        corners = rotation @ bank.mesh_vertices[start[mesh] : start[mesh + 1]].T.astype(np.float64)
        lower[z, n] = corners.min(-1) + bank.slot_position[z, n]
        upper[z, n] = corners.max(-1) + bank.slot_position[z, n]
    return lower, upper


def scene_sun(bank: SceneBank) -> tuple[np.ndarray, np.ndarray]:
    """(Z, 3) unit directions towards the sun, turned by each scene's yaw, and (Z, 3) irradiances."""
    direction = bank.sky_sun_direction[bank.scene_sky].astype(np.float64)
    c, s = np.cos(bank.scene_sky_yaw), np.sin(bank.scene_sky_yaw)
    turned = np.stack(
        [c * direction[:, 0] - s * direction[:, 1], s * direction[:, 0] + c * direction[:, 1], direction[:, 2]], -1
    )
    return turned, bank.sky_sun_irradiance[bank.scene_sky]


def sky_ambient(bank: SceneBank) -> np.ndarray:
    """(Z, 3) mean radiance of each scene's sky over the sphere: its light where no sky is drawn."""
    height = bank.sky_radiance.shape[1]
    weight = np.sin((np.arange(height) + 0.5) / height * np.pi)
    mean = np.einsum("h,shwc->sc", weight / weight.sum(), bank.sky_radiance) / bank.sky_radiance.shape[2]
    return mean[bank.scene_sky]
