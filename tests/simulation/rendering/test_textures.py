"""Mip levels of textures: those of Warp to the bit, and what is given is what kernels read."""

# pyright: reportArgumentType=false, reportCallIssue=false, reportIndexIssue=false
import gc

import numpy as np
import pytest
import warp as wp

from urbanverse_mjx.simulation.rendering import scenes
from urbanverse_mjx.simulation.rendering.scenes import linear_texels, make_texture, mip_levels, upload_textures


@wp.kernel
def read(texture: wp.Texture2D, level: float, found: wp.array[wp.vec4]) -> None:
    found[0] = wp.texture_sample(texture, wp.vec2(0.25, 0.75), dtype=wp.vec4, lod=level)


@pytest.mark.parametrize("shape", [(1, 1), (2, 1), (1, 7), (5, 3), (16, 64), (37, 20)])
@pytest.mark.parametrize("on_host", [True, False])
def test_levels_are_those_that_warp_makes(shape: tuple[int, int], on_host: bool) -> None:
    image = np.random.default_rng(0).integers(0, 256, (*shape, 3), np.uint8)
    texels = linear_texels(image, on_host)
    with wp.ScopedDevice("cpu"):
        expected = wp.Texture2D(texels, num_mip_levels=0)._generate_mipmap_chain(texels)
    levels = mip_levels(texels)
    assert [level.shape for level in levels] == [level.shape for level in expected]
    for level, other in zip(levels, expected, strict=True):
        assert level.dtype == texels.dtype
        np.testing.assert_array_equal(level, other)


def test_kernels_read_the_levels_that_are_given() -> None:
    levels = mip_levels(np.zeros((8, 8, 4), np.float32))
    for number, level in enumerate(levels):
        level[:] = number + 1.0
    with wp.ScopedDevice("cpu"):
        texture, found = make_texture(levels), wp.zeros(1, dtype=wp.vec4)
        for number in range(len(levels)):
            wp.launch(read, 1, inputs=[texture, float(number)], outputs=[found])
            np.testing.assert_array_equal(found.numpy()[0], number + 1.0)


def test_equal_images_are_one_texture_as_long_as_somebody_holds_it() -> None:
    rng = np.random.default_rng(1)
    images = [rng.integers(0, 256, (4, 4, 3), np.uint8) for _ in range(3)]
    other_shape = images[0].reshape(2, 8, 3)
    with wp.ScopedDevice("cpu"):
        first, sizes = upload_textures([*images, images[0].copy(), other_shape])
        second, _ = upload_textures(images[1:])
        assert first[0] is first[3]
        assert first[4] is not first[0]
        assert second[0] is first[1]
        assert second[1] is first[2]
        np.testing.assert_array_equal(sizes, [[4, 4]] * 4 + [[8, 2]])
        kept = scenes._uploaded[wp.get_device().alias]
        keys = [scenes.digest_of(image) for image in (*images, other_shape)]
        assert len(set(keys)) == 4, "the bytes alone do not name an image"
        assert all(key in kept for key in keys)
        del first, second
        gc.collect()
        assert not any(key in kept for key in keys)
