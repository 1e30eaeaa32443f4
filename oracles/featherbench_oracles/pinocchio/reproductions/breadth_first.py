"""Pinocchio's crba on joints that were not added depth-first: wrong entries, and no error raised.

Two arms of two joints on one body, added level by level. Inverse dynamics does not depend on the order; its columns are the reference.
"""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """Largest scaled error of M against the columns of inverse dynamics."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    arms = [0, 0]
    for level in range(2):
        for side in range(2):
            axis = random.normal(size=3)
            placement = pin.SE3(np.eye(3), random.uniform(-1, 1, 3))
            joint = pin.JointModelRevoluteUnaligned(axis / np.linalg.norm(axis))
            arms[side] = model.addJoint(arms[side], joint, placement, f"arm {side} level {level}")
            model.appendBodyToJoint(arms[side], pin.Inertia(1.0, random.uniform(-1, 1, 3), np.eye(3)), pin.SE3.Identity())
    data = model.createData()
    q = random.uniform(-np.pi, np.pi, model.nq)
    upper = np.triu(pin.crba(model, data, q))
    mass = upper + np.triu(upper, 1).T
    zero = np.zeros(model.nv)
    gravity = pin.rnea(model, data, q, zero, zero).copy()
    columns = np.array([pin.rnea(model, data, q, zero, unit) - gravity for unit in np.eye(model.nv)])
    scale = np.sqrt(np.outer(np.diag(columns), np.diag(columns)))
    return float(np.abs((mass - columns) / scale).max())
