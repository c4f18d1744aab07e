"""The controller of a robot on two wheels, which keeps it upright and drives it at a commanded velocity.

In: `Row` with the drive "balance". Out: `Gait` with one linear layer. When: once, at construction.

A linear-quadratic regulator of the pendulum on wheels (pitch, pitch rate, speed), and a proportional one of the yaw
rate: the sensors of a gait hold all of these, so `simulation.gait_engine` runs it like the gait of a robot with legs.
"""

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from ..gait import JOINT_RATE_UNIT, RATE_UNIT, Gait
from .mjcf import chassis
from .rows import Row

#: s, control step.
CONTROL_DT = 0.01
#: Costs of 1 rad, 1 rad/s and 1 m/s, and of the share 1 of the torque.
_STATE_COST, _TORQUE_COST = (20.0, 1.0, 25.0), 10.0
#: Torque of a motor by the weight of the robot on its wheel's radius: less than what the tyres hold.
_TORQUE_SHARE = 0.3
#: s, lag of the yaw rate.
_TURN_LAG = 0.3
_GRAVITY = 9.81


def plant(row: Row) -> tuple[np.ndarray, np.ndarray, float]:
    """A (3, 3) and B (3,) of d/dt (pitch, pitch rate, speed) for the share 1 of both motors' torque, and that torque
    (N m) of one motor."""
    wheel, (mass, centre, inertia) = row.wheels[0], chassis(row)
    arm, radius = float(centre[2] - wheel.radius), wheel.radius
    torque = _TORQUE_SHARE * row.mass * _GRAVITY * radius / 2.0
    rolling = mass + 2.0 * 1.5 * wheel.mass
    mixed = np.array([[float(inertia[1]) + mass * arm**2, mass * arm], [mass * arm, rolling]])
    gravity, push = np.linalg.solve(mixed, [mass * _GRAVITY * arm, 0.0]), np.linalg.solve(mixed, [-1.0, 1.0 / radius])
    a = np.array([[0.0, 1.0, 0.0], [gravity[0], 0.0, 0.0], [gravity[1], 0.0, 0.0]])
    return a, np.array([0.0, push[0], push[1]]) * 2.0 * torque, torque


def balance_gait(row: Row) -> Gait:
    """The controller of a robot on two wheels."""
    a, b, torque = plant(row)
    block = expm(np.block([[a, b[:, None]], [np.zeros((1, 4))]]) * CONTROL_DT)
    ad, bd = block[:3, :3], block[:3, 3:]
    cost = solve_discrete_are(ad, bd, np.diag(_STATE_COST), np.array([[_TORQUE_COST]]))
    pitch, rate, speed = -np.linalg.solve(_TORQUE_COST + bd.T @ cost @ bd, bd.T @ cost @ ad)[0]
    wheel = row.wheels[0]
    turned = float(chassis(row)[2][2]) + 2.0 * 1.5 * wheel.mass * wheel.y**2
    yaw = turned * wheel.radius / (2.0 * wheel.y * torque * _TURN_LAG)
    # Rows of the sensors of `gait.sensor_frame`: angular velocity 3, gravity 3, joints 2, their speeds 2, command 3,
    # action 2. The wheels turn relative to the body, which pitches.
    kernel = np.zeros((15, 2), np.float32)
    for side, sign in ((0, -1.0), (1, 1.0)):
        kernel[1, side] = (rate + speed * wheel.radius) / RATE_UNIT
        kernel[2, side] = -sign * yaw / RATE_UNIT
        kernel[3, side] = pitch
        kernel[8:10, side] = 0.5 * speed * wheel.radius / JOINT_RATE_UNIT
        kernel[10, side] = -speed
        kernel[12, side] = sign * yaw
    scale = np.full(2, torque, np.float32)
    zero = np.zeros(2, np.float32)
    return Gait((kernel,), (zero,), zero, scale, 1, CONTROL_DT, {"robot": row.name, "training": "none: LQR"})
