"""Robots with loops in Drake: ball and weld constraints of a discrete plant, which its solver SAP holds.

A continuous plant of Drake has no constraints. So an acceleration is that of a step: the change of velocity over its length. SAP holds a
loop almost rigidly: its compliance is made such that the loop's own frequency is that of the step.
"""

from __future__ import annotations

from time import perf_counter_ns

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.systems.analysis import Simulator

from featherbench_oracles.abilities.loops import TYPES, Drive, End, Follow, LoopMethods, Motion, Tie
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.drake.building import build
from featherbench_oracles.drake.coordinates import change_of_velocities, to_engine_q

ACCELERATIONS = ("sap_1e-3",)
MOTIONS = ("sap",)
HELD = {**TYPES, "distance": "distance", "gear": "coupler", "mimic": "coupler"}


class DrakeLoops:
    """A robot with loops in Drake.

    Parameters
    ----------
    robot : Description
        The robot.
    loops : list of Tie
        Its loops: ball constraints, two for a hinge, a weld, a distance, or a coupler.
    drive : Drive
        What drives it.
    """

    def __init__(self, robot: Description, loops: list[Tie], drive: Drive) -> None:
        self.robot, self.loops, self.drive = robot, loops, drive
        self.built: dict[float, MultibodyPlant] = {}
        self._plant(1e-3)

    def _plant(self, dt: float) -> MultibodyPlant:
        """Find or build the plant of a step."""
        if dt not in self.built:
            plant, _ = build(self.robot, dt, self._add)
            self.built = {dt: plant}
        return self.built[dt]

    def _add(self, plant: MultibodyPlant, chains: list[list[tree.Joint]]) -> None:
        """Add the constraints."""
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        plant.SetUseSampledOutputPorts(False)  # else the accelerations are those of the step before

        # Drake 1.51.1 ends the process where a constraint is on the world itself; a body that is welded to the world is taken.
        ground = plant.AddRigidBody("ground of loops", tree.SpatialInertia.Zero())
        plant.WeldFrames(plant.world_frame(), ground.body_frame())

        def on(end: End) -> tree.RigidBody:
            return ground if end.body < 0 else chains[end.body][-1].child_body()

        for spring in self.drive.springs:
            one, other = spring.first, spring.second
            force = tree.LinearSpringDamper(on(one), one.translation, on(other), other.translation, spring.length, spring.stiffness, 0.0)
            plant.AddForceElement(force)
        for loop in self.loops:
            if isinstance(loop, Follow):
                offset, ratio, *bends = loop.polynomial
                if any(bends):
                    raise Unsupported(f"loop {loop.name}: Drake's coupler is linear, and the polynomial is not")
                plant.AddCouplerConstraint(chains[loop.follower][-1], chains[loop.leader][-1], ratio, offset)
                continue
            for first, second in loop.points():
                if loop.type == "distance":
                    plant.AddDistanceConstraint(on(first), first.translation, on(second), second.translation, loop.length)
                elif loop.type == "fixed":
                    plant.AddWeldConstraint(on(first), _pose(first), on(second), _pose(second))
                else:
                    plant.AddBallConstraint(on(first), first.translation, on(second), second.translation)

    def settings(self, method: str) -> Header:
        """List the solver, and the step of an acceleration, s."""
        step = {} if method in MOTIONS else {"dt": float(method.removeprefix("sap_"))}
        return {"solver": "SAP", "compliance": "near rigid, by Drake", **step}

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute the change of velocity in one step over its length: of a discrete plant, the port of accelerations."""
        dt = float(method.removeprefix("sap_"))
        plant = self._plant(dt)
        change = change_of_velocities(self.robot, q, v)
        context = plant.CreateDefaultContext()
        plant.SetPositions(context, to_engine_q(self.robot, q))
        plant.SetVelocities(context, change.to_engine_v(v))
        plant.get_applied_generalized_force_input_port().FixValue(context, change.to_engine_tau(tau + self.drive.tau))
        start = perf_counter_ns()
        found = plant.get_generalized_acceleration_output_port().Eval(context)
        return change.to_neutral_a(found), perf_counter_ns() - start

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run a simulator. Its steps are the plant's."""
        plant = self._plant(motion.dt)
        simulator = Simulator(plant)
        context = simulator.get_mutable_context()
        plant.SetPositions(context, to_engine_q(self.robot, q))
        change = change_of_velocities(self.robot, q, v)
        plant.SetVelocities(context, change.to_engine_v(v))
        plant.get_applied_generalized_force_input_port().FixValue(context, change.to_engine_tau(self.drive.tau))
        simulator.Initialize()
        qs, vs, spent = [], [], 0
        for record in range(1, motion.steps // motion.every + 1):
            # The update at the end of an interval belongs to the next one: half a step more makes it belong to this.
            end = (record * motion.every - 0.5) * motion.dt
            start = perf_counter_ns()
            simulator.AdvanceTo(end)
            spent += perf_counter_ns() - start
            qs.append(self._neutral(plant.GetPositions(context)))
            vs.append(change_of_velocities(self.robot, qs[-1], np.zeros(self.robot.nv)).to_neutral_tau(plant.GetVelocities(context)))
        return np.array(qs), np.array(vs), spent

    def _neutral(self, positions: Array) -> Array:
        """Convert positions back: of a free joint (quaternion wxyz, p) to (p, quaternion xyzw). Drake's steps leave its length off one."""
        q = np.array(positions)
        for joint in (body.joint for body in self.robot.bodies):
            if joint.type == "free":
                w, place = positions[joint.q][:4], positions[joint.q][4:]
                q[joint.q] = np.concatenate([place, np.roll(w, -1) / np.linalg.norm(w)])
        return q


def _pose(end: End) -> RigidTransform:
    return RigidTransform(RotationMatrix(end.rotation), end.translation)


LOOPS = LoopMethods(DrakeLoops, ACCELERATIONS, tuple(MOTIONS), types=HELD)
