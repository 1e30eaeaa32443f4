"""Simbody's coordinates, as OpenSim's joints have them.

::

    joint      q_e                                          T                 b
    free       angles x, y, z of R about moving axes, p     [[0, R], [R, 0]]  (0, R (ω × v)): [angular; linear] in joint axes
    spherical  angles x, y, z of R about moving axes        R                 0
    all other  q                                            identity          0

R of a joint turns the body's axes to those of its joint's frame on the parent. u_e is no derivative of q_e. At a second angle of ±90° the
first and the third turn about one axis: R is right, and they are two of many.
"""

from __future__ import annotations

import math

import numpy as np

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description


def to_engine_q(robot: Description, q: Array) -> list[Array]:
    """Convert positions to those of OpenSim's coordinates, joint by joint."""
    found = []
    for body in robot.bodies:
        own = q[body.joint.q]
        if body.joint.type == "free":
            own = np.append(angles(rotation(own[3:])), own[:3])
        elif body.joint.type == "spherical":
            own = angles(rotation(own))
        found.append(own)
    return found


def change_of_velocities(robot: Description, q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`."""
    bias, blocks, zero = np.zeros(robot.nv), [], np.zeros((3, 3))
    for body in robot.bodies:
        joint = body.joint
        if joint.type == "spherical":
            blocks.append((joint.v, rotation(q[joint.q])))
        elif joint.type == "free":
            r, own = rotation(q[joint.q][3:]), v[joint.v]
            blocks.append((joint.v, np.block([[zero, r], [r, zero]])))
            bias[joint.v] = np.append(np.zeros(3), r @ np.cross(own[3:], own[:3]))
    return CoordinateChange(tuple(blocks), bias)


def angles(turn: Array) -> Array:
    """Find angles x, y, z with R = R_x R_y R_z.

    z is found of R_x' R, so that the product is R to rounding at any y.
    """
    x = math.atan2(-turn[1, 2], turn[2, 2])
    c, s = math.cos(x), math.sin(x)
    y = math.atan2(turn[0, 2], c * turn[2, 2] - s * turn[1, 2])
    z = math.atan2(c * turn[1, 0] + s * turn[2, 0], c * turn[1, 1] + s * turn[2, 1])
    return np.array([x, y, z])
