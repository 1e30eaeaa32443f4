"""Contact problems: the operations `contact_problems` and `solve_contacts`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.algebra import Array
from featherbench_oracles.messages import Answer, Blocks, Header
from featherbench_oracles.protocol import Unsupported


@dataclass(frozen=True)
class ContactProblem:
    """Find impulses with c = G lambda + b that obey Signorini's and Coulomb's laws; rows of a contact: normal, tangent, tangent.

    Parameters
    ----------
    delassus : ndarray
        G, of shape (3 contacts, 3 contacts).
    free : ndarray
        b, of shape (3 contacts,).
    friction : ndarray
        mu of each contact.
    """

    delassus: Array
    free: Array
    friction: Array


@dataclass(frozen=True)
class ContactSolution:
    """What a solver answers.

    Parameters
    ----------
    impulses : ndarray
        lambda, in the rows of the problem.
    iterations : int
        As the engine counts them.
    converged : bool
        What the engine says.
    nanoseconds : float
        The engine's own time of the solution.
    """

    impulses: Array
    iterations: int
    converged: bool
    nanoseconds: float


class ContactSolver(Protocol):
    """A solver that holds what it needs for problems of one size, without anything known of their solutions."""

    def solve(self, problem: int) -> ContactSolution:
        """Solve the problem of this number, from impulses of zero."""


# Makes a solver for problems of one size, by its tolerance and its cap on iterations.
MakeSolver = Callable[[Sequence[ContactProblem], float, int], ContactSolver]
SolverTable = Mapping[str, MakeSolver]

# The most numbers of Delassus matrices at once: 800 MB.
MOST_NUMBERS = 100_000_000


def check_blocks(blocks: Blocks, shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Check the numbers of contacts.

    Parameters
    ----------
    blocks : Blocks
        What was sent; `friction` is among it.
    shapes : mapping of str to tuple of int
        The shape of each block.

    Raises
    ------
    ValueError
        If a block is missing, has another shape or a number that is not finite, or a friction is negative.
    """
    for name, shape in shapes.items():
        if name not in blocks or blocks[name].shape != shape:
            raise ValueError(f"block {name} is missing or not of shape {list(shape)}")
        if not np.isfinite(blocks[name]).all():
            raise ValueError(f"block {name} has a number that is not finite")
    if (blocks["friction"] < 0).any():
        raise ValueError("a friction is negative")


class Contacts:
    """The problems of a session, and the solvers that are ready for them.

    Parameters
    ----------
    engine : str
        The engine's name.
    solvers, relaxations : mapping of str to callable
        `(problems, tolerance, iterations) -> ContactSolver` by the method's name: of the laws themselves, and of their convex relaxation.
    """

    def __init__(self, engine: str, solvers: SolverTable, relaxations: SolverTable | None = None) -> None:
        self.engine, self.solvers, self.relaxations = engine, solvers, relaxations or {}
        self.problems: Sequence[ContactProblem] | None = None
        self.ready: tuple[Any, ContactSolver] | None = None

    def set_problems(self, header: Header, blocks: Blocks) -> Answer:
        """Keep problems for later solutions."""
        self.problems = self.ready = None
        count, contacts = header["count"], header["contacts"]
        if not (isinstance(count, int) and isinstance(contacts, int) and count > 0 and contacts > 0):
            raise ValueError("count and contacts must be positive")
        rows = 3 * contacts
        if count * rows * rows > MOST_NUMBERS:
            raise ValueError(f"{count} problems of {contacts} contacts are more than {MOST_NUMBERS} numbers")
        shapes = {"delassus": (count, rows, rows), "free": (count, rows), "friction": (count, contacts)}
        check_blocks(blocks, shapes)
        each = zip(blocks["delassus"], blocks["free"], blocks["friction"], strict=True)
        self.problems = [ContactProblem(*numbers) for numbers in each]
        return {}, {}

    def solve(self, header: Header, _blocks: Blocks) -> Answer:
        """Solve a range of the problems, which begin again at their end: block `impulses` of shape (count, rows)."""
        method, first, count = header["method"], header["first"], header["count"]
        tolerance, iterations = header["tolerance"], header["iterations"]
        make = self.solvers.get(method) or self.relaxations.get(method)
        if make is None:
            raise Unsupported(f"{self.engine} offers no contact solver {method}")
        if self.problems is None:
            raise ValueError("no contact problems were given before")
        if not (tolerance > 0 and np.isfinite(tolerance) and iterations > 0):
            raise ValueError("tolerance and iterations must be positive")
        if first < 0 or count < 1:
            raise ValueError(f"there are no {count} problems from {first} on")
        asked = method, tolerance, iterations
        if self.ready is None or self.ready[0] != asked:
            self.ready = asked, make(self.problems, tolerance, iterations)
        solver, all_of_them = self.ready[1], len(self.problems)
        solved = [solver.solve((first + k) % all_of_them) for k in range(count)]
        # A time needs no impulses: those of a last round are enough.
        told = solved[-all_of_them:]
        answer = {
            "nanoseconds": sum(one.nanoseconds for one in solved),
            "iterations": [one.iterations for one in told],
            "converged": [one.converged for one in told],
        }
        return answer, {"impulses": np.array([one.impulses for one in told])}
