"""Times of an engine's own calls through Python, the overhead of calling subtracted: estimates. Knows no engine.

The same calls on a robot without bodies go the same way through Python and the engine's binding, and compute next to nothing. They stand
right behind each call of a sample, because the call before has taken their code and data out of the caches: on their own, again and again,
they are up to a quarter faster, and the estimate is the longer by that. METHODOLOGY.md, "Timing", says by how much estimates are off.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter_ns
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.algebra import Array
from featherbench_oracles.change import Change
from featherbench_oracles.protocol import Question

SAMPLE = 64  # at most so many calls before the overhead: as many as the loop has and two, so that one interruption is no median
WARM = 5  # at most so many calls beside the clock before each loop: the process has slept, and a first call takes several times as long
WARM_NS = 200_000  # but no longer than this and a call
TRIALS = 3  # an interruption may make the overhead longer than everything: it is measured again before there is said to be no estimate
NOTHING = -1  # the body that a robot without bodies is asked about: the world

# what stands in `Calls.given` -> how it is made of a state
ARGUMENTS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "q": lambda robot, _, ask: robot.positions(ask.q),
    "v": lambda _, change, ask: change.to_engine_v(ask.v),
    "a": lambda _, change, ask: change.to_engine_a(ask.a),
    "b": lambda _, change, ask: change.b,  # the engine's acceleration where ours is zero
    "tau": lambda _, change, ask: change.to_engine_tau(ask.tau),
    "body": lambda _, change, ask: ask.body,
}


class Timed(Protocol):
    """What a robot needs for its calls to be timed."""

    def change(self, ask: Question) -> Change:
        """Find the change of velocities at the state."""

    def positions(self, q: Array) -> Array:
        """Bring coordinates of shape (nq,) to the engine: shape (nq of the engine,), m, rad or quaternions."""


@dataclass(frozen=True)
class Calls:
    """A method whose engine calls can be timed alone.

    Attributes
    ----------
    given : str
        What the calls are given: keys of `ARGUMENTS`, with blanks between.
    calls : callable
        The calls, a function of the robot and of what they are given.
    answer : callable
        Turns the change of coordinates and the calls' result into the answer.
    """

    given: str
    calls: Callable[..., Any]
    answer: Callable[[Change, Any], Any] = lambda _, result: result

    def arguments(self, robot: Timed, ask: Question, change: Change) -> tuple[Any, ...]:
        """Find what the calls are given at a state, in the engine's coordinates.

        Parameters
        ----------
        robot : Timed
            The robot.
        ask : Question
            The state.
        change : Change
            The change of coordinates there.

        Returns
        -------
        tuple
            As many as `given` has words.
        """
        return tuple(ARGUMENTS[name](robot, change, ask) for name in self.given.split())

    def __call__(self, robot: Timed, ask: Question) -> Any:
        """Answer at a state.

        Parameters
        ----------
        robot : Timed
            The robot.
        ask : Question
            The state.

        Returns
        -------
        Any
            The quantity's numbers, in the shape of `protocol.SHAPES`.
        """
        change = robot.change(ask)
        return self.answer(change, self.calls(robot, *self.arguments(robot, ask, change)))


class Stream:
    """The calls of one method, with what they are given at each state of a batch.

    Parameters
    ----------
    method : Calls
        The method.
    robot, nothing : Timed
        The robot, and one without bodies, which measures what calling takes.
    asks : list of Question
        The states.
    clock : callable
        Tells the time in nanoseconds.
    """

    def __init__(
        self, method: Calls, robot: Timed, nothing: Timed, asks: list[Question], clock: Callable[[], int] = perf_counter_ns
    ) -> None:
        self.clock = clock
        self.call = method.calls.__get__(robot)
        self.states = [method.arguments(robot, ask, robot.change(ask)) for ask in asks]
        self.next = 0
        self.alone = len(asks) == 1
        if self.alone:
            # An engine may see that it is given the same state again, and compute nothing: the last bit of q differs every other time.
            q, *others = self.states[0]
            self.states.append((q + np.spacing(np.maximum(np.abs(q), 1.0)), *others))
        self.call_nothing = method.calls.__get__(nothing)
        self.nothing = tuple(NOTHING if name == "body" else np.zeros(0) for name in method.given.split())
        self.call_nothing(*self.nothing)

    def time(self, first: int, count: int) -> tuple[int, int]:
        """Time the calls.

        Parameters
        ----------
        first : int
            The state where the stream begins; a few calls that are not timed come before.
        count : int
            How many calls.

        Returns
        -------
        nanoseconds, overhead : int
            What all calls take by themselves, and what was subtracted from their time, ns.

        Raises
        ------
        ValueError
            If the overhead is as long as what was measured.
        """
        gc.disable()
        try:
            for _ in range(TRIALS):
                self.next = self.next if self.alone else first
                self._warm_up()
                spent = self._loop(self._taken(count))
                overhead = round(count * self._overhead(self._taken(min(SAMPLE, count + 2))))
                if spent > overhead:
                    return spent - overhead, overhead
        finally:
            gc.enable()
        told = f"calling takes {overhead / count:.0f} ns of the {spent / count:.0f} ns that were measured"
        raise ValueError(f"{told}: nothing is left to estimate")

    def _taken(self, count: int) -> list[tuple[Any, ...]]:
        """Take the next states."""
        taken = [self.states[k % len(self.states)] for k in range(self.next, self.next + count)]
        self.next += count
        return taken

    def _warm_up(self) -> None:
        """Make some calls that are not timed."""
        end = self.clock() + WARM_NS
        for _ in range(WARM):
            self._loop(self._taken(1))
            if self.clock() > end:
                break

    def _loop(self, stream: list[tuple[Any, ...]]) -> int:
        """Measure the nanoseconds of the calls as Python sees them."""
        call, clock = self.call, self.clock
        start = clock()
        for given in stream:
            call(*given)
        return clock() - start

    def _overhead(self, sample: list[tuple[Any, ...]]) -> float:
        """Measure the nanoseconds of a call that computes nothing, behind one that does: the median, without the clock's own."""
        call, call_nothing, nothing, clock, found = self.call, self.call_nothing, self.nothing, self.clock, []
        for given in sample:
            call(*given)
            start = clock()
            call_nothing(*nothing)
            stop = clock()
            found.append((stop - start) - (clock() - stop))
        return median(found)
