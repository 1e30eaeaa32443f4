"""Convex problems by Clarabel: solutions by hand, optimality conditions, and errors."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from featherbench_oracles.abilities.semidefinite import SemidefiniteLeastSquares, problem
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.testing.client import Oracle

ALONE = Path(__file__).parents[2] / "target/oracles/clarabel/venv/bin/python"
RELAXATIONS = ("impulses", "velocities")
# What an interior-point method in double precision reaches on all problems here; at 1e-10 some end as `AlmostSolved`.
TOLERANCE = 1e-9


@pytest.fixture(scope="module")
def clarabel() -> Iterator[Oracle]:
    """Start the oracle in its own environment."""
    if not ALONE.exists():
        pytest.skip("clarabel is not installed (`featherbench oracles install clarabel`)")
    oracle = Oracle.of("clarabel", str(ALONE))
    yield oracle
    oracle.end()


def _relaxed(contacts: int, count: int, rank: int, seed: int) -> tuple[Header, Blocks]:
    """Draw problems with G of a rank."""
    draw = np.random.default_rng(seed)
    rows = 3 * contacts
    factors = draw.normal(size=(count, rows, rank))
    free = np.einsum("kij,kj->ki", factors, draw.normal(size=(count, rank)))
    blocks = {
        "delassus": factors @ factors.transpose(0, 2, 1),
        "free": free,
        "friction": draw.uniform(0.1, 1.0, (count, contacts)),
    }
    return {"op": "contact_problems", "count": count, "contacts": contacts}, blocks


def _solve(method: str, count: int) -> Header:
    return {"op": "solve_contacts", "method": method, "first": 0, "count": count, "tolerance": 1e-11, "iterations": 200}


@pytest.mark.parametrize("method", RELAXATIONS)
def test_the_unit_problem_projects(clarabel: Oracle, method: str) -> None:
    """With G = 1 the impulses are the projection of -b onto the cone."""
    blocks = {
        "delassus": np.array([np.eye(3)] * 4),
        "free": np.array([[-1.0, 0.2, 0.0], [-1.0, 2.0, 0.0], [1.0, 0.3, 0.0], [-2.0, 0.0, -3.0]]),
        "friction": np.array([[0.5], [0.5], [0.5], [0.0]]),
    }
    assert clarabel.ask({"op": "contact_problems", "count": 4, "contacts": 1}, blocks)[0]["status"] == "ok"
    answer, found = clarabel.ask(_solve(method, 4))
    assert answer["converged"] == [True] * 4
    assert answer["nanoseconds"] > 0
    due = [[1.0, -0.2, 0.0], [1.6, -0.8, 0.0], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    # A gap of 1e-11 of |lambda|² / 2 is an error of its root.
    assert np.allclose(found["impulses"], due, rtol=0, atol=1e-5)


def test_both_forms_have_one_velocity(clarabel: Oracle) -> None:
    """The problem of impulses and that of velocities are each other's duals: velocities agree where impulses need not."""
    header, blocks = _relaxed(contacts=4, count=20, rank=6, seed=3)
    assert clarabel.ask(header, blocks)[0]["status"] == "ok"
    velocities = []
    for method in RELAXATIONS:
        impulses = clarabel.ask(_solve(method, 20))[1]["impulses"]
        velocities.append(np.einsum("kij,kj->ki", blocks["delassus"], impulses) + blocks["free"])
    # A gap of 1e-11 bounds |c - c'|² / 2 in the metric of G, whose largest eigenvalue is about 30.
    assert np.allclose(velocities[0], velocities[1], rtol=0, atol=5e-5)


def _pseudo(seed: int, bodies: int, rows: int) -> Blocks:
    """Draw a problem whose unknowns are the ten numbers of each body's pseudo-inertia, with a target that leaves the cones."""
    draw = np.random.default_rng(seed)
    n = 10 * bodies
    maps = np.zeros((bodies, 4, 4, n + 1))
    for body in range(bodies):
        for k, (i, j) in enumerate(zip(*np.triu_indices(4), strict=True)):
            maps[body, i, j, 10 * body + k] = maps[body, j, i, 10 * body + k] = 1.0
    return {"a": draw.normal(size=(rows, n)), "b": draw.normal(size=rows), "maps": maps.reshape(bodies, 16, n + 1)}


def _ask(**change: object) -> Header:
    question = {"op": "semidefinite_least_squares", "method": "interior_point", "tolerance": TOLERANCE, "iterations": 200}
    return {**question, **change}


def _conditions(blocks: Blocks, x: Array, multipliers: Array) -> tuple[float, float, float, float]:
    """Measure stationarity, the least eigenvalues of P and Z, and the largest product of both."""
    values = blocks["maps"][:, :, :-1] @ x + blocks["maps"][:, :, -1]
    matrices, duals = values.reshape(-1, 4, 4), multipliers.reshape(-1, 4, 4)
    slope = blocks["a"].T @ (blocks["a"] @ x - blocks["b"]) - np.einsum("pek,pe->k", blocks["maps"][:, :, :-1], multipliers)
    least, dual = (float(np.linalg.eigvalsh(part).min()) for part in (matrices, duals))
    return (float(np.abs(slope).max()), least, dual, float(np.abs(np.einsum("pij,pij->p", matrices, duals)).max()))


@pytest.mark.parametrize(("bodies", "rows"), [(1, 12), (3, 90), (2, 15)])
def test_least_squares_are_optimal(clarabel: Oracle, bodies: int, rows: int) -> None:
    """The answer and its multipliers obey the optimality conditions, and a condition acts."""
    blocks = _pseudo(5, bodies, rows)
    answer, found = clarabel.ask(_ask(), blocks)
    assert (answer["status"], answer["converged"]) == ("ok", True)
    slope, least, dual, product = _conditions(blocks, found["x"], found["multipliers"])
    # The asked tolerance is 1e-9 of numbers of size 1 to 10, and a gap is a sum of products.
    assert slope < 1e-8
    assert least > -1e-8
    assert dual > -1e-8
    assert product < 1e-7
    assert np.abs(found["multipliers"]).max() > 0.1


def test_scalar_conditions_have_a_closed_form(clarabel: Oracle) -> None:
    """P = x I - I / 2 with target 0.2: the answer is the bound 0.5. Without bodies it is least squares."""
    maps = np.stack([np.eye(4).ravel(), -0.5 * np.eye(4).ravel()], axis=-1)[None]
    blocks = {"a": np.array([[2.0]]), "b": np.array([0.4]), "maps": maps}
    found = clarabel.ask(_ask(), blocks)[1]
    assert abs(found["x"][0] - 0.5) < 1e-8
    assert abs(np.trace(found["multipliers"].reshape(4, 4)) - 1.2) < 1e-7
    free = {**blocks, "maps": np.zeros((0, 16, 2))}
    answer, found = clarabel.ask(_ask(), free)
    assert answer["converged"]
    assert abs(found["x"][0] - 0.2) < 1e-8


@pytest.mark.parametrize(
    ("name", "change", "says"),
    [
        ("a", lambda a: a[0], "dimensions"),
        ("b", lambda b: b[1:], "rows"),
        ("maps", lambda maps: maps[:, :, 1:], "shape"),
        ("maps", lambda maps: np.where(np.arange(16)[None, :, None] == 1, maps + 1, maps), "not symmetric"),
        ("b", lambda b: b * np.nan, "not finite"),
    ],
)
def test_wrong_problems_are_refused(name: str, change: object, says: str) -> None:
    """A wrong block is named."""
    blocks = _pseudo(1, 2, 30)
    assert callable(change)
    blocks[name] = change(blocks[name])
    with pytest.raises(ValueError, match=says):
        problem(blocks)


def test_wrong_questions_are_refused() -> None:
    """An unknown method is unsupported; a tolerance of zero is an error."""
    nobody = SemidefiniteLeastSquares("nobody", {})
    with pytest.raises(Unsupported, match="nobody"):
        nobody.solve(_ask(), _pseudo(1, 1, 12))


def test_it_has_no_robots(clarabel: Oracle) -> None:
    """Clarabel says so, and lists what it solves."""
    hello = clarabel.ask({"op": "hello"})[0]
    assert hello["contact_relaxations"] == list(RELAXATIONS)
    assert hello["semidefinite_least_squares"] == ["interior_point"]
    assert hello["methods"] == {}
    body = {"name": "b", "mass": 1.0, "com": [0, 0, 0], "inertia": [1, 0, 0, 1, 0, 1], "parent": -1}
    turn = {"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [0, 0, 0]}
    joint = {"name": "j", "type": "revolute", "axis": [0, 0, 1], "pitch": 0.0, "placement": turn}
    joint |= {"armature": [0.0], "damping": [0.0], "friction": [0.0]}
    model = {"format": 1, "name": "one", "gravity": [0, 0, -9.81], "bodies": [{**body, "joint": joint}]}
    assert clarabel.ask({"op": "prepare", "model": model})[0]["status"] == "unsupported"
