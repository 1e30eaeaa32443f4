"""MuJoCo's M of a light link far from the robot's centre of mass: its entry for the last joint does not depend on q, and is off."""

import mujoco
import numpy as np


def deviation(seed: int) -> float:
    """Error of the last diagonal entry of M over that entry, the link's inertia about its own axis, m r² + I; the worst of 100 poses."""
    random = np.random.default_rng(seed)
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    trunk = spec.worldbody.add_body(name="trunk")
    trunk.add_freejoint()
    trunk.explicitinertial, trunk.mass, trunk.inertia = True, 100.0, [5.0, 5.0, 5.0]
    link = trunk.add_body(name="link", pos=random.uniform(0.5, 1.0, 3))
    axis, radius, moment = np.eye(3)[2], random.uniform(0.01, 0.02), 1e-6
    link.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
    link.explicitinertial, link.mass, link.ipos, link.inertia = True, 0.05, [radius, 0, 0], [moment] * 3
    model = spec.compile()
    data = mujoco.MjData(model)
    exact = 0.05 * radius**2 + moment
    mass, worst = np.empty((model.nv, model.nv)), 0.0
    for _ in range(100):
        quaternion = random.normal(size=4)
        data.qpos = np.concatenate([np.zeros(3), quaternion / np.linalg.norm(quaternion), random.uniform(-np.pi, np.pi, 1)])
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        worst = max(worst, abs(mass[-1, -1] - exact) / exact)
    return float(worst)
