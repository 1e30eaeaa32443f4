"""DART's coordinates.

::

    joint      q_e                     T                 b
    free       log R, p                [[0, R], [R, 0]]  (0, R (ω × v)): [angular; linear] in the *parent body's* axes
    spherical  log R                   identity          0: angular velocity in body axes
    euler_zyx  z, -y, x                diag(1, -1, 1)    0: DART's order is x, y, z (Python cannot set another); its axes are turned by AXES
    all other  q                       identity          0

R of a free joint turns body axes to those of the parent body in T and b, and to those of the joint's frame in log R. The axes are those of
DART's bodies. For a robot read from a file they need not be those of the description's bodies, so DART itself is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2

import numpy as np
from dartpy import dynamics

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description, Joint

AXES = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])  # takes DART's x, y, z to our z, -y, x
MIRROR = np.diag([1.0, -1.0, 1.0])


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert positions to DART's: quaternions become rotation vectors, and nq of DART is nv."""
    return np.concatenate([_joint_q(body.joint, q[body.joint.q]) for body in robot.bodies])


def _joint_q(joint: Joint, q: Array) -> Array:
    if joint.type == "spherical":
        return log(q)
    if joint.type == "free":
        return np.append(log(q[3:]), q[:3])
    if joint.type == "euler_zyx":
        return MIRROR @ q
    return q


def log(quaternion: Array) -> Array:
    """Compute the rotation vector of a quaternion, without arccos, which loses half of the digits near 0.

    Parameters
    ----------
    quaternion : ndarray, shape (4,)
        (x, y, z, w).

    Returns
    -------
    ndarray, shape (3,)
        Of length at most pi, rad.
    """
    u, w = (quaternion[:3], quaternion[3]) if quaternion[3] >= 0 else (-quaternion[:3], -quaternion[3])
    sine = np.linalg.norm(u)
    return 2 * atan2(sine, w) / sine * u if sine > 0 else np.zeros(3)


def exponential(turn: Array) -> Array:
    """Compute the quaternion of a rotation vector: the inverse of `log`.

    Parameters
    ----------
    turn : ndarray, shape (3,)
        The rotation vector, rad.

    Returns
    -------
    ndarray, shape (4,)
        (x, y, z, w), of length one.
    """
    angle = float(np.linalg.norm(turn))
    # np.sinc(x) is sin(pi x) / (pi x), and one at zero.
    return np.append(0.5 * np.sinc(0.5 * angle / np.pi) * turn, np.cos(0.5 * angle))


def change_of_velocities(robot: Description, made: Sequence[dynamics.Joint], q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table; `made` are DART's joints of the robot."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint, mine in zip((body.joint for body in robot.bodies), made, strict=True):
        if joint.type == "euler_zyx":
            blocks.append((joint.v, MIRROR))
        if joint.type == "free":
            r, zero = mine.getTransformFromParentBodyNode().rotation() @ rotation(q[joint.q][3:]), np.zeros((3, 3))
            linear, angular = v[joint.v][:3], v[joint.v][3:]
            blocks.append((joint.v, np.block([[zero, r], [r, zero]])))
            bias[joint.v] = np.append(np.zeros(3), r @ np.cross(angular, linear))
    return CoordinateChange(tuple(blocks), bias)
