"""Baked light: against rays of C MuJoCo, light computed by hand, and committed pictures."""

import dataclasses
import pathlib
from typing import Any

import imageio.v3 as iio
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support import render_reference
from tests.support.agent_appearances import with_box_agents
from tests.support.box_bank import KERB, KERB_Y, box_bank
from tests.support.heard_progress import noted
from urbanverse_mjx.datatypes import AgentMotion, RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.progress import Progress
from urbanverse_mjx.robots.coco import make_coco
from urbanverse_mjx.simulation.rendering import light_bake, light_kernels
from urbanverse_mjx.simulation.rendering.renderer import Renderer

from . import render_cases as cases
from .test_renderer import GOLDEN

SUN = np.array([0.8, 0.36, 0.48])


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A cache folder of these tests alone, so that the light is baked here."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr(light_bake.process, "cache_dir", lambda *parts: folder.joinpath(*parts))
        yield folder


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco()


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(8, seed=0)


@pytest.fixture(scope="module")
def sunlit(bank: SceneBank) -> SceneBank:
    """The first street in grey, with the sun as the only light."""
    light = cases.with_light(cases.plain_bank(bank, 0.5), np.zeros((16, 32, 3)), SUN, np.full(3, 3.0))
    return _first(light)


def _first(bank: SceneBank) -> SceneBank:
    """The first scene alone."""
    arrays = {k: x[:1] for k, x in bank.arrays().items() if k.split("_")[0] in _SCENE_ARRAYS or k in _SCENE_ARRAYS}
    meta = {**bank.meta, **{k: bank.meta[k][:1] for k in ("scene_ids", "splits", "object_ids")}}
    return dataclasses.replace(bank, **arrays, meta=meta)


_SCENE_ARRAYS = ("inst", "prism", "grid_origin", "hull_grid", "map_kind", "map_origin", "episode", "slot", "scene")
_SCENE_ARRAYS += ("num_episodes",)


def _street(bank: SceneBank, robot: RobotSpec) -> render_reference.Street:
    street = render_reference.build_street(bank, 0, robot)
    street.data.qpos[2] = -100.0
    mujoco.mj_kinematics(street.model, street.data)
    return street


@pytest.mark.parametrize("sun", [SUN, np.array([0.0, 0.0, 1.0])])
def test_the_suns_disc_is_seen_in_four_directions_around_it(sun: np.ndarray) -> None:
    """At 0.7 of its radius, half a degree wide in all, a quarter turn from each other."""
    away = light_bake._disc(sun) - sun
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), 0.7 * np.radians(0.5329) / 2, rtol=2e-3)
    np.testing.assert_allclose(away @ sun, 0.0, atol=1e-9)
    cosines = away @ away.T / np.linalg.norm(away[0]) ** 2
    np.testing.assert_allclose(cosines, [[1, 0, -1, 0], [0, 1, 0, -1], [-1, 0, 1, 0], [0, -1, 0, 1]], atol=1e-9)


@pytest.mark.extended
def test_shadows_on_the_ground_are_where_mj_ray_finds_the_sun_hidden(sunlit: SceneBank, robot: RobotSpec) -> None:
    """Away from the edges of shadows, where a texel is partly lit, ground is black or as bright as open ground."""
    camera_position, fovy = np.array([20.0, 6.0, 7.0]), 1.2
    options = {"outputs": ("rgb", "depth", "object", "category"), "light": "baked"}
    image = cases.make_renderer(sunlit, None, **options).view(0, camera_position, cases.DOWN, fovy)
    image = {name: np.asarray(x) for name, x in image.items()}
    street = _street(sunlit, robot)
    names = np.array(sunlit.meta["categories"])
    ground = np.char.startswith(names, "ground:")[image["category"]] & (image["object"] >= 0)
    rays = render_reference.pixel_rays(fovy, cases.HEIGHT, cases.WIDTH)
    points = camera_position + rays * image["depth"][..., None] + [0.0, 0.0, 1e-3]
    near = [points + [x, y, 0.0] for x in (-0.15, 0.0, 0.15) for y in (-0.15, 0.0, 0.15)]
    free = np.array([[render_reference.is_free(street, p[i, j], SUN) for i, j in np.argwhere(ground)] for p in near])
    level = image["rgb"][ground].max(-1)
    lit, dark = free.all(0), ~free.any(0)
    assert min(lit.sum(), dark.sum()) > 25
    assert (level[dark] < 8).mean() > 0.99
    open_ground = cases.make_renderer(sunlit, None).view(0, camera_position, cases.DOWN, fovy)["rgb"]
    expected = cases.to_linear(open_ground)[ground][lit].max(-1)
    found = cases.to_linear(image["rgb"][ground])[lit].max(-1)
    exposure = np.median(found / expected)
    assert 1.0 < exposure < light_bake.BRIGHTEST, "the camera makes up for part of the shade"
    assert np.quantile(np.abs(found / expected / exposure - 1.0), 0.95) < 0.05


def _tower_bank(bank: SceneBank, sun: Any, irradiance: float) -> tuple[SceneBank, int]:
    """The street with one object alone, 2.5 m up in the air over its road; and the object's slot."""
    slot = int(np.flatnonzero(bank.slot_mesh[0] >= 0)[0])
    mesh, place = bank.slot_mesh.copy(), bank.slot_position.copy()
    mesh[:, : cases.OBJECTS] = -1
    mesh[0, slot] = bank.slot_mesh[0, slot]
    place[0, slot] = [20.0, 0.0, 0.0]
    even = cases.with_light(cases.plain_bank(bank, 0.5), np.ones((16, 32, 3)), sun, np.full(3, irradiance))
    return dataclasses.replace(even, slot_mesh=mesh, slot_position=place), slot


def test_the_sky_that_reaches_the_ground_is_what_mj_ray_leaves_of_it(sunlit: SceneBank, robot: RobotSpec) -> None:
    """Beside objects, and apart from them: 400 rays a place, whose light grows with their length."""
    light, street, rng = _bake(sunlit), _street(sunlit, robot), np.random.default_rng(0)
    height, angle = rng.uniform(size=400), rng.uniform(0.0, 2 * np.pi, 400)
    radius = np.sqrt(height)
    rays = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - height)], -1)
    objects = sunlit.slot_position[0, : cases.OBJECTS]
    places = objects[:, :2] + rng.uniform(-1.5, 1.5, (cases.OBJECTS, 2))
    out = np.abs(places[:, 1]) - KERB_Y
    # Of the flat pavement, without its ramps and ends.
    places = places[(out > 0.5) & (out < 3.5) & (np.abs(places[:, 0] - 30.0) > 3.0) & (places[:, 0] > 1.0)]
    shares, references = [], []
    for x, y in places:
        column, row = ((np.array([x, y]) - light.ground_origin) / light_bake.TEXEL).astype(int)
        shares.append(light.ground[column, row, 1] / 255.0)
        centre = light.ground_origin + (np.array([column, row]) + 0.5) * light_bake.TEXEL
        length = np.array([render_reference.distance(street, np.append(centre, KERB + 0.02), ray) for ray in rays])
        away = np.where(length < 0.0, 1.0, np.minimum(length / light_kernels.RANGE, 1.0))
        references.append(np.mean(light_kernels.DARKEST + (1.0 - light_kernels.DARKEST) * away))
    found, expected = np.array(shares), np.array(references)
    outside = expected > 0.3  # of objects
    found, expected = found[outside], expected[outside]
    error = found - expected
    assert len(error) > 20
    assert expected.min() < 0.6 < 0.97 < expected.max()
    assert np.abs(error).mean() < 0.03
    assert np.abs(error).max() < 0.2, "at the foot of a wall a texel is the mean of half a metre"


def test_objects_are_dark_in_the_shade_of_others_and_bright_in_the_open(sunlit: SceneBank) -> None:
    """A tower stands between a box and the sun, and another box apart from both."""
    slots, mesh, place = np.arange(3), sunlit.slot_mesh.copy(), sunlit.slot_position.copy()
    mesh[0, : cases.OBJECTS] = -1
    mesh[0, slots] = sunlit.slot_mesh[0, 0]
    vertices, faces = sunlit.mesh_vertices.copy(), slice(*sunlit.mesh_vertex_start[mesh[0, 0] :][:2])
    corners = vertices[faces] - vertices[faces].min(0)
    vertices[faces] = corners / corners.max(0)
    away = SUN[:2] / np.linalg.norm(SUN[:2])
    spots = {"shaded": [20.0, 0.0], "tower": np.array([20.0, 0.0]) + 2.0 * away, "open": [35.0, -2.0]}
    place[0, slots, :2], place[0, slots, 2] = np.array(list(spots.values())), 0.0
    # The tower is the same box many times over.
    pile = np.arange(3, 12)
    mesh[0, pile], place[0, pile] = mesh[0, 0], place[0, 1] + np.arange(1, 10)[:, None] * [0.0, 0.0, 1.0]
    quaternion = sunlit.slot_quaternion.copy()
    quaternion[0, : cases.OBJECTS] = [1.0, 0.0, 0.0, 0.0]
    bank = dataclasses.replace(
        sunlit, slot_mesh=mesh, slot_position=place, slot_quaternion=quaternion, mesh_vertices=vertices
    )
    level = {}
    for light in ("direct", "baked"):
        renderer = cases.make_renderer(bank, None, light=light, outputs=("rgb", "object"))
        for name, (x, y) in spots.items():
            image = renderer.view(0, np.array([x + 0.5, y + 0.5, 14.0]), cases.DOWN, 0.1)
            level[light, name] = cases.to_linear(image["rgb"])[16:20, 30:34].mean()
    top = level["baked", "open"] / level["direct", "open"]
    assert 1.0 <= top < light_bake.BRIGHTEST, "its top is as bright as before but for the exposure"
    assert level["baked", "tower"] == pytest.approx(level["baked", "open"], rel=0.03)
    assert level["baked", "shaded"] < 0.15 * level["baked", "open"]
    assert level["direct", "shaded"] == pytest.approx(level["direct", "open"], rel=0.03)


def _open_street(bank: SceneBank, sun: Any) -> SceneBank:
    """The ground of the street alone, in grey under an even sky."""
    even = cases.with_light(cases.plain_bank(bank, 0.4), np.full((16, 32, 3), 0.5), sun, np.full(3, 4.0))
    mesh = bank.slot_mesh.copy()
    mesh[:, : cases.OBJECTS] = -1
    return dataclasses.replace(even, slot_mesh=mesh)


@pytest.mark.extended
def test_a_camera_opens_under_a_dark_sky_as_it_does_in_a_dark_street(bank: SceneBank) -> None:
    """Without a sun a white surface in the open is as bright as the even sky: 0.65 and more is daylight."""
    level = {}
    for radiance in (0.2, 0.4, 0.65, 0.9):
        sky = np.full((16, 32, 3), radiance)
        street = _first(cases.with_light(cases.plain_bank(bank, 0.5), sky, SUN, np.zeros(3)))
        renderer = cases.make_renderer(street, None, light="baked", shading="matte")
        image = renderer.view(0, np.array([20.0, 6.0, 7.0]), cases.DOWN, 1.2)["rgb"]
        level[radiance] = cases.to_linear(image).mean()
    # It follows the sky from 0.65 on; below, it falls by the power 0.3 of the sky, and by itself once the factor is 2.
    assert level[0.9] / level[0.65] == pytest.approx(0.9 / 0.65, rel=0.03)
    assert level[0.4] / level[0.65] == pytest.approx((0.4 / 0.65) ** 0.3, rel=0.03)
    assert level[0.2] / level[0.65] == pytest.approx(0.2 / 0.65 * light_bake.BRIGHTEST, rel=0.03)


def _bake(bank: SceneBank) -> light_bake.BakedLight:
    found: list[light_bake.BakedLight] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(light_bake, "_write", lambda path, light: found.append(light))
        patch.setattr(light_bake, "_read", lambda path: None)
        Renderer(bank, None, 4, 4, light="baked", shading="matte").view(0, np.zeros(3), cases.DOWN, 1.0)
    return found[0]


def test_open_ground_is_as_bright_as_in_direct_light(sunlit: SceneBank) -> None:
    """An empty street has no shade, and the camera nothing to make up for."""
    bank = _open_street(sunlit, SUN)
    views = [
        cases.make_renderer(bank, None, **options).view(0, np.array([20.0, 0.0, 3.0]), cases.DOWN, 1.2)["rgb"]
        for options in ({}, {"light": "baked"})
    ]
    plain, baked = (np.asarray(x).astype(int) for x in views)
    inner = slice(4, -4), slice(14, -14)  # the road between its kerbs
    assert KERB_Y > 2.0
    assert np.abs(plain - baked)[inner].max() <= 2


@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_what_moves_darkens_the_ground_below_and_its_shadow(sunlit: SceneBank, robot: RobotSpec, shading: str) -> None:
    """A robot on open ground: the middle of its shadow lies where the sun's ray through its middle meets the ground."""
    bank = _open_street(sunlit, SUN)
    xpos, xquat = cases.bodies(robot, np.array([20.0, 0.0, 0.0, 0.4]))
    renderer = cases.make_renderer(bank, robot, light="baked", shading=shading, outputs=("rgb", "object"))
    camera = np.array([20.0, 0.0, 6.0])
    without = renderer.view(0, camera, cases.DOWN, 0.6)
    image = renderer.view(0, camera, cases.DOWN, 0.6, xpos, xquat)
    ground = np.asarray(image["object"]) >= 0
    before, after = (cases.to_linear(x["rgb"]).mean(-1) for x in (without, image))
    darker = np.where(ground, 1.0 - after / before, 0.0)
    rows, columns = np.nonzero(darker > 0.3)
    assert len(rows) > 10
    pixel = 2 * 6.0 * np.tan(0.3) / cases.HEIGHT
    middle = np.array([(columns.mean() + 0.5 - cases.WIDTH / 2), (cases.HEIGHT / 2 - rows.mean() - 0.5)]) * pixel
    away = -SUN[:2] / np.linalg.norm(SUN[:2])
    assert middle @ away > 0.1, "the shadow lies away from the sun"
    assert abs(middle @ [-away[1], away[0]]) < 0.15
    far = np.linalg.norm(np.indices(ground.shape).T - np.array([rows.mean(), columns.mean()]), axis=-1).T * pixel > 1.6
    assert np.abs(after - before)[far & ground].max() < 0.02, "nothing else changes"


def test_agents_shade_the_ground_where_they_are() -> None:
    bank = with_box_agents(box_bank(1, num_objects=1))
    names = bank.agents["kind"]
    appearances = [names.index("pedestrian"), names.index("car")]
    renderer = Renderer(bank, None, 36, 64, ("rgb", "object"), light="baked", shading="matte", agents=appearances)
    place = np.array([20.0, 6.0, KERB])

    def view(present: bool) -> tuple[np.ndarray, np.ndarray]:
        still = jnp.zeros((2, 3))
        at = jnp.asarray([place, [25.0, 6.0, KERB]], jnp.float32)
        agents = AgentMotion(at, jnp.zeros(2), still, jnp.zeros(2), jnp.array([present, False]))
        image = renderer.view(0, place + [0.0, 0.0, 6.0], cases.DOWN, 0.5, agents=agents)
        return cases.to_linear(image["rgb"]).mean(-1), np.asarray(image["object"])

    (before, _), (after, object_) = view(False), view(True)
    ground = object_ >= 0
    assert (ground & (after < 0.8 * before)).sum() > 5
    assert (after[ground] <= before[ground] + 1e-6).all()


@pytest.mark.extended
@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_baked_pictures_look_as_committed(bank: SceneBank, robot: RobotSpec, shading: str) -> None:
    """Eight frames; rounding may move an edge by a ray. `make_golden` beside this file draws them anew."""
    places = cases.make_places(bank, robot, 8)
    renderer = cases.make_renderer(bank, robot, shading=shading, light="baked")
    rgb = np.asarray(jax.vmap(renderer)(*places.inputs)["rgb"]).astype(int)
    golden = iio.imread(GOLDEN / f"{shading}_baked.png").reshape(8, cases.HEIGHT, cases.WIDTH, 3).astype(int)
    difference = np.abs(rgb - golden)
    assert difference.mean() < 0.5
    assert (difference > 8).mean() < 0.005
    direct = np.asarray(jax.vmap(cases.make_renderer(bank, robot, shading=shading))(*places.inputs)["rgb"])
    assert np.abs(direct.astype(int) - golden).mean() > 1.0


def test_light_is_baked_once_and_again_where_its_file_is_damaged(cache: pathlib.Path) -> None:
    bank = box_bank(1, seed=5)

    def draw() -> np.ndarray:
        renderer = cases.make_renderer(bank, None, light="baked")
        return np.asarray(renderer.view(0, np.array([20.0, 6.0, 7.0]), cases.DOWN, 1.2)["rgb"])

    before, notes = set((cache / "light").glob("*.npz")), list[tuple[str, str | None]]()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Progress, "task", noted(notes))
        first = draw()
    assert notes[0][0] == "computing shadows"  # in the log of commands whose users know no baking
    (path,) = set((cache / "light").glob("*.npz")) - before
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(light_bake.Baker, "_bake", None)
        np.testing.assert_array_equal(draw(), first)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.warns(UserWarning, match="bakes the scene again"):
        np.testing.assert_array_equal(draw(), first)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(light_bake.Baker, "_bake", None)
        np.testing.assert_array_equal(draw(), first)


def test_another_place_or_sun_is_another_light(cache: pathlib.Path) -> None:
    """Whatever changes the light changes the name of its file."""
    bank = box_bank(1, seed=5)

    def key(bank: SceneBank) -> str:
        made: list[str] = []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(light_bake, "_read", lambda path: made.append(path.stem) or _EMPTY)
            cases.make_renderer(bank, None, light="baked").view(0, np.zeros(3), cases.DOWN, 1.0)
        return made[0]

    place = bank.slot_position.copy()
    place[0, 0, 0] += 0.01
    vertices = bank.mesh_vertices.copy()
    vertices[bank.mesh_vertex_start[bank.slot_mesh[0, 0]]] += 0.01
    changed = [
        dataclasses.replace(bank, slot_position=place),
        dataclasses.replace(bank, mesh_vertices=vertices),
        dataclasses.replace(bank, scene_sky_yaw=bank.scene_sky_yaw + 0.1),
    ]
    keys = [key(bank), *map(key, changed)]
    assert len(set(keys)) == len(keys)
    assert key(dataclasses.replace(bank, material_roughness=bank.material_roughness * 0.5)) == keys[0]


def test_ground_around_a_scene_has_no_light_of_its_own(cache: pathlib.Path) -> None:
    """Courts and what lies below houses would count as dark ground."""
    bank = box_bank(1, seed=5)
    ground = [k for k, row in enumerate(bank.slot_category[0]) if bank.meta["categories"][row].startswith("ground:")]
    around = next(k for k in ground if bank.slot_mesh[0, k] >= 0)
    names = [list(row) for row in bank.meta["object_ids"]]
    names[0] += [""] * (around + 1 - len(names[0]))
    names[0][around] = f"{light_bake.AROUND}0/(0,0)"
    other = dataclasses.replace(bank, meta={**bank.meta, "object_ids": names})
    assert not light_bake.around_scenes(bank).any()
    assert np.flatnonzero(light_bake.around_scenes(other)[0]).tolist() == [around]

    def known(bank: SceneBank) -> int:
        """Number of texels with ground of their own."""
        counted: list[int] = []

        def exposure(self: light_bake.Baker, scene: int, shares: np.ndarray) -> np.ndarray:
            counted.append(len(shares))
            return np.ones((), np.float32)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(light_bake, "_read", lambda path: None)
            patch.setattr(light_bake.Baker, "_exposure", exposure)
            cases.make_renderer(bank, None, light="baked").view(0, np.zeros(3), cases.DOWN, 1.0)
        return counted[0]

    assert 0 <= known(other) < known(bank)


_EMPTY = light_bake.BakedLight(
    np.zeros(2, np.float32),
    np.full((2, 2, 2), 255, np.uint8),
    np.zeros(3, np.float32),
    np.zeros((2, 2, 2, 8), np.uint8),
    np.ones((), np.float32),
)


def test_a_light_that_is_none_is_refused(bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match=r"'bright'.*direct, baked"):
        Renderer(bank, None, 8, 8, light="bright")
