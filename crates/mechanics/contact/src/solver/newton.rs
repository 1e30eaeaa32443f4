//! Semismooth Newton methods on three laws: Coulomb's, its convex relaxation, and compliant contacts.
//!
//! Source: P. Alart and A. Curnier, *A mixed formulation for frictional contact problems prone to Newton like solution methods* (1991).
//! The residual may only fall. Where no Newton step makes it smaller, sweeps of a first-order method go on from there. Where the matrix is
//! singular (more contact rows than dofs) the step is the shortest that solves the linear system in least squares.

use super::standard::Standard;
use super::{Solver, Unsupported, positive};
use crate::cones::{self, Linearized};
use crate::problem::Problem;
use crate::solution::{Outcome, Solution};
use featherbench_spatial::{larger, smaller};
use nalgebra::{DMatrix, DVector};

/// Newton's method on the true laws (function of Alart and Curnier). O(rows³) per step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// The largest residual of an answer, free of units.
    pub tolerance: f64,
    /// The cap on Newton steps.
    pub steps: usize,
}

impl Default for Newton {
    fn default() -> Self {
        Self { tolerance: 1e-12, steps: 2000 }
    }
}

/// Newton's method on the convex relaxation K ∋ λ ⊥ c ∈ K*. Its answer obeys other equations than Coulomb's, and
/// [`Point::residuals`](crate::Point) shows by how much.
///
/// ```
/// use featherbench_contact::systems::Incline;
/// use featherbench_contact::{Convex, Solver};
/// let incline = Incline::default();
/// let solution = Convex::default().solve(&incline.problem()?)?;
/// let point = solution.point().ok_or("no answer")?;
/// // It slides, and so it opens, which Signorini's law forbids while the contact pushes.
/// assert!((point.velocities[0] - incline.relaxed().1).abs() < 1e-12);
/// assert!(point.residuals.signorini > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convex {
    /// The largest residual of an answer in the relaxation, free of units.
    pub tolerance: f64,
    /// The cap on Newton steps.
    pub steps: usize,
}

impl Default for Convex {
    fn default() -> Self {
        Self { tolerance: 1e-12, steps: 2000 }
    }
}

/// Compliant contacts: λ_n = k max(0, −c_n), λ_t = the point of the friction disk next to −k c_t. The laws hold as k grows, with errors 1/k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty {
    /// k, in units of the problem's impulse scale by its velocity scale.
    pub stiffness: f64,
    /// The largest residual of an answer in the compliant equations, free of units.
    pub tolerance: f64,
    /// The cap on Newton steps.
    pub steps: usize,
}

impl Default for Penalty {
    fn default() -> Self {
        Self { stiffness: 1e4, tolerance: 1e-12, steps: 2000 }
    }
}

impl Solver for Newton {
    fn name(&self) -> &'static str {
        "newton"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        let standard = Standard::new(problem, self.name(), true)?;
        run(problem, &Law { standard, convex: false, compliance: 0.0 }, self.name(), (self.tolerance, self.steps))
    }
}

impl Solver for Convex {
    fn name(&self) -> &'static str {
        "convex"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        let standard = Standard::new(problem, self.name(), false)?;
        run(problem, &Law { standard, convex: true, compliance: 0.0 }, self.name(), (self.tolerance, self.steps))
    }
}

impl Solver for Penalty {
    fn name(&self) -> &'static str {
        "penalty"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        positive(self.name(), "stiffness", self.stiffness)?;
        let standard = Standard::new(problem, self.name(), false)?;
        let law = Law { standard, convex: false, compliance: 1.0 / self.stiffness };
        run(problem, &law, self.name(), (self.tolerance, self.steps))
    }
}

/// The equations F(x) = 0, where c = (A + compliance·1) x + b.
struct Law {
    standard: Standard,
    convex: bool,
    compliance: f64,
}

impl Law {
    fn velocities(&self, x: &DVector<f64>) -> DVector<f64> {
        self.standard.velocities(x) + x * self.compliance
    }

    fn map(&self, contact: usize, x: &DVector<f64>, c: &DVector<f64>) -> Linearized {
        let range = self.standard.range(contact);
        let (x, c) = (&x.as_slice()[range.clone()], &c.as_slice()[range]);
        let steps = self.standard.steps(contact).map(|step| step / (1.0 + self.compliance * step));
        if self.convex {
            cones::convex_map(x, c, if steps[0] < steps[1] { steps[0] } else { steps[1] })
        } else {
            cones::coulomb_map(x, c, steps)
        }
    }

    fn value(&self, x: &DVector<f64>) -> DVector<f64> {
        let c = self.velocities(x);
        let mut value = DVector::zeros(x.len());
        for contact in 0..self.standard.contacts() {
            let map = self.map(contact, x, &c);
            for (k, row) in self.standard.range(contact).enumerate() {
                value[row] = map.value[k];
            }
        }
        value
    }

    /// The derivative ∂F/∂x = F_x + F_c (A + compliance·1).
    fn derivative(&self, x: &DVector<f64>) -> DMatrix<f64> {
        let c = self.velocities(x);
        let size = x.len();
        let mut derivative = DMatrix::zeros(size, size);
        for contact in 0..self.standard.contacts() {
            let map = self.map(contact, x, &c);
            let range = self.standard.range(contact);
            for (k, row) in range.clone().enumerate() {
                for (l, column) in range.clone().enumerate() {
                    derivative[(row, column)] += map.by_impulse[k][l] + self.compliance * map.by_velocity[k][l];
                    if map.by_velocity[k][l] != 0.0 {
                        for all in 0..size {
                            derivative[(row, all)] += map.by_velocity[k][l] * self.standard.matrix[(column, all)];
                        }
                    }
                }
            }
        }
        derivative
    }

    /// The residual in which the answer is judged: the natural map of the law, whose unit is that of x.
    fn residual(&self, x: &DVector<f64>) -> f64 {
        let c = self.velocities(x);
        let standard = &self.standard;
        if !self.convex {
            return standard.residual(x, &c);
        }
        let one =
            |contact: usize| cones::convex_map(&x.as_slice()[standard.range(contact)], &c.as_slice()[standard.range(contact)], 1.0).value;
        (0..standard.contacts()).flat_map(one).map(f64::abs).fold(0.0, larger)
    }

    /// Steps of a first-order method from a point: Gauss–Seidel for Coulomb's law, block projections for the relaxation.
    fn sweep(&self, x: &mut DVector<f64>) {
        if !self.convex {
            self.standard.sweep(x, self.compliance);
            return;
        }
        for contact in 0..self.standard.contacts() {
            let range = self.standard.range(contact);
            let block = self.standard.matrix.view((range.start, range.start), (range.len(), range.len()));
            let trace = block.trace();
            let step = if trace > 0.0 { 1.0 / trace } else { 1.0 };
            let c: Vec<f64> = range.clone().map(|row| (self.standard.matrix.row(row) * &*x)[0] + self.standard.free[row]).collect();
            let part = &mut x.as_mut_slice()[range];
            part.iter_mut().zip(c).for_each(|(x, c)| *x -= step * c);
            cones::project(part);
        }
    }
}

/// How many first-order sweeps come first, and how many where Newton's method gains nothing: twice as many each time, up to a limit.
const SWEEPS: usize = 20;
const MOST_SWEEPS: usize = 640;
/// A norm below this part of the lowest is another place: the same local minimum is reached again up to the steps' lengths.
const LOWER: f64 = 0.9;
/// A singular value below this part of the largest counts as zero: rounding leaves 1e-16 per row.
const RANK: f64 = 1e-12;

fn run(problem: &Problem, law: &Law, name: &'static str, (tolerance, cap): (f64, usize)) -> Result<Solution, Unsupported> {
    positive(name, "tolerance", tolerance)?;
    let mut x = DVector::zeros(law.standard.size());
    let (mut steps, mut sweeps) = (Vec::new(), SWEEPS);
    // The lowest norm of F at which Newton's method gained nothing, and whether it has gained since.
    let (mut lowest, mut gained) = (f64::INFINITY, false);
    let mut residual = law.residual(&x);
    if residual > tolerance {
        (0..SWEEPS).for_each(|_| law.sweep(&mut x));
        residual = law.residual(&x);
    }
    while residual > tolerance && residual.is_finite() && steps.len() < cap {
        let value = law.value(&x);
        let derivative = law.derivative(&x);
        let better = DIRECTIONS.into_iter().find_map(|by| {
            let step = direction(&derivative, &value, by)?;
            shortened(law, &x, &step, value.norm())
        });
        let next = match better {
            Some(next) => {
                gained = true;
                next
            }
            None => {
                // A local minimum of ‖F‖ takes Newton's method back after each short series of sweeps: only a lower one is a gain.
                let norm = value.norm();
                if gained && norm < LOWER * lowest {
                    sweeps = SWEEPS;
                }
                (lowest, gained) = (smaller(lowest, norm), false);
                let mut swept = x.clone();
                (0..sweeps).for_each(|_| law.sweep(&mut swept));
                sweeps = (2 * sweeps).min(MOST_SWEEPS);
                swept
            }
        };
        steps.push((&next - &x).amax());
        x = next;
        residual = law.residual(&x);
        if steps.last().is_some_and(|step| *step <= f64::EPSILON) {
            break;
        }
    }
    let (iterations, point) = (steps.len(), law.standard.point(problem, &x));
    let outcome = Outcome::judged(point, residual <= tolerance, iterations >= cap);
    Ok(Solution { outcome, iterations, steps })
}

/// How a Newton step is found.
#[derive(Clone, Copy)]
enum By {
    /// By elimination, with a part of the largest diagonal entry added to the diagonal.
    Elimination(f64),
    /// The shortest least-squares step.
    LeastSquares,
}

/// The ways to a Newton step, in the order in which they are tried.
const DIRECTIONS: [By; 4] = [By::Elimination(0.0), By::Elimination(1e-9), By::Elimination(1e-3), By::LeastSquares];

fn direction(derivative: &DMatrix<f64>, value: &DVector<f64>, by: By) -> Option<DVector<f64>> {
    let step = match by {
        By::LeastSquares => {
            let parts = derivative.clone().try_svd(true, true, f64::EPSILON, 0)?;
            let zero = RANK * parts.singular_values.max();
            parts.solve(&-value, zero).ok()?
        }
        By::Elimination(part) => {
            let mut matrix = derivative.clone();
            let added = part * matrix.diagonal().amax();
            (0..matrix.nrows()).for_each(|k| matrix[(k, k)] += added);
            matrix.lu().solve(&-value)?
        }
    };
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// The first point along a step, halved at most five times, whose value is smaller by a part of what the step promises.
fn shortened(law: &Law, x: &DVector<f64>, step: &DVector<f64>, norm: f64) -> Option<DVector<f64>> {
    (0..=5).map(|halvings| 0.5_f64.powi(halvings)).map(|part| (part, x + step * part)).find_map(|(part, next)| {
        let sufficient = law.value(&next).norm() <= (1.0 - 0.1 * part) * norm;
        sufficient.then_some(next)
    })
}
