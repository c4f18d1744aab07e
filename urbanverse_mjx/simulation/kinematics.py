"""Forward kinematics of a robot in JAX, without MJX, so that the Warp engine also runs where MJX is absent."""

from typing import Any

import jax.numpy as jnp
import mujoco

from ..geometry import rotations


def forward(model: mujoco.MjModel, qpos: Any) -> tuple[Any, Any, Any]:
    """Computes the frames of all bodies, as `mj_kinematics` does (MuJoCo, engine_core_smooth.c).

    Args:
      model: of the robot.
      qpos: (nq,) f32.

    Returns:
      qpos (nq,) with unit quaternions, xpos (nbody, 3) m, xquat (nbody, 4).
    """
    joint_types = mujoco.mjtJoint
    places, turns = [jnp.zeros(3)], [jnp.array([1.0, 0.0, 0.0, 0.0])]
    for body in range(1, model.nbody):
        parent = model.body_parentid[body]
        place = places[parent] + rotations.rotate(turns[parent], jnp.asarray(model.body_pos[body], jnp.float32))
        turn = rotations.product(turns[parent], jnp.asarray(model.body_quat[body], jnp.float32))
        first = model.body_jntadr[body]
        for joint in range(first, first + model.body_jntnum[body]):
            at, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
            anchor, axis = (jnp.asarray(x[joint], jnp.float32) for x in (model.jnt_pos, model.jnt_axis))
            if kind == joint_types.mjJNT_FREE:
                turn = rotations.unit(qpos[at + 3 : at + 7])
                place, qpos = qpos[at : at + 3], qpos.at[at + 3 : at + 7].set(turn)
                continue
            if kind == joint_types.mjJNT_SLIDE:
                place = place + rotations.rotate(turn, axis) * (qpos[at] - model.qpos0[at])
                continue
            fixed = place + rotations.rotate(turn, anchor)
            if kind == joint_types.mjJNT_BALL:
                own = rotations.unit(qpos[at : at + 4])
                qpos = qpos.at[at : at + 4].set(own)
            else:
                half = 0.5 * (qpos[at] - model.qpos0[at])
                own = jnp.concatenate([jnp.cos(half)[None], jnp.sin(half) * axis])
            turn = rotations.product(turn, own)
            place = fixed - rotations.rotate(turn, anchor)
        places.append(place)
        turns.append(turn)
    return qpos, jnp.stack(places), jnp.stack([rotations.unit(turn) for turn in turns])
