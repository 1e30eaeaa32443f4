"""Robots with loops: accelerations and motions against closed forms, coordinates that come back, and errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from featherbench_oracles.abilities.loops import LoopMethods, Loops
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.dart.coordinates import exponential, log

from .conftest import Oracles

ENGINES = ("pinocchio", "mujoco", "drake", "dart")
IDENTITY = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
ABOUT_Y = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]  # a frame whose z axis is y
# How far accelerations may be off, by method: rounding of a proximal solver, a soft loop, a loop that is held over a step.
EXACT = {"constraint_dynamics": 1e-11, "lcaba": 1e-6, "default": 0.5, "stiff": 1e-3, "sap_1e-3": 5e-3, "step_1e-3": 1e-6}
# The energy after a second with a step of 1 ms: order four, a soft loop, order one.
DRIFT = {"rk4_constraint_dynamics": 1e-11, "rk4_constraint_dynamics_baumgarte": 1e-11, "rk4_lcaba": 1e-8, "rk4": 1e-3, "rk4_stiff": 1e-6}
FIRST_ORDER = 1e-2


def _rod(name: str, parent: int, place: list[float], end: list[float]) -> Header:
    """Describe a rod of 1 kg on a hinge about y, with 1 % of its inertia about its own axis."""
    square = float(np.dot(end, end))
    inertia = (square * np.eye(3) - 0.99 * np.outer(end, end)) / 12
    placement = {"rotation": IDENTITY, "translation": place}
    joint: Header = {"name": name, "type": "revolute", "axis": [0.0, 1.0, 0.0], "pitch": 0.0, "placement": placement}
    joint |= {"armature": [0.0], "damping": [0.0], "friction": [0.0]}
    half = [0.5 * x for x in end]
    return {"name": name, "parent": parent, "mass": 1.0, "com": half, "inertia": inertia[np.triu_indices(3)].tolist(), "joint": joint}


def _end(body: int, place: list[float], rotation: list[float]) -> Header:
    return {"body": body, "placement": {"rotation": rotation, "translation": place}}


def _four_bar(kind: str = "revolute") -> Header:
    """Describe a parallelogram of rods of 1 m."""
    bodies = [_rod("a", -1, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0]), _rod("b", 0, [0.0, 0.0, -1.0], [1.0, 0.0, 0.0])]
    bodies.append(_rod("c", -1, [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]))
    loop: Header = {"name": "hinge", "type": kind, "first": _end(2, [0.0, 0.0, -1.0], ABOUT_Y), "second": _end(1, [1.0, 0.0, 0.0], ABOUT_Y)}
    return {"format": 1, "name": "four-bar", "gravity": [0.0, 0.0, -9.81], "bodies": bodies, "loops": [loop]}


def _spread(angle: float) -> Array:
    return np.array([angle, -angle, angle])


def _acceleration(angle: float, torque: float = 0.0) -> float:
    """Compute the closed form: cranks of 1/3 kg m² each, a coupler of 1 kg that only translates."""
    return (torque - 2.0 * 9.81 * float(np.sin(angle))) / (5.0 / 3.0)


def _energy(q: Array, v: Array) -> float:
    return float(0.5 * 5.0 / 3.0 * v[0] ** 2 - 2.0 * 9.81 * np.cos(q[0]))


@pytest.mark.parametrize("kind", ["revolute", "spherical"])
@pytest.mark.parametrize("engine", ENGINES)
def test_a_four_bar_accelerates(oracles: Oracles, engine: str, kind: str) -> None:
    """Accelerations under gravity and a torque are those of the closed form, as exactly as each engine holds a loop."""
    oracle = oracles[engine]
    offered = oracle.must({"op": "hello"})[0]["loops"]
    held = oracle.must({"op": "loops", "model": _four_bar(kind)})[0]
    assert (held["nq"], held["nv"]) == (3, 3)
    assert held["held"] == {"hinge": offered["types"][kind]}
    states = [(0.7, 0.9, 0.0), (-1.1, -1.5, 0.3), (0.2, 0.0, -2.0)]
    blocks = {"q": np.array([_spread(q) for q, _, _ in states]), "v": np.array([_spread(v) for _, v, _ in states])}
    blocks["tau"] = np.array([[torque, 0.0, 0.0] for _, _, torque in states])
    due = np.array([_spread(_acceleration(q, torque)) for q, _, torque in states])
    for method in offered["accelerations"]:
        answer, found = oracle.must({"op": "loop_accelerations", "method": method, "count": 3, "repeats": 2}, blocks)
        assert np.abs(found["acceleration"] - due).max() < EXACT[method] * np.abs(due).max(), method
        assert answer["nanoseconds"] > 0
        assert answer["settings"]
        again = oracle.must({"op": "loop_accelerations", "method": method, "count": 3}, blocks)[1]
        assert np.array_equal(again["acceleration"], found["acceleration"]), method


@pytest.mark.parametrize("engine", ENGINES)
def test_a_four_bar_swings(oracles: Oracles, engine: str) -> None:
    """A motion keeps its energy and its loop, as each method does, and comes back after each `every` steps."""
    oracle = oracles[engine]
    offered = oracle.must({"op": "hello"})[0]["loops"]
    oracle.must({"op": "loops", "model": _four_bar()})
    start = {"q": _spread(0.7), "v": _spread(0.0)}
    for method in offered["motions"]:
        answer, found = oracle.must({"op": "loop_motion", "method": method, "dt": 1e-3, "steps": 1000, "every": 100}, start)
        assert found["q"].shape == found["v"].shape == (10, 3)
        drift = abs(_energy(found["q"][-1], found["v"][-1]) - _energy(start["q"], start["v"]))
        assert drift < DRIFT.get(method, FIRST_ORDER), method
        assert np.abs(found["q"] - [[q[0], -q[0], q[0]] for q in found["q"]]).max() < 1e-3, method
        assert np.abs(found["q"][0, 0] - (0.7 + 0.5 * _acceleration(0.7) * 0.01)) < 2e-3, method
        assert answer["nanoseconds"] > 0


@pytest.mark.parametrize("engine", ENGINES)
def test_a_free_joint_comes_back(oracles: Oracles, engine: str) -> None:
    """A body on a free joint, held at a point of the world, is a spherical pendulum: its acceleration, and the held point in time."""
    body: Header = {"name": "b", "parent": -1, "mass": 2.0, "com": [0.3, 0.0, 0.0], "inertia": [0.1, 0.0, 0.0, 0.2, 0.0, 0.25]}
    joint: Header = {"name": "j", "type": "free", "placement": {"rotation": ABOUT_Y, "translation": [0.1, 0.2, 0.3]}}
    joint |= {"axis": [0.0, 0.0, 0.0], "pitch": 0.0, "armature": [0.0] * 6, "damping": [0.0] * 6, "friction": [0.0] * 6}
    # Where q is zero the body's origin is at the joint's frame: there it is held.
    loop = {"name": "hook", "type": "spherical", "first": _end(-1, [0.1, 0.2, 0.3], IDENTITY), "second": _end(0, [0.0] * 3, IDENTITY)}
    model = {"format": 1, "name": "hung", "gravity": [0.0, 0.0, -9.81], "bodies": [{**body, "joint": joint}], "loops": [loop]}
    oracle = oracles[engine]
    offered = oracle.must({"op": "hello"})[0]["loops"]
    oracle.must({"op": "loops", "model": model})
    q, v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.0, 0.3, 0.2, -0.4])
    blocks = {"q": q[None], "v": v[None], "tau": np.zeros((1, 6))}
    # Euler's equations about the held point, with gravity in the body's axes.
    about = np.diag([0.1, 0.2 + 2.0 * 0.09, 0.25 + 2.0 * 0.09])
    down = np.array(ABOUT_Y).reshape(3, 3).T @ [0.0, 0.0, -9.81]
    turn = np.linalg.solve(about, 2.0 * np.cross([0.3, 0.0, 0.0], down) - np.cross(v[3:], about @ v[3:]))
    for method in offered["accelerations"]:
        found = oracle.must({"op": "loop_accelerations", "method": method, "count": 1}, blocks)[1]["acceleration"][0]
        assert np.abs(found - np.append(np.zeros(3), turn)).max() < EXACT[method] * 9.81, method
    for method in offered["motions"]:
        moved = oracle.must({"op": "loop_motion", "method": method, "dt": 1e-3, "steps": 200, "every": 200}, {"q": q, "v": v})[1]
        end = moved["q"][0]
        assert abs(np.linalg.norm(end[3:]) - 1) < 1e-9, method
        assert np.abs(end[:3]).max() < 1e-3, method
        assert np.linalg.norm(end[3:6]) > 0.02, method
        assert np.abs(moved["v"][0, :3]).max() < 1e-2, method


LINK = [1.0, 2.5]  # masses of two pendulums of 1 m
OFFSET, RATIO, SQUARE, APART = 0.3, -1.5, 0.4, 1.5


def _tied(kind: str) -> tuple[Header, Any]:
    """Describe two pendulums that are tied, and how the second angle follows: its value, slope and bend."""
    apart = 0.0 if kind == "fixed" else APART
    bodies = [_rod(name, -1, [place, 0.0, 0.0], [0.0, 0.0, -1.0]) for name, place in (("a", 0.0), ("b", apart))]
    bodies[1]["mass"] = LINK[1]
    bodies[1]["inertia"] = [LINK[1] * x for x in bodies[1]["inertia"]]
    tip, origin = [0.0, 0.0, -1.0], [0.0] * 3
    ties: dict[str, tuple[Header, Any]] = {
        "gear": (
            {"terms": [{"body": 1, "coefficient": 2.0}, {"body": 0, "coefficient": -2.0 * RATIO}], "offset": 2.0 * OFFSET},
            lambda x: (OFFSET + RATIO * x, RATIO, 0.0),
        ),
        "mimic": (
            {"follower": 1, "leader": 0, "polynomial": [OFFSET, RATIO, SQUARE, 0.0, 0.0]},
            lambda x: (OFFSET + RATIO * x + SQUARE * x**2, RATIO + 2 * SQUARE * x, 2 * SQUARE),
        ),
        "distance": ({"length": APART, "first": _end(0, tip, IDENTITY), "second": _end(1, tip, IDENTITY)}, lambda x: (x, 1.0, 0.0)),
        "fixed": ({"first": _end(0, origin, IDENTITY), "second": _end(1, origin, IDENTITY)}, lambda x: (x, 1.0, 0.0)),
    }
    tie, follow = ties[kind]
    loops = [{"name": "tie", "type": kind, **tie}]
    return {"format": 1, "name": kind, "gravity": [0.0, 0.0, -9.81], "bodies": bodies, "loops": loops}, follow


@pytest.mark.parametrize("kind", ["gear", "mimic", "distance", "fixed"])
@pytest.mark.parametrize("engine", ENGINES)
def test_tied_pendulums_accelerate(oracles: Oracles, engine: str, kind: str) -> None:
    """Lagrange's equation of the first angle. What an engine lacks it says, by the loop's name.

    MuJoCo's equalities are about J a alone, without the derivative of J: of a cam it misses the bend.
    """
    oracle, (model, follow) = oracles[engine], _tied(kind)
    offered = oracle.must({"op": "hello"})[0]["loops"]
    answer = oracle.ask({"op": "loops", "model": model})[0]
    lacks = kind not in offered["types"] or (engine, kind) == ("drake", "mimic")
    assert answer["status"] == ("unsupported" if lacks else "ok"), answer
    if lacks:
        assert "tie" in answer["reason"]
        return
    assert answer["held"] == {"tie": offered["types"][kind]}
    angle, rate = 0.6, 1.1
    value, slope, bend = follow(angle)
    bend = 0.0 if engine == "mujoco" else bend
    inertia, moment = [m / 3 for m in LINK], [m * 9.81 / 2 for m in LINK]
    pull = inertia[1] * slope * bend * rate**2 + moment[0] * np.sin(angle) + slope * moment[1] * np.sin(value)
    first = -pull / (inertia[0] + slope**2 * inertia[1])
    due = np.array([first, slope * first + bend * rate**2])
    blocks = {"q": np.array([[angle, value]]), "v": np.array([[rate, slope * rate]]), "tau": np.zeros((1, 2))}
    for method in offered["accelerations"]:
        found = oracle.must({"op": "loop_accelerations", "method": method, "count": 1}, blocks)[1]["acceleration"][0]
        assert np.abs(found - due).max() < EXACT[method] * (np.abs(due).max() + rate**2), (method, found, due)


PULL, REST = 7.0, 0.4


def _sprung() -> Header:
    """Describe two pendulums on one hinge that are welded, a spring from the first one's end to a point of the world, and a torque."""
    spring = {"first": {"body": 0, "point": [0.0, 0.0, -1.0]}, "second": {"body": -1, "point": [0.9, 0.0, -0.2]}}
    return {"tau": [0.0, 1.5], "springs": [{**spring, "stiffness": PULL, "length": REST}]}


def _sprung_acceleration(angle: float) -> float:
    """Compute the closed form: the end is at (-sin, -cos), and turns by (-cos, sin) per rad."""
    inertia, moment = sum(LINK) / 3, sum(LINK) * 9.81 / 2
    way = np.array([0.9, -0.2]) - [-np.sin(angle), -np.cos(angle)]
    distance = float(np.linalg.norm(way))
    pull = PULL * (distance - REST) * float(way @ [-np.cos(angle), np.sin(angle)]) / distance
    return (1.5 + pull - moment * float(np.sin(angle))) / inertia


@pytest.mark.parametrize("engine", ENGINES)
def test_springs_and_torques_drive(oracles: Oracles, engine: str) -> None:
    """Accelerations are those of the closed form, and a motion ends where its steps by the closed form do."""
    oracle = oracles[engine]
    offered = oracle.must({"op": "hello"})[0]["loops"]
    model, _ = _tied("fixed")
    assert oracle.must({"op": "loops", "model": model, "drive": _sprung()})[0]["driven"]
    angle = 0.4
    blocks = {"q": np.full((1, 2), angle), "v": np.zeros((1, 2)), "tau": np.zeros((1, 2))}
    due = _sprung_acceleration(angle)
    for method in offered["accelerations"]:
        found = oracle.must({"op": "loop_accelerations", "method": method, "count": 1}, blocks)[1]["acceleration"][0]
        assert np.abs(found - due).max() < EXACT[method] * abs(due), method
    turn, rate = angle, 0.0
    for _ in range(20_000):  # semi-implicit steps of 10 us
        rate += 1e-5 * _sprung_acceleration(turn)
        turn += 1e-5 * rate
    for method in offered["motions"]:
        start = {"q": np.full(2, angle), "v": np.zeros(2)}
        end = oracle.must({"op": "loop_motion", "method": method, "dt": 1e-3, "steps": 200, "every": 200}, start)[1]["q"][0]
        assert np.abs(end - turn).max() < 2e-3, method  # order one at 1 ms, or a soft weld
    assert "driven" not in oracle.must({"op": "loops", "model": model})[0]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"stiffness": 0.0}, "stiffness"),
        ({"second": {"body": 0, "point": [0.0] * 3}}, "both ends"),
        ({"first": {"body": 5, "point": [0.0] * 3}}, "point"),
    ],
)
def test_wrong_springs_are_refused(change: Header, says: str) -> None:
    """A spring that cannot be is named, and so are forces that do not fit."""
    drive = _sprung()
    drive["springs"][0] |= change
    with pytest.raises(ValueError, match=says):
        Loops("anybody", ANYBODY).prepare({"model": _four_bar(), "drive": {**drive, "tau": [0.0] * 3}}, {})
    with pytest.raises(ValueError, match="tau"):
        Loops("anybody", ANYBODY).prepare({"model": _four_bar(), "drive": drive}, {})


def test_rotation_vectors_come_back() -> None:
    """The exponential is the inverse of the logarithm, at zero too."""
    assert np.array_equal(exponential(np.zeros(3)), [0.0, 0.0, 0.0, 1.0])
    draw = np.random.default_rng(1)
    for _ in range(20):
        turn = draw.uniform(-1.5, 1.5, size=3)  # shorter than half a turn
        assert np.abs(log(exponential(turn)) - turn).max() < 1e-14


def _any(*_: object) -> Any:
    """Hold anything."""
    return object()


ANYBODY = LoopMethods(_any, ("any",), ("any",))


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"type": "gear"}, Unsupported, "revolute"),
        ({"type": "point", "axes": [True, True, False]}, Unsupported, "all axes"),
        ({"first": _end(9, [0.0] * 3, IDENTITY)}, ValueError, "no body 9"),
        ({"first": _end(1, [0.0] * 3, IDENTITY)}, ValueError, "both ends"),
        ({"second": _end(1, [0.0] * 3, [1.0] * 9)}, ValueError, "rotation"),
    ],
)
def test_wrong_loops_are_refused(change: Header, error: type[Exception], says: str) -> None:
    """A loop that cannot be held is named."""
    model = _four_bar()
    model["loops"][0] |= change
    with pytest.raises(error, match=says):
        Loops("anybody", ANYBODY).prepare({"model": model}, {})


@pytest.mark.parametrize(
    ("kind", "change", "error", "says"),
    [
        ("gear", {"terms": [{"body": b, "coefficient": 1.0} for b in (0, 1, 0)]}, Unsupported, "two coordinates"),
        ("gear", {"offset": np.nan}, ValueError, "finite"),
        ("mimic", {"polynomial": [1.0]}, ValueError, "five"),
        ("mimic", {"leader": 7}, ValueError, "no body 7"),
        ("distance", {"length": 0.0}, ValueError, "length"),
        ("distance", {"second": _end(0, [0.0] * 3, IDENTITY)}, ValueError, "both ends"),
    ],
)
def test_wrong_ties_are_refused(kind: str, change: Header, error: type[Exception], says: str) -> None:
    """A tie that cannot be held is named."""
    holder = replace(ANYBODY, types={kind: "anything"})
    model, _ = _tied(kind)
    model["loops"][0] |= change
    with pytest.raises(error, match=says):
        Loops("anybody", holder).prepare({"model": model}, {})


def test_wrong_questions_are_refused() -> None:
    """Methods that are not offered are unsupported; blocks and steps without sense are errors."""
    with pytest.raises(Unsupported, match="nobody"):
        Loops("nobody", None).prepare({"model": _four_bar()}, {})
    loops = Loops("anybody", ANYBODY)
    good: Blocks = {"q": np.zeros((1, 3)), "v": np.zeros((1, 3)), "tau": np.zeros((1, 3))}
    with pytest.raises(ValueError, match="no robot with loops"):
        loops.accelerations({"method": "any", "count": 1}, good)
    loops.prepare({"model": _four_bar()}, {})
    with pytest.raises(Unsupported, match="other"):
        loops.accelerations({"method": "other", "count": 1}, good)
    with pytest.raises(ValueError, match="block q"):
        loops.accelerations({"method": "any", "count": 2}, good)
    with pytest.raises(ValueError, match="not finite"):
        loops.accelerations({"method": "any", "count": 1}, {**good, "v": np.full((1, 3), np.nan)})
    start: Blocks = {"q": np.zeros(3), "v": np.zeros(3)}
    wrong: list[tuple[Header, str]] = [
        ({"dt": 0.0}, "dt"),
        ({"dt": np.inf}, "dt"),
        ({"steps": 10, "every": 3}, "multiple"),
        ({"steps": 0}, "multiple"),
    ]
    for steps, says in wrong:
        question = {"method": "any", "dt": 1e-3, "steps": 10, "every": 1, **steps}
        with pytest.raises(ValueError, match=says):
            loops.motion(question, start)
