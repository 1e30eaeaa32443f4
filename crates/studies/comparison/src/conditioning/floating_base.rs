//! Condition numbers of a robot with a floating base: of M, and of both Schur complements, each also scaled to a unit diagonal.
//!
//! S_bb = M_bb − M_bj M_jj⁻¹ M_jb is what the base meets while the joints are free, S_jj = M_jj − M_jb M_bb⁻¹ M_bj what the joints meet while
//! the base floats. The inverse of each is a block of M⁻¹, and M⁻¹ has eigenvalues below and above those of its blocks. So neither complement has
//! a larger condition number than M: elimination by blocks loses no conditioning. That is a gate, and so is the error of both complements
//! against double-double.

use super::{condition, scaled_to_unit_diagonal};
use featherbench_bench::{Cell, Context, Outcome, Robot};
use featherbench_dynamics::{FloatingBase, TreeSparse, mass_matrix};
use featherbench_results::{Row, Verdict};
use featherbench_robots::Case;
use featherbench_spatial::{DoubleDouble, Real, larger};
use featherbench_study::row;
use nalgebra::DMatrix;
use std::ops::Range;

/// The method of cells.
pub(super) const METHOD: &str = "partition";

/// Condition numbers are medians over so many random states: poses differ, and eigenvalues of the largest robots take seconds.
pub(super) const STATES: usize = 5;

/// The condition numbers, in the order of an outcome.
pub(super) const METRICS: [&str; 6] = ["kappa", "kappa_scaled", "kappa_base", "kappa_base_scaled", "kappa_joints", "kappa_joints_scaled"];

/// What is judged, behind them: the largest of both ratios, and the largest error, over all states.
const JUDGED: [&str; 2] = ["complement_over_whole", "complement_error"];

/// The dofs of a floating base.
const BASE: usize = 6;

/// Whether a robot is partitioned: one floating base carries everything, and there are joints.
pub(super) fn takes(robot: &Robot) -> bool {
    robot.states.nv > BASE && FloatingBase::<f64>::new(&robot.model.topology).is_ok()
}

/// The numbers of [`METRICS`] and [`JUDGED`], or why there are none.
pub(super) fn numbers(robot: &Robot) -> Result<Vec<f64>, String> {
    let topology = &robot.model.topology;
    let mut workspace = FloatingBase::new(topology).map_err(|error| error.to_string())?;
    let mut exact = FloatingBase::new(topology).map_err(|error| error.to_string())?;
    let random = (0..robot.states.count()).filter(|&k| robot.states.cases[k] == Case::Random).take(STATES);
    let (mut conditions, mut judged) = (vec![Vec::new(); METRICS.len()], [0.0; JUDGED.len()]);
    for k in random {
        let matrix = mass_matrix(&robot.model, robot.states.q(k)).map_err(|error| error.to_string())?;
        let found = complements(&mut workspace, &matrix)?;
        let lifted = TreeSparse::from_fn(topology, |i, j| DoubleDouble::from_f64(matrix.get(i, j)));
        let truth = complements(&mut exact, &lifted)?;

        let whole = matrix.to_dense();
        let kappa = condition(whole.clone());
        let [base, joints] = found.each_ref().map(|complement| condition(complement.clone()));
        let [whole_scaled, base_scaled, joints_scaled] =
            [&whole, &found[0], &found[1]].map(|matrix| condition(scaled_to_unit_diagonal(matrix)));
        for (all, number) in conditions.iter_mut().zip([kappa, whole_scaled, base, base_scaled, joints, joints_scaled]) {
            all.push(number);
        }
        let (base_dofs, joint_dofs) = (0..BASE, BASE..matrix.size());
        for (place, (own, other)) in [(base_dofs.clone(), joint_dofs.clone()), (joint_dofs, base_dofs)].into_iter().enumerate() {
            let error = error(&found[place], &truth[place], &whole, own, other).ok_or("a block of M is not positive definite")?;
            judged[1] = larger(judged[1], error);
        }
        judged[0] = [base / kappa, joints / kappa].into_iter().fold(judged[0], larger);
    }
    if conditions[0].is_empty() {
        return Err("the robot has no random state".into());
    }
    let numbers: Vec<f64> = conditions.into_iter().map(median).chain(judged).collect();
    if numbers.iter().all(|number| number.is_finite()) { Ok(numbers) } else { Err("a condition number is not finite".into()) }
}

/// The rows of a finished cell.
pub(super) fn rows(context: &Context, robot: &Robot, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let blank = Row { states: Case::Random.name().into(), unit: "1".into(), ..row(cell, robot) };
    let Some(values) = outcome.values().filter(|values| values.len() == METRICS.len() + JUDGED.len()) else {
        return vec![blank.without_value(Verdict::Error, "there are no condition numbers")];
    };
    let (conditions, judged) = values.split_at(METRICS.len());
    let of = |metric: &str| Row { metric: metric.into(), ..blank.clone() };
    let informed = METRICS.iter().zip(conditions).map(|(metric, &value)| of(metric).informed(value));
    let judged = JUDGED.iter().zip(judged).map(|(metric, &value)| context.gates.judge(of(metric), value, 1.0));
    informed.chain(judged).collect()
}

/// S_bb and S_jj.
fn complements<T: Real + nalgebra::Scalar>(workspace: &mut FloatingBase<T>, matrix: &TreeSparse<T>) -> Result<[DMatrix<T>; 2], String> {
    let joints = matrix.size() - BASE;
    workspace.run(matrix).map_err(|error| error.to_string())?;
    let base = workspace.articulated_inertia();
    let mut dense = vec![T::zero(); joints * joints];
    workspace.joint_complement(&mut dense).map_err(|error| error.to_string())?;
    Ok([DMatrix::from_fn(BASE, BASE, |i, j| base[i][j]), DMatrix::from_row_slice(joints, joints, &dense)])
}

/// The largest error of the complement of `own` dofs, as a change of M: any change |δM_kl| ≤ η √(M_kk M_ll) moves the complement by
/// |δS_ij| ≤ η a_i a_j at most. So the largest |δS_ij| / (a_i a_j) is a change that is needed to explain the error.
///
/// `δS = [1, −Xᵀ] δM [1; −X]` to first order, with X = M_other⁻¹ M_other,own, and `a_i = √M_ii + Σ_k |X_ki| √M_kk`.
fn error(found: &DMatrix<f64>, truth: &DMatrix<DoubleDouble>, whole: &DMatrix<f64>, own: Range<usize>, other: Range<usize>) -> Option<f64> {
    let root = |dof: usize| whole[(dof, dof)].sqrt();
    let block =
        |rows: &Range<usize>, columns: &Range<usize>| whole.view((rows.start, columns.start), (rows.len(), columns.len())).into_owned();
    let x = block(&other, &other).cholesky()?.solve(&block(&other, &own));
    let reach: Vec<f64> = (0..own.len())
        .map(|i| root(own.start + i) + (0..other.len()).map(|k| x[(k, i)].abs() * root(other.start + k)).sum::<f64>())
        .collect();
    let off = |i: usize, j: usize| (DoubleDouble::from_f64(found[(i, j)]) - truth[(i, j)]).to_f64().abs() / (reach[i] * reach[j]);
    let n = own.len();
    Some((0..n * n).map(|place| off(place / n, place % n)).fold(0.0, larger))
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
