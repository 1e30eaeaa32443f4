"""The conventions of the engines, asked of the engines themselves: the rows of conventions.toml.

Nothing here goes through our oracles. `featherbench_oracles.ENGINE.conventions` gives the measured numbers, those of the convention and
those of its alternatives. A test fails if the convention does not hold, and also if an alternative holds as well.
"""

from __future__ import annotations

import tomllib
from importlib import import_module

import pytest

from featherbench_oracles.core.conventions import Claim, Convention, claim
from featherbench_oracles.testing.client import HOME
from featherbench_oracles.testing.described import ENGINES

from .conftest import require

ROWS: list[dict[str, str]] = tomllib.loads((HOME / "conventions.toml").read_text(encoding="utf-8"))["convention"]
of_each_row = pytest.mark.parametrize("row", ROWS, ids=[row["test"] for row in ROWS])


def claims(row: dict[str, str]) -> list[Claim]:
    """Ask the engine about a row's convention."""
    require(row["engine"])
    convention: Convention = getattr(import_module(f"featherbench_oracles.{row['engine']}.conventions"), row["test"])
    return list(convention())


@of_each_row
def test_convention_holds(row: dict[str, str]) -> None:
    """The engine answers by the convention, and by none of its alternatives."""
    asked = claims(row)
    assert asked, "it asks nothing"
    assert [one.refutation() for one in asked] == [None] * len(asked)


@of_each_row
def test_alternative_is_refuted(row: dict[str, str]) -> None:
    """A claim of an alternative in place of the convention is refuted, for each claim by itself."""
    asked = claims(row)
    assert asked, "it asks nothing"
    assert all(one.swapped().refutation() is not None for one in asked)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_convention_has_a_row(engine: str) -> None:
    """The functions of an engine's module are the rows of the ledger, each once."""
    require(engine)
    defined = vars(import_module(f"featherbench_oracles.{engine}.conventions"))
    functions = [name for name in defined if name.startswith(f"{engine}_") and defined[name].__annotations__["return"] == "Claims"]
    assert sorted(functions) == sorted(row["test"] for row in ROWS if row["engine"] == engine)


def test_claim_needs_an_alternative() -> None:
    """A convention without an alternative says nothing, and one whose alternative fits as well is refuted."""
    with pytest.raises(ValueError, match="says nothing"):
        claim(1.0, 1.0)
    assert "fits as well" in str(claim([1.0, 2.0], [1.0, 2.0], [3.0, 2.0], [1.0, 2.001]).refutation())
    assert "shape" in str(claim([1.0], 1.0, 2.0).refutation())
    assert claim(1.0, 1.0, float("nan")).refutation() is not None
