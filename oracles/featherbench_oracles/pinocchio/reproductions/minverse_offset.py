"""Pinocchio's computeMinverse a kilometre away from the world's origin: digits go as (distance/size) squared."""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """Largest entry of M·computeMinverse − 1 for a base far away; M is that of the convention LOCAL, which does not see that."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    parent = 0
    for k in range(6):
        axis = random.normal(size=3)
        at = random.uniform(-0.3, 0.3, 3) + (np.array([1e3, 0, 0]) if k == 0 else 0)
        parent = model.addJoint(parent, pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis)), pin.SE3(np.eye(3), at), f"joint {k}")
        model.appendBodyToJoint(parent, pin.Inertia(1.0, random.uniform(-0.1, 0.1, 3), 0.01 * np.eye(3)), pin.SE3.Identity())
    data = model.createData()
    q = random.uniform(-np.pi, np.pi, 6)
    upper = np.triu(pin.crba(model, data, q, pin.Convention.LOCAL))
    mass = upper + np.triu(upper, 1).T
    upper = np.triu(pin.computeMinverse(model, data, q))
    inverse = upper + np.triu(upper, 1).T
    return float(np.abs(mass @ inverse - np.eye(6)).max())
