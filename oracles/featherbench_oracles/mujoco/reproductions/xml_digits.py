"""MuJoCo writes numbers into XML with six digits: a robot that went through MjSpec.to_xml has another mass matrix."""

import mujoco
import numpy as np
from numpy.typing import NDArray


def mass_matrix(spec: mujoco.MjSpec, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """M of the compiled specification at q."""
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos = q
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return mass


def deviation(seed: int) -> float:
    """Largest scaled error of M after writing and reading."""
    random = np.random.default_rng(seed)
    spec = mujoco.MjSpec()
    body = spec.worldbody
    for k in range(4):
        body = body.add_body(name=f"body {k}", pos=random.uniform(-1, 1, 3), mass=random.uniform(1, 2), ipos=random.uniform(-1, 1, 3))
        body.inertia, body.explicitinertial = random.uniform(1, 1.9, 3), True
        body.add_joint(name=f"joint {k}", axis=random.normal(size=3))
    q = random.uniform(-np.pi, np.pi, 4)
    before = mass_matrix(spec, q)
    after = mass_matrix(mujoco.MjSpec.from_string(spec.to_xml()), q)
    return float(np.abs((after - before) / np.sqrt(np.outer(np.diag(before), np.diag(before)))).max())
