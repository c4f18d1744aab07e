"""Ground materials tile without a seam, have sane colours, and carry their patterns along the right axis."""

import numpy as np
import pytest

from urbanverse_mjx.assets.appearances import ground_materials as materials
from urbanverse_mjx.datatypes import ValidationError, ground

KINDS = ("road", "sidewalk", "crosswalk", "ground", "road_marking")
ALL = [i for kind in KINDS for i in materials.material_ids(kind)]


def test_every_kind_has_its_materials() -> None:
    assert set(KINDS) == set(ground.GROUND_KINDS) - {"none"}
    least = {"road": 6, "sidewalk": 10, "crosswalk": 3, "ground": 4, "road_marking": 2}
    for kind, count in least.items():
        assert len(materials.material_ids(kind)) >= count
    assert len(set(ALL)) == len(ALL)


@pytest.mark.parametrize("material_id", ALL)
def test_it_tiles(material_id: str) -> None:
    """The step from the last row (column) to the first is no larger than the largest step inside."""
    material = materials.build_material(material_id)
    assert material.texture.shape == (256, 256, 3)
    assert material.texture.dtype == np.uint8
    assert 0.5 <= material.tile_size_m <= 10
    assert 0 < material.roughness <= 1
    image = material.texture.astype(float)
    for axis in (0, 1):
        step = np.abs(np.diff(image, axis=axis)).mean(axis=(1 - axis, 2))
        seam = np.abs(image.take(0, axis) - image.take(-1, axis)).mean()
        assert seam <= 1.15 * step.max() + 1.0


def test_zebra_stripes_run_along_u_and_are_half_a_metre_wide() -> None:
    for material_id in materials.material_ids("crosswalk"):
        material = materials.build_material(material_id)
        # Saturated paint differs from the ground in red at least (white, yellow on grey; white on red in green).
        channel = material.texture[..., 1].astype(float)
        rows, columns = channel.mean(1), channel.mean(0)
        assert rows.std() > 5 * columns.std(), "stripes are constant along the driving direction"
        painted = rows > (rows.min() + rows.max()) / 2
        edges = int((painted != np.roll(painted, 1)).sum())
        width = material.tile_size_m / edges
        assert width == pytest.approx(0.5, abs=0.1)
        assert painted.mean() == pytest.approx(0.5, abs=0.1)


def test_asphalt_is_darker_than_concrete_and_paint_is_brightest() -> None:
    value = {i: materials.build_material(i).texture.mean() for i in ALL}
    assert value["asphalt_new"] < value["asphalt_old"] < value["concrete_road"] < value["paint_white"]


def test_same_id_same_pixels_and_unknown_names() -> None:
    first = materials.build_material("brick_herringbone").texture.copy()
    materials.build_material.cache_clear()
    assert np.array_equal(first, materials.build_material("brick_herringbone").texture)
    with pytest.raises(ValidationError, match="asphalt_new"):
        materials.build_material("cheese")
    with pytest.raises(ValidationError, match="sidewalk"):
        materials.material_ids("none")
