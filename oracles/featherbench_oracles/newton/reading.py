"""Newton's own parsers of URDF, MJCF and USD, and what the model then holds, in single precision.

A joint of several axes (D6) is a chain of joints: its translations come first. Bodies of fixed joints are merged in the description, and
stay bodies of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any

import newton
import numpy as np
from pxr import Usd

from featherbench_oracles.core import bad_values
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.edits import Held, edited
from featherbench_oracles.core.loaded import loaded, nearest_rotation
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, elements, moving, note, overheard
from featherbench_oracles.core.robot import Description

KINDS = newton.JointType
EFFORT = 1e6  # Newton's own limit where a file gives none


class Read:
    """What was read: the model, its links depth-first, and where the description's coordinates are among the model's.

    Parameters
    ----------
    model : newton.Model
        The robot.
    """

    def __init__(self, model: newton.Model) -> None:
        self.model = model
        names = (
            "joint_X_p",
            "joint_X_c",
            "joint_axis",
            "joint_armature",
            "joint_damping",
            "joint_friction",
            "body_mass",
            "body_com",
            "body_inertia",
        )
        limits = ("joint_limit_lower", "joint_limit_upper", "joint_velocity_limit", "joint_effort_limit")
        self.held = {name: np.array(getattr(model, name).numpy(), dtype=float) for name in (*names, *limits)}
        counts = ("joint_type", "joint_parent", "joint_child", "joint_q_start", "joint_qd_start", "joint_dof_dim")
        self.index = {name: getattr(model, name).numpy() for name in counts}
        self.bodies = [label.rsplit("/", 1)[-1] for label in model.body_label]
        self.order = self._depth_first()
        self.q, self.v = (self._places(name) for name in ("joint_q_start", "joint_qd_start"))
        self.links = self._links()

    def _depth_first(self) -> list[int]:
        """List the joints from the world outwards, siblings in the model's order."""
        below: dict[int, list[int]] = {}
        for joint, parent in enumerate(self.index["joint_parent"].tolist()):
            below.setdefault(parent, []).append(joint)
        order, ahead = [], list(reversed(below.get(-1, [])))
        seen = set()
        while ahead:
            joint = ahead.pop()
            child = int(self.index["joint_child"][joint])
            if child in seen:
                continue  # it closes a loop
            seen.add(child)
            order.append(joint)
            ahead.extend(reversed(below.get(child, [])))
        return order

    def _places(self, name: str) -> list[int]:
        """List the model's coordinates in the description's order."""
        starts = self.index[name].tolist()
        return [k for joint in self.order for k in range(starts[joint], starts[joint + 1])]

    def _links(self) -> list[Link]:
        places = {-1: -1}
        links: list[Link] = []
        for joint in self.order:
            parent, child = int(self.index["joint_parent"][joint]), int(self.index["joint_child"][joint])
            inner = _place(self.held["joint_X_c"][joint])
            place = _place(self.held["joint_X_p"][joint]) @ inner.inverse()
            places[child] = len(links)
            links.append(Link(self.bodies[child], *self._mass(child), places[parent], place, self._joints(joint, inner)))
        return links

    def _mass(self, body: int) -> Held:
        mass, com, inertia = (self.held[name][body] for name in ("body_mass", "body_com", "body_inertia"))
        return float(mass), com, (inertia + inertia.T) / 2

    def _joints(self, joint: int, inner: Place) -> list[HeldJoint]:
        """Describe a joint, one of several axes by one joint for each."""
        name, kind = self.model.joint_label[joint].rsplit("/", 1)[-1], KINDS(int(self.index["joint_type"][joint]))
        if kind == KINDS.FIXED:
            return []
        if kind == KINDS.FREE:
            return [HeldJoint(name, "free")]
        if kind == KINDS.BALL:
            return [HeldJoint(name, "spherical", place=inner)]
        if kind not in (KINDS.REVOLUTE, KINDS.PRISMATIC, KINDS.D6):
            raise Unsupported(f"joint {name} is a {kind.name.lower()} joint, which descriptions do not have")
        linear, angular = self.index["joint_dof_dim"][joint].tolist()
        start = int(self.index["joint_qd_start"][joint])
        held = []
        for k in range(linear + angular):
            axis = self.held["joint_axis"][start + k]
            own = name if linear + angular == 1 else f"{name}/{k}"
            type_ = "prismatic" if k < linear else "revolute"
            held.append(HeldJoint(own, type_, axis / np.linalg.norm(axis), place=inner, dofs=self._dofs(start + k)))
        return held

    def _dofs(self, dof: int) -> dict[str, Array]:
        names = {"armature": "joint_armature", "damping": "joint_damping", "friction": "joint_friction"}
        limits = {
            "lower": "joint_limit_lower",
            "upper": "joint_limit_upper",
            "velocity": "joint_velocity_limit",
            "effort": "joint_effort_limit",
        }
        dofs = {key: self.held[name][[dof]] for key, name in (names | limits).items()}
        none = {key for key in limits if abs(dofs[key][0]) >= (EFFORT if key in ("effort", "velocity") else newton.MAXVAL)}
        return {key: np.array([inf]) if key in none else value for key, value in dofs.items()}

    def inertial(self, name: str) -> Held | None:
        """Find what the model holds of a link."""
        return self._mass(self.bodies.index(name)) if self.bodies.count(name) == 1 else None


def _place(pose: Array) -> Place:
    """Read a pose in single. Its rotation is made one in double: that of a quaternion of nearly length one."""
    return Place(nearest_rotation(rotation(pose[3:] / np.linalg.norm(pose[3:]))), pose[:3].copy())


def read(path: Path, form: str, base: str, make: Callable[[Description, Read], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description and what was read."""
    notes: list[Header] = []
    builder = newton.ModelBuilder()
    with overheard(path, notes):
        if form == "urdf":
            builder.add_urdf(str(path), floating=base == "free")
        elif form == "mjcf":
            builder.add_mjcf(str(path))
        else:
            stage = Usd.Stage.Open(str(path))
            stage.Reload()  # of a file that was written again OpenUSD keeps the first text
            builder.add_usd(stage)
        model = builder.finalize()
    if not model.body_count:
        raise ValueError(f"Newton holds no body of {path.name}")
    got = Read(model)
    names = [] if form == "usd" else moving(path)
    links = loaded(got.links, notes, names)
    links = bad_values.zeroed(links)[0] if form == "usd" else bad_values.left_out(path, form, links, notes)
    description = describe(path.stem, np.array(model.gravity.numpy()[0], dtype=float), links)
    if form == "urdf":
        notes.extend(edited(path, got.inertial))
    if form == "mjcf":
        notes.extend(not_compared(path))
        if any("gravity" in option.attrib for option in elements(path, "option")):
            notes.append(note("gravity_ignored", None, "add_mjcf does not take the gravity of the file"))
    held = Description.read(description)
    return Reading(description, held, notes, make(held, got), {})
