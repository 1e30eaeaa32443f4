"""Clarabel as an oracle. It knows no robots: it solves convex problems that the harness states."""

from __future__ import annotations

import clarabel
import numpy as np
import scipy

from featherbench_oracles.abilities import HasContactRelaxations, HasSemidefiniteSolvers
from featherbench_oracles.clarabel import contacts, semidefinite
from featherbench_oracles.core.protocol import Quantities, Robot, Unsupported
from featherbench_oracles.core.robot import Description


class Clarabel(HasContactRelaxations, HasSemidefiniteSolvers):
    """The engine Clarabel, for `session.serve`."""

    name = "clarabel"
    version = clarabel.__version__
    build = {"language": "Rust (Python package clarabel)", "packages": f"numpy {np.__version__}, scipy {scipy.__version__}"}
    quantities: Quantities = {}
    contact_relaxations = contacts.RELAXATIONS
    semidefinite_solvers = semidefinite.SOLVERS

    def prepare(self, description: Description) -> Robot:
        """Refuse the robot."""
        raise Unsupported(f"Clarabel solves convex problems, and has no robots such as {description.name}")
