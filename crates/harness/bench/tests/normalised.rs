//! One meaning for axes and rotations that are not exactly normalised: the `f64` kernels, the double-double truth and the multi-precision
//! witness answer for the same robot. Each deviates by one ulp to 1e-7; so does a product of three such joints.

use featherbench_bench::measure::{Magnitudes, scaled_error};
use featherbench_bench::{Quantity, Robot};
use featherbench_dynamics::{Crba, Jacobian, Kinematics, Rnea, TreeSparse};
use featherbench_model::{Description, JointType, Label, Model};
use featherbench_reference::{Mp, Precision, Robot as Witness};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, Random};
use featherbench_spatial::{DoubleDouble, Lift};
use std::path::Path;

/// An ulp of one, and more.
const OFF: [f64; 5] = [f64::EPSILON, 1e-15, 1e-12, 1e-9, 1e-7];
/// The gate on the agreement of engines (ci/gates.toml).
const GATE: f64 = 1e-14;
/// Double-double against more digits: 2⁻¹⁰⁶ = 1.2e-32, some hundred roundings along a path of twenty joints, and cancellation by 100.
const WIDE: f64 = 1e-28;

fn panda() -> Description {
    featherbench_formats::neutral::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../datasets/models/panda.json")).unwrap()
}

fn generated(spec: &str) -> Description {
    Family::parse(spec).unwrap().generate().unwrap()
}

/// Three joints with romeo's axis, in a chain.
fn romeo() -> Description {
    let mut robot = generated("chain:n=3,layout=spatial");
    for body in &mut robot.bodies {
        body.joint.kind = JointType::Revolute { axis: [0.0, -1.0, -4.371_14e-8] };
    }
    robot
}

/// The same robot, each number of an axis or rotation changed by up to `off` of it.
fn moved(robot: &Description, off: f64) -> Description {
    let mut robot = robot.clone();
    let mut random = Random::named(21, "not quite unit");
    let mut nudge = |x: &mut f64| *x *= 1.0 + off * random.uniform(-1.0, 1.0);
    for joint in robot.bodies.iter_mut().map(|body| &mut body.joint) {
        if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut joint.kind {
            axis.iter_mut().for_each(&mut nudge);
        }
        joint.placement.rotation.iter_mut().for_each(&mut nudge);
    }
    robot
}

fn wide(numbers: &[f64]) -> Vec<DoubleDouble> {
    numbers.iter().map(|&x| x.lift()).collect()
}

fn narrow(numbers: &[DoubleDouble]) -> Vec<f64> {
    numbers.iter().map(|x| x.to_f64()).collect()
}

/// |a − b| of a double-double and a number of more digits.
fn apart(a: DoubleDouble, b: &Mp) -> f64 {
    let (high, low) = b.to_pair();
    (a - DoubleDouble::from_sum(high, low)).abs().to_f64()
}

/// Compares kernels, truth and witness on a robot as it is written.
#[track_caller]
fn one_meaning(name: &str, written: &Description) {
    let robot = Robot::new(written, "test", ModelOrigin::Generated, 3, 7).unwrap();
    let witness = Witness::new(written, Precision::for_dofs(written.nv())).unwrap();
    let truth = Model::<DoubleDouble>::build(written).unwrap();
    let (model, states) = (&robot.model, &robot.states);
    let (topology, nv, body) = (&model.topology, states.nv, model.described[robot.deepest_body()]);
    for k in 0..states.count() {
        let (q, v, a) = (states.q(k), states.v(k), states.a(k));
        let at = Magnitudes::new(&robot, k);
        let (wide_q, wide_v, wide_a) = (wide(q), wide(v), wide(a));
        let held = |quantity: Quantity, truth: &[DoubleDouble], ours: &[f64]| {
            let error = scaled_error(&robot, quantity, &at, &narrow(truth), ours);
            assert!(error <= GATE, "{name}, state {k}: our {} is {error:e} from the truth", quantity.name());
        };

        // M: witness, truth and kernel
        let due = witness.mass_matrix(q).unwrap();
        let mut mass = TreeSparse::new(topology);
        Crba::new(topology).run(&truth, &wide_q, &mut mass).unwrap();
        let entries: Vec<DoubleDouble> = (0..nv * nv).map(|entry| mass.get(entry / nv, entry % nv)).collect();
        for (entry, (found, due_entry)) in entries.iter().zip(due.entries()).enumerate() {
            let (i, j) = (entry / nv, entry % nv);
            let scale = (due.get(i, i).to_f64() * due.get(j, j).to_f64()).sqrt();
            let error = apart(*found, due_entry) / scale;
            assert!(error <= WIDE, "{name}, state {k}: M({i}, {j}) of the truth is {error:e} from the witness");
        }
        let mut ours = TreeSparse::new(topology);
        Crba::new(topology).run(model, q, &mut ours).unwrap();
        held(Quantity::MassMatrix, &entries, &(0..nv * nv).map(|entry| ours.get(entry / nv, entry % nv)).collect::<Vec<_>>());

        // inverse dynamics
        let due = witness.inverse_dynamics(q, v, a).unwrap();
        let mut tau = wide(&vec![0.0; nv]);
        Rnea::new(topology).run(&truth, &wide_q, &wide_v, &wide_a, None, &mut tau).unwrap();
        for (dof, (found, due)) in tau.iter().zip(&due).enumerate() {
            let error = apart(*found, due) / at.joint_force[dof];
            assert!(error <= WIDE, "{name}, state {k}: τ({dof}) of the truth is {error:e} from the witness");
        }
        let mut ours = vec![0.0; nv];
        Rnea::new(topology).run(model, q, v, a, None, &mut ours).unwrap();
        held(Quantity::InverseDynamics, &tau, &ours);

        // placements and the Jacobian
        let (mut exact, mut ours) = (Kinematics::new(topology), Kinematics::new(topology));
        exact.run(&truth, &wide_q, &wide_v, &wide_a).unwrap();
        ours.run(model, q, v, a).unwrap();
        let (mut due, mut found) = (Vec::new(), Vec::new());
        for &body in &model.described {
            let (exact, ours) = (exact.body(body).unwrap().placement, ours.body(body).unwrap().placement);
            due.extend(exact.rotation.to_array().into_iter().chain(exact.translation.to_array()));
            found.extend(ours.rotation.to_array().into_iter().chain(ours.translation.to_array()));
        }
        held(Quantity::BodyPlacement, &due, &found);
        let (mut exact, mut ours) = (Jacobian::new(topology), Jacobian::new(topology));
        let due: Vec<[DoubleDouble; 6]> = exact.run(&truth, &wide_q, body).unwrap().iter().map(|column| column.to_array()).collect();
        let found: Vec<[f64; 6]> = ours.run(model, q, body).unwrap().iter().map(|column| column.to_array()).collect();
        let order: Vec<(usize, usize)> = (0..6).flat_map(|row| (0..nv).map(move |dof| (row, dof))).collect();
        let due: Vec<DoubleDouble> = order.iter().map(|&(row, dof)| due[dof][row]).collect();
        let found: Vec<f64> = order.iter().map(|&(row, dof)| found[dof][row]).collect();
        held(Quantity::BodyJacobian, &due, &found);
    }
}

#[test]
fn axes_and_rotations_that_are_not_quite_unit_mean_one_robot() {
    let robots = [
        ("panda", panda()),
        ("tree", generated("tree:n=20,seed=1")),
        ("tree of all joints", generated("tree:n=16,seed=5,joints=all,base=free")),
        ("romeo's joints", romeo()),
    ];
    for (name, robot) in &robots {
        one_meaning(name, robot);
        for off in OFF {
            one_meaning(&format!("{name}, off by {off:e}"), &moved(robot, off));
        }
    }
}

/// Engines, our kernels and the witness all get the same canonical numbers.
#[test]
fn everybody_gets_the_canonical_numbers() {
    for off in OFF {
        let robot = Robot::new(&moved(&panda(), off), "test", ModelOrigin::Robot, 1, 1).unwrap();
        assert_eq!(robot.description.canonical().unwrap(), robot.description, "off by {off:e}");
        // The message to an oracle is made from this description, made canonical once more.
        let line = featherbench_formats::neutral::to_line(&robot.description).unwrap();
        let sent = featherbench_formats::neutral::parse(&line, "the line").unwrap();
        let model = &robot.model;
        for (i, (body, sent)) in robot.description.bodies.iter().zip(&sent.bodies).enumerate() {
            assert_eq!((body.joint.kind, body.joint.placement), (sent.joint.kind, sent.joint.placement), "off by {off:e}");
            let parent = body.parent.map_or(Label::Z, |parent| model.labels[parent]);
            let turned = model.labels[i].rotation_to_described(model.placements[i].rotation);
            let turned = parent.rotation_to_described(turned.transpose()).transpose();
            assert_eq!(turned.to_array(), body.joint.placement.rotation);
        }
        if off > f64::EPSILON {
            assert!(!robot.model.warnings.is_empty(), "off by {off:e}: nothing is told");
        }
    }
}
