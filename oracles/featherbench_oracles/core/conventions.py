"""Conventions: an engine is asked about one directly, without its oracle.

The robot has one body, and numbers without symmetry. Each row of conventions.toml has a function of its name in
`featherbench_oracles.ENGINE.conventions`. It yields claims: the engine's answer, the answer by the convention, and that by an alternative.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array, skew

CLOSE, APART = 1e-12, 1e-2  # rounding of numbers of size one; much less than a wrong convention changes
SINGLE = 1e-4  # the same rounding in single precision, of numbers of size up to a hundred


@dataclass(frozen=True)
class Claim:
    """A claim: measured numbers are those of the convention, and not those of any alternative.

    Attributes
    ----------
    measured, convention : ndarray
        The engine's answer, and the answer by the convention, of one shape and unit.
    otherwise : tuple of ndarray
        The answer by each alternative, of a shape that broadcasts to that one.
    close : float
        The rounding that is allowed.
    """

    measured: Array
    convention: Array
    otherwise: tuple[Array, ...]
    close: float = CLOSE

    def swapped(self) -> Claim:
        """Claim the first alternative in place of the convention."""
        return Claim(self.measured, np.broadcast_to(self.otherwise[0], self.measured.shape), (self.convention,), self.close)

    def refutation(self) -> str | None:
        """Say what is wrong with the claim.

        Returns
        -------
        str or None
            A sentence if the convention does not hold, or an alternative holds as well; None if the claim is right.
        """
        if self.measured.shape != self.convention.shape:
            return f"shape {self.measured.shape}, not {self.convention.shape}"
        if not np.abs(self.measured - self.convention).max() <= self.close:
            return f"measured {self.measured.tolist()}, by the convention {self.convention.tolist()}"
        for other in self.otherwise:
            if not np.abs(self.measured - other).max() >= APART:
                return f"the alternative {other.tolist()} fits as well"
        return None


Claims = Iterator[Claim]
Convention = Callable[[], Claims]


def claim(measured: ArrayLike, convention: ArrayLike, *otherwise: ArrayLike, close: float = CLOSE) -> Claim:
    """Claim that measured numbers are those of a convention.

    Parameters
    ----------
    measured, convention : array_like
        The engine's answer, and the answer by the convention, of one shape and unit.
    *otherwise : array_like
        The answer by each alternative. There is at least one.
    close : float
        The rounding that is allowed: `SINGLE` of an engine in single precision.

    Returns
    -------
    Claim
        With copies of the numbers, because engines reuse the memory of their results.
    """
    if not otherwise:
        raise ValueError("a convention without an alternative says nothing")
    return Claim(np.array(measured, float), np.array(convention, float), tuple(np.array(other, float) for other in otherwise), close)


def about(axis: Array, angle: float) -> Array:
    """Make the rotation of shape (3, 3) about a unit vector of shape (3,) by an angle in rad."""
    return np.eye(3) + sin(angle) * skew(axis) + (1 - cos(angle)) * skew(axis) @ skew(axis)


def turned(xyzw: Array) -> Array:
    """Make the rotation of shape (3, 3) of a unit quaternion (x, y, z, w) by its angle and axis."""
    return about(xyzw[:3] / np.linalg.norm(xyzw[:3]), 2 * np.arctan2(np.linalg.norm(xyzw[:3]), xyzw[3]))


P, V, W = np.array([0.3, -0.5, 0.7]), np.array([0.4, -0.9, 0.2]), np.array([1.1, 0.6, -0.8])
A, ALPHA = np.array([-0.7, 0.3, 0.5]), np.array([0.2, -0.4, 0.9])
XYZW = np.array([0.1, -0.5, 0.7, 0.5])
MASS, COM, GRAVITY = 2.0, np.array([0.1, -0.2, 0.15]), np.array([1.3, -2.1, -9.2])
MOMENTS = np.array([[0.31, 0.02, -0.03], [0.02, 0.27, 0.04], [-0.03, 0.04, 0.22]])
AXIS = np.array([2.0, -1.0, 2.0]) / 3
X, Y, Z = np.eye(3)
WXYZ = np.roll(XYZW, 1)
R = turned(XYZW)
WRONG_R = turned(np.roll(XYZW, -1))  # the four numbers taken for (w, x, y, z)
ABOUT_ORIGIN = MOMENTS - MASS * skew(COM) @ skew(COM)
