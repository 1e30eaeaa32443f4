"""What the reproductions about the Coriolis matrix share: an arm with one joint of the questioned type in its middle."""

import numpy as np
import pinocchio as pin


def coriolis_deviation(joint: pin.JointModel, seed: int) -> float:
    """The worst of ten states: |C v + g - h| over |h|, where h is Pinocchio's own bias force, which is right."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    parent = 0
    for k, kind in enumerate((pin.JointModelRY(), joint, pin.JointModelRX())):
        placement = pin.SE3(np.eye(3), random.uniform(-1, 1, 3))
        parent = model.addJoint(parent, kind, placement, f"joint {k}")
        model.appendBodyToJoint(parent, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.diag([1.0, 2.0, 2.5])), pin.SE3.Identity())
    data = model.createData()
    worst = 0.0
    for _ in range(10):
        q, v = random.uniform(-1, 1, model.nq), random.uniform(-1, 1, model.nv)
        bias = pin.nonLinearEffects(model, data, q, v).copy()
        gravity = pin.computeGeneralizedGravity(model, data, q).copy()
        matrix = pin.computeCoriolisMatrix(model, data, q, v)
        worst = np.maximum(worst, np.linalg.norm(matrix @ v + gravity - bias) / np.linalg.norm(bias))  # max() would lose a NaN
    return float(worst)
