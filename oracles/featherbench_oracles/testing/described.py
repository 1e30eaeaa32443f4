"""The engines of engines.toml that a module of this package serves."""

from __future__ import annotations

import tomllib
from typing import NamedTuple

from featherbench_oracles.testing.client import HOME


class Package(NamedTuple):
    """What has to be installed for an engine: the distribution's name and its exact version."""

    name: str
    version: str


def _read() -> dict[str, Package]:
    """Read the table of each engine in Python, in the order of the file."""
    tables = tomllib.loads((HOME / "engines.toml").read_text(encoding="utf-8"))
    python = {name: table["package"] for name, table in tables.items() if table["start"]["kind"] == "python"}
    return {name: Package(package["name"], package["version"]) for name, package in python.items()}


PACKAGES = _read()
ENGINES = tuple(PACKAGES)
