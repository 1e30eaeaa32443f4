//! The study of condition numbers: what it says of floating bases, by a second route, and that its gates can fail.

use featherbench_bench::{Engine, Robot};
use featherbench_comparison::Conditioning;
use featherbench_doubles::{gates, robot, whole};
use featherbench_dynamics::mass_matrix;
use featherbench_engines::Featherbench;
use featherbench_results::{Row, Verdict};
use featherbench_robots::Case;
use nalgebra::DMatrix;

fn rows(robot: &Robot) -> Vec<Row> {
    whole(&Conditioning, robot, &gates(""), &[Box::new(Featherbench::new()) as Box<dyn Engine>])
}

fn value(rows: &[Row], metric: &str) -> f64 {
    let found: Vec<&Row> = rows.iter().filter(|row| row.metric == metric).collect();
    assert_eq!(found.len(), 1, "{metric}");
    found[0].value.unwrap_or_else(|| panic!("{metric}: {}", found[0].reason))
}

/// The largest singular value over the smallest.
fn by_singular_values(m: &DMatrix<f64>) -> f64 {
    let values = m.singular_values();
    values[0] / values[values.len() - 1]
}

fn scaled(m: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / (m[(i, i)] * m[(j, j)]).sqrt())
}

/// By singular values in place of eigenvalues, and by blocks of the inverse in place of Schur complements: κ(S) is that of S⁻¹.
#[test]
fn condition_numbers_of_blocks_are_those_of_blocks_of_the_inverse() {
    for spec in ["humanoid", "quadruped", "chain:n=12,layout=spatial,base=free", "tree:n=16,base=free,joints=all,armature=true"] {
        let robot = robot(spec);
        let rows = rows(&robot);
        let states = (0..robot.states.count()).filter(|&k| robot.states.cases[k] == Case::Random).take(5);
        let mut expected: Vec<[f64; 6]> = states
            .map(|k| {
                let m: DMatrix<f64> = mass_matrix(&robot.model, robot.states.q(k)).unwrap().to_dense();
                let (n, inverse) = (m.nrows(), m.clone().try_inverse().unwrap());
                let base = inverse.view((0, 0), (6, 6)).into_owned();
                let joints = inverse.view((6, 6), (n - 6, n - 6)).into_owned();
                let of = |block: &DMatrix<f64>| {
                    let complement = block.clone().try_inverse().unwrap();
                    [by_singular_values(block), by_singular_values(&scaled(&complement))]
                };
                let ([base, base_scaled], [joints, joints_scaled]) = (of(&base), of(&joints));
                [by_singular_values(&m), by_singular_values(&scaled(&m)), base, base_scaled, joints, joints_scaled]
            })
            .collect();
        assert!(!expected.is_empty(), "{spec}");
        let metrics = ["kappa", "kappa_scaled", "kappa_base", "kappa_base_scaled", "kappa_joints", "kappa_joints_scaled"];
        for (place, metric) in metrics.into_iter().enumerate() {
            expected.sort_by(|a, b| a[place].total_cmp(&b[place]));
            let (found, expected) = (value(&rows, metric), expected[expected.len() / 2][place]);
            // Inverting twice costs κ·ε.
            assert!((found / expected - 1.0).abs() < 64.0 * value(&rows, "kappa") * f64::EPSILON, "{spec}, {metric}: {found} {expected}");
        }
        let ratio = value(&rows, "complement_over_whole");
        assert!(ratio > 0.0 && ratio <= 1.0, "{spec}: {ratio}");
        let judged: Vec<&Row> = rows.iter().filter(|row| row.verdict != Verdict::Info).collect();
        assert!(judged.len() == 2 && judged.iter().all(|row| row.verdict == Verdict::Pass), "{spec}: {judged:?}");
        assert!(rows.iter().all(|row| row.states == "random" && row.method == "partition"), "{spec}");
    }
}

/// Robots that do not float have the straight configuration.
#[test]
fn robots_without_a_floating_base_are_not_partitioned() {
    for spec in ["chain:n=8", "star:n=6", "joints:kind=revolute,base=fixed"] {
        let rows = rows(&robot(spec));
        assert!(rows.iter().all(|row| row.method == "eigenvalues" && row.states == "straight"), "{spec}");
        assert!(value(&rows, "kappa") >= value(&rows, "kappa_scaled") && rows.iter().all(|row| row.metric != "complement_error"), "{spec}");
    }
}

#[test]
fn a_wrong_complement_fails() {
    let rows = rows(&robot("quadruped"));
    for (metric, good, bad) in [("complement_error", 1e-15, 1e-13), ("complement_over_whole", 0.9, 1.1)] {
        let row = rows.iter().find(|row| row.metric == metric).unwrap();
        for (value, verdict) in [(good, Verdict::Pass), (bad, Verdict::Fail), (f64::NAN, Verdict::Error)] {
            assert_eq!(gates("").judge(row.clone(), value, 1.0).verdict, verdict, "{metric} = {value}");
        }
    }
}
