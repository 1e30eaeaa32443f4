//! The study of derivatives convicts planted errors, and acquits right answers. The gates are those of `ci/gates.toml`.

use crate::support;

use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_engines::Featherbench;
use featherbench_model::{JointKind, Topology};
use featherbench_results::{Row, Verdict};
use featherbench_studies::Derivatives;
use support::{Answer, Double, Twist, doubles, gates, robot, whole};

/// Small, with every quaternion joint and a moving base, so that every mistake of a frame shows.
const ROBOT: &str = "tree:n=7,joints=all,seed=4,base=free,armature=true";

fn rows(robot: &Robot, double: Double) -> Vec<Row> {
    whole(&Derivatives::default(), robot, &gates(""), &[Box::new(Featherbench::new()), Box::new(double)])
}

/// Our own kernels and an honest double pass every gate, and each quantity is judged.
#[test]
fn right_derivatives_pass() {
    for spec in
        [ROBOT, "joints:kind=spherical,base=fixed,shape=single", "joints:kind=revolute,base=fixed,shape=single", "chain:n=6,layout=spatial"]
    {
        let robot = robot(spec);
        let rows = rows(&robot, Double::of(&robot));
        for row in &rows {
            assert!(
                matches!(row.verdict, Verdict::Pass | Verdict::Info),
                "{spec}, {} {} {}: {}",
                row.engine,
                row.quantity,
                row.method,
                row.reason
            );
        }
        for quantity in Quantity::DERIVATIVES {
            for method in Featherbench::new().methods(quantity) {
                let judged =
                    rows.iter().filter(|row| row.quantity == quantity.name() && row.method == method && row.verdict == Verdict::Pass);
                assert!(judged.count() >= 2, "{spec}: {} by {method} is judged for both engines", quantity.name());
            }
        }
    }
}

/// Asserts that a mistake in these quantities fails each of them, and nothing else.
#[track_caller]
fn convicted(twist: Twist, wrong: &[Quantity]) {
    let robot = robot(ROBOT);
    let rows = rows(&robot, Double::twisting(&robot, twist));
    let mut failed: Vec<&str> = doubles(&rows, Verdict::Fail).iter().map(|row| row.quantity.as_str()).collect();
    failed.sort_unstable();
    failed.dedup();
    let mut due: Vec<&str> = wrong.iter().map(|quantity| quantity.name()).collect();
    due.sort_unstable();
    assert_eq!(failed, due);
    assert!(rows.iter().filter(|row| row.engine == "featherbench").all(|row| row.verdict != Verdict::Fail));
}

const BY_Q: [Quantity; 2] = [Quantity::InverseDynamicsDq, Quantity::ForwardDynamicsDq];
const SQUARE: [Quantity; 5] = [
    Quantity::InverseDynamicsDq,
    Quantity::InverseDynamicsDv,
    Quantity::ForwardDynamicsDq,
    Quantity::ForwardDynamicsDv,
    Quantity::CoriolisMatrix,
];

#[test]
fn a_wrong_sign_is_convicted() {
    convicted(|answer| answer.values.iter_mut().for_each(|x| *x = -*x), &Quantity::DERIVATIVES);
}

#[test]
fn a_wrong_sign_of_one_column_is_convicted() {
    fn last_column(answer: Answer) {
        let n = answer.robot.states.nv;
        if answer.quantity != Quantity::TorqueRegressor {
            answer.values.iter_mut().skip(n - 1).step_by(n).for_each(|x| *x = -*x);
        }
    }
    convicted(last_column, &SQUARE);
}

#[test]
fn a_transposed_matrix_is_convicted() {
    fn transpose(answer: Answer) {
        let n = answer.robot.states.nv;
        if answer.quantity != Quantity::TorqueRegressor {
            let given = answer.values.clone();
            answer.values.iter_mut().enumerate().for_each(|(entry, x)| *x = given[entry % n * n + entry / n]);
        }
    }
    convicted(transpose, &SQUARE);
}

/// The three dofs by which the base turns, or a ball joint, and where its quaternion begins.
fn turns(topology: &Topology, free: bool) -> Option<(usize, usize)> {
    topology.joints().iter().find_map(|joint| match joint.kind {
        JointKind::Free if free => Some((joint.v + 3, joint.q + 3)),
        JointKind::Spherical if !free => Some((joint.v, joint.q)),
        _ => None,
    })
}

/// Columns along world axes instead of body axes: X Rᵀ in the place of X.
fn columns_in_parent_axes(answer: Answer, free: bool) {
    if !BY_Q.contains(&answer.quantity) {
        return;
    }
    let n = answer.robot.states.nv;
    let (dof, at) = turns(&answer.robot.model.topology, free).unwrap();
    let q = answer.robot.states.q(answer.state);
    let rotation = featherbench_spatial::Quaternion::from_array([q[at], q[at + 1], q[at + 2], q[at + 3]]).to_rotation().to_array();
    for row in answer.values.chunks_exact_mut(n) {
        let given = [row[dof], row[dof + 1], row[dof + 2]];
        for (k, x) in row[dof..dof + 3].iter_mut().enumerate() {
            *x = (0..3).map(|j| given[j] * rotation[3 * k + j]).sum();
        }
    }
}

#[test]
fn a_base_that_turns_about_world_axes_is_convicted() {
    convicted(|answer| columns_in_parent_axes(answer, true), &BY_Q);
}

#[test]
fn a_ball_that_turns_about_its_parents_axes_is_convicted() {
    convicted(|answer| columns_in_parent_axes(answer, false), &BY_Q);
}

/// The derivative of the classical acceleration of the base in the place of that of v: ∂(v̇ + ω × v)/∂v.
#[test]
fn the_wrong_acceleration_of_the_base_is_convicted() {
    fn classical(answer: Answer) {
        if answer.quantity == Quantity::ForwardDynamicsDv {
            let (n, v) = (answer.robot.states.nv, answer.robot.states.v(answer.state).to_vec());
            let skew = |u: &[f64]| [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
            for i in 0..3 {
                for j in 0..3 {
                    answer.values[i * n + j] += skew(&v[3..6])[i][j];
                    answer.values[i * n + 3 + j] -= skew(&v[..3])[i][j];
                }
            }
        }
    }
    convicted(classical, &[Quantity::ForwardDynamicsDv]);
}

/// Another Coriolis matrix with the same C v, and vᵀ(Ṁ − 2C)v = 0: it is not the one with Ṁ = C + Cᵀ.
#[test]
fn a_coriolis_matrix_with_the_right_product_alone_is_convicted() {
    fn same_product(answer: Answer) {
        let (n, v) = (answer.robot.states.nv, answer.robot.states.v(answer.state));
        if answer.quantity == Quantity::CoriolisMatrix && n > 1 {
            answer.values[0] += v[1];
            answer.values[1] -= v[0];
        }
    }
    convicted(same_product, &[Quantity::CoriolisMatrix]);
}

#[test]
fn parameters_in_another_order_are_convicted() {
    fn reordered(answer: Answer) {
        if answer.quantity == Quantity::TorqueRegressor {
            answer.values.chunks_exact_mut(10).for_each(|body| body.swap(6, 7));
        }
    }
    convicted(reordered, &[Quantity::TorqueRegressor]);
}

#[test]
fn a_lost_number_is_convicted() {
    fn lost(answer: Answer) {
        if answer.state == 1 {
            answer.values[0] = f64::NAN;
        }
    }
    let robot = robot(ROBOT);
    let rows = rows(&robot, Double::twisting(&robot, lost));
    for quantity in Quantity::DERIVATIVES {
        let passed = rows.iter().filter(|row| row.engine == "double" && row.quantity == quantity.name() && row.metric == "true");
        assert!(passed.filter(|row| row.verdict != Verdict::Pass).count() > 0, "{}", quantity.name());
    }
}

/// An engine that offers methods and then no answer is told of in every quantity.
#[test]
fn an_engine_without_answers_has_rows() {
    let robot = robot("chain:n=2");
    let rows = rows(&robot, Double::refusing(&robot));
    for quantity in Quantity::DERIVATIVES {
        assert!(rows.iter().any(|row| row.engine == "double" && row.quantity == quantity.name() && row.verdict == Verdict::Skip));
    }
}
