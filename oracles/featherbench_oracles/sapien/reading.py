"""SAPIEN's own loader of URDF, and what the articulation then holds, in single precision.

The loader needs a renderer for shapes that are only seen: they are taken out before the articulation is built. Shapes that collide stay,
as links without an inertial get their mass from them.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.edits import Held, edited
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, moving, overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.sapien.building import placed, world

GRAVITY = np.array([0.0, 0.0, -9.81])  # of states that give none: a URDF has no gravity
KINDS = {"revolute": "revolute", "revolute_unwrapped": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
LARGE = 1e30  # PhysX's number for no limit is the largest single


def read(path: Path, base: str, make: Callable[[Description, tuple[Any, Any], list[str]], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the articulation and the links of bodies."""
    notes: list[Header] = []
    with overheard(path, notes):
        scene = world(GRAVITY)
        loader = scene.create_urdf_loader()
        loader.fix_root_link = base == "fixed"
        builder = loader.load_file_as_articulation_builder(str(path))
        for link in builder.link_builders:
            link.visual_records.clear()
        made = builder.build()
    links, bodies = _links(made, base)
    links = loaded(links, notes, moving(path))
    links = bad_values.left_out(path, "urdf", links, notes)
    description = describe(made.name or path.stem, GRAVITY, links)
    notes.extend(edited(path, lambda name: _inertial(made.find_link_by_name(name))))
    notes.extend(mimics.tell(path, {}, "", "a spring between neighbours (a fixed tendon)"))
    held = Description.read(description)
    return Reading(description, held, notes, make(held, (scene, made), bodies), {})


def _inertial(link: Any) -> Held | None:
    """Read what the articulation holds of a link."""
    if link is None:
        return None
    turn, com = placed(link.cmass_local_pose)
    return float(link.mass), com, (turn * np.array(link.inertia, dtype=float)) @ turn.T


def _links(made: Any, base: str) -> tuple[list[Link], list[str]]:
    """List the links depth first, siblings in SAPIEN's order, and the link of each body."""
    below: dict[int, list[Any]] = {}
    for link in made.links:
        below.setdefault(link.parent.index if link.parent else -1, []).append(link)
    ahead = list(reversed(below.get(-1, [])))
    places: dict[int, int] = {-1: -1}
    links: list[Link] = []
    bodies: list[str] = []
    while ahead:
        link = ahead.pop()
        joint = link.joint
        inner = Place(*placed(joint.pose_in_child))
        place = Place(*placed(joint.pose_in_parent)) @ inner.inverse()
        joints: list[HeldJoint] = []
        if link.parent is None and base == "free":
            joints, place = [HeldJoint("root", "free")], Place()
        elif joint.type in KINDS:
            joints = [HeldJoint(joint.name, KINDS[joint.type], np.array([1.0, 0.0, 0.0]), place=inner, dofs=_dofs(joint))]
        elif joint.type not in ("fixed", "undefined"):
            raise Unsupported(f"joint {joint.name} is a {joint.type} joint, which descriptions do not have")
        if joints:
            bodies.append(link.name)
        inertial = _inertial(link)
        assert inertial is not None
        places[link.index] = len(links)
        links.append(Link(link.name, *inertial, places[link.parent.index if link.parent else -1], place, joints))
        ahead.extend(reversed(below.get(link.index, [])))
    return links, bodies


def _dofs(joint: Any) -> dict[str, Any]:
    lower, upper = np.array(joint.limits, dtype=float).ravel()
    dofs = {
        "armature": np.array(joint.armature, dtype=float).ravel(),
        "damping": np.array([float(joint.damping)]),
        "friction": np.array([float(joint.friction)]),
        "lower": np.array([lower]),
        "upper": np.array([upper]),
    }
    return {key: np.array([inf]) if abs(value[0]) > LARGE else value for key, value in dofs.items()}
