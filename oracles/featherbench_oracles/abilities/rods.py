"""Rods: the operation `rod`. A clamped rod is discretised by the engine, loaded at its tip, and let vibrate."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header
from featherbench_oracles.core.protocol import Unsupported


@dataclass(frozen=True)
class Rod:
    """A straight uniform rod along x, clamped at the origin, which bends about z.

    Parameters
    ----------
    count : int
        The number of elements.
    length : float
        Its length, m.
    bending : float
        The bending stiffness EI, N m^2.
    mass_per_length : float
        Mass per length, kg/m; the sections have no rotary inertia, as far as the engine can.
    """

    count: int
    length: float
    bending: float
    mass_per_length: float


class RodModel(Protocol):
    """A rod in an engine: its elastic coordinates are zero where it is straight. All but Newton's iteration is the engine's."""

    dofs: int

    def imbalance(self, q: Array, force: float) -> Array:
        """Compute the generalized force that is left at rest: of elasticity, and of a dead force along y at the tip."""

    def tip(self, q: Array) -> Array:
        """Compute the tip's x and y."""

    def mass(self) -> Array:
        """Compute the mass matrix of the straight rod."""

    def stiffness(self) -> Array:
        """Tell the stiffness matrix of the straight rod."""

    def accelerate(self, q: Array) -> None:
        """Compute forward dynamics once at rest: what is timed."""


MakeRod = Callable[[Rod], RodModel]
RodTable = Mapping[str, MakeRod]

# The most elements.
MOST_ELEMENTS = 512
# A load is reached in steps of alpha = F L^2 / EI of this size: Newton's iteration without them may end at another equilibrium.
LOAD_STEP = 0.5
# Newton's iteration ends where the imbalance is this part of EI/L, or no longer falls.
TOLERANCE = 1e-13
MOST_ITERATIONS = 60
# The times of so many calls are told by their median.
TIMED_CALLS = 100


class Rods:
    """The answers about rods of a session.

    Parameters
    ----------
    engine : str
        The engine's name.
    elements : mapping of str to callable
        `rod -> RodModel` by the method's name.
    """

    def __init__(self, engine: str, elements: RodTable) -> None:
        self.engine, self.elements = engine, elements

    def solve(self, header: Header, blocks: Blocks) -> Answer:
        """Answer `rod`: blocks `tips` of shape (forces, 2) and `frequencies` of shape (up to 3,)."""
        method = header["method"]
        if method not in self.elements:
            raise Unsupported(f"{self.engine} offers no rod element {method}")
        rod = Rod(*(header[key] for key in ("count", "length", "bending", "mass_per_length")))
        if not (isinstance(rod.count, int) and 0 < rod.count <= MOST_ELEMENTS):
            raise ValueError(f"count must be between 1 and {MOST_ELEMENTS}")
        numbers = np.array([rod.length, rod.bending, rod.mass_per_length])
        if not (np.isfinite(numbers).all() and (numbers > 0).all()):
            raise ValueError("length, bending and mass_per_length must be positive and finite")
        if "forces" not in blocks or blocks["forces"].ndim != 1 or not np.isfinite(blocks["forces"]).all():
            raise ValueError("block forces is missing, not of shape [forces], or has a number that is not finite")
        start = time.perf_counter_ns()
        model = self.elements[method](rod)
        model.accelerate(np.zeros(model.dofs))
        preparation = time.perf_counter_ns() - start
        answer = {"tips": np.array([model.tip(equilibrium(model, rod, force)) for force in blocks["forces"]]).reshape(-1, 2)}
        answer["frequencies"] = frequencies(model)[:3]
        return {"nanoseconds": _median_time(model), "preparation": preparation}, answer


def equilibrium(model: RodModel, rod: Rod, force: float) -> Array:
    """Find the equilibrium under a dead force at the tip by load steps, with Newton's iteration in each.

    Parameters
    ----------
    model : RodModel
        The rod in the engine.
    rod : Rod
        Its numbers.
    force : float
        The force along y, N.

    Returns
    -------
    ndarray
        The elastic coordinates.

    Raises
    ------
    ArithmeticError
        If the iteration does not converge.
    """
    q = np.zeros(model.dofs)
    steps = max(1, int(np.ceil(abs(force) * rod.length**2 / rod.bending / LOAD_STEP)))
    for step in range(1, steps + 1):
        q = _newton(model, rod, force * step / steps, q)
    return q


def _newton(model: RodModel, rod: Rod, force: float, q: Array) -> Array:
    """Iterate to the equilibrium from a near one. The tangent is by central differences: its error moves no result."""
    scale, last = rod.bending / rod.length, np.inf
    for _ in range(MOST_ITERATIONS):
        left = model.imbalance(q, force)
        size = float(np.abs(left).max()) / scale
        if not np.isfinite(size):
            raise ArithmeticError("the engine's forces are not finite")
        if size <= TOLERANCE or (size < 1e-9 and size >= last):
            return q
        last = size
        q = q - np.linalg.solve(_tangent(model, q, force), left)
    raise ArithmeticError(f"the equilibrium at {force} N was not found in {MOST_ITERATIONS} iterations")


def _tangent(model: RodModel, q: Array, force: float) -> Array:
    """Differentiate the imbalance."""
    step = 1e-5
    columns = []
    for j in range(model.dofs):
        moved = np.zeros(model.dofs)
        moved[j] = step
        columns.append((model.imbalance(q + moved, force) - model.imbalance(q - moved, force)) / (2 * step))
    return np.array(columns).T


def frequencies(model: RodModel) -> Array:
    """Compute the angular frequencies of the straight rod, increasing: K x = omega^2 M x.

    Parameters
    ----------
    model : RodModel
        The rod in the engine.

    Returns
    -------
    ndarray
        omega, rad/s.
    """
    lower = np.linalg.cholesky(model.mass())
    half = np.linalg.solve(lower, model.stiffness())
    squares = np.linalg.eigvalsh(np.linalg.solve(lower, half.T))
    return np.sqrt(squares)


def _median_time(model: RodModel) -> float:
    """Time forward dynamics, with the overhead of a call from Python."""
    q, times = np.zeros(model.dofs), []
    model.accelerate(q)
    for _ in range(TIMED_CALLS):
        start = time.perf_counter_ns()
        model.accelerate(q)
        times.append(time.perf_counter_ns() - start)
    return float(np.median(times))
