"""Images of the renderer against C MuJoCo's rays, light computed by hand, and committed images."""

import dataclasses
import pathlib

import imageio.v3 as iio
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support import figures, render_reference
from tests.support.box_bank import box_bank
from urbanverse_mjx.assets.appearances.skies import build_sky
from urbanverse_mjx.datatypes import CameraMount, RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.robots import load, make_coco
from urbanverse_mjx.simulation.rendering.renderer import OUTPUTS, ROBOT_LABEL, SKY_LABEL, Renderer
from urbanverse_mjx.simulation.rendering.settings import PBR_EXPOSURE

from . import render_cases as cases

GOLDEN = pathlib.Path(__file__).parent / "golden"


@pytest.fixture(scope="module")
def bank() -> SceneBank:
    return box_bank(8, seed=0)


@pytest.fixture(scope="module")
def robot() -> RobotSpec:
    return make_coco()


@pytest.fixture(scope="module")
def places(bank: SceneBank, robot: RobotSpec) -> cases.Places:
    return cases.make_places(bank, robot, 20)


@pytest.fixture(scope="module")
def frames(bank: SceneBank, robot: RobotSpec, places: cases.Places) -> dict[str, np.ndarray]:
    """20 robots in 20 places of 8 scenes, one batch, every output."""
    renderer = cases.make_renderer(bank, robot, outputs=OUTPUTS)
    return {name: np.asarray(x) for name, x in jax.jit(jax.vmap(renderer))(*places.inputs).items()}


@pytest.mark.extended
def test_shapes_and_types(frames: dict[str, np.ndarray]) -> None:
    found = {name: (x.shape[1:], x.dtype.name) for name, x in frames.items()}
    size = (cases.HEIGHT, cases.WIDTH)
    assert found == {
        "rgb": ((*size, 3), "uint8"), "depth": (size, "float32"), "category": (size, "int32"),
        "object": (size, "int32"), "normal": ((*size, 3), "float32"),
    }  # fmt: skip


def test_every_pixel_is_what_mj_ray_hits(frames: dict[str, np.ndarray], places: cases.Places) -> None:
    """46,080 rays: only edges may fall on either side; distances differ by at most 1e-4."""
    same = frames["object"] == places.slot
    assert same.mean() > 0.9998
    assert (places.slot >= 0).mean() > 0.3
    assert len(np.unique(places.slot)) > 40
    np.testing.assert_allclose(frames["depth"][same], places.depth[same], rtol=1e-4, atol=1e-4)
    assert ((frames["depth"] == 0) == (frames["object"] == SKY_LABEL)).all()


def test_category_is_that_of_the_slot(frames: dict[str, np.ndarray], bank: SceneBank, places: cases.Places) -> None:
    slot, scene = frames["object"], np.broadcast_to(places.scene[:, None, None], frames["object"].shape)
    expected = np.where(slot >= 0, bank.slot_category[scene, np.maximum(slot, 0)], slot)
    np.testing.assert_array_equal(frames["category"], expected)


def test_normals_are_unit_and_face_the_camera(
    frames: dict[str, np.ndarray], places: cases.Places, bank: SceneBank, robot: RobotSpec
) -> None:
    seen = frames["object"] >= 0
    length = np.linalg.norm(frames["normal"], axis=-1)
    np.testing.assert_allclose(length[seen], 1.0, atol=1e-4)
    assert (length[frames["object"] == SKY_LABEL] == 0).all()
    # A hit's own geometry: neighbouring depths of a flat piece of ground lie in the plane of its normal.
    level = (frames["object"] >= cases.OBJECTS) & (np.abs(frames["normal"][..., 2]) > 0.999)
    assert level.mean() > 0.2
    assert (frames["normal"][level][:, 2] > 0).all()


@pytest.mark.extended
@pytest.mark.parametrize("who", ["coco", "wheelchair"])
def test_free_camera_sees_the_robot_where_it_is(bank: SceneBank, who: str) -> None:
    """COCO, and a robot with parts a metre away from their body."""
    robot = make_coco() if who == "coco" else load(who)
    start = np.array([10.0, 6.5, 0.15, 0.7])
    street = render_reference.build_street(bank, 0, robot)
    render_reference.place(street, robot, start)
    camera_position, fovy = np.array([10.0, 6.5, 3.0]), np.radians(50.0)
    renderer = cases.make_renderer(bank, robot, outputs=("depth", "object"))
    image = renderer.view(0, camera_position, cases.DOWN, fovy, street.data.xpos, street.data.xquat)
    camera = street.model.cam(robot.camera).id
    street.model.cam_fovy[camera] = np.degrees(fovy)
    street.data.cam_xpos[camera], street.data.cam_xmat[camera] = camera_position, np.eye(3).ravel()
    depth, slot = render_reference.cast(street, robot.camera, cases.HEIGHT, cases.WIDTH)
    assert (slot == ROBOT_LABEL).sum() > 60
    same = np.asarray(image["object"]) == slot
    assert same.mean() > 0.998
    # MuJoCo's rays hit the same cylinders and meshes of the robot; its cylinders are round where ours have facets.
    off = 1e-4 if who == "coco" else 2e-3
    np.testing.assert_allclose(np.asarray(image["depth"])[same], depth[same], rtol=1e-4, atol=off)
    without = renderer.view(0, camera_position, cases.DOWN, fovy)
    assert not (np.asarray(without["object"]) == ROBOT_LABEL).any()


def test_a_robot_at_the_edges_of_the_image_is_seen_as_far_as_it_is_inside(bank: SceneBank, robot: RobotSpec) -> None:
    """From above, from beside it in all eight directions: its middle is outside the image, a part of it is not."""
    street = render_reference.build_street(bank, 0, robot)
    render_reference.place(street, robot, np.array([10.0, 6.5, 0.15, 0.7]))
    camera, fovy = street.model.cam(robot.camera).id, np.radians(50.0)
    street.model.cam_fovy[camera] = np.degrees(fovy)
    street.data.cam_xmat[camera] = np.identity(3).ravel()
    away = [(x, y) for x in (-2.3, 0.0, 2.3) for y in (-1.3, 0.0, 1.3)]
    above = np.array([(10.0 + x, 6.5 + y, 3.0) for x, y in away])
    renderer = cases.make_renderer(bank, robot, outputs=("depth", "object"))
    body = street.data.xpos.copy(), street.data.xquat.copy()
    image = jax.jit(jax.vmap(lambda place: renderer.view(0, place, cases.DOWN, fovy, *body)))(jnp.asarray(above))
    for k, place in enumerate(above):
        street.data.cam_xpos[camera] = place
        depth, slot = render_reference.cast(street, robot.camera, cases.HEIGHT, cases.WIDTH)
        found = np.asarray(image["object"][k])
        assert (slot == ROBOT_LABEL).sum() > 4, "it is in view"
        assert ((found == ROBOT_LABEL) == (slot == ROBOT_LABEL)).mean() > 0.998
        same = found == slot
        assert same.mean() > 0.995
        np.testing.assert_allclose(np.asarray(image["depth"][k])[same], depth[same], rtol=1e-4, atol=1e-4)


def test_a_camera_mounted_otherwise_sees_what_mujocos_does(bank: SceneBank, robot: RobotSpec) -> None:
    """On a robot that is turned, so that the frames of offset and rotation matter."""
    street = render_reference.build_street(bank, 0, robot)
    camera = street.model.cam(robot.camera).id
    offset, turn = np.array([0.03, -0.05, 0.1]), np.array([0.1, -0.2, 0.3])
    rotation = np.asarray(rotations.from_rotation_vector(turn), np.float64)
    street.model.cam_pos[camera] += offset
    street.model.cam_quat[camera] = rotations.product(street.model.cam_quat[camera], rotation)
    street.model.cam_fovy[camera] *= 1.2
    render_reference.place(street, robot, np.array([10.0, 6.5, 0.15, 0.7]))
    depth, slot = render_reference.cast(street, robot.camera, cases.HEIGHT, cases.WIDTH)
    renderer = cases.make_renderer(bank, robot, outputs=("depth", "object"))
    mount = CameraMount(*(jnp.asarray(x, jnp.float32) for x in (offset, rotation, 1.2)))
    inputs = 0, street.data.xpos, street.data.xquat
    image = {name: np.asarray(x) for name, x in renderer(*inputs, mount=mount).items()}
    same = image["object"] == slot
    assert same.mean() > 0.995
    np.testing.assert_allclose(image["depth"][same], depth[same], rtol=1e-3, atol=2e-3)
    assert (np.asarray(renderer(*inputs)["object"]) == slot).mean() < 0.9, "it matters here"


def test_empty_slots_are_not_seen(bank: SceneBank, robot: RobotSpec, places: cases.Places) -> None:
    gone = int(np.bincount(places.slot[0][places.slot[0] >= 0]).argmax())
    mesh = bank.slot_mesh.copy()
    mesh[places.scene[0], gone] = -1
    renderer = cases.make_renderer(dataclasses.replace(bank, slot_mesh=mesh), robot, outputs=("object",))
    image = np.asarray(renderer(*(x[0] for x in places.inputs))["object"])
    assert not (image == gone).any()
    assert (image[places.slot[0] != gone] == places.slot[0][places.slot[0] != gone]).mean() > 0.999


@pytest.mark.extended
@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_two_faces_in_one_place_are_seen_from_both_sides(
    bank: SceneBank, robot: RobotSpec, places: cases.Places, shading: str
) -> None:
    """Leaves and paint have a back: whichever face a ray hits, it is opaque."""
    cut = zip(bank.mesh_face_start[:-1], bank.mesh_face_start[1:], strict=True)
    faces = [half for a, b in cut for half in (bank.mesh_faces[a:b], bank.mesh_faces[a:b, ::-1])]
    doubled = dataclasses.replace(bank, mesh_faces=np.concatenate(faces), mesh_face_start=2 * bank.mesh_face_start)
    renderer = cases.make_renderer(doubled, robot, outputs=("rgb", "depth", "object"), shading=shading)
    image = jax.vmap(renderer)(*places.first(8))
    same = np.asarray(image["object"]) == places.slot[:8]
    assert same.mean() > 0.9998
    np.testing.assert_allclose(np.asarray(image["depth"])[same], places.depth[:8][same], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_brightness_of_grey_ground_under_the_sun_alone(bank: SceneBank, shading: str) -> None:
    """Radiance = albedo / pi · irradiance · cosine. Roughness 1 reflects a few per cent more (pbr)."""
    sun = np.array([0.0, 0.6, 0.8])
    light = cases.with_light(cases.plain_bank(bank, 0.5), np.zeros((16, 32, 3)), sun, [2.0, 1.0, 0.5])
    renderer = cases.make_renderer(light, None, outputs=("rgb", "object"), shading=shading)
    image = renderer.view(0, np.array([30.0, 0.0, 2.0]), cases.DOWN, 0.3)
    ground = np.asarray(image["object"]) >= cases.OBJECTS
    assert ground.mean() > 0.9
    colour = np.median(cases.to_linear(image["rgb"])[ground], axis=0)
    expected = 0.5 / np.pi * 0.8 * np.array([2.0, 1.0, 0.5])
    if shading == "pbr":
        # Khronos PBR Neutral subtracts 0.04 from colours above 0.08, to compensate for the reflection of a surface.
        expected = expected * PBR_EXPOSURE - 0.04
    np.testing.assert_allclose(colour, expected, rtol=0.025 if shading == "matte" else 0.15)


def test_brightness_of_grey_ground_under_an_even_sky(bank: SceneBank) -> None:
    """A sphere of radiance L lights a surface of reflectance a to a · L, wherever it faces."""
    light = cases.with_light(cases.plain_bank(bank, 0.4), np.full((16, 32, 3), 0.9), [0, 0, 1], np.zeros(3))
    renderer = cases.make_renderer(light, None, outputs=("rgb", "object"))
    image = renderer.view(0, np.array([2.0, 0.0, 1.0]), cases.AHEAD, 1.0)
    linear = cases.to_linear(image["rgb"])[np.asarray(image["object"]) >= 0]
    np.testing.assert_allclose(linear, 0.4 * 0.9, atol=0.012)


def test_textures_lie_as_their_uv_say(bank: SceneBank) -> None:
    """A texture of four colours on everything: each pixel has the colour that its own triangle's UV point at."""
    height, width = 64, 64
    quarters = np.array([[[0.8, 0.1, 0.1], [0.1, 0.8, 0.1]], [[0.1, 0.1, 0.8], [0.8, 0.8, 0.1]]])  # [lower row][right]
    pattern = np.kron(quarters, np.ones((height // 2, width // 2, 1)))
    srgb = np.where(pattern <= 0.0031308, pattern * 12.92, 1.055 * pattern ** (1 / 2.4) - 0.055)
    number = len(bank.texture_shape)
    painted = dataclasses.replace(
        bank,
        texture_data=np.tile(np.round(srgb * 255).astype(np.uint8).ravel(), number),
        texture_start=np.arange(number + 1, dtype=np.int64) * height * width * 3,
        texture_shape=np.tile(np.array([height, width, 3], np.int32), (number, 1)),
        material_rgba=np.ones_like(bank.material_rgba),
    )
    light = cases.with_light(painted, np.ones((16, 32, 3)), [0, 0, 1], np.zeros(3))
    renderer = cases.make_renderer(light, None, outputs=("rgb", "depth", "object"))
    camera_position, fovy = np.array([4.0, 6.0, 1.2]), 1.2
    image = {name: np.asarray(x) for name, x in renderer.view(0, camera_position, cases.AHEAD, fovy).items()}
    forward = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    rays = render_reference.pixel_rays(fovy, cases.HEIGHT, cases.WIDTH) @ forward.T
    near = (image["object"] >= 0) & (image["depth"] < 6.0)
    points = (camera_position + rays * image["depth"][..., None])[near]
    uv = np.array([cases.uv_at(bank, 0, s, p) for s, p in zip(image["object"][near], points, strict=True)])
    lower, right = np.floor(2 * (1 - uv[:, 1])).astype(int) % 2, np.floor(2 * uv[:, 0]).astype(int) % 2
    expected = 2 * lower + right
    seen = cases.to_linear(image["rgb"][near])
    nearest = np.abs(seen[:, None] - quarters.reshape(1, 4, 3)).max(-1).argmin(1)
    # Pixels on a border between two colours mix them.
    inside = (np.abs((2 * uv) % 1.0 - 0.5) < 0.3).all(1)
    assert np.bincount(expected[inside], minlength=4).min() > 20
    assert (nearest == expected)[inside].mean() > 0.98


def test_sky_turns_with_the_scene(bank: SceneBank) -> None:
    """A red patch at yaw 90° stands over +y, and over -x once the scene turns its sky by 90°."""
    radiance = np.full((16, 32, 3), 0.2)
    radiance[6:9, 23:26] = [5.0, 0.0, 0.0]  # column 24 of 32 is yaw (24.5 / 32 - 1/2) · 360° = 95.6°
    directions = {"+y": np.array([0.70710678, 0.70710678, 0.0, 0.0]), "-x": np.array([0.5, 0.5, 0.5, 0.5])}
    for yaw, expected in ((0.0, "+y"), (np.pi / 2, "-x")):
        turned = cases.with_light(bank, radiance, [0, 0, 1], np.zeros(3), yaw)
        renderer = cases.make_renderer(turned, None)
        reds = {
            name: int(np.asarray(renderer.view(0, np.array([30.0, 0.0, 40.0]), q, 0.8)["rgb"])[18, 32, 0])
            for name, q in directions.items()
        }
        assert reds[expected] > 200, (yaw, reds)
        assert min(reds.values()) < 150, (yaw, reds)


def test_the_sun_turns_with_the_scene(bank: SceneBank) -> None:
    """A low sun over +x lights what faces +x; turned by 180° it lights what faces -x."""
    grey, black = cases.plain_bank(bank, 0.5), np.zeros((16, 32, 3))
    lit = {}
    for yaw in (0.0, np.pi):
        light = cases.with_light(grey, black, [1.0, 0.0, 0.2], np.full(3, 2.0), yaw)
        image = cases.make_renderer(light, None, outputs=("rgb", "normal")).view(0, [1.0, 6.0, 0.8], cases.AHEAD, 1.2)
        wall = np.asarray(image["normal"])[..., 0] < -0.5  # faces the camera
        assert wall.sum() > 20
        lit[yaw] = np.asarray(image["rgb"])[wall].mean()
    assert lit[0.0] < 5
    assert lit[np.pi] > 60


def test_a_face_seen_from_behind_turns_its_normal_to_the_camera(bank: SceneBank) -> None:
    """The camera is inside an object, whose faces point away from it."""
    hull = bank.inst_hull[0, 0]
    inside = bank.inst_position[0, 0] + bank.inst_rotation[0, 0] @ bank.hull_box[hull, 0]
    fovy = 1.2
    image = cases.make_renderer(bank, None, outputs=("rgb", "normal")).view(0, inside, cases.DOWN, fovy)
    normal, rays = np.asarray(image["normal"]), render_reference.pixel_rays(fovy, cases.HEIGHT, cases.WIDTH)
    assert ((normal * rays).sum(-1) < -1e-3).all(), "whoever stands in a closed box sees no sky"
    assert normal[cases.HEIGHT // 2, cases.WIDTH // 2, 2] > 0.9, "its floor is below"


@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_shadows_are_where_mj_ray_finds_the_sun_hidden(bank: SceneBank, robot: RobotSpec, shading: str) -> None:
    """With the sun as the only light exactly the surfaces that face away or are in shadow are black."""
    sun = np.array([0.8, 0.36, 0.48])
    light = cases.with_light(cases.plain_bank(bank, 0.5), np.zeros((16, 32, 3)), sun, np.full(3, 3.0))
    camera_position, fovy = np.array([20.0, 6.0, 7.0]), 1.2
    renderer = cases.make_renderer(light, None, outputs=OUTPUTS, shadows=True, shading=shading)
    image = {name: np.asarray(x) for name, x in renderer.view(0, camera_position, cases.DOWN, fovy).items()}
    street = render_reference.build_street(bank, 0, robot)
    street.data.qpos[2] = -100.0
    mujoco.mj_kinematics(street.model, street.data)
    rays = render_reference.pixel_rays(fovy, cases.HEIGHT, cases.WIDTH)
    points = camera_position + rays * image["depth"][..., None] + 1e-3 * image["normal"]
    facing = image["normal"] @ sun > 0.02
    seen = (image["object"] >= 0) & (facing | (image["normal"] @ sun < -0.02))
    free = np.array([render_reference.is_free(street, points[i, j], sun) for i, j in np.ndindex(*seen.shape)])
    expected = facing & free.reshape(seen.shape)
    lit = image["rgb"].max(-1) > 20
    assert (facing & ~expected & seen).sum() > 40, "no shadow in the image"
    assert (lit == expected)[seen].mean() > 0.995


@pytest.mark.extended
@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_colours_respond_to_the_sky(bank: SceneBank, robot: RobotSpec, places: cases.Places, shading: str) -> None:
    """The same places are redder at sunset than at noon."""
    warmth = {}
    for name in ("clear_noon", "sunset"):
        sky = build_sky(name)
        light = cases.with_light(bank, sky.radiance, sky.sun_direction, sky.sun_irradiance)
        renderer = cases.make_renderer(light, robot, shading=shading)
        rgb = np.asarray(jax.vmap(renderer)(*places.first(8))["rgb"]).astype(float)
        assert rgb.std() > 20
        warmth[name] = rgb[..., 0].mean() / rgb[..., 2].mean()
    assert warmth["sunset"] > 1.15 * warmth["clear_noon"]


def test_more_rays_per_pixel_are_the_mean_of_a_finer_picture(bank: SceneBank, robot: RobotSpec) -> None:
    """Four rays a pixel agree with an image of twice the size, averaged in linear light."""
    camera_position = np.array([3.0, 5.5, 0.9])
    coarse = cases.make_renderer(bank, None, samples=2).view(0, camera_position, cases.AHEAD, 1.0)["rgb"]
    large = Renderer(bank, None, 2 * cases.HEIGHT, 2 * cases.WIDTH, shading="matte")
    fine = large.view(0, camera_position, cases.AHEAD, 1.0)["rgb"]
    mean = cases.to_linear(fine).reshape(cases.HEIGHT, 2, cases.WIDTH, 2, 3).mean((1, 3))
    error = np.abs(cases.to_linear(coarse) - mean)
    assert np.quantile(error, 0.95) < 0.02
    assert error.mean() < 0.005


def test_figures_of_pictures(frames: dict[str, np.ndarray]) -> None:
    """Of each place; rounding may move some edges by a ray."""
    found = {name: {str(k): x for k, x in enumerate(frame[:6])} for name, frame in frames.items()}
    figures.check("rendering/frames", found, tolerance=0.02)


@pytest.mark.extended
@pytest.mark.parametrize("shading", ["matte", "pbr"])
def test_pictures_look_as_committed(bank: SceneBank, robot: RobotSpec, places: cases.Places, shading: str) -> None:
    """Eight frames; rounding may move an edge by a ray. `make_golden` beside this file draws them anew."""
    renderer = cases.make_renderer(bank, robot, shading=shading, shadows=True)
    rgb = np.asarray(jax.vmap(renderer)(*places.first(8))["rgb"]).astype(int)
    golden = iio.imread(GOLDEN / f"{shading}.png").reshape(8, cases.HEIGHT, cases.WIDTH, 3).astype(int)
    difference = np.abs(rgb - golden)
    assert difference.mean() < 0.5
    assert (difference > 8).mean() < 0.005


def test_errors_say_what_to_do(bank: SceneBank, robot: RobotSpec) -> None:
    with pytest.raises(ValidationError, match=r"'colour'.*rgb, depth"):
        Renderer(bank, robot, 8, 8, outputs=("colour",))
    with pytest.raises(ValidationError, match=r"'rear'.*front_cam"):
        Renderer(bank, robot, 8, 8, camera="rear")
    with pytest.raises(ValidationError, match="at least one of each"):
        Renderer(bank, robot, 0, 8)
    with pytest.raises(ValidationError, match=r"'shiny'.*pbr, matte"):
        Renderer(bank, robot, 8, 8, shading="shiny")
    with pytest.raises(ValidationError, match="call `view`"):
        Renderer(bank, None, 8, 8)(0, np.zeros((1, 3)), np.zeros((1, 4)))
    with pytest.raises(ValidationError, match=r"jax\.vmap"):
        Renderer(bank, None, 8, 8).view(0, np.zeros((2, 3)), cases.DOWN, 1.0)


def test_appearances_change_colours_and_nothing_else(
    bank: SceneBank, robot: RobotSpec, places: cases.Places, frames: dict[str, np.ndarray]
) -> None:
    renderer = cases.make_renderer(bank, robot, outputs=("rgb", "depth", "object"), appearance=0.3)
    draw = jax.jit(jax.vmap(renderer))
    number = len(places.scene)
    plain, one, again, other = (
        {name: np.asarray(x) for name, x in draw(*places.inputs, np.full(number, appearance_seed, np.int32)).items()}
        for appearance_seed in (0, 5, 5, 6)
    )
    np.testing.assert_array_equal(plain["rgb"], frames["rgb"])
    np.testing.assert_array_equal(one["rgb"], again["rgb"])
    for name in ("depth", "object"):
        np.testing.assert_array_equal(plain[name], one[name])
    # Factors of 0.7 to 1.3 with 0.85 to 1.15 for a channel, on colour and on light.
    street = (plain["object"] >= 0) & (plain["rgb"].min(-1) > 40) & (plain["rgb"].max(-1) < 120)
    factor = cases.to_linear(one["rgb"][street]) / cases.to_linear(plain["rgb"][street])
    assert np.percentile(factor, 1) > (0.7 * 0.85) ** 2 * 0.8
    assert np.percentile(factor, 99) < (1.3 * 1.15) ** 2 * 1.2
    assert factor.std() > 0.05
    assert np.abs(one["rgb"].astype(int) - other["rgb"]).mean() > 3.0


def test_an_appearance_that_is_no_share_is_refused(bank: SceneBank) -> None:
    with pytest.raises(ValidationError, match="appearance"):
        Renderer(bank, None, 9, 16, appearance=1.0)
