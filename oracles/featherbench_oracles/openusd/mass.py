"""Mass properties of a body: what its `MassAPI` says, and what OpenUSD computes of colliders where it says nothing.

`RigidBodyAPI.ComputeMassProperties` sums colliders, and wants volume and inertia of each. Of a body without colliders it gives no principal
axes, and a mass of −1 if there is none: these become the identity and 0.
"""

from __future__ import annotations

import numpy as np
from pxr import Gf, Usd, UsdPhysics

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import inertial, note, turned
from featherbench_oracles.openusd.solids import Solid, solid
from featherbench_oracles.openusd.units import Units, vector

SINGLE = 4e-6  # relative: the rounding of a product R diag R' whose factors are single, some ten times 2⁻²³
EXACT = "newton:inertia"  # xx, yy, zz, xy, xz, yz about the centre of mass, in double: the schema's own attributes are single
Held = tuple[float, Array, Array]


def mass_of(body: Usd.Prim, units: Units, notes: list[Header]) -> Held:
    """Read mass, centre of mass and inertia of a body.

    Parameters
    ----------
    body : Usd.Prim
        With a `RigidBodyAPI`.
    units : Units
        Of its stage.
    notes : list of dict
        Gets a note if something was computed, or is said twice.

    Returns
    -------
    mass : float
        In kg.
    com : ndarray, shape (3,)
        In the body's axes, m.
    inertia : ndarray, shape (3, 3)
        About the centre of mass, in the body's axes, kg m².
    """
    said = UsdPhysics.MassAPI(body)
    mass, com, moments = said.GetMassAttr().Get() or 0.0, said.GetCenterOfMassAttr().Get(), said.GetDiagonalInertiaAttr().Get()
    axes = said.GetPrincipalAxesAttr().Get()
    placed = com is not None and bool(np.isfinite(vector(com)).all())
    whole = mass > 0 and placed and moments is not None and vector(moments).any()
    if not whole:
        colliders: list[Solid] = []

        def measured(collider: Usd.Prim) -> UsdPhysics.RigidBodyAPI.MassInformation:
            colliders.append(solid(collider, body))
            return colliders[-1].information()

        mass, moments, com, axes = UsdPhysics.RigidBodyAPI(body).ComputeMassProperties(measured)
        if mass <= 0 and not colliders:  # neither a mass nor a shape
            mass, moments, com, axes = 0.0, Gf.Vec3f(0), Gf.Vec3f(0), Gf.Quatf(1)
        if not colliders:
            axes = said.GetPrincipalAxesAttr().Get()
    turn = _turn(axes)
    held = float(mass) * units.mass, units.length * vector(com), units.inertia * (turn * vector(moments)) @ turn.T
    name = body.GetName()
    if not whole and float(mass):
        computed = f"{name} says not all of mass, centre of mass and inertia: OpenUSD computes it"
        notes.append(note("from_geometry", name, computed, inertial(*held)))
    return held[0], held[1], _exact(body, units, held, notes)


def _turn(axes: Gf.Quatf | None) -> Array:
    """Read principal axes; four zeros are none."""
    numbers = [axes.GetReal(), *axes.GetImaginary()] if axes is not None else [0.0]
    return turned(*numbers) if any(numbers) else np.eye(3)


def _exact(body: Usd.Prim, units: Units, held: Held, notes: list[Header]) -> Array:
    """Take the inertia in double where the stage has it as well, and both are the same."""
    given = body.GetAttribute(EXACT)
    six = given.Get() if given and given.HasAuthoredValue() else None
    if six is None or len(six) != 6:
        return held[2]
    xx, yy, zz, xy, xz, yz = (float(x) for x in six)
    exact = units.inertia * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if np.abs(exact - held[2]).max() <= SINGLE * np.abs(held[2]).max():
        return exact
    notes.append(note("warning", body.GetName(), f"{EXACT} and physics:diagonalInertia of {body.GetName()} differ: the latter is taken"))
    return held[2]
