"""A robot in USD, by OpenUSD's own parser of the physics schemas, `UsdPhysics.LoadUsdPhysicsFromRange`.

Bodies are the prims with an enabled `RigidBodyAPI`. A body without a joint to another one or to the world floats. So does the root of an
articulation that nothing holds. The tree begins at the world, then at the articulation's root, then at the first body of the file. Joints
that close a loop are told. Siblings are in the order of their joints on the stage.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom, UsdPhysics

from featherbench_oracles.core import bad_values
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, note, overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.openusd.joints import UsdJoint, joints
from featherbench_oracles.openusd.mass import mass_of
from featherbench_oracles.openusd.units import Units, vector

EARTH = 9.81  # m/s², of a scene that says no magnitude
WORLD = Sdf.Path.emptyPath
TYPES = UsdPhysics.ObjectType


def read(path: Path) -> Reading:
    """Read a file as `abilities.ReadsFiles` says."""
    notes: list[Header] = []
    with overheard(path, notes), warnings.catch_warnings(category=DeprecationWarning, action="ignore"):
        try:
            stage = Usd.Stage.Open(str(path))
            stage.Reload()  # of a file that was written again OpenUSD keeps the first text
        except Tf.ErrorException as error:
            raise ValueError(_said(error)) from None
        parsed = UsdPhysics.LoadUsdPhysicsFromRange(stage, [stage.GetPseudoRoot().GetPath()])
        _told(stage, notes)
        units = Units.of(stage)
        links = loaded(_links(stage, parsed, units, notes), notes, [])
    links, left = bad_values.zeroed(links)
    for (name, field), values in left.items():
        notes.append(note("bad_value", name, f"joint '{name}' has {field} {values[0]:.6g}, which no joint can have; it is left out"))
    if not links:
        raise ValueError(f"{path.name} has no rigid body")
    robot = stage.GetDefaultPrim().GetName() if stage.GetDefaultPrim() else path.stem
    description = describe(robot, _gravity(stage, parsed, units, notes), links)
    return Reading(description, Description.read(description), notes, None, {})


def _said(error: Tf.ErrorException) -> str:
    """Shorten OpenUSD's message to what it says of the file."""
    lines = [line.split(" : ", 1)[-1].strip(" '\t") for line in str(error).splitlines() if " : " in line]
    return re.sub(r" matching pxr.*? at ", " at ", "; ".join(lines) or str(error))  # the parser's own names


def _told(stage: Usd.Stage, notes: list[Header]) -> None:
    """Note what a reader may choose otherwise: variants, and files that the stage does not find."""
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        sets = prim.GetVariantSets()
        for name in sets.GetNames():
            chosen, others = sets.GetVariantSelection(name) or "none", ", ".join(sets.GetVariantSet(name).GetVariantNames())
            notes.append(note("warning", prim.GetName(), f"{prim.GetPath()} has the variant {chosen} of {name} ({others})"))
    for layer in stage.GetUsedLayers():
        for asset in layer.GetCompositionAssetDependencies():
            if asset and not Sdf.Layer.FindOrOpenRelativeToLayer(layer, asset):
                notes.append(note("warning", None, f"{layer.GetDisplayName()} names {asset}, which is not found"))


def _gravity(stage: Usd.Stage, parsed: dict[Any, Any], units: Units, notes: list[Header]) -> Array:
    """Read the gravity of the first scene; without any it is that of the schema, 9.81 m/s² down."""
    paths, scenes = parsed.get(TYPES.Scene, ((), ()))
    if not scenes:
        up = "XYZ".index(str(UsdGeom.GetStageUpAxis(stage)))
        return np.where(np.arange(3) == up, -EARTH, 0.0)
    if len(paths) > 1:
        notes.append(note("warning", None, f"there are {len(paths)} scenes, and the first gives gravity"))
    said = UsdPhysics.Scene.Get(stage, paths[0])
    enabled = said.GetPrim().GetAttribute("newton:gravityEnabled")
    if enabled and enabled.Get() is False:
        return np.zeros(3)
    magnitude = said.GetGravityMagnitudeAttr().Get()
    size = units.length * magnitude if np.isfinite(magnitude) and magnitude >= 0 else EARTH
    direction = vector(scenes[0].gravityDirection)
    return size * direction / (np.linalg.norm(direction) or 1.0)


def _links(stage: Usd.Stage, parsed: dict[Any, Any], units: Units, notes: list[Header]) -> list[Link]:
    """List the bodies depth-first, each with what carries it."""
    order = {prim.GetPath(): k for k, prim in enumerate(stage.Traverse(Usd.TraverseInstanceProxies()))}
    held = dict(zip(*parsed.get(TYPES.RigidBody, ((), ())), strict=True))
    bodies = sorted((path for path, body in held.items() if body.rigidBodyEnabled), key=order.__getitem__)
    names = _names(bodies)
    along = _adjacent(sorted(joints(stage, parsed, units, notes), key=lambda joint: order[joint.prim.GetPath()]), bodies, notes)
    world = UsdGeom.XformCache()
    links: list[Link] = []
    index = {WORLD: -1}
    used: set[Sdf.Path] = set()

    def add(path: Sdf.Path, parent: int, place: Place, by: list[HeldJoint]) -> None:
        index[path] = len(links)
        links.append(Link(names[path], *mass_of(stage.GetPrimAtPath(path), units, notes), parent, place, by))

    def onward(path: Sdf.Path) -> Iterator[tuple[Sdf.Path, Sdf.Path, list[UsdJoint], int]]:
        for joint, child in along.get(path, ()):
            if joint.prim.GetPath() not in used:
                together = _stacked(stage, [other for other, side in along[path] if other.ends == joint.ends and side == child], joint)
                used.update(one.prim.GetPath() for one in together)
                yield joint.ends[child], path, together, child

    kinematic = [path for path in bodies if held[path].kinematicBody]
    roots = [path for path in bodies if stage.GetPrimAtPath(path).HasAPI(UsdPhysics.ArticulationRootAPI)]
    for start in [WORLD, *kinematic, *roots, *bodies]:
        if start != WORLD and start in index:
            continue
        if start in kinematic:
            notes.append(note("root_welded", names[start], f"{names[start]} is kinematic, so it stays where it is"))
            matrix = world.GetLocalToWorldTransform(stage.GetPrimAtPath(start)).RemoveScaleShear()
            add(start, -1, units.place(matrix.ExtractRotationQuat(), matrix.ExtractTranslation()), [])
        elif start != WORLD:
            add(start, -1, Place(), [HeldJoint(f"{names[start]} root" if links else "root_joint", "free")])
        ahead = list(reversed(list(onward(start))))
        while ahead:
            path, parent, together, child = ahead.pop()
            if path in index:
                closing = ", ".join(joint.name for joint in together)
                notes.append(note("not_compared", None, f"joint {closing} closes a loop"))
                continue
            add(path, index[parent], together[0].place(child), [one for joint in together if (one := joint.held(child, units))])
            ahead.extend(reversed(list(onward(path))))
    return links


def _names(bodies: list[Sdf.Path]) -> dict[Sdf.Path, str]:
    """Name bodies by their prims; prims of one name by their paths."""
    names = [path.name for path in bodies]
    return {path: path.name if names.count(path.name) == 1 else str(path) for path in bodies}


def _adjacent(found: list[UsdJoint], bodies: list[Sdf.Path], notes: list[Header]) -> dict[Sdf.Path, list[tuple[UsdJoint, int]]]:
    """List the joints of the tree at each body, with the side that is its neighbour."""
    along: dict[Sdf.Path, list[tuple[UsdJoint, int]]] = {}
    known = {WORLD, *bodies}
    for joint in found:
        first, second = joint.ends
        if first == second or not {first, second} <= known:
            notes.append(note("not_compared", joint.name, f"joint {joint.name} does not tie two bodies that move, or one and the world"))
        elif not joint.in_tree:
            notes.append(note("not_compared", joint.name, f"joint {joint.name} is not of the articulation: it constrains"))
        else:
            along.setdefault(first, []).append((joint, 1))
            along.setdefault(second, []).append((joint, 0))
    return along


def _stacked(stage: Usd.Stage, between: list[UsdJoint], joint: UsdJoint) -> list[UsdJoint]:
    """List the joints between the same two bodies that are one after another, if the articulation says that they add mobility."""
    roots = (prim for prim in stage.Traverse(Usd.TraverseInstanceProxies()) if prim.HasAPI(UsdPhysics.ArticulationRootAPI))
    adds = any((given := root.GetAttribute("newton:jointsAddMobility")) and given.Get() for root in roots)
    return between if adds else [joint]
