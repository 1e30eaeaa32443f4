"""Chains of massless bodies with the same axes are one body with several joints in MuJoCo. It then lacks them as bodies."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.draws import COUNT, random_robot, random_states
from featherbench_oracles.testing.measures import EXACT, INVERSE, ratio, within

from .conftest import Oracles
from .test_session import status_of

NOTHING = {"mass": 0.0, "com": [0.0] * 3, "inertia": [0.0] * 6}
MASSLESS = (1, 2, 4, 7, 9)
RNG = np.random.default_rng(11)


def _folded() -> Header:
    """Draw a robot with five bodies that are only joints."""
    kinds = ["free", "revolute", "prismatic", "revolute", "universal", "prismatic", "revolute", "planar", "revolute"]
    model = random_robot(RNG, "folded", [*kinds, "prismatic", "spherical"])
    for i, body in enumerate(model["bodies"]):
        body["parent"] = i - 1
        if i in MASSLESS:
            body.update(NOTHING)
            model["bodies"][i + 1]["joint"]["placement"]["rotation"] = np.eye(3).ravel().tolist()
    model["bodies"][9]["parent"] = 3  # a branch
    return model


def _skew() -> Header:
    """Draw a robot whose massless body is not in the axes of its child."""
    model = random_robot(RNG, "skew", ["revolute", "revolute"])
    model["bodies"][0].update(NOTHING)
    model["bodies"][1]["parent"] = 0
    return model


MODEL = _folded()
ROBOT = Description.read(MODEL)
STATES = random_states(RNG, ROBOT)
SKEW = _skew()
PREPARE: Header = {"op": "prepare", "model": MODEL}


@pytest.fixture
def readback(oracles: Oracles) -> Array:
    """Have MuJoCo build the robot, and read it back."""
    return oracles["mujoco"].must(PREPARE)[1]["readback"]


def test_readback(readback: Array) -> None:
    """MuJoCo holds all bodies and all joints' placements. Massless bodies are read back without mass."""
    for body, row in zip(ROBOT.bodies, readback, strict=True):
        size = np.trace(body.inertia) + body.mass * body.com @ body.com
        assert ratio(row[:4] - np.append(body.mass, body.com)) <= within(1e-15)
        assert ratio(row[4:10] - body.inertia[np.triu_indices(3)], size) <= within(4e-15)
        assert ratio(row[10:] - np.append(body.joint.rotation.ravel(), body.joint.translation)) <= within(4e-15)
    assert not readback[list(MASSLESS), :10].any()


@pytest.mark.parametrize("quantity", ["mass_matrix", "id", "bias", "fd", "kinetic_energy", "potential_energy", "com", "momentum"])
def test_quantity_is_pinocchios(oracles: Oracles, quantity: str) -> None:
    """MuJoCo gives Pinocchio's answer by each method. Pinocchio's last method of kinetic energy is the right one."""
    mujoco, pinocchio = oracles["mujoco"], oracles["pinocchio"]
    for oracle in (mujoco, pinocchio):
        oracle.must(PREPARE)
    right = pinocchio.at(STATES, quantity, pinocchio.methods()[quantity][-1])
    size = np.abs(right).max(axis=tuple(range(1, right.ndim)), keepdims=True)
    size = np.maximum(size, np.abs(right[:20]).max())  # where a sum is small, its terms are not
    for method in mujoco.methods()[quantity]:
        gap = ratio((mujoco.at(STATES, quantity, method) - right) / size)
        assert gap <= (INVERSE if quantity == "fd" else EXACT), method


def _jacobian(oracle: Oracle) -> Array:
    """Ask for the Jacobian of a body after folded ones."""
    oracle.must(PREPARE)
    oracle.must({"op": "states", "count": COUNT}, STATES)
    return oracle.value("body_jacobian", oracle.methods()["body_jacobian"][0], COUNT, 8)


def test_jacobian_is_pinocchios(oracles: Oracles) -> None:
    """The Jacobian of a body that MuJoCo has is Pinocchio's; the robot is some metres long."""
    assert ratio(_jacobian(oracles["mujoco"]) - _jacobian(oracles["pinocchio"])) <= within(1e-12)


@pytest.mark.parametrize("quantity", ["id_wrench", "body_placement", "body_velocity", "body_acceleration", "body_jacobian"])
def test_folded_body_has_no_answer(oracles: Oracles, quantity: str) -> None:
    """A quantity of a body that MuJoCo does not have is unsupported."""
    mujoco = oracles["mujoco"]
    mujoco.must(PREPARE)
    mujoco.must({"op": "states", "count": COUNT}, STATES)
    asked = {"op": "evaluate", "first": 0, "count": 1, "body": 1, "quantity": quantity, "method": mujoco.methods()[quantity][0]}
    assert status_of(mujoco.ask(asked)) == "unsupported"


def test_skew_axes_are_not_folded(oracles: Oracles) -> None:
    """A massless body with other axes than its child's is unsupported."""
    assert status_of(oracles["mujoco"].ask({"op": "prepare", "model": SKEW})) == "unsupported"
