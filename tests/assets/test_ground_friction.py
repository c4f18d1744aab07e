"""Friction of ground materials: every material has one, by its surface and condition."""

import pytest

from urbanverse_mjx.assets.appearances.ground_friction import ground_friction
from urbanverse_mjx.assets.appearances.ground_materials import material_ids
from urbanverse_mjx.assets.appearances.grounds import ground_records
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes.ground import GROUND_KINDS


def test_every_material_of_a_scene_has_a_friction() -> None:
    shipped = {i for kind in GROUND_KINDS[1:] for i in material_ids(kind)}
    assert len(shipped) == 32
    found = {i: ground_friction(i) for i in shipped} | {r.uid: ground_friction(r.uid) for r in ground_records()}
    assert len(found) == 32 + 288
    assert all(0.1 < friction <= 0.85 for friction in found.values())
    assert found["asphalt_new"] == 0.7
    assert found["slabs_grey"] == 0.65
    assert found["asphalt_wet"] == pytest.approx(0.72 * 0.7)
    assert found["zebra_new"] < found["asphalt_new"], "paint closes the pores"
    assert {r.uid: r.friction for r in ground_records()}.items() <= found.items()


def test_an_unknown_material_is_refused() -> None:
    with pytest.raises(ValidationError, match="'lava'"):
        ground_friction("lava")
    with pytest.raises(ValidationError, match="'road/lava'"):
        ground_friction("road/lava")
