"""The MJX engine: pure, one compilation for all scenes, independent envs, counted slots."""

import dataclasses
import types
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from tests.support.box_bank import box_bank
from tests.support.engine_runs import CONTROL_DT, NUM_ENVS, assert_equal, roll, starts
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.collision_slots import body_slots
from urbanverse_mjx.simulation.collision_slots.body_slots import Awake, Sizes
from urbanverse_mjx.simulation.collision_slots.hull_contact import SphereContacts
from urbanverse_mjx.simulation.collision_slots.static_slots import Slots
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.jax_engine import JaxEngine, body_dynamics, constraint
from urbanverse_mjx.simulation.jax_engine.engine import _Touch


@pytest.mark.extended
def test_changing_scenes_compiles_nothing(
    jax_engine: JaxEngine, small_bank: SceneBank, jax_step: Any, jax_traces: list[int]
) -> None:
    state, ctrl = starts(jax_engine, small_bank)
    jax_step(state, ctrl)
    made = len(jax_traces)
    for shift in range(small_bank.num_scenes):
        jax_step(state._replace(scene=(state.scene + shift) % small_bank.num_scenes), ctrl)
    assert len(jax_traces) == made


@pytest.mark.parametrize(
    ("owner", "foot", "noted"),
    [
        # owner of the hull, foot of the sphere or -1 -> (hit, ground, object, agent, load of the foot)
        (7, -1, (1, False, 7, -1, 0.0)),
        (-1, -1, (1, True, -1, -1, 0.0)),
        (-1, 1, (0, False, -1, -1, 5.0)),
        (-2, -1, (1, False, -2, 0, 0.0)),
        (-3, -1, (1, False, -3, 1, 0.0)),
    ],
)
def test_a_contact_is_noted_as_of_what_it_is(owner: int, foot: int, noted: tuple) -> None:
    """With an object, the ground, a foot on the ground, the first agent and the second; a second sphere touches
    nothing."""
    engine: Any = types.SimpleNamespace(
        agents=object(),
        physics=types.SimpleNamespace(spheres=types.SimpleNamespace(foot=np.array([foot, -1]))),
        robot=types.SimpleNamespace(foot_geoms=("left", "right")),
    )
    none, zero, rest = jnp.int32(-1), jnp.int32(0), jnp.zeros(1)
    before = _Touch(jnp.float32(0.0), none, jnp.bool_(False), zero, zero, jnp.zeros(2), none, jnp.float32(0.0))
    slots = Slots(rest, jnp.array([owner]), rest, rest, rest, rest)
    where = jnp.zeros((2, 3))
    found = SphereContacts(jnp.arange(2), jnp.zeros(2, int), jnp.array([-0.01, jnp.inf]), where, where, jnp.int32(3))
    after = JaxEngine._note(engine, before, found, slots, jnp.array([5.0, 0.0]))
    hit, ground, body, agent, load = noted
    assert (int(after.count), bool(after.ground), int(after.owner)) == (hit, ground, body)
    assert (int(after.agent), float(after.agent_force)) == (agent, 5.0 if agent >= 0 else float(before.agent_force))
    assert after.foot.tolist() == [0.0, load]
    assert int(after.missed) == 3


def test_rows_of_contacts_are_velocities_of_the_surfaces_against_each_other() -> None:
    """Of a floating robot (linear, then angular velocity about a centre) against the ground and two pushed bodies, from
    the velocities of rigid bodies at a point; each pair of rows is normal plus and minus friction times tangent."""
    rng = np.random.default_rng(0)
    number, mu = 3, 0.5
    body = np.array([-1, 0, 1])
    spheres: Any = types.SimpleNamespace(
        dof_mask=np.ones((1, 6)),
        own_friction=np.array([True]),
        slippery=np.array([False]),
        friction=np.array([mu / 2.0]),
        solref=np.array([[0.02, 1.0]]),
        solimp=np.array([[0.9, 0.95, 0.001, 0.5, 2.0]]),
        invweight=np.array([0.1]),
    )
    normal = rng.normal(size=(number, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    place, centre, point = rng.normal(size=(2, 3)), rng.normal(size=3), rng.normal(size=(number, 3))
    zeros = jnp.zeros(number, int)
    found = SphereContacts(zeros, zeros, jnp.full(number, -0.01), jnp.asarray(normal), jnp.asarray(point), jnp.int32(0))
    unit = np.eye(3)
    motion = np.block([[np.zeros((3, 3)), unit], [unit, np.zeros((3, 3))]])
    pushed = constraint.Pushed(jnp.asarray(body), jnp.asarray(place), jnp.array([0.2, 0.3]))
    speed = rng.normal(size=6 + 12)
    rows = constraint.contact_rows(
        found, spheres, jnp.ones(1), 2.0, jnp.asarray(motion), jnp.asarray(centre), jnp.asarray(speed), 0.01, pushed
    )
    ends = np.asarray(rows.jacobian @ speed).reshape(number, 4)
    tangents = np.stack(constraint.tangents(jnp.asarray(normal)), 1)
    for k in range(number):
        moves = speed[:3] + np.cross(speed[3:6], point[k] - centre)
        if body[k] >= 0:
            own = speed[6 + 6 * body[k] :]
            moves = moves - own[:3] - np.cross(own[3:6], point[k] - place[body[k]])
        along, aside = moves @ normal[k], mu * (tangents[k] @ moves)
        wanted = [along + aside[0], along - aside[0], along + aside[1], along - aside[1]]
        np.testing.assert_allclose(ends[k], wanted, atol=1e-5)


def test_the_scene_decides_what_is_hit(jax_engine: JaxEngine, small_bank: SceneBank, jax_step: Any) -> None:
    """Robots stand where an object of the first scene stands: there they hit that object, elsewhere not that one."""
    clear = [
        k
        for k in range(40)
        if np.linalg.norm(small_bank.inst_position[1:, :, :2] - small_bank.inst_position[0, k, :2], axis=-1).min() > 2.5
    ]
    place = small_bank.inst_position[0, clear[0]] + (0.0, 0.0, jax_engine.robot.spawn_height + 0.05)
    qpos = np.zeros((NUM_ENVS, jax_engine.physics.model.nq), np.float32)
    qpos[:, :3], qpos[:, 3] = place, 1.0
    scenes = np.arange(NUM_ENVS) % small_bank.num_scenes
    state = jax.jit(jax.vmap(jax_engine.init))(scenes, qpos, np.zeros((NUM_ENVS, jax_engine.physics.model.nv)))
    state = jax_step(state, np.zeros((NUM_ENVS, jax_engine.physics.model.nu), np.float32))
    np.testing.assert_array_equal(state.contacts.hit, scenes == 0)
    owner = small_bank.inst_object[0, clear[0]]
    np.testing.assert_array_equal(state.contacts.hit_object, np.where(scenes == 0, owner, -1))
    assert (np.array(state.contacts.hit_fraction)[scenes == 0] > 0.5).all()
    assert (np.array(state.contacts.hit_force)[scenes == 0] > 100).all()


@pytest.mark.extended
def test_vmap_equals_a_loop(jax_engine: JaxEngine, small_bank: SceneBank, jax_step: Any) -> None:
    state, ctrl = starts(jax_engine, small_bank)
    together = roll(jax_step, state, ctrl, 8)
    alone = jax.jit(jax_engine.step)
    for i in range(NUM_ENVS):
        one = roll(alone, jax.tree.map(lambda x, i=i: x[i], state), ctrl[i], 8)
        # Batched matrix products add up in another order.
        np.testing.assert_allclose(one.qpos, together.qpos[i], atol=2e-4)
        assert bool(one.contacts.hit) == bool(together.contacts.hit[i])
        assert int(one.contacts.hit_object) == int(together.contacts.hit_object[i])


def test_step_is_pure_and_envs_are_independent(jax_engine: JaxEngine, small_bank: SceneBank, jax_step: Any) -> None:
    state, ctrl = starts(jax_engine, small_bank)
    copy = jax.tree.map(lambda x: np.array(x), state)
    first = roll(jax_step, state, ctrl, 5)
    assert_equal(copy, state)
    roll(jax_step, *starts(jax_engine, small_bank, seed=1), 3)  # another batch in between
    assert_equal(first, roll(jax_step, state, ctrl, 5))
    # Shuffled envs give the shuffled result.
    order = np.array([3, 5, 0, 1, 4, 2])
    shuffled = roll(jax_step, jax.tree.map(lambda x: x[order], state), ctrl[order], 5)
    assert_equal(jax.tree.map(lambda x: x[order], first), shuffled)
    # A neighbour of NaN has no effect.
    nan = {name: jnp.asarray(getattr(state, name)).at[2].set(jnp.nan) for name in ("qpos", "qvel", "xpos")}
    spoilt = roll(jax_step, state._replace(**nan), ctrl, 5)
    well = np.array([0, 1, 3, 4, 5])
    assert_equal(jax.tree.map(lambda x: x[well], first), jax.tree.map(lambda x: x[well], spoilt))
    assert np.isnan(np.array(spoilt.qpos[2])).any()  # and NaN stays, so that the env detects it


def test_init_reports_kinematics_and_no_contact(jax_engine: JaxEngine, small_bank: SceneBank) -> None:
    state, _ = starts(jax_engine, small_bank)
    root = jax_engine.physics.root
    np.testing.assert_allclose(state.xpos[:, root], state.qpos[:, :3])
    np.testing.assert_allclose(state.xquat[:, root], state.qpos[:, 3:7], atol=1e-6)
    assert not np.array(state.contacts.hit).any()
    assert (np.array(state.contacts.hit_object) == -1).all()
    assert (np.array(state.slot_overflow) == 0).all()


def test_far_from_everything_nothing_is_hit_and_the_robot_falls(jax_engine: JaxEngine, jax_step: Any) -> None:
    qpos = np.zeros((NUM_ENVS, jax_engine.physics.model.nq), np.float32)
    qpos[:, :4] = 500.0, -300.0, 5.0, 1.0
    state = jax.jit(jax.vmap(jax_engine.init))(
        np.zeros(NUM_ENVS, int), qpos, np.zeros((NUM_ENVS, jax_engine.physics.model.nv))
    )
    state = jax_step(state, np.zeros((NUM_ENVS, jax_engine.physics.model.nu), np.float32))
    # Ten Euler steps of 10 ms: v = -g t, z = sum of v dt.
    np.testing.assert_allclose(state.qvel[:, 2], -9.81 * 0.1, rtol=1e-4)
    np.testing.assert_allclose(state.qpos[:, 2], 5.0 - 9.81 * 0.01**2 * 55, rtol=1e-5)
    assert not np.array(state.contacts.hit).any()


def crowd(number: int) -> SceneBank:
    """One street with all its objects at one place."""
    bank = box_bank(1, num_objects=number)
    position = np.tile(np.array([20.0, 6.5, 0.15], np.float32), (1, number, 1))
    hulls = np.broadcast_to(np.arange(number, dtype=np.int32), (*bank.hull_grid.shape[:3], number)).copy()
    return dataclasses.replace(bank, inst_position=position, hull_grid=hulls)


@pytest.mark.parametrize("slots", [8, 20, 24])
def test_hulls_without_a_slot_are_counted(slots: int) -> None:
    engine = JaxEngine(crowd(20), make_coco(), control_dt=CONTROL_DT)
    engine.num_slots = slots  # as where nothing was counted, off the traversable ground
    place = jnp.array([20.0, 6.5, 0.4])
    nearby, missing = jax.jit(engine.find_slots)(0, place)
    assert int(missing) == max(20 - slots, 0)
    objects = np.array(nearby.owner)[: engine.num_slots]
    valid = np.array(nearby.valid)[: engine.num_slots]
    assert valid.sum() == min(slots, 20)
    assert len(set(objects[valid])) == min(slots, 20)
    # Ten metres farther no hull is within reach.
    assert int(jax.jit(engine.find_slots)(0, place + jnp.array([10.0, 0, 0]))[1]) == 0


def test_a_step_counts_hulls_without_a_slot_and_pairs_without_a_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    def misses_two(engine: JaxEngine, model: Any, friction: Any, nearby: Any, *given: Any) -> Any:
        """In place of a physics step, which would take seconds to compile: two pairs found no place."""
        before = given[-1]
        return before._replace(touch=before.touch._replace(missed=jnp.int32(2)))

    monkeypatch.setattr(JaxEngine, "_physics_step", misses_two)
    engine = JaxEngine(crowd(20), make_coco(), control_dt=CONTROL_DT)
    engine.num_slots = 8  # as where nothing was counted, off the traversable ground
    qpos = np.zeros(engine.physics.model.nq, np.float32)
    qpos[:4] = 20.0, 6.5, 0.4, 1.0
    state = jax.jit(engine.init)(0, qpos, np.zeros(engine.physics.model.nv, np.float32))
    after = jax.jit(engine.step)(state, np.zeros(engine.physics.model.nu, np.float32))
    assert int(after.slot_overflow) == 12 + 2


def test_every_hull_within_reach_has_a_slot(jax_engine: JaxEngine, small_bank: SceneBank) -> None:
    """10,000 poses, against brute force over all hulls of the scene."""
    rng = np.random.default_rng(0)
    count = 10_000
    scene = rng.integers(small_bank.num_scenes, size=count)
    place = rng.uniform([0, -8, 0.2], [60, 8, 0.6], (count, 3)).astype(np.float32)
    nearby, missing = jax.jit(jax.vmap(jax_engine.find_slots))(scene, place)
    assert int(missing.max()) == 0
    valid, owner = np.array(nearby.valid), np.array(nearby.owner)
    for z in range(small_bank.num_scenes):
        here = np.flatnonzero(scene == z)
        hull = small_bank.inst_hull[z]
        box = small_bank.hull_box[hull]
        offset = place[here, None] - small_bank.inst_position[z]
        local = np.einsum("qij,nqi->nqj", small_bank.inst_rotation[z], offset) - box[:, 0]
        reachable = np.linalg.norm(np.maximum(np.abs(local) - box[:, 1], 0), axis=-1) < jax_engine.reach - 1e-4
        for row, objects in zip(here, reachable & (hull >= 0), strict=True):
            wanted = set(small_bank.inst_object[z][objects])
            assert wanted <= set(owner[row][valid[row]])


def test_each_body_has_what_stands_within_its_own_reach(small_bank: SceneBank) -> None:
    """Against brute force over all hulls of the street: nothing that is a body itself, places about the origin."""
    engine = make_engine(small_bank, make_coco(), impl="jax", control_dt=CONTROL_DT, movable=Sizes(6, 5, 4))
    assert isinstance(engine, JaxEngine)
    rng = np.random.default_rng(1)
    there = small_bank.inst_hull[0] >= 0
    objects = np.unique(small_bank.inst_object[0][there])
    taken = rng.choice(objects[objects >= 0], 6, replace=False)
    near = small_bank.inst_position[0][there][rng.choice(there.sum(), 5, replace=False)]
    places = (near + rng.uniform(-0.6, 0.6, (5, 3))).astype(np.float32)
    qpos = np.zeros(engine.physics.model.nq, np.float32)
    qpos[:4] = *places[0, :2], 0.4, 1.0
    origin = np.array([7.0, -2.0, 0.0], np.float32)
    reach = np.array([0.3, 0.8, 0.5, 1.2, 0.9], np.float32)

    state = jax.eval_shape(engine.init, 0, qpos, np.zeros(engine.physics.model.nv, np.float32), taken)
    bodies = jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype), state.bodies)._replace(object_index=jnp.asarray(taken))
    still = jnp.zeros((5, 3))
    turn = jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (5, 1))
    awake = Awake(jnp.arange(5), jnp.arange(5), jnp.asarray(places), turn, still, still, jnp.zeros((5, 6)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(body_slots, "reach", lambda *_: jnp.asarray(reach))
        here = state._replace(scene=jnp.int32(0), bodies=bodies)
        found = jax.jit(lambda a: engine._scenery(here, a, jnp.asarray(origin)))(awake)
    hull, owner = small_bank.inst_hull[0], small_bank.inst_object[0]
    box = small_bank.hull_box[np.maximum(hull, 0)]
    for k, place in enumerate(places):
        local = np.einsum("qij,qi->qj", small_bank.inst_rotation[0], place - small_bank.inst_position[0]) - box[:, 0]
        away = np.linalg.norm(np.maximum(np.abs(local) - box[:, 1], 0.0), axis=-1)
        away = np.where((hull >= 0) & ~np.isin(owner, taken), away, np.inf)
        wanted = sorted(away[away <= reach[k]].tolist())[: body_slots.HULLS]
        valid = np.asarray(found.hulls.valid[k])
        assert valid.sum() == len(wanted)
        rows = np.asarray(found.hulls.position[k])[valid] + origin
        for row, number in zip(rows, np.asarray(found.hulls.hull[k])[valid], strict=True):
            same = (hull == number) & (np.abs(small_bank.inst_position[0] - row).max(1) < 1e-4)
            assert (away[same] <= reach[k] + 1e-5).any()
        assert not set(np.asarray(found.hulls.owner[k])[valid].tolist()) & set(taken.tolist())
    counts = np.asarray(found.hulls.valid).sum(1)
    assert counts.max() > 0
    assert np.asarray(found.prisms.valid).any()


def test_callers_mistakes_are_one_sentence(small_bank: SceneBank) -> None:
    robot = make_coco()
    with pytest.raises(ValidationError, match="multiple of the physics step"):
        JaxEngine(small_bank, robot, control_dt=0.125)
    with pytest.raises(ValidationError, match="grid_reach"):
        JaxEngine(small_bank, robot, control_dt=0.5)
    with pytest.raises(ValidationError, match="num_contacts"):
        JaxEngine(small_bank, robot, num_contacts=100_000)
    sphere = 'name="body_0" class="collision" type="sphere"'
    box = robot.mjcf.replace(sphere, sphere.replace("sphere", "box"))
    box = box.replace(f'size="{0.2}" pos', 'size="0.2 0.2 0.2" pos', 1)
    with pytest.raises(ValidationError, match="another shape than a sphere"):
        JaxEngine(small_bank, dataclasses.replace(robot, mjcf=box))
    with pytest.raises(ValidationError, match="foot_geoms"):
        JaxEngine(small_bank, dataclasses.replace(robot, foot_geoms=("paw",)))


def test_a_body_moves_by_its_acceleration_as_in_c_mujoco() -> None:
    """A box that tumbles and falls: its new velocity moves it, and its spin turns it about axes of the world."""
    box = "<mujoco><option timestep='.02'/><worldbody><body pos='1 2 3' quat='.8 0 .6 0'><freejoint/>"
    box += "<geom type='box' size='.1 .2 .3'/></body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(box)
    data = mujoco.MjData(model)
    data.qvel[:] = [0.4, -0.3, 0.2, 2.0, -3.0, 4.0]
    mujoco.mj_forward(model, data)

    def turned(spin: np.ndarray) -> np.ndarray:
        out = np.zeros(3)
        mujoco.mju_rotVecQuat(out, spin, turn)
        return out

    turn = data.qpos[3:].copy()
    linear, angular = data.qvel[:3].copy(), turned(data.qvel[3:])
    acceleration = jnp.asarray([*data.qacc[:3], *turned(data.qacc[3:])])
    body = Awake(*(jnp.asarray(x)[None] for x in (0, 0, data.qpos[:3], turn, linear, angular, np.zeros(6))))
    found = body_dynamics.moved(body, acceleration, model.opt.timestep)
    mujoco.mj_Euler(model, data)
    np.testing.assert_allclose(found.place[0], data.qpos[:3], atol=1e-6)
    np.testing.assert_allclose(found.quaternion[0], data.qpos[3:], atol=1e-6)
    np.testing.assert_allclose(found.velocity[0], data.qvel[:3], atol=1e-6)
    np.testing.assert_allclose(found.spin[0], turned(data.qvel[3:]), atol=1e-5)
    np.testing.assert_allclose(found.warm[0], acceleration, atol=1e-6)


def test_springs_of_contacts_are_those_of_c_mujoco() -> None:
    """Stiffness, damping and impedance of touching spheres, at depths below and beyond the width of the impedance."""
    curves = [(0.9, 0.95, 0.001, 0.5, 2.0), (0.3, 0.99, 0.02, 0.3, 3.0), (0.5, 0.8, 0.1, 0.7, 1.0)]
    solref = [(0.02, 1.0), (0.05, 0.7), (0.001, 1.3)]  # the last is shorter than two steps
    depths = (0.0004, 0.004, 0.03)
    spheres = [
        f'<body pos="{k} {i} {0.1 - depth}"><freejoint/><geom type="sphere" size=".1" priority="1" condim="1"'
        f' solref="{" ".join(map(str, solref[k]))}" solimp="{" ".join(map(str, curves[k]))}"/></body>'
        for k in range(3)
        for i, depth in enumerate(depths)
    ]
    plane = '<geom type="plane" size="9 9 1"/>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{plane}{''.join(spheres)}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.ncon == data.nefc == 9
    found = constraint._spring(
        jnp.asarray(data.contact.solref), jnp.asarray(data.contact.solimp), jnp.asarray(-data.contact.dist), 0.002
    )
    assert model.opt.timestep == 0.002
    np.testing.assert_allclose(np.stack(found, -1), data.efc_KBIP[:, :3], rtol=1e-5)
    assert np.ptp(data.efc_KBIP[:, 2]) > 0.4
