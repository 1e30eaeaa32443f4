"""MuJoCo's own parser and compiler, and what the model then holds. A file is compiled as users of MuJoCo compile it.

A URDF is read with MuJoCo's defaults. Bodies of fixed joints are fused into their parents, and visual geometry is discarded. The root link
is a part of the world for a fixed base, and gets a free joint for a free base. If the compiler rejects a file, it is compiled again:

- without the meshes that are not found;
- then with balanceinertia;
- then with lower bounds of mass and inertia.

A note says so. The equality constraints of an MJCF are the description's `loops`; the answers are those of the tree.

Positions are MuJoCo's own (`qpos`): a hinge with a `ref` is at its place in the file when its coordinate is `ref`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco as mj
import numpy as np

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.attributes import not_compared
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading
from featherbench_oracles.core.reading import (
    HeldJoint,
    Link,
    Place,
    describe,
    inertial,
    listed,
    moving,
    note,
    overheard,
    turned,
    without_free_armature,
)
from featherbench_oracles.core.robot import Description
from featherbench_oracles.mujoco.loops import loops
from featherbench_oracles.mujoco.variants import variants

# Without this MuJoCo writes MUJOCO_LOG.TXT into the current folder.
mj.set_mju_user_warning(lambda text: print(f"warning: {text}", file=sys.stderr))

BOUND = 1e-6  # kg and kg m², if the compiler rejects a file without bounds
DIAGONALISED = 64 * np.finfo(float).eps  # of an inertia: error of MuJoCo's iteration for principal axes (18 eps on a link of xarm7)
EDITED = 1e-9  # relative difference of a mass or inertia that is reported as an edit; MuJoCo's own rounding is a few eps
TYPES = {
    mj.mjtJoint.mjJNT_HINGE: "revolute",
    mj.mjtJoint.mjJNT_SLIDE: "prismatic",
    mj.mjtJoint.mjJNT_BALL: "spherical",
    mj.mjtJoint.mjJNT_FREE: "free",
}


def read(path: Path, form: str, base: str, make: Callable[[Description, mj.MjModel], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description and MuJoCo's model."""
    notes: list[Header] = []
    floating = form == "urdf" and base == "free"
    with overheard(path, notes):
        spec, model, settings, given = _compiled(path, floating, notes)
        # a second time only if a link was fused: the time of compiling grows with the cube of the number of bodies
        whole_spec, whole = _unfused(path, floating, settings) if model.nbody < given else (spec, model)
    _note_edits(whole_spec, whole, notes)
    if form == "mjcf":
        notes.extend(not_compared(path))
        _note_armature(model, notes)
    if form == "urdf":
        notes.extend(mimics.tell(path, _mimics(model), "a joint of its own with an equality constraint", "a joint of its own"))
    names = [_named(model.body(i).name, "body", i) for i in range(model.nbody)]
    links = loaded(without_free_armature([_link(spec, model, names, i) for i in range(1, model.nbody)], notes), notes, moving(path))
    gravity = np.zeros(3) if model.opt.disableflags & mj.mjtDisableBit.mjDSBL_GRAVITY else model.opt.gravity
    description = describe(spec.modelname or path.stem, gravity, bad_values.left_out(path, form, links, notes))
    written = None
    if form == "mjcf" and (_balance in settings or _bound in settings):
        written = describe(spec.modelname or path.stem, gravity, bad_values.left_out(path, form, _as_written(whole_spec, whole), []))
    if floating and not any(body["joint"]["type"] == "free" for body in description["bodies"]):
        notes.append(note("root_welded", None, "the file has no single root link that could float"))
    _add_fused_frames(description, names, whole, notes)
    if form == "mjcf" and model.neq:
        description["loops"] = loops(model, names, description, notes)
        if written is not None:
            written["loops"] = description["loops"]
    keyframes = {_named(model.key(i).name, "key", i): neutral_q(model, model.key_qpos[i]) for i in range(model.nkey)}
    _without_extras(model)
    held = Description.read(description)
    return Reading(description, held, notes, make(held, model), keyframes, written)


def variants_of(path: Path) -> list[Header]:
    """List the variants of an MJCF that MuJoCo compiles as it is written; of another there are none."""
    spec, model, settings, _ = _compiled(path, False, [])
    return [] if settings else variants(path, _described, model, _described(spec, model))


def _described(spec: mj.MjSpec, model: mj.MjModel) -> Header:
    """Describe a compiled model."""
    names = [_named(model.body(i).name, "body", i) for i in range(model.nbody)]
    links, _ = bad_values.zeroed(without_free_armature([_link(spec, model, names, i) for i in range(1, model.nbody)], []))
    gravity = np.zeros(3) if model.opt.disableflags & mj.mjtDisableBit.mjDSBL_GRAVITY else model.opt.gravity
    return describe(spec.modelname or "variant", gravity, links)


def neutral_q(model: mj.MjModel, qpos: Array) -> Array:
    """Convert MuJoCo's positions back: quaternions end with w.

    Parameters
    ----------
    model : mj.MjModel
        The model.
    qpos : ndarray, shape (nq,)
        MuJoCo's coordinates, m, rad or quaternions.

    Returns
    -------
    ndarray, shape (nq,)
        Neutral coordinates.
    """
    q = np.array(qpos)
    for number, start in zip(model.jnt_type, model.jnt_qposadr, strict=True):
        kind = TYPES[mj.mjtJoint(number)]
        if kind in ("spherical", "free"):
            last = slice(start, start + 4) if kind == "spherical" else slice(start + 3, start + 7)
            q[last] = np.roll(qpos[last], -1)
    return q


# ---- the compiler ----------------------------------------------------------------------------------------------------------------


Setting = Callable[[mj.MjSpec], None]


def _balance(spec: mj.MjSpec) -> None:
    """Repair inertias that violate the triangle inequality."""
    spec.compiler.balanceinertia = True


def _bound(spec: mj.MjSpec) -> None:
    """Repair inertias, and give every body at least the mass and inertia `BOUND`."""
    _balance(spec)
    spec.compiler.boundmass = spec.compiler.boundinertia = BOUND


def _without_files(spec: mj.MjSpec) -> None:
    """Delete what comes from other files: meshes and height fields with their geoms, skins, textures with their materials."""
    for geom in spec.geoms:
        geom.material = ""
        if geom.meshname or geom.hfieldname:
            spec.delete(geom)
    for site in spec.sites:
        site.material = ""
    for tendon in spec.tendons:
        tendon.material = ""
    for group in (spec.skins, spec.meshes, spec.hfields, spec.materials, spec.textures):
        for element in group:
            spec.delete(element)


# the settings that are tried if the compiler rejects a file, in this order: the note's cause, the setting, its description
REMEDIES: tuple[tuple[str, Setting, str], ...] = (
    ("geometry_dropped", _without_files, "meshes, height fields, skins and textures were dropped, as not all of their files can be read"),
    ("balanceinertia", _balance, "balanceinertia was needed: it gives a body of unphysical inertia three equal moments"),
    ("bounds", _bound, f"balanceinertia, and boundmass and boundinertia of {BOUND}, were needed"),
)


def _compiled(path: Path, floating: bool, notes: list[Header]) -> tuple[mj.MjSpec, mj.MjModel, list[Setting], int]:
    """Compile a file. Returns the spec, the model, the settings that were needed, and the number of bodies in the file with the world."""
    settings: list[Setting] = []
    remedies, tried = list(REMEDIES), []
    while True:
        spec = _loaded(path, floating, settings)
        given = len(spec.bodies)
        try:
            model = spec.compile()
            break
        except ValueError as reason:
            refusal = " ".join(str(reason).split())
        if remedies and remedies[0][1] is _without_files and "file" not in refusal.lower():  # files are opened first
            remedies.pop(0)
        if not remedies:
            raise ValueError(f"MuJoCo refuses the file: {refusal}")
        cause, setting, text = remedies.pop(0)
        settings.append(setting)
        tried.append(note(cause, None, f"{text}; MuJoCo said: {refusal}"))
    notes.extend(n for n in tried if n["cause"] != "balanceinertia" or tried[-1] is n)
    return spec, model, settings, given


def _loaded(path: Path, floating: bool, settings: list[Setting]) -> mj.MjSpec:
    """Load the spec of the file, without compiling it."""
    spec = mj.MjSpec.from_file(str(path))
    for setting in settings:
        setting(spec)
    roots = spec.worldbody.bodies
    if floating and len(roots) == 1 and not roots[0].joints:
        roots[0].add_freejoint(name="root_joint")
    return spec


def _unfused(path: Path, floating: bool, settings: list[Setting]) -> tuple[mj.MjSpec, mj.MjModel]:
    """Compile without fusing links. The result shows where fused links are, and what was edited link by link."""
    spec = _loaded(path, floating, settings)
    spec.compiler.fusestatic = False
    for joint in spec.joints:  # a free joint below a link is allowed only if the link is fused into the world
        if joint.type == mj.mjtJoint.mjJNT_FREE and joint.parent.parent.name != spec.worldbody.name:
            spec.delete(joint)
    return spec, spec.compile()


# ---- the model -------------------------------------------------------------------------------------------------------------------


def _named(name: str, kind: str, i: int) -> str:
    """Return the name, or make one."""
    return name or f"{kind} {i}"


def _place(model: mj.MjModel, i: int) -> Place:
    """Find the placement of body i in its parent."""
    return Place(turned(*model.body_quat[i]), model.body_pos[i].copy())


def _inertial_frame(model: mj.MjModel, i: int) -> Place:
    """Find the centre of mass and principal axes of body i that MuJoCo uses: within 1e-6 of the body's frame it uses that frame."""
    same, kinds = model.body_sameframe[i], mj.mjtSameFrame
    axes = np.eye(3) if same in (kinds.mjSAMEFRAME_BODY, kinds.mjSAMEFRAME_BODYROT) else turned(*model.body_iquat[i])
    return Place(axes, np.zeros(3) if same == kinds.mjSAMEFRAME_BODY else model.body_ipos[i].copy())


def _inertia(model: mj.MjModel, i: int) -> Array:
    """Compute body i's inertia about its centre of mass in its axes: R diag(principal moments) R'."""
    axes = _inertial_frame(model, i).rotation
    return (axes * model.body_inertia[i]) @ axes.T


def _as_written(spec: mj.MjSpec, model: mj.MjModel) -> list[Link]:
    """List the links with the inertials of the file, in place of those that the compiler repaired.

    A link without an inertial has the mass of its geometry, or none.
    """
    names = [_named(model.body(i).name, "body", i) for i in range(model.nbody)]
    links = without_free_armature([_link(spec, model, names, i) for i in range(1, model.nbody)], [])
    for body in spec.bodies[1:]:
        mass, com, inertia = _given(body, model)
        links[body.id - 1] = replace(links[body.id - 1], mass=mass, com=com, inertia=inertia)
    return links


def _given(body: mj.MjsBody, model: mj.MjModel) -> tuple[float, Array, Array]:
    """Find mass, centre of mass and inertia of a link in the file; those of the model if the file leaves them to geometry."""
    i = body.id
    held = float(model.body_mass[i]), _inertial_frame(model, i).translation, _inertia(model, i)
    if not body.explicitinertial:
        return held if body.geoms else (0.0, np.zeros(3), np.zeros((3, 3)))
    six = _given_inertia(body)
    if six is not None and not _edited(six, held[2]):
        six = held[2]  # the compiler's rounding is no repair
    if six is None:  # the file has principal moments; the compiler keeps their axes
        axes = turned(*model.body_iquat[i])
        six = (axes * body.inertia) @ axes.T
    return float(body.mass), np.array(body.ipos), six


def _edited(given: Array, held: Array) -> bool:
    """Whether two inertias differ by more than rounding."""
    return not np.abs(given - held).max() <= EDITED * np.abs(given).max()  # NaN is an edit


def _given_inertia(body: mj.MjsBody) -> Array | None:
    """Find the inertia of the file in body axes, if the spec still holds it."""
    six = body.fullinertia
    if not body.explicitinertial or not np.isfinite(six).all() or body.ialt.type != mj.mjtOrientation.mjORIENTATION_QUAT:
        return None
    axes = turned(*body.iquat)
    xx, yy, zz, xy, xz, yz = six
    return axes @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ axes.T


def _link(spec: mj.MjSpec, model: mj.MjModel, names: list[str], i: int) -> Link:
    """Describe body i of the model.

    If the compiler's principal axes give the file's inertia within rounding, the numbers of the file are used.
    """
    inertia = _inertia(model, i)
    body = spec.body(model.body(i).name) if model.body(i).name else None
    given = _given_inertia(body) if body is not None else None
    if given is not None and np.abs(given - inertia).max() <= DIAGONALISED * np.abs(given).max():
        inertia = given
    joints = [_joint(model, j) for j in range(model.body_jntadr[i], model.body_jntadr[i] + model.body_jntnum[i])]
    place = Place() if joints and joints[0].type == "free" else _place(model, i)  # a free joint's coordinates are relative to the world
    parent = int(model.body_parentid[i]) - 1
    return Link(names[i], float(model.body_mass[i]), _inertial_frame(model, i).translation, inertia, parent, place, joints)


def _joint(model: mj.MjModel, j: int) -> HeldJoint:
    """Describe joint j."""
    kind = TYPES[mj.mjtJoint(model.jnt_type[j])]
    dof = model.jnt_dofadr[j]
    span = slice(dof, dof + {"spherical": 3, "free": 6}.get(kind, 1))
    dofs = {"armature": model.dof_armature[span], "damping": model.dof_damping[span], "friction": model.dof_frictionloss[span]}
    with_axis = kind in ("revolute", "prismatic")
    if with_axis and model.jnt_limited[j]:
        dofs["lower"], dofs["upper"] = model.jnt_range[j][:1], model.jnt_range[j][1:]
    low, high = model.jnt_actfrcrange[j]
    if with_axis and model.jnt_actfrclimited[j] and low == -high:
        dofs["effort"] = model.jnt_actfrcrange[j][1:]
    return HeldJoint(
        _named(model.joint(j).name, "joint", j),
        kind,
        axis=model.jnt_axis[j].copy() if with_axis else None,
        place=Place(translation=np.zeros(3) if kind == "free" else model.jnt_pos[j].copy()),
        zero=float(model.qpos0[model.jnt_qposadr[j]]) if with_axis else 0.0,
        dofs={key: value.copy() for key, value in dofs.items()},
    )


def _add_fused_frames(description: Header, names: list[str], whole: mj.MjModel, notes: list[Header]) -> None:
    """Add frames for the links that the compiler fused into others."""
    bodies = {body["name"]: k for k, body in enumerate(description["bodies"])}
    frames = {frame["name"]: (frame["body"], Place.of(frame["placement"])) for frame in description["frames"]}
    homes: dict[int, tuple[int, Place]] = {0: (-1, Place())}
    fused = []
    for i in range(1, whole.nbody):
        name = _named(whole.body(i).name, "body", i)
        if name in names:
            homes[i] = frames.get(name, (bodies.get(name, -1), Place()))
            continue
        body, on_body = homes[int(whole.body_parentid[i])]
        homes[i] = body, on_body @ _place(whole, i)
        description["frames"].append({"name": name, "body": body, "placement": homes[i][1].json()})
        fused.append(name)
    if fused:
        notes.append(note("fused", None, f"{len(fused)} links of fixed joints were fused into their parents: {listed(fused)}"))


def _without_extras(model: mj.MjModel) -> None:
    """Remove from the model all but bodies, joints, gravity and joint armature: the neutral quantities include nothing else."""
    disable = mj.mjtDisableBit
    model.opt.disableflags |= disable.mjDSBL_CONSTRAINT | disable.mjDSBL_CONTACT | disable.mjDSBL_AUTORESET
    model.opt.disableflags |= disable.mjDSBL_SPRING | disable.mjDSBL_DAMPER | disable.mjDSBL_ACTUATION | disable.mjDSBL_SENSOR
    model.opt.enableflags = 0
    model.opt.density = model.opt.viscosity = 0
    held = [model.body_gravcomp, model.tendon_armature, model.actuator_armature]
    for j in range(model.njnt):
        if model.jnt_type[j] == mj.mjtJoint.mjJNT_FREE:
            held.append(model.dof_armature[model.jnt_dofadr[j] : model.jnt_dofadr[j] + 6])
    wrong = bad_values.bad(model.dof_armature)
    changed = wrong.any() or any(numbers.any() for numbers in held)
    for numbers in held:
        numbers[:] = 0
    model.dof_armature[wrong] = 0
    if changed:  # updates what depends on them; its time grows with the cube of the number of bodies
        mj.mj_setConst(model, mj.MjData(model))


def _mimics(model: mj.MjModel) -> dict[str, mimics.Mimic | None]:
    """Find the joints that follow others by an equality, with the coefficients. One with higher powers is no mimic of a URDF."""
    found: dict[str, mimics.Mimic | None] = {}
    for k in range(model.neq):
        if model.eq_type[k] == mj.mjtEq.mjEQ_JOINT and model.eq_obj2id[k] >= 0 and model.eq_active0[k]:
            follower, leader = (model.joint(int(ids[k])) for ids in (model.eq_obj1id, model.eq_obj2id))
            offset, multiplier, *_ = model.eq_data[k, :5].tolist()
            found[follower.name] = mimics.Mimic(leader.name, multiplier, offset)
    return found


# ---- notes -----------------------------------------------------------------------------------------------------------------------


def _note_edits(spec: mj.MjSpec, model: mj.MjModel, notes: list[Header]) -> None:
    """Note every link whose mass or inertia differs from the file's."""
    for body in spec.bodies[1:]:
        i, name = body.id, _named(body.name, "body", body.id)
        com, inertia = _inertial_frame(model, i).translation, _inertia(model, i)
        held = inertial(model.body_mass[i], com, inertia)
        if not body.explicitinertial and body.geoms:
            if model.body_mass[i]:
                computed = f"it has no inertial: {model.body_mass[i]:.6g} kg were computed from its geometry"
                notes.append(note("from_geometry", name, computed, held))
            continue
        given = _given(body, model)
        numbers = [*inertial(*given), *held]  # those of the file, then those of the model
        if not body.explicitinertial:
            if model.body_mass[i]:
                notes.append(note("mass_edited", name, f"no inertial in the file became {model.body_mass[i]} kg", numbers))
            continue
        if not abs(model.body_mass[i] - body.mass) <= EDITED * body.mass:
            notes.append(note("mass_edited", name, f"{body.mass} kg in the file became {model.body_mass[i]} kg", numbers))
        if _edited(given[2], inertia):
            notes.append(note("inertia_edited", name, f"{_six(given[2])} in the file became {_six(inertia)} kg m²", numbers))
        if (com != model.body_ipos[i]).any():
            moved = f"MuJoCo computes as if the centre of mass, {tuple(model.body_ipos[i].tolist())}, were the origin, as it is within 1e-6"
            notes.append(note("com_edited", name, moved))


def _six(inertia: Array) -> str:
    """Write the six numbers of an inertia as text."""
    return "(" + ", ".join(f"{x:.6g}" for x in inertia[np.triu_indices(3)]) + ")"


def _note_armature(model: mj.MjModel, notes: list[Header]) -> None:
    """Note the armature that tendons and actuators add to M, which descriptions do not have."""
    part = "is a part of MuJoCo's M; it is left out"
    for i in np.flatnonzero(model.tendon_armature).tolist():
        added = f"armature {model.tendon_armature[i]:.6g} of the tendon times the square of its moments {part}"
        notes.append(note("tendon_armature", _named(model.tendon(i).name, "tendon", i), added, [model.tendon_armature[i]]))
    for i in np.flatnonzero(model.actuator_armature).tolist():
        armature, gear = float(model.actuator_armature[i]), float(model.actuator_gear[i, 0])
        added = f"armature {armature:.6g} of the actuator times the square of its gear {gear:.6g} {part}"
        notes.append(note("actuator_armature", _named(model.actuator(i).name, "actuator", i), added, [armature * gear**2]))
