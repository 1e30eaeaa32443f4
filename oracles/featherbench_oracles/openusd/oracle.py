"""OpenUSD as a reader of files. It has no dynamics: it answers what a file says, and no quantity."""

from __future__ import annotations

from pathlib import Path

from pxr import Usd

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.protocol import Quantities, Reading, Robot, Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.openusd import reading


class OpenUsd(ReadsFiles):
    """The reader, for `session.serve`."""

    name = "openusd"
    version = ".".join(str(part) for part in Usd.GetVersion()[1:])
    build = {"language": "C++ (Python package usd-core)"}
    formats = ("usd",)
    quantities: Quantities = {}

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a USD by UsdPhysics."""
        return reading.read(path)

    def prepare(self, description: Description) -> Robot:
        """Refuse: OpenUSD computes nothing."""
        raise Unsupported("OpenUSD has no dynamics")
