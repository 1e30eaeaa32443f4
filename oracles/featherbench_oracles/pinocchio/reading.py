"""Pinocchio's own parsers, `buildModelFromUrdf` and `buildModelFromMJCF`, and what the model then holds.

The bodies here are those that Pinocchio's moving joints carry. Links of fixed joints are already merged, and leave frames. A joint of
several joints (JointModelComposite) is taken apart. The (cos, sin) of a continuous joint is an angle here.
"""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.loaded import loaded, sound
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, elements, moving, note, overheard, without_free_armature
from featherbench_oracles.core.robot import Description

WORKSPACE = 15e3  # bytes of Pinocchio's Data per degree of freedom squared (1.4 GB at 300); without it the process may end
SHARE = 0.8  # of the process's address space: the rest holds the libraries
UNBOUNDED = 1e300  # a limit beyond this is no limit
KINDS = {"R": "revolute", "P": "prismatic", "H": "helical"}
WHOLE = {"Spherical": "spherical", "FreeFlyer": "free", "Planar": "planar", "Universal": "universal"}
WHOLE |= {"SphericalZYX": "euler_zyx", "Translation": "translation"}


def read(path: Path, form: str, base: str, make: Callable[[Description, pin.Model, list[int]], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the model and the indices of its (cos, sin) angles."""
    notes: list[Header] = []
    with overheard(path, notes):
        if form == "mjcf":
            model = pin.buildModelFromMJCF(str(path))
        elif base == "free":
            model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer(), "root_joint")
        else:
            model = pin.buildModelFromUrdf(str(path))
    affordable(model.nv)
    carried = _carried_frames(model)
    bodies = list(elements(path, "body"))
    links = without_free_armature([_link(model, i, bodies, carried) for i in range(1, model.njoints)], notes)
    links = bad_values.left_out(path, form, loaded(links, notes, moving(path)), notes)
    description = describe(model.name or path.stem, model.gravity.linear, links)
    _add_frames(description, model, carried, notes)
    if form == "urdf":
        notes.extend(_mimics(path, model))
    _note_gravity(path, model, notes)
    if form == "mjcf":
        notes.extend(not_compared(path))
    held = Description.read(description)
    for joint, link in zip(list(model.joints)[1:], links, strict=True):
        if any(part.type == "free" for part in link.joints):
            model.armature[joint.idx_v : joint.idx_v + joint.nv] = 0
    model.armature[bad_values.bad(model.armature)] = 0
    return Reading(description, held, notes, make(held, model, _turning(model)), {})


def affordable(nv: int) -> None:
    """Check that the workspace of a robot fits into the address space that this process may have.

    Parameters
    ----------
    nv : int
        Its degrees of freedom.

    Raises
    ------
    Unsupported
        If it does not fit.
    """
    need, most = WORKSPACE * nv**2, resource.getrlimit(resource.RLIMIT_AS)[0]
    if most != resource.RLIM_INFINITY and need > SHARE * most:
        told = f"its workspace (pinocchio.Data) needs about {need / 1e9:.3g} GB for {nv} degrees of freedom"
        raise Unsupported(f"Pinocchio: {told}, and this process may have {most / 1e9:.3g} GB")


def _place(placement: pin.SE3) -> Place:
    return Place(placement.rotation.copy(), placement.translation.copy())


def _turning(model: pin.Model) -> list[int]:
    """List the indices of the angles that are (cos, sin), where each pair counts as one number."""
    indices, count = [], 0
    for i in range(1, model.njoints):
        for joint, _ in _parts(model.joints[i]):
            turning = joint.nq == 2 and joint.nv == 1
            if turning:
                indices.append(count)
            count += 1 if turning else joint.nq
    return indices


def _link(model: pin.Model, i: int, bodies: Sequence[ElementTree.Element], carried: dict[int, pin.Frame]) -> Link:
    """Describe joint i with the body that it carries."""
    parts = list(_parts(model.joints[i]))
    names = [model.names[i]] if len(parts) == 1 else _names(model, i, len(parts), bodies, carried)
    whole = Place()  # from the whole joint's frame to what it moves
    places = []
    for _, placement in parts:
        whole = whole @ placement
        places.append(whole)
    on_joint = _on_joint(carried, i)
    back = (whole @ on_joint).inverse()
    joints = []
    q, v = model.idx_qs[i], model.idx_vs[i]
    for name, (joint, _), place in zip(names, parts, places, strict=True):
        kind, axis, pitch = _type(joint, model.names[i])
        dofs = _dofs(model, slice(q, q + joint.nq), slice(v, v + joint.nv))
        joints.append(HeldJoint(name, kind, axis, pitch, on_joint.inverse() if place is whole else back @ place, dofs=dofs))
        q, v = q + joint.nq, v + joint.nv
    inertia, parent = model.inertias[i], int(model.parents[i]) - 1
    place = _on_joint(carried, parent + 1).inverse() @ _place(model.jointPlacements[i]) @ whole @ on_joint
    axes, com = on_joint.rotation, on_joint.inverse() @ Place(translation=inertia.lever)
    return Link(_carried(model, carried, i), inertia.mass, com.translation, axes.T @ inertia.inertia @ axes, parent, place, joints)


def _own(joint: pin.JointModel) -> Any:
    """Find the joint in its own class, where Pinocchio wraps it in a general one."""
    return joint.extract() if hasattr(joint, "extract") else joint


def _parts(joint: pin.JointModel) -> Iterator[tuple[pin.JointModel, Place]]:
    """List the parts of a joint, each with its placement in the one before."""
    if joint.shortname() != "JointModelComposite":
        yield joint, Place()
        return
    whole = _own(joint)
    for part, placement in zip(whole.joints, whole.jointPlacements, strict=True):
        yield part, _place(placement)


def _names(model: pin.Model, i: int, count: int, bodies: Sequence[ElementTree.Element], carried: dict[int, pin.Frame]) -> list[str]:
    """Name the parts of joint i. Pinocchio does not keep their names; those of the file are taken if its body has as many joints."""
    link = _carried(model, carried, i)
    for body in bodies:
        names = [joint.get("name") for joint in body if joint.tag in ("joint", "freejoint")]
        if body.get("name") == link and len(names) == count and all(names):
            return [str(name) for name in names]
    return [f"{model.names[i]} {k}" for k in range(count)]


def _carried_frames(model: pin.Model) -> dict[int, pin.Frame]:
    """Find the frame of the link that each joint carries: the first body frame on it. The world carries none.

    One pass: a search for each joint would take a time that grows with the square of the number of links.
    """
    found: dict[int, pin.Frame] = {}
    for frame in model.frames:
        if frame.type == pin.BODY and frame.parentJoint:
            found.setdefault(frame.parentJoint, frame)
    return found


def _carried(model: pin.Model, carried: dict[int, pin.Frame], i: int) -> str:
    """Name the link that joint i carries."""
    return carried[i].name if i in carried else model.names[i]


def _on_joint(carried: dict[int, pin.Frame], i: int) -> Place:
    """Find the placement of that link in joint i's frame."""
    return _place(carried[i].placement) if i in carried else Place()


def _type(joint: pin.JointModel, name: str) -> tuple[str, Array | None, float]:
    """Find type, axis and pitch of a joint that is not composite."""
    short = joint.shortname().removeprefix("JointModel")
    if short in WHOLE:
        return WHOLE[short], None, 0.0
    whole = _own(joint)
    for prefix, kind in KINDS.items():
        letter = short.removeprefix(prefix).removeprefix("UB")
        if short.startswith(prefix) and letter in "XYZ" and len(letter) == 1:
            return kind, np.eye(3)["XYZ".index(letter)], float(getattr(whole, "pitch", 0.0))
    named = {"RevoluteUnaligned": "revolute", "RevoluteUnboundedUnaligned": "revolute", "PrismaticUnaligned": "prismatic"}
    named["HelicalUnaligned"] = "helical"
    if short in named:
        return named[short], _axis(joint, whole), float(getattr(whole, "pitch", 0.0))
    raise Unsupported(f"joint {name} is Pinocchio's {short}, a type that descriptions do not have")


def _axis(joint: pin.JointModel, whole: object) -> Array:
    """Find the axis of a joint. Pinocchio 4.1 does not show the axis of an unbounded joint; it is taken from the motion subspace."""
    if hasattr(whole, "axis"):
        return np.array(whole.axis, dtype=float)
    data = joint.createData()
    joint.calc(data, np.array([1.0, 0.0]))
    return np.array(data.S, dtype=float).reshape(6)[3:]


def _dofs(model: pin.Model, q: slice, v: slice) -> dict[str, Array]:
    """Collect armature, damping, friction and limits of one joint."""
    dofs = {"armature": model.armature[v], "damping": model.damping[v], "friction": model.upperDryFrictionLimit[v]}
    limits = {"velocity": model.upperVelocityLimit[v], "effort": model.upperEffortLimit[v]}
    if q.stop - q.start == v.stop - v.start:
        limits |= {"lower": model.lowerPositionLimit[q], "upper": model.upperPositionLimit[q]}
    return {key: value.copy() for key, value in {**dofs, **limits}.items() if key in dofs or (np.abs(value) < UNBOUNDED).all()}


def _add_frames(description: Header, model: pin.Model, carried: dict[int, pin.Frame], notes: list[Header]) -> None:
    """Add a frame for each link that no joint carries."""
    bodies = {body["name"]: k for k, body in enumerate(description["bodies"])}
    frames = {frame["name"]: Place.of(frame["placement"]) for frame in description["frames"]}
    carriers = [_carried(model, carried, i) for i in range(model.njoints)]
    for frame in model.frames:
        link = carriers[frame.parentJoint]
        if frame.type == pin.BODY and (frame.parentJoint == 0 or frame.name != link):
            on_link = sound(_on_joint(carried, frame.parentJoint).inverse() @ _place(frame.placement), frame.name, notes)
            place = frames.get(link, Place()) @ on_link if frame.parentJoint else on_link
            body = bodies[link] if frame.parentJoint else -1
            description["frames"].append({"name": frame.name, "body": body, "placement": place.json()})


def _mimics(path: Path, model: pin.Model) -> list[Header]:
    """Note each joint that mimics another. By default Pinocchio reads it as an independent joint."""
    if not any(mimics.written(path)):
        return []
    try:
        nv = pin.buildModelFromUrdf(str(path), mimic=True).nv
        asked = f"with mimic=True the robot has {nv} degrees of freedom"
    except ValueError as reason:
        asked = f"with mimic=True it refuses the file: {str(reason).strip().splitlines()[-1].removeprefix('hint: ')}"
    held: dict[str, mimics.Mimic | None] = dict.fromkeys(model.names[joint] for joint in model.mimicking_joints)
    return mimics.tell(path, held, "a joint that follows", f"by default Pinocchio reads an independent joint; {asked}")


def _note_gravity(path: Path, model: pin.Model, notes: list[Header]) -> None:
    """Note the gravity of an MJCF, which Pinocchio does not hold."""
    for option in elements(path, "option"):
        given = option.get("gravity")
        if given is not None and given.split() != [f"{x:g}" for x in model.gravity.linear]:
            notes.append(note("gravity_ignored", None, f"the file says ({given}), Pinocchio holds {tuple(model.gravity.linear.tolist())}"))
