"""Shared by all tests: the oracles' processes, and the skip of an engine that is not installed."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import pytest

from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.described import ALONE, NIGHT, PACKAGES, alone

from .readers import Readers

WITNESS = {"truth": "mpmath"}  # the witness of truth, and the package that it needs
REQUIRE_ALL = "FEATHERBENCH_REQUIRE_ALL"
NIGHTLY = "FEATHERBENCH_NIGHTLY"


def installed(engine: str) -> bool:
    """Whether the engine is in this environment, or in the one that is its own."""
    if engine in ALONE:
        return alone(engine).exists()
    try:
        metadata.version(WITNESS.get(engine) or PACKAGES[engine].name)
    except metadata.PackageNotFoundError:
        return False
    return True


def require(engine: str) -> None:
    """Skip the test where the engine is not installed, or is left to the night; fail it where FEATHERBENCH_REQUIRE_ALL is set."""
    if engine in NIGHT and os.environ.get(NIGHTLY) is None:
        pytest.skip(f"{engine} is left to the night ({NIGHTLY} is not set)")
    if installed(engine):
        return
    named = f" {engine}" if engine in ALONE else ""
    reason = f"{engine} is not installed (`featherbench oracles install{named}`)"
    if os.environ.get(REQUIRE_ALL) is not None:
        pytest.fail(f"{reason}, and {REQUIRE_ALL} is set")
    pytest.skip(reason)


class Oracles:
    """The engines' oracles. Each is started when it is first needed, and again if it has ended."""

    def __init__(self) -> None:
        self.running: dict[str, Oracle] = {}

    def __getitem__(self, engine: str) -> Oracle:
        """Return the oracle of an engine, which has to be installed."""
        require(engine)
        oracle = self.running.get(engine)
        if oracle is None or oracle.process.poll() is not None:
            python = str(alone(engine)) if engine in ALONE else sys.executable
            oracle = self.running[engine] = Oracle.of(engine, python)
        return oracle

    def end(self) -> None:
        """End them all."""
        for oracle in self.running.values():
            if oracle.process.poll() is None:
                oracle.end()


@pytest.fixture(scope="session")
def oracles() -> Iterator[Oracles]:
    """Provide the oracles, and end them after the last test."""
    running = Oracles()
    yield running
    running.end()


@pytest.fixture
def readers(oracles: Oracles, tmp_path: Path) -> Readers:
    """Provide the oracles, and a folder for files."""
    return Readers(oracles, tmp_path)
