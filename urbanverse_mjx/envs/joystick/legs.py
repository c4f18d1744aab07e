"""Data of a legged robot read from its MJCF: joints, servos, feet."""

import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from ...datatypes import RobotSpec, SimState, ValidationError
from ...geometry import rotations


class Legs:
    """Data of a robot's model for the env: joints, servos and feet, all constant arrays.

    A foot is a body with one or more of the robot's foot spheres, each foot with as many.

    Raises:
      ValidationError: the actuators are not position servos, one per joint in order, or feet differ.
    """

    def __init__(self, robot: RobotSpec, scale: tuple[float, ...]) -> None:
        model = mujoco.MjModel.from_xml_string(robot.mjcf)
        joints = np.arange(1, model.njnt)
        kp = model.actuator_gainprm[:, 0]
        if model.nu != len(joints) or (model.actuator_trnid[:, 0] != joints).any() or not model.nkey:
            raise ValidationError(
                f"robot {robot.name!r}: found {model.nu} actuators for {len(joints)} joints and {model.nkey} "
                "keyframes, needed a position servo for each joint, in their order, and the standing pose as the first "
                "keyframe."
            )
        self.model, self.root = model, model.body(robot.root_body).id
        self.stand = jnp.asarray(model.key_qpos[0, 7:], jnp.float32)
        self.limits = jnp.asarray(model.jnt_range[1:], jnp.float32)
        self.kp, self.kd = jnp.asarray(kp, jnp.float32), jnp.asarray(model.dof_damping[6:], jnp.float32)
        self.max_torque = jnp.asarray(model.actuator_forcerange[:, 1], jnp.float32)
        self.scale = jnp.tile(jnp.array(scale, jnp.float32), model.nu // len(scale))
        feet = [model.geom(name) for name in robot.foot_geoms]
        bodies = np.array([g.bodyid[0] for g in feet])
        self.foot_body, count = np.unique(bodies, return_counts=True)
        if len(set(count)) != 1:
            raise ValidationError(
                f"robot {robot.name!r}: found feet of {', '.join(map(str, sorted(set(count))))} spheres, needed as "
                "many in each."
            )
        #: (F, G) rows of `foot_geoms`, the spheres of each foot.
        self.spheres = np.array([np.flatnonzero(bodies == body) for body in self.foot_body])
        places = np.array([g.pos for g in feet])[self.spheres].mean(1)
        self.foot_place = jnp.asarray(places, jnp.float32)
        self.sole = jnp.asarray(np.array([g.size[0] for g in feet])[self.spheres].mean(1), jnp.float32)

    @property
    def number(self) -> int:
        return self.model.nu

    def feet(self, sim: SimState) -> Float[Array, "F 3"]:
        """(F, 3) m, centres of the feet: the means of their spheres' middles."""
        return sim.xpos[self.foot_body] + rotations.rotate(sim.xquat[self.foot_body], self.foot_place)

    def foot_force(self, sim: SimState) -> Float[Array, " F"]:
        """(F,) N, contact forces of the feet: the sums of their spheres'."""
        return sim.contacts.foot_force[..., self.spheres].sum(-1)

    def torque(
        self, ctrl: Float[Array, " J"], qpos: Float[Array, " nq"], qvel: Float[Array, " nv"]
    ) -> Float[Array, " J"]:
        """(J,) N m, torques of the servos including damping."""
        push = jnp.clip(self.kp * (ctrl - qpos[7:]), -self.max_torque, self.max_torque)
        return push - self.kd * qvel[6:]
