"""MuJoCo's MjSpec drops the principal axes of a full inertia when the body has no inertial position (`ipos` left unset)."""

import mujoco
import numpy as np


def deviation(seed: int) -> float:
    """Largest error of the compiled inertia about the body's axes over its largest entry."""
    random = np.random.default_rng(seed)
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
    inertia = axes @ np.diag([1.0, 1.5, 2.0]) @ axes.T
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="rod", mass=1.0, explicitinertial=True)
    body.fullinertia = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    body.add_joint(name="ball", type=mujoco.mjtJoint.mjJNT_BALL)
    model = spec.compile()
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    principal = turn.reshape(3, 3)
    held = principal @ np.diag(model.body_inertia[1]) @ principal.T
    return float(np.abs(held - inertia).max() / np.abs(inertia).max())
