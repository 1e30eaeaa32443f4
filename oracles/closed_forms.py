"""Where each joint puts its body, in closed form and by the words of PROTOCOL.md alone: what the tests hold every engine to."""

from __future__ import annotations

import numpy as np

from protocol import Array, Joint, rotation, skew

X, Y, Z = np.eye(3)


def turn(axis: Array, angle: float) -> Array:
    """The rotation about a unit vector: 1 + sin K + (1 - cos) K² with K = [axis]x."""
    k = skew(axis)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def across(joint: Joint, q: Array) -> tuple[Array, Array]:
    """The body's axes and origin in the joint's frame, at the joint's own coordinates `q`."""
    u = joint.axis
    forms = {
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
    """Rotation (row-major) and origin of the body of a joint on the world."""
    r, p = across(joint, q)
    return np.append(joint.rotation @ r, joint.rotation @ p + joint.translation)
