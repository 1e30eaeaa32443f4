"""adam's coordinates, in its body-fixed representation.

::

    joint      q_e                                                     T         b
    free       H: from the root's frame to the world's, homogeneous    identity  0: its velocity is [linear; angular] in body axes
    all other  q                                                       identity  0

The base of a robot that does not float stays at H = 1 with the velocity 0. These are numbers in the expressions, so that generated code has
no operations on them.
"""

from __future__ import annotations

import numpy as np

from featherbench_oracles.adam.urdf import floats
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.robot import Description


def base_transform(robot: Description, q: Array) -> Array:
    """Find H of a robot's root.

    Parameters
    ----------
    robot : Description
        The robot.
    q : ndarray, shape (nq,)
        Neutral positions, m, rad or quaternions.

    Returns
    -------
    ndarray, shape (4, 4)
        H, without unit and in m. It is 1 where the robot does not float.
    """
    h = np.eye(4)
    if floats(robot):
        joint = robot.bodies[0].joint
        origin, quaternion = q[joint.q][:3], q[joint.q][3:]
        h[:3, :3] = joint.rotation @ rotation(quaternion)
        h[:3, 3] = joint.translation + joint.rotation @ origin
    return h


def to_angular_first(linear_first: Array) -> Array:
    """Reorder 6-vectors of adam, which begin with the linear part.

    Parameters
    ----------
    linear_first : ndarray, shape (6, ...)
        6-vectors, or the rows of a Jacobian.

    Returns
    -------
    ndarray, shape (6, ...)
        [angular; linear], in the same units.
    """
    return np.roll(linear_first, 3, axis=0)
