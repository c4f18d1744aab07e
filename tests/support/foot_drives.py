"""Drives with contacts of some of a robot's feet, in C MuJoCo and in the engines."""

from typing import Any, NamedTuple

import jax
import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, SceneBank
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco


class Run(NamedTuple):
    """qpos (T, N, nq), place (T, N, 3) m and turn (T, N, 4) of a body; force (T, N) N on the feet, the mean of each
    control step; hit (T, N) bool."""

    qpos: np.ndarray
    place: np.ndarray
    turn: np.ndarray
    force: np.ndarray
    hit: np.ndarray


def in_c_mujoco(
    scene: mujoco.MjSpec,
    robot: RobotSpec,
    start: np.ndarray,
    ctrl: np.ndarray,
    dt: float,
    feet: tuple[str, ...],
    body: str,
) -> Run:
    """Drives from (N, nq) by commands (T, N, nu), each held for `dt` s.

    Args:
      scene: whose geoms named "ground..." the feet of the robot may touch.
      feet: names of those of `robot.foot_geoms` whose forces are wanted.
      body: of the robot.
    """
    model = c_mujoco.reference_model(scene, robot)
    names = [model.geom(g).name for g in range(model.ngeom)]
    wanted = {model.geom(f"robot/{name}").id for name in feet}
    allowed = {model.geom(f"robot/{name}").id for name in robot.foot_geoms}
    number, substeps = model.body(f"robot/{body}").id, round(dt / model.opt.timestep)
    shape, wrench = ctrl.shape[:2], np.zeros(6)
    qpos, place, turn = (np.zeros((*shape, n)) for n in (model.nq, 3, 4))
    out = Run(qpos, place, turn, np.zeros(shape), np.zeros(shape, bool))
    for i in range(len(start)):
        data = mujoco.MjData(model)
        data.qpos[:] = start[i]
        for step in range(len(ctrl)):
            data.ctrl[:] = ctrl[step, i]
            for _ in range(substeps):
                mujoco.mj_step(model, data)
                for k, contact in enumerate(data.contact[: data.ncon]):
                    pair = {int(g) for g in contact.geom}
                    ground = any(names[g].startswith("ground") for g in pair)
                    if contact.dist < 0 and not (ground and pair & allowed):
                        out.hit[step, i] = True
                    if pair & wanted:
                        mujoco.mj_contactForce(model, data, k, wrench)
                        out.force[step, i] += wrench[0] / substeps
            out.qpos[step, i] = data.qpos
            mujoco.mj_kinematics(model, data)
            out.place[step, i], out.turn[step, i] = data.xpos[number], data.xquat[number]
    return out


def in_engine(
    impl: str,
    bank: SceneBank,
    robot: RobotSpec,
    start: np.ndarray,
    ctrl: np.ndarray,
    dt: float,
    feet: tuple[str, ...],
    body: str,
) -> Run:
    """The same in an engine, in the bank's first scene."""
    engine = make_engine(bank, robot, impl=impl, control_dt=dt)
    number, own = engine.physics.model.body(body).id, [robot.foot_geoms.index(name) for name in feet]
    step: Any = jax.jit(jax.vmap(engine.step))
    scene, speed = np.zeros(len(start), np.int32), np.zeros((len(start), engine.physics.model.nv), np.float32)
    state = jax.jit(jax.vmap(engine.init))(scene, start, speed)
    rows = []
    for now in ctrl:
        state = step(state, now)
        force = np.array(state.contacts.foot_force)[:, own].sum(1)
        rows.append((state.qpos, state.xpos[:, number], state.xquat[:, number], force, state.contacts.hit))
        assert not np.array(state.slot_overflow).any()
    return Run(*(np.stack([np.array(y) for y in x]) for x in zip(*rows, strict=True)))
