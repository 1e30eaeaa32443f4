"""What an engine may do beside quantities. Each ability is one protocol: an engine has it if it has all its members.

The session asks `isinstance(engine, ABILITY)`. What the members mean is told by the module of each ability; PROTOCOL.md has the messages.
An engine need not inherit from a protocol. Ours do, so that mypy compares their members with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from featherbench_oracles.abilities.contact_steps import StepMethod
from featherbench_oracles.abilities.contacts import SolverTable
from featherbench_oracles.abilities.loops import LoopMethods
from featherbench_oracles.abilities.rods import RodTable
from featherbench_oracles.abilities.scenes import DerivativeVariant, Variant
from featherbench_oracles.abilities.semidefinite import SemidefiniteTable
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, State

FORMATS = ("urdf", "mjcf", "sdf", "usd")


@runtime_checkable
class ReadsFiles(Protocol):
    """The operation `import`.

    Attributes
    ----------
    formats : tuple of str
        What the engine's parser reads, of `FORMATS`.
    """

    formats: tuple[str, ...]

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by the engine's own parser.

        Parameters
        ----------
        path : Path
            The file, which has passed the checks of `examination`.
        form : str
            One of `formats`.
        base : str
            `fixed` or `free`: whether the root of a URDF floats. Other files say themselves what floats.

        Returns
        -------
        Reading
            What the engine holds of the file.

        Raises
        ------
        Unsupported
            If descriptions cannot hold what the engine read.
        ValueError
            If the engine rejects the file.
        """


@runtime_checkable
class WritesFiles(Protocol):
    """The operation `rewrite`."""

    def rewrite(self, path: Path, form: str, into: Path) -> list[Header]:
        """Read a file and write it again by each of the engine's writers.

        Parameters
        ----------
        path : Path
            The file, which has passed the checks of `examination`.
        form : str
            One of `FORMATS`.
        into : Path
            A folder for what is written.

        Returns
        -------
        list of dict
            For each writer `by`, its name, and `file`, or the `reason` why there is none.

        Raises
        ------
        Unsupported
            If the engine does not read the format.
        """


@runtime_checkable
class HasVariants(Protocol):
    """The operation `variants`, of the engine whose import is the reference of a format."""

    def variants(self, path: Path, form: str) -> list[Header]:
        """List what a file would be to parsers that read something of it otherwise.

        Parameters
        ----------
        path : Path
            The file, which has passed the checks of `examination`.
        form : str
            `urdf` or `mjcf`.

        Returns
        -------
        list of dict
            Of each variant `cause`, `text`, `edits` and `model`; none of a format of which another engine is the reference.

        Raises
        ------
        ValueError
            If the engine rejects the file.
        """


@runtime_checkable
class HasResidual(Protocol):
    """The operation `residual`.

    Attributes
    ----------
    residual_acceleration : bool
        Whether the residual depends on a.
    """

    residual_acceleration: bool

    def residual(self, robot: Any, state: State, /) -> Array:
        """Answer r(q, v, a) of one state, of shape (nv,), N or N m."""


@runtime_checkable
class HasContactSolvers(Protocol):
    """The operation `solve_contacts`, by the laws of contact themselves: solvers by the method's name."""

    contact_solvers: SolverTable


@runtime_checkable
class HasContactRelaxations(Protocol):
    """The operation `solve_contacts`, by the convex relaxation: solvers by the method's name."""

    contact_relaxations: SolverTable


@runtime_checkable
class HasContactSteps(Protocol):
    """The operation `solve_contact_steps`, by the method's name."""

    contact_steps: Mapping[str, StepMethod]


@runtime_checkable
class HasLoops(Protocol):
    """The operations `loop_accelerations` and `loop_motion`."""

    loops: LoopMethods


@runtime_checkable
class HasRods(Protocol):
    """The operation `rod`: elements by the method's name."""

    rods: RodTable


@runtime_checkable
class HasScenes(Protocol):
    """The operation `scene`, by the variant's name."""

    scene_variants: Mapping[str, Variant]


@runtime_checkable
class HasSceneDerivatives(Protocol):
    """The operation `scene_derivative`, by the variant's name."""

    scene_derivatives: Mapping[str, DerivativeVariant]


@runtime_checkable
class HasSemidefiniteSolvers(Protocol):
    """The operation `semidefinite_least_squares`: solvers by the method's name."""

    semidefinite_solvers: SemidefiniteTable
