"""Drake's coordinates.

::

    joint      q_e                     T                 b
    free       quaternion wxyz, p      [[0, R], [R, 0]]  (0, R (ω × v)): [angular; linear] in joint-frame axes, R from body to joint frame
    spherical  roll, pitch, yaw of R   R                 0: angular velocity in joint-frame axes
    all other  q                       identity          0
"""

from __future__ import annotations

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RollPitchYaw

from featherbench_oracles.abilities.derivatives import Rates, of_turned_ball, of_turned_free
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description, Joint


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert positions to Drake's."""
    return np.concatenate([_joint_q(body.joint, q[body.joint.q]) for body in robot.bodies])


def _joint_q(joint: Joint, q: Array) -> Array:
    if joint.type == "spherical":
        return RollPitchYaw(Quaternion(wxyz=np.roll(q / np.linalg.norm(q), 1))).vector()
    if joint.type == "free":
        return np.concatenate([np.roll(q[3:], 1), q[:3]])
    return q


def change_of_velocities(robot: Description, q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "spherical":
            blocks.append((joint.v, rotation(q[joint.q])))
        if joint.type == "free":
            r, zero = rotation(q[joint.q][3:]), np.zeros((3, 3))
            linear, angular = v[joint.v][:3], v[joint.v][3:]
            blocks.append((joint.v, np.block([[zero, r], [r, zero]])))
            bias[joint.v] = np.append(np.zeros(3), r @ np.cross(angular, linear))
    return CoordinateChange(tuple(blocks), bias)


SWAP = np.roll(np.eye(6), 3, axis=0)  # exchanges the halves of a free joint's velocity


def rates_of_change(robot: Description, q: Array, v: Array) -> tuple[Rates, ...]:
    """Differentiate T and b of the table: those of free and spherical joints depend on the rotation."""
    rates = []
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "spherical":
            rates.append(of_turned_ball(joint.v, rotation(q[joint.q])))
        if joint.type == "free":
            rates.append(of_turned_free(joint.v, rotation(q[joint.q][3:]), v[joint.v], SWAP))
    return tuple(rates)
