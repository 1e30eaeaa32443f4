//! How far impulses are from obeying the governing equations: one number per law, free of units.

use crate::cones;
use crate::problem::{Friction, Level, Problem};
use featherbench_spatial::larger;
use nalgebra::DVector;

/// The residuals of a point. Velocities are divided by the problem's velocity scale, impulses by its impulse scale; see
/// [`Problem::scales`]. Each number is the largest over all contacts; NaN stays NaN.
///
/// ```
/// use featherbench_contact::{Contact, Level, Problem, Residuals};
/// use nalgebra::{DMatrix, DVector};
/// let contact = vec![Contact::planar("tip", 0.5)];
/// let problem = Problem::from_delassus("point", Level::Impulse, contact, DMatrix::from_row_slice(2, 2, &[0.5, 0.0, 0.0, 0.5]), DVector::from_vec(vec![-3.0, 1.0])).unwrap();
/// // The impulse 6 N·s stops the normal motion, 2 N·s the sliding: within the cone.
/// assert_eq!(Residuals::of(&problem, &DVector::from_vec(vec![6.0, -2.0])).largest(), 0.0);
/// // Without friction the contact should not slide.
/// assert!(Residuals::of(&problem, &DVector::from_vec(vec![6.0, 0.0])).dissipation > 0.15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Signorini's law: |min(λ_n, c_n)|.
    pub signorini: f64,
    /// How far λ is outside the friction cone.
    pub cone: f64,
    /// Maximum dissipation: |c_tᵀλ_t + σ(c_t)|, where σ = max over the friction set of −c_tᵀ(·); for a Coulomb cone σ = λ_n ‖D c_t‖.
    /// Where λ_n is above its scale the gap is divided by it: it then tells how wrong c_t is, and not how hard the contact is pressed.
    pub dissipation: f64,
    /// ‖λ − P_K(λ − c − Γ(c))‖∞ with De Saxcé's Γ(c) = ‖D c_t‖ e_n, in the axes where the cone is circular with μ = 1.
    pub natural_map: f64,
    /// Kinetic energy that the contacts create: max(½ λᵀ(c + b), 0), divided by the largest impulse where that is above its scale. Zero in
    /// a problem with restitution or of forces, where it is no error.
    pub energy: f64,
}

impl Residuals {
    /// The residuals of impulses.
    ///
    /// # Panics
    /// If `impulses` does not have [`Problem::rows`] numbers.
    pub fn of(problem: &Problem, impulses: &DVector<f64>) -> Self {
        let scales = problem.scales();
        let velocities = (problem.velocities(impulses) + problem.restitution_shift()) / scales.velocity;
        let impulses = impulses / scales.impulse;
        let mut worst = Self { signorini: 0.0, cone: 0.0, dissipation: 0.0, natural_map: 0.0, energy: 0.0 };
        for (index, contact) in problem.contacts().iter().enumerate() {
            let range = problem.range(index);
            let (impulse, velocity) = (&impulses.as_slice()[range.clone()], &velocities.as_slice()[range]);
            let [cone, dissipation, natural_map] = laws(&contact.friction, impulse, velocity);
            let smaller = if impulse[0] < velocity[0] { impulse[0] } else { velocity[0] };
            let signorini = if impulse[0].is_nan() { impulse[0] } else { smaller.abs() };
            worst.signorini = larger(worst.signorini, signorini);
            worst.cone = larger(worst.cone, cone);
            worst.dissipation = larger(worst.dissipation, dissipation / larger(1.0, impulse[0]));
            worst.natural_map = larger(worst.natural_map, natural_map);
        }
        let elastic = problem.contacts().iter().any(|contact| contact.restitution > 0.0);
        if !elastic && problem.level() == Level::Impulse {
            let created = 0.5 * impulses.dot(&(velocities + problem.free() / scales.velocity));
            worst.energy = larger(0.0, created / larger(1.0, impulses.amax()));
        }
        worst
    }

    /// The largest of all.
    pub fn largest(&self) -> f64 {
        [self.signorini, self.cone, self.dissipation, self.natural_map, self.energy].into_iter().fold(0.0, larger)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Cone violation, dissipation gap and natural map of one contact.
fn laws(friction: &Friction, impulse: &[f64], velocity: &[f64]) -> [f64; 3] {
    let (normal, tangential, slip) = (impulse[0], &impulse[1..], &velocity[1..]);
    let below = larger(0.0, -normal);
    match friction {
        Friction::None => [below, 0.0, cones::natural(impulse, velocity)],
        Friction::Coulomb { coefficients } => {
            let scaled: Vec<f64> = slip.iter().zip(coefficients).map(|(c, mu)| c * mu).collect();
            // Where a coefficient is zero the impulse must be: its own size is the violation.
            let (mut stretched, mut without) = (vec![normal], 0.0);
            let mut stretched_velocity = vec![velocity[0]];
            for ((force, mu), slip) in tangential.iter().zip(coefficients).zip(&scaled) {
                if *mu > 0.0 {
                    stretched.push(force / mu);
                    stretched_velocity.push(*slip);
                } else {
                    without = larger(without, force.abs());
                }
            }
            let outside = larger(0.0, norm(&stretched[1..]) - normal);
            let gap = (dot(slip, tangential) + normal * norm(&scaled)).abs();
            [larger(larger(below, outside), without), gap, larger(cones::natural(&stretched, &stretched_velocity), without)]
        }
        Friction::Pyramid { vertices } => {
            let support = vertices.iter().map(|v| -dot(v, slip)).fold(f64::NEG_INFINITY, larger);
            let gap = (dot(slip, tangential) + normal * support).abs();
            let outside = polygon_distance(vertices, normal, tangential);
            // The natural map of the normal row alone: a polygon has no projection in closed form.
            [larger(below, outside), gap, cones::natural(&impulse[..1], &velocity[..1])]
        }
        Friction::Sliding { coefficient, direction } => {
            let off: Vec<f64> = tangential.iter().zip(direction).map(|(force, d)| force + coefficient * normal * d).collect();
            let off = norm(&off);
            [larger(below, off), off * norm(slip), larger(cones::natural(&impulse[..1], &velocity[..1]), off)]
        }
    }
}

/// How far a tangential impulse is outside λ_n times the hull of the vertices: the largest distance to a side's line, over outer sides.
fn polygon_distance(vertices: &[[f64; 2]], normal: f64, tangential: &[f64]) -> f64 {
    let mut worst = 0.0;
    for a in vertices {
        for b in vertices {
            let side = [b[0] - a[0], b[1] - a[1]];
            let length = norm(&side);
            let outward = |v: &[f64; 2]| side[1] * (v[0] - a[0]) - side[0] * (v[1] - a[1]);
            // A line with all vertices on one side is a side of the hull.
            if length > 0.0 && vertices.iter().all(|v| outward(v) <= 0.0) {
                let distance = (side[1] * (tangential[0] - normal * a[0]) - side[0] * (tangential[1] - normal * a[1])) / length;
                worst = larger(worst, distance);
            }
        }
    }
    worst
}
