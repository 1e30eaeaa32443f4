"""Pinocchio's lcaba where the world is the first body of a constraint: the process ends by a signal. constraintDynamics takes it."""

import os

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """Whether a child process that calls lcaba ends by a signal."""
    random = np.random.default_rng(seed)
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), "joint")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.eye(3)), pin.SE3.Identity())
    held = pin.SE3(np.eye(3), random.uniform(-1, 1, 3))
    models, data = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    models.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 0, held, joint, held, pin.ReferenceFrame.LOCAL))
    data.append(models[0].createData())
    of_model, v = model.createData(), np.zeros(3)
    pin.computeJointMinimalOrdering(model, of_model, models)
    child = os.fork()
    if child == 0:
        pin.lcaba(model, of_model, pin.neutral(model), v, v, models, data, pin.ProximalSettings(1e-10, 1e-10, 1e-6, 20))
        os._exit(0)
    return float(os.WIFSIGNALED(os.waitpid(child, 0)[1]))
