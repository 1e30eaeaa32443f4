"""MuJoCo 4.0.0: the Newton solver's sparse factor of its Hessian is wrong where rows with different descendants are merged.

The links a, c and d are hinged to the world, b to a. Equalities tie c to a, and d to b. The cost is then quadratic, so that one step of
Newton's method is the solution; with a dense Jacobian it is. MuJoCo chooses the sparse one for 60 degrees of freedom and more.
"""

import mujoco
import numpy as np


def deviation(seed: int) -> float:
    """Error of the accelerations after one step over the largest of them, against the dense Jacobian; the worst of 100 robots."""
    random = np.random.default_rng(seed)
    return max(_error(random) for _ in range(100))


def _error(random: np.random.Generator) -> float:
    spec = mujoco.MjSpec()
    bodies = {"world": spec.worldbody}
    for name, parent in {"a": "world", "b": "a", "c": "world", "d": "world"}.items():
        body = bodies[name] = bodies[parent].add_body(name=name, pos=random.normal(size=3))
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=random.normal(size=3))
        body.explicitinertial, body.mass, body.ipos, body.inertia = True, 1.0, random.normal(size=3), [0.1] * 3
    for first, second in (("c", "a"), ("d", "b")):
        tie = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT, name1=first, name2=second)
        tie.data[1] = random.normal()
    model = spec.compile()
    model.opt.solver, model.opt.iterations = mujoco.mjtSolver.mjSOL_NEWTON, 1
    dense, sparse = (_accelerations(model, kind) for kind in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE))
    return float(np.abs(sparse - dense).max() / np.abs(dense).max())


def _accelerations(model: mujoco.MjModel, jacobian: mujoco.mjtJacobian) -> np.ndarray:
    model.opt.jacobian = jacobian
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return np.array(data.qacc)
