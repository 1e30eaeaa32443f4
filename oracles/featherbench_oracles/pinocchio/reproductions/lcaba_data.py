"""Pinocchio's constraintDynamics after lcaba with the same Data: the accelerations are those without the constraint."""

import numpy as np
import pinocchio as pin


def deviation(seed: int) -> float:
    """|a after lcaba - a with Data of its own| / |a with Data of its own|. Three hinges, and the last body is held in the world."""
    random = np.random.default_rng(seed)
    model, joint = pin.Model(), 0
    for k in range(3):
        joint = model.addJoint(joint, pin.JointModelRY(), pin.SE3(np.eye(3), random.uniform(0.5, 1, 3)), f"{k}")
        model.appendBodyToJoint(joint, pin.Inertia(1.0, random.uniform(-1, 1, 3), np.eye(3)), pin.SE3.Identity())
    q, nothing = random.uniform(-1, 1, 3), np.zeros(3)
    first = model.createData()
    pin.forwardKinematics(model, first, q)
    models, kind, there = pin.StdVec_RigidConstraintModel(), pin.ContactType.CONTACT_3D, first.oMi[joint]
    models.append(pin.RigidConstraintModel(kind, model, joint, pin.SE3.Identity(), 0, there, pin.ReferenceFrame.LOCAL))

    def accelerations(*calls: str) -> list[np.ndarray]:
        data, of_models = model.createData(), pin.StdVec_RigidConstraintData()
        of_models.append(models[0].createData())
        pin.initConstraintDynamics(model, data, models, of_models)
        pin.computeJointMinimalOrdering(model, data, models)
        settings = [pin.ProximalSettings(1e-10, 1e-10, 1e-6, 50) for _ in calls]
        arguments = (model, data, q, nothing, nothing, models, of_models)
        return [getattr(pin, call)(*arguments, one).copy() for call, one in zip(calls, settings, strict=True)]

    (alone,) = accelerations("constraintDynamics")
    _, after = accelerations("lcaba", "constraintDynamics")
    return float(np.linalg.norm(after - alone) / np.linalg.norm(alone))
