"""Joints as chains of simple ones, and the mass distributions of bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from mpmath import mpf

from featherbench_oracles.core.robot import Body
from featherbench_oracles.truth.matrices import NULL, ONE, UNIT, ZERO, Number, Rows, exact, from_quaternion, generator, plus, screw


@dataclass
class Link:
    """A simple joint and what it carries: a body, or nothing between the parts of a composed joint.

    Attributes
    ----------
    parent : int
        The index of the link before, or -1.
    placement : rows of a 4x4 matrix
        P, lengths in m.
    kind : str
        `turn`, `slide`, `screw`, `ball` or `free`.
    axis : list of 3 numbers
        A unit vector in the joint's frame.
    pitch : number
        Metres per radian.
    q, v : slice
        Its ranges in the neutral coordinates.
    pseudo_inertia : 4x4 matrix, optional
        J of the body, kg, kg m and kg m².
    generators : list of rows of 4x4 matrices
        E_k of each degree of freedom.
    """

    parent: int
    placement: Rows
    kind: str
    axis: list[Number]
    pitch: Number
    q: slice
    v: slice
    pseudo_inertia: Rows | None
    generators: list[Rows] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Make the constant matrices E_k."""
        along = [self.pitch * entry for entry in self.axis]
        generators: dict[str, Callable[[], list[Rows]]] = {
            "turn": lambda: [generator(self.axis, NULL)],
            "slide": lambda: [generator(NULL, self.axis)],
            "screw": lambda: [generator(self.axis, along)],
            "ball": lambda: [generator(e, NULL) for e in UNIT],
            "free": lambda: [*(generator(NULL, e) for e in UNIT), *(generator(e, NULL) for e in UNIT)],
        }
        self.generators = generators[self.kind]()

    def displacement(self, q: list[Number]) -> Rows:
        """Compute A(q) at the link's own coordinates."""
        if self.kind == "ball":
            return from_quaternion(q, NULL)
        if self.kind == "free":
            return from_quaternion(q[3:], q[:3])
        lead = {"turn": ZERO, "slide": ONE, "screw": self.pitch}[self.kind]
        return screw(self.axis, ZERO if self.kind == "slide" else q[0], [lead * q[0] * entry for entry in self.axis])

    def twist(self, rates: list[Number]) -> Rows:
        """Compute V = Σ E_k rate_k at the link's own rates."""
        return plus(*([[rate * entry for entry in row] for row in e] for e, rate in zip(self.generators, rates, strict=True)))


# joint type -> its simple joints: kind, axis (None: the joint's own), numbers of q, numbers of v
PARTS: dict[str, list[tuple[str, list[Number] | None, int, int]]] = {
    "revolute": [("turn", None, 1, 1)],
    "prismatic": [("slide", None, 1, 1)],
    "helical": [("screw", None, 1, 1)],
    "spherical": [("ball", UNIT[0], 4, 3)],
    "free": [("free", UNIT[0], 7, 6)],
    "planar": [("slide", UNIT[0], 1, 1), ("slide", UNIT[1], 1, 1), ("turn", UNIT[2], 1, 1)],
    "universal": [("turn", UNIT[0], 1, 1), ("turn", UNIT[1], 1, 1)],
    "translation": [("slide", UNIT[0], 1, 1), ("slide", UNIT[1], 1, 1), ("slide", UNIT[2], 1, 1)],
    "cylindrical": [("turn", None, 1, 1), ("slide", None, 1, 1)],
    "euler_zyx": [("turn", UNIT[2], 1, 1), ("turn", UNIT[1], 1, 1), ("turn", UNIT[0], 1, 1)],
}


def pseudo_inertia(body: Body) -> Rows:
    """Compute ∫ x x' dm in body axes: second moments about the origin, first moments, mass.

    Parameters
    ----------
    body : Body
        The body.

    Returns
    -------
    Rows
        A 4x4 matrix in kg m², kg m and kg.
    """
    mass, com = mpf(body.mass), exact(body.com)
    inertia = [exact(row) for row in body.inertia]
    half_trace = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 2
    second = [[half_trace * UNIT[i][j] - inertia[i][j] + mass * com[i] * com[j] for j in range(3)] for i in range(3)]
    first = [mass * entry for entry in com]
    return [*([*row, entry] for row, entry in zip(second, first, strict=True)), [*first, mass]]
