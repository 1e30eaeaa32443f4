"""DART's own parsers, `DartLoader` for URDF and `MjcfParser`, and what the skeleton then holds.

DART keeps the links of fixed joints as bodies on weld joints. They are merged in the description. Damping, friction, springs and the
coupling of joints that mimic others are reported and then taken out of the skeleton.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from math import pi
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from dartpy import common, dynamics, utils
from dartpy.math import Isometry3

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, elements, errors, inertial, moving, note, overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.dart.building import check_size

# DART's name of a joint's type -> ours
TYPES = {
    "RevoluteJoint": "revolute",
    "PrismaticJoint": "prismatic",
    "ScrewJoint": "helical",
    "BallJoint": "spherical",
    "FreeJoint": "free",
    "PlanarJoint": "planar",
    "UniversalJoint": "universal",
    "TranslationalJoint": "translation",
}
UNBOUNDED = 1e300  # a limit beyond this is no limit
DRESS = re.compile(r"\x1b\[[0-9;]*m|^\[[-0-9 :.]+\] \[\w+\] ")  # colours and times in DART's messages
BETWEEN = re.compile(r"(.+)__mjcf_dof\d+")  # bodies of DART's own between the joints of an MJCF body
EDITED = 1e-9  # relative difference of a link's mass that is reported as an edit


def read(path: Path, form: str, base: str, make: Callable[[Description, dynamics.Skeleton, Any, Any], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the skeleton, its moving joints and their bodies."""
    notes: list[Header] = []
    check_size(sum(1 for _ in elements(path, "body" if form == "mjcf" else "link")))
    with overheard(path, notes):
        skeleton = _urdf(path, base) if form == "urdf" else _world(path, form)
    for heard in notes:
        heard["text"] = DRESS.sub("", heard["text"])
    if skeleton is None and form == "urdf":
        skeleton = _urdf(path, base, bare=True)
        if skeleton is not None:
            notes.append(note("geometry_dropped", None, "DART reads the file without its visual and collision elements only"))
    if skeleton is None:
        said = errors(notes) or (notes[-1]["text"] if notes else "it does not say why")
        raise ValueError(f"DART does not read {path.name}: {said}")
    nodes = skeleton.getBodyNodes()
    links = bad_values.left_out(path, form, loaded(_links(nodes), notes, moving(path)), notes)
    description = describe(skeleton.getName() or path.stem, skeleton.getGravity(), links)
    description["frames"] = [frame for frame in description["frames"] if "/" not in frame["name"]]
    if form != "sdf":
        _note(path, nodes, notes)
    if form == "urdf":
        joints = [node.getParentJoint() for node in nodes]
        driven = [joint.getName() for joint in joints if joint.getNumDofs() and joint.getActuatorType() == dynamics.ActuatorType.MIMIC]
        tied: dict[str, mimics.Mimic | None] = dict.fromkeys(driven)
        notes.extend(mimics.tell(path, tied, "a joint of its own, driven by an actuator as a mimic", "a joint of its own"))
    if form == "urdf" and base == "free" and not any(isinstance(joint, dynamics.FreeJoint) for joint in skeleton.getJoints()):
        notes.append(note("root_welded", None, "DART takes a link called world for the world"))
    for joint in skeleton.getJoints():
        joint.setActuatorType(dynamics.ActuatorType(dynamics.FORCE))
        for k in range(joint.getNumDofs()):
            for neutralise in (joint.setDampingCoefficient, joint.setCoulombFriction, joint.setSpringStiffness):
                neutralise(k, 0.0)
    if form == "mjcf":
        notes.extend(not_compared(path))
    held = Description.read(description)
    moved = [node for node in nodes if node.getParentJoint().getNumDofs()]
    robot = make(held, skeleton, [node.getParentJoint() for node in moved], moved)
    return Reading(description, held, notes, robot, {})


def _urdf(path: Path, base: str, bare: bool = False) -> dynamics.Skeleton | None:
    """Load the skeleton of a URDF; if `bare`, without its geometry, whose files DART may not find."""
    roots = utils.DartLoaderRootJointType
    loader, options = utils.DartLoader(), utils.DartLoaderOptions()
    options.mDefaultRootJointType = roots.FLOATING if base == "free" else roots.FIXED
    loader.setOptions(options)
    if not bare:
        return loader.parseSkeleton(common.Uri(str(path)))
    tree = ElementTree.parse(path)
    for link in tree.getroot().iter("link"):
        for geometry in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(geometry)
    return loader.parseSkeletonString(ElementTree.tostring(tree.getroot(), encoding="unicode"), common.Uri(str(path)))


def _world(path: Path, form: str) -> dynamics.Skeleton | None:
    """Load the one skeleton that moves. DART makes a skeleton of each body in the world of an MJCF."""
    if form == "sdf":
        skeleton = utils.SdfParser.readSkeleton(common.Uri(str(path)))
        if skeleton is not None:
            _depth_first(skeleton)
        return skeleton
    world = utils.MjcfParser.readWorld(common.Uri(str(path)))
    if world is None:
        return None
    moving = [world.getSkeleton(i) for i in range(world.getNumSkeletons()) if world.getSkeleton(i).getNumDofs()]
    if len(moving) != 1:
        raise Unsupported(f"DART reads {path.name} as {len(moving)} moving skeletons, of which descriptions hold one")
    return moving[0]


def _depth_first(skeleton: dynamics.Skeleton) -> None:
    """Refuse links that are not depth-first: of an SDF they stay in the order of the file, and with them the coordinates."""
    below = {node.getName(): [node.getChildBodyNode(k) for k in range(node.getNumChildBodyNodes())] for node in skeleton.getBodyNodes()}
    order: list[str] = []
    ahead = [skeleton.getRootBodyNode(k) for k in reversed(range(skeleton.getNumTrees()))]
    while ahead:
        order.append(ahead.pop().getName())
        ahead.extend(reversed(below[order[-1]]))
    if order != [node.getName() for node in skeleton.getBodyNodes()]:
        raise Unsupported("DART keeps the links of an SDF in the file's order, and descriptions are depth-first: write the links so")


def _place(pose: Isometry3) -> Place:
    return Place(pose.rotation().copy(), pose.translation().copy())


def _links(nodes: list[dynamics.BodyNode]) -> list[Link]:
    """List the bodies as links, each with its joint to the parent."""
    index = {node.getName(): k for k, node in enumerate(nodes)}
    links = []
    for node in nodes:
        joint, parent = node.getParentJoint(), node.getParentBodyNode()
        outer, inner = _place(joint.getTransformFromParentBodyNode()), _place(joint.getTransformFromChildBodyNode())
        place = outer if inner.identical() else outer @ inner.inverse()
        inertia = node.getInertia()
        com, moment = np.array(inertia.getLocalCOM()), np.array(inertia.getMoment())
        held = [_held(joint, inner)] if joint.getNumDofs() else []
        between = BETWEEN.fullmatch(node.getName())
        name = f"{between[1]}/{joint.getName()}" if between else node.getName()
        links.append(Link(name, inertia.getMass(), com, moment, index[parent.getName()] if parent else -1, place, held))
    return links


def _held(joint: dynamics.Joint, inner: Place) -> HeldJoint:
    """Describe a joint."""
    kind = TYPES.get(joint.getType(), joint.getType())
    count = joint.getNumDofs()
    dofs = {"damping": np.array([joint.getDampingCoefficient(k) for k in range(count)])}
    dofs["friction"] = np.array([joint.getCoulombFriction(k) for k in range(count)])
    limits = {"velocity": joint.getVelocityUpperLimits(), "effort": joint.getForceUpperLimits()}
    if kind not in ("spherical", "free"):
        limits |= {"lower": joint.getPositionLowerLimits(), "upper": joint.getPositionUpperLimits()}
    dofs |= {key: np.array(value) for key, value in limits.items() if (np.abs(value) < UNBOUNDED).all()}
    axis = np.array(joint.getAxis()) if kind in ("revolute", "prismatic", "helical") else None
    pitch = joint.getPitch() / (2 * pi) if kind == "helical" else 0.0
    return HeldJoint(joint.getName(), kind, axis, pitch, inner @ Place(_axes(joint, kind)), dofs=dofs)


def _axes(joint: dynamics.Joint, kind: str) -> Array:
    """Find our joint's axes in DART's joint frame. DART's planar joint may have others than x, y, z; a universal joint others than x, y."""
    if kind == "planar":
        return np.column_stack([joint.getTranslationalAxis1(), joint.getTranslationalAxis2(), joint.getRotationalAxis()])
    if kind == "universal":
        x, y = np.array(joint.getAxis1()), np.array(joint.getAxis2())
        return np.column_stack([x, y, np.cross(x, y)])
    return np.eye(3)


def _note(path: Path, nodes: list[dynamics.BodyNode], notes: list[Header]) -> None:
    """Note links of a URDF whose mass is not the file's."""
    held = {node.getName(): node.getInertia() for node in nodes}
    for link in elements(path, "link"):
        name, mass = link.get("name"), link.find("inertial/mass")
        if name not in held:
            continue
        words = (mass.get("value") if mass is not None else None) or "0"
        try:
            edited = abs(float(words) - held[name].getMass()) > EDITED * abs(float(words))
        except ValueError:
            edited = True
        if edited:
            numbers = inertial(held[name].getMass(), held[name].getLocalCOM(), np.array(held[name].getMoment()))
            notes.append(note("mass_edited", name, f"{words} kg in the file became {held[name].getMass()} kg", numbers))
