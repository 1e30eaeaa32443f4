//! Nonsmooth Gauss–Seidel: contact by contact, each solved exactly.
//!
//! Source: M. Jean, *The non-smooth contact dynamics method* (1999), section 4; J. Hwangbo, J. Lee and M. Hutter, *Per-contact iteration
//! method for solving contact dynamics* (2018). With the others' impulses held, a contact opens, sticks or slides:
//!
//! ```text
//! opens    b_n ≥ 0:                     λ = 0                         (b: the velocity without the contact's own impulse)
//! sticks   λ = λ − A⁻¹ c in the cone:   c = 0                         (A: the contact's 3×3 block)
//! slides   λ = n (1, d), |d| = 1:       n = −b_n / (A_nn + A_nt d),   d × c_t = 0 and d · c_t ≤ 0, by Newton's method on the angle of d
//! ```
//!
//! The velocities come from rows times a state, whichever is shorter:
//!
//! | form | rows | state | cost of a contact |
//! |---|---|---|---|
//! | Delassus | G, m numbers each | λ | 3 m |
//! | joints | W = J R⁻¹ with M = RᵀR, n numbers each | Wᵀλ | 6 n |
//!
//! A sweep does not allocate.

use super::standard::Standard;
use super::{Solver, Unsupported, positive};
use crate::cones;
use crate::problem::{Friction, Mechanism, Problem};
use crate::solution::{Outcome, Solution};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix3};

/// Nonsmooth Gauss–Seidel with exact contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockGaussSeidel {
    /// The largest natural-map residual of an answer, free of units.
    pub tolerance: f64,
    /// The cap on sweeps.
    pub sweeps: usize,
}

impl Default for BlockGaussSeidel {
    fn default() -> Self {
        Self { tolerance: 1e-10, sweeps: 100_000 }
    }
}

impl Solver for BlockGaussSeidel {
    fn name(&self) -> &'static str {
        "block_gauss_seidel"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        positive(self.name(), "tolerance", self.tolerance)?;
        let mut blocks = Blocks::new(problem)?;
        let iterations = blocks.run(self);
        let residual = blocks.residual();
        let point = blocks.standard.point(problem, &blocks.impulses());
        let outcome = Outcome::judged(point, residual <= self.tolerance, iterations >= self.sweeps);
        Ok(Solution { outcome, iterations, steps: Vec::new() })
    }
}

/// Numbers of a register: rows are filled up with zeros.
const LANES: usize = 8;
/// How many Newton steps find the direction of sliding. It goes on in the next sweep, from the direction found.
const TURNS: usize = 4;

/// A problem in the form that is swept, and its impulses: standard axes, free of units.
pub struct Blocks {
    standard: Standard,
    contacts: Vec<Contact>,
    /// Three rows per contact, one after the other.
    rows: Vec<f64>,
    width: usize,
    state: Vec<f64>,
    /// Whether the state is λ.
    is_delassus: bool,
}

/// A contact: its own numbers.
#[derive(Clone, Copy)]
struct Contact {
    block: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    free: [f64; 3],
    x: [f64; 3],
    /// The direction of sliding of the last sweep.
    slides: [f64; 2],
}

impl Blocks {
    /// Makes rows, blocks and their inverses of a problem; all impulses are zero.
    ///
    /// # Errors
    /// [`Unsupported`]: a contact has a pyramid or slides in a given direction.
    pub fn new(problem: &Problem) -> Result<Self, Unsupported> {
        let name = BlockGaussSeidel::default().name();
        let standard = Standard::new(problem, name, false)?;
        let count = standard.contacts();
        let shorter = problem.mechanism().filter(|mechanism| 2 * mechanism.mass.nrows() < 3 * count);
        let joints = shorter.and_then(|mechanism| joints(problem, mechanism));
        let is_delassus = joints.is_none();
        let length = joints.as_ref().map_or(3 * count, DMatrix::nrows);
        let width = length.next_multiple_of(LANES);
        let mut rows = vec![0.0; 3 * count * width];
        let mut contacts = Vec::with_capacity(count);
        for contact in 0..count {
            let own = standard.range(contact);
            let mut block = Matrix3::identity();
            let mut free = [0.0; 3];
            for (k, row) in own.clone().enumerate() {
                free[k] = standard.free[row];
                for (l, column) in own.clone().enumerate() {
                    block[(k, l)] = standard.matrix[(row, column)];
                }
                let to = &mut rows[(3 * contact + k) * width..][..width];
                match &joints {
                    Some(joints) => to[..length].copy_from_slice(joints.column(row).as_slice()),
                    None => spread(&standard, row, to),
                }
            }
            // A block without inverse is that of a point that cannot move in some direction: there the rounding of its velocity counts.
            let slack = 1e-12 * block.trace();
            let inverse = (block + Matrix3::identity() * slack).try_inverse().unwrap_or_else(Matrix3::identity);
            let of = |m: Matrix3<f64>| [0, 1, 2].map(|k| [0, 1, 2].map(|l| m[(k, l)]));
            contacts.push(Contact { block: of(block), inverse: of(inverse), free, x: [0.0; 3], slides: [0.0; 2] });
        }
        Ok(Self { standard, contacts, rows, width, state: vec![0.0; width], is_delassus })
    }

    /// All impulses zero.
    pub fn clear(&mut self) {
        self.state.fill(0.0);
        for contact in &mut self.contacts {
            (contact.x, contact.slides) = ([0.0; 3], [0.0; 2]);
        }
    }

    /// Sweeps until the natural map is within the tolerance or the cap is reached; the number of sweeps.
    pub fn run(&mut self, settings: &BlockGaussSeidel) -> usize {
        let mut sweeps = 0;
        let mut moved = f64::INFINITY;
        while sweeps < settings.sweeps {
            // A small change is cheap to see, and then the residual decides.
            if moved <= settings.tolerance && self.residual() <= settings.tolerance {
                break;
            }
            moved = self.sweep();
            sweeps += 1;
            if moved.is_nan() {
                break;
            }
        }
        sweeps
    }

    /// The natural-map residual of Coulomb's law.
    pub fn residual(&self) -> f64 {
        let of = |(k, contact): (usize, &Contact)| {
            let size = self.standard.range(k).len();
            cones::natural(&contact.x[..size], &self.velocity(k)[..size])
        };
        self.contacts.iter().enumerate().map(of).fold(0.0, featherbench_spatial::larger)
    }

    fn impulses(&self) -> DVector<f64> {
        let of = |(k, contact): (usize, &Contact)| contact.x.into_iter().take(self.standard.range(k).len());
        DVector::from_iterator(self.standard.size(), self.contacts.iter().enumerate().flat_map(of))
    }

    fn velocity(&self, contact: usize) -> [f64; 3] {
        let rows = &self.rows[3 * contact * self.width..][..3 * self.width];
        products::<false>(rows, &self.state, self.contacts[contact].free)
    }

    fn sweep(&mut self) -> f64 {
        let Self { contacts, rows, width, state, is_delassus, .. } = self;
        fast::sweep(contacts, rows, *width, state, *is_delassus)
    }
}

/// A row of A in blocks of three columns.
fn spread(standard: &Standard, row: usize, to: &mut [f64]) {
    for contact in 0..standard.contacts() {
        for (k, column) in standard.range(contact).enumerate() {
            to[3 * contact + k] = standard.matrix[(row, column)];
        }
    }
}

/// W in standard axes: n rows, a column per row of the standard form. `None` if M has no factor.
fn joints(problem: &Problem, mechanism: &Mechanism) -> Option<DMatrix<f64>> {
    let factor = Cholesky::new(mechanism.mass.clone())?;
    let half = factor.l().solve_lower_triangular(&mechanism.jacobian.transpose())?;
    let scales = problem.scales();
    let scale = (scales.impulse / scales.velocity).sqrt();
    let mut columns = Vec::new();
    for (contact, number) in problem.contacts().iter().zip(0..) {
        let row = problem.range(number).start;
        columns.push(half.column(row) * scale);
        if let Friction::Coulomb { coefficients } = &contact.friction {
            let sliding = coefficients.iter().enumerate().filter(|(_, mu)| **mu > 0.0);
            columns.extend(sliding.map(|(k, mu)| half.column(row + 1 + k) * (scale * mu)));
        }
    }
    Some(DMatrix::from_columns(&columns))
}

/// a b + c, in one rounding where the processor has such an instruction.
#[inline(always)]
fn fused<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// Three rows times a state, plus three numbers.
#[inline(always)]
fn products<const FMA: bool>(rows: &[f64], state: &[f64], plus: [f64; 3]) -> [f64; 3] {
    let mut sums = [[0.0; LANES]; 3];
    let (first, rest) = rows.split_at(state.len());
    let (second, third) = rest.split_at(state.len());
    let of = |row: &[f64], at: usize| -> [f64; LANES] { std::array::from_fn(|lane| row[at + lane]) };
    for at in (0..state.len()).step_by(LANES) {
        let x = of(state, at);
        for (sum, row) in sums.iter_mut().zip([first, second, third]) {
            let row = of(row, at);
            *sum = std::array::from_fn(|lane| fused::<FMA>(row[lane], x[lane], sum[lane]));
        }
    }
    let total = |sum: [f64; LANES]| {
        let four: [f64; 4] = std::array::from_fn(|lane| sum[lane] + sum[lane + 4]);
        (four[0] + four[2]) + (four[1] + four[3])
    };
    [0, 1, 2].map(|k| total(sums[k]) + plus[k])
}

/// Adds three rows, times a number each, to a state.
#[inline(always)]
fn add<const FMA: bool>(rows: &[f64], by: [f64; 3], state: &mut [f64]) {
    let (first, rest) = rows.split_at(state.len());
    let (second, third) = rest.split_at(state.len());
    for (((x, a), b), c) in state.iter_mut().zip(first).zip(second).zip(third) {
        *x = fused::<FMA>(by[2], *c, fused::<FMA>(by[1], *b, fused::<FMA>(by[0], *a, *x)));
    }
}

/// One sweep; the largest change of an impulse.
#[inline(always)]
fn sweep<const FMA: bool>(contacts: &mut [Contact], rows: &[f64], width: usize, state: &mut [f64], is_delassus: bool) -> f64 {
    let mut largest = 0.0;
    let state = &mut state[..width];
    for (number, (contact, rows)) in contacts.iter_mut().zip(rows.chunks_exact(3 * width)).enumerate() {
        let old = contact.x;
        let velocity = products::<FMA>(rows, state, contact.free);
        contact.solve(velocity);
        let change = [0, 1, 2].map(|k| contact.x[k] - old[k]);
        if is_delassus {
            state[3 * number..][..3].copy_from_slice(&contact.x);
        } else {
            add::<FMA>(rows, change, state);
        }
        for part in change {
            if part.is_nan() || part.abs() > largest {
                largest = part.abs();
            }
        }
        if largest.is_nan() {
            return largest;
        }
    }
    largest
}

impl Contact {
    /// The impulse that obeys the laws where the other contacts' are held; `c` is the velocity with the impulse so far.
    #[inline(always)]
    fn solve(&mut self, c: [f64; 3]) {
        let (a, x) = (&self.block, self.x);
        let times = |m: &[[f64; 3]; 3], v: [f64; 3], k: usize| m[k][0] * v[0] + m[k][1] * v[1] + m[k][2] * v[2];
        let b = [0, 1, 2].map(|k| c[k] - times(a, x, k));
        if b[0] >= 0.0 {
            self.x = [0.0; 3];
            return;
        }
        let stuck = [0, 1, 2].map(|k| x[k] - times(&self.inverse, c, k));
        if stuck[1] * stuck[1] + stuck[2] * stuck[2] <= stuck[0] * stuck[0] && stuck[0] > 0.0 {
            (self.x, self.slides) = (stuck, [0.0; 2]);
            return;
        }
        let mut d = self.slides;
        if d == [0.0; 2] {
            d = unit([stuck[1], stuck[2]]).unwrap_or([1.0, 0.0]);
        }
        for _ in 0..TURNS {
            let across = [-d[1], d[0]];
            let (along_d, along_across) = (a[0][1] * d[0] + a[0][2] * d[1], a[0][1] * across[0] + a[0][2] * across[1]);
            let weight = a[0][0] + along_d;
            let n = -b[0] / weight;
            let by = [a[1][0] + a[1][1] * d[0] + a[1][2] * d[1], a[2][0] + a[2][1] * d[0] + a[2][2] * d[1]];
            let slip = [b[1] + n * by[0], b[2] + n * by[1]];
            let n_turned = -n * along_across / weight;
            let turned = [
                n_turned * by[0] + n * (a[1][1] * across[0] + a[1][2] * across[1]),
                n_turned * by[1] + n * (a[2][1] * across[0] + a[2][2] * across[1]),
            ];
            // f = d × c_t, and its derivative by the angle of d.
            let f = d[0] * slip[1] - d[1] * slip[0];
            let against = -(d[0] * slip[0] + d[1] * slip[1]);
            let slope = against + d[0] * turned[1] - d[1] * turned[0];
            let angle = if slope > 0.0 && against >= 0.0 { -f / slope } else { -0.5 * f.signum() };
            let angle = angle.clamp(-0.5, 0.5);
            if let Some(next) = unit([d[0] + angle * across[0], d[1] + angle * across[1]]) {
                d = next;
            }
            if angle.abs() <= 1e-12 {
                break;
            }
        }
        let weight = a[0][0] + a[0][1] * d[0] + a[0][2] * d[1];
        let n = -b[0] / weight;
        let slip = [1, 2].map(|k| b[k] + n * (a[k][0] + a[k][1] * d[0] + a[k][2] * d[1]));
        let across = (d[0] * slip[1] - d[1] * slip[0]).abs();
        let slides = weight > 0.0 && -(d[0] * slip[0] + d[1] * slip[1]) > across;
        (self.x, self.slides) = if slides { ([n, n * d[0], n * d[1]], d) } else { (self.projected(c), [0.0; 2]) };
    }

    /// A step of projected Gauss–Seidel, where the contact by itself has no answer that slides (Painlevé), or Newton's method has not found
    /// it: its direction is more than 45° off.
    fn projected(&self, c: [f64; 3]) -> [f64; 3] {
        let (a, x) = (&self.block, self.x);
        let normal = x[0] - c[0] / a[0][0];
        if normal <= 0.0 || normal.is_nan() {
            return [0.0 * normal; 3];
        }
        let trace = a[1][1] + a[2][2];
        let moved = [x[1] - c[1] / trace, x[2] - c[2] / trace];
        let length = (moved[0] * moved[0] + moved[1] * moved[1]).sqrt();
        let shorter = if length > normal { normal / length } else { 1.0 };
        [normal, shorter * moved[0], shorter * moved[1]]
    }
}

#[inline(always)]
fn unit(v: [f64; 2]) -> Option<[f64; 2]> {
    let length = (v[0] * v[0] + v[1] * v[1]).sqrt();
    (length > 0.0).then(|| [v[0] / length, v[1] / length])
}

/// The sweep with the processor's widest instructions.
#[expect(unsafe_code, reason = "functions of instructions that the processor was asked for")]
mod fast {
    use super::Contact;

    /// One sweep; the largest change of an impulse.
    pub(super) fn sweep(contacts: &mut [Contact], rows: &[f64], width: usize, state: &mut [f64], is_delassus: bool) -> f64 {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            // SAFETY: the processor has these instructions.
            return unsafe { with_registers(contacts, rows, width, state, is_delassus) };
        }
        super::sweep::<false>(contacts, rows, width, state, is_delassus)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn with_registers(contacts: &mut [Contact], rows: &[f64], width: usize, state: &mut [f64], is_delassus: bool) -> f64 {
        super::sweep::<true>(contacts, rows, width, state, is_delassus)
    }
}
