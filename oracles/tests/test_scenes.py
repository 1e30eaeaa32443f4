"""Scenes: motions by hand, laws of contact models, and errors."""

from __future__ import annotations

import os
import re
from typing import Any

import numpy as np
import pytest

from featherbench_oracles.abilities.scenes import Derivative, DerivativeVariant, Motion, Scene, Scenes, Stepping, Variant, read
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Unsupported

from .conftest import Oracles

ENGINES = ("mujoco", "drake", "dart")
GRAVITY = 9.81


def _ball(**change: Any) -> dict[str, Any]:
    ball = {
        "name": "ball",
        "mass": 2.0,
        "inertia": [0.008] * 3,
        "position": [0.0, 0.0, 0.1],
        "orientation": [0.0, 0.0, 0.0, 1.0],
        "linear": [0.0] * 3,
        "angular": [0.0] * 3,
        "force": [0.0] * 3,
        "shapes": [{"kind": "sphere", "radius": 0.1, "at": [0.0] * 3}],
    }
    return {**ball, **change}


def _scene(*bodies: dict[str, Any], **change: Any) -> dict[str, Any]:
    return {"gravity": [0, 0, -GRAVITY], "friction": 0.5, "restitution": 0.0, "bodies": list(bodies), **change}


def _asked(scene: Any, variant: str, **change: Any) -> Header:
    return {"op": "scene", "scene": scene, "variant": variant, "dt": 1e-3, "steps": 400, "every": 200, **change}


@pytest.mark.parametrize("engine", ENGINES)
def test_balls_roll_spin_and_push(oracles: Oracles, engine: str) -> None:
    """One ball rolls, one flies and turns, one is pushed: by all variants of an engine."""
    oracle = oracles[engine]
    half = np.sqrt(0.5)
    rolls = _ball(linear=[0.5, 0, 0], angular=[0, 5.0, 0])
    flies = _ball(position=[0, 3.0, 5.0], orientation=[half, 0, 0, half], linear=[0, 0.3, 0], angular=[0, 0, 2.0])
    pushed = _ball(position=[0, -3.0, 5.0], force=[4.0, 0, 0])
    variants = oracle.ask({"op": "hello"})[0]["scenes"]
    assert len(variants) >= 3
    for variant, settings in variants.items():
        assert settings["contact"], variant
        answer, found = oracle.ask(_asked(_scene(rolls, flies, pushed), variant))
        assert answer["status"] == "ok", answer
        motion, contacts = found["motion"], found["contacts"]
        assert motion.shape == (2, 3, 13)
        # Order one over 0.4 s: half of g T dt is 2e-3.
        time, fall = 0.4, GRAVITY * 0.4**2 / 2
        turned = [half * np.cos(time), half * np.sin(time), half * np.sin(time), half * np.cos(time)]
        assert np.allclose(motion[1, 0, :3], [0.5 * time, 0, 0.1], atol=3e-3), variant
        assert np.allclose(motion[1, 1, :3], [0, 3 + 0.3 * time, 5 - fall], atol=3e-3), variant
        quaternion = motion[1, 1, 3:7]
        assert np.allclose(quaternion * np.sign(quaternion[3]), turned, atol=3e-3), variant
        assert np.allclose(motion[1, 1, 7:], [0, 0.3, -GRAVITY * time, 0, 0, 2], atol=1e-2), variant
        assert np.allclose(motion[1, 2, 7], 2 * time, atol=3e-3), variant
        assert contacts.shape == (1, 8), variant
        assert contacts[0, 0] == 0, variant
        assert contacts[0, 1] == -1, variant
        assert abs(contacts[0, 7] / (2 * GRAVITY) - 1) < 1e-2, variant


def test_dart_restitution_is_that_of_the_scene(oracles: Oracles) -> None:
    """A ball that falls 0.2 m rises with e of its speed."""
    scene = _scene(_ball(position=[0, 0, 0.3]), restitution=0.5)
    speed = np.sqrt(2 * GRAVITY * 0.2)
    steps = int((speed / GRAVITY + 0.05) / 1e-4)
    _, found = oracles["dart"].ask(_asked(scene, "dantzig", dt=1e-4, steps=steps, every=steps))
    last = found["motion"][0, 0]
    energy = GRAVITY * (last[2] - 0.1) + last[9] ** 2 / 2
    assert abs(np.sqrt(2 * energy) / speed - 0.5) < 2e-3
    assert oracles["mujoco"].ask(_asked(scene, "elliptic_newton"))[0]["status"] == "unsupported"


@pytest.mark.parametrize("engine", ["mujoco", "drake"])
def test_a_free_fall_is_differentiated(oracles: Oracles, engine: str) -> None:
    """Without a contact the derivative is that of uniform acceleration: (1, T; 0, 1)."""
    oracle = oracles[engine]
    for variant in oracle.ask({"op": "hello"})[0]["scene_derivatives"]:
        asked = {**_asked(_scene(_ball(position=[0, 0, 9])), variant), "op": "scene_derivative", "stiffness": 1e4}
        answer, found = oracle.ask(asked)
        assert answer["status"] == "ok", answer
        assert np.allclose(found["derivative"], np.array([[1, 0.4], [0, 1]]), atol=1e-6), variant
        assert np.allclose(found["state"], np.array([9 - GRAVITY * 0.08, -0.4 * GRAVITY]), atol=3e-3), variant


def _simulate(scene: Scene, stepping: Stepping) -> Motion:
    return Motion([[np.zeros(13)] * len(scene.bodies)] * (stepping.steps // stepping.every), [])


def _differentiate(*_: object) -> Derivative:
    return Derivative(np.zeros(2), np.eye(2))


SCENES = Scenes("any", {"one": Variant(_simulate, {})}, {"one": DerivativeVariant(_differentiate, {})})


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"dt": 0.0}, "dt"),
        ({"dt": float("nan")}, "dt"),
        ({"steps": 0}, "whole numbers"),
        ({"every": 401}, "whole numbers"),
        ({"scene": _scene()}, "bodies"),
        ({"scene": _scene(_ball(mass=-1.0))}, "mass"),
        ({"scene": _scene(_ball(orientation=[0, 0, 0, 2]))}, "quaternion"),
        ({"scene": _scene(_ball(linear=[0, 0, float("nan")]))}, "linear"),
        ({"scene": _scene(_ball(shapes=[{"kind": "cone", "at": [0, 0, 0]}]))}, "cone"),
        ({"scene": _scene(_ball(), restitution=1.5)}, "restitution"),
        ({"scene": {"gravity": [0, 0, 0]}}, "malformed"),
    ],
)
def test_wrong_requests_are_refused(change: dict[str, Any], says: str) -> None:
    """A wrong number is named."""
    with pytest.raises(ValueError, match=says):
        SCENES.simulate({**_asked(_scene(_ball()), "one"), **change}, {})


def test_what_is_not_offered_is_unsupported() -> None:
    """Another variant, and the derivative of several bodies."""
    with pytest.raises(Unsupported, match="other"):
        SCENES.simulate(_asked(_scene(_ball()), "other"), {})
    asked = {**_asked(_scene(_ball(), _ball()), "one"), "stiffness": 1e4}
    with pytest.raises(Unsupported, match="one body"):
        SCENES.differentiate(asked, {})
    with pytest.raises(ValueError, match="stiffness"):
        SCENES.differentiate({**asked, "stiffness": 0.0}, {})
    answer, found = SCENES.simulate(_asked(_scene(_ball()), "one"), {})
    assert answer == {}
    assert found["motion"].shape == (2, 1, 13)
    assert found["contacts"].shape == (0, 8)
    assert read(_scene(_ball())).bodies[0].shapes[0].radius == 0.1


@pytest.mark.parametrize("message", ["Error [a.cpp:1] no solution", "WARNING: the solver failed", "\x1b[1;31mError:\x1b[0m NaN"])
def test_what_an_engine_says_is_its_answer(message: str) -> None:
    """Numbers of steps in which an engine prints a failure are refused, with its words; other messages are none."""

    def simulate(_scene: Scene, _stepping: Stepping) -> Motion:
        for _ in range(3):
            os.write(2, f"{message}\n".encode())
        return Motion([[np.zeros(13)]], [])

    def other(_scene: Scene, _stepping: Stepping) -> Motion:
        os.write(2, b"WARNING: no contact data will be reported\n")
        return Motion([[np.zeros(13)]], [])

    scenes = Scenes("x", {"loud": Variant(simulate, {}), "other": Variant(other, {})}, {})
    plain = re.sub("\x1b.*?m", "", message)
    with pytest.raises(ValueError, match=rf"^x says while it computes: {re.escape(plain)}$"):
        scenes.simulate(_asked(_scene(_ball()), "loud", steps=1, every=1), {})
    assert scenes.simulate(_asked(_scene(_ball()), "other", steps=1, every=1), {})[1]["motion"].shape == (1, 1, 13)


def _pile(rng: np.random.Generator) -> dict[str, Any]:
    """Two boxes on each other that slide, of masses over six decades."""

    def box(name: str, z: float) -> dict[str, Any]:
        mass = 10 ** rng.uniform(-3, 3)
        shapes = [{"kind": "box", "half": [0.1] * 3, "at": [0.0] * 3}]
        return _ball(name=name, mass=mass, inertia=[mass * 0.01] * 3, position=[0.0, 0.0, z], linear=[0.3, 0, 0], shapes=shapes)

    return _scene(box("lower", 0.1), box("upper", 0.3))


def test_a_solver_that_failed_gives_no_motion(oracles: Oracles) -> None:
    """DART's PGS sets impulses to zero where it fails, and bodies sink: no answer has such a motion, and the reason has its words."""
    rng, failures = np.random.default_rng(5), 0
    for _ in range(10):
        answer, found = oracles["dart"].ask(_asked(_pile(rng), "pgs", steps=100, every=100))
        if answer["status"] == "ok":
            assert found["motion"][-1, 0, 2] > 0.05, "it sinks, and DART has said nothing"
            continue
        failures += 1
        assert answer["status"] == "error", answer
        assert "Primary LCP solver failed" in answer["reason"]
    assert failures > 3


def test_mujoco_counts_its_warnings(oracles: Oracles) -> None:
    """MuJoCo starts again where an acceleration is too large: its counter is the reason."""
    rng = np.random.default_rng(6)
    for _ in range(5):
        thrown = _ball(position=[0, 0, 5.0], force=[0, 0, 10 ** rng.uniform(12, 15)])
        answer, _ = oracles["mujoco"].ask(_asked(_scene(thrown), "elliptic_newton", steps=100, every=100))
        assert answer["status"] == "error", answer
        assert re.search(r"BADQ(ACC|VEL|POS)", answer["reason"])
