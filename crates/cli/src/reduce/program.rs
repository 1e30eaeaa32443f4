//! A program that shows an error in the engine's own interface: the robot, body by body, the state, the answer beside the truth.
//!
//! Only robots of hinges and slides have one, and for Pinocchio of balls: there the engines have the neutral coordinates.

use ::featherbench_results::Row;
use featherbench_bench::{Quantity, Robot};
use featherbench_model::{BodyDescription, JointType};
use std::fmt::Write;

/// How an engine's interface makes a robot and answers.
struct Interface {
    /// The imports, and an empty robot; `{gravity}` is replaced.
    begin: &'static str,
    /// A body; `{name}`, `{parent}`, `{kind}`, `{axis}`, `{rotation}`, `{translation}`, `{mass}`, `{com}` and `{inertia}` are replaced.
    body: &'static str,
    /// The words of hinges and slides.
    kinds: [&'static str; 2],
    /// The words of a ball, where its coordinates are the neutral ones.
    ball: Option<&'static str>,
    /// What follows the last body.
    end: &'static str,
    /// The answers by quantity and method.
    answers: &'static [(&'static str, &'static str, &'static str)],
}

const PINOCCHIO: Interface = Interface {
    begin: "import numpy as np
import pinocchio as pin

model = pin.Model()
model.gravity = pin.Motion(np.array({gravity}), np.zeros(3))
bodies = [0]
",
    body: "place = pin.SE3(np.array({rotation}), np.array({translation}))
bodies.append(model.addJoint(bodies[{parent}], pin.{kind}, place, \"{name}\"))
model.appendBodyToJoint(bodies[-1], pin.Inertia({mass}, np.array({com}), np.array({inertia})), pin.SE3.Identity())
",
    kinds: ["JointModelRevoluteUnaligned(np.array({axis}))", "JointModelPrismaticUnaligned(np.array({axis}))"],
    ball: Some("JointModelSpherical()"),
    end: "data = model.createData()


def full(upper):
    \"\"\"Mirror the upper triangle.\"\"\"
    upper = np.triu(upper)
    return upper + np.triu(upper, 1).T
",
    answers: &[
        ("id", "rnea", "pin.rnea(model, data, q, v, a)"),
        ("mass_matrix", "crba_local", "full(pin.crba(model, data, q, pin.Convention.LOCAL))"),
        ("mass_matrix", "crba_world", "full(pin.crba(model, data, q, pin.Convention.WORLD))"),
        ("fd", "aba_local", "pin.aba(model, data, q, v, tau, pin.Convention.LOCAL)"),
        ("fd", "aba_world", "pin.aba(model, data, q, v, tau, pin.Convention.WORLD)"),
        ("fd", "minverse", "full(pin.computeMinverse(model, data, q)) @ (tau - pin.rnea(model, data, q, v, 0 * v))"),
        ("fd", "crba_cholesky", "np.linalg.solve(full(pin.crba(model, data, q)), tau - pin.rnea(model, data, q, v, 0 * v))"),
    ],
};

const MUJOCO: Interface = Interface {
    begin: "import mujoco
import numpy as np

spec = mujoco.MjSpec()
spec.compiler.degree = spec.compiler.balanceinertia = spec.compiler.fusestatic = False
spec.compiler.boundmass = spec.compiler.boundinertia = 0
spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
spec.option.gravity = {gravity}
bodies = [spec.worldbody]


def quaternion(rotation):
    \"\"\"Convert a rotation to a quaternion, w first.\"\"\"
    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, np.array(rotation).ravel())
    return out


def principal(inertia):
    \"\"\"Compute principal moments, and the quaternion of their axes.\"\"\"
    moments, axes = np.linalg.eigh(np.array(inertia))
    if (np.diag(np.diag(inertia)) == inertia).all():
        moments, axes = np.diag(inertia), np.eye(3)
    return moments, quaternion(axes * np.sign(np.linalg.det(axes)))
",
    body: "body = bodies[{parent}].add_body(name=\"{name}\", pos={translation}, quat=quaternion({rotation}))
body.add_joint(name=\"{name}\", type=mujoco.mjtJoint.{kind}, axis={axis})
moments, turn = principal({inertia})
body.explicitinertial, body.mass, body.ipos, body.inertia, body.iquat = True, {mass}, {com}, moments, turn
bodies.append(body)
",
    kinds: ["mjJNT_HINGE", "mjJNT_SLIDE"],
    ball: None,
    end: "model = spec.compile()
data = mujoco.MjData(model)


def forward():
    \"\"\"Compute M and the acceleration.\"\"\"
    data.qpos, data.qvel, data.qfrc_applied = q, v, tau
    mujoco.mj_forward(model, data)
    return data.qacc.copy()


def mass():
    \"\"\"Compute M.\"\"\"
    forward()
    out = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, out)
    return out


def inverse():
    \"\"\"Compute the forces of an acceleration.\"\"\"
    data.qpos, data.qvel, data.qacc = q, v, a
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse.copy()
",
    answers: &[
        ("id", "inverse", "inverse()"),
        ("id", "rne", "inverse()"),
        ("mass_matrix", "crb", "mass()"),
        ("fd", "forward", "forward()"),
    ],
};

const DRAKE: Interface = Interface {
    begin: "import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant

plant = MultibodyPlant(0.0)
plant.mutable_gravity_field().set_gravity_vector({gravity})
bodies = [plant.world_body()]


def skew(x):
    \"\"\"Make the matrix of the cross product.\"\"\"
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def add(parent, kind, name, axis, rotation, translation, mass, com, inertia):
    \"\"\"Add a body on a joint.\"\"\"
    about = np.array(inertia) / mass - skew(com) @ skew(com)
    unit = tree.UnitInertia(about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2])
    body = plant.AddRigidBody(name, tree.SpatialInertia(mass, com, unit, skip_validity_check=True))
    place = RigidTransform(RotationMatrix(np.array(rotation)), translation)
    frame = plant.AddFrame(tree.FixedOffsetFrame(f\"{name}_on\", bodies[parent].body_frame(), place))
    plant.AddJoint(kind(f\"{name}_joint\", frame, body.body_frame(), axis))
    bodies.append(body)

",
    body: "
add({parent}, tree.{kind}, \"{name}\", {axis}, {rotation}, {translation}, {mass}, {com}, {inertia})",
    kinds: ["RevoluteJoint", "PrismaticJoint"],
    ball: None,
    end: "
plant.Finalize()
context = plant.CreateDefaultContext()
drive = plant.get_applied_generalized_force_input_port().FixValue(context, np.zeros(plant.num_velocities()))


def at():
    \"\"\"Set the state.\"\"\"
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    drive.GetMutableData().get_mutable_value().SetFromVector(tau)
    return context


def inverse():
    \"\"\"Compute the forces of an acceleration.\"\"\"
    forces = tree.MultibodyForces(plant)
    plant.CalcForceElementsContribution(at(), forces)
    return plant.CalcInverseDynamics(context, np.array(a), forces)
",
    answers: &[
        ("id", "inverse_dynamics", "inverse()"),
        ("mass_matrix", "crba", "plant.CalcMassMatrix(at())"),
        ("mass_matrix", "inverse_dynamics", "plant.CalcMassMatrixViaInverseDynamics(at())"),
        ("fd", "aba", "plant.get_generalized_acceleration_output_port().Eval(at())"),
    ],
};

const DART: Interface = Interface {
    begin: "import numpy as np
from dartpy import dynamics
from dartpy.math import Isometry3

robot = dynamics.Skeleton(\"robot\")
robot.setGravity({gravity})
bodies = [None]
",
    body: "joint, body = robot.{kind}(bodies[{parent}])
joint.setAxis({axis})
joint.setTransformFromParentBodyNode(Isometry3(np.array({rotation}), np.array({translation})))
body.setInertia(dynamics.Inertia({mass}, np.array({com}), np.array({inertia})))
bodies.append(body)
",
    kinds: ["createRevoluteJointAndBodyNodePair", "createPrismaticJointAndBodyNodePair"],
    ball: None,
    end: "

def at():
    \"\"\"Set the state.\"\"\"
    robot.setPositions(q)
    robot.setVelocities(v)
    return robot


def forward():
    \"\"\"Compute the acceleration.\"\"\"
    at().setForces(tau)
    robot.computeForwardDynamics()
    return robot.getAccelerations()


def inverse():
    \"\"\"Compute the forces of an acceleration.\"\"\"
    at().setAccelerations(a)
    robot.computeInverseDynamics()
    return robot.getForces()
",
    answers: &[
        ("id", "inverse_dynamics", "inverse()"),
        ("mass_matrix", "mass_matrix", "at().getMassMatrix()"),
        ("fd", "aba", "forward()"),
        ("fd", "inverse_mass_matrix", "at().getInvMassMatrix() @ (np.array(tau) - robot.getCoriolisAndGravityForces())"),
    ],
};

/// The program of a case; `None` where the engine or the method has no such program, or the robot has other joints or armature.
pub fn of(row: &Row, quantity: Quantity, robot: &Robot, truth: &[f64]) -> Option<String> {
    let interface = match row.engine.as_str() {
        "pinocchio" => &PINOCCHIO,
        "mujoco" => &MUJOCO,
        "drake" => &DRAKE,
        "dart" => &DART,
        _ => return None,
    };
    let (.., answer) = interface.answers.iter().find(|(of, method, _)| *of == quantity.name() && *method == row.method)?;
    let mut text = format!(
        "\"\"\"{} {}: {} by {} on {}.\n\nIt prints the largest difference from the truth over the largest number of the truth.\n\"\"\"\n\n",
        row.engine,
        row.engine_version,
        quantity.name(),
        row.method,
        if robot.description.bodies.len() == 1 { "one body".to_owned() } else { format!("{} bodies", robot.description.bodies.len()) }
    );
    text += &interface.begin.replace("{gravity}", &list(&robot.description.gravity));
    for body in &robot.description.bodies {
        text += &body_text(interface, body)?;
    }
    text += interface.end;
    // All numbers are written so that they read back to the bit.
    for (name, numbers) in [("q", robot.states.q(0)), ("v", robot.states.v(0)), ("a", robot.states.a(0)), ("tau", robot.states.tau(0))] {
        write!(text, "\n{name} = np.array({})", list(numbers)).ok()?;
    }
    write!(
        text,
        "\ntruth = np.array({})\nanswer = np.ravel({answer})\nprint(np.abs(answer - truth).max() / np.abs(truth).max())\n",
        list(truth)
    )
    .ok()?;
    Some(text)
}

fn body_text(interface: &Interface, body: &BodyDescription) -> Option<String> {
    let (kind, axis) = match body.joint.kind {
        JointType::Revolute { axis } => (interface.kinds[0], axis),
        JointType::Prismatic { axis } => (interface.kinds[1], axis),
        JointType::Spherical => (interface.ball?, [0.0; 3]),
        _ => return None,
    };
    if body.joint.armature.iter().any(|&armature| armature != 0.0) {
        return None;
    }
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let rows = |m: [f64; 9]| format!("[{}, {}, {}]", list(&m[..3]), list(&m[3..6]), list(&m[6..]));
    let words = [
        ("{name}", body.name.clone()),
        // The world is the first of the list.
        ("{parent}", body.parent.map_or(0, |parent| parent + 1).to_string()),
        ("{kind}", kind.to_owned()),
        ("{axis}", list(&axis)),
        ("{rotation}", rows(body.joint.placement.rotation)),
        ("{translation}", list(&body.joint.placement.translation)),
        ("{mass}", format!("{:?}", body.mass)),
        ("{com}", list(&body.com)),
        ("{inertia}", rows([xx, xy, xz, xy, yy, yz, xz, yz, zz])),
    ];
    Some(words.iter().fold(interface.body.to_owned(), |text, (word, value)| text.replace(word, value)))
}

/// Numbers as Python reads them back to the bit.
fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}
