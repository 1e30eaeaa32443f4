"""Pinocchio's aba in the WORLD convention, a kilometre away from the world's origin: digits go as (distance/size) squared."""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """Difference of the accelerations between the conventions WORLD and LOCAL over their size; LOCAL does not see where it stands."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    parent = 0
    for k in range(6):
        axis = random.normal(size=3)
        at = random.uniform(-0.3, 0.3, 3) + (np.array([1e3, 0, 0]) if k == 0 else 0)
        parent = model.addJoint(parent, pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis)), pin.SE3(np.eye(3), at), f"joint {k}")
        model.appendBodyToJoint(parent, pin.Inertia(1.0, random.uniform(-0.1, 0.1, 3), 0.01 * np.eye(3)), pin.SE3.Identity())
    data = model.createData()
    q, v, tau = random.uniform(-np.pi, np.pi, 6), random.uniform(-1, 1, 6), random.uniform(-1, 1, 6)
    local = pin.aba(model, data, q, v, tau, pin.Convention.LOCAL).copy()
    world = pin.aba(model, data, q, v, tau, pin.Convention.WORLD).copy()
    return float(np.linalg.norm(world - local) / np.linalg.norm(local))
