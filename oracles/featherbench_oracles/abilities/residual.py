"""A residual as an oracle: any function of q, v and a, behind the operation `residual`.

The robot is the one that the harness describes. It is read back from the description, and no engine builds it.
"""

from __future__ import annotations

from collections.abc import Callable

from featherbench_oracles.abilities import HasResidual
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Quantities, State, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.core.session import serve

Residual = Callable[[Array, Array, Array], Array]


class DescribedRobot:
    """A robot that is its description.

    Parameters
    ----------
    description : Description
        The robot.
    """

    def __init__(self, description: Description) -> None:
        self.description = description

    def readback(self) -> list[Array]:
        """Read back the description.

        Returns
        -------
        list of ndarray, shape (22,)
            For each body a row of `readback_row`.
        """
        rows = self.description.bodies
        return [readback_row(body.mass, body.com, body.inertia, body.joint.rotation, body.joint.translation) for body in rows]


class ResidualEngine(HasResidual):
    """An engine that has a residual and no quantities.

    Parameters
    ----------
    name, version : str
        What it is called in `hello`.
    function : callable
        `r(q, v, a)`, of shape (nv,): the joint forces that the true robot needs beyond the nominal model's, tau = ID + r.
    acceleration : bool
        Whether r depends on a.
    """

    def __init__(self, name: str, version: str, function: Residual, *, acceleration: bool) -> None:
        self.name, self.version = name, version
        self.build = {"language": "python"}
        self.quantities: Quantities = {}
        self.function, self.residual_acceleration = function, acceleration

    def prepare(self, description: Description) -> DescribedRobot:
        """Keep the robot.

        Parameters
        ----------
        description : Description
            The robot.

        Returns
        -------
        DescribedRobot
            It.
        """
        return DescribedRobot(description)

    def residual(self, _robot: DescribedRobot, state: State) -> Array:
        """Answer r of one state.

        Parameters
        ----------
        state : State
            Of which q, v and a are read.

        Returns
        -------
        ndarray, shape (nv,)
            In N or N m.
        """
        return self.function(state.q, state.v, state.a)


def serve_residual(name: str, function: Residual, *, version: str = "1", acceleration: bool = False) -> None:
    """Answer requests until standard input ends.

    Parameters
    ----------
    name, version : str
        What the oracle is called.
    function : callable
        `r(q, v, a)`, of shape (nv,).
    acceleration : bool
        Whether r depends on a.
    """
    serve(ResidualEngine(name, version, function, acceleration=acceleration))
