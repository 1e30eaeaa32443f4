"""Steps on contacts: a body on one point against Euler's equations, and errors."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.abilities.contact_steps import StepMethod, StepsOnContacts
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Unsupported

from .conftest import Oracles

IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
MASS, INERTIA, POINT, GRAVITY = 2.0, np.array([0.1, 0.2, 0.25]), np.array([0.1, 0.0, -0.2]), 9.81
DT, FRICTION = 1e-3, 0.5
SPIN = np.array([0.1, 0.2, 0.0])
# Two states: the point sticks, or slides.
SPEEDS = np.array([[0.05, 0.015, -0.44], [-3.0, -0.9, -0.44]])


def _steps() -> tuple[Header, Blocks]:
    """Describe a free body that lands on one point."""
    joint: Header = {
        "name": "j",
        "type": "free",
        "axis": [0.0] * 3,
        "pitch": 0.0,
        "placement": {"rotation": IDENTITY, "translation": [0.0] * 3},
    }
    joint |= {"armature": [0.0] * 6, "damping": [0.0] * 6, "friction": [0.0] * 6}
    moments = [INERTIA[0], 0.0, 0.0, INERTIA[1], 0.0, INERTIA[2]]
    body = {"name": "b", "parent": -1, "mass": MASS, "com": [0.0] * 3, "inertia": moments, "joint": joint}
    model = {"format": 1, "name": "lander", "gravity": [0.0, 0.0, -GRAVITY], "bodies": [body]}
    blocks = {
        "points": POINT[None],
        "friction": np.array([FRICTION]),
        "q": np.tile([0.0, 0.0, -POINT[2], 0.0, 0.0, 0.0, 1.0], (2, 1)),
        "v": np.hstack([SPEEDS, np.tile(SPIN, (2, 1))]),
        "tau": np.zeros((2, 6)),
    }
    return {"op": "contact_steps", "model": model, "count": 2, "bodies": [0], "dt": DT}, blocks


def _solve(method: str, **change: float) -> Header:
    return {"op": "solve_contact_steps", "method": method, "first": 0, "count": 2, "tolerance": 1e-14, "iterations": 1000, **change}


def _problem(speed: Array) -> tuple[Array, Array]:
    """Compute G and b of the point along x, y, z: Newton's and Euler's equations."""
    x, y, z = POINT
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    jacobian = np.hstack([np.eye(3), -cross])
    by_mass = jacobian / np.concatenate([np.full(3, MASS), INERTIA])
    turn = -np.cross(SPIN, INERTIA * SPIN) / INERTIA
    fall = np.array([0.0, 0.0, -GRAVITY]) - np.cross(SPIN, speed)  # of the linear velocity in body axes
    return by_mass @ jacobian.T, jacobian @ np.concatenate([speed + DT * fall, SPIN + DT * turn])


def test_a_body_lands_on_a_point(oracles: Oracles) -> None:
    """Sticking stops the point. Sliding is that of the convex relaxation: friction on the cone, against a slip that lifts by mu times it.

    R is 1e-4 of the diagonal of G, so velocities of at most 1e-3 are left where the point sticks, and of 1e-3 of the slip where it slides.
    """
    oracle = oracles["mujoco"]
    offered = oracle.must({"op": "hello"})[0]["contact_steps"]
    header, blocks = _steps()
    assert oracle.must(header, blocks)[0]["nv"] == 6
    assert {settings["limit"] for settings in offered.values()} <= set(offered)
    for method, settings in offered.items():
        answer, found = oracle.must(_solve(method))
        assert found["impulses"].shape == (2, 3)
        assert answer["nanoseconds"] > 0
        for speed, (z, x, y) in zip(SPEEDS, found["impulses"], strict=True):
            impulse = np.array([x, y, z])
            delassus, free = _problem(speed)
            after = delassus @ impulse + free
            slip = float(np.hypot(*after[:2]))
            if abs(speed[0]) < 1:
                assert np.abs(after).max() < 1e-3, method
                assert np.hypot(x, y) < FRICTION * z, method
            elif "elliptic" in settings["model"]:
                assert abs(np.hypot(x, y) - FRICTION * z) < 1e-6, method
                assert abs(after[2] - FRICTION * slip) < 1e-3 * slip, method
                # The slip opposes friction, up to the softness.
                assert abs(np.dot(after[:2], [x, y]) / (slip * np.hypot(x, y)) + 1) < 1e-3, method
            else:
                # The pyramid lies within the cone.
                assert abs(x) + abs(y) < FRICTION * z * (1 + 1e-6), method
        again = oracle.must(_solve(method, count=5))[1]["impulses"]
        assert np.array_equal(again, found["impulses"][[1, 0]]), method


def test_solvers_of_one_model_agree(oracles: Oracles) -> None:
    """Newton's method, conjugate gradients and sweeps minimise the same function."""
    oracle = oracles["mujoco"]
    oracle.must(*_steps())
    by = {method: oracle.must(_solve(method))[1]["impulses"] for method in ("elliptic_newton", "elliptic_cg", "elliptic_pgs")}
    for method in ("elliptic_cg", "elliptic_pgs"):
        assert np.abs(by[method] - by["elliptic_newton"]).max() < 1e-6, method


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("friction", -0.1, "negative"), ("v", np.nan, "not finite"), ("points", np.inf, "not finite")],
)
def test_wrong_steps_are_refused(name: str, value: float, says: str) -> None:
    """A wrong number is named, and an earlier robot is gone."""
    steps = StepsOnContacts("somebody", {"any": StepMethod(lambda *_: pytest.fail("nothing is made of a wrong question"), {})})
    header, blocks = _steps()
    steps.prepare(header, blocks)
    wrong = {**blocks, name: blocks[name].copy()}
    wrong[name].flat[0] = value
    with pytest.raises(ValueError, match=says):
        steps.prepare(header, wrong)
    assert steps.steps is None


def test_wrong_questions_are_refused() -> None:
    """An engine or a method that is not there is unsupported; questions without sense are errors."""
    header, blocks = _steps()
    with pytest.raises(Unsupported, match="nobody"):
        StepsOnContacts("nobody", {}).prepare(header, blocks)
    steps = StepsOnContacts("somebody", {"any": StepMethod(lambda *_: pytest.fail("nothing is made of a wrong question"), {})})
    with pytest.raises(ValueError, match="no robot"):
        steps.solve(_solve("any"), {})
    for change, says in (({"bodies": [1]}, "body 1"), ({"bodies": []}, "empty"), ({"dt": 0.0}, "dt"), ({"count": 3}, "block q")):
        with pytest.raises(ValueError, match=says):
            steps.prepare({**header, **change}, blocks)
    steps.prepare(header, blocks)
    with pytest.raises(Unsupported, match="other"):
        steps.solve(_solve("other"), {})
    for wrong in ({"tolerance": 0.0}, {"tolerance": np.inf}, {"iterations": 0}, {"first": -1}, {"count": 0}):
        with pytest.raises(ValueError, match=r"positive|there are no"):
            steps.solve(_solve("any", **wrong), {})
