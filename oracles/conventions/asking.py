"""How the engines are asked about their conventions: what the tests share, one body and numbers in which nothing is symmetric."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
CLOSE, APART = 1e-12, 1e-2  # rounding of numbers of size one; far below what any convention of these changes
asked = 0
swapped = False  # claims the first alternative in place of each convention: every test must then fail


def holds(measured: ArrayLike, convention: ArrayLike, *otherwise: ArrayLike) -> None:
    """The measured numbers are those of the convention, and not those of any other."""
    global asked
    asked += 1
    assert otherwise, "a convention without an alternative says nothing"
    if swapped:
        convention, otherwise = np.broadcast_to(np.asarray(otherwise[0], float), np.shape(measured)), (convention,)
    measured, convention = np.asarray(measured, float), np.asarray(convention, float)
    assert measured.shape == convention.shape, f"shape {measured.shape}, not {convention.shape}"
    gap = np.abs(measured - convention).max()
    assert gap <= CLOSE, f"measured {measured.tolist()}, by the convention {convention.tolist()}"
    for other in otherwise:
        apart = np.abs(measured - np.asarray(other, float)).max()
        assert apart >= APART, f"the alternative {np.asarray(other).tolist()} fits as well"


P, V, W = np.array([0.3, -0.5, 0.7]), np.array([0.4, -0.9, 0.2]), np.array([1.1, 0.6, -0.8])
A, ALPHA = np.array([-0.7, 0.3, 0.5]), np.array([0.2, -0.4, 0.9])
XYZW = np.array([0.1, -0.5, 0.7, 0.5])
MASS, COM, GRAVITY = 2.0, np.array([0.1, -0.2, 0.15]), np.array([1.3, -2.1, -9.2])
MOMENTS = np.array([[0.31, 0.02, -0.03], [0.02, 0.27, 0.04], [-0.03, 0.04, 0.22]])
AXIS = np.array([2.0, -1.0, 2.0]) / 3
X, Y, Z = np.eye(3)


def skew(u: Array) -> Array:
    """The matrix of u x."""
    return np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def about(axis: Array, angle: float) -> Array:
    """The rotation about a unit vector."""
    return np.eye(3) + sin(angle) * skew(axis) + (1 - cos(angle)) * skew(axis) @ skew(axis)


def rotation(xyzw: Array) -> Array:
    """R of a unit quaternion."""
    return about(xyzw[:3] / np.linalg.norm(xyzw[:3]), 2 * np.arctan2(np.linalg.norm(xyzw[:3]), xyzw[3]))


WXYZ = np.roll(XYZW, 1)
R = rotation(XYZW)
WRONG_R = rotation(np.roll(XYZW, -1))  # the four numbers taken for (w, x, y, z)
about_origin = MOMENTS - MASS * skew(COM) @ skew(COM)
