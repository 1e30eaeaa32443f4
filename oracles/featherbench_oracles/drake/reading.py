"""Drake's own parser, and what the plant then holds. The continuous plant has no scene graph, so `Parser` needs no meshes.

Drake keeps the links of fixed joints as bodies. They are merged in the description. A body of an MJCF with several joints has bodies of
Drake's own between them. They get the names that such bodies have in a description. Drake's log becomes notes with the cause `warning`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody import tree
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.edits import Held, edited
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, elements, moving, note, overheard, roots
from featherbench_oracles.core.robot import Description

TYPES = {
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "helical",
    "ball_rpy": "spherical",
    "quaternion_floating": "free",
    "planar": "planar",
    "universal": "universal",
}


def read(path: Path, form: str, base: str, make: Callable[[Description, MultibodyPlant, list[list[tree.Joint]]], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the plant and each body's joint."""
    notes: list[Header] = []
    plant = MultibodyPlant(0.0)
    with overheard(path, notes):
        Parser(plant).AddModels(str(path))
        if form == "urdf":
            _stand(plant, path, base, notes)
        damping = {joint.index(): joint.default_damping_vector().copy() for joint in _joints(plant)}
        for joint in _joints(plant):
            joint.set_default_damping_vector(np.zeros(joint.num_velocities()))
        plant.Finalize()
    joints = _ordered(plant)
    names = [plant.GetModelInstanceName(tree.ModelInstanceIndex(i)) for i in range(2, plant.num_model_instances())]
    links = loaded(_links(plant, joints, damping), notes, moving(path))
    named = _chained(links, path) if form == "mjcf" else links
    description = describe(
        next(iter(names), path.stem), plant.gravity_field().gravity_vector(), bad_values.left_out(path, form, named, notes)
    )
    own = {after.name for before, after in zip(links, named, strict=True) if before.name != after.name}  # not links of the file
    description["frames"] = [frame for frame in description["frames"] if frame["name"] not in own]
    _note_rotors(plant, notes)
    if form == "urdf":
        notes.extend(edited(path, partial(_inertial, plant)))
        notes.extend(_mimics(path, plant))
    elif plant.num_constraints():
        notes.append(note("not_compared", None, f"constraints: {plant.num_constraints()}"))
    if form == "mjcf":
        notes.extend(not_compared(path))
    held = Description.read(description)
    return Reading(description, held, notes, make(held, plant, [[joint] for joint in joints if joint.num_velocities()]), {})


def _mimics(path: Path, plant: MultibodyPlant) -> list[Header]:
    """Note what became of each mimic. A plant gives the number of its constraints, and not what they tie."""
    followers = [name for name, _ in mimics.written(path)]
    count = plant.num_constraints()
    held: dict[str, mimics.Mimic | None] = dict.fromkeys(followers if count == len(followers) else ())
    left = f"Drake has {count} coupler constraints for {len(followers)} mimics, and does not tell which"
    return mimics.tell(path, held, "a joint of its own with a coupler constraint", left if count else "Drake has no constraint for it")


def _note_rotors(plant: MultibodyPlant, notes: list[Header]) -> None:
    """Note each actuator that reflects the inertia of its rotor to its joint by a gear."""
    for motor in (plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()):
        rotor, gear = motor.default_rotor_inertia(), motor.default_gear_ratio()
        if rotor and gear != 1:
            held = f"the actuator '{motor.name()}' has the rotor inertia {rotor:.6g} and the gear ratio {gear:.6g}: {rotor * gear**2:.6g}"
            notes.append(note("rotor_inertia", motor.joint().name(), held, [rotor, gear]))


# ---- the plant -------------------------------------------------------------------------------------------------------------------


def _joints(plant: MultibodyPlant) -> list[tree.Joint]:
    """List all joints, fixed ones included."""
    return [plant.get_joint(i) for i in plant.GetJointIndices()]


def _stand(plant: MultibodyPlant, path: Path, base: str, notes: list[Header]) -> None:
    """Weld a URDF's root link to the world for a fixed base. A root with the name `world` is the world already."""
    for root in roots(path):
        if root == "world" and base == "free":
            notes.append(note("root_welded", root, "Drake takes a link called world for the world"))
        if root != "world" and base == "fixed":
            plant.WeldFrames(plant.world_frame(), plant.GetBodyByName(root).body_frame(), RigidTransform())


def _ordered(plant: MultibodyPlant) -> list[tree.Joint]:
    """List the joints depth-first, siblings by their place among the velocities."""
    below: dict[int, list[tree.Joint]] = {}
    for joint in _joints(plant):
        below.setdefault(int(joint.parent_body().index()), []).append(joint)
    order: list[tree.Joint] = []
    bodies = [plant.world_body()]
    pending: list[tree.Joint] = []
    while bodies:
        children = below.get(int(bodies.pop().index()), [])
        pending.extend(sorted(children, key=lambda joint: joint.velocity_start(), reverse=True))
        if pending:
            order.append(pending.pop())
            bodies.append(order[-1].child_body())
    q = v = 0
    for joint in order:
        if joint.num_velocities() and (joint.position_start(), joint.velocity_start()) != (q, v):
            raise RuntimeError(f"Drake put the coordinates of joint {joint.name()} elsewhere than depth-first")
        q, v = q + joint.num_positions(), v + joint.num_velocities()
    return order


def _place(pose: RigidTransform) -> Place:
    return Place(pose.rotation().matrix().copy(), pose.translation().copy())


def _links(plant: MultibodyPlant, joints: list[tree.Joint], damping: dict[Any, Array]) -> list[Link]:
    """List the bodies as links, each with its joint to the parent."""
    context = plant.CreateDefaultContext()
    index = {int(plant.world_body().index()): -1}
    motors = [plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()]
    actuators = {motor.joint().index(): motor for motor in motors}
    links = []
    for k, joint in enumerate(joints):
        body = joint.child_body()
        index[int(body.index())] = k
        outer = _place(joint.frame_on_parent().GetFixedPoseInBodyFrame())
        inner = _place(joint.frame_on_child().GetFixedPoseInBodyFrame())
        held = []
        if joint.type_name() == "weld":
            outer = outer @ _place(joint.X_FM())
        else:
            held = [_held(joint, inner, damping.get(joint.index(), np.zeros(joint.num_velocities())), actuators.get(joint.index()))]
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        mass, com = inertia.get_mass(), inertia.get_com().copy()
        about_com = inertia.CalcRotationalInertia().CopyToFullMatrix3() + mass * skew(com) @ skew(com)
        place = outer if inner.identical() else outer @ inner.inverse()
        links.append(Link(body.name(), mass, com, about_com, index[int(joint.parent_body().index())], place, held))
    return links


def _held(joint: tree.Joint, inner: Place, damping: Array, actuator: tree.JointActuator | None) -> HeldJoint:
    """Describe a joint. Its armature is the rotor inertia of its actuator times the square of the gear ratio."""
    kind = TYPES.get(joint.type_name(), joint.type_name())
    dofs = {"damping": damping, "velocity": joint.velocity_upper_limits().copy()}
    if joint.num_positions() == joint.num_velocities() and kind != "spherical":
        dofs |= {"lower": joint.position_lower_limits().copy(), "upper": joint.position_upper_limits().copy()}
    if actuator is not None:
        dofs["armature"] = np.array([actuator.default_rotor_inertia() * actuator.default_gear_ratio() ** 2])
        dofs["effort"] = np.array([actuator.effort_limit()])
    axes = {"revolute": "revolute_axis", "prismatic": "translation_axis", "helical": "screw_axis"}
    axis = np.array(getattr(joint, axes[kind])()) if kind in axes else None
    pitch = joint.screw_pitch() / (2 * pi) if kind == "helical" else 0.0
    return HeldJoint(joint.name(), kind, axis, pitch, inner, dofs=dofs)


def _chained(links: list[Link], path: Path) -> list[Link]:
    """Give bodies that are not in the file the names of a description: `<link>/<joint>`, where the link is the next one outwards."""
    known = {body.get("name") for body in elements(path, "body")}
    renamed, below = list(links), ""
    for k in reversed(range(len(links))):
        link = links[k]
        own = k + 1 < len(links) and link.name not in known and not link.mass and links[k + 1].parent == k
        if own and link.joints:
            renamed[k] = replace(link, name=f"{below}/{link.joints[0].name}")
        else:
            below = link.name
    return renamed


def _inertial(plant: MultibodyPlant, name: str) -> Held | None:
    """Find what the plant holds of a link."""
    if name == "world" or not plant.HasBodyNamed(name):
        return None
    held = plant.GetBodyByName(name).CalcSpatialInertiaInBodyFrame(plant.CreateDefaultContext())
    mass, com = held.get_mass(), held.get_com()
    return mass, com, held.CalcRotationalInertia().CopyToFullMatrix3() + mass * skew(com) @ skew(com)
