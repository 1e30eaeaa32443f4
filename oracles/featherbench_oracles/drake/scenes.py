"""Scenes by Drake: point contact in discrete time (TAMSI, SAP, similar, lagged), and by the error-controlled integrator CENIC."""

from __future__ import annotations

from functools import partial

import numpy as np
from pydrake.autodiffutils import AutoDiffXd, InitializeAutoDiff
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import AddContactMaterial, Box, HalfSpace, ProximityProperties, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialForce, SpatialVelocity
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
    ExternallyAppliedSpatialForce,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import RigidBody, SpatialInertia, UnitInertia
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, Simulator_, SimulatorConfig
from pydrake.systems.framework import Context, DiagramBuilder

from featherbench_oracles.abilities.scenes import Derivative, DerivativeVariant, Motion, Scene, Stepping, Variant
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported

# Drake 1.58 has no TAMSI any more.
APPROXIMATIONS = {
    name: getattr(DiscreteContactApproximation, value)
    for name, value in {"tamsi": "kTamsi", "sap": "kSap", "similar": "kSimilar", "lagged": "kLagged"}.items()
    if hasattr(DiscreteContactApproximation, value)
}
# The accuracy that is asked of CENIC.
ACCURACY = 1e-6
# Drake's own settings of contact.
DEFAULTS = MultibodyPlantConfig()


def _build(plant: MultibodyPlant, scene: Scene) -> list[RigidBody]:
    """Add ground and bodies."""
    plant.mutable_gravity_field().set_gravity_vector(scene.gravity)
    friction = CoulombFriction(scene.friction, scene.friction)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", friction)
    bodies = []
    for index, body in enumerate(scene.bodies):
        inertia = SpatialInertia(body.mass, np.zeros(3), UnitInertia(*(body.inertia / body.mass)))
        made = plant.AddRigidBody(f"{index}", inertia)
        for number, shape in enumerate(body.shapes):
            geometry = Sphere(shape.radius) if shape.radius is not None else Box(*(2 * np.asarray(shape.half)))
            plant.RegisterCollisionGeometry(made, RigidTransform(shape.at), geometry, f"{index}_{number}", friction)
        bodies.append(made)
    return bodies


def _sample(plant: MultibodyPlant, context: Context, bodies: list[RigidBody]) -> list[Array]:
    read = []
    for body in bodies:
        place, velocity = plant.EvalBodyPoseInWorld(context, body), plant.EvalBodySpatialVelocityInWorld(context, body)
        turn = place.rotation().ToQuaternion()
        quaternion = [turn.x(), turn.y(), turn.z(), turn.w()]
        read.append(np.concatenate([place.translation(), quaternion, velocity.translational(), velocity.rotational()]))
    return read


def _contacts(plant: MultibodyPlant, context: Context, bodies: list[RigidBody]) -> list[Array]:
    """Read the contacts. The force acts on body B of a pair."""
    known = {int(body.index()): k for k, body in enumerate(bodies)}
    results = plant.get_contact_results_output_port().Eval(context)
    found = []
    for k in range(results.num_point_pair_contacts()):
        pair = results.point_pair_contact_info(k)
        first, second = (known.get(int(index), -1) for index in (pair.bodyA_index(), pair.bodyB_index()))
        force = np.ravel(pair.contact_force())
        on, other, force = (second, first, force) if second >= 0 else (first, second, -force)
        found.append(np.concatenate([[on, other], np.ravel(pair.contact_point()), force]))
    return found


def _simulate(name: str, scene: Scene, stepping: Stepping) -> Motion:
    if scene.restitution > 0:
        raise Unsupported("Drake's point contact has dissipation, no coefficient of restitution")
    discrete = name in APPROXIMATIONS
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=stepping.dt if discrete else 0.0)
    if discrete:
        plant.set_discrete_contact_approximation(APPROXIMATIONS[name])
    bodies = _build(plant, scene)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    pushes = []
    for made, body in zip(bodies, scene.bodies, strict=True):
        x, y, z, w = body.orientation
        place = RigidTransform(RotationMatrix(Quaternion(wxyz=np.array([w, x, y, z]) / np.linalg.norm(body.orientation))), body.position)
        plant.SetFreeBodyPose(context, made, place)
        plant.SetFreeBodySpatialVelocity(context, made, SpatialVelocity(body.angular, body.linear))
        if body.force.any():
            push = ExternallyAppliedSpatialForce()
            push.body_index, push.p_BoBq_B = made.index(), np.zeros(3)
            push.F_Bq_W = SpatialForce(np.zeros(3), body.force)
            pushes.append(push)
    plant.get_applied_spatial_force_input_port().FixValue(context, pushes)
    if not discrete:
        config = SimulatorConfig(integration_scheme="cenic", accuracy=ACCURACY, max_step_size=stepping.dt, use_error_control=True)
        ApplySimulatorConfig(config, simulator)
    simulator.Initialize()
    samples = []
    for k in range(1, stepping.steps // stepping.every + 1):
        # Step n happens at the time (n - 1) dt: half a step after it, before the next. A continuous motion ends where it is asked.
        simulator.AdvanceTo((k * stepping.every - (0.5 if discrete else 0.0)) * stepping.dt)
        samples.append(_sample(plant, context, bodies))
    return Motion(samples, _contacts(plant, context, bodies))


def _variant(name: str) -> Variant:
    discrete = name in APPROXIMATIONS
    settings = {
        "contact": "point contact, "
        + (name if discrete else "forces told are those of the continuous model, which has no static friction"),
        "integrator": "discrete" if discrete else f"CENIC, accuracy {ACCURACY:g}, steps up to dt",
        "penetration_allowance": DEFAULTS.penetration_allowance,
        "stiction_tolerance": DEFAULTS.stiction_tolerance,
    }
    return Variant(partial(_simulate, name), settings)


def _autodiff(name: str, scene: Scene, stiffness: float, stepping: Stepping) -> Derivative:
    """Simulate with AutoDiffXd. Two materials of twice the stiffness, one behind the other, have it once; neither dissipates."""
    body = scene.bodies[0]
    radius = body.shapes[0].radius
    if radius is None or body.linear[:2].any() or body.angular.any() or scene.gravity[:2].any():
        raise Unsupported("the derivative is of a sphere that moves up and down")
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=stepping.dt)
    plant.set_discrete_contact_approximation(APPROXIMATIONS[name])
    plant.mutable_gravity_field().set_gravity_vector(scene.gravity)
    material = ProximityProperties()
    friction = CoulombFriction(scene.friction, scene.friction)
    AddContactMaterial(dissipation=0.0, point_stiffness=2 * stiffness, friction=friction, properties=material)
    material.AddProperty("material", "relaxation_time", 0.0)
    made = plant.AddRigidBody("body", SpatialInertia(body.mass, np.zeros(3), UnitInertia(*(body.inertia / body.mass))))
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", material)
    plant.RegisterCollisionGeometry(made, RigidTransform(), Sphere(radius), "sphere", material)
    plant.Finalize()
    diagram = builder.Build().ToAutoDiffXd()
    simulator = Simulator_[AutoDiffXd](diagram)
    plant = diagram.GetSubsystemByName(plant.get_name())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    start = InitializeAutoDiff(np.array([body.position[2], body.linear[2]]))
    positions = np.array([AutoDiffXd(x) for x in (1, 0, 0, 0, *body.position)], dtype=object)
    velocities = np.array([AutoDiffXd(0.0) for _ in range(6)], dtype=object)
    positions[6], velocities[5] = start[0, 0], start[1, 0]
    plant.SetPositions(context, positions)
    plant.SetVelocities(context, velocities)
    simulator.Initialize()
    simulator.AdvanceTo((stepping.steps - 0.5) * stepping.dt)
    end = [plant.GetPositions(context)[6], plant.GetVelocities(context)[5]]
    return Derivative(np.array([x.value() for x in end]), np.array([x.derivatives() for x in end]))


DERIVATIVES = {
    f"autodiff_{name}": DerivativeVariant(
        partial(_autodiff, name), {"contact": f"point contact, {name}", "differences": "none: AutoDiffXd"}
    )
    for name in ("tamsi", "lagged")
    if name in APPROXIMATIONS
}
VARIANTS = {name: _variant(name) for name in (*APPROXIMATIONS, "cenic")}
