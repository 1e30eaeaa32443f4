"""Contacts of a robot on the ground by MuJoCo's own stage of constraint forces, `mj_fwdConstraint`.

MuJoCo solves no problem of G and b. It finds accelerations that minimise a convex function of the robot, whose contacts are soft:

    min over a   |a - a_free|^2 / 2 in the metric of M  +  s(J a - a_ref)        R = (1 - d)/d * diag(G), softness of s

Each point is a sphere of 1 um on a plane. d is the largest that MuJoCo takes, and a_ref = -J v/dt, without a pull out of the ground. So
as d goes to one the points stop in the step, as in an impact without restitution. The friction is that of the convex relaxation: a
sliding point lifts with mu times its speed. The impulses are dt times the forces.
"""

from __future__ import annotations

from functools import partial
from time import perf_counter_ns

import mujoco as mj
import numpy as np

from featherbench_oracles.abilities.contact_steps import ContactSteps, StepMethod, StepSolution
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.mujoco.building import build
from featherbench_oracles.mujoco.coordinates import change_of_velocities, to_engine_q

# The largest impedance that MuJoCo takes, whatever the distance.
IMPEDANCE = 0.9999
RADIUS = 1e-6
# A point counts as closed up to this height, m: the harness says that all are.
REACH = 1e-3
CONES = {"elliptic": mj.mjtCone.mjCONE_ELLIPTIC, "pyramidal": mj.mjtCone.mjCONE_PYRAMIDAL}
SOLVERS = {"newton": mj.mjtSolver.mjSOL_NEWTON, "cg": mj.mjtSolver.mjSOL_CG, "pgs": mj.mjtSolver.mjSOL_PGS}
INCLUDES = {
    "newton": "mj_fwdConstraint and its call through Python; J, M and the factors of M are there before",
    "cg": "mj_fwdConstraint and its call through Python; J, M and the factors of M are there before",
    "pgs": "mj_fwdConstraint and its call through Python; G is there before",
}


class MujocoStanding:
    """The robot of some steps, in all their states.

    Parameters
    ----------
    cone, solver : str
        A key of `CONES` and one of `SOLVERS`.
    steps : ContactSteps
        The robot, its points and states.
    tolerance : float
        MuJoCo's own, of the solver and of its line search.
    iterations : int
        The cap.
    """

    def __init__(self, cone: str, solver: str, steps: ContactSteps, tolerance: float, iterations: int) -> None:
        self.steps, self.solver = steps, solver
        self.model = build(steps.robot, self._add)
        option, disable = self.model.opt, mj.mjtDisableBit
        # Without a warm start every solution begins at the motion without contacts: impulses of zero.
        option.disableflags = int(disable.mjDSBL_AUTORESET | disable.mjDSBL_WARMSTART)
        option.timestep, option.cone, option.solver = steps.dt, CONES[cone], SOLVERS[solver]
        option.tolerance, option.iterations, option.impratio = tolerance, iterations, 1.0
        self.points = {self.model.geom(f"point {k}").id: k for k in range(len(steps.bodies))}
        self.data = [self._state(k) for k in range(len(steps.q))]

    def _add(self, spec: mj.MjSpec, bodies: dict[int, mj.MjsBody]) -> None:
        """Add the ground, and a small sphere at each point. Points touch the ground alone."""
        soft = {"solref": [0.0, -IMPEDANCE / self.steps.dt], "solimp": [IMPEDANCE, IMPEDANCE, 0.001, 0.5, 2.0], "margin": REACH}
        plane = mj.mjtGeom.mjGEOM_PLANE
        spec.worldbody.add_geom(name="ground", type=plane, size=[0, 0, 1], friction=[0, 0, 0], contype=1, conaffinity=0, **soft)
        for k, (body, point, friction) in enumerate(zip(self.steps.bodies, self.steps.points, self.steps.friction, strict=True)):
            if body not in bodies:
                raise Unsupported("MuJoCo has no massless body, which a point is on")
            bodies[body].add_geom(
                name=f"point {k}",
                type=mj.mjtGeom.mjGEOM_SPHERE,
                size=[RADIUS, 0, 0],
                pos=point,
                friction=[friction, 0, 0],
                condim=3,
                contype=0,
                conaffinity=1,
                **soft,
            )

    def _state(self, k: int) -> mj.MjData:
        """Make data of a state up to the stage of constraint forces."""
        steps, data = self.steps, mj.MjData(self.model)
        change = change_of_velocities(steps.robot, steps.q[k], steps.v[k])
        data.qpos = to_engine_q(steps.robot, steps.q[k])
        data.qvel = change.to_engine_v(steps.v[k])
        data.qfrc_applied = change.to_engine_tau(steps.tau[k])
        for stage in (mj.mj_fwdPosition, mj.mj_fwdVelocity, mj.mj_fwdActuation, mj.mj_fwdAcceleration):
            stage(self.model, data)
        if data.ncon != len(steps.bodies):
            raise RuntimeError(f"MuJoCo finds {data.ncon} contacts in state {k}, and {len(steps.bodies)} were given")
        return data

    def solve(self, state: int) -> StepSolution:
        """Time `mj_fwdConstraint`, and read the contact forces."""
        data = self.data[state]
        start = perf_counter_ns()
        mj.mj_fwdConstraint(self.model, data)
        spent = perf_counter_ns() - start
        impulses, force = np.zeros((len(self.steps.bodies), 3)), np.zeros(6)
        for k in range(data.ncon):
            contact = data.contact[k]
            mj.mj_contactForce(self.model, data, k, force)
            # Rows of the frame are the normal, which points from the ground to the point, and the tangents.
            x, y, z = contact.frame.reshape(3, 3).T @ force[:3]
            impulses[self.points[int(contact.geom[1])]] = self.steps.dt * np.array([z, x, y])
        return StepSolution(impulses, int(data.solver_niter[0]), spent)


def _method(cone: str, solver: str) -> StepMethod:
    settings = {"model": f"soft, convex, {cone}", "impedance": IMPEDANCE, "reference": "-v/dt", "impratio": 1.0}
    return StepMethod(partial(MujocoStanding, cone, solver), {**settings, "limit": f"{cone}_newton", "time": INCLUDES[solver]})


METHODS = {f"{cone}_{solver}": _method(cone, solver) for cone in CONES for solver in SOLVERS}
