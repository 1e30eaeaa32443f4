"""The import: what an engine holds after its own parser has read a file, as a description (PROTOCOL.md, "import").

This module depends on no engine. An engine gives its links, each with the joints between it and its parent. `describe` makes a description:

- a link with several joints becomes a chain of bodies;
- a link without a joint is merged into its parent, and leaves a frame;
- each body's origin is at its joint.
"""

from __future__ import annotations

import math
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import JOINT_SIZES, WITH_AXIS


@dataclass(frozen=True)
class Place:
    """The placement of an inner frame in an outer frame.

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
        From the inner axes to the outer.
    translation : ndarray, shape (3,)
        The inner origin in the outer frame, m.
    """

    rotation: Array = field(default_factory=lambda: np.eye(3))
    translation: Array = field(default_factory=lambda: np.zeros(3))

    def __matmul__(self, inner: Place) -> Place:
        """The placement of `inner` in the outer frame; `inner` is given in this frame."""
        return Place(self.rotation @ inner.rotation, self.rotation @ inner.translation + self.translation)

    def inverse(self) -> Place:
        """The outer frame in this one."""
        return Place(self.rotation.T, -(self.rotation.T @ self.translation))

    def identical(self) -> bool:
        """Whether both frames are exactly the same."""
        return not self.translation.any() and bool((self.rotation == np.eye(3)).all())

    @classmethod
    def of(cls, placement: Header) -> Place:
        """Read a description's placement.

        Parameters
        ----------
        placement : dict
            A placement with `rotation` and `translation`.

        Returns
        -------
        Place
            The same placement.
        """
        return cls(np.reshape(placement["rotation"], (3, 3)), np.array(placement["translation"]))

    def json(self) -> Header:
        """Write the placement as in a description; adding 0 makes -0 a 0."""
        return {"rotation": (self.rotation.ravel() + 0.0).tolist(), "translation": (self.translation + 0.0).tolist()}


@dataclass(frozen=True)
class HeldJoint:
    """A joint of a link.

    Attributes
    ----------
    name, type : str
        As in a description.
    axis : ndarray, shape (3,), optional
        A unit vector in the joint's frame.
    pitch : float
        Metres per radian.
    place : Place
        The joint's frame in the *link's* axes, from the link's origin.
    zero : float
        The coordinate at which the link is at its `place` in the parent (MJCF: `ref`), m or rad.
    dofs : dict of str to ndarray, shape (nv of the joint,)
        Armature, damping, friction and the limits that the engine holds; infinite limits are left out.
    """

    name: str
    type: str
    axis: Array | None = None
    pitch: float = 0.0
    place: Place = field(default_factory=Place)
    zero: float = 0.0
    dofs: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Link:
    """A link, with the joints between it and its parent.

    A link without joints is fixed to its parent. Of several joints each moves those that follow. All places are those at zero coordinates.

    Attributes
    ----------
    name : str
        The link's name.
    mass : float
        In kg.
    com : ndarray, shape (3,)
        The centre of mass in the link's axes, m.
    inertia : ndarray, shape (3, 3)
        About the centre of mass, in the link's axes, kg m².
    parent : int
        The index of a link before this one, or -1.
    place : Place
        The link in its parent.
    joints : sequence of HeldJoint
        The joints, from the parent outwards.
    """

    name: str
    mass: float
    com: Array
    inertia: Array
    parent: int
    place: Place
    joints: Sequence[HeldJoint]


def note(cause: str, about: str | None, text: str, numbers: Sequence[float] = ()) -> Header:
    """Make a note of the answer to `import`.

    Parameters
    ----------
    cause : str
        What the parser did: a word of PROTOCOL.md.
    about : str, optional
        The link or joint.
    text : str
        A sentence for people. Line breaks become blanks.
    numbers : sequence of float
        The numbers that PROTOCOL.md defines for this cause.

    Returns
    -------
    dict
        The note.
    """
    told: Header = {"cause": cause, "about": about, "text": " ".join(text.split())}
    return {**told, "numbers": [float(x) for x in numbers]} if len(numbers) else told


def inertial(mass: float, com: Array, inertia: Array) -> list[float]:
    """List the ten numbers of a link's inertia in a note.

    Parameters
    ----------
    mass : float
        In kg.
    com : ndarray, shape (3,)
        The centre of mass in the link's frame, m.
    inertia : ndarray, shape (3, 3)
        About the centre of mass in the link's frame, kg m².

    Returns
    -------
    list of float
        Mass, centre of mass, and the inertia's xx, xy, xz, yy, yz, zz.
    """
    return [float(mass), *np.asarray(com, dtype=float).tolist(), *inertia[np.triu_indices(3)].tolist()]


def without_free_armature(links: Sequence[Link], notes: list[Header]) -> list[Link]:
    """Take out the armature of free joints: engines disagree on its meaning, and descriptions do not have it.

    Parameters
    ----------
    links : sequence of Link
        The links that the engine holds.
    notes : list of dict
        Gets a note for each such joint.

    Returns
    -------
    list of Link
        The same links without that armature.
    """
    result = []
    for link in links:
        for joint in link.joints:
            armature = joint.dofs.get("armature", np.zeros(0))
            if joint.type == "free" and armature.any():
                held = f"armature {tuple(armature.tolist())} on the free joint is held, and taken out of what is compared"
                notes.append(note("free_armature", joint.name, held, armature.tolist()))
        joints = [replace(j, dofs={**j.dofs, "armature": np.zeros(6)}) if j.type == "free" else j for j in link.joints]
        result.append(replace(link, joints=joints))
    return result


def listed(names: Sequence[str]) -> str:
    """Write names for a sentence: all, or the first ten of more than twelve."""
    more = f" and {len(names) - 10} more" if len(names) > 12 else ""
    return ", ".join(names[: 10 if more else None]) + more


def describe(name: str, gravity: Array, links: Sequence[Link]) -> Header:
    """Write links in depth-first order as a description.

    Parameters
    ----------
    name : str
        The robot's name.
    gravity : ndarray, shape (3,)
        In world axes, m/s².
    links : sequence of Link
        The links.

    Returns
    -------
    dict
        The description in its JSON form, with a frame for each link that is not a body.
    """
    bodies: list[Header] = []
    frames: list[Header] = []
    parts: list[list[tuple[float, Array, Array]]] = []  # the merged links of each body
    homes: list[tuple[int, Place]] = []  # the body of each link, and the link's place there
    for link in links:
        body, on_parent = homes[link.parent] if link.parent >= 0 else (-1, Place())
        on_parent = on_parent @ link.place
        before = Place()  # the frame of the joint before, in the link's
        for k, joint in enumerate(link.joints):
            last = k == len(link.joints) - 1
            here, axis = _gauge(joint)
            place = (on_parent @ here if k == 0 else before.inverse() @ here) @ _back(joint, axis)
            named = link.name if last else f"{link.name}/{joint.name}"
            bodies.append({"name": named, "parent": body, "joint": _joint(joint, axis, place)})
            parts.append([])
            body, before = len(bodies) - 1, here
        home = before.inverse() if link.joints else on_parent
        homes.append((body, home))
        if not (link.joints and home.identical()):
            frames.append({"name": link.name, "body": body, "placement": home.json()})
        if body >= 0:
            parts[body].append((link.mass, home.rotation @ link.com + home.translation, home.rotation @ link.inertia @ home.rotation.T))
    for item, held in zip(bodies, parts, strict=True):
        mass, com, inertia = merged(held)
        com = com if mass else np.zeros(3)  # nowhere
        item.update(mass=mass, com=(com + 0.0).tolist(), inertia=(inertia[np.triu_indices(3)] + 0.0).tolist())
    return {"format": 1, "name": name, "gravity": np.asarray(gravity).tolist(), "bodies": bodies, "frames": frames}


def _gauge(joint: HeldJoint) -> tuple[Place, Array | None]:
    """Find the joint's frame in the link's, and its axis.

    A joint with an axis gets a frame with the link's axes. A prismatic joint's frame also has the link's origin.
    """
    if joint.type not in JOINT_SIZES:
        raise Unsupported(f"joint {joint.name} is of a type that descriptions do not have: {joint.type}")
    if joint.axis is None:
        return joint.place, None
    axis = joint.place.rotation @ joint.axis
    return (Place() if joint.type == "prismatic" else Place(translation=joint.place.translation)), axis


def _back(joint: HeldJoint, axis: Array | None) -> Place:
    """Find the motion from the coordinate `zero` to 0."""
    if joint.zero == 0 or axis is None:
        return Place()
    if joint.type == "prismatic":
        return Place(translation=-joint.zero * axis)
    turn = skew(axis)
    return Place(np.eye(3) - math.sin(joint.zero) * turn + (1 - math.cos(joint.zero)) * turn @ turn)


def _joint(joint: HeldJoint, axis: Array | None, place: Place) -> Header:
    """Write a joint of a description."""
    dofs = {key: np.zeros(JOINT_SIZES[joint.type][1]) for key in ("armature", "damping", "friction")}
    dofs.update({key: value for key, value in joint.dofs.items() if np.isfinite(value).all()})
    data: Header = {"name": joint.name, "type": joint.type, "placement": place.json()}
    if joint.type in WITH_AXIS and axis is not None:
        data["axis"] = (axis + 0.0).tolist()
    if joint.type == "helical":
        data["pitch"] = joint.pitch
    return {**data, **{key: value.tolist() for key, value in dofs.items()}}


def merged(parts: Sequence[tuple[float, Array, Array]]) -> tuple[float, Array, Array]:
    """Merge bodies that are given in one frame. A single one is returned unchanged.

    Parameters
    ----------
    parts : sequence of (float, ndarray, ndarray)
        For each its mass (kg), its centre of mass of shape (3,) (m), and its inertia about that point of shape (3, 3) (kg m²).

    Returns
    -------
    mass : float
        The sum, kg.
    com : ndarray, shape (3,)
        The common centre of mass, m.
    inertia : ndarray, shape (3, 3)
        About the common centre of mass, kg m².
    """
    parts = [part for part in parts if part[0] or part[2].any()] or list(parts[:1])
    if len(parts) < 2:
        return parts[0] if parts else (0.0, np.zeros(3), np.zeros((3, 3)))
    mass = sum(m for m, _, _ in parts)
    com = sum((m * c for m, c, _ in parts), np.zeros(3)) / (mass or 1.0)
    return mass, com, sum((i - m * skew(c - com) @ skew(c - com) for m, c, i in parts), np.zeros((3, 3)))


def turned(w: float, x: float, y: float, z: float) -> Array:
    """Compute the rotation of a quaternion of any length, by scalar operations in this order, each rounded once, none fused.

    ::

        n = ((w w + x x) + y y) + z z
        diagonal: (((w w + x x) - y y) - z z) / n,  (((w w - x x) + y y) - z z) / n,  (((w w - x x) - y y) + z z) / n
        below it, at (1,0), (2,0), (2,1): (2 (x y + w z)) / n,  (2 (x z - w y)) / n,  (2 (y z + w x)) / n
        above it, at (0,1), (0,2), (1,2): (2 (x y - w z)) / n,  (2 (x z + w y)) / n,  (2 (y z - w x)) / n

    Quarter turns are exact. A program that writes a file can search a quaternion that gives a rotation to the bit.
    """
    w, x, y, z = float(w), float(x), float(y), float(z)
    ww, xx, yy, zz = w * w, x * x, y * y, z * z
    n = ((ww + xx) + yy) + zz
    return np.array(
        [
            [(((ww + xx) - yy) - zz) / n, (2 * (x * y - w * z)) / n, (2 * (x * z + w * y)) / n],
            [(2 * (x * y + w * z)) / n, (((ww - xx) + yy) - zz) / n, (2 * (y * z - w * x)) / n],
            [(2 * (x * z - w * y)) / n, (2 * (y * z + w * x)) / n, (((ww - xx) - yy) + zz) / n],
        ]
    )


# ---- the file, and what the parser prints --------------------------------------------------------------------------------------------


def parsed(path: Path) -> ElementTree.Element:
    """Parse a file; its root, which no caller may change. One file is asked many times in a row, and the last one is kept."""
    return _parsed(path.read_bytes())


@lru_cache(maxsize=1)
def _parsed(text: bytes) -> ElementTree.Element:
    return ElementTree.fromstring(text)


def elements(path: Path, tag: str) -> Iterator[ElementTree.Element]:
    """Find the elements of a tag in a file, but not in files that it includes. They show what an engine left out.

    Parameters
    ----------
    path : Path
        An XML file.
    tag : str
        The tag.

    Returns
    -------
    iterator of Element
        The elements in the file's order.
    """
    return parsed(path).iter(tag)


def moving(path: Path) -> list[str]:
    """Find the joints of a URDF or an MJCF, by their names."""
    return [joint.get("name") or "without a name" for tag in ("joint", "freejoint") for joint in elements(path, tag)]


def roots(path: Path) -> list[str]:
    """Find the links of a URDF that no joint carries, in the file's order."""
    carried = {child.get("link") for child in elements(path, "child")}
    names = (link.get("name") for link in elements(path, "link"))
    return [name for name in names if name is not None and name not in carried]


_COLOURS = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")  # the escape sequences of terminals


@contextmanager
def overheard(path: Path, notes: list[Header]) -> Iterator[None]:
    """Add each message that an engine prints in this context to the notes, as `warning`.

    Standard error gets the messages as well. In the notes the file's path is shortened to its name. An exception is raised again with the
    errors that the engine printed: a library that rejects a file prints the reason, and its exception does not have it.
    """
    kept = [(number, os.dup(number)) for number in (1, 2)]
    failure: Exception | None = None
    with tempfile.TemporaryFile() as words:
        try:
            for number, _ in kept:
                os.dup2(words.fileno(), number)
            yield
        except Exception as reason:
            failure = reason
        finally:
            sys.stderr.flush()
            for number, copy in kept:
                os.dup2(copy, number)
                os.close(copy)
            words.seek(0)
            text = words.read().decode(errors="replace")
            sys.stderr.write(text)
            messages: list[str] = []
            for line in _COLOURS.sub("", text).replace(str(path), path.name).splitlines():
                if messages and not re.match(r"\S*(warning|error)\b", line, re.IGNORECASE):
                    messages[-1] += " " + line
                elif line.strip():
                    messages.append(line)
            notes.extend(note("warning", None, message) for message in dict.fromkeys(messages))
    if failure is not None:
        said = errors(notes)
        # What is not offered stays so, whatever the engine printed.
        told = failure if isinstance(failure, Unsupported) or not said else ValueError(f"{failure} It prints: {said}")
        raise told


def errors(notes: Sequence[Header]) -> str:
    """Collect the errors that an engine printed, without the positions in its own sources.

    Parameters
    ----------
    notes : Sequence[Header]
        Notes of `overheard`.

    Returns
    -------
    str
        The errors, with semicolons between.
    """
    texts = [n["text"] for n in notes if n["cause"] == "warning" and re.match(r"\S*error\b", n["text"], re.IGNORECASE)]
    return "; ".join(re.sub(r"\S*error:?\s*|\s*at line \d+ in \S+", "", text, flags=re.IGNORECASE).strip() for text in texts)
