"""Contact problems: solutions by hand, and errors."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.abilities.contacts import Contacts, ContactSolver
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Unsupported

from .conftest import Oracles

SOLVERS = ("pgs", "admm")


def _sphere() -> tuple[Header, Blocks]:
    """Make the problem of a sphere (m = 2, r = 0.5) that lands sliding: a step that sticks, and one that slides."""
    mass, radius, inertia = 2.0, 0.5, 0.2
    across = 1 / mass + radius**2 / inertia
    free = np.array([[-1.0, 0.4, -0.1], [-1.0, 30.0, 40.0]])
    delassus = np.array([np.diag([1 / mass, across, across])] * 2)
    return {"op": "contact_problems", "count": 2, "contacts": 1}, {"delassus": delassus, "free": free, "friction": np.full((2, 1), 0.3)}


def _solve(method: str, **change: float) -> Header:
    return {"op": "solve_contacts", "method": method, "first": 0, "count": 2, "tolerance": 1e-11, "iterations": 1000, **change}


@pytest.mark.parametrize("method", SOLVERS)
def test_a_sphere_sticks_or_slides(oracles: Oracles, method: str) -> None:
    """Sticking stops the point: lambda = -G^-1 b. Sliding opposes the velocity with mu times the normal impulse."""
    oracle = oracles["pinocchio"]
    header, blocks = _sphere()
    assert oracle.ask(header, blocks)[0]["status"] == "ok"
    answer, found = oracle.ask(_solve(method))
    sticks = -blocks["free"][0] / np.diag(blocks["delassus"][0])
    slides = np.array([2.0, -0.6 * 0.6, -0.6 * 0.8])
    # The solvers' own measure is 1e-11 of velocities up to 50.
    assert np.allclose(found["impulses"], [sticks, slides], rtol=0, atol=1e-8)
    assert answer["converged"] == [True, True]
    assert answer["nanoseconds"] > 0
    again = oracle.ask(_solve(method, count=5))
    assert np.array_equal(again[1]["impulses"], found["impulses"][[1, 0]])
    assert again[0]["nanoseconds"] > 0


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("friction", -0.1, "negative"), ("free", np.nan, "not finite"), ("delassus", np.inf, "not finite")],
)
def test_wrong_problems_are_refused(name: str, value: float, says: str) -> None:
    """A wrong number is named, and earlier problems are gone."""
    contacts = Contacts("nobody", {})
    header, blocks = _sphere()
    contacts.set_problems(header, blocks)
    blocks[name] = blocks[name].copy()
    blocks[name].flat[0] = value
    with pytest.raises(ValueError, match=says):
        contacts.set_problems(header, blocks)
    assert contacts.problems is None
    with pytest.raises(ValueError, match="shape"):
        contacts.set_problems({**header, "contacts": 2}, blocks)
    with pytest.raises(ValueError, match="positive"):
        contacts.set_problems({**header, "count": 0}, blocks)


def test_wrong_questions_are_refused() -> None:
    """An unknown solver is unsupported; questions without sense are errors."""

    def make(*_: object) -> ContactSolver:
        raise AssertionError("no solver is made of a wrong question")

    contacts = Contacts("nobody", {"any": make})
    with pytest.raises(ValueError, match="no contact problems"):
        contacts.solve(_solve("any"), {})
    contacts.set_problems(*_sphere())
    with pytest.raises(Unsupported, match="other"):
        contacts.solve(_solve("other"), {})
    for change in ({"tolerance": 0.0}, {"tolerance": np.inf}, {"iterations": 0}, {"first": -1}, {"count": 0}):
        with pytest.raises(ValueError, match=r"positive|there are no"):
            contacts.solve(_solve("any", **change), {})
