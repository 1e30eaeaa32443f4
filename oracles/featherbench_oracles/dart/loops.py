"""Robots with loops in DART: its joint constraints, and steps of a `World`.

A constraint holds what coincides when it is made, so it is made at each beginning. An acceleration is that of a step: the change of
velocity over its length. DART corrects openings of loops by a share of them in each step (error reduction); the settings name it.
"""

from __future__ import annotations

from time import perf_counter_ns

import numpy as np
from dartpy import constraint, dynamics, simulation

from featherbench_oracles.algebra import Array
from featherbench_oracles.dart.building import build
from featherbench_oracles.dart.coordinates import change_of_velocities, exponential, to_engine_q
from featherbench_oracles.loops import End, Loop, Motion, Tie
from featherbench_oracles.messages import Header
from featherbench_oracles.robot import Description

ACCELERATIONS = ("step_1e-3",)
MOTIONS = ("step",)
# What DART does not hold, or not from Python.
LACKS = {
    "distance": "DART has no constraint of a distance",
    "gear": "DART's Python package cannot name the joint that a mimicking joint follows",
    "mimic": "DART's Python package cannot name the joint that a mimicking joint follows",
}


class DartLoops:
    """A robot with loops in DART.

    Parameters
    ----------
    robot : Description
        The robot.
    loops : list of Tie
        Its loops: ball joint constraints, two for a hinge, or a weld.
    """

    def __init__(self, robot: Description, loops: list[Tie]) -> None:
        # Others are refused before (`LACKS`).
        self.robot, self.loops = robot, [loop for loop in loops if isinstance(loop, Loop)]
        self._world(np.zeros(robot.nq), np.zeros(robot.nv), 1e-3)

    def _world(self, q: Array, v: Array, dt: float) -> tuple[simulation.World, dynamics.Skeleton, list[dynamics.Joint]]:
        """Build a world at a state, with the loops as they are there."""
        skeleton, joints, bodies = build(self.robot)
        world = simulation.World()
        world.setTimeStep(dt)
        world.setGravity(self.robot.gravity)
        world.addSkeleton(skeleton)
        skeleton.setPositions(to_engine_q(self.robot, q))
        skeleton.setVelocities(change_of_velocities(self.robot, joints, q, v).to_engine_v(v))
        solver = world.getConstraintSolver()
        for loop in self.loops:
            for ends in loop.points():
                solver.addConstraint(_constraint(loop, ends, bodies))
        return world, skeleton, joints

    def settings(self, method: str) -> Header:
        """List the error reduction, and the step of an acceleration, s."""
        step = {} if method in MOTIONS else {"dt": float(method.removeprefix("step_"))}
        reduction = constraint.BallJointConstraint.getErrorReductionParameter()
        return {"error_reduction": reduction, "solver": "boxed LCP, by DART", **step}

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute the change of velocity in one step over its length."""
        dt = float(method.removeprefix("step_"))
        world, skeleton, joints = self._world(q, v, dt)
        change = change_of_velocities(self.robot, joints, q, v)
        skeleton.setForces(change.to_engine_tau(tau))
        before = skeleton.getVelocities().copy()
        start = perf_counter_ns()
        world.step()
        spent = perf_counter_ns() - start
        return change.to_neutral_a((skeleton.getVelocities() - before) / dt), spent

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run steps of the world, each a call."""
        world, skeleton, joints = self._world(q, v, motion.dt)
        qs, vs, spent = [], [], 0
        for _ in range(motion.steps // motion.every):
            start = perf_counter_ns()
            for _ in range(motion.every):
                world.step()
            spent += perf_counter_ns() - start
            qs.append(self._neutral(skeleton.getPositions()))
            change = change_of_velocities(self.robot, joints, qs[-1], np.zeros(self.robot.nv))
            vs.append(change.to_neutral_tau(skeleton.getVelocities()))
        return np.array(qs), np.array(vs), spent

    def _neutral(self, positions: Array) -> Array:
        """Convert positions back: of a free joint (rotation vector, p) to (p, quaternion xyzw)."""
        parts = []
        for joint in (body.joint for body in self.robot.bodies):
            held = positions[joint.v]
            parts.append(np.append(held[3:], exponential(held[:3])) if joint.type == "free" else held)
        return np.concatenate(parts)


def _constraint(loop: Loop, ends: tuple[End, End], bodies: list[dynamics.BodyNode]) -> constraint.JointConstraint:
    """Make DART's constraint where the loop is now: at the frame on the second body, which has to be one."""
    first, second = ends
    if second.body < 0:
        first, second = second, first
    moved = bodies[second.body]
    place = moved.getWorldTransform()
    point = place.rotation() @ second.translation + place.translation()
    if loop.type == "fixed":
        return constraint.WeldJointConstraint(*([moved] if first.body < 0 else [bodies[first.body], moved]))
    if first.body < 0:
        return constraint.BallJointConstraint(moved, point)
    return constraint.BallJointConstraint(bodies[first.body], moved, point)
