"""MuJoCo's coordinates.

::

    joint      q_e                               T             b
    free       p of the world, quaternion wxyz   diag(R, 1)    (R (ω × v), 0): linear velocity in world axes, R from body to world
    spherical  quaternion wxyz                   identity      0
    all other  q                                 identity      0

A free joint's q_e is the pose in the *world*: the neutral pose composed with the joint's placement.
"""

from __future__ import annotations

import mujoco as mj
import numpy as np

from featherbench_oracles.abilities.derivatives import Rates, of_turned_free
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Body, Description


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert positions to MuJoCo's."""
    return np.concatenate([_joint_q(body, q[body.joint.q]) for body in robot.bodies])


def _joint_q(body: Body, q: Array) -> Array:
    joint = body.joint
    if joint.type == "spherical":
        return np.roll(q, 1)
    if joint.type == "free":
        quaternion = np.empty(4)
        mj.mju_mulQuat(quaternion, wxyz(joint.rotation), np.roll(q[3:], 1))
        return np.append(joint.rotation @ q[:3] + joint.translation, quaternion)
    return q


def change_of_velocities(robot: Description, q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "free":
            linear = slice(joint.v.start, joint.v.start + 3)
            r = joint.rotation @ rotation(q[joint.q][3:])
            blocks.append((linear, r))
            bias[linear] = r @ np.cross(v[joint.v][3:], v[linear])
    return CoordinateChange(tuple(blocks), bias)


def rates_of_change(robot: Description, q: Array, v: Array) -> tuple[Rates, ...]:
    """Differentiate T and b of the table: those of free joints depend on the rotation."""
    free = [body.joint for body in robot.bodies if body.joint.type == "free"]
    return tuple(of_turned_free(joint.v, joint.rotation @ rotation(q[joint.q][3:]), v[joint.v], np.eye(6)) for joint in free)


def wxyz(matrix: Array) -> Array:
    """Compute MuJoCo's quaternion of a rotation.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        The rotation.

    Returns
    -------
    ndarray, shape (4,)
        (w, x, y, z), of length one.
    """
    quaternion = np.empty(4)
    mj.mju_mat2Quat(quaternion, matrix.ravel())
    return quaternion


def from_wxyz(quaternion: Array) -> Array:
    """Compute the rotation of MuJoCo's quaternion.

    Parameters
    ----------
    quaternion : ndarray, shape (4,)
        (w, x, y, z).

    Returns
    -------
    ndarray, shape (3, 3)
        The rotation.
    """
    return rotation(np.roll(quaternion, -1))
