"""Drake's ball, weld and distance constraints on the world body: a step of the plant ends the process by a signal."""

import os

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator


def deviation(seed: int) -> float:
    """The share of the three kinds with which a child process that makes a step ends by a signal."""
    point, ended = np.random.default_rng(seed).uniform(-1, 1, 3), 0
    for kind in range(3):
        plant = MultibodyPlant(1e-3)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        body, world = plant.AddRigidBody("body", SpatialInertia.SolidSphereWithMass(1.0, 0.1)), plant.world_body()
        if kind == 0:
            plant.AddBallConstraint(world, point, body, point)
        elif kind == 1:
            plant.AddWeldConstraint(world, RigidTransform(), body, RigidTransform())
        else:
            plant.AddDistanceConstraint(world, np.zeros(3), body, point, np.linalg.norm(point))
        plant.Finalize()
        child = os.fork()
        if child == 0:
            Simulator(plant).AdvanceTo(0.0015)
            os._exit(0)
        ended += os.WIFSIGNALED(os.waitpid(child, 0)[1])
    return ended / 3
