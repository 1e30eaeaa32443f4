"""Rods of engines against a cantilever's closed forms, and requests that are errors."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from featherbench_oracles.abilities.inextensible import nodes, on_angles, straight_mass
from featherbench_oracles.abilities.rods import Rods
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported

FIRST = 1.875104068711961**2
COUNT = 12


def rods(engine: str) -> Rods:
    """Find the rods of an engine, or skip where it is not installed."""
    pytest.importorskip({"mujoco": "mujoco", "drake": "pydrake", "soromox": "soromox", "pyelastica": "elastica"}[engine])
    return Rods(engine, import_module(f"featherbench_oracles.{engine}.rods").RODS)


def ask(rods: Rods, element: str, forces: Array, **changed: float) -> dict[str, Array]:
    """Ask about a rod of 2 m, 3 N m² and 0.5 kg/m."""
    header = {"method": element, "count": COUNT, "length": 2.0, "bending": 3.0, "mass_per_length": 0.5, **changed}
    answer, blocks = rods.solve(header, {"forces": forces})
    assert answer["nanoseconds"] > 0
    return blocks


@pytest.mark.parametrize("engine", ["mujoco", "drake"])
def test_hinge_chains_have_the_law_of_the_midpoint_rule(engine: str) -> None:
    """A small deflection is 1 - 1/4n² of the exact one, and the first frequency 1 + 0.2294/n²; the next terms are of order 1/n⁴."""
    blocks = ask(rods(engine), "hinge_chain", np.array([0.0, 7.5e-5]))
    small = 7.5e-5 * 8 / 9
    assert np.allclose(blocks["tips"][0], [2.0, 0.0], atol=1e-12)
    assert abs(blocks["tips"][1, 1] / small - (1 - 0.25 / COUNT**2)) < 1e-7
    exact = FIRST * np.sqrt(6.0) / 4
    assert abs(blocks["frequencies"][0] / exact - (1 + 0.2294 / COUNT**2)) < 1e-4


def test_a_flex_has_the_law_of_edges_with_masses_at_nodes() -> None:
    """A small deflection is 1 + 1/2n² of the exact one, and the first frequency 1 - 0.8462/n², which is s (6 + s)/12 with s = 1.3765."""
    blocks = ask(rods("mujoco"), "flex_rod", np.array([0.0, 7.5e-5]))
    small = 7.5e-5 * 8 / 9
    assert np.allclose(blocks["tips"][0], [2.0, 0.0], atol=1e-12)
    # The edge within the wall has 1e-6 of an element.
    assert abs(blocks["tips"][1, 1] / small - (1 + 0.5 / COUNT**2)) < 1e-6
    exact = FIRST * np.sqrt(6.0) / 4
    assert abs(blocks["frequencies"][0] / exact - (1 - 0.8462 / COUNT**2)) < 1e-4


def test_a_held_director_makes_a_rod_shorter_by_half_an_element() -> None:
    """A small deflection is 1 - 3/2n + 1/2n² of the exact one, and the first frequency near to 1 + 1/n."""
    blocks = ask(rods("pyelastica"), "held_director", np.array([0.0, 7.5e-5]))
    small = 7.5e-5 * 8 / 9
    assert np.allclose(blocks["tips"][0], [2.0, 0.0], atol=1e-12)
    assert abs(blocks["tips"][1, 1] / small - (1 - 1.5 / COUNT + 0.5 / COUNT**2)) < 1e-7
    exact = FIRST * np.sqrt(6.0) / 4
    # The next term is 0.6/n².
    assert abs(blocks["frequencies"][0] / exact - (1 + 1 / COUNT)) < 1 / COUNT**2


def test_segments_of_constant_strain_have_the_law_of_the_best_approximation() -> None:
    """A small deflection is 1 - 1/4n² of the exact one, and the first frequency 1 + 0.1937/n², which is s (2 + s)/24 with s = 1.3765."""
    found = rods("soromox")
    import_module("jax").config.update("jax_enable_x64", True)
    blocks = ask(found, "constant_strain", np.array([0.0, 7.5e-5]))
    small = 7.5e-5 * 8 / 9
    assert abs(blocks["tips"][1, 1] / small - (1 - 0.25 / COUNT**2)) < 1e-7
    exact = FIRST * np.sqrt(6.0) / 4
    # The next term is of order 1/n⁴, 3e-6 here.
    assert abs(blocks["frequencies"][0] / exact - (1 + 0.1937 / COUNT**2)) < 1e-5


def test_nodal_forces_act_on_angles_by_virtual_work() -> None:
    """A small turn of an edge does the work of the forces on the nodes beyond it; the straight mass is that of kinetic energy."""
    angles, forces, edge = np.array([0.3, -0.2, 0.9]), np.arange(8.0).reshape(4, 2) - 3.0, 0.4
    moments = on_angles(angles, edge, forces)
    for k, step in enumerate(1e-6 * np.eye(3)):
        moved = (nodes(angles + step, edge) - nodes(angles - step, edge)) / 2e-6
        assert abs((moved * forces).sum() - moments[k]) < 1e-9
    masses, rates = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0.5, -1.0, 2.0])
    speeds = edge * np.concatenate([[0.0], np.cumsum(rates)])
    assert abs(rates @ straight_mass(masses, edge) @ rates - (masses * speeds**2).sum()) < 1e-12


@pytest.mark.parametrize("engine", ["mujoco", "drake"])
def test_wrong_questions_are_refused(engine: str) -> None:
    """A rod has elements, a positive stiffness, finite forces, and an element that the engine has."""
    found = rods(engine)
    for wrong in ({"count": 0}, {"bending": -1.0}, {"length": float("nan")}):
        with pytest.raises(ValueError, match="must be"):
            ask(found, "hinge_chain", np.array([0.0]), **wrong)
    with pytest.raises(ValueError, match="forces"):
        ask(found, "hinge_chain", np.array([np.nan]))
    with pytest.raises(Unsupported):
        ask(found, "no such element", np.array([0.0]))
