"""The units of a stage: lengths and masses in its own, angles in degrees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.reading import Place, turned


@dataclass(frozen=True)
class Units:
    """What one unit of the stage is.

    Attributes
    ----------
    length : float
        In m.
    mass : float
        In kg.
    """

    length: float
    mass: float

    @classmethod
    def of(cls, stage: Usd.Stage) -> Units:
        """Read `metersPerUnit` and `kilogramsPerUnit`. A stage that says no length has centimetres, as the schema says."""
        return cls(UsdGeom.GetStageMetersPerUnit(stage), UsdPhysics.GetStageKilogramsPerUnit(stage))

    @property
    def inertia(self) -> float:
        """In kg m²."""
        return self.mass * self.length**2

    def place(self, rotation: Gf.Quatf | Gf.Quatd, position: Gf.Vec3f | Gf.Vec3d) -> Place:
        """Read a placement, m. A quaternion of another length than one is taken by its direction."""
        return Place(turned(rotation.GetReal(), *rotation.GetImaginary()), self.length * vector(position))


def vector(held: Gf.Vec3f | Gf.Vec3d) -> Array:
    """Read three numbers."""
    return np.array([float(x) for x in held])
