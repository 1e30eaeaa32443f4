"""Pinocchio's computeKineticEnergy on a revolute joint with a skew axis leaves the armature out, which crba puts into M."""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """|T - v'Mv/2| over v'Mv/2."""
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis)), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.eye(3)), pin.SE3.Identity())
    model.armature = np.array([1.0])
    data = model.createData()
    q, v = random.uniform(-1, 1, 1), random.uniform(0.5, 1, 1)
    energy = v @ pin.crba(model, data, q) @ v / 2
    return float(abs(pin.computeKineticEnergy(model, data, q, v) - energy) / energy)
