"""Bullet's importers of URDF, SDF and MJCF, and what the multi-body then holds.

Inertias are the file's by the flag `URDF_USE_INERTIA_FROM_FILE`; without it they come from the shapes. A multi-body has a base, the first
link of the file.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pybullet as pb
from numpy.typing import NDArray

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import rotation
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.edits import Held, edited
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, moving, overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.pybullet.building import still

GRAVITY = np.array([0.0, 0.0, -9.81])  # of states that give none: an importer sets no gravity
FLAGS = pb.URDF_USE_INERTIA_FROM_FILE
KINDS = {pb.JOINT_REVOLUTE: "revolute", pb.JOINT_PRISMATIC: "prismatic", pb.JOINT_SPHERICAL: "spherical"}
Make = Callable[[Description, int, int, NDArray[np.intp]], Any]


def read(path: Path, form: str, base: str, make: Make) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the multi-body, its world and the order of its dofs."""
    notes: list[Header] = []
    client = pb.connect(pb.DIRECT)
    with overheard(path, notes):
        try:
            made = _load(path, form, base, client)
        except pb.error as reason:
            raise ValueError(f"PyBullet does not read {path.name}: {reason}") from None
    order = _depth_first(made, client)
    stands = pb.getDynamicsInfo(made, -1, physicsClientId=client)[0] == 0 or (form == "urdf" and base == "fixed")
    links = loaded(_links(made, order, client, stands), notes, moving(path))
    links = bad_values.left_out(path, form, links, notes)
    name = pb.getBodyInfo(made, physicsClientId=client)[1].decode(errors="replace") or path.stem
    description = describe(name, GRAVITY, links)
    if form == "urdf":
        notes.extend(edited(path, lambda link: _held_of(made, link, client)))
        notes.extend(mimics.tell(path, {}, "", "a joint of its own"))
    if form == "mjcf":
        notes.extend(not_compared(path))
    held = Description.read(description)
    still(made, client)
    pb.setGravity(*GRAVITY.tolist(), physicsClientId=client)
    dofs = [pb.getJointInfo(made, k, physicsClientId=client)[4] for k in order]
    return Reading(description, held, notes, make(held, made, client, np.argsort([dof for dof in dofs if dof >= 0])), {})


def _load(path: Path, form: str, base: str, client: int) -> int:
    """Load the one multi-body of a file."""
    if form == "urdf":
        return int(pb.loadURDF(str(path), useFixedBase=base == "fixed", flags=FLAGS, physicsClientId=client))
    if form == "sdf" and any((parent.text or "").strip() == "world" for parent in ElementTree.parse(path).iter("parent")):
        raise Unsupported("PyBullet reads no joint of an SDF to the world")
    load = pb.loadSDF if form == "sdf" else pb.loadMJCF
    made = [k for k in load(str(path), physicsClientId=client) if pb.getNumJoints(k, physicsClientId=client)]
    if len(made) != 1:
        raise Unsupported(f"PyBullet reads {path.name} as {len(made)} multi-bodies with joints, of which descriptions hold one")
    return int(made[0])


def _depth_first(made: int, client: int) -> list[int]:
    """List the links from the base outwards, siblings in Bullet's order."""
    below: dict[int, list[int]] = {}
    for k in range(pb.getNumJoints(made, physicsClientId=client)):
        below.setdefault(pb.getJointInfo(made, k, physicsClientId=client)[16], []).append(k)
    order, ahead = [], list(reversed(below.get(-1, [])))
    while ahead:
        order.append(ahead.pop())
        ahead.extend(reversed(below.get(order[-1], [])))
    return order


def placement(made: int, link: int, client: int) -> Place:
    """Find a link's frame in that of its parent, at the coordinate zero. Bullet has it between principal axes."""
    info = pb.getJointInfo(made, link, physicsClientId=client)
    inertial = Place(rotation(np.array(info[15])).T, np.array(info[14]))
    own = _principal(made, link, client)
    between = _principal(made, info[16], client) @ inertial
    return Place(between.rotation @ own.rotation.T, between.translation)


def _principal(made: int, link: int, client: int) -> Place:
    """Find where a link's principal axes are in its frame."""
    _, _, _, com, axes, *_ = pb.getDynamicsInfo(made, link, physicsClientId=client)
    return Place(rotation(np.array(axes)), np.array(com))


def _mass(made: int, link: int, client: int) -> Held:
    mass, _, moments, *_ = pb.getDynamicsInfo(made, link, physicsClientId=client)
    frame = _principal(made, link, client)
    return float(mass), frame.translation, (frame.rotation * moments) @ frame.rotation.T


def _held_of(made: int, name: str, client: int) -> Held | None:
    """Find what Bullet holds of a link of the file."""
    names = {pb.getJointInfo(made, k, physicsClientId=client)[12].decode(): k for k in range(pb.getNumJoints(made, physicsClientId=client))}
    names.setdefault(pb.getBodyInfo(made, physicsClientId=client)[0].decode(), -1)
    return _mass(made, names[name], client) if name in names else None


def _links(made: int, order: list[int], client: int, stands: bool) -> list[Link]:
    base = pb.getBodyInfo(made, physicsClientId=client)[0].decode(errors="replace")
    position, turn = pb.getBasePositionAndOrientation(made, physicsClientId=client)
    centre = Place(rotation(np.array(turn)), np.array(position))
    place = centre @ _principal(made, -1, client).inverse() if stands else Place()
    links = [Link(base, *_mass(made, -1, client), -1, place, [] if stands else [HeldJoint("root_joint", "free")])]
    index = {-1: 0}
    for k in order:
        info = pb.getJointInfo(made, k, physicsClientId=client)
        index[k] = len(links)
        held = [] if info[2] == pb.JOINT_FIXED else [_joint(info, _principal(made, k, client))]
        links.append(Link(info[12].decode(errors="replace"), *_mass(made, k, client), index[info[16]], placement(made, k, client), held))
    return links


def _joint(info: tuple[Any, ...], principal: Place) -> HeldJoint:
    """Describe a joint. Bullet has its axis in the principal axes of the link."""
    name, kind = info[1].decode(errors="replace"), info[2]
    if kind not in KINDS:
        raise Unsupported(f"joint {name} is of Bullet's type {kind}, which is not read here")
    if kind == pb.JOINT_SPHERICAL:
        return HeldJoint(name, "spherical")
    axis = principal.rotation @ np.array(info[13])
    lower, upper, effort, velocity = info[8:12]
    limits = {"lower": lower, "upper": upper} if lower <= upper else {}
    dofs = {"damping": info[6], "friction": info[7], "effort": effort or inf, "velocity": velocity or inf, **limits}
    return HeldJoint(name, KINDS[kind], axis / np.linalg.norm(axis), dofs={key: np.array([value]) for key, value in dofs.items()})
