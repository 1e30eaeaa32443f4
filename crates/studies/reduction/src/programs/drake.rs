//! Programs in Drake's Python interface. A joint that Drake lacks is a chain of its own with massless bodies between, as our oracle builds it.

use super::{Interface, Theirs, list, number};
use featherbench_model::{BodyDescription, JointType, OneDof};
use featherbench_rbd::Convention;

pub const DRAKE: Interface = Interface {
    begin: "import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant

plant = MultibodyPlant(0.0)
plant.mutable_gravity_field().set_gravity_vector({gravity})
bodies = [plant.world_body()]
X, Y, Z = np.eye(3)


def turn(axis):
    \"\"\"Say how a hinge is made.\"\"\"
    return lambda *on: tree.RevoluteJoint(*on, axis)


def slide(axis):
    \"\"\"Say how a slide is made.\"\"\"
    return lambda *on: tree.PrismaticJoint(*on, axis)


def screw(axis, pitch):
    \"\"\"Say how a screw is made: its pitch is in metres per revolution.\"\"\"
    return lambda *on: tree.ScrewJoint(*on, axis, 2 * np.pi * pitch, 0.0)


def skew(x):
    \"\"\"Make the matrix of the cross product.\"\"\"
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def spatial(mass, com, inertia):
    \"\"\"Make Drake's inertia: its unit inertia is about the body's origin.\"\"\"
    about = np.array(inertia) / mass - skew(com) @ skew(com) if mass else np.zeros((3, 3))
    unit = tree.UnitInertia(about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2])
    return tree.SpatialInertia(mass, com, unit, skip_validity_check=True)


def add(parent, joints, name, rotation, translation, mass, com, inertia, armature=()):
    \"\"\"Add a body on its joints, with massless bodies between.\"\"\"
    place = RigidTransform(RotationMatrix(np.array(rotation)), translation)
    frame = plant.AddFrame(tree.FixedOffsetFrame(f\"{name}_on\", bodies[parent].body_frame(), place))
    for k, make in enumerate(joints):
        last = k + 1 == len(joints)
        held = spatial(mass, com, inertia) if last else tree.SpatialInertia.Zero()
        body = plant.AddRigidBody(name if last else f\"{name}_{k}\", held)
        joint = plant.AddJoint(make(f\"{name}_joint_{k}\", frame, body.body_frame()))
        if any(armature):
            motor = plant.AddJointActuator(f\"{name}_motor_{k}\", joint)
            motor.set_default_rotor_inertia(armature[k])
            motor.set_default_gear_ratio(1.0)
        frame = body.body_frame()
    bodies.append(body)


",
    body,
    end: "plant.Finalize()
context = plant.CreateDefaultContext()
drive = plant.get_applied_generalized_force_input_port().FixValue(context, np.zeros(plant.num_velocities()))


def at():
    \"\"\"Set the state.\"\"\"
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    drive.GetMutableData().get_mutable_value().SetFromVector(tau)
    return context


def inverse(acceleration):
    \"\"\"Compute the forces of an acceleration.\"\"\"
    forces = tree.MultibodyForces(plant)
    plant.CalcForceElementsContribution(at(), forces)
    return plant.CalcInverseDynamics(context, acceleration, forces)
",
    armature: "",
    answers: &[
        ("id", "inverse_dynamics", "inverse(a)"),
        ("bias", "bias_term", "plant.CalcBiasTerm(at()) - plant.CalcGravityGeneralizedForces(context)"),
        ("bias", "inverse_dynamics", "inverse(0 * v)"),
        ("mass_matrix", "crba", "plant.CalcMassMatrix(at())"),
        ("mass_matrix", "inverse_dynamics", "plant.CalcMassMatrixViaInverseDynamics(at())"),
        ("fd", "aba", "plant.get_generalized_acceleration_output_port().Eval(at())"),
    ],
    theirs: |robot| Theirs::of(robot, Convention::Drake),
};

fn body(bodies: &[BodyDescription], at: usize) -> Option<String> {
    let body = bodies.get(at)?;
    let joints = match body.joint.kind {
        JointType::Fixed => return None,
        JointType::Revolute { axis } => format!("turn({})", list(&axis)),
        JointType::Prismatic { axis } => format!("slide({})", list(&axis)),
        JointType::Helical { axis, pitch } => format!("screw({}, {})", list(&axis), number(pitch)),
        JointType::Spherical => "tree.BallRpyJoint".into(),
        JointType::Free => "tree.QuaternionFloatingJoint".into(),
        JointType::Planar => "tree.PlanarJoint".into(),
        JointType::Universal => "tree.UniversalJoint".into(),
        row => {
            let one = |one: OneDof| format!("{}({})", if one.turns { "turn" } else { "slide" }, super::axis(&one.axis));
            row.row().into_iter().map(one).collect::<Vec<_>>().join(", ")
        }
    };
    let armed = body.joint.armature.iter().any(|armature| *armature != 0.0);
    let has_motors = !matches!(body.joint.kind, JointType::Spherical | JointType::Free | JointType::Planar | JointType::Universal);
    // Drake holds no rotational inertia without mass, and has motors on joints of one degree of freedom.
    if body.mass == 0.0 && body.inertia.iter().any(|entry| *entry != 0.0) || armed && !has_motors {
        return None;
    }
    let armature = if armed { format!(", {}", list(&body.joint.armature)) } else { String::new() };
    Some(super::add(body, &format!("[{joints}]"), body, &body.joint.placement.translation, &armature))
}
