"""Pinocchio's coordinates.

::

    joint      q_e                      T               b
    planar     x, y, cos θ, sin θ       diag(R(θ)', 1)  (θ̇ v_y, -θ̇ v_x, 0) with v = R(θ)' (ẋ, ẏ): Pinocchio's v is in body axes
    all other  q                        identity        0
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from featherbench_oracles.abilities.derivatives import Rates
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert positions to Pinocchio's: a planar joint's angle becomes its cosine and sine."""
    return np.concatenate([_planar_q(*q[b.joint.q]) if b.joint.type == "planar" else q[b.joint.q] for b in robot.bodies])


def _planar_q(x: float, y: float, theta: float) -> Array:
    return np.array([x, y, np.cos(theta), np.sin(theta)])


def change_of_velocities(robot: Description, q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "planar":
            theta, rate = q[joint.q][2], v[joint.v][2]
            c, s = np.cos(theta), np.sin(theta)
            t = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            vx, vy, _ = t @ v[joint.v]
            blocks.append((joint.v, t))
            bias[joint.v] = rate * vy, -rate * vx, 0
    return CoordinateChange(tuple(blocks), bias)


def rates_of_change(robot: Description, q: Array, v: Array) -> tuple[Rates, ...]:
    """Differentiate T and b of the table: those of planar joints depend on θ alone."""
    rates = []
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "planar":
            theta, (x, y, rate) = q[joint.q][2], v[joint.v]
            c, s = np.cos(theta), np.sin(theta)
            t_dq, b_dq = np.zeros((3, 3, 3)), np.zeros((3, 3))
            t_dq[2] = [[-s, c, 0], [-c, -s, 0], [0, 0, 0]]
            b_dq[:2, 2] = rate * (-c * x - s * y), rate * (s * x - c * y)
            b_dv = np.array([[-rate * s, rate * c, c * y - s * x], [-rate * c, -rate * s, -c * x - s * y], [0, 0, 0]])
            rates.append(Rates(joint.v, t_dq, b_dq, b_dv))
    return tuple(rates)


def to_our_parameters(regressor: Array) -> Array:
    """Reorder the columns of a regressor, ten for each body.

    Parameters
    ----------
    regressor : ndarray, shape (nv, 10 bodies)
        By Pinocchio's parameters: mass, first moments, then the inertia about the origin: xx, xy, yy, xz, yz, zz. Where nv is 1, its
        shape is (10 bodies,).

    Returns
    -------
    ndarray, shape (nv, bodies, 10)
        By mass, first moments, and xx, xy, xz, yy, yz, zz.
    """
    rows = np.atleast_2d(regressor)
    theirs = rows.reshape(len(rows), -1, 10)
    return theirs[:, :, [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]]


def to_angular_first(motion: pin.Motion | pin.Force) -> Array:
    """Reorder a 6-vector of Pinocchio, which begins with the linear part.

    Parameters
    ----------
    motion : pin.Motion | pin.Force
        A motion or a force.

    Returns
    -------
    ndarray, shape (6,)
        [angular; linear], in the units of the motion.
    """
    return np.concatenate([motion.angular, motion.linear])
