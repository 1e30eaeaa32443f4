"""Clarabel's solver: settings, one solution, and what it says of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
from scipy import sparse

from featherbench_oracles.core.algebra import Array

# The words of an answer that is within the tolerance that was asked.
SOLVED = "Solved"


@dataclass(frozen=True)
class Interior:
    """Minimise y' H y / 2 + g' y with s = d - C y in a product of cones.

    Parameters
    ----------
    y, multipliers : ndarray
        The solution, and the dual variables of the conditions: H y + g + C' multipliers = 0.
    solver_status : str
        Clarabel's word.
    iterations : int
        Of the interior-point method.
    nanoseconds : float
        Clarabel's own time of the solution, with its setup.
    """

    y: Array
    multipliers: Array
    solver_status: str
    iterations: int
    nanoseconds: float

    @property
    def converged(self) -> bool:
        """Whether the tolerance that was asked is met; an answer of reduced accuracy is none."""
        return self.solver_status == SOLVED


def solve(
    quadratic: Array, linear: Array, conditions: Array, right: Array, cones: list[Any], tolerance: float, iterations: int
) -> Interior:
    """Solve a problem.

    Parameters
    ----------
    quadratic, linear : ndarray
        H of shape (n, n), symmetric and positive semidefinite, and g of shape (n,).
    conditions, right : ndarray
        C of shape (m, n) and d of shape (m,).
    cones : list
        The cones of s, in order.
    tolerance : float
        Of the gap, absolute and relative, and of feasibility.
    iterations : int
        The cap.

    Returns
    -------
    Interior
        The solution.
    """
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.max_iter = iterations
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    upper = sparse.triu(sparse.csc_matrix(quadratic), format="csc")
    solver = clarabel.DefaultSolver(upper, linear, sparse.csc_matrix(conditions), right, cones, settings)
    found = solver.solve()
    return Interior(np.array(found.x), np.array(found.z), str(found.status), int(found.iterations), found.solve_time * 1e9)
