"""SoRoMoX as an oracle. It has soft robots alone: it answers about rods, and of rigid robots nothing."""

from __future__ import annotations

from importlib.metadata import version
from typing import NoReturn

import jax

from featherbench_oracles.abilities import HasRods
from featherbench_oracles.core.protocol import Quantities, Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.soromox.rods import RODS


class Soromox(HasRods):
    """The engine SoRoMoX, for `session.serve`. Its numbers are doubles, which JAX has only if it is asked."""

    name = "soromox"
    version = version("soromox")
    rods = RODS
    quantities: Quantities = {}

    def __init__(self) -> None:
        jax.config.update("jax_enable_x64", True)
        self.build = {"language": "Python, compiled by XLA", "packages": f"soromox {self.version}, jax {jax.__version__}, CPU"}

    def prepare(self, _description: Description) -> NoReturn:
        """Refuse a rigid robot."""
        raise Unsupported("SoRoMoX has soft robots alone")
