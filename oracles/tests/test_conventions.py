"""The conventions of the engines, asked of the engines themselves: the rows of conventions.toml.

Nothing here goes through our oracles. `featherbench_oracles.ENGINE.conventions` gives the measured numbers, those of the convention and
those of its alternatives. A test fails if the convention does not hold, and also if an alternative holds as well.
"""

from __future__ import annotations

import functools
import json
import subprocess
import tomllib

import pytest

from featherbench_oracles.core.conventions import claim
from featherbench_oracles.testing.client import HOME
from featherbench_oracles.testing.conventions import Refutations, refutations
from featherbench_oracles.testing.described import ALONE, ENGINES, alone

from .conftest import require

ROWS: list[dict[str, str]] = tomllib.loads((HOME / "conventions.toml").read_text(encoding="utf-8"))["convention"]
of_each_row = pytest.mark.parametrize("row", ROWS, ids=[row["test"] for row in ROWS])


@functools.cache
def asked(engine: str) -> Refutations:
    """Ask an engine about its conventions, in an environment that has it."""
    require(engine)
    if engine in ENGINES:
        return refutations(engine)
    command = [str(alone(engine)), "-m", "featherbench_oracles.testing.conventions", engine]
    told = subprocess.run(command, cwd=HOME, check=True, capture_output=True, text=True).stdout
    found: Refutations = json.loads(told)
    return found


@of_each_row
def test_convention_holds(row: dict[str, str]) -> None:
    """The engine answers by the convention, and by none of its alternatives."""
    claims = asked(row["engine"])[row["test"]]
    assert claims, "it asks nothing"
    assert [refuted for refuted, _ in claims] == [None] * len(claims)


@of_each_row
def test_alternative_is_refuted(row: dict[str, str]) -> None:
    """A claim of an alternative in place of the convention is refuted, for each claim by itself."""
    claims = asked(row["engine"])[row["test"]]
    assert claims, "it asks nothing"
    assert all(swapped is not None for _, swapped in claims)


@pytest.mark.parametrize("engine", [*ENGINES, *(engine for engine in ALONE if any(row["engine"] == engine for row in ROWS))])
def test_every_convention_has_a_row(engine: str) -> None:
    """The functions of an engine's module are the rows of the ledger, each once."""
    assert sorted(asked(engine)) == sorted(row["test"] for row in ROWS if row["engine"] == engine)


def test_claim_needs_an_alternative() -> None:
    """A convention without an alternative says nothing, and one whose alternative fits as well is refuted."""
    with pytest.raises(ValueError, match="says nothing"):
        claim(1.0, 1.0)
    assert "fits as well" in str(claim([1.0, 2.0], [1.0, 2.0], [3.0, 2.0], [1.0, 2.001]).refutation())
    assert "shape" in str(claim([1.0], 1.0, 2.0).refutation())
    assert claim(1.0, 1.0, float("nan")).refutation() is not None
