"""Times of an engine's own calls through Python, less the overhead of calling. They are estimates. This module depends on no engine.

The overhead is the time of the same calls on a robot without bodies. They go the same way through Python and the engine's binding, and
compute next to nothing. Each is made directly after one call of a sample, which has taken their code and data out of the caches. In a
loop of their own they are up to a quarter faster, and the estimate would be too long by that.
`guide/studies/timing.md`, "Limits", gives the errors.
"""

from __future__ import annotations

import gc
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter_ns
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import State

SAMPLE = 64  # calls that measure the overhead: at most these; else those of the loop plus two, so that one interruption is no median
WARM = 5  # calls before each loop that are not timed, at most: after a pause the first call takes several times as long
WARM_NS = 200_000  # no further such call after this time
TRIALS = 3  # measurements before the answer is that there is no estimate: an interruption may make the overhead too long
NOTHING = -1  # the body in a question to a robot without bodies: the world

# word of `TimedCalls.given` -> how the argument is made from a state
ARGUMENTS: dict[str, Callable[[Any, Any, Any], Any]] = {
    "q": lambda robot, _, ask: robot.positions(ask.q),
    "v": lambda _, change, ask: change.to_engine_v(ask.v),
    "a": lambda _, change, ask: change.to_engine_a(ask.a),
    "b": lambda _, change, ask: change.b,  # the engine's acceleration where ours is zero
    "tau": lambda _, change, ask: change.to_engine_tau(ask.tau),
    "body": lambda _, change, ask: ask.body,
}


class Timed(Protocol):
    """The interface of a robot whose calls can be timed."""

    def change(self, ask: State) -> CoordinateChange:
        """Find T and b at a state.

        Parameters
        ----------
        ask : State
            The state.

        Returns
        -------
        CoordinateChange
            The change from neutral to engine coordinates there.
        """

    def positions(self, q: Array) -> Array:
        """Convert positions to the engine's.

        Parameters
        ----------
        q : ndarray, shape (nq,)
            Neutral positions, m, rad or quaternions.

        Returns
        -------
        ndarray, shape (nq of the engine,)
            q_e, in the units of the engine's table in its module `coordinates`.
        """


@dataclass(frozen=True)
class TimedCalls:
    """A method whose engine calls can be timed alone.

    The calls take and return numbers in the engine's coordinates (e):

    ::

        word   argument                               shape                unit
        q      q_e                                    (nq of the engine,)  m, rad, quaternions or rotation vectors
        v      v_e                                    (nv,)                m/s or rad/s
        a      a_e                                    (nv,)                m/s² or rad/s²
        b      a_e where the neutral a is zero        (nv,)                m/s² or rad/s²
        tau    tau_e                                  (nv,)                N or N m
        body   the body's index in the description    -                    -

    Their result is tau_e, a_e, M_e of shape (nv, nv) in kg, kg m or kg m², J_e of shape (6, nv), an energy in J, or the centre of mass
    of shape (3,) in m.

    Attributes
    ----------
    given : str
        The arguments of the calls: words of this table, separated by blanks.
    calls : callable
        The calls, a function of the robot and these arguments.
    answer : callable
        Converts the result of the calls, with the change of coordinates, to the answer.
    """

    given: str
    calls: Callable[..., Any]
    answer: Callable[[CoordinateChange, Any], Any] = lambda _, result: result

    def arguments(self, robot: Timed, ask: State, change: CoordinateChange) -> tuple[Any, ...]:
        """Compute the arguments of the calls at a state, in the engine's coordinates.

        Parameters
        ----------
        robot : Timed
            The robot.
        ask : State
            The state.
        change : CoordinateChange
            The change of coordinates there.

        Returns
        -------
        tuple
            One for each word of `given`.
        """
        return tuple(ARGUMENTS[name](robot, change, ask) for name in self.given.split())

    def __call__(self, robot: Timed, ask: State) -> Any:
        """Answer at a state.

        Parameters
        ----------
        robot : Timed
            The robot.
        ask : State
            The state.

        Returns
        -------
        Any
            The quantity's numbers, in the shape of `protocol.SHAPES`.
        """
        change = robot.change(ask)
        return self.answer(change, self.calls(robot, *self.arguments(robot, ask, change)))


class MeasuredStream(Protocol):
    """The states of a method whose loop is code that reads the clock itself."""

    def time(self, first: int, count: int) -> int:
        """Time the loop.

        Parameters
        ----------
        first, count : int
            The range of states. Beyond the end of the batch they begin again.

        Returns
        -------
        int
            Its nanoseconds.
        """

    def relocate(self, seed: int | None) -> None:
        """Copy all data to other addresses.

        Parameters
        ----------
        seed : int, optional
            The addresses are drawn with it.
        """


class Measured(ABC):
    """A method whose loop over states is compiled code, with the clock beside it: nothing of Python is timed."""

    @abstractmethod
    def stream(self, robot: Any, asks: list[State]) -> MeasuredStream:
        """Convert states for the loop.

        Parameters
        ----------
        robot : Any
            The robot.
        asks : list of State
            The states, at least one.

        Returns
        -------
        MeasuredStream
            What can be timed.
        """


class Stream:
    """The calls of one method, with their arguments at each state of a batch.

    Parameters
    ----------
    method : TimedCalls
        The method.
    robot, nothing : Timed
        The robot, and one without bodies, which measures the overhead of calling.
    asks : list of State
        The states.
    clock : callable
        The time in nanoseconds.
    """

    def __init__(
        self, method: TimedCalls, robot: Timed, nothing: Timed, asks: list[State], clock: Callable[[], int] = perf_counter_ns
    ) -> None:
        self.clock = clock
        self.call = method.calls.__get__(robot)
        self.states = [method.arguments(robot, ask, robot.change(ask)) for ask in asks]
        self.next = 0
        self.alone = len(asks) == 1
        if self.alone:
            # An engine may detect that the state is the same, and compute nothing. So the last bit of q differs every other time.
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
            The state where the stream begins. A few calls that are not timed come before.
        count : int
            How many calls.

        Returns
        -------
        nanoseconds, overhead : int
            The time of all calls less their overhead, and that overhead, ns.

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
        """Measure the nanoseconds of a call that computes nothing, after one that does: the median, less the time of the clock itself."""
        call, call_nothing, nothing, clock, found = self.call, self.call_nothing, self.nothing, self.clock, []
        for given in sample:
            call(*given)
            start = clock()
            call_nothing(*nothing)
            stop = clock()
            found.append((stop - start) - (clock() - stop))
        return median(found)
