"""iDynTree's own parser of URDF, `ModelLoader`, and what the model then holds.

iDynTree keeps the links of fixed joints. They are merged in the description. Fixed links without mass that carry nothing become frames.
Bodies are listed depth-first from the base, siblings in the order of iDynTree's joints.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import idyntree.bindings as idt
import numpy as np

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.edits import Held, edited
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, moving, overheard, parsed, roots
from featherbench_oracles.core.robot import Description
from featherbench_oracles.idyntree.building import Built, numbers

GRAVITY = np.array([0.0, 0.0, -9.81])  # of states that give none: iDynTree's models have no gravity


def read(path: Path, form: str, base: str, make: Callable[[Description, Built], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description and what was built."""
    notes: list[Header] = []
    loader = idt.ModelLoader()
    with overheard(path, notes):
        if not loader.loadModelFromFile(str(path)):
            raise ValueError(f"iDynTree does not read {path.name}.")
    model = loader.model().copy()
    if not model.getNrOfLinks():
        raise ValueError(f"iDynTree holds no link of {path.name}")
    root = model.getDefaultBaseLink()
    order = _order(model, root)
    stands = _stands(model, path) if base == "fixed" else Place()
    links = loaded(_links(model, order, base, stands), notes, moving(path))
    description = describe(parsed(path).get("name") or path.stem, GRAVITY, bad_values.left_out(path, form, links, notes))
    notes.extend(edited(path, lambda name: _inertial(model, name)))
    notes.extend(mimics.tell(path, {}, "", "a joint of its own"))
    held = Description.read(description)
    moved = [(link, joint) for link, joint in order if joint is not None and joint.getNrOfDOFs()]
    carried = [root] * (base == "free") + [link for link, _ in moved]
    return Reading(description, held, notes, make(held, Built(model, carried, [joint for _, joint in moved], stands)), {})


def _stands(model: idt.Model, path: Path) -> Place:
    """Find where the base stands on the file's root, which iDynTree makes a frame of the base if it has no mass and one fixed joint."""
    frame = next((index for index in map(model.getFrameIndex, roots(path)) if index >= model.getNrOfLinks()), None)
    return _place(model.getFrameTransform(frame)).inverse() if frame is not None else Place()


def _order(model: idt.Model, root: int) -> list[tuple[int, idt.IJoint | None]]:
    """List links depth-first, each with the joint that carries it."""
    joints = [model.getJoint(k) for k in range(model.getNrOfJoints())]
    onto: dict[int, list[tuple[int, idt.IJoint]]] = {}
    for joint in joints:
        ends = joint.getFirstAttachedLink(), joint.getSecondAttachedLink()
        onto.setdefault(ends[0], []).append((ends[1], joint))
    order, ahead = [], [(root, None)]
    while ahead:
        order.append(ahead.pop())
        ahead.extend(reversed(onto.get(order[-1][0], [])))
    return order


def _place(transform: idt.Transform) -> Place:
    return Place(numbers(transform.getRotation()), numbers(transform.getPosition()))


def _inertial(model: idt.Model, name: str) -> Held | None:
    """Find what the model holds of a link. One that became a frame has no mass."""
    if model.getFrameIndex(name) < 0:
        return None
    if model.getLinkIndex(name) < 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    index = model.getLinkIndex(name)
    held = model.getLink(index).getInertia()
    return held.getMass(), numbers(held.getCenterOfMass()), numbers(held.getRotationalInertiaWrtCenterOfMass())


def _links(model: idt.Model, order: list[tuple[int, idt.IJoint | None]], base: str, stands: Place) -> list[Link]:
    """Describe the links, and the frames on them as links without mass."""
    places = {link: k for k, (link, _) in enumerate(order)}
    links = []
    for link, joint in order:
        mass, com, inertia = _inertial(model, model.getLinkName(link)) or (0.0, np.zeros(3), np.zeros((3, 3)))
        if joint is None:
            free = [HeldJoint("root_joint", "free")] * (base == "free")
            links.append(Link(model.getLinkName(link), mass, com, inertia, -1, stands, free))
            continue
        parent = joint.getFirstAttachedLink()
        place = _place(joint.getRestTransform(parent, link))
        held = [_held(model, joint, link)] if joint.getNrOfDOFs() else []
        links.append(Link(model.getLinkName(link), mass, com, inertia, places[parent], place, held))
    for frame in range(model.getNrOfLinks(), model.getNrOfFrames()):
        place = _place(model.getFrameTransform(frame))
        links.append(Link(model.getFrameName(frame), 0.0, np.zeros(3), np.zeros((3, 3)), places[model.getFrameLink(frame)], place, []))
    return links


def _held(model: idt.Model, joint: idt.IJoint, link: int) -> HeldJoint:
    """Describe a joint that moves a link."""
    name = model.getJointName(joint.getIndex())
    own = (joint.isRevoluteJoint() and joint.asRevoluteJoint()) or (joint.isPrismaticJoint() and joint.asPrismaticJoint())
    if own:
        kind = "revolute" if joint.isRevoluteJoint() else "prismatic"
        axis = own.getAxis(link)
        return HeldJoint(name, kind, numbers(axis.getDirection()), dofs=_dofs(joint))
    raise Unsupported(f"joint {name} is of a type that is not read here")


def _dofs(joint: idt.IJoint) -> dict[str, Array]:
    """Collect damping, friction and limits of a joint with one degree of freedom."""
    dofs = {"damping": joint.getDamping(0), "friction": joint.getStaticFriction(0)}
    if joint.hasPosLimits():
        dofs |= {"lower": joint.getMinPosLimit(0), "upper": joint.getMaxPosLimit(0)}
    if joint.hasVelocityLimits():
        dofs["velocity"] = joint.getVelocityLimit(0)
    if joint.hasEffortLimits():
        dofs["effort"] = joint.getEffortLimit(0)
    return {key: np.array([value]) for key, value in dofs.items()}
