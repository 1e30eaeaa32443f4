"""PyElastica as an oracle. It has soft rods alone: it answers about rods, and of rigid robots nothing."""

from __future__ import annotations

from importlib.metadata import version
from typing import NoReturn

from featherbench_oracles.abilities import HasRods
from featherbench_oracles.core.protocol import Quantities, Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.pyelastica.rods import RODS


class PyElastica(HasRods):
    """The engine PyElastica, for `session.serve`."""

    name = "pyelastica"
    version = version("pyelastica")
    rods = RODS
    quantities: Quantities = {}

    def __init__(self) -> None:
        self.build = {"language": "Python, compiled by Numba", "packages": f"pyelastica {self.version}, numba {version('numba')}"}

    def prepare(self, _description: Description) -> NoReturn:
        """Refuse a rigid robot."""
        raise Unsupported("PyElastica has soft rods alone")
