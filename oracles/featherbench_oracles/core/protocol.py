"""The protocol (PROTOCOL.md) without its messages: quantities with their shapes, states, and the interface of an engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.robot import Description

PROTOCOL = 1


class Unsupported(Exception):  # noqa: N818 (no error: it is the protocol's answer `unsupported`)
    """The engine has no such joint, quantity or method; the message says which."""


@dataclass(frozen=True)
class State:
    """One state in neutral coordinates, and a body, for a quantity of one body.

    Attributes
    ----------
    q : ndarray, shape (nq,)
        Positions, m, rad or quaternions.

    v, a : ndarray, shape (nv,)
        Velocities, m/s or rad/s; accelerations, m/s² or rad/s².

    tau : ndarray, shape (nv,)
        Forces of the joints, N or N m.

    wrench : ndarray, shape (bodies, 6)
        For each body [moment; force] in body axes at the body's origin, N m and N.

    probe : ndarray, shape (4, nv)
        The vectors that M is multiplied by.

    body : int
        The index of the body.
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    wrench: Array
    probe: Array
    body: int


@dataclass(frozen=True)
class Reading:
    """What an engine holds after its own parser has read a file.

    Attributes
    ----------
    model : dict
        The description in its JSON form.

    description : Description
        The same description.

    notes : list of dict
        What the parser did, and to which link or joint (`reading.note`).

    robot : Any
        The engine's robot, in the description's coordinates.

    keyframes : dict of str to ndarray, shape (nq,)
        The file's keyframes by name.

    written : dict, optional
        The description with the file's own inertias, if the engine rejects those and holds repaired ones.
    """

    model: Header
    description: Description
    notes: list[Header]
    robot: Any
    keyframes: dict[str, Array]
    written: Header | None = None


class Robot(Protocol):
    """One robot, built through the engine's interface."""

    def readback(self) -> list[Array]:
        """Read back what the engine holds.

        Returns
        -------
        list of ndarray, shape (22,)
            For each body a row of `readback_row`.
        """


Quantities = Mapping[str, Mapping[str, Callable[[Any, State], Any]]]


class Engine(Protocol):
    """The interface of an engine, which `session.serve` takes. What it may do beside this, `abilities` says.

    A function of `quantities` answers for one state, in neutral coordinates, with an array or a list of this shape:

    ::

        quantity             shape          unit            answer
        id, id_wrench, bias  (nv,)          N or N m        forces of the joints, tau or h
        mass_matrix          (nv, nv)       kg, kg m, kg m² both triangles of M
        mass_matrix_sparse   (nv, nv)       kg, kg m, kg m² the same M; the session takes the stored entries
        mass_matrix_probe    (6, nv)        kg, kg m, kg m² M x for the rows x of `probe`, the diagonal of M, its last row
        fd                   (nv,)          m/s² or rad/s²  accelerations a = M^-1 (tau - h)
        kinetic_energy       (1,)           J               v' M v / 2
        potential_energy     (1,)           J               -Σ m g·c, zero at the world's origin
        com                  (3,)           m               centre of mass in world axes
        momentum             (6,)           kg m²/s, kg m/s [angular about the centre of mass; linear] in world axes
        body_placement       (bodies, 12)   -, m            rotation from body to world axes, row by row, then the origin
        body_velocity        (bodies, 6)    rad/s, m/s      [angular; linear] in world axes, of the body's origin
        body_acceleration    (bodies, 6)    rad/s², m/s²    its time derivative (classical), without gravity
        body_jacobian        (6, nv)        -, m            J of one body, with J v = its `body_velocity`
        stored_entries       (1,)           -               how many numbers of M the engine stores
        id_dq, id_dv         (nv, nv)       see `id`        derivatives of tau by q, on the tangent space in the axes of v, and by v
        fd_dq, fd_dv         (nv, nv)       see `fd`        derivatives of a by q and by v, tau being fixed
        coriolis_matrix      (nv, nv)       N s/m, N m s    C with C v = h - g and dM/dt = C + C'
        torque_regressor     (nv, bodies, 10) see `id`      Y with tau - armature a = Y pi, pi: m, m c, and I about the body's origin

    For kinetic_energy, potential_energy and stored_entries a plain number will do.

    Attributes
    ----------
    name, version : str
        Of the engine.
    build : dict of str to str
        What else its answers may depend on.
    quantities : mapping
        Quantity -> method -> a function `(robot, question)`. The first method is the engine's usual one.
    """

    name: str
    version: str
    build: dict[str, str]
    quantities: Quantities

    def prepare(self, description: Description) -> Robot:
        """Build a robot through the engine's own interface, never through a file.

        Parameters
        ----------
        description : Description
            The robot.

        Returns
        -------
        Robot
            The same robot in the engine, at which the functions of `quantities` are asked.

        Raises
        ------
        Unsupported
            If the engine cannot hold the robot; the message says why.
        """


# quantity -> shape per state
SHAPES: dict[str, tuple[str | int, ...]] = {
    "id": ("nv",),
    "id_wrench": ("nv",),
    "bias": ("nv",),
    "mass_matrix": ("nv", "nv"),
    "mass_matrix_probe": (6, "nv"),
    "fd": ("nv",),
    "kinetic_energy": (1,),
    "potential_energy": (1,),
    "com": (3,),
    "momentum": (6,),
    "body_placement": ("bodies", 12),
    "body_velocity": ("bodies", 6),
    "body_acceleration": ("bodies", 6),
    "body_jacobian": (6, "nv"),
    "stored_entries": (1,),
    "mass_matrix_sparse": ("stored",),
    "id_dq": ("nv", "nv"),
    "id_dv": ("nv", "nv"),
    "fd_dq": ("nv", "nv"),
    "fd_dv": ("nv", "nv"),
    "coriolis_matrix": ("nv", "nv"),
    "torque_regressor": ("nv", "bodies", 10),
}


# The derivatives and what is made of them: an engine may have some of them, and they take long on big robots.
DERIVATIVES = ("id_dq", "id_dv", "fd_dq", "fd_dv", "coriolis_matrix", "torque_regressor")

# The quantities of a robot read from a file: those that need no single bodies, and no masses that are fixed to the world.
AS_READ = ("id", "bias", "mass_matrix", "mass_matrix_probe", "fd", "kinetic_energy")


def readback_row(mass: float, com: Array, inertia: Array, rotation: Array, translation: Array) -> Array:
    """Write one body as a row of the answer to `prepare`.

    Parameters
    ----------
    mass : float
        In kg.
    com : ndarray, shape (3,)
        The centre of mass in body axes, m.
    inertia : ndarray, shape (3, 3)
        About the centre of mass in body axes, kg m².
    rotation : ndarray, shape (3, 3)
        From the joint's axes to the parent's.
    translation : ndarray, shape (3,)
        The joint's origin in the parent's frame, m.

    Returns
    -------
    ndarray, shape (22,)
        All of these numbers, in this order.
    """
    return np.concatenate([[mass], com, inertia[np.triu_indices(3)], rotation.ravel(), translation])


def mass_matrix_probe(product: Callable[[Array], Array], diagonal: Array, probe: Array) -> Array:
    """Answer `mass_matrix_probe`.

    Parameters
    ----------
    product : callable
        Takes x of shape (nv,) to M x.
    diagonal : ndarray, shape (nv,)
        The diagonal of M, kg or kg m².
    probe : ndarray, shape (4, nv)
        The x that M is multiplied by.

    Returns
    -------
    ndarray, shape (6, nv)
        M x for the rows x of `probe`, the diagonal of M, its last row.
    """
    last = np.zeros_like(diagonal)
    last[-1] = 1
    return np.array([*map(product, probe), diagonal, product(last)])
