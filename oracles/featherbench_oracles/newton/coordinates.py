"""Newton's coordinates.

::

    joint      q_e                                          T                        b
    free       the pose in the world: p, quaternion xyzw    [[R, -R c×], [0, R]]     (R (ω × (v + ω × c)), 0)
    spherical  q                                            R                        0: angular velocity in joint-frame axes
    all other  q                                            identity                 0

A free joint has [linear; angular] in world axes, where linear is the velocity of the root's centre of mass c. Its R turns body axes to
those of the world, that of a spherical joint to those of the joint's frame. T of a free joint is not orthogonal. So of the changes only
those hold that are made by T and T': v and a to the engine, tau and M back.
"""

from __future__ import annotations

import numpy as np

from featherbench_oracles.core.algebra import Array, quaternion, rotation, skew
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert positions to Newton's, with quaternions of length one."""
    held = q.copy()
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "free":
            turn = joint.rotation @ rotation(q[joint.q][3:])
            held[joint.q] = np.append(joint.translation + joint.rotation @ q[joint.q][:3], quaternion(turn))
        if joint.type == "spherical":
            held[joint.q] /= np.linalg.norm(held[joint.q])
    return held


def change_of_velocities(robot: Description, q: Array, v: Array, com: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`; c is the centre of mass of the root as Newton holds it."""
    blocks, bias = [], np.zeros(robot.nv)
    for body in robot.bodies:
        joint = body.joint
        if joint.type == "spherical":
            blocks.append((joint.v, rotation(q[joint.q])))
        if joint.type == "free":
            r, c = joint.rotation @ rotation(q[joint.q][3:]), com
            linear, angular = v[joint.v][:3], v[joint.v][3:]
            blocks.append((joint.v, np.block([[r, -r @ skew(c)], [np.zeros((3, 3)), r]])))
            bias[joint.v] = np.append(r @ np.cross(angular, linear + np.cross(angular, c)), np.zeros(3))
    return CoordinateChange(tuple(blocks), bias)
