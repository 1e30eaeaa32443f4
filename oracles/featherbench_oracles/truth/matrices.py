"""Numbers of many digits, and 4x4 matrices of which three rows are kept.

A pose has the last row (0, 0, 0, 1). Its derivatives and the matrices of se(3) have (0, 0, 0, 0).
"""

from __future__ import annotations

from typing import Any

from mpmath import mp, mpf

from featherbench_oracles.core.algebra import Array

Number = Any  # an mpf: mpmath has no types
Rows = list[list[Number]]  # the first three rows of a 4x4 matrix, or a 4x4 matrix

ZERO, ONE = mpf(0), mpf(1)
NULL = [ZERO] * 3
UNIT = [[ONE if i == j else ZERO for j in range(3)] for i in range(3)]


def exact(values: Array) -> list[Number]:
    """Take doubles as they are."""
    return [mpf(float(value)) for value in values]


def nearest_rotation(matrix: Array) -> Rows:
    """Find the orthogonal polar factor by R <- R (3 - R'R) / 2, until nothing changes that counts.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        Nearly a rotation.

    Returns
    -------
    Rows
        Three rows of three.
    """
    r = [exact(row) for row in matrix]
    while True:
        columns = list(zip(*r, strict=True))
        gram = [[mp.fdot(a, b) for b in columns] for a in columns]
        correction = [[((3 if i == j else 0) - gram[i][j]) / 2 for j in range(3)] for i in range(3)]
        r = [[mp.fdot(row, column) for column in zip(*correction, strict=True)] for row in r]
        if max(abs(gram[i][j] - UNIT[i][j]) for i in range(3) for j in range(3)) < mp.ldexp(1, -(2 * mp.prec) // 3):
            return r


def product(a: Rows, b: Rows, bottom: Number) -> Rows:
    """Multiply 4x4 matrices of which three rows are kept.

    Parameters
    ----------
    a : Rows
        Three rows.
    b : Rows
        Three rows.
    bottom : Number
        The last entry of b's last row.

    Returns
    -------
    Rows
        Three rows of a b.
    """
    columns = [[row[j] for row in b] for j in range(4)]
    rows = [[mp.fdot(row[:3], column) for column in columns] for row in a]
    if bottom:
        for result, row in zip(rows, a, strict=True):
            result[3] += row[3]
    return rows


def plus(*terms: Rows) -> Rows:
    """Add matrices of one shape."""
    return [[mp.fsum(entries) for entries in zip(*rows, strict=True)] for rows in zip(*terms, strict=True)]


def times_transposed(a: Rows, b: Rows) -> Rows:
    """Multiply a b' of matrices of four columns."""
    return [[mp.fdot(row, other) for other in b] for row in a]


def inner(a: Rows, b: Rows) -> Number:
    """Compute tr(a b') of matrices of one shape."""
    return mp.fsum(mp.fdot(row, other) for row, other in zip(a, b, strict=True))


def inverse_pose(t: Rows) -> Rows:
    """Invert a pose: T^-1 = (R', -R' p)."""
    rotated = [[t[i][j] for i in range(3)] for j in range(3)]
    return [[*row, -mp.fdot(row, [t[i][3] for i in range(3)])] for row in rotated]


def with_bottom(t: Rows) -> Rows:
    """Append a pose's fourth row."""
    return [*t, [ZERO, ZERO, ZERO, ONE]]


def generator(angular: list[Number], linear: list[Number]) -> Rows:
    """Make the matrix of se(3): x -> angular × x + linear.

    Parameters
    ----------
    angular : list[Number]
        Three numbers.
    linear : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        Three rows of four.
    """
    x, y, z = angular
    return [[ZERO, -z, y, linear[0]], [z, ZERO, -x, linear[1]], [-y, x, ZERO, linear[2]]]


def screw(axis: list[Number], angle: Number, shift: list[Number]) -> Rows:
    """Compute exp of the angle times the axis' matrix, by Rodrigues' formula 1 + sin K + (1 - cos) K²; then the shift.

    Parameters
    ----------
    axis : list[Number]
        A unit vector.
    angle : Number
        In rad.
    shift : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        The pose.
    """
    k = [row[:3] for row in generator(axis, NULL)]
    square = [[mp.fdot(row, column) for column in zip(*k, strict=True)] for row in k]
    sin, versed = mp.sin(angle), 2 * mp.sin(angle / 2) ** 2
    turn = [[UNIT[i][j] + sin * k[i][j] + versed * square[i][j] for j in range(3)] for i in range(3)]
    return [[*row, entry] for row, entry in zip(turn, shift, strict=True)]


def from_quaternion(q: list[Number], position: list[Number]) -> Rows:
    """Make the pose of a quaternion, normalised: R x is the vector part of q x q*.

    Parameters
    ----------
    q : list[Number]
        (x, y, z, w), of any length but 0.
    position : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        The pose.
    """
    length = mp.sqrt(mp.fdot(q, q))
    x, y, z, w = (entry / length for entry in q)

    def turned(v: list[Number], s: Number) -> list[Number]:
        """W v + s u + u × v, the vector part of q (v, s), and with the other sign of s that of (v, s) q*."""
        return [w * v[0] + s * x + y * v[2] - z * v[1], w * v[1] + s * y + z * v[0] - x * v[2], w * v[2] + s * z + x * v[1] - y * v[0]]

    # (v, s) = q (e, 0) has s = -u·e; then (v, s) q* has the vector part w v - s u + u × v.
    columns = [turned(turned(e, ZERO), mp.fdot(e, (x, y, z))) for e in UNIT]
    return [[*(column[i] for column in columns), position[i]] for i in range(3)]
