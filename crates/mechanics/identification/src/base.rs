//! Base parameters: the combinations of parameters that the torques depend on.
//!
//! Source: M. Gautier, *Numerical calculation of the base inertial parameters of robots* (1991). With the independent columns Y₁ and the
//! dependent ones Y₂ = Y₁ C:
//!
//! ```text
//! Y θ = Y₁ β,   β = θ₁ + C θ₂
//! ```
//!
//! Columns are divided by their length first, so that the threshold does not depend on units. Then
//! 1. a column whose length is below [`NO_EFFECT`] of the longest has no effect;
//! 2. the rank r is the number of singular values above [`RANK`] of the largest; the ratio σ_r/σ_{r+1} is reported as the gap;
//! 3. QR with column pivoting has to find as many diagonal entries above [`RANK`] of the largest; if not, the rank is not clear;
//! 4. independent columns are the first ones in the order of the unknowns. A column is independent if more than [`INDEPENDENT`] of its length
//!    in the row space stands on those before it. They have to be r.

use crate::{IdentificationError, Information, LinearModel, Samples, Stacking};
use featherbench_dynamics::{PARAMETERS, Regressor};
use featherbench_robots::StateBatch;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are zero. Rounding leaves some 1e-14 of it, and of the robots here the least that is not
/// zero is 1e-4; a chain of thirty has 1e-6.
pub const RANK: f64 = 1e-10;
/// A column shorter than this share of the longest is zero: rounding leaves 1e-16 of it.
pub const NO_EFFECT: f64 = 1e-13;
/// A column of the row space whose remainder is below this share of its length depends on the columns before it.
pub const INDEPENDENT: f64 = 1e-7;
/// A coefficient below this, in scaled columns, is rounding.
const COEFFICIENT: f64 = 1e-9;

/// The base parameters β = B θ of a set of equations.
#[derive(Clone, Debug)]
pub struct Base {
    /// The unknowns that stand for a base parameter, rising.
    pub independent: Vec<usize>,
    /// B: a row per base parameter, a column per unknown. The columns of [`Base::independent`] are those of the identity.
    pub map: DMatrix<f64>,
    /// The singular values of the scaled columns, falling.
    pub singular: Vec<f64>,
    /// σ_r/σ_{r+1}; infinite if nothing follows, or if it is zero.
    pub gap: f64,
}

impl Base {
    /// The base parameters of a robot: what any motion can tell, from random states.
    ///
    /// ```
    /// use featherbench_identification::{Base, LinearModel, Terms};
    /// use featherbench_robots::Family;
    ///
    /// // A planar arm in the vertical plane has three base parameters per link.
    /// let robot = Family::parse("chain:n=3")?.generate()?;
    /// let linear = LinearModel::new(&robot, Terms::NONE)?;
    /// let base = Base::of_robot(&linear, 1)?;
    /// assert_eq!(base.rank(), 9);
    /// assert!(base.gap > 1e6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentificationError`] when the rank is not clear.
    pub fn of_robot(linear: &LinearModel, seed: u64) -> Result<Self, IdentificationError> {
        Self::of_states(linear, seed, &Stacking::plain(linear), Motion::Any)
    }

    /// The base parameters that some dofs tell at random states, moving or at rest.
    ///
    /// # Errors
    /// [`IdentificationError`] when the rank is not clear.
    pub fn of_states(linear: &LinearModel, seed: u64, stacking: &Stacking, motion: Motion) -> Result<Self, IdentificationError> {
        let unknowns = linear.unknowns().len();
        // Twice as many equations as unknowns, and as many more states.
        let count = 10 + 2 * unknowns / stacking.dofs.len().max(1);
        let mut samples = Samples::random(linear, count, seed, &vec![0.0; unknowns])?;
        if motion == Motion::AtRest {
            samples.v.fill(0.0);
            samples.a.fill(0.0);
        }
        Self::of(&Information::of(linear, &samples, stacking)?)
    }

    /// The base parameters that the total energy tells, from random states: those of [`Base::of_robot`] by another way.
    ///
    /// Torques do not depend on a combination of parameters if, and only if, `E(q, v) − E(q₀, v₀)` does not. No acceleration enters.
    ///
    /// # Errors
    /// [`IdentificationError`] when the rank is not clear.
    pub fn of_energy(linear: &LinearModel, seed: u64) -> Result<Self, IdentificationError> {
        let model = linear.model();
        let width = PARAMETERS * model.described.len();
        let states = StateBatch::random(model, 1 + 3 * width, seed);
        let mut regressor = Regressor::new(&model.topology);
        let (mut kinetic, mut potential) = (vec![0.0; width], vec![0.0; width]);
        let mut energies = DMatrix::zeros(states.count(), width);
        for k in 0..states.count() {
            regressor.energy(model, states.q(k), states.v(k), &mut kinetic, &mut potential)?;
            (0..width).for_each(|column| energies[(k, column)] = kinetic[column] + potential[column]);
        }
        let start = energies.row(0).into_owned();
        for mut row in energies.row_iter_mut() {
            row -= &start;
        }
        Self::of(&Information::of_rows(&energies, &DVector::zeros(energies.nrows())))
    }

    /// The base parameters that equations tell.
    ///
    /// # Errors
    /// [`IdentificationError::NoEffect`], [`IdentificationError::UnclearRank`].
    pub fn of(information: &Information) -> Result<Self, IdentificationError> {
        let factor = information.factor();
        let unknowns = information.unknowns();
        let lengths: Vec<f64> = factor.column_iter().map(|column| column.norm()).collect();
        let longest = lengths.iter().copied().fold(0.0, larger);
        if let Some(&value) = lengths.iter().find(|length| !length.is_finite()) {
            return Err(IdentificationError::NotFinite { what: "the length of a column".into(), value });
        }
        let kept: Vec<usize> = (0..unknowns).filter(|&k| lengths[k] > NO_EFFECT * longest).collect();
        if kept.is_empty() {
            return Err(IdentificationError::NoEffect);
        }
        let mut scaled = factor.select_columns(&kept);
        for (mut column, &k) in scaled.column_iter_mut().zip(&kept) {
            column /= lengths[k];
        }
        let decomposed = scaled.clone().try_svd(false, true, f64::EPSILON, 0).ok_or(IdentificationError::Singular("the regressor"))?;
        let rows = decomposed.v_t.as_ref().ok_or(IdentificationError::Singular("the regressor"))?;
        let mut order: Vec<usize> = (0..decomposed.singular_values.len()).collect();
        order.sort_by(|&a, &b| decomposed.singular_values[b].total_cmp(&decomposed.singular_values[a]));
        let singular: Vec<f64> = order.iter().map(|&k| decomposed.singular_values[k]).collect();
        let rank = singular.iter().take_while(|&&value| value > RANK * singular[0]).count();
        let below = singular.get(rank).copied().unwrap_or(0.0);
        let gap = if below > 0.0 { singular[rank - 1] / below } else { f64::INFINITY };
        let unclear = |by_columns| IdentificationError::UnclearRank { by_singular: rank, by_columns, threshold: RANK, gap };

        let pivoted = scaled.col_piv_qr().unpack_r();
        let first = pivoted[(0, 0)].abs();
        let diagonal = (0..pivoted.nrows().min(pivoted.ncols())).map(|k| pivoted[(k, k)].abs());
        let by_pivots = diagonal.filter(|&entry| entry > RANK * first).count();
        if by_pivots != rank {
            return Err(unclear(by_pivots));
        }
        let space = rows.select_rows(&order[..rank]);
        let chosen = first_independent(&space);
        if chosen.len() != rank {
            return Err(unclear(chosen.len()));
        }
        let coefficients =
            space.select_columns(&chosen).lu().solve(&space).ok_or(IdentificationError::Singular("the choice of base parameters"))?;
        let independent: Vec<usize> = chosen.iter().map(|&k| kept[k]).collect();
        let mut map = DMatrix::zeros(rank, unknowns);
        for (i, &own) in independent.iter().enumerate() {
            for (j, &unknown) in kept.iter().enumerate() {
                let coefficient = coefficients[(i, j)];
                // Columns were divided by their length: a unit of the unknown is so many of the base parameter's.
                map[(i, unknown)] = if coefficient.abs() < COEFFICIENT { 0.0 } else { coefficient * lengths[unknown] / lengths[own] };
            }
            independent.iter().for_each(|&other| map[(i, other)] = 0.0);
            map[(i, own)] = 1.0;
        }
        Ok(Self { independent, map, singular, gap })
    }

    /// How many base parameters there are.
    pub fn rank(&self) -> usize {
        self.independent.len()
    }

    /// Largest over smallest singular value of the scaled columns, as far as they are no zeros.
    pub fn condition(&self) -> f64 {
        self.singular[0] / self.singular[self.rank() - 1]
    }

    /// The values of the base parameters: `β = B θ`.
    pub fn values(&self, theta: &[f64]) -> Vec<f64> {
        (&self.map * DVector::from_column_slice(theta)).as_slice().to_vec()
    }

    /// Each base parameter as a combination of unknowns, such as `Izz1 + 0.25 m2`.
    pub fn names(&self, linear: &LinearModel) -> Vec<String> {
        self.independent.iter().enumerate().map(|(i, &own)| self.name(linear, i, own)).collect()
    }

    fn name(&self, linear: &LinearModel, row: usize, own: usize) -> String {
        let mut text = linear.unknowns()[own].name();
        for (unknown, &coefficient) in linear.unknowns().iter().zip(self.map.row(row).iter()) {
            if coefficient == 0.0 || *unknown == linear.unknowns()[own] {
                continue;
            }
            text += if coefficient < 0.0 { " - " } else { " + " };
            let shown = short(coefficient.abs());
            if shown != "1" {
                text += &format!("{shown} ");
            }
            text += &unknown.name();
        }
        text
    }
}

/// What the states of a rank are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Random velocities and accelerations.
    Any,
    /// At rest.
    AtRest,
}

/// A number with six digits at most.
fn short(x: f64) -> String {
    let digits = (5 - x.abs().log10().floor().clamp(-20.0, 5.0) as i32).max(0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The first columns of which none depends on those before it: Gram and Schmidt, twice for orthogonality to rounding.
fn first_independent(space: &DMatrix<f64>) -> Vec<usize> {
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(space.nrows());
    let mut chosen = Vec::with_capacity(space.nrows());
    for (k, column) in space.column_iter().enumerate() {
        let mut rest = column.into_owned();
        for _ in 0..2 {
            for direction in &basis {
                let along = direction.dot(&rest);
                rest.axpy(-along, direction, 1.0);
            }
        }
        let length = rest.norm();
        if length > INDEPENDENT * column.norm() && basis.len() < space.nrows() {
            basis.push(rest / length);
            chosen.push(k);
        }
    }
    chosen
}
