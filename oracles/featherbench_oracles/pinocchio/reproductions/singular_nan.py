"""Pinocchio's aba on a robot with a massless last link, whose M is singular: NaN in the answer, and no error."""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """The share of accelerations that are not a number; an exception would be 0."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    first = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "first")
    model.appendBodyToJoint(first, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.eye(3)), pin.SE3.Identity())
    model.addJoint(first, pin.JointModelRX(), pin.SE3(np.eye(3), random.uniform(-1, 1, 3)), "massless")
    data = model.createData()
    q, v, tau = (random.uniform(-1, 1, 2) for _ in range(3))
    try:
        return float(np.isnan(pin.aba(model, data, q, v, tau)).mean())
    except Exception:
        return 0.0
