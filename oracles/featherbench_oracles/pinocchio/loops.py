"""Robots with loops in Pinocchio: `constraintDynamics` and `lcaba`, and motions by their accelerations."""

from __future__ import annotations

from time import perf_counter_ns

import numpy as np
import pinocchio as pin

from featherbench_oracles.abilities.loops import Drive, End, Loop, LoopMethods, Motion, Tie
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.robot import Description
from featherbench_oracles.pinocchio.building import build
from featherbench_oracles.pinocchio.coordinates import change_of_velocities, to_engine_q

# Pinocchio's own default of mu is 0: then redundant rows have no answer.
# At a smaller accuracy rounding would decide how many iterations are made.
MU, ACCURACY, ITERATIONS = 1e-6, 1e-10, 20
ACCELERATIONS = ("constraint_dynamics", "lcaba")
# What Pinocchio's rigid constraints do not hold.
LACKS = {
    "distance": "Pinocchio's rigid constraints hold a point or a frame, and no distance",
    "gear": "Pinocchio has no constraint between coordinates",
    "mimic": "Pinocchio has no constraint between coordinates: its mimicking joint has none of its own",
}
# method of a motion -> method of its accelerations, and the time constant of Baumgarte's stabilisation, s
MOTIONS: dict[str, tuple[str, float | None]] = {
    "rk4_constraint_dynamics": ("constraint_dynamics", None),
    "rk4_constraint_dynamics_baumgarte": ("constraint_dynamics", 0.05),
    "rk4_lcaba": ("lcaba", None),
}


class PinocchioLoops:
    """A robot with loops in Pinocchio. Its joints' coordinates are neutral, so q needs no conversion.

    Parameters
    ----------
    robot : Description
        The robot.
    loops : list of Tie
        Its loops. Pinocchio has rigid constraints of a point (three rows) and of a frame (six rows).
    drive : Drive
        What drives it.
    """

    def __init__(self, robot: Description, loops: list[Tie], drive: Drive) -> None:
        # Others are refused before (`LACKS`).
        self.robot, self.loops = robot, [loop for loop in loops if isinstance(loop, Loop)]
        self.model, self.drive = build(robot), drive
        self.data = self.model.createData()
        # Data of their own: `lcaba` leaves in its `Data` what makes later answers of `constraintDynamics` wrong.
        asked = {*MOTIONS.values(), *((method, None) for method in ACCELERATIONS)}
        self.held = {(method, stabilised): self._constraints(stabilised) for method, stabilised in asked}

    def _constraints(self, time: float | None) -> tuple[pin.Data, pin.StdVec_RigidConstraintModel, pin.StdVec_RigidConstraintData]:
        """Make the constraints and data for both methods."""
        models, data = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for loop in self.loops:
            kind = pin.ContactType.CONTACT_6D if loop.type == "fixed" else pin.ContactType.CONTACT_3D
            for ends in loop.points():
                # The world comes second: `lcaba` ends the process where it is first.
                (one, at), (other, there) = (self._place(end) for end in sorted(ends, key=lambda end: end.body < 0))
                held = pin.RigidConstraintModel(kind, self.model, one, at, other, there, pin.ReferenceFrame.LOCAL)
                if time is not None:
                    held.m_baumgarte_parameters.Kp = 1 / time**2
                    held.m_baumgarte_parameters.Kd = 2 / time
                models.append(held)
                data.append(held.createData())
        computed = self.model.createData()
        pin.initConstraintDynamics(self.model, computed, models, data)
        pin.computeJointMinimalOrdering(self.model, computed, models)
        return computed, models, data

    @staticmethod
    def _place(end: End) -> tuple[int, pin.SE3]:
        """Find the joint of a body, and the frame on it."""
        return end.body + 1, pin.SE3(end.rotation, end.translation)

    def settings(self, method: str) -> Header:
        """List the proximal settings, and the stabilisation of a motion."""
        proximal = {"mu": MU, "accuracy": ACCURACY, "iterations": ITERATIONS}
        return {**proximal, "baumgarte_seconds": MOTIONS[method][1]} if method in MOTIONS else proximal

    def _driven(self, q: Array, tau: Array) -> Array:
        """Add the drive to forces of the joints, in Pinocchio's coordinates. It has no springs: their pull is brought there by J'."""
        if self.drive.springs:
            pin.computeJointJacobians(self.model, self.data, q)
        tau = tau + self.drive.tau
        for spring in self.drive.springs:
            places, jacobians = [], []
            for end in (spring.first, spring.second):
                joint, at = self._place(end)
                place = self.data.oMi[joint] * at
                moved = pin.getJointJacobian(self.model, self.data, joint, pin.LOCAL_WORLD_ALIGNED)
                arm = place.translation - self.data.oMi[joint].translation
                places.append(place.translation)
                jacobians.append(moved[:3] - pin.skew(arm) @ moved[3:] if joint else np.zeros((3, self.model.nv)))
            way = places[1] - places[0]
            distance = float(np.linalg.norm(way))
            tau = tau + spring.stiffness * (distance - spring.length) / distance * (jacobians[0] - jacobians[1]).T @ way
        return tau

    def _solve(self, method: str, stabilised: float | None, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute an acceleration in Pinocchio's coordinates, and the time of the call."""
        data, models, of_models = self.held[method, stabilised]
        proximal = pin.ProximalSettings(ACCURACY, ACCURACY, MU, ITERATIONS)
        call = pin.lcaba if method == "lcaba" else pin.constraintDynamics
        tau = self._driven(q, tau)
        start = perf_counter_ns()
        found = call(self.model, data, q, v, tau, models, of_models, proximal)
        return found.copy(), perf_counter_ns() - start

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute an acceleration."""
        change = change_of_velocities(self.robot, q, v)
        found, spent = self._solve(method, None, to_engine_q(self.robot, q), change.to_engine_v(v), change.to_engine_tau(tau))
        return change.to_neutral_a(found), spent

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run a motion by the method of Runge and Kutta of order four, on the configuration space by `pin.integrate`.

        Velocities of a free joint have the body's axes, which differ between stages. They are combined as if they had the same: with a free
        joint the order is two.
        """
        by, stabilised = MOTIONS[method]
        nothing, spent = np.zeros(self.model.nv), 0
        qs, vs = [], []
        dt = motion.dt
        for step in range(1, motion.steps + 1):
            stages, at, rate = [], q, v
            for share in (0.5, 0.5, 1.0, None):
                acceleration, took = self._solve(by, stabilised, at, rate, nothing)
                stages.append((rate, acceleration))
                start = perf_counter_ns()
                if share is not None:
                    at, rate = pin.integrate(self.model, q, share * dt * rate), v + share * dt * acceleration
                spent += took + perf_counter_ns() - start
            weights = (dt / 6, dt / 3, dt / 3, dt / 6)
            q = pin.integrate(self.model, q, sum((w * r for w, (r, _) in zip(weights, stages, strict=True)), nothing))
            v = v + sum((w * a for w, (_, a) in zip(weights, stages, strict=True)), nothing)
            if step % motion.every == 0:
                qs.append(q)
                vs.append(v)
        return np.array(qs), np.array(vs), spent


LOOPS = LoopMethods(PinocchioLoops, ACCELERATIONS, tuple(MOTIONS), lacks=LACKS)
