"""A rod in SoRoMoX: a planar rod of piecewise constant strain, of which bending alone varies."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from soromox.systems import PlanarPCS
from soromox.systems.components import CrossSectionGeometry, LinkSpec
from soromox.systems.pcs.structures import PlanarPCSStructure

from featherbench_oracles.abilities.rods import Rod, RodTable
from featherbench_oracles.core.algebra import Array

# SoRoMoX's planar sections are circles with rotary inertia: of this radius over the length, its part of a frequency is below 1e-8.
SLENDER = 1e-4


class ConstantStrain:
    """Segments of constant curvature.

    Parameters
    ----------
    rod : Rod
        The rod.
    """

    def __init__(self, rod: Rod) -> None:
        radius = SLENDER * rod.length
        segment = LinkSpec(
            cross_section_geometry=CrossSectionGeometry.CIRCULAR,
            length=rod.length / rod.count,
            density=rod.mass_per_length / (np.pi * radius**2),
            reference_strain=[0.0, 1.0, 0.0],
            cross_section_coefficients=(radius,),
            cross_section_profile_types=("constant",),
            cross_section_profile_parameter_counts=(1,),
            cross_section_coefficient_names=("radius",),
            young_modulus=rod.bending / (np.pi * radius**4 / 4),
            poisson_ratio=0.0,
        )
        bending = PlanarPCSStructure(strain_selector=jnp.array([True, False, False] * rod.count))
        self.dofs = rod.count
        system = PlanarPCS.from_links([segment] * rod.count, structure=bending, gravity=jnp.zeros(2), base_pose=jnp.zeros(3), backend="jax")
        end = jnp.asarray(rod.length)
        stiffness = system.stiffness_matrix()
        # A pose is [angle, x, y].
        self._imbalance = jax.jit(lambda q, force: system.jacobian(q, end)[2] * force - stiffness @ q)
        self._tip = jax.jit(lambda q: system.forward_kinematics(q, end)[1:3])
        self._mass = jax.jit(lambda q: system.inertia_matrix(q))
        self._stiffness = stiffness
        # The state is [q, its rate].
        self._accelerate = jax.jit(lambda state: system.forward_dynamics(jnp.zeros(()), state))

    def imbalance(self, q: Array, force: float) -> Array:
        """Add what elasticity and a force along y at the tip leave."""
        return np.asarray(self._imbalance(q, force))

    def tip(self, q: Array) -> Array:
        """Read the tip's place."""
        return np.asarray(self._tip(q))

    def mass(self) -> Array:
        """Read M."""
        return np.asarray(self._mass(np.zeros(self.dofs)))

    def stiffness(self) -> Array:
        """Read K."""
        return np.asarray(self._stiffness)

    def accelerate(self, q: Array) -> None:
        """Compute the accelerations, and wait for them."""
        self._accelerate(np.concatenate([q, np.zeros(self.dofs)])).block_until_ready()


RODS: RodTable = {"constant_strain": ConstantStrain}
