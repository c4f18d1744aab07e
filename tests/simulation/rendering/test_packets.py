"""Rays that walk together on a CPU find what single rays find."""

from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank
from urbanverse_mjx.datatypes import Bodies
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering import street_batch, street_packets
from urbanverse_mjx.simulation.rendering.renderer import OUTPUTS, ROBOT_LABEL, Renderer

from . import render_cases as cases


# Neither side a multiple of a packet's; some packets hold fewer pixels than lanes.
@pytest.mark.extended
@pytest.mark.parametrize(("size", "samples"), [((37, 66), 1), ((18, 33), 3)])
def test_every_output_is_that_of_single_rays(
    size: tuple[int, int], samples: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    bank, robot = box_bank(8, seed=0), make_coco()
    places = cases.make_places(bank, robot, 16)
    # Two objects are elsewhere, right ahead of the robots; a third is not in the street.
    slots = np.flatnonzero(bank.slot_movable.all(0))[:2]
    root = int(mujoco.MjModel.from_xml_string(robot.mjcf).body(robot.root_body).id)
    ahead = places.xpos[:, root, None] + np.array([[2.0, 0.7, -0.2], [4.0, -1.0, 0.3]])
    turn = np.tile([0.8, 0.0, 0.6, 0.0], (16, 3, 1))
    index = np.tile(np.append(slots, -1), (16, 1)).astype(np.int32)
    position = np.concatenate([ahead, ahead[:, :1]], axis=1)
    index, position, turn = map(jnp.asarray, (index, position, turn))
    bodies = Bodies(index, position, turn, jnp.zeros((16, 3, 3)), jnp.zeros((16, 3, 3)), jnp.zeros((16, 3, 6)))
    # From behind, so that the robot is seen.
    behind = places.xpos[:, root] + np.array([-2.5, 0.0, 1.0])

    def draw() -> dict[str, np.ndarray]:
        renderer = Renderer(bank, robot, *size, OUTPUTS, shading="matte", samples=samples, bodies=3, threads=2)

        def view(scene: Any, position: Any, xpos: Any, xquat: Any, bodies: Bodies) -> dict[str, jax.Array]:
            return renderer.view(scene, position, cases.AHEAD, 1.2, xpos, xquat, bodies=bodies)

        drawn = jax.jit(jax.vmap(view))(places.scene, behind, places.xpos, places.xquat, bodies)
        return {name: np.asarray(x) for name, x in drawn.items()}

    together = draw()
    assert (together["object"] == ROBOT_LABEL).any(axis=(1, 2)).sum() > 12
    assert np.isin(slots, together["object"]).all()
    with monkeypatch.context() as single:
        single.setattr(street_packets, "build_cast_kernel", lambda moved: None)
        alone = draw()
    same = together["object"] == alone["object"]
    assert same.mean() > 0.9995
    np.testing.assert_allclose(together["depth"][same], alone["depth"][same], rtol=1e-4, atol=1e-4)
    assert (np.abs(together["normal"] - alone["normal"]).max(-1) > 1e-3).mean() < 1e-3
    assert (np.abs(together["rgb"].astype(int) - alone["rgb"]).max(-1) > 2).mean() < 1e-3
    assert (together["category"] == alone["category"])[same].all()


@pytest.mark.extended
def test_a_small_piece_is_drawn_in_parts_as_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hits are kept for a few worlds at once; each world has its own."""
    bank, robot = box_bank(8, seed=0), make_coco()
    places = cases.make_places(bank, robot, 10)
    whole = np.asarray(jax.jit(jax.vmap(cases.make_renderer(bank, robot)))(*places.inputs)["rgb"])
    monkeypatch.setattr(street_batch, "_RAYS", 2 * cases.HEIGHT * cases.WIDTH)
    parts = np.asarray(jax.jit(jax.vmap(cases.make_renderer(bank, robot)))(*places.inputs)["rgb"])
    np.testing.assert_array_equal(parts, whole)
