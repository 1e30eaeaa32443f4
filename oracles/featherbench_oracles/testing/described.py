"""The engines of engines.toml that a module of this package serves."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import NamedTuple

from featherbench_oracles.testing.client import HOME


class Package(NamedTuple):
    """What has to be installed for an engine: the distribution's name and its exact version."""

    name: str
    version: str


TABLES = tomllib.loads((HOME / "engines.toml").read_text(encoding="utf-8"))


def _read(kind: str) -> dict[str, Package]:
    """Read the table of each engine that is started so, in the order of the file."""
    python = {name: table["package"] for name, table in TABLES.items() if table["start"]["kind"] == kind}
    return {name: Package(package["name"], package["version"]) for name, package in python.items()}


PACKAGES = _read("python")
ENGINES = tuple(PACKAGES)
ALONE = tuple(_read("python_alone"))  # each in an environment of its own
NIGHT = tuple(name for name, table in TABLES.items() if table.get("night"))  # tests ask them at night alone


def alone(engine: str) -> Path:
    """Find the interpreter of an engine's own environment, which `featherbench oracles install ENGINE` makes."""
    return HOME.parent / "target/oracles" / engine / "venv/bin/python"
