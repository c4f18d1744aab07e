"""Pixels that objects would have alone, against MuJoCo's rays to one geom at a time and boxes in closed form."""

import dataclasses

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.simulation.rendering.test_render_agents import CAMERA_POSITION, standing
from tests.simulation.rendering.test_render_movable import homes
from tests.support import render_reference
from tests.support.agent_appearances import BOXES, with_box_agents
from tests.support.box_bank import KERB, box_bank
from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering.renderer import AGENT_LABEL, Renderer
from urbanverse_mjx.simulation.rendering.settings import Scan

from . import render_cases as cases

OUTPUTS = ("object", "coverage")


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(2, seed=0)


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco()


@pytest.mark.extended
def test_it_is_what_mujocos_rays_meet_of_each_object_alone(bank: SceneBank, robot: RobotSpec) -> None:
    """Robots in all scenes; some objects are hidden in part, and none that is not seen is counted."""
    places = cases.make_places(bank, robot, 4, seed=3)
    renderer = cases.make_renderer(bank, robot, outputs=OUTPUTS)
    found = {name: np.asarray(x) for name, x in jax.jit(jax.vmap(renderer))(*places.inputs).items()}
    slots, hidden, checked = bank.slot_mesh.shape[1], 0, 0
    assert found["coverage"].shape == (4, slots)
    for k, scene in enumerate(places.scene):
        shown = {int(n) for n in np.unique(found["object"][k]) if n >= 0}
        ground = {
            n for n in range(slots) if bank.meta["categories"][bank.slot_category[scene, n]].startswith("ground:")
        }
        counted = sorted(shown - ground)
        assert np.flatnonzero(found["coverage"][k]).tolist() == counted
        street = render_reference.build_street(bank, scene, robot)
        alone = pixels_alone(street, robot, places.xpos[k], places.xquat[k], counted)
        for slot, wanted in zip(counted, alone, strict=True):
            pixels, covered = int((found["object"][k] == slot).sum()), int(found["coverage"][k, slot])
            assert pixels <= covered
            # Rays along an edge may pass on either side.
            assert covered == pytest.approx(wanted, abs=2 + 0.01 * wanted)
            hidden += pixels < 0.8 * covered
            checked += 1
    assert checked > 15
    assert hidden >= 3


def pixels_alone(
    street: render_reference.Street, robot: RobotSpec, xpos: np.ndarray, xquat: np.ndarray, slots: list[int]
) -> list[int]:
    """How many rays of the camera the geom of each slot stops, by `mj_rayMesh`."""
    model, data = street.model, street.data
    mujoco.mj_kinematics(model, data)
    camera = model.camera(robot.camera)
    turn, both, body = np.zeros(9), np.zeros(4), int(camera.bodyid[0])
    mujoco.mju_quat2Mat(turn, xquat[body].astype(float))
    at = xpos[body] + turn.reshape(3, 3) @ camera.pos
    mujoco.mju_mulQuat(both, xquat[body].astype(float), camera.quat)
    mujoco.mju_quat2Mat(turn, both)
    rays = render_reference.pixel_rays(np.radians(camera.fovy[0]), cases.HEIGHT, cases.WIDTH) @ turn.reshape(3, 3).T
    geoms = [int(np.flatnonzero(street.slot == slot)[0]) for slot in slots]
    return [
        sum(mujoco.mj_rayMesh(model, data, geom, at, ray, None) >= 0 for ray in rays.reshape(-1, 3)) for geom in geoms
    ]


def slab(low: np.ndarray, high: np.ndarray, rays: np.ndarray) -> int:
    """How many rays from the camera meet a box."""
    with np.errstate(divide="ignore"):
        a, b = (low - CAMERA_POSITION) / rays, (high - CAMERA_POSITION) / rays
    near, far = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
    return int(((near <= far) & (near > 0)).sum())


@pytest.mark.extended
def test_a_car_behind_a_person_counts_whole(robot: RobotSpec) -> None:
    bank = with_box_agents(box_bank(1, num_objects=1))
    names = bank.agents["kind"]
    appearances = [names.index("pedestrian"), names.index("car")]
    renderer = Renderer(bank, robot, cases.HEIGHT, cases.WIDTH, outputs=OUTPUTS, agents=appearances)
    agents = standing((24.0, 6.1, 0.0, True), (29.0, 6.0, 0.0, True))
    image = jax.jit(lambda: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9, agents=agents))()
    slots = bank.slot_mesh.shape[1]
    found, labels = np.asarray(image["coverage"])[slots:], np.asarray(image["object"])
    forward = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    rays = render_reference.pixel_rays(0.9, cases.HEIGHT, cases.WIDTH) @ forward.T
    for k, (kind, x, y) in enumerate((("pedestrian", 24.0, 6.1), ("car", 29.0, 6.0))):
        size, centre = np.array(BOXES[kind]), np.array([x, y, KERB])
        low = centre - size * [0.5, 0.5, 0.0]
        assert found[k] == pytest.approx(slab(low, low + size, rays), abs=1)
    seen = [(labels == AGENT_LABEL - k).sum() for k in range(2)]
    assert seen[0] == found[0]
    assert 0 < seen[1] < 0.9 * found[1]
    # An agent that is not there is not counted.
    absent = standing((24.0, 6.1, 0.0, False), (29.0, 6.0, 0.0, True))
    image = jax.jit(lambda: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9, agents=absent))()
    assert np.asarray(image["coverage"])[slots:].tolist() == [0, found[1]]
    # Each world has its own: elsewhere in the third, where nobody is where the others of the first stand.
    aside = standing((24.0, 7.5, 0.0, True), (35.0, 4.0, 0.7, True))
    worlds = jax.tree.map(lambda *x: jnp.stack(x), absent, agents, aside)
    view = jax.jit(jax.vmap(lambda a: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9, agents=a)["coverage"]))
    alone = jax.jit(lambda: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9, agents=aside)["coverage"])()
    counted = np.asarray(view(worlds))[:, slots:]
    assert counted.tolist() == [[0, found[1]], found.tolist(), np.asarray(alone)[slots:].tolist()]
    assert (counted[2] > 5).all()
    assert (np.abs(counted[2] - counted[1]) > 5).all()


@pytest.mark.extended
def test_a_pushed_object_counts_where_it_is(bank: SceneBank) -> None:
    """A camera beside it; the other bank has it there from the beginning."""
    slots, home = homes(bank)
    moving = Renderer(bank, None, 54, 96, OUTPUTS, bodies=3)
    pushed = home._replace(position=home.position.at[0].add(jnp.array([0.5, -1.5, 0.8])))
    place = bank.slot_position.copy()
    place[0, slots[:2]] = pushed.position[:2]
    other = Renderer(dataclasses.replace(bank, slot_position=place), None, 54, 96, OUTPUTS)
    camera = np.array(pushed.position[0]) + [-4.0, 0.0, 0.6]
    found = jax.jit(lambda b: moving.view(0, camera, cases.AHEAD, 1.2, bodies=b)["coverage"])
    wanted = np.asarray(other.view(0, camera, cases.AHEAD, 1.2)["coverage"])
    np.testing.assert_allclose(found(pushed), wanted, atol=1)
    assert wanted[slots[0]] > 20
    assert np.asarray(found(home))[slots[0]] != wanted[slots[0]]
    worlds = jax.tree.map(lambda *x: jnp.stack(x), home, pushed, home)
    np.testing.assert_array_equal(jax.vmap(found)(worlds), [found(home), found(pushed), found(home)])


def test_it_needs_labels_and_a_camera(bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match="found 'coverage' without 'object'; needed both"):
        cases.make_renderer(bank, None, outputs=("coverage",))
    with pytest.raises(ValidationError, match="scan"):
        cases.make_renderer(bank, None, outputs=OUTPUTS, scan=Scan(0.1, -0.1, 10.0))
