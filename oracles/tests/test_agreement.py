"""Every engine on every robot: it holds what it was given, agrees with the others, and keeps identities of mechanics.

`featherbench_oracles.testing.measures` says by what each residual is measured.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks
from featherbench_oracles.core.protocol import DERIVATIVES, SHAPES
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.draws import derivative
from featherbench_oracles.testing.measures import DIFFERENCE, EXACT, INVERSE, ratio, residual, within

from .conftest import Oracles
from .trials import TRIALS, Answered

PAIRS = [(number, engine) for number, trial in enumerate(TRIALS) for engine in trial.engines]
OTHERS = ("body_jacobian", "stored_entries", "mass_matrix_sparse", *DERIVATIVES)
QUANTITIES = [quantity for quantity in SHAPES if quantity not in OTHERS]
# Quantities whose derivatives by time are compared with other quantities. The rates of a fast state are too large for finite differences.
KEPT = slice(None, -1)


@pytest.fixture(scope="module")
def kept() -> dict[tuple[int, str], Answered]:
    """Keep the answers about the last robot, for the engines that are compared with the first one."""
    return {}


@pytest.fixture(scope="module", params=PAIRS, ids=[f"{number}-{TRIALS[number].model['name']}-{engine}" for number, engine in PAIRS])
def pair(request: pytest.FixtureRequest) -> tuple[int, str]:
    """Choose a robot and an engine."""
    number, engine = request.param
    return number, engine


def _answers(oracles: Oracles, kept: dict[tuple[int, str], Answered], number: int, engine: str) -> Answered:
    """Ask the engine about the robot, once."""
    if (number, engine) not in kept:
        for other in [key for key in kept if key[0] != number]:
            del kept[other]
        kept[number, engine] = Answered(oracles[engine], engine, TRIALS[number])
    return kept[number, engine]


@pytest.fixture(scope="module")
def answered(oracles: Oracles, kept: dict[tuple[int, str], Answered], pair: tuple[int, str]) -> Answered:
    """Give the engine's answers about the robot."""
    return _answers(oracles, kept, *pair)


@pytest.fixture(scope="module")
def agreed(oracles: Oracles, kept: dict[tuple[int, str], Answered], pair: tuple[int, str]) -> Blocks:
    """Give the answers of the engine that the others are compared with."""
    return _answers(oracles, kept, pair[0], TRIALS[pair[0]].engines[0]).first


@pytest.fixture(scope="module")
def slow(answered: Answered) -> tuple[Blocks, Blocks]:
    """Give states and answers without the fast state, whose rates are too large for finite differences."""
    states = {key: value if key == "probe" else value[KEPT] for key, value in answered.states.items()}
    return states, {key: value[KEPT] for key, value in answered.first.items()}


def _asked(answered: Answered, quantity: str) -> Callable[[Blocks], Array]:
    """Make a function of states."""
    return lambda moved: answered.at(moved, quantity, answered.methods[quantity][0])


# ---- what the engine holds


def test_readback_of_mass_and_com(answered: Answered) -> None:
    """Mass and centre of mass are read back; MuJoCo's and DART's frames may cost an ulp."""
    for body, row in zip(answered.robot.bodies, answered.readback, strict=True):
        assert ratio(row[:4] - np.append(body.mass, body.com)) <= within(1e-15)


def test_readback_of_inertia(answered: Answered) -> None:
    """The inertia is read back; principal axes and other reference points cost some ulps of the inertia about the origin."""
    for body, row in zip(answered.robot.bodies, answered.readback, strict=True):
        size = np.trace(body.inertia) + body.mass * body.com @ body.com
        assert ratio(row[4:10] - body.inertia[np.triu_indices(3)], size) <= within(4e-15)


def test_readback_of_placement(answered: Answered) -> None:
    """The joint's placement is read back; a quaternion costs some ulps."""
    for body, row in zip(answered.robot.bodies, answered.readback, strict=True):
        place = np.append(body.joint.rotation.ravel(), body.joint.translation)
        assert ratio(row[10:] - place) <= within(4e-15)


def _stored_entries(robot: Description) -> int:
    """Count n + Σ (d_k - 1) = Σ d_k: each dof has an entry with itself and with each of its ancestors."""
    depths: list[int] = []
    total = 0
    for body in robot.bodies:
        above = 0 if body.parent < 0 else depths[body.parent]
        dofs = body.joint.v.stop - body.joint.v.start
        total += sum(range(above + 1, above + dofs + 1))
        depths.append(above + dofs)
    return total


def test_stored_entries(answered: Answered) -> None:
    """The number of stored entries of M is that of the tree."""
    for method in answered.methods.get("stored_entries", []):
        assert (answered.values["stored_entries", method] == _stored_entries(answered.robot)).all()


def test_sparse_mass_matrix(answered: Answered) -> None:
    """The number of entries of M in the tree-sparse layout is that of the tree, and they are those of M to the bit."""
    rows, columns = answered.robot.tree_sparse()
    assert len(rows) == _stored_entries(answered.robot)
    for method in answered.methods.get("mass_matrix_sparse", []):
        assert (answered.values["mass_matrix_sparse", method] == answered.first["mass_matrix"][:, rows, columns]).all()


# ---- agreement


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_engines_agree(answered: Answered, agreed: Blocks, quantity: str) -> None:
    """Every method gives the answer of the first method of the first engine. Sums in other orders lose a few digits."""
    for method in answered.methods[quantity]:
        gap = residual(quantity, answered.values[quantity, method], agreed[quantity], answered.reference)
        assert gap <= EXACT, method


def test_newton_and_euler(answered: Answered) -> None:
    """Inverse dynamics is the result of Newton's and Euler's equations with the engine's own kinematics."""
    assert residual("id", answered.first["id"], answered.reference.id, answered.reference) <= EXACT


def test_pinocchio_kinetic_energy(answered: Answered) -> None:
    """Pinocchio 4.1.0's kinetic energy lacks the armature of unaligned revolute and helical joints, and nothing else."""
    if answered.engine != "pinocchio":
        return
    native, right = answered.values["kinetic_energy", "kinetic_energy"], answered.first["kinetic_energy"]
    missing = np.zeros_like(right)
    for joint in (body.joint for body in answered.robot.bodies):
        if joint.type in ("revolute", "helical") and np.count_nonzero(joint.axis) > 1:
            missing += joint.armature * answered.states["v"][:, joint.v] ** 2 / 2
    assert ratio(native + missing - right, right) <= EXACT


# ---- identities at one state


def test_mass_matrix_is_symmetric(answered: Answered) -> None:
    """M is symmetric up to an ulp of its diagonal."""
    for m in answered.first["mass_matrix"]:
        d = np.sqrt(np.diag(m))
        assert ratio((m - m.T) / np.outer(d, d)) <= within(1e-15)


def test_inverse_dynamics_is_mass_times_acceleration_and_bias(answered: Answered) -> None:
    """Inverse dynamics is M a + h."""
    x = answered.first
    for k, m in enumerate(x["mass_matrix"]):
        gap = x["id"][k] - m @ answered.states["a"][k] - x["bias"][k]
        assert ratio(gap / answered.reference.force[k]) <= EXACT


def test_kinetic_energy_is_that_of_the_mass_matrix(answered: Answered) -> None:
    """The kinetic energy is ½ v' M v."""
    x = answered.first
    for k, m in enumerate(x["mass_matrix"]):
        v = answered.states["v"][k]
        assert ratio(x["kinetic_energy"][k] - v @ m @ v / 2, x["kinetic_energy"][k]) <= EXACT


def test_jacobians_give_body_velocities(answered: Answered) -> None:
    """A Jacobian times v is the velocity of its body."""
    for k, due in enumerate(answered.first["body_velocity"]):
        assert ratio(answered.jacobians[:, k] @ answered.states["v"][k] - due, due) <= EXACT


def test_wrenches_act_by_jacobians(answered: Answered) -> None:
    """Wrenches f in body axes change inverse dynamics by -Σ J' f."""
    x = answered.first
    for k, wrench in enumerate(answered.states["wrench"]):
        r = x["body_placement"][k, :, :9].reshape(-1, 3, 3)
        world = np.hstack([np.einsum("bij,bj->bi", r, wrench[:, part]) for part in (slice(3), slice(3, 6))])
        pushed = np.einsum("bij,bi->j", answered.jacobians[:, k], world)
        assert ratio((x["id"][k] - x["id_wrench"][k] - pushed) / answered.reference.force[k]) <= EXACT


def test_probe_is_of_the_mass_matrix(answered: Answered) -> None:
    """The probe is the products with M, its diagonal and its last row."""
    x = answered.first
    for k, m in enumerate(x["mass_matrix"]):
        d = np.sqrt(np.diag(m))
        probe = np.array([*(m @ p for p in answered.states["probe"]), np.diag(m), m[-1]])
        assert ratio((probe - x["mass_matrix_probe"][k]) / d, probe / d) <= EXACT


# ---- identities that need other states


def test_bias_is_inverse_dynamics_without_acceleration(answered: Answered) -> None:
    """The bias force is inverse dynamics at a = 0, by each method."""
    still = {**answered.states, "a": np.zeros_like(answered.states["a"])}
    for method in answered.methods["id"]:
        gap = residual("bias", answered.first["bias"], answered.at(still, "id", method), answered.reference)
        assert gap <= EXACT, method


def test_inverse_undoes_forward_dynamics(answered: Answered) -> None:
    """Inverse dynamics of the accelerations of forward dynamics is tau; an explicit inverse of M loses its condition number."""
    for method in answered.methods["fd"]:
        driven = {**answered.states, "a": answered.at(answered.states, "fd", method)}
        for k, tau in enumerate(_asked(answered, "id")(driven)):
            due = answered.states["tau"][k]
            terms = np.abs(answered.first["mass_matrix"][k]) @ np.abs(driven["a"][k]) + np.abs(due) + answered.reference.force[k]
            assert ratio((tau - due) / terms) <= INVERSE, method


def test_placements_move_by_velocities(answered: Answered, slow: tuple[Blocks, Blocks]) -> None:
    """The derivative of a placement is ω × the columns of R, and the velocity of the origin."""
    states, x = slow
    spin, pace = x["body_velocity"][..., :3], x["body_velocity"][..., 3:]
    columns = x["body_placement"][..., :9].reshape(*spin.shape, 3).swapaxes(2, 3)
    turning = np.cross(spin[..., None, :], columns).swapaxes(2, 3)
    due = np.concatenate([turning.reshape(*spin.shape[:2], 9), pace], axis=2)
    assert ratio(derivative(answered.robot, states, _asked(answered, "body_placement")) - due, due) <= DIFFERENCE


def test_velocities_change_by_accelerations(answered: Answered, slow: tuple[Blocks, Blocks]) -> None:
    """The derivative of a body's velocity is its acceleration: the classical one."""
    states, x = slow
    speeding = derivative(answered.robot, states, _asked(answered, "body_velocity"))
    assert ratio(speeding - x["body_acceleration"], speeding) <= DIFFERENCE


def test_linear_momentum_is_that_of_the_centre_of_mass(answered: Answered, slow: tuple[Blocks, Blocks]) -> None:
    """The linear momentum is the mass times the derivative of the centre of mass."""
    states, x = slow
    drift = sum(body.mass for body in answered.robot.bodies) * derivative(answered.robot, states, _asked(answered, "com"))
    assert ratio(drift - x["momentum"][:, 3:], drift) <= DIFFERENCE


def test_energy_changes_by_power(answered: Answered, slow: tuple[Blocks, Blocks]) -> None:
    """The derivative of the energy under forward dynamics is tau·v. Energies are larger than their changes, which costs two digits."""
    states, x = slow
    driven = {**states, "a": x["fd"]}
    kinetic, potential = (derivative(answered.robot, driven, _asked(answered, f"{kind}_energy")) for kind in ("kinetic", "potential"))
    power = (states["tau"] * states["v"]).sum(axis=1, keepdims=True)
    assert ratio(kinetic + potential - power, power) <= 100 * DIFFERENCE
