//! One spatial Coulomb contact: open, sticking, and every slip direction.
//!
//! In the axes where the cone is circular with μ = 1 a slip direction u has λ = p (1, −u), c_n = 0 and c_t = s u. Eliminating p leaves
//!
//! ```text
//! f(φ) = (G_nn − g·u) (u × b_t) − b_n (u × (g − G_tt u)) = a0 + a1 cos φ + b1 sin φ + a2 cos 2φ + b2 sin 2φ,   u = (cos φ, sin φ)
//! ```
//!
//! so there are at most four directions. They are the eigenvalues of a companion matrix, corrected in double-double arithmetic.

use super::enumeration::{Exact, Search, Violation, negative, signorini};
use crate::ball::Ball;
use crate::extended::{self, Solved};
use crate::problem::{Friction, Problem};
use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::{DMatrix, Matrix4};

/// All solutions of a problem with one spatial contact; or the reason why it is not such a problem. Roots of a quartic prove nothing: where
/// none is a solution, there may be one.
pub(super) fn search(problem: &Problem, exact: &Exact) -> Result<Search, &'static str> {
    let [contact] = problem.contacts() else { return Err("it enumerates a round cone only if it is the only contact") };
    let Friction::Coulomb { coefficients } = &contact.friction else { return Err("it has no friction pyramids") };
    let scale: Vec<Ball> = std::iter::once(1.0).chain(coefficients.iter().copied()).map(Ball::exact).collect();
    let matrix = extended::Matrix::from_fn(3, 3, |row, column| scale[row] * exact.matrix[(row, column)] * scale[column]);
    let free: Vec<Ball> = exact.free.iter().zip(&scale).map(|(b, s)| *b * *s).collect();
    let mut search = Search { certain: false, ..Search::new() };
    let mut candidates = vec![vec![Ball::exact(0.0); 3]];
    match extended::solve(matrix.clone(), free.iter().map(|b| -*b).collect()).0 {
        Solved::Unique(impulses) => candidates.push(impulses),
        Solved::Many(_) => return Err("its Delassus matrix is singular, and a round cone then has infinitely many modes"),
        Solved::Inconsistent => {}
    }
    let (middle, middles) = (matrix.map(Ball::middle), free.iter().map(|b| b.middle()).collect::<Vec<_>>());
    for (sine, cosine) in directions(&middle, &middles) {
        let (sine, cosine) = (Ball::at(sine), Ball::at(cosine));
        let along = |row: usize| matrix[(row, 1)] * cosine + matrix[(row, 2)] * sine;
        let normal = -free[0] / (matrix[(0, 0)] - along(0));
        if normal.to_f64().is_finite() {
            candidates.push(vec![normal, -(normal * cosine), -(normal * sine)]);
        }
    }
    search.modes = candidates.len();
    for candidate in candidates {
        let velocities = extended::times_plus(&matrix, &candidate, &free);
        // A root is not exact: what it breaks may be its own error.
        let violation = Violation { certain: false, ..violation(&candidate, &velocities) };
        let impulses = candidate.iter().zip(&scale).map(|(x, s)| *x * *s).collect();
        search.offer(impulses, violation, exact.zero);
    }
    Ok(search)
}

/// Signorini's law, the cone, and maximum dissipation in the axes where the cone is circular.
fn violation(impulses: &[Ball], velocities: &[Ball]) -> Violation {
    let norm = |v: &[Ball]| Ball::at((v[1] * v[1] + v[2] * v[2]).middle().sqrt());
    let gap = impulses[1] * velocities[1] + impulses[2] * velocities[2] + impulses[0] * norm(velocities);
    signorini(impulses[0], velocities[0]).or(negative(impulses[0] - norm(impulses))).or(Violation::of(gap))
}

/// The coefficients a0, a1, b1, a2, b2 of f.
fn coefficients(matrix: &DMatrix<DoubleDouble>, free: &[DoubleDouble]) -> [DoubleDouble; 5] {
    let half = DoubleDouble::from_f64(0.5);
    let (g1, g2) = (matrix[(0, 1)], matrix[(0, 2)]);
    let (bn, b1, b2) = (free[0], free[1], free[2]);
    let normal = matrix[(0, 0)];
    [
        half * (g2 * b1 - g1 * b2),
        normal * b2 - bn * g2,
        bn * g1 - normal * b1,
        bn * matrix[(1, 2)] - half * (g1 * b2 + g2 * b1),
        half * (bn * (matrix[(2, 2)] - matrix[(1, 1)]) + g1 * b1 - g2 * b2),
    ]
}

/// Sine and cosine of every zero of f.
fn directions(matrix: &DMatrix<DoubleDouble>, free: &[DoubleDouble]) -> Vec<(DoubleDouble, DoubleDouble)> {
    let exact = coefficients(matrix, free);
    let [a0, a1, b1, a2, b2] = exact.map(DoubleDouble::to_f64);
    let value = |angle: f64| a0 + a1 * angle.cos() + b1 * angle.sin() + a2 * (2.0 * angle).cos() + b2 * (2.0 * angle).sin();
    // t = tan((φ − turn)/2) misses the direction opposite to `turn`: take one where f is large.
    let opposite = (0..7).map(f64::from).reduce(|best, angle| if value(angle).abs() > value(best).abs() { angle } else { best });
    let turn = opposite.unwrap_or(0.0) + std::f64::consts::PI;
    let (sine, cosine) = turn.sin_cos();
    let (sine2, cosine2) = (2.0 * turn).sin_cos();
    let (c1, s1) = (a1 * cosine + b1 * sine, b1 * cosine - a1 * sine);
    let (c2, s2) = (a2 * cosine2 + b2 * sine2, b2 * cosine2 - a2 * sine2);
    // (1 + t²)² f: coefficients of t⁰ … t⁴.
    let quartic = [a0 + c1 + c2, 2.0 * s1 + 4.0 * s2, 2.0 * a0 - 6.0 * c2, 2.0 * s1 - 4.0 * s2, a0 - c1 + c2];
    if quartic[4] == 0.0 || !quartic.iter().all(|c| c.is_finite()) {
        return Vec::new();
    }
    let mut companion = Matrix4::zeros();
    for k in 0..4 {
        companion[(k, 3)] = -quartic[k] / quartic[4];
        if k > 0 {
            companion[(k, k - 1)] = 1.0;
        }
    }
    let companion = DMatrix::from_iterator(4, 4, companion.iter().copied());
    let roots = companion.complex_eigenvalues();
    // A double root is known to half the digits only: take what is nearly real, and let the exact laws decide.
    let real = roots.iter().filter(|root| root.im.abs() <= 1e-5 * (1.0 + root.re.abs()));
    real.map(|root| corrected(&exact, turn + 2.0 * root.re.atan())).collect()
}

/// Newton's steps on f from an angle, in double-double arithmetic.
fn corrected(&[a0, a1, b1, a2, b2]: &[DoubleDouble; 5], angle: f64) -> (DoubleDouble, DoubleDouble) {
    let two = DoubleDouble::from_f64(2.0);
    let mut angle = DoubleDouble::from_f64(angle);
    // Each step doubles the digits of a simple root: 1e-8 becomes 1e-32 in two. Double roots gain one bit each.
    for _ in 0..6 {
        let ((s, c), (s2, c2)) = (angle.sin_cos(), (two * angle).sin_cos());
        let value = a0 + a1 * c + b1 * s + a2 * c2 + b2 * s2;
        let slope = b1 * c - a1 * s + two * (b2 * c2 - a2 * s2);
        let step = value / slope;
        if !step.to_f64().is_finite() {
            break;
        }
        angle -= step;
    }
    angle.sin_cos()
}
