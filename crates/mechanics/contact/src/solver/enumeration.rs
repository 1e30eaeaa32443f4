//! Enumeration: every mode of every contact, in double-double arithmetic. It finds all solutions to rounding, or proves that there is none.
//!
//! A mode says which contact velocities are zero and which edges of the friction cones carry impulse. Its equations are linear. Planar and
//! sliding contacts have finitely many modes, so a search of all is complete:
//! - where each mode's equations have one solution, the modes are open, slipping either way, and sticking;
//! - where some have many (more rows than dofs), the solutions of a mode fill a polyhedron inside the cones. Its corners have independent
//!   columns, so the search goes over the subsets of edges with every set of rows that may be zero.
//!
//! One spatial contact is solved as well: its slip directions are the roots of a quartic.
//!
//! A proof needs that each mode breaks a law by more than the bound of its error (`crate::ball`). Where one does not, and no solution was
//! found, it is undecided, unless `crate::farkas` proves Lemke's ray.

use super::{Lemke, Solver, Unsupported, spatial};
use crate::ball::Ball;
use crate::extended::{self, Matrix, Solved};
use crate::malformed;
use crate::problem::{Friction, Mechanism, Problem};
use crate::solution::{Certificate, Outcome, Point, Solution};
use featherbench_spatial::larger;
use nalgebra::{DVector, SymmetricEigen};

/// Enumeration of all modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enumeration {
    /// The most modes to try.
    pub modes: usize,
}

impl Default for Enumeration {
    fn default() -> Self {
        Self { modes: 1 << 20 }
    }
}

/// A solution breaks no law by more than this: what double-double arithmetic leaves of zero, 1e-31 times the pivots' growth.
const EXACT: f64 = 1e-22;
/// The same where the entries of a singular G are rounded: they decide by no more digits.
const GIVEN: f64 = 1e-12;
/// Points that are closer than this, free of units, are one.
const SAME: f64 = 1e-9;

/// A problem in double-double numbers, scaled by powers of two.
pub(super) struct Exact {
    pub matrix: Matrix,
    pub free: Vec<Ball>,
    /// The most by which a solution breaks a law.
    pub zero: f64,
    impulse_scale: f64,
}

impl Exact {
    fn new(problem: &Problem) -> Self {
        let scales = problem.scales();
        let power = |x: f64| 2.0_f64.powi(x.log2().round() as i32);
        let (velocity, impulse) = (power(scales.velocity), power(scales.impulse));
        let given = problem.delassus();
        let exact = problem.mechanism().and_then(Mechanism::delassus);
        let eigenvalues = SymmetricEigen::new(given.clone()).eigenvalues;
        let known = exact.is_some() || eigenvalues.min() > 1e-10 * eigenvalues.max();
        // What may be singular is known to the rounding that a problem's G is accepted with.
        let radius = if known { 0.0 } else { malformed::rounding(given) };
        let rounded = || (given.map(|entry| Ball::within(entry, radius)), problem.free().iter().map(|b| Ball::exact(*b)).collect());
        let (matrix, free): (Matrix, Vec<Ball>) = exact.unwrap_or_else(rounded);
        let matrix = matrix.map(|entry| entry * Ball::exact(impulse / velocity));
        let shift = problem.restitution_shift();
        let free = free.iter().zip(&shift).map(|(b, shift)| (*b + Ball::exact(*shift)) * Ball::exact(velocity.recip())).collect();
        Self { matrix, free, zero: if known { EXACT } else { GIVEN }, impulse_scale: impulse }
    }

    pub fn velocities(&self, impulses: &[Ball]) -> Vec<Ball> {
        extended::times_plus(&self.matrix, impulses, &self.free)
    }
}

/// A column of impulses: rows and factors.
type Edge = Vec<(usize, Ball)>;

/// A contact of the enumeration.
enum Kind {
    /// One unknown with this edge; only the normal velocity counts.
    Line { row: usize, edge: Edge },
    /// Two unknowns: normal row, tangent row, μ > 0.
    Planar { normal: usize, tangent: usize, friction: Ball },
}

/// Velocities that are zero, and edges that carry impulse.
struct State {
    zero: Vec<usize>,
    edges: Vec<Edge>,
}

impl Kind {
    fn new(problem: &Problem, index: usize) -> Option<Self> {
        let row = problem.range(index).start;
        let one = Ball::exact(1.0);
        match &problem.contacts()[index].friction {
            Friction::None => Some(Self::Line { row, edge: vec![(row, one)] }),
            Friction::Sliding { coefficient, direction } => {
                let along = |(k, d): (usize, &f64)| (row + 1 + k, -Ball::product(*coefficient, *d));
                Some(Self::Line { row, edge: std::iter::once((row, one)).chain(direction.iter().enumerate().map(along)).collect() })
            }
            Friction::Coulomb { coefficients } => {
                let mut rough = coefficients.iter().enumerate().filter(|(_, mu)| **mu > 0.0);
                match (rough.next(), rough.next()) {
                    (None, _) => Some(Self::Line { row, edge: vec![(row, one)] }),
                    (Some((k, mu)), None) => Some(Self::Planar { normal: row, tangent: row + 1 + k, friction: Ball::exact(*mu) }),
                    _ => None,
                }
            }
            Friction::Pyramid { .. } => None,
        }
    }

    /// The states; all of them, or those that suffice while no equations are singular.
    fn states(&self, all: bool) -> Vec<State> {
        let state = |zero: &[usize], edges: &[&Edge]| State { zero: zero.to_vec(), edges: edges.iter().map(|e| (*e).clone()).collect() };
        match self {
            Self::Line { row, edge } => {
                let mut states = vec![state(&[], &[]), state(&[*row], &[edge])];
                if all {
                    states.push(state(&[*row], &[]));
                }
                states
            }
            Self::Planar { normal, tangent, friction } => {
                let (n, t) = (*normal, *tangent);
                let edge = |mu: Ball| vec![(n, Ball::exact(1.0)), (t, mu)];
                let (up, down) = (edge(*friction), edge(-*friction));
                let mut states = vec![state(&[], &[]), state(&[n], &[&down]), state(&[n], &[&up]), state(&[n, t], &[&up, &down])];
                if all {
                    states.extend([state(&[n], &[]), state(&[n, t], &[]), state(&[n, t], &[&up]), state(&[n, t], &[&down])]);
                }
                states
            }
        }
    }

    /// How far impulses and velocities are from obeying the contact's laws.
    fn violation(&self, impulses: &[Ball], velocities: &[Ball]) -> Violation {
        match self {
            Self::Line { row, .. } => signorini(impulses[*row], velocities[*row]),
            Self::Planar { normal, tangent, friction } => {
                let slack = *friction * impulses[*normal] - impulses[*tangent].abs();
                let gap = velocities[*tangent] * impulses[*tangent] + *friction * impulses[*normal] * velocities[*tangent].abs();
                signorini(impulses[*normal], velocities[*normal]).or(negative(slack)).or(Violation::of(gap))
            }
        }
    }
}

/// By how much a law is broken, and whether it is for certain.
#[derive(Clone, Copy)]
pub(super) struct Violation {
    pub size: f64,
    pub certain: bool,
}

impl Violation {
    pub const NONE: Self = Self { size: 0.0, certain: false };

    /// Of a number that should be zero.
    pub fn of(number: Ball) -> Self {
        Self { size: number.to_f64().abs(), certain: number.is_nonzero() }
    }

    /// The larger one; certain if one is.
    pub fn or(self, other: Self) -> Self {
        Self { size: larger(self.size, other.size), certain: self.certain || other.certain }
    }
}

/// Of a number that should not be negative.
pub(super) fn negative(number: Ball) -> Violation {
    if number.to_f64() >= 0.0 { Violation::NONE } else { Violation::of(number) }
}

/// min(λ_n, c_n) is zero.
pub(super) fn signorini(impulse: Ball, velocity: Ball) -> Violation {
    let smaller = if (impulse - velocity).to_f64() < 0.0 { impulse } else { velocity };
    // One that is negative, or both that are positive.
    let certain = impulse.is_negative() || velocity.is_negative() || impulse.is_positive() && velocity.is_positive();
    Violation { size: smaller.to_f64().abs(), certain }
}

/// What a search collects.
pub(super) struct Search {
    pub points: Vec<Vec<Ball>>,
    pub modes: usize,
    /// The smallest violation of a candidate that is no solution.
    pub margin: f64,
    /// Whether each mode without a solution has none for certain.
    pub certain: bool,
}

impl Search {
    pub fn new() -> Self {
        Self { points: Vec::new(), modes: 0, margin: f64::INFINITY, certain: true }
    }

    /// Takes a candidate as a solution, or notes by how much it is none.
    pub fn offer(&mut self, candidate: Vec<Ball>, violation: Violation, zero: f64) {
        // Impulses of size s have rounding errors of s: compare with what they are made of.
        let size = candidate.iter().map(|x| x.to_f64().abs()).fold(1.0, larger);
        // What exact numbers break for certain is no rounding, whatever the size.
        let breaks = violation.certain && zero <= EXACT;
        if violation.size <= zero * size && !breaks {
            let distance = |a: &[Ball]| a.iter().zip(&candidate).map(|(a, b)| (*a - *b).to_f64().abs()).fold(0.0, larger);
            if !self.points.iter().any(|known| distance(known) <= SAME * size) {
                self.points.push(candidate);
            }
            return;
        }
        self.certain &= violation.certain;
        if violation.size < self.margin {
            self.margin = violation.size;
        }
    }
}

impl Solver for Enumeration {
    fn name(&self) -> &'static str {
        "enumeration"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        let exact = Exact::new(problem);
        let kinds: Option<Vec<Kind>> = (0..problem.contacts().len()).map(|index| Kind::new(problem, index)).collect();
        let search = match kinds {
            Some(kinds) => self.search(&exact, &kinds)?,
            None => spatial::search(problem, &exact).map_err(|reason| {
                let spatial = problem.contacts().iter().enumerate().find(|(index, _)| Kind::new(problem, *index).is_none());
                let contact = spatial.map(|(_, contact)| contact.name.clone()).unwrap_or_default();
                Unsupported::Contact { solver: self.name(), contact, reason }
            })?,
        };
        let point = |impulses: &Vec<Ball>| {
            Point::new(problem, DVector::from_iterator(impulses.len(), impulses.iter().map(|x| x.to_f64() * exact.impulse_scale)))
        };
        let mut points: Vec<Point> = search.points.iter().map(point).collect();
        let outcome = match points.len() {
            0 if search.certain => Outcome::NoSolution(Certificate::Enumeration { modes: search.modes, margin: search.margin }),
            0 => match Lemke::default().solve(problem)?.outcome {
                Outcome::NoSolution(proof) => Outcome::NoSolution(proof),
                _ => Outcome::Undecided,
            },
            1 => Outcome::Converged(points.remove(0)),
            _ => Outcome::Several(points),
        };
        Ok(Solution { outcome, iterations: search.modes, steps: Vec::new() })
    }
}

impl Enumeration {
    fn search(&self, exact: &Exact, kinds: &[Kind]) -> Result<Search, Unsupported> {
        let (search, singular) = self.pass(exact, kinds, false)?;
        if singular { Ok(self.pass(exact, kinds, true)?.0) } else { Ok(search) }
    }

    /// Tries every combination of states. Also tells whether the equations of one had many solutions.
    fn pass(&self, exact: &Exact, kinds: &[Kind], all: bool) -> Result<(Search, bool), Unsupported> {
        let states: Vec<Vec<State>> = kinds.iter().map(|kind| kind.states(all)).collect();
        let modes: f64 = states.iter().map(|states| states.len() as f64).product();
        if modes > self.modes as f64 {
            return Err(Unsupported::TooMany { solver: self.name(), modes, limit: self.modes as f64 });
        }
        let violation = |impulses: &[Ball]| {
            let velocities = exact.velocities(impulses);
            kinds.iter().map(|kind| kind.violation(impulses, &velocities)).fold(Violation::NONE, Violation::or)
        };
        let (mut search, mut singular, mut directions) = (Search::new(), false, Vec::new());
        let mut digits = vec![0; kinds.len()];
        loop {
            search.modes += 1;
            let chosen: Vec<&State> = states.iter().zip(&digits).map(|(states, digit)| &states[*digit]).collect();
            let (solved, certain) = solve(exact, &chosen);
            search.certain &= certain;
            match solved {
                Solved::Unique(impulses) => {
                    let violation = violation(&impulses);
                    search.offer(impulses, violation, exact.zero);
                }
                Solved::Many(direction) => {
                    singular = true;
                    directions.extend(direction);
                }
                Solved::Inconsistent => singular |= !certain,
            }
            // The next combination, as an odometer counts.
            let Some(place) = (0..digits.len()).find(|place| digits[*place] + 1 < states[*place].len()) else { break };
            digits[..place].fill(0);
            digits[place] += 1;
        }
        // A family without an end: a solution that stays one along a direction, both a little and far.
        for point in search.points.clone() {
            for direction in directions.iter().flat_map(|d: &Vec<Ball>| [d.clone(), d.iter().map(|x| -*x).collect()]) {
                let moved = |by: f64| -> Vec<Ball> { point.iter().zip(&direction).map(|(x, d)| *x + *d * Ball::exact(by)).collect() };
                if [1.0, 1e3].iter().all(|by| violation(&moved(*by)).size <= exact.zero * by) {
                    search.offer(moved(1.0), violation(&moved(1.0)), exact.zero);
                }
            }
        }
        Ok((search, singular))
    }
}

/// The impulses of a combination of states, in all rows.
fn solve(exact: &Exact, states: &[&State]) -> (Solved, bool) {
    let rows: Vec<usize> = states.iter().flat_map(|state| state.zero.iter().copied()).collect();
    let edges: Vec<&Edge> = states.iter().flat_map(|state| &state.edges).collect();
    let entry = |row: usize, edge: usize| {
        edges[edge].iter().fold(Ball::exact(0.0), |sum, (k, factor)| sum + exact.matrix[(rows[row], *k)] * *factor)
    };
    let matrix = Matrix::from_fn(rows.len(), edges.len(), entry);
    let right = rows.iter().map(|row| -exact.free[*row]).collect();
    let spread = |weights: Vec<Ball>| {
        let mut impulses = vec![Ball::exact(0.0); exact.free.len()];
        for (edge, weight) in edges.iter().zip(weights) {
            edge.iter().for_each(|(row, factor)| impulses[*row] = impulses[*row] + *factor * weight);
        }
        impulses
    };
    let (solved, certain) = extended::solve(matrix, right);
    let solved = match solved {
        Solved::Unique(weights) => Solved::Unique(spread(weights)),
        Solved::Inconsistent => Solved::Inconsistent,
        Solved::Many(direction) => Solved::Many(direction.map(spread)),
    };
    (solved, certain)
}
