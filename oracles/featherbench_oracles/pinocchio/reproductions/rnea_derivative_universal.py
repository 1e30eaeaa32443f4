"""Pinocchio's derivative of inverse dynamics by q with a universal joint, against central differences of its own inverse dynamics."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

STEP = 1e-6  # the differences are good to about 1e-9, the deviation is larger than 1e-3


def deviation(seed: int) -> float:
    """Largest error of dtau/dq over its largest entry."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    parent = 0
    for k, kind in enumerate((pin.JointModelRY(), pin.JointModelUniversal(*np.eye(3)[:2]), pin.JointModelRX())):
        parent = model.addJoint(parent, kind, pin.SE3(np.eye(3), random.uniform(-1, 1, 3)), f"joint {k}")
        model.appendBodyToJoint(parent, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.diag([1.0, 2.0, 2.5])), pin.SE3.Identity())
    data = model.createData()
    q, v, a = (random.uniform(-1, 1, model.nv) for _ in range(3))
    analytic = pin.computeRNEADerivatives(model, data, q, v, a)[0].copy()

    def torque(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array(pin.rnea(model, data, at, v, a))

    columns = [(torque(q + STEP * unit) - torque(q - STEP * unit)) / (2 * STEP) for unit in np.eye(model.nv)]
    return float(np.abs(analytic - np.array(columns).T).max() / np.abs(columns).max())
