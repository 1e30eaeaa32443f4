"""Volume, centre and inertia of colliders, each at the density one, as `RigidBodyAPI.ComputeMassProperties` wants them."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported

AXES = "XYZ"


@dataclass(frozen=True)
class Solid:
    """A collider in its body's axes, in units of the stage.

    Attributes
    ----------
    volume : float
        Of the solid.
    com : ndarray, shape (3,)
        Its centre.
    inertia : ndarray, shape (3, 3)
        About its centre, at the density one.
    """

    volume: float
    com: Array
    inertia: Array

    def information(self) -> UsdPhysics.RigidBodyAPI.MassInformation:
        """Write it as OpenUSD wants it, in the axes of the body."""
        result = UsdPhysics.RigidBodyAPI.MassInformation()
        result.volume, result.inertia = self.volume, Gf.Matrix3f(*self.inertia.ravel().tolist())
        result.centerOfMass, result.localPos, result.localRot = Gf.Vec3f(*self.com.tolist()), Gf.Vec3f(0), Gf.Quatf(1)
        return result


def solid(collider: Usd.Prim, body: Usd.Prim) -> Solid:
    """Measure a collider.

    Parameters
    ----------
    collider : Usd.Prim
        A sphere, cube, cylinder, capsule, cone or closed mesh.
    body : Usd.Prim
        The body that carries it.

    Returns
    -------
    Solid
        In the body's axes. The body's own scale counts.

    Raises
    ------
    Unsupported
        If it is of another kind, or scaled so that it is no such solid any more.
    """
    cache = UsdGeom.XformCache()
    local = cache.GetLocalToWorldTransform(collider) * _rigid(cache.GetLocalToWorldTransform(body)).GetInverse()
    matrix = np.array(local)  # acts on rows
    linear, origin = matrix[:3, :3].T, matrix[3, :3]
    if collider.IsA(UsdGeom.Mesh):
        return _mesh(UsdGeom.Mesh(collider), linear, origin)
    if collider.IsA(UsdGeom.Cube):
        size = UsdGeom.Cube(collider).GetSizeAttr().Get()
        return _moved(size**3, np.zeros(3), np.eye(3) * size**5 / 6, linear, origin)
    if collider.IsA(UsdGeom.Sphere):
        radius = UsdGeom.Sphere(collider).GetRadiusAttr().Get()
        return _moved(4 * pi * radius**3 / 3, np.zeros(3), np.eye(3) * 4 * pi * radius**5 / 15, linear, origin)
    return _round(collider, linear, origin)


def _round(collider: Usd.Prim, linear: Array, origin: Array) -> Solid:
    """Measure a solid of revolution by its second moments: ∫ x², ∫ y², ∫ z² with the axis in z."""
    centre = 0.0
    if collider.IsA(UsdGeom.Cylinder):
        shape = UsdGeom.Cylinder(collider)
        r, h = shape.GetRadiusAttr().Get(), shape.GetHeightAttr().Get()
        volume = pi * r**2 * h
        across, along = volume * r**2 / 4, volume * h**2 / 12
    elif collider.IsA(UsdGeom.Capsule):
        shape = UsdGeom.Capsule(collider)
        r, h = shape.GetRadiusAttr().Get(), shape.GetHeightAttr().Get()
        rod, ball = pi * r**2 * h, 4 * pi * r**3 / 3
        volume = rod + ball
        across = rod * r**2 / 4 + ball * r**2 / 5
        along = rod * h**2 / 12 + ball * (r**2 / 5 + h**2 / 4 + 3 * h * r / 8)
        if not np.allclose(linear @ linear.T, np.eye(3) * np.linalg.det(linear) ** (2 / 3)):
            raise Unsupported(f"the capsule {collider.GetPath()} is scaled by different factors, so it is none any more")
    elif collider.IsA(UsdGeom.Cone):
        shape = UsdGeom.Cone(collider)
        r, h = shape.GetRadiusAttr().Get(), shape.GetHeightAttr().Get()
        volume, centre = pi * r**2 * h / 3, -h / 4
        across, along = volume * 3 * r**2 / 20, volume * 3 * h**2 / 80
    else:
        raise Unsupported(f"the volume of {collider.GetPath()}, which is a {collider.GetTypeName()}, is not computed here")
    place = AXES.index(shape.GetAxisAttr().Get())
    second = np.full(3, across)
    second[place] = along
    com = np.zeros(3)
    com[place] = centre
    return _moved(volume, com, np.diag(second.sum() - second), linear, origin)


def _moved(volume: float, com: Array, inertia: Array, linear: Array, origin: Array) -> Solid:
    """Place a solid by a linear map and an origin: its second moments turn and stretch with it."""
    second = np.trace(inertia) / 2 * np.eye(3) - inertia
    factor = abs(float(np.linalg.det(linear)))
    second = factor * linear @ second @ linear.T
    return Solid(factor * volume, linear @ com + origin, np.trace(second) * np.eye(3) - second)


def _mesh(mesh: UsdGeom.Mesh, linear: Array, origin: Array) -> Solid:
    """Measure a closed mesh: the sum over the pyramids from the origin to its triangles."""
    points = np.array(mesh.GetPointsAttr().Get() or [], dtype=float).reshape(-1, 3) @ linear.T + origin
    counts, indices = mesh.GetFaceVertexCountsAttr().Get() or [], list(mesh.GetFaceVertexIndicesAttr().Get() or [])
    volume, first, second, at = 0.0, np.zeros(3), np.zeros((3, 3)), 0
    for count in counts:
        face = points[indices[at : at + count]]
        at += count
        for k in range(1, count - 1):
            corners = face[[0, k, k + 1]]
            part = float(np.linalg.det(corners)) / 6
            middle = corners.sum(axis=0)
            volume += part
            first += part * middle / 4
            second += part / 20 * (np.outer(middle, middle) + corners.T @ corners)
    if volume == 0:
        raise Unsupported(f"the mesh {mesh.GetPath()} has no volume")
    com = first / volume
    second = np.sign(volume) * (second - volume * np.outer(com, com))
    return Solid(abs(volume), com, np.trace(second) * np.eye(3) - second)


def _rigid(transform: Gf.Matrix4d) -> Gf.Matrix4d:
    """Take the scale out of a transform."""
    return Gf.Matrix4d(transform.RemoveScaleShear())
