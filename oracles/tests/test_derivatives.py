"""The engines' derivatives in neutral coordinates, against differences of the same engine's own dynamics in neutral coordinates.

So the way back (`derivatives`) is tested, and with it that an engine's derivatives are along its own velocities. The differences move the
neutral configuration by `draws.advance`, which knows no engine.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.draws import advance, random_robot, random_states
from featherbench_oracles.testing.measures import within

from .conftest import Oracles, require

STEP = 1e-3
# The fourth order of h = 1e-3 leaves (h^4 / 30) f^(5), 1e-10 where derivatives grow a hundredfold with each order.
# Rounding leaves eps f / h, 1e-13.
DIFFERENCES = within(1e-9)
# MuJoCo's own step of 1e-6: forward differences of first order leave 1e-6 f'' / 2; centred ones are limited by eps f / 1e-6.
FINITE = within(1e-4)
STATES = 6
ENGINES = ("pinocchio", "mujoco", "drake")
KINDS = ("revolute", "prismatic", "spherical", "planar", "universal", "translation", "cylindrical", "euler_zyx", "helical")
DEVIATING = {"pinocchio": ("universal", "euler_zyx")}  # subspaces that depend on q: known deviations
MISSING = {"mujoco": ("helical",)}


def _robots() -> dict[str, Any]:
    """Draw a robot of each kind of joint on a free base, and two with all that engines have and get right."""
    rng = np.random.default_rng(31)
    robots = {kind: random_robot(rng, kind, ["free", kind, "revolute", kind]) for kind in KINDS}
    common = ["revolute", "prismatic", "spherical", "planar", "translation", "cylindrical"]
    robots["mixed free"] = random_robot(rng, "mixed", ["free", *common, "revolute", "spherical"])
    robots["mixed fixed"] = random_robot(rng, "mixed", [*common, "revolute", "planar", "free"])
    return robots


ROBOTS = _robots()
PAIRS = [
    (engine, name) for engine in ENGINES for name in ROBOTS if name not in DEVIATING.get(engine, ()) and name not in MISSING.get(engine, ())
]
of_each_pair = pytest.mark.parametrize(("engine", "name"), PAIRS, ids=[f"{engine}-{name}" for engine, name in PAIRS])


class Asked:
    """An engine's oracle with one robot, and the states at which it is asked."""

    def __init__(self, oracle: Oracle, name: str) -> None:
        self.oracle, self.robot = oracle, Description.read(ROBOTS[name])
        oracle.must({"op": "prepare", "model": ROBOTS[name]})
        states = random_states(np.random.default_rng(7), self.robot)
        # Not the first state, whose pitch of 90 degrees is singular in Drake's angles.
        self.states = {key: value if key == "probe" else value[1 : 1 + STATES] for key, value in states.items()}
        self.methods = oracle.methods()

    def at(self, states: Blocks, quantity: str, method: str | None = None) -> Array:
        """Ask for a quantity, by its usual method if none is named."""
        return self.oracle.at(states, quantity, method or self.methods[quantity][0])

    def by_q(self, quantity: str) -> Array:
        """Differentiate a quantity along the tangent of the configurations: the last index is the dof."""
        return self._columns(quantity, self._moved_q)

    def by(self, name: str, quantity: str) -> Array:
        """Differentiate a quantity by the numbers of a block."""
        return self._columns(quantity, lambda step: {**self.states, name: self.states[name] + step})

    def _moved_q(self, step: Array) -> Blocks:
        return {**self.states, "q": np.array([advance(self.robot, q, step) for q in self.states["q"]])}

    def _columns(self, quantity: str, moved: Callable[[Array], Blocks]) -> Array:
        def column(unit: Array) -> Array:
            near, far = ([self.at(moved(s * n * STEP * unit), quantity) for s in (1, -1)] for n in (1, 2))
            difference: Array = (8 * (near[0] - near[1]) - (far[0] - far[1])) / (12 * STEP)
            return difference

        return np.stack([column(unit) for unit in np.eye(self.robot.nv)], axis=-1)


@pytest.fixture
def asked(oracles: Oracles, engine: str, name: str) -> Asked:
    """Have the engine build the robot."""
    require(engine)
    return Asked(oracles[engine], name)


def residual(found: Array, due: Array) -> float:
    """Find the largest difference at a state over the largest number of that state."""
    return float(max(np.abs(f - d).max() / np.abs(d).max() for f, d in zip(found, due, strict=True)))


def check(asked: Asked, quantity: str, due: Array) -> None:
    """Compare each method of a quantity with the differences; those of MuJoCo are differences themselves, the first the usual one."""
    methods = asked.methods[quantity]
    exact = [method for method in methods if not method.startswith("difference")]
    found = [(method, residual(asked.at(asked.states, quantity, method), due)) for method in exact or methods[:1]]
    tolerance = DIFFERENCES if exact else FINITE
    assert found, "it asks nothing"
    assert [one for one in found if not one[1] <= tolerance] == []


@of_each_pair
def test_inverse_dynamics_by_q(asked: Asked) -> None:
    """The derivative of ID by q is that of differences."""
    check(asked, "id_dq", asked.by_q("id"))


@of_each_pair
def test_inverse_dynamics_by_v(asked: Asked) -> None:
    """The derivative of ID by v is that of differences."""
    check(asked, "id_dv", asked.by("v", "id"))


@of_each_pair
def test_forward_dynamics_by_q(asked: Asked) -> None:
    """The derivative of FD by q is that of differences."""
    check(asked, "fd_dq", asked.by_q("fd"))


@of_each_pair
def test_forward_dynamics_by_v(asked: Asked) -> None:
    """The derivative of FD by v is that of differences."""
    check(asked, "fd_dv", asked.by("v", "fd"))


PINOCCHIO = [pair for pair in PAIRS if pair[0] == "pinocchio"]
of_pinocchio = pytest.mark.parametrize(("engine", "name"), PINOCCHIO, ids=[name for _, name in PINOCCHIO])


@of_pinocchio
def test_coriolis_matrix(asked: Asked) -> None:
    """C v is the part of h by velocities, and C + C' is the rate of M, as matrices."""
    c = asked.at(asked.states, "coriolis_matrix")
    still = asked.at({**asked.states, "v": np.zeros_like(asked.states["v"])}, "bias")
    assert residual(np.einsum("kij,kj->ki", c, asked.states["v"]), asked.at(asked.states, "bias") - still) <= within(1e-12)
    rate = np.einsum("kijl,kl->kij", asked.by_q("mass_matrix"), asked.states["v"])
    assert residual(c + np.swapaxes(c, 1, 2), rate) <= DIFFERENCES


@of_pinocchio
def test_regressor(asked: Asked) -> None:
    """Y times the parameters is tau without armature: m, m c, I about the origin as xx, xy, xz, yy, yz, zz."""
    y = asked.at(asked.states, "torque_regressor")
    parameters = []
    for body in asked.robot.bodies:
        about_origin = body.inertia + body.mass * (body.com @ body.com * np.eye(3) - np.outer(body.com, body.com))
        parameters.append(np.concatenate([[body.mass], body.mass * body.com, about_origin[np.triu_indices(3)]]))
    armature = np.concatenate([body.joint.armature for body in asked.robot.bodies])
    due = asked.at(asked.states, "id") - armature * asked.states["a"]
    assert residual(np.einsum("kibp,bp->ki", y, np.array(parameters)), due) <= within(1e-12)


@pytest.mark.parametrize("engine", ENGINES)
def test_rates(engine: str) -> None:
    """The derivatives of T and b are those of differences: T by its products with unit vectors, b as it is."""
    require(engine)
    coordinates = import_module(f"featherbench_oracles.{engine}.coordinates")
    robot = Description.read(random_robot(np.random.default_rng(5), "rates", ["free", "planar", "spherical", "revolute"]))
    states = random_states(np.random.default_rng(6), robot)
    q, v = states["q"][1], states["v"][1]

    def whole(q: Array, v: Array) -> tuple[Array, Array]:
        change = coordinates.change_of_velocities(robot, q, v)
        return change.to_neutral_jacobian(np.eye(robot.nv)), change.b

    def slope(move: Callable[[float], tuple[Array, Array]]) -> list[Array]:
        return [(8 * (a - b) - (c - d)) / (12 * STEP) for a, b, c, d in zip(*(move(s * STEP) for s in (1, -1, 2, -2)), strict=True)]

    t_dq, b_dq, b_dv = np.zeros((robot.nv,) * 3), np.zeros((robot.nv,) * 2), np.zeros((robot.nv,) * 2)
    for rates in coordinates.rates_of_change(robot, q, v):
        t_dq[rates.dofs, rates.dofs, rates.dofs], b_dq[rates.dofs, rates.dofs] = rates.t_dq, rates.b_dq
        b_dv[rates.dofs, rates.dofs] = rates.b_dv
    assert np.abs(t_dq).max() > 0.1, "it asks nothing"
    for k, unit in enumerate(np.eye(robot.nv)):
        by_t, by_b = slope(lambda h, unit=unit: whole(advance(robot, q, h * unit), v))  # type: ignore[misc]
        # h^4 / 30 times fifth derivatives of about one
        assert np.abs(t_dq[k] - by_t).max() <= within(1e-11)
        assert np.abs(b_dq[:, k] - by_b).max() <= within(1e-10)
        _, by_v = slope(lambda h, unit=unit: whole(q, v + h * unit))  # type: ignore[misc]
        assert np.abs(b_dv[:, k] - by_v).max() <= within(1e-10)
