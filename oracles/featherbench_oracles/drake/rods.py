"""A rod in Drake: rigid links with revolute joints and torsion springs."""

from __future__ import annotations

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.abilities.rods import Rod, RodTable
from featherbench_oracles.core.algebra import Array


class HingeChain:
    """Rigid links with a revolute joint in the middle of each element, whose spring is EI/h.

    Parameters
    ----------
    rod : Rod
        The rod.
    """

    def __init__(self, rod: Rod) -> None:
        self.dofs, h = rod.count, rod.length / rod.count
        self.plant = MultibodyPlant(0.0)
        self.plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
        body, self.springs = self.plant.world_body(), []
        for link in range(rod.count):
            long = 0.5 * h if link + 1 == rod.count else h
            unit = tree.UnitInertia(0.0, long**2 / 3, long**2 / 3)
            inertia = tree.SpatialInertia(rod.mass_per_length * long, np.array([0.5 * long, 0, 0]), unit, skip_validity_check=True)
            child = self.plant.AddRigidBody(f"link{link}", inertia)
            place = tree.FixedOffsetFrame(f"mount{link}", body.body_frame(), _along(h if link else 0.5 * h))
            parent = self.plant.AddFrame(place)
            joint = self.plant.AddJoint(tree.RevoluteJoint(f"hinge{link}", parent, child.body_frame(), np.array([0, 0, 1.0])))
            self.springs.append(self.plant.AddForceElement(tree.RevoluteSpring(joint, 0.0, rod.bending / h)))
            body = child
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        self.last, self.end = body, np.array([0.5 * h, 0, 0])

    def _place(self, q: Array) -> None:
        """Set the configuration at rest."""
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, np.zeros(self.dofs))

    def imbalance(self, q: Array, force: float) -> Array:
        """Add what the springs and a force along y at the tip leave."""
        self._place(q)
        forces = tree.MultibodyForces(self.plant)
        self.plant.CalcForceElementsContribution(self.context, forces)
        world = self.plant.world_frame()
        jacobian = self.plant.CalcJacobianTranslationalVelocity(
            self.context, tree.JacobianWrtVariable.kV, self.last.body_frame(), self.end, world, world
        )
        return jacobian[1] * force - self.plant.CalcInverseDynamics(self.context, np.zeros(self.dofs), forces)

    def tip(self, q: Array) -> Array:
        """Read the tip's place."""
        self._place(q)
        place = self.plant.CalcPointsPositions(self.context, self.last.body_frame(), self.end, self.plant.world_frame())
        return np.asarray(place).ravel()[:2]

    def mass(self) -> Array:
        """Read M."""
        self._place(np.zeros(self.dofs))
        return self.plant.CalcMassMatrix(self.context)

    def stiffness(self) -> Array:
        """Read the springs."""
        return np.diag([spring.default_stiffness() for spring in self.springs])

    def accelerate(self, q: Array) -> None:
        """Compute the accelerations; a new configuration makes what Drake keeps out of date."""
        self.plant.SetPositions(self.context, q)
        self.plant.get_generalized_acceleration_output_port().Eval(self.context)


def _along(x: float) -> RigidTransform:
    """Make a placement along x."""
    return RigidTransform(np.array([x, 0, 0.0]))


RODS: RodTable = {"hinge_chain": HingeChain}
