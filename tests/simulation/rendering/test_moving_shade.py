"""The shade of what moves: an ellipsoid as wide as its box, compared with the geometry of a turned ball."""

# Warp checks the types of kernels when it compiles them.
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportArgumentType=false

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
import warp as wp
from scipy.spatial.transform import Rotation

from urbanverse_mjx.simulation.rendering.model import _robot_box
from urbanverse_mjx.simulation.rendering.street_kernels import Street, Views, module_options
from urbanverse_mjx.simulation.rendering.street_light import REACH, SHADE, moving_shade, place_shades

Shade = Callable[[np.ndarray, np.ndarray], np.ndarray]
#: m, half sizes of the box of the first body and of the second, and the middle of the first one in its frame.
HALF, SMALL, CENTRE = np.array([0.5, 0.3, 0.8]), np.array([0.2, 0.2, 0.2]), np.array([0.1, 0.0, 0.4])
PLACE, TURN = np.array([3.0, -2.0, 0.1]), Rotation.from_euler("zyx", [0.9, 0.2, -0.3])
MIDDLE = PLACE + TURN.apply(CENTRE)
SECOND = np.array([8.0, 4.0, 0.2])
SUN = np.array([0.48, -0.36, 0.8])


@wp.kernel(module="unique", module_options=module_options(), enable_backward=False)
def shade_at(
    street: Street, views: Views, world: int, points: wp.array[wp.vec3], sun: wp.vec3, left: wp.array[wp.vec2]
):
    i = wp.tid()
    left[i] = moving_shade(street, views, world, points[i], sun)


def shade_of(camera: np.ndarray, second: np.ndarray = SECOND) -> Shade:
    """shade(points (n, 3), sun) -> (n, 2), what is left of sun and sky, in the second of two worlds; nothing is known
    of the bodies of the first one."""
    street, views = Street(), Views()
    street.num_shades, street.num_bodies = 2, 0
    body = wp.array([1, 2], dtype=int)
    boxes = wp.array(np.asarray([[CENTRE, HALF], [np.zeros(3), SMALL]], np.float32), dtype=wp.vec3)
    x, y, z, w = TURN.as_quat()
    place = np.asarray([np.zeros(3), PLACE, second], np.float32)
    turn = np.asarray([[1, 0, 0, 0], [w, x, y, z], [1, 0, 0, 0]], np.float32)
    xpos = wp.array(np.stack([place * np.nan, place]), dtype=wp.vec3)
    xquat = wp.array(np.stack([turn, turn]), dtype=wp.vec4)
    camera_position = wp.array(np.asarray([camera, camera], np.float32), dtype=wp.vec3)
    shades = wp.zeros(2 * 2 * SHADE, dtype=wp.vec4)
    shaded = wp.zeros(2 * 3, dtype=int)
    none = wp.zeros((1, 2), dtype=wp.vec3)
    views.shades, views.shaded = shades.ptr, shaded.ptr
    wp.launch(place_shades, 2, inputs=[street, views, body, boxes, none, xpos, xquat, camera_position, shades, shaded])
    assert shaded.numpy()[[0, 3]].tolist() == [0, sum(np.linalg.norm(p - camera) < REACH for p in (PLACE, second))]

    def shade(points: np.ndarray, sun: np.ndarray) -> np.ndarray:
        left = wp.zeros(len(points), dtype=wp.vec2)
        at = wp.array(points.astype(np.float32), dtype=wp.vec3)
        wp.launch(shade_at, len(points), inputs=[street, views, 1, at, wp.vec3(*sun), left])
        assert shades.ptr
        assert shaded.ptr
        return left.numpy()

    return shade


@pytest.fixture(scope="module")
def shade() -> Shade:
    return shade_of(PLACE)


def on_sphere(number: int) -> np.ndarray:
    points = np.random.default_rng(0).normal(size=(number, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def outward(direction: np.ndarray, radii: np.ndarray | float) -> np.ndarray:
    """Points so many radii of the first ellipsoid from its middle."""
    return MIDDLE + TURN.apply(direction * np.reshape(radii, (-1, 1)) * HALF)


def test_the_sky_is_hidden_by_how_near_a_body_is(shade: Shade) -> None:
    """A quarter is left at the outline, all of it from 1.9 radii on; nothing depends on the direction."""
    direction = on_sphere(200)
    night = np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(shade(outward(direction, 1.0), night)[:, 1], 0.25, atol=1e-4)
    np.testing.assert_allclose(shade(outward(direction, 0.5), night)[:, 1], 0.25, atol=1e-4)
    np.testing.assert_allclose(shade(outward(direction, 1.9), night)[:, 1], 1.0, atol=1e-4)
    half = np.sqrt(3.6 - 2.6 / 2)  # half as near
    np.testing.assert_allclose(shade(outward(direction, half), night)[:, 1], 1 - 0.75 / 4, atol=1e-4)


def test_the_sun_is_hidden_where_its_ray_passes_the_body(shade: Shade) -> None:
    """The ray's distance from the middle in the frame in which the body is a unit ball, by hand for each point."""
    rng = np.random.default_rng(1)
    points = MIDDLE + rng.uniform(-1.6, 1.6, (4000, 3))
    local = TURN.inv().apply(points - MIDDLE) / HALF
    toward = TURN.inv().apply(SUN) / HALF
    steps = np.linspace(0.0, 12.0, 6001)  # m along the ray
    nearest = np.array([np.linalg.norm(p + steps[:, None] * toward, axis=1).min() for p in local])
    left = shade(points, SUN)[:, 0]
    assert (left[nearest < 0.7] < 1e-3).all()
    assert (left[nearest > 1.2] > 1 - 1e-3).all()
    assert min((nearest < 0.7).sum(), ((nearest > 0.7) & (nearest < 1.2)).sum()) > 30
    expected = 1.0 - np.clip((1.2**2 - nearest**2) / (1.2**2 - 0.7**2), 0.0, 1.0)
    np.testing.assert_allclose(left, expected, atol=2e-3)
    behind = outward(-SUN[None], 0.0) - 20.0 * SUN
    np.testing.assert_allclose(shade(behind, SUN), [[0.0, 1.0]], atol=1e-4)
    np.testing.assert_allclose(shade(behind + 40.0 * SUN, SUN), [[1.0, 1.0]], atol=1e-4)


def test_what_two_bodies_leave_is_multiplied_and_what_is_far_from_the_camera_hides_nothing() -> None:
    both, one = shade_of(PLACE, MIDDLE), shade_of(PLACE)
    near = outward(on_sphere(50), 1.3)
    small = shade_of(PLACE, np.array([3.0, 9.0, 0.0]))  # elsewhere
    alone = shade_of(PLACE + [0.0, 0.0, 200.0], MIDDLE + [0.0, 0.0, 200.0])
    first, second = one(near, SUN), alone(near + [0.0, 0.0, 200.0], SUN)
    np.testing.assert_allclose(small(near, SUN), first, atol=1e-6)
    np.testing.assert_allclose(both(near, SUN), first * second, atol=1e-3)
    away = shade_of(PLACE, PLACE + [REACH + 0.1, 0.0, 0.0])
    np.testing.assert_array_equal(away((PLACE + [REACH + 0.1, 0.0, 0.0])[None], SUN), [[1.0, 1.0]])


#: A body in some pose with a box, a smaller one turned by 45 degrees, and the mast of a flag.
ROBOT = """<mujoco><worldbody><body pos="1 2 0.5" euler="0 0 90"><freejoint/>
  <geom name="hull" type="box" size="0.3 0.2 0.1" pos="0 0 0.1"/>
  <geom name="head" type="box" size="0.1 0.1 0.1" pos="0.4 0 0.3" euler="0 0 45"/>
  <geom name="mast" type="cylinder" size="0.004 0.6" pos="-0.2 0 {mast}"/>
  <body pos="0 0 0"><geom name="wheel" type="sphere" size="0.05" pos="0.1 -0.25 0"/></body>
</body></worldbody></mujoco>"""


@pytest.mark.parametrize(("mast", "bottom"), [(0.8, -0.05), (0.4, -0.2)])
def test_the_box_of_a_robot_holds_all_but_how_high_a_thin_mast_is(mast: float, bottom: float) -> None:
    model = mujoco.MjModel.from_xml_string(ROBOT.format(mast=mast))
    body, (centre, half) = _robot_box(model, list(range(model.ngeom)))
    assert body == 1
    np.testing.assert_allclose(centre - half, [-0.3, -0.3, bottom], atol=1e-6)
    np.testing.assert_allclose(centre + half, [0.4 + 0.1 * 2**0.5, 0.2, 0.4], atol=1e-6)


def test_a_robot_of_thin_parts_alone_is_as_large_as_they_are() -> None:
    model = mujoco.MjModel.from_xml_string(ROBOT.format(mast=0.8))
    _, (centre, half) = _robot_box(model, [model.geom("mast").id])
    np.testing.assert_allclose(centre - half, [-0.204, -0.004, 0.2], atol=1e-6)
    np.testing.assert_allclose(centre + half, [-0.196, 0.004, 1.4], atol=1e-6)
