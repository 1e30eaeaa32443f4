"""Robots with loops in DART: its joint constraints, and steps of a `World`.

A constraint holds what coincides when it is made, so it is made at each beginning. An acceleration is that of a step: the change of
velocity over its length. DART corrects openings of loops by a share of them in each step (error reduction); the settings name it.
"""

from __future__ import annotations

from time import perf_counter_ns
from typing import TypeAlias

import numpy as np
from dartpy import constraint, dynamics, simulation

from featherbench_oracles.abilities.loops import Drive, End, Loop, LoopMethods, Motion, Tie
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.robot import Description
from featherbench_oracles.dart.building import build
from featherbench_oracles.dart.coordinates import change_of_velocities, exponential, to_engine_q

Joints: TypeAlias = list[dynamics.Joint]
Bodies: TypeAlias = list[dynamics.BodyNode]
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
    drive : Drive
        What drives it.
    """

    def __init__(self, robot: Description, loops: list[Tie], drive: Drive) -> None:
        # Others are refused before (`LACKS`).
        self.robot, self.loops = robot, [loop for loop in loops if isinstance(loop, Loop)]
        self.drive = drive
        self._world(np.zeros(robot.nq), np.zeros(robot.nv), 1e-3)

    def _world(self, q: Array, v: Array, dt: float) -> tuple[simulation.World, dynamics.Skeleton, Joints, Bodies]:
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
        return world, skeleton, joints, bodies

    def _pull(self, skeleton: dynamics.Skeleton, bodies: Bodies, forces: Array) -> None:
        """Set forces of the joints, and those of the springs, which DART does not have."""
        skeleton.setForces(forces)
        for spring in self.drive.springs:
            ends = (spring.first, spring.second)
            places = [end.translation if end.body < 0 else _point(bodies[end.body], end.translation) for end in ends]
            way = places[1] - places[0]
            distance = float(np.linalg.norm(way))
            pull = spring.stiffness * (distance - spring.length) / distance * way
            for end, force in zip(ends, (pull, -pull), strict=True):
                if end.body >= 0:
                    bodies[end.body].addExtForce(force, end.translation, False, True)

    def settings(self, method: str) -> Header:
        """List the error reduction, and the step of an acceleration, s."""
        step = {} if method in MOTIONS else {"dt": float(method.removeprefix("step_"))}
        reduction = constraint.BallJointConstraint.getErrorReductionParameter()
        return {"error_reduction": reduction, "solver": "boxed LCP, by DART", **step}

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute the change of velocity in one step over its length."""
        dt = float(method.removeprefix("step_"))
        world, skeleton, joints, bodies = self._world(q, v, dt)
        change = change_of_velocities(self.robot, joints, q, v)
        self._pull(skeleton, bodies, change.to_engine_tau(tau + self.drive.tau))
        before = skeleton.getVelocities().copy()
        start = perf_counter_ns()
        world.step()
        spent = perf_counter_ns() - start
        return change.to_neutral_a((skeleton.getVelocities() - before) / dt), spent

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run steps of the world, each a call."""
        world, skeleton, joints, bodies = self._world(q, v, motion.dt)
        forces = change_of_velocities(self.robot, joints, q, v).to_engine_tau(self.drive.tau)
        qs, vs, spent = [], [], 0
        for _ in range(motion.steps // motion.every):
            for _ in range(motion.every):
                if forces.any() or self.drive.springs:
                    self._pull(skeleton, bodies, forces)  # a step takes them away
                start = perf_counter_ns()
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


def _point(body: dynamics.BodyNode, place: Array) -> Array:
    """Compute where a point of a body is in the world."""
    at = body.getWorldTransform()
    found: Array = at.rotation() @ place + at.translation()
    return found


def _constraint(loop: Loop, ends: tuple[End, End], bodies: list[dynamics.BodyNode]) -> constraint.JointConstraint:
    """Make DART's constraint where the loop is now: at the frame on the second body, which has to be one."""
    first, second = ends
    if second.body < 0:
        first, second = second, first
    moved = bodies[second.body]
    point = _point(moved, second.translation)
    if loop.type == "fixed":
        return constraint.WeldJointConstraint(*([moved] if first.body < 0 else [bodies[first.body], moved]))
    if first.body < 0:
        return constraint.BallJointConstraint(moved, point)
    return constraint.BallJointConstraint(bodies[first.body], moved, point)


LOOPS = LoopMethods(DartLoops, ACCELERATIONS, tuple(MOTIONS), lacks=LACKS)
