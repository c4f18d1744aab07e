"""Kinematics of a robot's arm in JAX: where its fingertip is, the joint angles that bring it to a place, and the
torques that hold it there.

In:   joint angles, a place, a direction.
Out:  places, Jacobians, joint angles, torques.
When: inside jit, per env: in scripted controllers and in tasks.

Inverse kinematics by damped least squares (Wampler, "Manipulator inverse kinematic solutions based on vector
formulations and damped least-squares methods", 1986); a force at the fingertip needs the torques J^T f, and a position
servo of gain k that stands at q gives k (target - q).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from ..datatypes import RobotSpec, ValidationError
from ..geometry import rotations

#: Damping (m), weight of the hand's direction (m/rad), largest change of an angle (rad) and number of iterations.
DAMPING, DIRECTION_WEIGHT, LARGEST_STEP, ITERATIONS = 0.03, 0.15, 0.4, 12
#: rad from the ends of the joints' ranges that solutions keep.
LIMIT_MARGIN = 0.03


class ArmPose(NamedTuple):
    """An arm in one pose, in the frame of the robot's root body.

    Attributes:
      anchor, axis: (J, 3) m and unit vectors, of the joints.
      tip: (3,) m, centre of the fingertip.
      hand: (3,) unit vector from the last joint to the fingertip.
      centre: (J, 3) m, centres of mass of the links.
    """

    anchor: Any
    axis: Any
    tip: Any
    hand: Any
    centre: Any

    def jacobian(self) -> Any:
        """(3, J) m/rad of the fingertip."""
        return jnp.cross(self.axis, self.tip - self.anchor).T


class ArmReach:
    """The kinematics of a robot's arm.

    Args:
      robot: with an `Arm`, each of whose links has one joint at its origin.
      beyond: m along the hand from the fingertip's centre to the point that is meant by the fingertip.

    Attributes:
      low, high: (J,) rad, ends of the ranges.
      gain: (J,) N m/rad, of the servos.
      addresses: (J,) i32, places of the angles in qpos; speeds: (J,) i32, of their speeds in qvel.
      hand: number of the body at the end.
      tip: (3,) m, the fingertip's centre in it.

    Raises:
      ValidationError: the robot has no arm.
    """

    def __init__(self, robot: RobotSpec, beyond: float = 0.0) -> None:
        if robot.arm is None:
            raise ValidationError(f"robot {robot.name!r}: found no arm, needed one, such as that of 'coco_arm'.")
        model = mujoco.MjModel.from_xml_string(robot.mjcf)
        joints = [model.joint(name).id for name in robot.arm.joints]
        links = model.jnt_bodyid[joints]
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        root, foot = model.body(robot.root_body).id, model.body_parentid[links[0]]
        turn = data.xmat[root].reshape(3, 3).T
        #: T_root_foot of the body that carries the arm.
        self._place = jnp.asarray(turn @ (data.xpos[foot] - data.xpos[root]), jnp.float32)
        self._turn = jnp.asarray(turn @ data.xmat[foot].reshape(3, 3), jnp.float32)
        self._to_next = jnp.asarray(model.body_pos[links], jnp.float32)
        self._axis = jnp.asarray(model.jnt_axis[joints], jnp.float32)
        self._centre, self._mass = (jnp.asarray(x[links], jnp.float32) for x in (model.body_ipos, model.body_mass))
        geom = model.geom(robot.arm.tip).id
        tip = model.geom_pos[geom]
        self.tip = jnp.asarray(tip + beyond * tip / np.linalg.norm(tip), jnp.float32)
        self.hand = int(links[-1])
        self.low, self.high = jnp.asarray(model.jnt_range[joints].T, jnp.float32)
        self.gain = jnp.asarray(model.actuator_gainprm[list(robot.arm.actuators), 0], jnp.float32)
        self.addresses, self.speeds = np.array(model.jnt_qposadr[joints]), np.array(model.jnt_dofadr[joints])

    def shares(self, angles: Any) -> Any:
        """(J,) in [-1, 1], the places in their ranges of angles (J,) rad, as actions have them."""
        return 2.0 * (angles - self.low) / (self.high - self.low) - 1.0

    def angles(self, shares: Any) -> Any:
        """(J,) rad at shares (J,) of the ranges; the inverse of `shares`."""
        return self.low + 0.5 * (shares + 1.0) * (self.high - self.low)

    def pose(self, angles: Any) -> ArmPose:
        """The pose at (J,) rad."""
        place, turn = self._place, self._turn
        anchor, axis, centre = [], [], []
        for k in range(len(self.addresses)):
            place = place + turn @ self._to_next[k]
            anchor.append(place)
            axis.append(turn @ self._axis[k])
            turn = turn @ rotations.matrix(rotations.from_rotation_vector(angles[k] * self._axis[k]))
            centre.append(place + turn @ self._centre[k])
        reach = turn @ self.tip
        hand = reach / jnp.linalg.norm(reach)
        return ArmPose(jnp.stack(anchor), jnp.stack(axis), place + reach, hand, jnp.stack(centre))

    def holding(self, pose: ArmPose, force: Any = 0.0) -> Any:
        """(J,) N m that hold the arm against gravity in an upright robot and give a force (3,) N at the fingertip, in
        the root body's frame."""
        weight = jnp.stack([jnp.zeros_like(self._mass), jnp.zeros_like(self._mass), 9.81 * self._mass], -1)
        # A joint carries the links after it and its own.
        arms = pose.centre[None] - pose.anchor[:, None]
        moments = (jnp.cross(arms, weight[None]) * pose.axis[:, None]).sum(-1)
        own = jnp.triu(jnp.ones_like(moments))
        return (own * moments).sum(1) + pose.jacobian().T @ jnp.broadcast_to(jnp.asarray(force), (3,))

    def solve(self, angles: Any, place: Any, direction: Any) -> tuple[Any, Any]:
        """Angles (J,) rad at which the fingertip is at a place (3,) m and the hand points along a direction (3,), if
        they are within reach, and the distance () m that remains.

        Args:
          angles: (J,) rad, from which to start.
        """
        low, high = self.low + LIMIT_MARGIN, self.high - LIMIT_MARGIN

        def improve(_: int, q: Any) -> Any:
            pose = self.pose(q)
            error = jnp.concatenate([place - pose.tip, DIRECTION_WEIGHT * (direction - pose.hand)])
            turning = DIRECTION_WEIGHT * jnp.cross(pose.axis, pose.hand).T
            jacobian = jnp.concatenate([pose.jacobian(), turning])
            square = jacobian @ jacobian.T + DAMPING**2 * jnp.identity(6)
            step = jacobian.T @ jnp.linalg.solve(square, error)
            step = step * jnp.minimum(1.0, LARGEST_STEP / jnp.maximum(jnp.abs(step).max(), 1e-6))
            return jnp.clip(q + step, low, high)

        found = jax.lax.fori_loop(0, ITERATIONS, improve, jnp.clip(angles, low, high))
        return found, jnp.linalg.norm(self.pose(found).tip - place)
