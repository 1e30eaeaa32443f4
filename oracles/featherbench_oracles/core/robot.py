"""The description of a robot (PROTOCOL.md, "The description"): joints, bodies, and its JSON form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from featherbench_oracles.core.algebra import Array, symmetric

# joint type -> (numbers in q, numbers in v)
JOINT_SIZES = {
    "revolute": (1, 1),
    "prismatic": (1, 1),
    "helical": (1, 1),
    "spherical": (4, 3),
    "free": (7, 6),
    "planar": (3, 3),
    "universal": (2, 2),
    "translation": (3, 3),
    "cylindrical": (2, 2),
    "euler_zyx": (3, 3),
}
WITH_AXIS = ("revolute", "prismatic", "helical", "cylindrical")


@dataclass(frozen=True)
class Joint:
    """A joint. Damping and dry friction are not kept, because no quantity includes them.

    Attributes
    ----------
    name : str
        The joint's name.

    type : str
        One of the keys of `JOINT_SIZES`.

    axis : ndarray, shape (3,)
        A unit vector in the joint's frame; zero for types without an axis.

    pitch : float
        Metres per radian; 0 unless the joint is helical.

    rotation : ndarray, shape (3, 3)
        From the joint's axes to the parent's.

    translation : ndarray, shape (3,)
        The joint's origin in the parent's frame, m.

    armature : ndarray, shape (nv of the joint,)
        Added to the diagonal of M, kg or kg m².

    q, v : slice
        The joint's ranges in the neutral coordinates.
    """

    name: str
    type: str
    axis: Array
    pitch: float
    rotation: Array
    translation: Array
    armature: Array
    q: slice
    v: slice


@dataclass(frozen=True)
class Body:
    """A rigid body, the child of its joint.

    Attributes
    ----------
    name : str
        The body's name.

    mass : float
        In kg.

    com : ndarray, shape (3,)
        The centre of mass in body axes, m.

    inertia : ndarray, shape (3, 3)
        About the centre of mass, in body axes, kg m².

    parent : int
        The index of the parent body; -1 is the world.

    joint : Joint
        The joint that carries the body.
    """

    name: str
    mass: float
    com: Array
    inertia: Array
    parent: int
    joint: Joint


@dataclass(frozen=True)
class Description:
    """A robot: bodies in depth-first order. Body i is the child of joint i.

    Attributes
    ----------
    name : str
        The robot's name.
    gravity : ndarray, shape (3,)
        The acceleration of free fall in world axes, m/s².
    bodies : tuple of Body
        The bodies.
    nq, nv : int
        The numbers of coordinates and of velocities.
    """

    name: str
    gravity: Array
    bodies: tuple[Body, ...]
    nq: int
    nv: int

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Description:
        """Read and check the JSON form.

        Parameters
        ----------
        data : mapping
            The description as PROTOCOL.md has it.

        Returns
        -------
        Description
            The robot.

        Raises
        ------
        ValueError, KeyError
            If something is malformed; the message names it.
        """
        if data["format"] != 1:
            raise ValueError(f"description format {data['format']} is not 1")
        bodies: list[Body] = []
        branch: list[int] = [-1]  # from the world to the last body
        nq = nv = 0
        for i, item in enumerate(data["bodies"]):
            joint = _read_joint(item["joint"], nq, nv)
            nq, nv = joint.q.stop, joint.v.stop
            where = f"body {item['name']}"
            parent = item["parent"]
            if parent not in branch:
                raise ValueError(f"{where}: its parent {parent} breaks the depth-first order")
            branch = [*branch[: branch.index(parent) + 1], i]
            mass = float(_numbers(item["mass"], (), f"{where}: mass"))
            inertia = symmetric(_numbers(item["inertia"], (6,), f"{where}: inertia"))
            bodies.append(Body(item["name"], mass, _numbers(item["com"], (3,), f"{where}: com"), inertia, parent, joint))
        return cls(data["name"], _numbers(data["gravity"], (3,), "gravity"), tuple(bodies), nq, nv)

    def tree_sparse(self) -> tuple[list[int], list[int]]:
        """List the entries of M in the tree-sparse layout: row i holds those of the dofs from the root to i.

        Returns
        -------
        rows, columns : list of int
            The indices of the stored entries in M, in the order of the layout.
        """
        paths: list[list[int]] = []  # of the last dof of each body
        rows: list[int] = []
        columns: list[int] = []
        for body in self.bodies:
            path = list(paths[body.parent]) if body.parent >= 0 else []
            for dof in range(body.joint.v.start, body.joint.v.stop):
                path.append(dof)
                rows += [dof] * len(path)
                columns += path
            paths.append(path)
        return rows, columns


def _read_joint(data: Mapping[str, Any], nq: int, nv: int) -> Joint:
    """Read the joint whose coordinates begin at `nq` and `nv`."""
    name, kind, where = data["name"], data["type"], f"joint {data['name']}"
    if kind not in JOINT_SIZES:
        raise ValueError(f"{where}: unknown type {kind}")
    sizes = JOINT_SIZES[kind]
    axis = _numbers(data["axis"], (3,), f"{where}: axis") if kind in WITH_AXIS else np.zeros(3)
    if kind in WITH_AXIS and abs(np.linalg.norm(axis) - 1) > 1e-9:
        raise ValueError(f"{where}: its axis is not a unit vector")
    pitch = float(_numbers(data["pitch"], (), f"{where}: pitch")) if kind == "helical" else 0.0
    rotation, translation = read_placement(data["placement"], where)
    armature = _numbers(data["armature"], (sizes[1],), f"{where}: armature")
    q, v = slice(nq, nq + sizes[0]), slice(nv, nv + sizes[1])
    return Joint(name, kind, axis, pitch, rotation, translation, armature, q, v)


def read_placement(data: Mapping[str, Any], where: str) -> tuple[Array, Array]:
    """Read and check a placement.

    Parameters
    ----------
    data : mapping
        Its JSON form.
    where : str
        What it places, for messages.

    Returns
    -------
    rotation : ndarray, shape (3, 3)
        From the placed axes to the carrier's.
    translation : ndarray, shape (3,)
        The placed origin, m.

    Raises
    ------
    ValueError, KeyError
        If it is malformed.
    """
    rotation = _numbers(data["rotation"], (9,), f"{where}: rotation").reshape(3, 3)
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-9 or np.linalg.det(rotation) < 0:
        raise ValueError(f"{where}: its placement's rotation is not a rotation")
    return rotation, _numbers(data["translation"], (3,), f"{where}: translation")


def _numbers(value: Any, shape: tuple[int, ...], what: str) -> Array:
    """Make an array of that shape of `value`, whose numbers must be finite."""
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"{what}: expected {math.prod(shape)} finite number(s)")
    return array
