//! Which parameters a body can have, log-Cholesky numbers, and exciting trajectories.

use super::{Case, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_identification::{Arm, Base, Gravity, LinearModel, LogCholesky, PseudoInertia, Search, Terms, excite};
use featherbench_robots::Random;
use serde_json::json;

/// Bodies that are drawn.
const DRAWS: usize = 200;

pub(super) fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = shapes().into_iter().map(|(name, pi, rank, exists)| shape(name, pi, rank, exists)).collect();
    cases.extend([round_trip(), jacobian(), trajectory()]);
    cases
}

/// Ten parameters, the rank of the pseudo-inertia, and whether a body has them.
fn shapes() -> Vec<(&'static str, [f64; 10], usize, bool)> {
    let (m, r, l) = (2.0, 0.3, 0.8);
    let (ball, rod) = (0.4 * m * r * r, m * l * l / 12.0);
    vec![
        ("solid ball", [m, 0.0, 0.0, 0.0, ball, 0.0, 0.0, ball, 0.0, ball], 4, true),
        ("thin rod", [m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, rod, 0.0, rod], 2, true),
        // At (1, 2, −1): h = m c, Ī = m (c·c 1 − c cᵀ).
        ("point mass", [m, m, 2.0 * m, -m, 5.0 * m, -2.0 * m, m, 2.0 * m, 2.0 * m, 5.0 * m], 1, true),
        ("moments 1, 1, 3", [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 3.0], 3, false),
    ]
}

fn shape(name: &'static str, pi: [f64; 10], rank: usize, exists: bool) -> Case {
    Case {
        name: name.into(),
        quantity: "pseudo_inertia",
        method: "eigenvalues".into(),
        params: json!({"parameters": pi}),
        numbers: vec![
            count("positive", rank as f64, "closed form"),
            count("exists", f64::from(u8::from(exists)), "physics"),
            told("smallest_eigenvalue", "SI"),
        ],
        evaluate: Box::new(move |_| {
            let found = PseudoInertia::of(&pi).consistency();
            Ok(vec![found.rank as f64, f64::from(u8::from(found.is_consistent())), found.smallest])
        }),
    }
}

fn drawn(random: &mut Random) -> LogCholesky {
    LogCholesky(std::array::from_fn(|k| match k {
        0 => random.uniform(-3.0, 3.0),
        1..=3 => random.uniform(-3.0, -0.5),
        _ => random.uniform(-0.5, 0.5),
    }))
}

fn log_cholesky(
    method: &'static str,
    metric: &'static str,
    of: impl Fn(&LogCholesky) -> Result<f64, NoAnswer> + Send + Sync + 'static,
) -> Case {
    Case {
        name: "drawn bodies".into(),
        quantity: "log_cholesky",
        method: method.into(),
        params: json!({"draws": DRAWS}),
        numbers: vec![error(metric, "second route")],
        evaluate: Box::new(move |seed| {
            let mut random = Random::named(seed, "log-Cholesky");
            let errors: Result<Vec<f64>, NoAnswer> = (0..DRAWS).map(|_| of(&drawn(&mut random))).collect();
            Ok(vec![largest(errors?)])
        }),
    }
}

/// π → φ → π, each entry over the largest of its kind.
fn round_trip() -> Case {
    log_cholesky("there and back", "round_trip", |phi| {
        let pi = phi.parameters();
        let back = LogCholesky::of(&pi).ok_or_else(|| NoAnswer::Failed("P is not positive definite".into()))?.parameters();
        let inertia = largest([pi[4], pi[7], pi[9]]);
        Ok(largest((0..10).map(|k| (pi[k] - back[k]) / if k < 4 { pi[0] } else { inertia })))
    })
}

/// The Jacobian against central differences, extrapolated from two steps.
fn jacobian() -> Case {
    log_cholesky("Jacobian", "jacobian_error", |phi| {
        let jacobian = phi.jacobian();
        let error = |column: usize| {
            let central = |h: f64| {
                let at = |step: f64| {
                    let mut moved = *phi;
                    moved.0[column] += step;
                    moved.parameters()
                };
                let (up, down) = (at(h), at(-h));
                move |k: usize| (up[k] - down[k]) / (2.0 * h)
            };
            let (fine, coarse) = (central(5e-4), central(1e-3));
            let size = largest(jacobian.column(column).iter().copied());
            largest((0..10).map(|k| ((4.0 * fine(k) - coarse(k)) / 3.0 - jacobian[(k, column)]) / size))
        };
        Ok(largest((0..10).map(error)))
    })
}

/// An exciting trajectory: within its limits between the points of the search, and better than the first that was drawn.
fn trajectory() -> Case {
    let arm = Arm::puma560();
    Case {
        name: arm.name.clone(),
        quantity: "excitation",
        method: "Fourier".into(),
        params: json!({"joints": arm.joints}),
        numbers: vec![
            count("broken_limits", 0.0, "description"),
            error("condition_over_first", "first draw"),
            told("condition", "1"),
            told("scaled_condition", "1"),
        ],
        evaluate: Box::new(move |seed| {
            let linear = LinearModel::new(&arm.describe(Gravity::Parallel, 1), Terms::NONE).map_err(failed)?;
            let base = Base::of_robot(&linear, seed).map_err(failed)?;
            let search = Search { draws: 10, changes: 40, frequency: 0.2, seed, ..Search::default() };
            let found = excite(&linear, &base, &search).map_err(failed)?;
            let samples = found.trajectory.samples(&linear, &linear.nominal(), 2000, 1.0).map_err(failed)?;
            let nv = linear.dofs().len();
            let broken = |at: &usize| {
                let (dof, limits) = (&linear.dofs()[at % nv], linear.model().limits[at % nv]);
                let inside = samples.q[*at] >= limits.0 && samples.q[*at] <= limits.1;
                !(inside && samples.v[*at].abs() <= dof.speed && samples.tau[*at].abs() <= dof.effort)
            };
            let broken = (0..samples.tau.len()).filter(broken).count();
            Ok(vec![broken as f64, found.condition / found.first, found.condition, found.scaled])
        }),
    }
}
