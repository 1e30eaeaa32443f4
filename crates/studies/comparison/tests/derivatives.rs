//! The study of derivatives convicts planted errors, and acquits right answers. The gates are those of `ci/gates.toml`.

use featherbench_bench::{Engine, Quantity, Robot};
use featherbench_comparison::Derivatives;
use featherbench_doubles::{Answer, Double, Twist, gates, robot, whole};
use featherbench_engines::Featherbench;
use featherbench_model::{JointKind, Topology};
use featherbench_results::{Row, Verdict};
use std::sync::LazyLock;

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

/// Mistakes by their names.
const MISTAKES: [(&str, Twist); 9] = [
    ("a wrong sign of one column", last_column),
    ("a transposed matrix", transpose),
    ("the wrong acceleration of the base", classical),
    ("a coriolis matrix with the right product alone", same_product),
    ("parameters in another order", reordered),
    ("a wrong sign", |answer| answer.values.iter_mut().for_each(|x| *x = -*x)),
    ("a base that turns about world axes", |answer| columns_in_parent_axes(answer, true)),
    ("a ball that turns about its parents axes", |answer| columns_in_parent_axes(answer, false)),
    ("a lost number", lost),
];

/// The rows of all mistakes beside each other: the truth is computed once.
static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let robot = robot(ROBOT);
    let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
    engines.extend(MISTAKES.map(|(name, twist)| Box::new(Double::twisting(&robot, twist).named(name)) as Box<dyn Engine>));
    whole(&Derivatives::default(), &robot, &gates(""), &engines)
});

/// Asserts that a mistake in these quantities fails each of them, and nothing else.
#[track_caller]
fn convicted(mistake: &str, wrong: &[Quantity]) {
    let rows = &*ROWS;
    let of_it: Vec<&Row> = rows.iter().filter(|row| row.engine == mistake).collect();
    assert!(!of_it.is_empty(), "{mistake}");
    let mut failed: Vec<&str> = of_it.iter().filter(|row| row.verdict == Verdict::Fail).map(|row| row.quantity.as_str()).collect();
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
    convicted("a wrong sign", &Quantity::DERIVATIVES);
}

fn last_column(answer: Answer) {
    let n = answer.robot.states.nv;
    if answer.quantity != Quantity::TorqueRegressor {
        answer.values.iter_mut().skip(n - 1).step_by(n).for_each(|x| *x = -*x);
    }
}

#[test]
fn a_wrong_sign_of_one_column_is_convicted() {
    convicted("a wrong sign of one column", &SQUARE);
}

fn transpose(answer: Answer) {
    let n = answer.robot.states.nv;
    if answer.quantity != Quantity::TorqueRegressor {
        let given = answer.values.clone();
        answer.values.iter_mut().enumerate().for_each(|(entry, x)| *x = given[entry % n * n + entry / n]);
    }
}

#[test]
fn a_transposed_matrix_is_convicted() {
    convicted("a transposed matrix", &SQUARE);
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
    convicted("a base that turns about world axes", &BY_Q);
}

#[test]
fn a_ball_that_turns_about_its_parents_axes_is_convicted() {
    convicted("a ball that turns about its parents axes", &BY_Q);
}

/// The derivative of the classical acceleration of the base in the place of that of v: ∂(v̇ + ω × v)/∂v.
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

#[test]
fn the_wrong_acceleration_of_the_base_is_convicted() {
    convicted("the wrong acceleration of the base", &[Quantity::ForwardDynamicsDv]);
}

/// Another Coriolis matrix with the same C v, and vᵀ(Ṁ − 2C)v = 0: it is not the one with Ṁ = C + Cᵀ.
fn same_product(answer: Answer) {
    let (n, v) = (answer.robot.states.nv, answer.robot.states.v(answer.state));
    if answer.quantity == Quantity::CoriolisMatrix && n > 1 {
        answer.values[0] += v[1];
        answer.values[1] -= v[0];
    }
}

#[test]
fn a_coriolis_matrix_with_the_right_product_alone_is_convicted() {
    convicted("a coriolis matrix with the right product alone", &[Quantity::CoriolisMatrix]);
}

fn reordered(answer: Answer) {
    if answer.quantity == Quantity::TorqueRegressor {
        answer.values.chunks_exact_mut(10).for_each(|body| body.swap(6, 7));
    }
}

#[test]
fn parameters_in_another_order_are_convicted() {
    convicted("parameters in another order", &[Quantity::TorqueRegressor]);
}

fn lost(answer: Answer) {
    if answer.state == 1 {
        answer.values[0] = f64::NAN;
    }
}

#[test]
fn a_lost_number_is_convicted() {
    for quantity in Quantity::DERIVATIVES {
        let passed = ROWS.iter().filter(|row| row.engine == "a lost number" && row.quantity == quantity.name() && row.metric == "true");
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
