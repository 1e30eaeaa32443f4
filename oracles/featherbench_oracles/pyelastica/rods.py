"""A rod in PyElastica: nodes with masses, and elements with directors; the first element is held, as PyElastica clamps a rod."""

from __future__ import annotations

import numpy as np
from elastica.rod.cosserat_rod import CosseratRod

from featherbench_oracles.abilities.inextensible import nodes, on_angles, straight_mass, straight_stiffness
from featherbench_oracles.abilities.rods import Rod, RodTable
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported

# The section is a circle of this radius over the length. It enters by E alone, and by rotary inertia, which is left out.
RADIUS = 0.01
# PyElastica asks for more than two elements.
FEWEST_ELEMENTS = 3


class HeldDirector:
    """Cosserat elements whose first has its node and its director held: PyElastica's condition of one fixed end.

    Directors are along the elements, which keep their lengths: the coordinates are the angles of the elements but the first.

    Parameters
    ----------
    rod : Rod
        The rod.
    """

    def __init__(self, rod: Rod) -> None:
        if rod.count < FEWEST_ELEMENTS:
            raise Unsupported(f"a rod of PyElastica has {FEWEST_ELEMENTS} elements or more")
        self.dofs, self.edge = rod.count - 1, rod.length / rod.count
        radius = RADIUS * rod.length
        area = np.pi * radius**2
        young = rod.bending / (area * radius**2 / 4)
        self.rod = CosseratRod.straight_rod(
            rod.count,
            np.zeros(3),
            np.array([1.0, 0.0, 0.0]),
            np.array([0.0, 0.0, 1.0]),
            rod.length,
            radius,
            rod.mass_per_length / area,
            youngs_modulus=young,
            shear_modulus=young / 2,
        )
        # Elements neither stretch nor shear: what their stiffness makes of rounding is no force.
        self.rod.shear_matrix[:] = 0.0

    def _place(self, q: Array) -> Array:
        """Set the configuration at rest, and compute internal forces. Returns the angles of all elements."""
        angles = np.concatenate([[0.0], q])
        self.rod.position_collection[:2] = nodes(angles, self.edge).T
        cos, sin = np.cos(angles), np.sin(angles)
        # Rows are the normal, the binormal and the tangent, as `straight_rod` has them.
        self.rod.director_collection[1, :2] = sin, -cos
        self.rod.director_collection[2, :2] = cos, sin
        self.rod.compute_internal_forces_and_torques(0.0)
        return angles

    def imbalance(self, q: Array, force: float) -> Array:
        """Add what the internal forces and moments and a force along y at the tip leave."""
        angles = self._place(q)
        forces = self.rod.internal_forces[:2].T.copy()
        forces[-1, 1] += force
        # The normal is the world's z: a moment about it is the first of the element's axes.
        return (on_angles(angles, self.edge, forces) + self.rod.internal_torques[0])[1:]

    def tip(self, q: Array) -> Array:
        """Read the tip's place."""
        self._place(q)
        return self.rod.position_collection[:2, -1].copy()

    def mass(self) -> Array:
        """Read the nodes' masses."""
        return straight_mass(self.rod.mass, self.edge)[1:, 1:]

    def stiffness(self) -> Array:
        """Differentiate the internal moments."""
        return straight_stiffness(self)

    def accelerate(self, q: Array) -> None:
        """Compute internal forces and accelerations."""
        self.rod.compute_internal_forces_and_torques(0.0)
        self.rod.update_accelerations(0.0, 0.0)


RODS: RodTable = {"held_director": HeldDirector}
