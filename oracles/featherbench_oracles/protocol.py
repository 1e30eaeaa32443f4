"""What the protocol (PROTOCOL.md) says, without frames or any engine: quantities with their shapes, questions, and what an engine is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from featherbench_oracles.algebra import Array
from featherbench_oracles.frames import Header
from featherbench_oracles.robot import Description

PROTOCOL = 1


class Unsupported(Exception):  # noqa: N818 (no error: it is the protocol's answer `unsupported`)
    """The engine has no such joint, quantity or method; the message says which."""


@dataclass(frozen=True)
class Question:
    """One state in neutral coordinates, and the body that is asked about where the quantity is one body's.

    Attributes
    ----------
    q : ndarray, shape (nq,)
        Coordinates, m, rad or quaternions.
    v, a : ndarray, shape (nv,)
        Velocities and accelerations, m/s or rad/s, and the same per second.
    tau : ndarray, shape (nv,)
        Forces of the joints, N or N m.
    wrench : ndarray, shape (bodies, 6)
        Of each body [moment; force] in its axes at its origin, N m and N.
    probe : ndarray, shape (4, nv)
        What M is multiplied by.
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
    """What an engine holds of a file that its own parser read.

    Attributes
    ----------
    model : dict
        The description in its JSON form.
    description : Description
        The same.
    notes : list of dict
        What the parser did to what (`reading.note`).
    robot : Any
        The engine's robot, in the description's coordinates.
    keyframes : dict of str to ndarray, shape (nq,)
        The file's keyframes by name.
    written : dict, optional
        The description with the file's own inertias, where the engine refuses those and holds repaired ones.
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
        """Tell what the engine holds of each body, by `readback_row`: for each body shape (22,)."""


Quantities = Mapping[str, Mapping[str, Callable[[Any, Question], Any]]]


class Engine(Protocol):
    """What an engine's module gives to `session.serve`.

    An engine that reads files has a method `read(path, format, base) -> Reading` besides.

    Attributes
    ----------
    name, version : str
        Of the engine.
    build : dict of str to str
        What else its answers may depend on.
    quantities : mapping
        Quantity -> method -> a function `(robot, question)` that answers for one state, in the shape of `SHAPES`.
    """

    name: str
    version: str
    build: dict[str, str]
    quantities: Quantities

    def prepare(self, description: Description) -> Robot:
        """Build the robot.

        Raises
        ------
        Unsupported
            If the engine cannot, with what it is that it cannot do.
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
}


# What is told of a robot as an engine read it: what does not ask for single bodies, nor counts masses that are fixed to the world.
AS_READ = ("id", "bias", "mass_matrix", "mass_matrix_probe", "fd", "kinetic_energy")


def readback_row(mass: float, com: Array, inertia: Array, rotation: Array, translation: Array) -> Array:
    """Make one body's row of the answer to `prepare`.

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
