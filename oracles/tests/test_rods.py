"""Rods of engines against a cantilever's closed forms, and requests that are errors."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from featherbench_oracles.algebra import Array
from featherbench_oracles.protocol import Unsupported
from featherbench_oracles.rods import Rods

FIRST = 1.875104068711961**2
COUNT = 12


def rods(engine: str) -> Rods:
    """Find the rods of an engine, or skip where it is not installed."""
    pytest.importorskip({"mujoco": "mujoco", "drake": "pydrake", "soromox": "soromox"}[engine])
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
