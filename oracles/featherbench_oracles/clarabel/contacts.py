"""The convex relaxation of contact problems, by Clarabel: as a problem of impulses, and as one of velocities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np

from featherbench_oracles.abilities.contacts import ContactProblem, ContactSolution, SolverTable
from featherbench_oracles.clarabel.interior import solve
from featherbench_oracles.core.algebra import Array

# An eigenvalue of G below this much of the largest is rounding.
RANK = 1e-13


def _cones(friction: Array) -> tuple[Array, list[Any]]:
    """Make the map from impulses to self-dual cones of x_n >= |x_t|, x_n = mu lambda_n.

    Where mu = 0 the contact has a normal impulse only.
    """
    rows, kinds = [], []
    for contact, mu in enumerate(friction):
        normal = 3 * contact
        if mu > 0:
            rows += [(normal, mu), (normal + 1, 1.0), (normal + 2, 1.0)]
            kinds.append(clarabel.SecondOrderConeT(3))
        else:
            rows.append((normal, 1.0))
            kinds.append(clarabel.NonnegativeConeT(1))
    change = np.zeros((len(rows), 3 * len(friction)))
    for row, (column, factor) in enumerate(rows):
        change[row, column] = factor
    return change, kinds


@dataclass(frozen=True)
class _Relaxed:
    """One form of the relaxation.

    Impulses are T' x with x in the self-dual cones, T = `_cones`, with the unit of x_n such that rows of T have one entry.
    """

    problems: Sequence[ContactProblem]
    tolerance: float
    iterations: int
    primal: bool

    def solve(self, problem: int) -> ContactSolution:
        """Solve a problem. An interior-point method begins at its own point, whatever was solved before."""
        given = self.problems[problem]
        return self._velocities(given) if self.primal else self._impulses(given)

    def _impulses(self, given: ContactProblem) -> ContactSolution:
        """Minimise lambda' G lambda / 2 + b' lambda over the friction cones."""
        change, kinds = _cones(given.friction)
        # A frictionless contact's tangent impulses are zero.
        kept = change.any(axis=0)
        found = solve(
            given.delassus[np.ix_(kept, kept)],
            given.free[kept],
            -change[:, kept],
            np.zeros(len(change)),
            kinds,
            self.tolerance,
            self.iterations,
        )
        impulses = np.zeros(len(given.free))
        impulses[kept] = found.y
        return ContactSolution(impulses, found.iterations, found.converged, found.nanoseconds)

    def _velocities(self, given: ContactProblem) -> ContactSolution:
        """Minimise |u|² / 2 while c = F u + b is in the cones' duals, where G = F F' and u = F' lambda. The multipliers are impulses."""
        values, vectors = np.linalg.eigh(given.delassus)
        held = values > RANK * values[-1]
        factor = vectors[:, held] * np.sqrt(values[held])
        change, kinds = _cones(given.friction)
        # The dual of x_n >= |x_t| is itself; with lambda = T^-1 x its velocities are T^-T c: c_n / mu >= |c_t|.
        dual = np.where(change != 0, 1 / np.where(change != 0, change, 1.0), 0.0)
        found = solve(
            np.eye(factor.shape[1]), np.zeros(factor.shape[1]), -dual @ factor, dual @ given.free, kinds, self.tolerance, self.iterations
        )
        return ContactSolution(dual.T @ found.multipliers, found.iterations, found.converged, found.nanoseconds)


def _dual(problems: Sequence[ContactProblem], tolerance: float, iterations: int) -> _Relaxed:
    return _Relaxed(problems, tolerance, iterations, primal=False)


def _primal(problems: Sequence[ContactProblem], tolerance: float, iterations: int) -> _Relaxed:
    return _Relaxed(problems, tolerance, iterations, primal=True)


RELAXATIONS: SolverTable = {"impulses": _dual, "velocities": _primal}
