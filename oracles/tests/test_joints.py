"""Each joint alone moves its body by its closed form. `test_agreement` tests the rates."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.algebra import rotation, skew
from featherbench_oracles.core.closed_forms import placement
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.robot import JOINT_SIZES, Description
from featherbench_oracles.testing.described import ENGINES
from featherbench_oracles.testing.draws import random_robot, random_states, without_armature
from featherbench_oracles.testing.measures import EXACT, ratio, within

from .conftest import Oracles

LACKING = {("mujoco", "helical")}


def _drawn() -> dict[str, tuple[Header, Blocks]]:
    """Draw a robot of each joint, and states."""
    rng, drawn = np.random.default_rng(7), {}
    for kind in JOINT_SIZES:
        model = without_armature(random_robot(rng, kind, [kind]))
        drawn[kind] = model, random_states(rng, Description.read(model))
    return drawn


DRAWN = _drawn()


@pytest.mark.parametrize("kind", JOINT_SIZES)
@pytest.mark.parametrize("engine", ENGINES)
def test_joint_is_offered(oracles: Oracles, engine: str, kind: str) -> None:
    """Every engine has every joint, except those that are known to be missing."""
    status = oracles[engine].ask({"op": "prepare", "model": DRAWN[kind][0]})[0]["status"]
    assert status == ("unsupported" if (engine, kind) in LACKING else "ok")


@pytest.mark.parametrize(("engine", "kind"), [(e, k) for e in ENGINES for k in JOINT_SIZES if (e, k) not in LACKING])
def test_joint_has_its_closed_form(oracles: Oracles, engine: str, kind: str) -> None:
    """The pose of the body is that of the joint's closed form."""
    oracle, (model, states) = oracles[engine], DRAWN[kind]
    joint = Description.read(model).bodies[0].joint
    oracle.must({"op": "prepare", "model": model})
    found = oracle.at(states, "body_placement", oracle.methods()["body_placement"][0])[:, 0]
    due = np.array([placement(joint, q) for q in states["q"]])
    assert ratio(found - due, due) <= EXACT


def test_dart_at_small_rotations(oracles: Oracles) -> None:
    """DART 6.20.0's exponential of K = [rotation vector]x leaves out the third order below 1e-3 rad, K^3 / 6, and nothing else."""
    dart, rng, angle = oracles["dart"], np.random.default_rng(8), 9e-4
    model = without_armature(random_robot(rng, "ball", ["spherical"], plain=True))
    robot = Description.read(model)
    states = random_states(rng, robot)
    axes = states["q"][:, :3] + [1e-3, 0, 0]  # one state has none
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    states["q"] = np.hstack([np.sin(angle / 2) * axes, np.full((len(axes), 1), np.cos(angle / 2))])
    dart.must({"op": "prepare", "model": model})
    found = dart.at(states, "body_placement", "world_transforms")[:, 0, :9].reshape(-1, 3, 3)
    for q, axis, turned in zip(states["q"], axes, found, strict=True):
        k = angle * skew(axis)
        due = robot.bodies[0].joint.rotation @ (rotation(q) - k @ k @ k / 6)
        assert ratio(turned - due) <= within(angle**4 / 12)  # the next order is θ⁴ / 24
