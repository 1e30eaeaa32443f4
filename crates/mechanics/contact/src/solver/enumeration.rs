//! Enumeration: every mode of every contact, in double-double arithmetic. It finds all solutions, or proves that there is none.
//!
//! A mode says which contact velocities are zero and which edges of the friction cones carry impulse. Its equations are linear. Planar and
//! sliding contacts have finitely many modes, so a search of all is complete:
//! - where each mode's equations have one solution, the modes are open, slipping either way, and sticking;
//! - where some have many (more rows than dofs), the solutions of a mode fill a polyhedron inside the cones. Its corners have independent
//!   columns, so the search goes over the subsets of edges with every set of rows that may be zero.
//!
//! One spatial contact is solved as well: its slip directions are the roots of a quartic.

use super::{Solver, Unsupported, spatial};
use crate::extended::{self, Matrix, Solved};
use crate::problem::{Friction, Mechanism, Problem};
use crate::solution::{Certificate, Outcome, Point, Solution};
use featherbench_spatial::larger;
use featherbench_spatial::{DoubleDouble, Real};
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

/// What double-double arithmetic leaves of zero in these sizes: 1e-31 times the pivots' growth.
const EXACT: f64 = 1e-22;
/// What the rounding of f64 entries leaves of zero: a singular G that was given as such decides by no more digits.
const GIVEN: f64 = 1e-12;
/// Points that are closer than this, free of units, are one.
const SAME: f64 = 1e-9;

/// A problem in double-double numbers, scaled by powers of two.
pub(super) struct Exact {
    pub matrix: Matrix,
    pub free: Vec<DoubleDouble>,
    /// What counts as zero.
    pub zero: f64,
    impulse_scale: f64,
}

impl Exact {
    fn new(problem: &Problem) -> Self {
        let scales = problem.scales();
        let power = |x: f64| 2.0_f64.powi(x.log2().round() as i32);
        let (velocity, impulse) = (power(scales.velocity), power(scales.impulse));
        let given = || (extended::wide(problem.delassus()), problem.free().iter().map(|b| DoubleDouble::from_f64(*b)).collect::<Vec<_>>());
        let exact = problem.mechanism().and_then(Mechanism::delassus);
        let known = exact.is_some();
        let (matrix, free) = exact.unwrap_or_else(given);
        let scaled = |value: DoubleDouble, factor: f64| value * DoubleDouble::from_f64(factor);
        let matrix = matrix.map(|entry| scaled(entry, impulse / velocity));
        let shift = problem.restitution_shift();
        let free = free.iter().zip(&shift).map(|(b, shift)| scaled(*b + DoubleDouble::from_f64(*shift), 1.0 / velocity)).collect();
        let eigenvalues = SymmetricEigen::new(matrix.map(DoubleDouble::to_f64)).eigenvalues;
        let regular = eigenvalues.min() > 1e-10 * eigenvalues.max();
        Self { matrix, free, zero: if known || regular { EXACT } else { GIVEN }, impulse_scale: impulse }
    }

    pub fn velocities(&self, impulses: &[DoubleDouble]) -> Vec<DoubleDouble> {
        extended::times_plus(&self.matrix, impulses, &self.free)
    }
}

/// A column of impulses: rows and factors.
type Edge = Vec<(usize, DoubleDouble)>;

/// A contact of the enumeration.
enum Kind {
    /// One unknown with this edge; only the normal velocity counts.
    Line { row: usize, edge: Edge },
    /// Two unknowns: normal row, tangent row, μ > 0.
    Planar { normal: usize, tangent: usize, friction: DoubleDouble },
}

/// Velocities that are zero, and edges that carry impulse.
struct State {
    zero: Vec<usize>,
    edges: Vec<Edge>,
}

impl Kind {
    fn new(problem: &Problem, index: usize) -> Option<Self> {
        let row = problem.range(index).start;
        let one = DoubleDouble::one();
        match &problem.contacts()[index].friction {
            Friction::None => Some(Self::Line { row, edge: vec![(row, one)] }),
            Friction::Sliding { coefficient, direction } => {
                let along = |(k, d): (usize, &f64)| (row + 1 + k, -DoubleDouble::from_product(*coefficient, *d));
                Some(Self::Line { row, edge: std::iter::once((row, one)).chain(direction.iter().enumerate().map(along)).collect() })
            }
            Friction::Coulomb { coefficients } => {
                let mut rough = coefficients.iter().enumerate().filter(|(_, mu)| **mu > 0.0);
                match (rough.next(), rough.next()) {
                    (None, _) => Some(Self::Line { row, edge: vec![(row, one)] }),
                    (Some((k, mu)), None) => {
                        Some(Self::Planar { normal: row, tangent: row + 1 + k, friction: DoubleDouble::from_f64(*mu) })
                    }
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
                let edge = |mu: DoubleDouble| vec![(n, DoubleDouble::one()), (t, mu)];
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
    fn violation(&self, impulses: &[DoubleDouble], velocities: &[DoubleDouble]) -> f64 {
        match self {
            Self::Line { row, .. } => signorini(impulses[*row], velocities[*row]),
            Self::Planar { normal, tangent, friction } => {
                let slack = *friction * impulses[*normal] - impulses[*tangent].abs();
                let gap = velocities[*tangent] * impulses[*tangent] + *friction * impulses[*normal] * velocities[*tangent].abs();
                let outside = larger(0.0, -slack.to_f64());
                larger(signorini(impulses[*normal], velocities[*normal]), larger(outside, gap.abs().to_f64()))
            }
        }
    }
}

/// |min(λ_n, c_n)|, decided in double-double.
pub(super) fn signorini(impulse: DoubleDouble, velocity: DoubleDouble) -> f64 {
    let smaller = if (impulse - velocity).to_f64() < 0.0 { impulse } else { velocity };
    smaller.abs().to_f64()
}

/// What a search collects.
pub(super) struct Search {
    pub points: Vec<Vec<DoubleDouble>>,
    pub modes: usize,
    /// The smallest violation of a candidate that is no solution.
    pub margin: f64,
}

impl Search {
    pub fn new() -> Self {
        Self { points: Vec::new(), modes: 0, margin: f64::INFINITY }
    }

    /// Takes a candidate as a solution, or notes by how much it is none.
    pub fn offer(&mut self, candidate: Vec<DoubleDouble>, violation: f64, zero: f64) {
        // Impulses of size s have rounding errors of s: compare with what they are made of.
        let size = candidate.iter().map(|x| x.to_f64().abs()).fold(1.0, larger);
        if violation <= zero * size {
            let distance = |a: &[DoubleDouble]| a.iter().zip(&candidate).map(|(a, b)| (*a - *b).to_f64().abs()).fold(0.0, larger);
            if !self.points.iter().any(|known| distance(known) <= SAME * size) {
                self.points.push(candidate);
            }
        } else if violation < self.margin {
            self.margin = violation;
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
        let point = |impulses: &Vec<DoubleDouble>| {
            Point::new(problem, DVector::from_iterator(impulses.len(), impulses.iter().map(|x| x.to_f64() * exact.impulse_scale)))
        };
        let mut points: Vec<Point> = search.points.iter().map(point).collect();
        let outcome = match points.len() {
            0 => Outcome::NoSolution(Certificate::Enumeration { modes: search.modes, margin: search.margin }),
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
        let violation = |impulses: &[DoubleDouble]| {
            let velocities = exact.velocities(impulses);
            kinds.iter().map(|kind| kind.violation(impulses, &velocities)).fold(0.0, larger)
        };
        let (mut search, mut singular, mut directions) = (Search::new(), false, Vec::new());
        let mut digits = vec![0; kinds.len()];
        loop {
            search.modes += 1;
            let chosen: Vec<&State> = states.iter().zip(&digits).map(|(states, digit)| &states[*digit]).collect();
            match solve(exact, &chosen) {
                Solved::Unique(impulses) => {
                    let violation = violation(&impulses);
                    search.offer(impulses, violation, exact.zero);
                }
                Solved::Many(direction) => {
                    singular = true;
                    directions.extend(direction);
                }
                Solved::Inconsistent => {}
            }
            // The next combination, as an odometer counts.
            let Some(place) = (0..digits.len()).find(|place| digits[*place] + 1 < states[*place].len()) else { break };
            digits[..place].fill(0);
            digits[place] += 1;
        }
        // A family without an end: a solution that stays one along a direction, both a little and far.
        for point in search.points.clone() {
            for direction in directions.iter().flat_map(|d: &Vec<DoubleDouble>| [d.clone(), d.iter().map(|x| -*x).collect()]) {
                let moved = |by: f64| -> Vec<DoubleDouble> {
                    point.iter().zip(&direction).map(|(x, d)| d.mul_add(DoubleDouble::from_f64(by), *x)).collect()
                };
                if [1.0, 1e3].iter().all(|by| violation(&moved(*by)) <= exact.zero * by) {
                    search.offer(moved(1.0), violation(&moved(1.0)), exact.zero);
                }
            }
        }
        Ok((search, singular))
    }
}

/// The impulses of a combination of states, in all rows.
fn solve(exact: &Exact, states: &[&State]) -> Solved {
    let rows: Vec<usize> = states.iter().flat_map(|state| state.zero.iter().copied()).collect();
    let edges: Vec<&Edge> = states.iter().flat_map(|state| &state.edges).collect();
    let entry = |row: usize, edge: usize| {
        edges[edge].iter().fold(DoubleDouble::zero(), |sum, (k, factor)| exact.matrix[(rows[row], *k)].mul_add(*factor, sum))
    };
    let matrix = Matrix::from_fn(rows.len(), edges.len(), entry);
    let right = rows.iter().map(|row| -exact.free[*row]).collect();
    let spread = |weights: Vec<DoubleDouble>| {
        let mut impulses = vec![DoubleDouble::zero(); exact.free.len()];
        for (edge, weight) in edges.iter().zip(weights) {
            edge.iter().for_each(|(row, factor)| impulses[*row] = factor.mul_add(weight, impulses[*row]));
        }
        impulses
    };
    match extended::solve(matrix, right, exact.zero) {
        Solved::Unique(weights) => Solved::Unique(spread(weights)),
        Solved::Inconsistent => Solved::Inconsistent,
        Solved::Many(direction) => Solved::Many(direction.map(spread)),
    }
}
