"""The pose of each joint's body in closed form, by PROTOCOL.md alone. The tests compare every engine with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from featherbench_oracles.core.algebra import Array, rotation, skew
from featherbench_oracles.core.robot import Joint

X, Y, Z = np.eye(3)


def turn(axis: Array, angle: float) -> Array:
    """Make the rotation about a unit vector: 1 + sin K + (1 - cos) K² with K = [axis]x.

    Parameters
    ----------
    axis : ndarray, shape (3,)
        A unit vector.
    angle : float
        In rad.

    Returns
    -------
    ndarray, shape (3, 3)
        The rotation.
    """
    k = skew(axis)
    rotated: Array = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    return rotated


def across(joint: Joint, q: Array) -> tuple[Array, Array]:
    """Compute the pose of a joint's body in the joint's frame.

    Parameters
    ----------
    joint : Joint
        The joint.
    q : ndarray, shape (nq of the joint,)
        The joint's own coordinates.

    Returns
    -------
    axes : ndarray, shape (3, 3)
        The body's axes.
    origin : ndarray, shape (3,)
        Its origin, m.
    """
    u = joint.axis
    forms: dict[str, Callable[[], tuple[Array, Array]]] = {
        "revolute": lambda: (turn(u, q[0]), np.zeros(3)),
        "prismatic": lambda: (np.eye(3), u * q[0]),
        "helical": lambda: (turn(u, q[0]), u * joint.pitch * q[0]),
        "spherical": lambda: (rotation(q), np.zeros(3)),
        "free": lambda: (rotation(q[3:]), q[:3]),
        "planar": lambda: (turn(Z, q[2]), np.array([q[0], q[1], 0])),
        "universal": lambda: (turn(X, q[0]) @ turn(Y, q[1]), np.zeros(3)),
        "translation": lambda: (np.eye(3), q),
        "cylindrical": lambda: (turn(u, q[0]), u * q[1]),
        "euler_zyx": lambda: (turn(Z, q[0]) @ turn(Y, q[1]) @ turn(X, q[2]), np.zeros(3)),
    }
    return forms[joint.type]()


def placement(joint: Joint, q: Array) -> Array:
    """Compute the pose in the world of a body whose joint hangs on the world.

    Parameters
    ----------
    joint : Joint
        The joint.
    q : ndarray, shape (nq of the joint,)
        The joint's own coordinates.

    Returns
    -------
    ndarray, shape (12,)
        Its rotation, row by row, and its origin in m.
    """
    r, p = across(joint, q)
    return np.append(joint.rotation @ r, joint.rotation @ p + joint.translation)
