"""Contact problems: the operations `contact_problems` and `solve_contacts`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header, check_blocks, limits
from featherbench_oracles.core.protocol import Unsupported


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


class Solution(Protocol):
    """What an answer tells of each solution."""

    @property
    def iterations(self) -> int:
        """As the engine counts them."""

    @property
    def nanoseconds(self) -> float:
        """The engine's own time."""


AnySolution = TypeVar("AnySolution", bound=Solution)


def check_contacts(blocks: Blocks, shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Check the numbers of contacts: as `check_blocks`, and no friction is negative."""
    check_blocks(blocks, shapes)
    if (blocks["friction"] < 0).any():
        raise ValueError("a friction is negative")


def in_turn(solve: Callable[[int], AnySolution], problems: int, first: int, count: int) -> tuple[Header, list[AnySolution]]:
    """Solve a range of problems, which begin again at their end.

    Parameters
    ----------
    solve : callable
        Solves the problem of a number.
    problems : int
        How many there are.
    first, count : int
        The range.

    Returns
    -------
    header : dict
        `nanoseconds` of all solutions, and `iterations` of those that are told.
    told : list
        The solutions of the last round: a time needs no impulses.
    """
    solved = [solve((first + k) % problems) for k in range(count)]
    told = solved[-problems:]
    return {"nanoseconds": sum(one.nanoseconds for one in solved), "iterations": [one.iterations for one in told]}, told


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
        check_contacts(blocks, shapes)
        each = zip(blocks["delassus"], blocks["free"], blocks["friction"], strict=True)
        self.problems = [ContactProblem(*numbers) for numbers in each]
        return {}, {}

    def solve(self, header: Header, _blocks: Blocks) -> Answer:
        """Solve a range of the problems, which begin again at their end: block `impulses` of shape (count, rows)."""
        method, first, count = header["method"], header["first"], header["count"]
        make = self.solvers.get(method) or self.relaxations.get(method)
        if make is None:
            raise Unsupported(f"{self.engine} offers no contact solver {method}")
        if self.problems is None:
            raise ValueError("no contact problems were given before")
        asked = method, *limits(header)
        if first < 0 or count < 1:
            raise ValueError(f"there are no {count} problems from {first} on")
        if self.ready is None or self.ready[0] != asked:
            self.ready = asked, make(self.problems, *asked[1:])
        answer, told = in_turn(self.ready[1].solve, len(self.problems), first, count)
        answer["converged"] = [one.converged for one in told]
        return answer, {"impulses": np.array([one.impulses for one in told])}
