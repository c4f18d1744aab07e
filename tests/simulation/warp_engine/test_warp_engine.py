"""The Warp engine: pure, one capture per batch, the slots of the MJX engine, independent envs."""

import dataclasses
import gc
import weakref
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import warp as wp

from tests.support.box_bank import box_bank
from tests.support.engine_runs import CONTROL_DT, NUM_ENVS, assert_equal, roll, starts
from urbanverse_mjx.datatypes import SceneBank, SimState, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation import engines
from urbanverse_mjx.simulation.collision_slots import hull_contact
from urbanverse_mjx.simulation.collision_slots.body_slots import Sizes
from urbanverse_mjx.simulation.warp_engine import WarpEngine, contact, kernels
from urbanverse_mjx.simulation.warp_engine import batch as warp_batch
from urbanverse_mjx.simulation.warp_engine.batch import WorldBatch
from urbanverse_mjx.simulation.warp_engine.model import DeviceModel


@pytest.fixture(scope="module")
def engine(small_bank: SceneBank) -> WarpEngine:
    return WarpEngine(small_bank, make_coco("differential"), control_dt=CONTROL_DT)


@pytest.fixture(scope="module")
def traces() -> list[int]:
    """One entry per trace of `batched`."""
    return []


@pytest.fixture(scope="module")
def batched(engine: WarpEngine, traces: list[int]) -> Any:
    def step(state: SimState, ctrl: Any) -> SimState:
        traces.append(1)
        return jax.vmap(engine.step)(state, ctrl)

    return jax.jit(step)


def row(tree: Any, number: int) -> Any:
    return jax.tree.map(lambda x: x[number], tree)


def test_changing_scenes_compiles_nothing(
    engine: WarpEngine,
    small_bank: SceneBank,
    batched: Any,
    traces: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    state, ctrl = starts(engine, small_bank)
    batched(state, ctrl)
    made = engine.num_contexts

    def forbidden(*_: Any) -> None:
        raise AssertionError("something was captured again")

    monkeypatch.setattr(warp_batch, "_captured", forbidden)
    for shift in range(small_bank.num_scenes):
        jax.block_until_ready(batched(state._replace(scene=(state.scene + shift) % small_bank.num_scenes), ctrl))
    assert len(traces) == 1
    assert engine.num_contexts == made


def test_the_scene_decides_what_is_hit(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    """Robots stand where an object of the first scene stands: there they hit that object, elsewhere not that one."""
    clear = [
        k
        for k in range(40)
        if np.linalg.norm(small_bank.inst_position[1:, :, :2] - small_bank.inst_position[0, k, :2], axis=-1).min() > 2.5
    ]
    place = small_bank.inst_position[0, clear[0]] + (0.0, 0.0, engine.robot.spawn_height + 0.05)
    qpos = np.zeros((NUM_ENVS, engine.physics.model.nq), np.float32)
    qpos[:, :3], qpos[:, 3] = place, 1.0
    scenes = np.arange(NUM_ENVS) % small_bank.num_scenes
    state = jax.jit(jax.vmap(engine.init))(scenes, qpos, np.zeros((NUM_ENVS, engine.physics.model.nv)))
    state = batched(state, np.zeros((NUM_ENVS, engine.physics.model.nu), np.float32))
    np.testing.assert_array_equal(state.contacts.hit, scenes == 0)
    owner = small_bank.inst_object[0, clear[0]]
    np.testing.assert_array_equal(state.contacts.hit_object, np.where(scenes == 0, owner, -1))
    assert (np.array(state.contacts.hit_fraction)[scenes == 0] > 0.5).all()
    assert (np.array(state.contacts.hit_force)[scenes == 0] > 100).all()


def test_contacts_mean_what_they_mean_in_the_mjx_engine(
    engine: WarpEngine, small_bank: SceneBank, batched: Any, jax_step: Any
) -> None:
    """Both engines over two seconds of drives into objects: hits, objects, shares, and forces within two per cent."""
    state, ctrl = starts(engine, small_bank)
    twin = state
    touched = 0
    for _ in range(20):
        state, twin = batched(state, ctrl), jax_step(twin, ctrl)
        ours, theirs = jax.device_get((state.contacts, twin.contacts))
        np.testing.assert_array_equal(ours.hit, theirs.hit)
        np.testing.assert_array_equal(ours.hit_object, theirs.hit_object)
        np.testing.assert_array_equal(ours.hit_ground, theirs.hit_ground)
        # A touch may begin or end one physics step apart.
        np.testing.assert_allclose(ours.hit_fraction, theirs.hit_fraction, atol=1.01 / engine.num_substeps)
        np.testing.assert_allclose(ours.hit_force, theirs.hit_force, rtol=0.02, atol=1.0)
        np.testing.assert_allclose(state.qpos[:, :7], twin.qpos[:, :7], atol=1e-3)
        np.testing.assert_allclose(state.xpos, twin.xpos, atol=1e-3)
        np.testing.assert_allclose(
            np.abs(np.sum(state.xquat * twin.xquat, -1)), 1.0, atol=1e-5
        )  # q and -q are one turn
        touched += int(ours.hit.sum())
    assert touched > 5


@pytest.mark.extended
def test_any_nesting_of_vmap_is_the_same_call(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    state, ctrl = starts(engine, small_bank)
    together = roll(batched, state, ctrl, 8)
    alone = jax.jit(engine.step)
    for i in range(NUM_ENVS):
        assert_equal(roll(alone, row(state, i), ctrl[i], 8), row(together, i))
    fold = lambda tree: jax.tree.map(lambda x: x.reshape(2, 3, *x.shape[1:]), tree)  # noqa: E731
    nested = roll(jax.jit(jax.vmap(jax.vmap(engine.step))), fold(state), ctrl.reshape(2, 3, -1), 8)
    assert_equal(fold(together), nested)
    scanned = jax.lax.scan(lambda s, _: (jax.vmap(engine.step)(s, ctrl), None), state, None, length=8)[0]
    assert_equal(together, scanned)
    # One command for all.
    shared = jax.jit(jax.vmap(engine.step, in_axes=(0, None)))(state, ctrl[0])
    assert_equal(batched(state, jnp.tile(ctrl[:1], (NUM_ENVS, 1))), shared)


def test_step_is_pure_and_envs_are_independent(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    state, ctrl = starts(engine, small_bank)
    copy = jax.tree.map(lambda x: np.array(x), state)
    first = roll(batched, state, ctrl, 20)
    assert_equal(copy, state)
    # Another batch of the same size in between, step by step.
    mixed, other = state, starts(engine, small_bank, seed=1)
    for _ in range(20):
        mixed, other = batched(mixed, ctrl), (batched(*other), other[1])
    assert_equal(first, mixed)
    order = np.array([3, 5, 0, 1, 4, 2])
    shuffled = roll(batched, jax.tree.map(lambda x: x[order], state), ctrl[order], 20)
    assert_equal(jax.tree.map(lambda x: x[order], first), shuffled)


def test_a_world_of_nans_disturbs_no_other_and_leaves_nothing_behind(
    engine: WarpEngine, small_bank: SceneBank, batched: Any
) -> None:
    state, ctrl = starts(engine, small_bank)
    first = roll(batched, state, ctrl, 12)
    wheel = {"qpos": jnp.asarray(state.qpos).at[2, 8].set(jnp.nan)}
    for fields in (("qpos", "qvel", "xpos"), ("qvel",), ("qpos",), ("xpos",), ("wheel",), ("carry",)):
        nan = {name: jnp.asarray(getattr(state, name)).at[2].set(jnp.nan) for name in fields if name != "wheel"}
        spoilt = roll(batched, state._replace(**(nan or wheel)), ctrl, 12)
        well = np.array([0, 1, 3, 4, 5])
        assert_equal(jax.tree.map(lambda x, w=well: x[w], first), jax.tree.map(lambda x, w=well: x[w], spoilt))
        if fields != ("carry",):
            assert np.isnan(np.array(spoilt.qpos[2])).any()  # NaN stays, so that the env detects it
        assert_equal(first, roll(batched, state, ctrl, 12))


@pytest.mark.extended
def test_replay_is_what_plain_launches_do(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    plain = WarpEngine(small_bank, engine.robot, control_dt=CONTROL_DT, graphs=False)
    state, ctrl = starts(engine, small_bank)
    assert_equal(roll(batched, state, ctrl, 15), roll(jax.jit(jax.vmap(plain.step)), state, ctrl, 15))


def test_record_ends_where_the_step_ends(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    state, ctrl = starts(engine, small_bank)
    state = roll(batched, state, ctrl, 25)
    expected = batched(state, ctrl)
    after, record = jax.jit(jax.vmap(engine.step_and_record))(state, ctrl)
    assert_equal(expected, after)
    assert record.qpos.shape == (NUM_ENVS, engine.num_substeps, engine.physics.model.nq)
    np.testing.assert_array_equal(record.qpos[:, -1], after.qpos)
    np.testing.assert_array_equal(record.hit.any(1), after.contacts.hit)
    np.testing.assert_allclose(record.hit.mean(1), after.contacts.hit_fraction, atol=1e-6)
    assert np.array(record.hit).any()


def test_far_from_everything_nothing_is_hit_and_the_robot_falls(engine: WarpEngine, batched: Any) -> None:
    qpos = np.zeros((NUM_ENVS, engine.physics.model.nq), np.float32)
    qpos[:, :4] = 500.0, -300.0, 5.0, 1.0
    state = jax.jit(jax.vmap(engine.init))(np.zeros(NUM_ENVS, int), qpos, np.zeros((NUM_ENVS, engine.physics.model.nv)))
    state = batched(state, np.zeros((NUM_ENVS, engine.physics.model.nu), np.float32))
    # Ten Euler steps of 10 ms: v = -g t, z = sum of v dt.
    np.testing.assert_allclose(state.qvel[:, 2], -9.81 * 0.1, rtol=1e-4)
    np.testing.assert_allclose(state.qpos[:, 2], 5.0 - 9.81 * 0.01**2 * 55, rtol=1e-5)
    assert not np.array(state.contacts.hit).any()
    assert (np.array(state.contacts.hit_object) == -1).all()
    assert (np.array(state.slot_overflow) == 0).all()


def slots_of(engine: WarpEngine, scene: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Owners of the slots (n, C), -2 where empty, and () how many hulls found none (n,)."""
    n, split = len(scene), engine.num_slots
    with wp.ScopedDevice("cpu"):
        shared = DeviceModel(engine.bank, engine._robot_model, engine.reach)
        nearby = kernels.Nearby()
        nearby.row = wp.empty((n, split + engine.num_prism_slots), dtype=int)
        nearby.distance, nearby.missing = wp.empty(nearby.row.shape, dtype=float), wp.empty((n, 2), dtype=int)
        where = [wp.array(scene, dtype=int), wp.array(place, dtype=wp.vec3)]
        wp.launch(
            kernels.find_slots,
            dim=(n, 2),
            inputs=[shared.tables, *where, split, engine.num_prism_slots, nearby, wp.zeros((n, 0), dtype=int)],
        )
        rows = nearby.row.numpy()
    objects, prisms = rows[:, :split], rows[:, split:]
    owner = np.where(objects < 0, -2, np.take_along_axis(engine.bank.inst_object[scene], np.maximum(objects, 0), 1))
    return np.concatenate([owner, np.where(prisms < 0, -2, -1)], 1), nearby.missing.numpy().sum(1)


@pytest.mark.mjx
@pytest.mark.parametrize("max_contacts", [3, 60])
def test_contacts_are_those_of_the_mjx_engine(small_bank: SceneBank, max_contacts: int) -> None:
    """Balls at random places, deep and shallow, at faces, edges and corners: distance, normal, place, friction."""
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    robot, rng = make_coco(), np.random.default_rng(0)
    engine = WarpEngine(small_bank, robot, control_dt=CONTROL_DT, num_contacts=max_contacts)
    other = JaxEngine(small_bank, robot, control_dt=CONTROL_DT, num_contacts=100)
    n, count = 400, len(engine.physics.spheres.radius)
    scene = rng.integers(small_bank.num_scenes, size=n).astype(np.int32)
    hulls = rng.integers(small_bank.inst_hull.shape[1], size=n)
    place = small_bank.inst_position[scene, hulls] + rng.uniform([-1, -1, 0], [1, 1, 2], (n, 3)).astype(np.float32)
    balls = place[:, None] + rng.uniform(-0.4, 0.4, (n, count, 3)).astype(np.float32)
    origin = np.round(place) * np.array([1.0, 1.0, 0.0], np.float32)

    def reference(scene: Any, place: Any, balls: Any, origin: Any) -> Any:
        nearby, _ = other.find_slots(scene, place)
        nearby = nearby._replace(position=nearby.position - origin)
        found = hull_contact.find_contacts(
            balls - origin, jnp.asarray(engine.physics.spheres.radius, jnp.float32), nearby, other.tables.hulls, 100
        )
        return found, nearby.friction[found.slot], nearby.owner[found.slot]

    expected, friction, owner = jax.device_get(jax.jit(jax.vmap(reference))(scene, place, balls, origin))
    with wp.ScopedDevice("cpu"):
        shared = DeviceModel(engine.bank, engine._robot_model, engine.reach)
        batch = WorldBatch(
            shared, n, engine.num_slots, engine.num_prism_slots, max_contacts, 0, graphs=False, agents=None
        )
        where = [shared.tables, wp.array(scene, dtype=int), wp.array(place, dtype=wp.vec3), engine.num_slots]
        wp.launch(kernels.find_slots, dim=(n, 2), inputs=[*where, engine.num_prism_slots, batch.nearby, batch.nothing])
        wp.launch(kernels.place_slots, dim=batch.slots.hull.shape, inputs=[*where, batch.nearby, batch.slots])
        xpos = np.zeros((n, engine._robot_model.model.ngeom, 3), np.float32)
        xpos[:, engine._robot_model.sphere_geom] = balls - origin[:, None]
        inputs = [shared.hulls, shared.spheres, batch.slots, wp.array(xpos, dtype=wp.vec3), batch.places]
        wp.launch(contact.find_contacts, dim=batch.slots.hull.shape, inputs=inputs)
        found = {name: getattr(batch.places, name).numpy() for name in ("dist", "pos", "frame", "friction", "slot")}
        geom, number = batch.places.geom.numpy(), batch.places.count.numpy()
        owners = np.take_along_axis(batch.slots.owner.numpy(), found["slot"].reshape(n, max_contacts), 1)
    sphere_of = {int(g): s for s, g in enumerate(engine._robot_model.sphere_geom)}
    touching = expected.distance < 0
    np.testing.assert_array_equal(number, touching.sum(1))
    assert (number > max_contacts).any() == (max_contacts == 3)
    own, seen = engine.physics.spheres, 0
    for w in range(n):
        theirs = {(int(expected.sphere[w, k]), int(expected.slot[w, k])): k for k in np.flatnonzero(touching[w])}
        for number_here in range(min(number[w], max_contacts)):
            k = w * max_contacts + number_here
            sphere = sphere_of[int(geom[k, 0])]
            match = theirs[sphere, int(found["slot"][k])]
            np.testing.assert_allclose(found["dist"][k], expected.distance[w, match], atol=2e-6)
            np.testing.assert_allclose(-found["frame"][k][0], expected.normal[w, match], atol=2e-4)
            np.testing.assert_allclose(found["pos"][k], expected.position[w, match], atol=5e-5)
            slide = own.friction[sphere] if own.own_friction[sphere] else max(own.friction[sphere], friction[w, match])
            np.testing.assert_allclose(found["friction"][k][:2], slide, rtol=1e-6)
            assert owners[w, number_here] == owner[w, match]
            seen += 1
    assert seen > 500


def pile(number: int) -> SceneBank:
    """One street with the same object so many times at one place."""
    bank = box_bank(1, num_objects=number)
    position = np.tile(np.array([20.0, 6.5, 0.15], np.float32), (1, number, 1))
    turn = np.tile(np.eye(3, dtype=np.float32), (1, number, 1, 1))
    hulls = np.broadcast_to(np.arange(number, dtype=np.int32), (*bank.hull_grid.shape[:3], number)).copy()
    same = {"inst_hull": np.zeros_like(bank.inst_hull), "inst_rotation": turn, "inst_position": position}
    return dataclasses.replace(bank, **same, hull_grid=hulls)


@pytest.mark.mjx
@pytest.mark.parametrize("number", [0, 1, 16])
def test_slots_are_those_of_the_mjx_engine(small_bank: SceneBank, number: int) -> None:
    """2,000 places: the same hulls in the same order, and as many without a slot."""
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    robot = make_coco()
    ours = WarpEngine(small_bank, robot, control_dt=CONTROL_DT)
    ours.num_slots = number  # as where nothing was counted, off the traversable ground
    theirs = JaxEngine(small_bank, robot, control_dt=CONTROL_DT)
    theirs.num_slots = number  # as where nothing was counted, off the traversable ground
    rng = np.random.default_rng(0)
    scene = rng.integers(small_bank.num_scenes, size=2000).astype(np.int32)
    place = rng.uniform([-2, -9, 0.2], [62, 9, 0.6], (2000, 3)).astype(np.float32)
    place[0] = np.nan
    nearby, missing = jax.jit(jax.vmap(theirs.find_slots))(scene, place)
    owner, absent = slots_of(ours, scene, place)
    expected = np.where(np.array(nearby.valid), np.array(nearby.owner), -2)
    # Hulls whose boxes hold the robot are equally near, to within rounding.
    same = (owner == expected).all(1)
    assert same.mean() > 0.99
    np.testing.assert_array_equal(np.sort(owner[~same]), np.sort(expected[~same]))
    np.testing.assert_array_equal(absent, missing)
    assert (owner[0] == -2).all()
    assert absent.max() == 0 if number == 16 else absent.max() > 0


@pytest.mark.parametrize("slots", [8, 20])
def test_hulls_without_a_slot_are_counted(slots: int) -> None:
    """A robot hovers over the pile, too high to touch it within the step, and once out of its reach."""
    bank = pile(20)
    engine = WarpEngine(bank, make_coco(), control_dt=CONTROL_DT)
    engine.num_slots = slots  # as where nothing was counted, off the traversable ground
    top = 0.15 + float(bank.hull_vertices[0, :, 2].max())
    qpos = np.zeros((engine.physics.model.nq,), np.float32)
    qpos[:2], qpos[3] = (20.0, 6.5), 1.0
    for above, missing in ((0.5, 20 - slots), (engine.reach + 0.01, 0)):
        qpos[2] = top + above
        state = jax.jit(engine.init)(0, qpos, np.zeros((engine.physics.model.nv,), np.float32))
        after = jax.jit(engine.step)(state, np.zeros((engine.physics.model.nu,), np.float32))
        assert not after.contacts.hit
        assert int(after.slot_overflow) == missing


def test_contacts_without_a_place_are_counted(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    """With room for two contacts two of four wheels find none."""
    poor = WarpEngine(small_bank, engine.robot, control_dt=CONTROL_DT, num_contacts=2)
    state, ctrl = starts(engine, small_bank)
    np.testing.assert_array_equal(batched(state, ctrl).slot_overflow, 0)
    after = jax.jit(jax.vmap(poor.step))(state, ctrl)
    np.testing.assert_array_equal(after.slot_overflow, 2)


@pytest.mark.extended
def test_a_deleted_engine_gives_its_memory_back(small_bank: SceneBank) -> None:
    engine = WarpEngine(small_bank, make_coco(), control_dt=CONTROL_DT)
    state, ctrl = starts(engine, small_bank)
    step = jax.jit(jax.vmap(engine.step))
    jax.block_until_ready(step(state, ctrl))
    ((shared, batches),) = engine._devices.values()
    batch, shared = weakref.ref(next(iter(batches.values()))), weakref.ref(shared)
    executable = step.lower(state, ctrl).compile()
    del engine, step, batches
    gc.collect()
    assert batch() is None
    assert shared() is None
    with pytest.raises(Exception, match="deleted"):
        jax.block_until_ready(executable(state, ctrl))


@pytest.mark.extended
def test_few_batches_are_kept(small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("urbanverse_mjx.simulation.warp_bridge.KEPT_BATCHES", 2)
    engine = WarpEngine(small_bank, make_coco(), control_dt=CONTROL_DT, graphs=False)
    for number in (2, 3, 4):
        state, ctrl = starts(engine, small_bank, number=number)
        jax.block_until_ready(jax.jit(jax.vmap(engine.step))(state, ctrl))
    assert engine.num_contexts == 2


def test_physics_steps_are_captured(engine: WarpEngine, small_bank: SceneBank, batched: Any) -> None:
    jax.block_until_ready(batched(*starts(engine, small_bank)))
    ((_, batches),) = engine._devices.values()
    assert batches
    assert all(isinstance(batch, WorldBatch) and batch.is_captured for batch in batches.values())


@pytest.mark.gpu
def test_on_cuda_a_graph_is_replayed_in_the_same_memory(small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = WarpEngine(small_bank, make_coco(), control_dt=CONTROL_DT)
    state, ctrl = starts(engine, small_bank, number=512)
    step = jax.jit(jax.vmap(engine.step))
    state = jax.block_until_ready(step(state, ctrl))
    ((_, batches),) = engine._devices.values()
    (batch,) = batches.values()
    assert isinstance(batch, WorldBatch)
    assert batch.shared.device.is_cuda
    assert batch.is_captured
    monkeypatch.setattr(warp_batch, "_captured", None)
    used = wp.get_mempool_used_mem_current(batch.shared.device)
    for _ in range(100):
        state = step(state, ctrl)
    assert np.isfinite(state.qpos).all()
    assert wp.get_mempool_used_mem_current(batch.shared.device) <= used


def test_the_general_engine_is_warp_on_cuda_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    assert engines.general_impl("jax") == "jax"
    for backend, impl in (("cpu", "jax"), ("gpu", "warp"), ("tpu", "jax")):
        monkeypatch.setattr(jax, "default_backend", lambda backend=backend: backend)
        assert engines.general_impl("auto") == impl


@pytest.mark.extended
@pytest.mark.mjx
def test_auto_is_fused_where_the_robot_allows_it(small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> None:
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    robot = make_coco()
    made = engines.make_engine(small_bank, robot)
    assert isinstance(made, WarpEngine)
    assert made.fused
    movable = engines.make_engine(small_bank, robot, movable=Sizes(1, 1))
    assert isinstance(movable, JaxEngine)
    with pytest.raises(ValidationError, match="bodies awake, needed none with impl='warp-fused'"):
        engines.make_engine(small_bank, robot, impl="warp-fused", movable=Sizes(1, 1))
    monkeypatch.setattr(jax, "default_backend", lambda: "tpu")
    assert isinstance(engines.make_engine(small_bank, robot), JaxEngine)


@pytest.mark.mjx
def test_engines_by_name(small_bank: SceneBank) -> None:
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    robot = make_coco()
    made = engines.make_engine(small_bank, robot, impl="warp", control_dt=0.1, physics_dt=0.005)
    assert isinstance(made, WarpEngine)
    assert made.num_substeps == 20
    assert made.physics.model.opt.timestep == 0.005
    assert isinstance(engines.make_engine(small_bank, robot, impl="jax"), JaxEngine)
    with pytest.raises(ValidationError, match="impl: found 'cuda'"):
        engines.make_engine(small_bank, robot, impl="cuda")


def test_callers_mistakes_are_one_sentence(small_bank: SceneBank) -> None:
    robot = make_coco()
    with pytest.raises(ValidationError, match="multiple of the physics step"):
        WarpEngine(small_bank, robot, control_dt=0.125)
    with pytest.raises(ValidationError, match="grid_reach"):
        WarpEngine(small_bank, robot, control_dt=0.5)
    with pytest.raises(ValidationError, match="num_contacts"):
        WarpEngine(small_bank, robot, num_contacts=0)
    mocap = robot.mjcf.replace("<worldbody>", '<worldbody><body mocap="true"/>')
    with pytest.raises(ValidationError, match="mocap bodies"):
        WarpEngine(small_bank, dataclasses.replace(robot, mjcf=mocap))
