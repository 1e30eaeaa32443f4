"""The joints of a stage, as OpenUSD's own parser gives them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite, radians
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdPhysics

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import HeldJoint, Place, note
from featherbench_oracles.openusd.units import Units

LARGEST = 3.4e38  # a number beyond is infinite: the largest single is written for no limit
DOFS = UsdPhysics.JointDOF
SLIDES = {DOFS.TransX: 0, DOFS.TransY: 1, DOFS.TransZ: 2}
TURNS = {DOFS.RotX: 0, DOFS.RotY: 1, DOFS.RotZ: 2}


@dataclass(frozen=True)
class UsdJoint:
    """A joint of a stage.

    Attributes
    ----------
    prim : Usd.Prim
        The joint.
    ends : tuple of Sdf.Path
        The body of each side; the empty path is the world.
    places : tuple of Place
        The joint's frame in the axes of each side.
    type : str
        As in a description, or `fixed`.
    axis : ndarray, shape (3,), optional
        In the joint's frame.
    lower, upper : float
        The limits of the coordinate, m or rad.
    in_tree : bool
        Whether the file wants it in the articulation.
    """

    prim: Usd.Prim
    ends: tuple[Sdf.Path, Sdf.Path]
    places: tuple[Place, Place]
    type: str
    axis: Array | None
    lower: float
    upper: float
    in_tree: bool

    @property
    def name(self) -> str:
        """The name of its prim."""
        return str(self.prim.GetName())

    def place(self, child: int) -> Place:
        """Place the body of a side in that of the other, at the coordinate zero."""
        return self.places[1 - child] @ self.places[child].inverse()

    def held(self, child: int, units: Units) -> HeldJoint | None:
        """Describe it with a side as the child. A joint whose child is its body 0 turns the other way; a fixed one is none."""
        if self.type == "fixed":
            return None
        axis, lower, upper = self.axis, self.lower, self.upper
        if child == 0 and axis is not None:
            axis, lower, upper = -axis, -upper, -lower
        dofs = {key: value for key, value in self._dofs(units).items() if isfinite(value)}
        size = {"spherical": 3, "free": 6, "planar": 3}.get(self.type, 1)
        held = {key: np.full(size, value) for key, value in dofs.items()}
        if axis is not None:
            held |= {key: np.array([value]) for key, value in (("lower", lower), ("upper", upper)) if isfinite(value)}
        return HeldJoint(self.name, self.type, axis, place=self.places[child], dofs=held)

    def _dofs(self, units: Units) -> dict[str, float]:
        """Read armature, damping, friction and limits, in SI units."""
        turns = self.type in ("revolute", "spherical")
        effort, angle = (units.inertia, radians(1)) if turns else (units.mass * units.length, units.length)
        inertia = units.inertia if turns else units.mass
        found = {
            "armature": (inertia, ["newton:armature", "physxJoint:armature"]),
            "damping": (effort / angle, ["newton:damping"]),
            "friction": (effort, ["newton:friction"]),
            "velocity": (angle, ["newton:velocityLimit", "physxJoint:maxJointVelocity"]),
            "effort": (1.0, ["urdf:limit:effort"]),  # as in the URDF, whatever the units of the stage
        }
        held = {
            key: (unit, next((number for name in names if (number := self._number(name)) is not None), None))
            for key, (unit, names) in found.items()
        }
        return {key: unit * number if abs(number) < LARGEST else inf for key, (unit, number) in held.items() if number is not None}

    def _number(self, name: str) -> float | None:
        given = self.prim.GetAttribute(name)
        return float(given.Get()) if given and given.HasAuthoredValue() else None


def joints(stage: Usd.Stage, parsed: dict[Any, Any], units: Units, notes: list[Header]) -> list[UsdJoint]:
    """Read the joints that act.

    Parameters
    ----------
    stage : Usd.Stage
        The stage.
    parsed : dict
        Of `UsdPhysics.LoadUsdPhysicsFromRange`.
    units : Units
        Of the stage.
    notes : list of dict
        Gets a note of each joint that descriptions do not have.

    Returns
    -------
    list of UsdJoint
        In no order.
    """
    kinds: dict[Any, Callable[[Any, Units], Kind]] = {
        UsdPhysics.ObjectType.RevoluteJoint: _revolute,
        UsdPhysics.ObjectType.PrismaticJoint: _prismatic,
        UsdPhysics.ObjectType.SphericalJoint: lambda *_: ("spherical", None, -inf, inf),
        UsdPhysics.ObjectType.FixedJoint: lambda *_: ("fixed", None, -inf, inf),
        UsdPhysics.ObjectType.D6Joint: _generic,
    }
    found = []
    for kind, of_kind in kinds.items():
        for path, held in zip(*parsed.get(kind, ((), ())), strict=True):
            if not held.jointEnabled:
                notes.append(note("not_compared", path.name, f"joint {path.name} is disabled"))
                continue
            places = (
                units.place(held.localPose0Orientation, held.localPose0Position),
                units.place(held.localPose1Orientation, held.localPose1Position),
            )
            ends = held.body0, held.body1
            found.append(UsdJoint(stage.GetPrimAtPath(path), ends, places, *of_kind(held, units), not held.excludeFromArticulation))
    for kind in (UsdPhysics.ObjectType.DistanceJoint, UsdPhysics.ObjectType.CustomJoint):
        for path in parsed.get(kind, ((), ()))[0]:
            notes.append(
                note(
                    "not_compared",
                    path.name,
                    f"joint {path.name} is a {stage.GetPrimAtPath(path).GetTypeName()}, which is no joint of a tree",
                )
            )
    return found


Kind = tuple[str, Array | None, float, float]


def _axis(held: Any) -> Array:
    return np.eye(3)[[UsdPhysics.Axis.X, UsdPhysics.Axis.Y, UsdPhysics.Axis.Z].index(held.axis)]


def _limits(limit: UsdPhysics.JointLimit, unit: float) -> tuple[float, float]:
    ends = (limit.lower, limit.upper) if limit.enabled else (-inf, inf)
    lower, upper = (float(np.sign(end)) * inf if abs(end) >= LARGEST else unit * end for end in ends)
    return lower, upper


def _revolute(held: Any, _: Units) -> Kind:
    return "revolute", _axis(held), *_limits(held.limit, radians(1))


def _prismatic(held: Any, units: Units) -> Kind:
    return "prismatic", _axis(held), *_limits(held.limit, units.length)


def _generic(held: Any, units: Units) -> Kind:
    """Find what a generic joint leaves free: an axis is locked if its lower limit is above the upper."""
    limits = dict.fromkeys([*SLIDES, *TURNS])
    limits |= {pair.first: pair.second for pair in held.jointLimits if pair.first in limits}
    free = {dof: limit for dof, limit in limits.items() if limit is None or not limit.enabled or limit.lower <= limit.upper}
    slides, turns = [dof for dof in free if dof in SLIDES], [dof for dof in free if dof in TURNS]
    if not free:
        return "fixed", None, -inf, inf
    if len(free) == 1:
        (dof, limit), kind = next(iter(free.items())), "revolute" if turns else "prismatic"
        place, unit = (TURNS[dof], radians(1)) if turns else (SLIDES[dof], units.length)
        return kind, np.eye(3)[place], *(_limits(limit, unit) if limit is not None else (-inf, inf))
    known = {(0, 3): "spherical", (3, 3): "free"}
    return known.get((len(slides), len(turns)), f"generic with {len(slides)} translations and {len(turns)} rotations"), None, -inf, inf
