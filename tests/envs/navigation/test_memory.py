"""The memory of an environment grows with the scenes of its bank, and no table is held twice."""

import dataclasses

import pytest
import warp as wp

from tests.support.held_bytes import held_bytes
from urbanverse_mjx.datatypes import SceneBank, bank_join
from urbanverse_mjx.envs import registry
from urbanverse_mjx.simulation.rendering.renderer import Renderer
from urbanverse_mjx.simulation.warp_engine import WarpEngine

#: Bytes that an environment holds for each byte of the bank's arrays, the bank included: 1.96 here (equal textures of
#: the copies are one; 3.34 where the render model, instances and distance fields stayed on the host). Baked light takes
#: 0.53 of them, because it grows with the area and these streets have few objects.
_MOST = 2.1


def _copies(bank: SceneBank, number: int) -> SceneBank:
    """The bank's scenes several times over."""
    ids = ([f"{i}_{name}" for name in bank.scene_ids] for i in range(number))
    return bank_join.join([dataclasses.replace(bank, meta={**bank.meta, "scene_ids": names}) for names in ids])


def _held(bank: SceneBank) -> int:
    """Bytes of an environment once it has stepped and drawn, the bank included."""
    overrides = {"preset": "fast", "impl": "warp", "scenes": "all", "vision": True, "vision_config.height": 4}
    overrides |= {"vision_config.width": 6, "observations.privileged_map": True}
    env = registry.load("CocoNav", config_overrides=overrides, bank=bank)
    engine, renderer = env.engine, env.renderer
    assert isinstance(engine, WarpEngine)
    assert isinstance(renderer, Renderer)
    device = wp.get_device("cpu")
    with wp.ScopedDevice(device):  # as the first step does
        kept = engine._batch(device, 1, 0), renderer._batch(device, 1)
    return held_bytes(env, kept)


@pytest.mark.extended
def test_memory_of_a_scene_is_little_more_than_its_arrays(small_bank: SceneBank) -> None:
    few, many = (_copies(small_bank, number) for number in (1, 4))
    sizes = [sum(a.nbytes for a in bank.arrays().values()) for bank in (few, many)]
    assert sizes == [held_bytes(few), held_bytes(many)]
    arrays = sizes[1] - sizes[0]
    held = _held(many) - _held(few)
    assert arrays < held <= _MOST * arrays
