"""Least squares under semidefinite conditions, by Clarabel."""

from __future__ import annotations

import clarabel
import numpy as np

from featherbench_oracles.abilities.semidefinite import SIZE, SemidefiniteProblem, SemidefiniteSolution, SemidefiniteTable
from featherbench_oracles.clarabel.interior import solve
from featherbench_oracles.core.algebra import Array

# Clarabel's order of a triangle is that of columns, its entries beside the diagonal times √2: so scalar products are those of matrices.
ROWS, COLUMNS = (np.array(index) for index in zip(*[(i, j) for j in range(SIZE) for i in range(j + 1)], strict=True))
WEIGHTS = np.where(ROWS == COLUMNS, 1.0, np.sqrt(2.0))


def interior_point(problem: SemidefiniteProblem, tolerance: float, iterations: int) -> SemidefiniteSolution:
    """Solve with the unknowns y = [x; r] and r = A x - b, so that A is not squared.

    Columns of A and of the maps are divided by the length of A's column. So the unit of an unknown does not matter.

    Parameters
    ----------
    problem : SemidefiniteProblem
        The problem.
    tolerance : float
        Of the gap and of feasibility.
    iterations : int
        The cap.

    Returns
    -------
    SemidefiniteSolution
        The solution.
    """
    rows, n = problem.matrix.shape
    length = np.linalg.norm(problem.matrix, axis=0)
    scale = np.where(length > 0, length, 1.0)
    triangles = problem.maps[:, ROWS, COLUMNS, :] * WEIGHTS[None, :, None]
    bodies = len(triangles)
    flat = triangles.reshape(bodies * len(WEIGHTS), n + 1)
    quadratic = np.diag(np.concatenate([np.zeros(n), np.ones(rows)]))
    residual = np.hstack([problem.matrix / scale, -np.eye(rows)])
    inside = np.hstack([-flat[:, :n] / scale, np.zeros((len(flat), rows))])
    right = np.concatenate([problem.target, flat[:, n]])
    cones = [clarabel.ZeroConeT(rows), *(clarabel.PSDTriangleConeT(SIZE) for _ in range(bodies))]
    found = solve(quadratic, np.zeros(n + rows), np.vstack([residual, inside]), right, cones, tolerance, iterations)
    multipliers = np.array([_matrix(part) for part in found.multipliers[rows:].reshape(bodies, len(WEIGHTS))]).reshape(bodies, SIZE, SIZE)
    return SemidefiniteSolution(found.y[:n] / scale, multipliers, found.converged, found.solver_status, found.iterations, found.nanoseconds)


def _matrix(triangle: Array) -> Array:
    """Make a symmetric matrix of a triangle."""
    matrix = np.zeros((SIZE, SIZE))
    matrix[ROWS, COLUMNS] = matrix[COLUMNS, ROWS] = triangle / WEIGHTS
    return matrix


SOLVERS: SemidefiniteTable = {"interior_point": interior_point}
