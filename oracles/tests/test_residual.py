"""A residual behind the protocol: its answers, and errors."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.abilities.residual import Residual, ResidualEngine
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.session import Session

ROD = {
    "name": "rod",
    "mass": 1.0,
    "com": [0.5, 0.0, 0.0],
    "inertia": [0.01, 0.0, 0.0, 0.08, 0.0, 0.08],
    "parent": -1,
    "joint": {
        "name": "hinge",
        "type": "revolute",
        "axis": [0.0, 1.0, 0.0],
        "pitch": 0.0,
        "placement": {"rotation": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], "translation": [0.0, 0.0, 0.0]},
        "armature": [0.0],
        "damping": [0.0],
        "friction": [0.0],
    },
}
MODEL = {"format": 1, "name": "pendulum", "gravity": [0.0, 0.0, -9.81], "bodies": [ROD]}


def _session(function: Residual, *, acceleration: bool = False) -> Session:
    """Make a session that holds the pendulum."""
    session = Session(ResidualEngine("mine", "1", function, acceleration=acceleration))
    session.answer({"op": "prepare", "model": MODEL}, {})
    return session


def _states() -> tuple[Header, Blocks]:
    """Make three states."""
    rows = np.array([[0.1], [0.2], [0.3]])
    blocks = {"q": rows, "v": 10 * rows, "a": 100 * rows, "tau": 0 * rows, "wrench": np.zeros((3, 1, 6)), "probe": np.zeros((4, 1))}
    return {"op": "states", "count": 3}, blocks


def test_answers_are_those_of_the_function() -> None:
    """A range of states has the function's numbers, and `hello` says what it depends on."""
    session = _session(lambda q, v, a: q + v + a, acceleration=True)
    assert session.answer({"op": "hello"}, {})[0]["residual"] == {"acceleration": True}
    session.answer(*_states())
    _, blocks = session.answer({"op": "residual", "first": 1, "count": 2}, {})
    assert np.allclose(blocks["value"], [[22.2], [33.3]], rtol=1e-15, atol=0)


def test_what_it_cannot_is_refused() -> None:
    """States that are missing, ranges beyond them, wrong shapes and NaN are errors."""
    session = _session(lambda _q, v, _a: v)
    question = {"op": "residual", "first": 0, "count": 3}
    with pytest.raises(ValueError, match="no model and states"):
        session.answer(question, {})
    session.answer(*_states())
    with pytest.raises(ValueError, match="do not exist"):
        session.answer({**question, "first": 1}, {})
    for wrong in (lambda _q, _v, _a: np.zeros(2), lambda _q, v, _a: v * np.nan):
        bad = _session(wrong)
        bad.answer(*_states())
        with pytest.raises(ValueError, match="finite numbers"):
            bad.answer(question, {})


def test_an_engine_without_one_says_so() -> None:
    """An engine that has no residual does not offer it."""

    class Plain:
        name, version = "plain", "1"
        build: dict[str, str] = {}
        quantities: dict[str, dict[str, object]] = {}

    session = Session(Plain())  # type: ignore[arg-type]
    assert "residual" not in session.answer({"op": "hello"}, {})[0]
    with pytest.raises(Unsupported, match="no residual"):
        session.answer({"op": "residual", "first": 0, "count": 0}, {})
