"""Steps of a robot on its contacts: the operations `contact_steps` and `solve_contact_steps`. This module depends on no engine.

An engine whose solver takes no Delassus matrix gets the robot, the points that touch the ground and the states. Each state has one contact
problem: that of a step, with all points closed. The engine answers it by its own model of contact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.abilities.contacts import check_contacts, in_turn
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header, limits
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description

# The most numbers of impulses and states at once: 80 MB.
MOST_NUMBERS = 10_000_000


@dataclass(frozen=True)
class ContactSteps:
    """A robot that touches the ground z = 0 at points, and the states from which it makes a step.

    Attributes
    ----------
    robot : Description
        The robot.
    dt : float
        The length of the step, s.
    bodies : list of int
        The body of each point.
    points : ndarray, shape (contacts, 3)
        The points, in body axes, m.
    friction : ndarray, shape (contacts,)
        mu of each.
    q, v, tau : ndarray
        The states and the joints' forces, neutral, state after state.
    """

    robot: Description
    dt: float
    bodies: list[int]
    points: Array
    friction: Array
    q: Array
    v: Array
    tau: Array


@dataclass(frozen=True)
class StepSolution:
    """What a solver answers.

    Attributes
    ----------
    impulses : ndarray, shape (contacts, 3)
        On the robot, along z, x, y of the world, N s.
    iterations : int
        As the engine counts them.
    nanoseconds : float
        Of the engine's own stage of contacts.
    """

    impulses: Array
    iterations: int
    nanoseconds: float


class StepSolver(Protocol):
    """A solver that holds a robot in all states, ready for the stage that finds contact forces."""

    def solve(self, state: int) -> StepSolution:
        """Find the impulses of the step from this state, from impulses of zero."""


# Makes a solver by its tolerance and its cap on iterations.
MakeStepSolver = Callable[[ContactSteps, float, int], StepSolver]


@dataclass(frozen=True)
class StepMethod:
    """A way to find the impulses.

    Attributes
    ----------
    make : callable
        `(steps, tolerance, iterations) -> StepSolver`.
    settings : dict
        The engine's model of contact; `time`: what the time includes; `limit`: the method whose answers by a small tolerance are those of
        the same model without an error of the solver.
    """

    make: MakeStepSolver
    settings: Header


class StepsOnContacts:
    """The robot on its contacts of a session, and the solver that is ready for it.

    Parameters
    ----------
    engine : str
        The engine's name.
    methods : mapping of str to StepMethod
        By the method's name.
    """

    def __init__(self, engine: str, methods: Mapping[str, StepMethod]) -> None:
        self.engine, self.methods = engine, methods
        self.steps: ContactSteps | None = None
        self.ready: tuple[Any, StepSolver] | None = None

    def hello(self) -> Header:
        """Tell what the engine offers, with the settings."""
        return {"contact_steps": {name: method.settings for name, method in self.methods.items()}} if self.methods else {}

    def prepare(self, header: Header, blocks: Blocks) -> Answer:
        """Keep a robot, its points and states for later solutions."""
        self.steps = self.ready = None
        if not self.methods:
            raise Unsupported(f"{self.engine} makes no steps on contacts")
        robot = Description.read(header["model"])
        count, bodies, dt = header["count"], header["bodies"], header["dt"]
        contacts = len(bodies)
        if not (count > 0 and contacts > 0):
            raise ValueError("count and the list of bodies must not be empty")
        if count * (robot.nq + 2 * robot.nv + 3 * contacts) > MOST_NUMBERS:
            raise ValueError(f"{count} states on {contacts} contacts are more than {MOST_NUMBERS} numbers")
        for body in bodies:
            if not (isinstance(body, int) and 0 <= body < len(robot.bodies)):
                raise ValueError(f"a point is on body {body}, and there are {len(robot.bodies)}")
        if not (dt > 0 and np.isfinite(dt)):
            raise ValueError("dt must be positive and finite")
        shapes = {"points": (contacts, 3), "friction": (contacts,)}
        shapes |= {"q": (count, robot.nq), "v": (count, robot.nv), "tau": (count, robot.nv)}
        check_contacts(blocks, shapes)
        self.steps = ContactSteps(robot, dt, bodies, **{name: blocks[name] for name in shapes})
        return {"nq": robot.nq, "nv": robot.nv}, {}

    def solve(self, header: Header, _blocks: Blocks) -> Answer:
        """Solve a range of the states, which begin again at their end: block `impulses` of shape (count, 3 contacts)."""
        method, first, count = header["method"], header["first"], header["count"]
        if method not in self.methods:
            raise Unsupported(f"{self.engine} offers no step on contacts by {method}")
        if self.steps is None:
            raise ValueError("no robot on contacts was given before")
        asked = method, *limits(header)
        if first < 0 or count < 1:
            raise ValueError(f"there are no {count} states from {first} on")
        if self.ready is None or self.ready[0] != asked:
            self.ready = asked, self.methods[method].make(self.steps, *asked[1:])
        answer, told = in_turn(self.ready[1].solve, len(self.steps.q), first, count)
        return answer, {"impulses": np.array([one.impulses.ravel() for one in told])}
