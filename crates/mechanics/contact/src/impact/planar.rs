//! Poisson's and Stronge's laws at one planar contact: the impact as a process in the normal impulse.
//!
//! Source: E. J. Routh, *Dynamics of a System of Rigid Bodies* (1905); J. B. Keller, *Impact with friction* (1986); W. J. Stronge, *Impact
//! Mechanics* (2000). While the normal impulse p grows, dc/dp = G (1, −μ s) in slip with s = sign(c_t), and G (1, −G_nt/G_tt) in stick.
//! Both are constant, so each phase is a straight line and the whole impact is a few of them.

use super::{Law, NoImpact};
use crate::problem::{Friction, Problem};
use nalgebra::{DVector, Matrix2, Vector2};

/// When an impact ends, as a function of what compression was.
enum End {
    /// At this normal impulse.
    Impulse(f64),
    /// When the normal impulse has done this work, counted from the end of compression.
    Work(f64),
}

pub(super) fn impulses(problem: &Problem, law: Law) -> Result<DVector<f64>, NoImpact> {
    let refuse = |reason| Err(NoImpact::Law { law: law.name(), reason });
    let [contact] = problem.contacts() else { return refuse("takes one contact; use a sequence for several") };
    let friction = match &contact.friction {
        Friction::None => None,
        Friction::Coulomb { coefficients } if coefficients.len() == 1 => Some(coefficients[0]),
        _ => return refuse("takes a planar Coulomb contact or one without friction"),
    };
    let (g, b) = (problem.delassus(), problem.free());
    // Without friction the tangent row is one that never moves.
    let matrix =
        if friction.is_some() { Matrix2::new(g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)]) } else { Matrix2::new(g[(0, 0)], 0.0, 0.0, 1.0) };
    let before = Vector2::new(b[0], if friction.is_some() { b[1] } else { 0.0 });
    let mut process = Process { matrix, friction: friction.unwrap_or(0.0), velocity: before, impulse: Vector2::zeros(), work: 0.0 };
    if before[0] < 0.0 {
        let endless = || NoImpact::NoSolution { law: law.name() };
        process.compress().ok_or_else(endless)?;
        let e = contact.restitution;
        let end = if law == Law::Poisson { End::Impulse((1.0 + e) * process.impulse[0]) } else { End::Work(-e * e * process.work) };
        process.work = 0.0;
        process.restore(&end).ok_or_else(endless)?;
    }
    Ok(DVector::from_iterator(problem.rows(), process.impulse.iter().copied().take(problem.rows())))
}

struct Process {
    matrix: Matrix2<f64>,
    friction: f64,
    velocity: Vector2<f64>,
    impulse: Vector2<f64>,
    /// ∫ c_n dp.
    work: f64,
}

/// More phases than this do not occur: slip, stick or reversed slip, in compression and in restitution.
const PHASES: usize = 8;

impl Process {
    /// The impulse per normal impulse, λ_t/λ_n, of the present phase.
    fn ratio(&self) -> f64 {
        let (mu, coupling, tangent) = (self.friction, self.matrix[(0, 1)], self.matrix[(1, 1)]);
        let slip = self.velocity[1];
        if slip != 0.0 {
            return -mu * slip.signum();
        }
        // Sticks if friction can hold; otherwise slips in the direction in which the normal impulse drives it.
        if coupling.abs() <= mu * tangent { if tangent > 0.0 { -coupling / tangent } else { 0.0 } } else { -mu * coupling.signum() }
    }

    /// The rate of the velocity, and how much normal impulse the phase lasts at most: until slip ends.
    fn phase(&self) -> (f64, Vector2<f64>, f64) {
        let ratio = self.ratio();
        let mut rate = self.matrix * Vector2::new(1.0, ratio);
        let slip = self.velocity[1];
        let sticks = slip == 0.0 && self.matrix[(0, 1)].abs() <= self.friction * self.matrix[(1, 1)];
        if sticks {
            rate[1] = 0.0;
        }
        let lasts = if slip * rate[1] < 0.0 { -slip / rate[1] } else { f64::INFINITY };
        (ratio, rate, lasts)
    }

    /// Moves on by a normal impulse. At the end of slip the tangent velocity is exactly zero.
    fn advance(&mut self, ratio: f64, rate: Vector2<f64>, by: f64, slip_ends: bool) {
        self.work += by * (self.velocity[0] + 0.5 * rate[0] * by);
        self.velocity += rate * by;
        self.impulse += Vector2::new(1.0, ratio) * by;
        if slip_ends {
            self.velocity[1] = 0.0;
        }
    }

    /// Until the normal velocity is zero; none if it never is.
    fn compress(&mut self) -> Option<()> {
        for _ in 0..PHASES {
            let (ratio, rate, lasts) = self.phase();
            let ends = if rate[0] > 0.0 { -self.velocity[0] / rate[0] } else { f64::INFINITY };
            if ends <= lasts {
                if ends == f64::INFINITY {
                    return None;
                }
                self.advance(ratio, rate, ends, ends == lasts);
                self.velocity[0] = 0.0;
                return Some(());
            }
            self.advance(ratio, rate, lasts, true);
        }
        None
    }

    /// Until the end that the law asks for; none if it never comes.
    fn restore(&mut self, end: &End) -> Option<()> {
        for _ in 0..PHASES {
            let (ratio, rate, lasts) = self.phase();
            let ends = match end {
                End::Impulse(total) => total - self.impulse[0],
                End::Work(total) => until(self.velocity[0], rate[0], total - self.work),
            };
            if ends <= lasts {
                if !ends.is_finite() {
                    return None;
                }
                self.advance(ratio, rate, ends, ends == lasts);
                return Some(());
            }
            self.advance(ratio, rate, lasts, true);
        }
        None
    }
}

/// The positive p with c p + ½ r p² = work ≥ 0; infinite if there is none.
fn until(c: f64, r: f64, work: f64) -> f64 {
    if work <= 0.0 {
        return 0.0;
    }
    let discriminant = c * c + 2.0 * r * work;
    let denominator = c + discriminant.sqrt();
    // Written without cancellation; a negative discriminant gives NaN, which is no end.
    if denominator > 0.0 { 2.0 * work / denominator } else { f64::INFINITY }
}
