"""Least squares under semidefinite conditions: the operation `semidefinite_least_squares`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header, limits
from featherbench_oracles.core.protocol import Unsupported

# The size of a pseudo-inertia.
SIZE = 4
# Rounding may make a map unsymmetric by this much of its largest entry.
SYMMETRY = 1e-12


@dataclass(frozen=True)
class SemidefiniteProblem:
    """Minimise |A x - b|² / 2 while P_i(x) is positive semidefinite for each body i.

    Parameters
    ----------
    matrix : ndarray
        A, of shape (rows, n), already weighted.
    target : ndarray
        b, of shape (rows,), already weighted.
    maps : ndarray
        Of shape (bodies, 4, 4, n + 1): P_i(x) is the sum of maps[i, :, :, k] x[k], and of maps[i, :, :, n].
    """

    matrix: Array
    target: Array
    maps: Array


@dataclass(frozen=True)
class SemidefiniteSolution:
    """What a solver answers.

    Parameters
    ----------
    x : ndarray
        The unknowns, of shape (n,).
    multipliers : ndarray
        Of shape (bodies, 4, 4): Z_i, semidefinite, with A'(A x - b) = sum over i of the adjoint of map i at Z_i.
    converged : bool
        What the engine says.
    solver_status : str
        The same in the engine's word.
    iterations : int
        As the engine counts them.
    nanoseconds : float
        The engine's own time of the solution.
    """

    x: Array
    multipliers: Array
    converged: bool
    solver_status: str
    iterations: int
    nanoseconds: float


# Solves a problem by its tolerance and its cap on iterations.
SolveSemidefinite = Callable[[SemidefiniteProblem, float, int], SemidefiniteSolution]
SemidefiniteTable = Mapping[str, SolveSemidefinite]


class SemidefiniteLeastSquares:
    """The operation of a session.

    Parameters
    ----------
    engine : str
        The engine's name.
    solvers : mapping of str to callable
        `(problem, tolerance, iterations) -> SemidefiniteSolution` by the method's name.
    """

    def __init__(self, engine: str, solvers: SemidefiniteTable) -> None:
        self.engine, self.solvers = engine, solvers

    def solve(self, header: Header, blocks: Blocks) -> Answer:
        """Solve a problem: blocks `x` of shape (n,) and `multipliers` of shape (bodies, 16)."""
        method = header["method"]
        if method not in self.solvers:
            raise Unsupported(f"{self.engine} offers no semidefinite least squares by {method}")
        tolerance, iterations = limits(header)
        found = self.solvers[method](problem(blocks), tolerance, iterations)
        answer = {
            "converged": found.converged,
            "solver_status": found.solver_status,
            "iterations": found.iterations,
            "nanoseconds": found.nanoseconds,
        }
        return answer, {"x": found.x, "multipliers": found.multipliers.reshape(-1, SIZE * SIZE)}


def problem(blocks: Blocks) -> SemidefiniteProblem:
    """Examine the blocks of a request.

    Parameters
    ----------
    blocks : dict of str to ndarray
        `a` (rows, n), `b` (rows,), `maps` (bodies, 16, n + 1).

    Returns
    -------
    SemidefiniteProblem
        The problem, with maps that are symmetric to the bit.

    Raises
    ------
    ValueError
        If a block is missing, of another shape or not finite, or a map is not symmetric.
    """
    for name, dimensions in (("a", 2), ("b", 1), ("maps", 3)):
        if name not in blocks or blocks[name].ndim != dimensions:
            raise ValueError(f"block {name} is missing or has not {dimensions} dimensions")
        if not np.isfinite(blocks[name]).all():
            raise ValueError(f"block {name} has a number that is not finite")
    matrix, target, maps = blocks["a"], blocks["b"], blocks["maps"]
    rows, n = matrix.shape
    if rows < 1 or n < 1:
        raise ValueError(f"block a has the shape {[rows, n]}: there is nothing to solve")
    if target.shape != (rows,):
        raise ValueError(f"block b has the shape {list(target.shape)}, and block a has {rows} rows")
    if maps.shape[1:] != (SIZE * SIZE, n + 1):
        raise ValueError(f"block maps has the shape {list(maps.shape)}; due is [bodies, {SIZE * SIZE}, {n + 1}]")
    square = maps.reshape(-1, SIZE, SIZE, n + 1)
    turned = square.transpose(0, 2, 1, 3)
    if square.size and np.abs(square - turned).max() > SYMMETRY * np.abs(square).max():
        raise ValueError("a map of block maps is not symmetric: entries ij and ji of a 4×4 matrix must be equal")
    return SemidefiniteProblem(matrix, target, (square + turned) / 2)
