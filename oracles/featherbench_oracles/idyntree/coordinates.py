"""iDynTree's coordinates, in its mixed representation.

::

    joint      q_e                                          T          b
    free       H: from the root's frame to the world's      [R, R]     (R (ω × v), 0): [linear; angular] in world axes
    spherical  quaternion wxyz                              identity   0
    all other  q                                            identity   0

R of a free joint turns body axes to those of the world; T has it twice on its diagonal. H is given beside q_e of the joints. A robot
that does not float has a base that stands.
"""

from __future__ import annotations

import numpy as np

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.robot import Description


def floats(robot: Description) -> bool:
    """Whether the root is on a free joint."""
    return bool(robot.bodies) and robot.bodies[0].joint.type == "free"


def to_engine_q(robot: Description, q: Array) -> Array:
    """Convert the positions of all joints but a free one to iDynTree's."""
    joints = [body.joint for body in robot.bodies if body.joint.type != "free"]
    return np.concatenate([np.zeros(0), *(np.roll(q[joint.q], 1) if joint.type == "spherical" else q[joint.q] for joint in joints)])


def base(robot: Description, q: Array) -> tuple[Array, Array]:
    """Find rotation and origin of H of a robot that floats."""
    joint = robot.bodies[0].joint
    return joint.rotation @ rotation(q[3:7]), joint.translation + joint.rotation @ q[:3]


def change_of_velocities(robot: Description, q: Array, v: Array) -> CoordinateChange:
    """Find T and b of the table, by the interface in `change`."""
    bias = np.zeros(robot.nv)
    if not floats(robot):
        return CoordinateChange((), bias)
    r, zero = base(robot, q)[0], np.zeros((3, 3))
    bias[:3] = r @ np.cross(v[3:6], v[:3])
    return CoordinateChange(((slice(0, 6), np.block([[r, zero], [zero, r]])),), bias)
