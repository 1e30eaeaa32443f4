"""Scenes by MuJoCo: its soft convex contacts with pyramidal and elliptic cones, by each solver."""

from __future__ import annotations

from functools import partial

import mujoco
import numpy as np

from featherbench_oracles.abilities.scenes import Body, Derivative, DerivativeVariant, Motion, Scene, Stepping, Variant
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.mujoco.status import check_warnings

CONES = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}
SOLVERS = {"pgs": mujoco.mjtSolver.mjSOL_PGS, "cg": mujoco.mjtSolver.mjSOL_CG, "newton": mujoco.mjtSolver.mjSOL_NEWTON}


def compiled(scene: Scene, dt: float) -> tuple[mujoco.MjModel, dict[int, int]]:
    """Build a scene, and the scene's body of each of MuJoCo's."""
    spec = mujoco.MjSpec()
    spec.option.gravity = scene.gravity
    spec.option.timestep = dt
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    slide = [scene.friction, 0, 0]
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], condim=3, friction=slide)
    for index, body in enumerate(scene.bodies):
        made = spec.worldbody.add_body(name=f"{index}", pos=body.position, quat=np.roll(body.orientation, 1))
        made.explicitinertial = True
        made.mass, made.ipos, made.inertia = body.mass, np.zeros(3), body.inertia
        made.iquat = [1, 0, 0, 0]
        made.add_freejoint()
        for shape in body.shapes:
            sphere = shape.radius is not None
            kind = mujoco.mjtGeom.mjGEOM_SPHERE if sphere else mujoco.mjtGeom.mjGEOM_BOX
            size = [shape.radius, 0, 0] if sphere else shape.half
            made.add_geom(type=kind, size=size, pos=shape.at, condim=3, friction=slide)
    model = spec.compile()
    return model, {model.body(f"{k}").id: k for k in range(len(scene.bodies))}


def _start(data: mujoco.MjData, bodies: tuple[Body, ...]) -> None:
    """Set velocities and forces. A free joint has its linear velocity in world axes and its angular velocity in body axes."""
    for index, body in enumerate(bodies):
        turned = np.zeros(3)
        back = np.zeros(4)
        mujoco.mju_negQuat(back, np.roll(body.orientation, 1))
        mujoco.mju_rotVecQuat(turned, body.angular, back)
        data.qvel[6 * index : 6 * index + 6] = np.concatenate([body.linear, turned])
        data.qfrc_applied[6 * index : 6 * index + 3] = body.force


def sample(data: mujoco.MjData, bodies: int) -> list[Array]:
    """Read the bodies: thirteen numbers each."""
    read = []
    for k in range(bodies):
        place, velocity = data.qpos[7 * k : 7 * k + 7].copy(), data.qvel[6 * k : 6 * k + 6]
        angular = np.zeros(3)
        mujoco.mju_rotVecQuat(angular, velocity[3:].copy(), place[3:])
        read.append(np.concatenate([place[:3], np.roll(place[3:], -1), velocity[:3], angular]))
    return read


def _contacts(model: mujoco.MjModel, data: mujoco.MjData, known: dict[int, int]) -> list[Array]:
    """Read the contacts of the last step. The normal points from the first geometry to the second."""
    found = []
    for k, contact in enumerate(data.contact):
        wrench = np.zeros(6)
        mujoco.mj_contactForce(model, data, k, wrench)
        force = contact.frame.reshape(3, 3).T @ wrench[:3]
        first, second = (known.get(int(model.geom_bodyid[geom]), -1) for geom in contact.geom)
        on, other = (second, first) if second >= 0 else (first, second)
        sign = 1 if on == second else -1
        found.append(np.concatenate([[on, other], contact.pos, sign * force]))
    return found


def _set(model: mujoco.MjModel, cone: str, solver: str, impratio: float) -> None:
    model.opt.cone, model.opt.solver, model.opt.impratio = CONES[cone], SOLVERS[solver], impratio


def _simulate(cone: str, solver: str, impratio: float, scene: Scene, stepping: Stepping) -> Motion:
    if scene.restitution > 0:
        raise Unsupported("MuJoCo has no coefficient of restitution")
    model, known = compiled(scene, stepping.dt)
    _set(model, cone, solver, impratio)
    data = mujoco.MjData(model)
    _start(data, scene.bodies)
    samples = []
    for step in range(stepping.steps):
        mujoco.mj_step(model, data)
        if (step + 1) % stepping.every == 0:
            samples.append(sample(data, len(scene.bodies)))
    check_warnings(data)
    return Motion(samples, _contacts(model, data, known))


def _variant(cone: str, solver: str, impratio: float) -> Variant:
    """Make a variant. Its settings are those that a compiled model has."""
    model, _ = compiled(Scene(np.zeros(3), 1.0, 0.0, ()), 1e-3)
    _set(model, cone, solver, impratio)
    settings = {
        "contact": f"soft, convex, {cone} cone",
        "integrator": "Euler",
        "impratio": float(model.opt.impratio),
        "iterations": int(model.opt.iterations),
        "tolerance": float(model.opt.tolerance),
        "solref": [float(x) for x in model.geom_solref[0]],
        "solimp": [float(x) for x in model.geom_solimp[0]],
    }
    return Variant(partial(_simulate, cone, solver, impratio), settings)


VARIANTS = {f"{cone}_{solver}": _variant(cone, solver, 1.0) for cone in CONES for solver in SOLVERS}
VARIANTS["elliptic_newton_impratio_100"] = _variant("elliptic", "newton", 100.0)


def _transitions(impedance: float, scene: Scene, stiffness: float, stepping: Stepping) -> Derivative:
    """Multiply the transition matrices of all steps, by mjd_transitionFD with centred differences.

    A negative `solref` is stiffness and damping per unit of inverse mass; the reference is scaled by 1/d^2 of the impedance d.
    """
    model, _ = compiled(scene, stepping.dt)
    body = scene.bodies[0]
    model.geom_solref[:] = [-stiffness / body.mass, 0.0]
    model.geom_solimp[:, :2] = impedance
    data = mujoco.MjData(model)
    _start(data, scene.bodies)
    chain, size = np.eye(12), 12
    for _ in range(stepping.steps):
        step = np.zeros((size, size))
        mujoco.mjd_transitionFD(model, data, 1e-6, True, step, None, None, None)
        chain = step @ chain
        mujoco.mj_step(model, data)
    check_warnings(data)
    # The third position and the third velocity: the height.
    rows = [2, 8]
    return Derivative(np.array([data.qpos[2], data.qvel[2]]), chain[np.ix_(rows, rows)])


def _derivative(impedance: float) -> DerivativeVariant:
    settings = {"contact": "soft, convex", "differences": "mjd_transitionFD, centred, 1e-6", "impedance": impedance}
    return DerivativeVariant(partial(_transitions, impedance), settings)


DERIVATIVES = {"transition_fd": _derivative(0.9999)}
