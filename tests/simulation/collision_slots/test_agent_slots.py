"""Agents in the engines: distances, runs against C MuJoCo's mocap bodies, and no effect without agents."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
import warp as wp

from tests.support.box_bank import KERB, box_bank, box_scenes
from urbanverse_mjx.datatypes import AgentMotion, AgentShapes, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene.mjcf import scene_spec
from urbanverse_mjx.simulation.collision_slots import agent_slots
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco
from urbanverse_mjx.simulation.warp_engine.agents import prism_distance

CONTROL_DT, NUM_STEPS = 0.2, 10
#: A person, and a car's half: a disc of 0.4 m drawn along 0.6 m to either side.
SHAPES = AgentShapes(*(np.array(a, np.float32) for a in ((0.27, 0.4), (0.0, 0.6), (1.75, 1.4))))
#: Rows: the robot's speed; position and velocity in the robot's frame of each agent at the start, heading, turn rate.
ENCOUNTERS = {
    "into one who stands": (1.5, ((1.6, 0.05), (0.0, 0.0), 0.0, 0.0), ((0.0, 9.0), (0.0, 0.0), 0.0, 0.0)),
    "one walks into it": (0.0, ((2.0, -0.1), (-1.3, 0.0), 0.0, 0.0), ((0.0, 9.0), (0.0, 0.0), 0.0, 0.0)),
    "a vehicle from the side": (0.0, ((5.0, 5.0), (0.0, 0.0), 0.0, 0.0), ((0.1, 2.0), (0.0, -1.2), 1.4, 0.05)),
    "passed by": (1.0, ((1.0, 1.2), (-1.0, 0.0), 0.0, 0.0), ((0.0, -3.0), (1.0, 0.0), 0.0, 0.0)),
    "into a vehicle": (1.2, ((0.0, 9.0), (0.0, 0.0), 0.0, 0.0), ((2.2, 0.3), (-0.2, 0.0), 0.7, 0.0)),
}
START = np.array([20.0, 6.0, KERB])


def with_prisms(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """A scene with a mocap body for each of `SHAPES`: a cylinder at either end and a box between them."""
    for a, (radius, half, height) in enumerate(zip(*SHAPES, strict=True)):
        body = spec.worldbody.add_body(name=f"agent/{a}", mocap=True)
        for x in sorted({-half, half}):
            size, place = (radius, height / 2, 0.0), (x, 0.0, height / 2)
            body.add_geom(name=f"agent/{a}/{x}", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=size, pos=place)
        if half > 0:
            size, place = (half, radius, height / 2), (0.0, 0.0, height / 2)
            body.add_geom(name=f"agent/{a}/box", type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=place)
    return spec


def motions() -> AgentMotion:
    """(encounter, control step, agent, ...): poses of all agents at the beginning of every control step."""
    rows = [pair for _, *pair in ENCOUNTERS.values()]
    place = np.array([[[*agent[0], 0.0] for agent in row] for row in rows])
    velocity = np.array([[[*agent[1], 0.0] for agent in row] for row in rows])
    heading, rate = (np.array([[agent[i] for agent in row] for row in rows]) for i in (2, 3))
    time = CONTROL_DT * np.arange(NUM_STEPS)[None, :, None]
    wide = np.broadcast_to
    shape = (len(rows), NUM_STEPS, 2)
    columns = (
        START + place[:, None] + time[..., None] * velocity[:, None],
        heading[:, None] + time * rate[:, None],
        wide(velocity[:, None], (*shape, 3)),
        wide(rate[:, None], shape),
        np.ones(shape, bool),
    )
    return AgentMotion(*(jnp.asarray(column) for column in columns))


def free_bank() -> Any:
    return box_bank(1, num_objects=1)


@functools.cache
def in_c_mujoco() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Robot's places (N, S, 3), the agent touched (N, S, 2) bool, and whether anything else was hit, in C MuJoCo."""
    robot, moving = make_coco("differential"), jax.device_get(motions())
    model = c_mujoco.reference_model(with_prisms(scene_spec(box_scenes(1, num_objects=1)[0])), robot)
    dt, substeps = robot.physics_timestep, round(CONTROL_DT / robot.physics_timestep)
    names = [model.geom(g).name for g in range(model.ngeom)]
    places, touched = [], []
    for i, (speed, *_) in enumerate(ENCOUNTERS.values()):
        data = mujoco.MjData(model)
        data.qpos[:] = first_qpos(robot, model.nq)
        data.ctrl[:] = np.asarray(robot.command(jnp.array([speed, 0.0])))
        for k in range(NUM_STEPS * substeps):
            step, time = k // substeps, (k % substeps) * dt
            data.mocap_pos[:] = moving.position[i, step] + time * moving.velocity[i, step]
            angle = 0.5 * (moving.heading[i, step] + time * moving.turn_rate[i, step])
            data.mocap_quat[:] = np.stack([np.cos(angle), 0 * angle, 0 * angle, np.sin(angle)], -1)
            mujoco.mj_step(model, data)
            pairs = {names[g].split("/")[1] for c in data.contact[: data.ncon] for g in c.geom if "agent" in names[g]}
            places.append(data.qpos[:3].copy())
            touched.append([str(a) in pairs for a in range(2)])
    shape = (len(ENCOUNTERS), NUM_STEPS * substeps)
    return np.reshape(places, (*shape, 3)), np.reshape(touched, (*shape, 2)), np.zeros(shape, bool)


def first_qpos(robot: Any, size: int) -> np.ndarray:
    qpos = np.zeros(size)
    qpos[:4] = *START[:2], START[2] + robot.spawn_height, 1.0
    return qpos


@functools.cache
def in_engine(impl: str) -> tuple[np.ndarray, np.ndarray, Any]:
    """Robot's places (N, S, 3), hits (N, S), and the contacts of each control step."""
    bank, robot, moving = free_bank(), make_coco("differential"), motions()
    engine = make_engine(bank, robot, impl=impl, control_dt=CONTROL_DT, agents=SHAPES)
    count = len(ENCOUNTERS)
    qpos = np.tile(first_qpos(robot, engine.physics.model.nq), (count, 1))
    ctrl = np.stack([np.asarray(robot.command(jnp.array([speed, 0.0]))) for speed, *_ in ENCOUNTERS.values()])
    state = jax.jit(jax.vmap(engine.init))(np.zeros(count, int), qpos, np.zeros((count, engine.physics.model.nv)))
    step = jax.jit(jax.vmap(engine.step_and_record))
    places, hits, contacts = [], [], []
    for t in range(NUM_STEPS):
        state, record = step(state, ctrl, jax.tree.map(lambda x, t=t: x[:, t], moving))
        places.append(np.asarray(record.qpos)[..., :3])
        hits.append(np.asarray(record.hit))
        contacts.append(jax.tree.map(np.asarray, state.contacts))
        assert not np.asarray(state.slot_overflow).any()
    return np.concatenate(places, 1), np.concatenate(hits, 1), jax.tree.map(lambda *x: np.stack(x, 1), *contacts)


def test_distances_are_those_of_c_mujoco() -> None:
    """Spheres anywhere around both shapes: the prism is the union of its cylinders and its box."""
    rng = np.random.default_rng(0)
    model = with_prisms(mujoco.MjSpec())
    model.worldbody.add_body(name="probe", mocap=True).add_geom(
        name="probe", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.1, 0, 0)
    )
    model = model.compile()
    data = mujoco.MjData(model)
    heading = np.array([0.4, -1.1])
    data.mocap_quat[:2] = np.stack([np.cos(heading / 2), [0, 0], [0, 0], np.sin(heading / 2)], -1)
    points = rng.uniform([-1.5, -1.5, -0.5], [1.5, 1.5, 2.4], (300, 3))
    distance = jax.jit(lambda p: agent_slots.prism_distance(p, jnp.asarray(heading), SHAPES))
    gaps, routes = (np.asarray(x) for x in distance(jnp.asarray(points[:, None], jnp.float32)))
    back = np.asarray(distance(jnp.asarray(points[:, None] - gaps[..., None] * routes, jnp.float32))[0])
    np.testing.assert_allclose(back, 0.0, atol=2e-5, err_msg="a step back along the normal ends on the surface")
    np.testing.assert_allclose(np.linalg.norm(routes, axis=-1), 1.0, atol=1e-5)
    probe, line = model.geom("probe").id, np.zeros(6)
    geoms = [np.flatnonzero(model.geom_bodyid == model.body(f"agent/{a}").id) for a in range(2)]
    for point, gap in zip(points, gaps - 0.1, strict=True):
        data.mocap_pos[2] = point
        mujoco.mj_kinematics(model, data)
        for a in range(2):
            nearest = min(mujoco.mj_geomDistance(model, data, g, probe, 10.0, line) for g in geoms[a])
            # Inside, each part of the union gives only its own exit direction.
            assert gap[a] <= nearest + 2e-5
            assert gap[a] <= 0.0 or gap[a] == pytest.approx(nearest, abs=2e-5)


@wp.kernel
def warp_distances(
    offset: wp.array[wp.vec3], turn: float, radius: float, half: float, height: float, found: wp.array[wp.vec4]
):
    """Direction and distance of each point."""
    i = wp.tid()
    found[i] = prism_distance(offset[i], turn, radius, half, height)  # pyright: ignore


def test_distances_in_warp_are_those_in_jax() -> None:
    """Of a person, half a car, and a low and wide shape whose lower and upper end are the nearest ones inside."""
    shapes = AgentShapes(*(np.array(a, np.float32) for a in ((0.27, 0.4, 0.9), (0.0, 0.6, 0.5), (1.75, 1.4, 0.8))))
    heading = np.array([0.4, -1.1, 2.0], np.float32)
    points = np.random.default_rng(1).uniform([-1.5, -1.5, -0.5], [1.5, 1.5, 2.4], (3000, 3)).astype(np.float32)
    points[:200, :2] *= 0.1
    distance, routes = jax.jit(agent_slots.prism_distance)(points[:, None], heading, shapes)
    for a, shape in enumerate(zip(heading, *shapes, strict=True)):
        with wp.ScopedDevice("cpu"):
            found = wp.zeros(len(points), dtype=wp.vec4)
            wp.launch(
                warp_distances,
                len(points),
                inputs=[wp.array(points, dtype=wp.vec3), *map(float, shape)],
                outputs=[found],
            )
        np.testing.assert_allclose(found.numpy()[:, 3], distance[:, a], atol=1e-6)
        np.testing.assert_allclose(found.numpy()[:, :3], routes[:, a], atol=2e-4)


@pytest.mark.parametrize("impl", [pytest.param("jax", marks=pytest.mark.slow), "warp", "warp-fused"])
def test_runs_into_agents_are_those_of_c_mujoco(impl: str) -> None:
    """Onset within one physics step; 1 mm before it; 1 s after it 5 mm in the median and 50 mm at most (design 3)."""
    reference_places, touched, _ = in_c_mujoco()
    places, hits, contacts = in_engine(impl)
    apart = np.linalg.norm(reference_places - places, axis=-1)
    any_touch = touched.any(-1)
    second = round(1.0 / make_coco().physics_timestep)
    after = []
    for i, name in enumerate(ENCOUNTERS):
        met, found = any_touch[i].any(), hits[i].any()
        assert met == found, name
        assert met == (name != "passed by"), name
        onset = int(any_touch[i].argmax()) if met else len(hits[i])
        assert apart[i, :onset].max(initial=0.0) < 1e-3, name
        if met:
            assert abs(int(hits[i].argmax()) - onset) <= 1, name
            after.append(apart[i, min(onset + second, hits.shape[1] - 1)])
            who = int(touched[i].any(0).argmax())
            named = contacts.hit_agent[i][contacts.hit_agent[i] >= 0]
            assert set(named) == {who}, name
            assert (contacts.hit_object[i] == -1).all()
            assert not contacts.hit_ground[i].any()
            assert contacts.hit_force[i].max() > 10.0
        else:
            assert (contacts.hit_agent[i] == -1).all()
    assert np.median(after) < 5e-3, after
    assert max(after) < 0.05, after


@pytest.mark.extended
@pytest.mark.mjx
def test_without_agents_no_line_of_theirs_is_traced(monkeypatch: pytest.MonkeyPatch) -> None:
    """The program of an engine without agents is the one it was: same text with all agent functions broken."""
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    engine = JaxEngine(free_bank(), make_coco("differential"), control_dt=0.02)
    qpos = first_qpos(engine.robot, engine.physics.model.nq)
    state = jax.eval_shape(engine.init, 0, qpos, np.zeros(engine.physics.model.nv))
    assert state.contacts.hit_agent is None
    for name in ("moved", "with_agents", "noted", "prism_distance"):
        monkeypatch.setattr(agent_slots, name, None)
    jaxpr = str(jax.make_jaxpr(engine.step)(state, np.zeros(engine.physics.model.nu, np.float32)))
    assert "jit" in jaxpr
    with pytest.raises(ValidationError, match="2 of them"):
        jax.eval_shape(
            engine.step, state, np.zeros(engine.physics.model.nu), jax.tree.map(lambda x: x[0, 0], motions())
        )
