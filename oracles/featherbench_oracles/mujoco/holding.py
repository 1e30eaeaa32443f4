"""Robots with loops in MuJoCo: equality constraints between sites, accelerations by `mj_forward` and motions by `mj_step`.

MuJoCo's constraints are soft. `solref` is the time constant and damping ratio with which an opening vanishes. `solimp` is the impedance d:
of the acceleration that would hold a loop, the share 1 - d is left. Methods differ in these numbers. MuJoCo's own are (0.02, 1), and d from
0.9 to 0.95. A stiff method has the shortest time constant that MuJoCo takes, two steps, and the largest d.

Rows are about J a alone. A loop whose rows turn, as that of a cam, misses the derivative of J times v in each acceleration.
"""

from __future__ import annotations

from time import perf_counter_ns

import mujoco as mj
import numpy as np

from featherbench_oracles.abilities.loops import TYPES, Drive, End, Follow, Loop, LoopMethods, Motion, Tie
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.mujoco.building import build
from featherbench_oracles.mujoco.coordinates import change_of_velocities, from_wxyz, to_engine_q, wxyz
from featherbench_oracles.mujoco.status import check_warnings

# MuJoCo's default impedance, and its largest.
SOFT, STIFF = (0.9, 0.95, 0.001, 0.5, 2.0), (0.9999, 0.9999, 0.001, 0.5, 2.0)
# The time constant of MuJoCo's default, s; a stiff method of a motion has two steps instead.
TIME = 0.02
TOLERANCE, ITERATIONS = 1e-14, 100
ACCELERATIONS = ("default", "stiff")
HELD = {**TYPES, "distance": "tendon of fixed length", "gear": "joint equality", "mimic": "joint equality"}
EULER, RK4 = mj.mjtIntegrator.mjINT_EULER, mj.mjtIntegrator.mjINT_RK4
# method of a motion -> integrator, impedance, whether the time constant is two steps
MOTIONS = {
    "rk4": (RK4, SOFT, False),
    "rk4_stiff": (RK4, STIFF, True),
    "euler": (EULER, SOFT, False),
    "euler_stiff": (EULER, STIFF, True),
}


class MujocoLoops:
    """A robot with loops in MuJoCo.

    Parameters
    ----------
    robot : Description
        The robot.
    loops : list of Tie
        Its loops: `connect` between two sites, twice for a hinge, or `weld`; a `joint` equality; of a distance a tendon.
    drive : Drive
        Springs are tendons too.
    """

    def __init__(self, robot: Description, loops: list[Tie], drive: Drive) -> None:
        self.robot, self.loops, self.drive = robot, loops, drive
        self.model = build(robot, self._add)
        for loop in loops:
            if loop.type == "distance" and isinstance(loop, Loop):
                # The equality is about the change of the length since `qpos0`.
                rest = self.model.tendon_length0[self.model.tendon(loop.name).id]
                self.model.eq_data[self.model.equality(loop.name).id, 0] = loop.length - rest
        option = self.model.opt
        option.disableflags &= ~int(mj.mjtDisableBit.mjDSBL_CONSTRAINT)
        option.solver, option.tolerance, option.iterations = mj.mjtSolver.mjSOL_NEWTON, TOLERANCE, ITERATIONS
        self.data = mj.MjData(self.model)

    def _add(self, spec: mj.MjSpec, bodies: dict[int, mj.MjsBody]) -> None:
        """Add sites, the constraints between them, and springs."""
        for k, spring in enumerate(self.drive.springs):
            tendon = spec.add_tendon(name=f"spring {k}", stiffness=spring.stiffness, springlength=[spring.length] * 2)
            for side, end in enumerate((spring.first, spring.second)):
                if end.body not in bodies:
                    raise Unsupported("MuJoCo has no massless body, which a spring would pull")
                self._site(bodies[end.body], end, f"spring {k}.{side}")
                tendon.wrap_site(f"spring {k}.{side}")
        count = 0
        for loop in self.loops:
            if isinstance(loop, Follow):
                self._follow(spec, bodies, loop)
                continue
            for ends in loop.points():
                names = [f"loop {count}.{k}" for k in range(2)]
                for end, name in zip(ends, names, strict=True):
                    if end.body not in bodies:
                        raise Unsupported(f"MuJoCo has no massless body, which loop {loop.name} would hold")
                    self._site(bodies[end.body], end, name)
                count += 1
                if loop.type == "distance":
                    tendon = spec.add_tendon(name=loop.name)
                    for name in names:
                        tendon.wrap_site(name)
                    spec.add_equality(name=loop.name, type=mj.mjtEq.mjEQ_TENDON, objtype=mj.mjtObj.mjOBJ_TENDON, name1=loop.name)
                    continue
                kind = mj.mjtEq.mjEQ_WELD if loop.type == "fixed" else mj.mjtEq.mjEQ_CONNECT
                data = np.zeros(mj.mjNEQDATA)
                data[10] = 1.0  # of a weld: the weight of a rotation against a translation
                spec.add_equality(type=kind, objtype=mj.mjtObj.mjOBJ_SITE, name1=names[0], name2=names[1], data=data)

    @staticmethod
    def _follow(spec: mj.MjSpec, bodies: dict[int, mj.MjsBody], loop: Follow) -> None:
        """Let a joint be a polynomial of another."""
        names = []
        for body in (loop.follower, loop.leader):
            if body not in bodies:
                raise Unsupported(f"MuJoCo folds massless body {body}, whose joint loop {loop.name} names")
            joint = bodies[body].joints[-1]
            joint.name = f"joint of body {body}"
            names.append(joint.name)
        data = np.zeros(mj.mjNEQDATA)
        data[:5] = loop.polynomial
        spec.add_equality(type=mj.mjtEq.mjEQ_JOINT, objtype=mj.mjtObj.mjOBJ_JOINT, name1=names[0], name2=names[1], data=data)

    @staticmethod
    def _site(body: mj.MjsBody, end: End, name: str) -> None:
        """Add a frame to a body."""
        body.add_site(name=name, pos=end.translation, quat=wxyz(end.rotation))

    def settings(self, method: str) -> Header:
        """List the softness of the loops, and the solver's settings."""
        impedance = STIFF if "stiff" in method else SOFT
        return {
            "solimp": list(impedance),
            "solref_time": "2 dt" if method in MOTIONS and MOTIONS[method][2] else TIME,
            "solver": "Newton",
            "tolerance": TOLERANCE,
            "iterations": ITERATIONS,
        }

    def _soften(self, time: float, impedance: tuple[float, ...]) -> None:
        """Set solref and solimp."""
        self.model.eq_solref[:] = time, 1.0
        self.model.eq_solimp[:] = impedance

    def _start(self, q: Array, v: Array) -> None:
        """Set a state. What the solver begins from is forgotten."""
        mj.mj_resetData(self.model, self.data)
        self.data.qpos = to_engine_q(self.robot, q)
        change = change_of_velocities(self.robot, q, v)
        self.data.qvel, self.data.qfrc_applied = change.to_engine_v(v), change.to_engine_tau(self.drive.tau)

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute qacc of `mj_forward`."""
        self._soften(TIME, STIFF if method == "stiff" else SOFT)
        self._start(q, v)
        change = change_of_velocities(self.robot, q, v)
        self.data.qfrc_applied = change.to_engine_tau(tau + self.drive.tau)
        start = perf_counter_ns()
        mj.mj_forward(self.model, self.data)
        spent = perf_counter_ns() - start
        check_warnings(self.data)
        return change.to_neutral_a(self.data.qacc.copy()), spent

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run `mj_step`. One call makes all steps between two records."""
        integrator, impedance, stiff = MOTIONS[method]
        self.model.opt.integrator, self.model.opt.timestep = integrator, motion.dt
        self._soften(2 * motion.dt if stiff else TIME, impedance)
        self._start(q, v)
        qs, vs, spent = [], [], 0
        for _ in range(motion.steps // motion.every):
            start = perf_counter_ns()
            mj.mj_step(self.model, self.data, motion.every)
            spent += perf_counter_ns() - start
            qs.append(self._neutral(self.data.qpos))
            vs.append(change_of_velocities(self.robot, qs[-1], np.zeros(self.robot.nv)).to_neutral_tau(self.data.qvel.copy()))
        check_warnings(self.data)
        return np.array(qs), np.array(vs), spent

    def _neutral(self, positions: Array) -> Array:
        """Convert positions back: of a free joint the pose in the world to that in the joint's frame."""
        q = np.array(positions)
        for joint in (body.joint for body in self.robot.bodies):
            if joint.type == "free":
                place, turn = q[joint.q][:3], from_wxyz(q[joint.q][3:])
                q[joint.q] = np.append(joint.rotation.T @ (place - joint.translation), np.roll(wxyz(joint.rotation.T @ turn), -1))
        return q


LOOPS = LoopMethods(MujocoLoops, ACCELERATIONS, tuple(MOTIONS), types=HELD)
