"""Movable objects as free bodies of `scene.xml`: at rest in C MuJoCo, with their mass and inertia."""

import dataclasses

import mujoco
import numpy as np
import pytest

from tests.support.box_bank import street_regions
from tests.support.standing_objects import CUBE, LEANING, scene_of
from tests.support.toy_assets import TOY_SOURCE, few_episodes, toy_index, toy_layout
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, SceneLayout, Source
from urbanverse_mjx.pipeline import make_controller
from urbanverse_mjx.scene import CompiledScene, compile_scene
from urbanverse_mjx.scene.resting import resting

SIZE = (0.4, 0.6, 0.8)
#: Where boxes stand, m: one in the air, one on the ground, one 2 cm over it, and one on another.
PLACES = {"falling": (14.0, 6.0, 1.0), "box": (20.0, 6.0, 0.0), "lifted": (24.0, 6.0, 0.02), "upper": (20.0, 6.0, 0.8)}


def _layout() -> SceneLayout:
    objects = [
        GraphObject(name, "bollard", (x, y, 0.15 + z + SIZE[2] / 2), SIZE, 0.3) for name, (x, y, z) in PLACES.items()
    ]
    source = Source("hand", "Apache-2.0", "none", "none")
    return toy_layout(SceneGraph("toy_street", source, tuple(objects), tuple(street_regions())))


@pytest.fixture(scope="module")
def free(tmp_path_factory: pytest.TempPathFactory) -> CompiledScene:
    out = tmp_path_factory.mktemp("scene") / "toy"
    options = {"source": TOY_SOURCE, "freeze_unstable": True, "movable": True}
    with few_episodes():
        return compile_scene(_layout(), toy_index(), out, make_controller(), **options)


@pytest.fixture(scope="module")
def model(free: CompiledScene) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(free.folder / "scene.xml"))


@pytest.mark.extended
def test_free_bodies_rest_for_five_seconds_and_weigh_what_they_should(
    free: CompiledScene, model: mujoco.MjModel
) -> None:
    assert model.nv == 6 * 3
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bodies = np.unique(model.jnt_bodyid)
    assert {model.body(b).name for b in bodies} == set(PLACES) - {"falling"}
    start, turned = data.xipos[bodies].copy(), data.xmat[bodies].reshape(-1, 3, 3).copy()
    for _ in range(round(5.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        assert np.linalg.norm(data.xipos[bodies] - start, axis=1).max() < 0.01
    cosine = (np.einsum("nij,nij->n", data.xmat[bodies].reshape(-1, 3, 3), turned) - 1) / 2
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 1.0
    a, b, c = SIZE
    moments = np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2]) / 12
    for placed in free.layout.objects:
        body = model.body(placed.id)
        assert body.mass[0] == pytest.approx(placed.mass, rel=1e-5)
        if placed.id != "falling":
            np.testing.assert_allclose(np.sort(body.inertia), np.sort(placed.mass * moments), rtol=1e-4)


def test_the_file_says_what_was_laid_and_fixed(free: CompiledScene) -> None:
    assert free.metadata["bodies"] == {"free": 3, "laid": 1, "movable_fixed": 0, "unstable_fixed": 1}
    head = (free.folder / "scene.xml").read_text().splitlines()[1]
    assert "3 of 4 objects are free bodies (1 of them laid where they come to rest); 1 do not stay" in head


def test_maps_and_banks_have_the_places_of_the_layout(free: CompiledScene, model: mujoco.MjModel) -> None:
    """Objects are laid in `scene.xml` alone; only what would leave its place anyway is fixed for all."""
    saved = CompiledScene.load(free.folder)
    before = {o.id: o for o in _layout().objects}
    for placed in saved.layout.objects:
        assert placed == dataclasses.replace(before[placed.id], movable=placed.id != "falling")
        row = saved.geometry.object_ids.index(placed.id)
        np.testing.assert_array_equal(saved.geometry.object_position[row], placed.position)
        assert saved.geometry.object_movable[row] == placed.movable
        lower = placed.position[2] - model.body(placed.id).pos[2]
        assert lower == pytest.approx(0.02 if placed.id == "lifted" else 0.0, abs=2e-3)


def test_a_settling_object_is_laid_and_what_leaves_its_place_is_fixed_there() -> None:
    """The leaning post falls upon the third box, which would stay without it and is not moved."""
    scene = scene_of(CUBE, LEANING, CUBE, CUBE)
    scene.object_position[3, 2] += 0.02
    rest = resting(scene)
    assert rest.unstable == ("thing_1",)
    assert rest.laid == ("thing_3",)
    assert rest.geometry.object_movable.tolist() == [True, False, True, True]
    np.testing.assert_array_equal(rest.geometry.object_position[:3], scene.object_position[:3])
    np.testing.assert_allclose(rest.geometry.object_position[3], scene.object_position[0] + [3, 0, 0], atol=2e-3)
    assert scene.object_position[3, 2] == pytest.approx(scene.object_position[0, 2] + 0.02)


def test_without_movable_objects_nothing_is_tried() -> None:
    scene = scene_of(LEANING, movable=False)
    rest = resting(scene)
    assert (rest.laid, rest.unstable) == ((), ())
    assert not rest.geometry.object_movable.any()
