"""Arrays of doubles, and the small matrices that several modules need."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def symmetric(six: Array) -> Array:
    """Unpack a symmetric matrix.

    Parameters
    ----------
    six : ndarray, shape (6,)
        The entries xx, xy, xz, yy, yz, zz.

    Returns
    -------
    ndarray, shape (3, 3)
        The matrix, in the unit of its entries.
    """
    xx, xy, xz, yy, yz, zz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def rotation(xyzw: Array) -> Array:
    """Compute the rotation matrix of a quaternion: I + 2 (w [u]x + [u]x^2) / |xyzw|^2.

    Parameters
    ----------
    xyzw : ndarray, shape (4,)
        The numbers (x, y, z, w), of any length but 0.

    Returns
    -------
    ndarray, shape (3, 3)
        The rotation, without unit.
    """
    u, w = skew(xyzw[:3]), xyzw[3]
    matrix: Array = np.eye(3) + (2 / (xyzw @ xyzw)) * (w * u + u @ u)
    return matrix


def quaternion(matrix: Array) -> Array:
    """Find the quaternion (x, y, z, w) of a rotation, from the row of 4 q q' with the largest diagonal entry.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        The rotation.

    Returns
    -------
    ndarray, shape (4,)
        Of length one.
    """
    (a, b, c), (d, e, f), (g, h, i) = matrix
    squares = np.array(
        [
            [1 + a - e - i, b + d, c + g, h - f],
            [b + d, 1 - a + e - i, f + h, c - g],
            [c + g, f + h, 1 - a - e + i, d - b],
            [h - f, c - g, d - b, 1 + a + e + i],
        ]
    )
    row = squares[np.argmax(np.diag(squares))]
    return np.array(row / np.linalg.norm(row))


def skew(u: Array) -> Array:
    """Make the matrix of the cross product u x.

    Parameters
    ----------
    u : ndarray, shape (3,)
        A vector.

    Returns
    -------
    ndarray, shape (3, 3)
        The antisymmetric matrix K with K x = u x x, in the unit of `u`.
    """
    x, y, z = u
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
