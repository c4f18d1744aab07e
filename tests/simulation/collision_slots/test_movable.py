"""Objects that can be pushed: runs against C MuJoCo's free bodies, sleep, and no effect without such objects."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support import pushing
from tests.support.box_bank import box_bank
from tests.support.pushing import MovableObject, Push
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.geometry import SceneGeometry
from urbanverse_mjx.scene.mjcf import scene_mjcf
from urbanverse_mjx.simulation.collision_slots import body_contact, body_slots, body_table
from urbanverse_mjx.simulation.collision_slots.body_slots import Sizes
from urbanverse_mjx.simulation.engines import make_engine

SIZES = Sizes(bodies=3, awake=2, hulls=4)
ENGINES = [pytest.param("jax", marks=pytest.mark.slow), "warp"]


def scooter() -> list[np.ndarray]:
    """A scooter of four convex parts, 1.0 m long and 1.1 m high, that stands on its deck."""
    deck = pushing.box(1.0, 0.16, 0.12)
    column = pushing.box(0.06, 0.06, 1.0) + np.array([0.42, 0.0, 0.1], np.float32)
    bar = pushing.box(0.06, 0.5, 0.05) + np.array([0.42, 0.0, 1.08], np.float32)
    guard = pushing.box(0.2, 0.1, 0.15) + np.array([-0.4, 0.0, 0.1], np.float32)
    return [deck, column, bar, guard]


#: What is pushed, and the speed (m/s) at which the robot drives for 4.4 s.
CASES: dict[str, tuple[tuple[MovableObject, ...], float]] = {
    "a box of 10 kg": ((MovableObject([pushing.box(0.5, 0.5, 0.4)], (1.2, 0.02, 0.0), 0.1, 10.0, 0.5),), 1.0),
    "a scooter": ((MovableObject(scooter(), (1.3, 0.0, 0.0), np.pi / 2, 20.0, 0.6),), 0.8),
    "one box into another": (
        (
            MovableObject([pushing.box(0.5, 0.4, 0.5)], (1.2, 0.0, 0.0), 0.0, 10.0, 0.5),
            MovableObject([pushing.box(0.4, 0.5, 0.6)], (2.1, 0.05, 0.0), 0.3, 12.0, 0.5),
        ),
        1.0,
    ),
}
NUM_STEPS = 22


@functools.cache
def scene_of(name: str) -> SceneGeometry:
    return pushing.object_scene(CASES[name][0])


def commands(name: str) -> np.ndarray:
    return np.tile([CASES[name][1], 0.0], (NUM_STEPS, 1))


@functools.cache
def in_c_mujoco(name: str) -> Push:
    return pushing.push_reference(scene_of(name), make_coco("differential"), commands(name))


@functools.cache
def in_engine(name: str, impl: str) -> tuple[Push, Any]:
    return pushing.push_engine(scene_of(name), make_coco("differential"), commands(name), impl, SIZES)


#: m to the left at which the robot of each C MuJoCo run starts: first as the engines', then up to 1 mm aside.
ASIDES = (0.0, *(side * k * 1e-4 for k in range(1, 11) for side in (1.0, -1.0)))


@functools.cache
def runs_of_c_mujoco(name: str) -> np.ndarray:
    """(21, T, 3) m: the first object's places in C MuJoCo, a run for each of `ASIDES`."""
    robot = make_coco("differential")
    return np.array([pushing.push_reference(scene_of(name), robot, commands(name), a).places[:, 0] for a in ASIDES])


@pytest.mark.extended
@pytest.mark.parametrize("impl", ENGINES)
def test_a_box_is_pushed_two_metres_as_in_c_mujoco(impl: str) -> None:
    """Before the touch the runs are equal, 0.2 s after it the box is within 1 cm. After 2 m its distance is within 10
    %.

    The lateral slip differs between runs of C MuJoCo: where the robot starts 0.1 mm aside, the box is 6 to 20 mm
    elsewhere 0.2 s after the touch (it sticks or slips on its edges), and up to 63 cm after 2 m for 1 mm. So its path
    is compared with those of 21 runs whose robots start up to 1 mm aside: it is always within 20 cm of one of them.
    Each of these is within 11 cm of another (docs/decisions/movable.md)."""
    reference, (found, state) = in_c_mujoco("a box of 10 kg"), in_engine("a box of 10 kg", impl)
    route, ours = (np.linalg.norm(x.places[:, 0, :2] - x.places[0, 0, :2], axis=-1) for x in (reference, found))
    assert route[-1] > 2.0
    onset = int(reference.hit.argmax())
    assert int(found.hit.argmax()) == onset
    np.testing.assert_allclose(found.robot[:onset], reference.robot[:onset], atol=1e-3)
    np.testing.assert_allclose(found.places[:onset], reference.places[:onset], atol=2e-3)
    np.testing.assert_allclose(found.places[onset], reference.places[onset], atol=1e-2)
    two = int((route > 2.0).argmax())
    assert abs(ours[two] - route[two]) < 0.1 * route[two]
    apart = np.linalg.norm(runs_of_c_mujoco("a box of 10 kg") - found.places[:, 0], axis=-1)[:, : two + 1].max(1)
    assert apart.min() < 0.2, apart
    assert (found.obj[onset:] == 0).all()
    assert pushing.tilt(found.quaternions[: two + 1]).max() < np.radians(15.0)
    assert int(state.slot_overflow) == 0


@pytest.mark.parametrize("impl", ENGINES)
def test_a_scooter_topples_as_in_c_mujoco(impl: str) -> None:
    """It stands, is hit, and lies within one control step (0.2 s) of C MuJoCo's, flat to 5 degrees and within 25 cm."""
    reference, (found, _) = in_c_mujoco("a scooter"), in_engine("a scooter", impl)
    leans, other = (pushing.tilt(x.quaternions[:, 0]) for x in (found, reference))
    onset = int(reference.hit.argmax())
    assert reference.hit.any()
    assert int(found.hit.argmax()) == onset
    assert leans[:onset].max(initial=0.0) < np.radians(1.0), "it stands until it is hit"
    assert other[-1] > np.radians(60.0)
    fell, theirs = (int((x > np.radians(45.0)).argmax()) for x in (leans, other))
    assert abs(fell - theirs) <= 1
    assert abs(leans[-1] - other[-1]) < np.radians(5.0)
    assert np.linalg.norm(found.places[-1, 0] - reference.places[-1, 0]) < 0.25


@pytest.mark.parametrize("impl", ENGINES)
def test_bodies_push_each_other(impl: str) -> None:
    """The second box is reached by the first one alone, in the same control step or the next, and moves as far."""
    reference, (found, _) = in_c_mujoco("one box into another"), in_engine("one box into another", impl)
    moved, theirs = (np.linalg.norm(x.places[:, 1, :2] - x.places[0, 1, :2], axis=-1) for x in (found, reference))
    assert theirs[-1] > 0.5
    assert abs(int((moved > 0.01).argmax()) - int((theirs > 0.01).argmax())) <= 1
    assert abs(moved[-1] - theirs[-1]) < 0.2
    gap = found.places[-1, 1, 0] - found.places[-1, 0, 0]
    assert gap > 0.4, "boxes of 0.5 and 0.4 m do not stand in each other"


@pytest.mark.mjx
@pytest.mark.slow
def test_both_engines_do_the_same() -> None:
    """To 1 mm to the end of the control step in which they touch, and for 0.6 s more no farther from each other than
    runs of C MuJoCo whose robots start 0.1 mm to the left, in the middle and to the right (2, 5 and 7 cm)."""
    (first, _), (second, _) = (in_engine("a box of 10 kg", impl) for impl in ("jax", "warp"))
    onset = int(first.hit.argmax())
    np.testing.assert_allclose(first.places[: onset + 1], second.places[: onset + 1], atol=1e-3)
    np.testing.assert_allclose(first.robot[: onset + 1], second.robot[: onset + 1], atol=1e-3)
    apart = np.linalg.norm(first.places[:, 0] - second.places[:, 0], axis=-1)
    near = runs_of_c_mujoco("a box of 10 kg")[:3]
    among = np.linalg.norm(near[:, None] - near, axis=-1).max((0, 1))
    after = slice(onset + 1, onset + 4)
    assert (apart[after] < among[after]).all(), (apart[after], among[after])


@pytest.mark.parametrize("impl", ENGINES)
def test_a_body_inside_a_fixed_object_leaves_it_through_the_nearest_face(impl: str) -> None:
    """A box that stands 2 cm inside the long side of a turned one, whose normal is horizontal: it is pushed along that
    normal, neither up nor aside."""
    robot, yaw = make_coco("differential"), 0.9
    normal = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    wall = np.array([1.2, 0.0, 0.0])
    place = wall + normal * (0.2 + 0.2 - 0.02)
    objects = [
        MovableObject([pushing.box(0.4, 0.4, 0.4)], (place[0], place[1], 0.0), yaw, 10.0, 0.1),
        MovableObject([pushing.box(0.7, 0.4, 0.6)], (wall[0], wall[1], 0.0), yaw),
    ]
    scene = pushing.object_scene(objects)
    slot = pushing.object_bank(scene).meta["object_ids"][0].index("thing_0")
    found, _ = pushing.push_engine(scene, robot, np.zeros((1, 2)), impl, SIZES, np.array([slot, -1, -1]))
    moved = found.places[0, 0] - (pushing.START + place)
    assert 0.02 < moved @ normal < 0.1, "out of it, without a leap"
    assert abs(moved[2]) < 2e-3
    assert np.linalg.norm(moved - (moved @ normal) * normal) < 0.02
    assert not found.hit.any()


def one_box(place: float) -> SceneGeometry:
    return pushing.object_scene([MovableObject([pushing.box(0.5, 0.5, 0.5)], (place, 0.0, 0.0))])


def test_what_sleeps_stays_to_the_bit_and_what_left_its_place_is_gone_from_there() -> None:
    """A body 5 m away is not touched by the physics; where a body once stood the robot drives on."""
    robot = make_coco("differential")
    bank = pushing.object_bank(one_box(1.2))
    engine = make_engine(bank, robot, impl="warp", control_dt=pushing.CONTROL_DT, movable=SIZES)
    objects = np.array([bank.meta["object_ids"][0].index("thing_0"), -1, -1])
    qpos = pushing.first_qpos(robot, engine.physics.model.nq)
    init = jax.jit(engine.init)
    state = init(0, qpos, np.zeros(engine.physics.model.nv), objects)
    assert state.bodies is not None
    np.testing.assert_allclose(state.bodies.position[0], pushing.START + [1.2, 0.0, 0.0], atol=1e-5)
    away = state._replace(bodies=state.bodies._replace(position=state.bodies.position.at[0, 0].add(5.0)))
    step, ctrl = jax.jit(engine.step), np.asarray(robot.command(jnp.array([1.5, 0.0])))
    for _ in range(8):
        away = step(away, ctrl)
        assert not bool(away.contacts.hit)
    assert float(away.qpos[0]) > pushing.START[0] + 1.2
    for name in ("object_index", "quaternion", "velocity", "spin", "warm"):
        np.testing.assert_array_equal(getattr(away.bodies, name), getattr(state.bodies, name), err_msg=name)
    assert away.bodies is not None
    assert float(away.bodies.position[0, 0] - state.bodies.position[0, 0]) == 5.0
    # Without bodies the same box is static and stops the robot.
    still = init(0, qpos, np.zeros(engine.physics.model.nv), np.full(3, -1))
    for _ in range(8):
        still = step(still, ctrl)
    assert bool(still.contacts.hit)
    assert int(still.contacts.hit_object) == objects[0]
    assert float(still.qpos[0]) < pushing.START[0] + 1.0


def test_more_bodies_in_reach_than_may_be_awake_are_told() -> None:
    boxes = [MovableObject([pushing.box(0.2, 0.2, 0.3)], (0.8 + 0.01 * i, 0.5 * (i - 1), 0.0)) for i in range(3)]
    robot = make_coco("differential")
    _, state = pushing.push_engine(pushing.object_scene(boxes), robot, np.zeros((1, 2)), "warp", SIZES)
    assert int(state.slot_overflow) == 1


@pytest.mark.mjx
def test_sizes_and_counts_are_checked() -> None:
    bank, robot = box_bank(1, num_objects=1), make_coco("differential")
    with pytest.raises(ValidationError, match=r"movable\.awake"):
        make_engine(bank, robot, impl="jax", movable=Sizes(2, 3, 4))
    engine = make_engine(bank, robot, impl="jax", control_dt=0.02, movable=Sizes(2, 1, 4))
    with pytest.raises(ValidationError, match="3 of them"):
        jax.eval_shape(engine.init, 0, np.zeros(11), np.zeros(10), np.full(3, -1))
    plain = make_engine(bank, robot, impl="jax", control_dt=0.02, movable=Sizes(0, 1, 4))
    assert plain.movable is None
    with pytest.raises(ValidationError, match="2 of them"):
        jax.eval_shape(plain.init, 0, np.zeros(11), np.zeros(10), np.full(2, -1))


@pytest.mark.extended
@pytest.mark.mjx
def test_without_bodies_no_line_of_theirs_is_traced(monkeypatch: pytest.MonkeyPatch) -> None:
    """The program of an engine without body slots is the same text with every function of bodies broken."""
    from urbanverse_mjx.simulation.jax_engine import JaxEngine, body_dynamics

    bank, robot = box_bank(1, num_objects=1), make_coco("differential")
    programs = []
    for movable in (None, Sizes(0)):
        engine = JaxEngine(bank, robot, control_dt=0.02, movable=movable)
        qpos = pushing.first_qpos(robot, engine.physics.model.nq)
        state = jax.eval_shape(engine.init, 0, qpos, np.zeros(engine.physics.model.nv))
        assert state.bodies is None
        programs.append(str(jax.make_jaxpr(engine.step)(state, np.zeros(engine.physics.model.nu, np.float32))))
        for module in (body_contact, body_dynamics):
            for name, obj in vars(module).items():
                if callable(obj) and getattr(obj, "__module__", "") == module.__name__:
                    monkeypatch.setattr(module, name, None)
        for name in ("wake", "put_back", "reach", "begin"):
            monkeypatch.setattr(body_slots, name, None)
    assert programs[0] == programs[1]


@pytest.mark.extended
def test_table_has_the_moments_that_c_mujoco_compiles(small_bank: SceneBank) -> None:
    """Mass, centre, principal moments and axes of a scooter and of boxes, against MJCF with free joints."""
    objects = [
        MovableObject(scooter(), (0.0, 0.0, 0.0), 0.7, 20.0),
        MovableObject([pushing.box(0.3, 0.2, 0.5)], (3.0, 0.0, 0.0)),
    ]
    scene = pushing.object_scene(objects)
    model = mujoco.MjModel.from_xml_string(scene_mjcf(scene, visuals=False, free=True)[0])
    bank = pushing.object_bank(scene)
    table = body_table.body_table(bank)
    for i, name in enumerate(scene.object_ids):
        row = table.row[0, bank.meta["object_ids"][0].index(name)]
        shape, body = table.shape[row], model.body(name).id
        assert table.mass[row] == pytest.approx(model.body_mass[body], rel=1e-5)
        np.testing.assert_allclose(table.centre[shape], model.body_ipos[body], atol=1e-5)
        moments = table.mass[row] * table.inertia[shape]
        np.testing.assert_allclose(np.sort(moments), np.sort(model.body_inertia[body]), rtol=1e-4)
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_iquat[body])
        theirs, axes = turn.reshape(3, 3), table.axes[shape]
        whole = theirs @ np.diag(model.body_inertia[body]) @ theirs.T
        np.testing.assert_allclose(axes @ np.diag(moments) @ axes.T, whole, atol=1e-4)
        assert np.linalg.det(axes) == pytest.approx(1.0)
        assert table.friction[row] == pytest.approx(objects[i].friction)
        # All of its points are on its surface: in none of its hulls, and none far outside.
        for t in table.hull[shape][table.hull[shape] >= 0]:
            planes = bank.hull_planes[t, : bank.hull_num_triangles[t]]
            height = (table.points[shape] + table.centre[shape]) @ planes[:, :3].T - planes[:, 3]
            assert height.max(1).min() > -0.011
        corners = np.concatenate(objects[i].hulls)
        low, high = corners.min(0) - 1e-5, corners.max(0) + 1e-5
        points = table.points[shape] + table.centre[shape]
        assert ((points >= low) & (points <= high)).all()
        lowest = points[points[:, 2] < 1e-4]
        foot = objects[i].hulls[0]
        for corner in foot[foot[:, 2] < 1e-4]:
            assert np.linalg.norm(lowest - corner, axis=1).min() < 1e-5, "corners that it stands on are points"
    assert (body_table.body_table(small_bank).row >= 0).sum() <= small_bank.slot_movable.sum()
