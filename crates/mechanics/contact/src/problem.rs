//! What a contact problem is: the Delassus matrix, the free velocity, and a contact law per contact.

use crate::ball::Ball;
use crate::extended;
use crate::malformed::{self, Defect, Malformed};
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What the unknowns are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Impulses in N·s change velocities in m/s.
    Impulse,
    /// Forces in N change accelerations in m/s².
    Force,
}

/// The friction law of a contact. It also says how many rows the contact has.
///
/// Rows are in the contact's frame, the normal row first: `[n]`, `[n, t]` or `[n, t1, t2]`.
#[derive(Clone, Debug, PartialEq)]
pub enum Friction {
    /// No friction: one row.
    None,
    /// Coulomb friction, one coefficient per tangent row. Two coefficients that differ make the cone elliptic: its axes are t1 and t2.
    Coulomb {
        /// The coefficients: one for a planar contact, two for a spatial one.
        coefficients: Vec<f64>,
    },
    /// A friction pyramid of a spatial contact: λ_t/λ_n is in the convex hull of the vertices.
    Pyramid {
        /// The corners of the section λ_n = 1. Their hull contains zero.
        vertices: Vec<[f64; 2]>,
    },
    /// The contact slides in a known direction d: λ_t = −μ λ_n d.
    Sliding {
        /// μ.
        coefficient: f64,
        /// The unit vector d, with one or two numbers.
        direction: Vec<f64>,
    },
}

/// One contact: a name, its friction law and its coefficient of restitution.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// A name for messages.
    pub name: String,
    /// The friction law.
    pub friction: Friction,
    /// The coefficient of restitution e, in [0, 1]. The impact law says what it means.
    pub restitution: f64,
}

impl Contact {
    /// A contact without restitution.
    pub fn new(name: impl Into<String>, friction: Friction) -> Self {
        Self { name: name.into(), friction, restitution: 0.0 }
    }

    /// A contact without friction: one row.
    pub fn frictionless(name: impl Into<String>) -> Self {
        Self::new(name, Friction::None)
    }

    /// A planar Coulomb contact: two rows.
    pub fn planar(name: impl Into<String>, coefficient: f64) -> Self {
        Self::new(name, Friction::Coulomb { coefficients: vec![coefficient] })
    }

    /// A spatial Coulomb contact with a circular cone: three rows.
    pub fn spatial(name: impl Into<String>, coefficient: f64) -> Self {
        Self::new(name, Friction::Coulomb { coefficients: vec![coefficient; 2] })
    }

    /// A planar contact that slides: direction 1 is along t, −1 against it.
    pub fn sliding(name: impl Into<String>, coefficient: f64, direction: f64) -> Self {
        Self::new(name, Friction::Sliding { coefficient, direction: vec![direction] })
    }

    /// The same contact with a coefficient of restitution.
    #[must_use]
    pub fn with_restitution(self, restitution: f64) -> Self {
        Self { restitution, ..self }
    }

    /// The number of rows: 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        match &self.friction {
            Friction::None => 1,
            Friction::Coulomb { coefficients } => 1 + coefficients.len(),
            Friction::Pyramid { .. } => 3,
            Friction::Sliding { direction, .. } => 1 + direction.len(),
        }
    }
}

/// Checks the contacts and gives the first row of each, and the number of rows.
fn offsets(contacts: &[Contact], level: Level) -> Result<Vec<usize>, Malformed> {
    if contacts.is_empty() {
        return Err(Malformed::new("contacts", Defect::NoContact));
    }
    let mut offsets = vec![0];
    for (index, contact) in contacts.iter().enumerate() {
        friction(&contact.friction, &format!("contacts[{index}].friction"))?;
        let field = || format!("contacts[{index}].restitution");
        let value = contact.restitution;
        malformed::finite(value, field)?;
        if !(0.0..=1.0).contains(&value) {
            return Err(Malformed::new(field(), Defect::Restitution { value }));
        }
        if value > 0.0 && level == Level::Force {
            return Err(Malformed::new(field(), Defect::RestitutionOfForces { value }));
        }
        offsets.push(offsets[index] + contact.dimension());
    }
    Ok(offsets)
}

fn friction(friction: &Friction, field: &str) -> Result<(), Malformed> {
    let coefficient = |value: f64, field: &str| {
        malformed::finite(value, || field.to_owned())?;
        if value < 0.0 { Err(Malformed::new(field, Defect::NegativeFriction { value })) } else { Ok(()) }
    };
    let tangents = |found: usize, field: &str| match found {
        1 | 2 => Ok(()),
        _ => Err(Malformed::new(field, Defect::Tangents { found })),
    };
    match friction {
        Friction::None => Ok(()),
        Friction::Coulomb { coefficients } => {
            tangents(coefficients.len(), &format!("{field}.coulomb"))?;
            coefficients.iter().enumerate().try_for_each(|(k, value)| coefficient(*value, &format!("{field}.coulomb[{k}]")))
        }
        Friction::Pyramid { vertices } => {
            for (k, vertex) in vertices.iter().enumerate() {
                for (l, value) in vertex.iter().enumerate() {
                    malformed::finite(*value, || format!("{field}.pyramid[{k}][{l}]"))?;
                }
            }
            if contains_zero(vertices) { Ok(()) } else { Err(Malformed::new(format!("{field}.pyramid"), Defect::Pyramid)) }
        }
        Friction::Sliding { coefficient: value, direction } => {
            coefficient(*value, &format!("{field}.sliding.coefficient"))?;
            let field = format!("{field}.sliding.direction");
            tangents(direction.len(), &field)?;
            for (k, value) in direction.iter().enumerate() {
                malformed::finite(*value, || format!("{field}[{k}]"))?;
            }
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            // A unit vector with three decimals is meant as one; its error would be an error of μ.
            if (length - 1.0).abs() > 1e-12 { Err(Malformed::new(field, Defect::NotUnit { length })) } else { Ok(()) }
        }
    }
}

/// Whether zero is in the hull: seen from it, no gap between neighbouring vertices is wider than a half turn.
fn contains_zero(vertices: &[[f64; 2]]) -> bool {
    let mut angles: Vec<f64> = vertices.iter().filter(|v| **v != [0.0, 0.0]).map(|v| v[1].atan2(v[0])).collect();
    if vertices.len() < 3 || angles.len() < 2 {
        return false;
    }
    angles.sort_by(f64::total_cmp);
    let turn = std::f64::consts::TAU;
    let next = angles.iter().skip(1).copied().chain([angles[0] + turn]);
    // Rounding of the angles of two opposite vertices.
    angles.iter().zip(next).all(|(angle, next)| next - angle <= 0.5 * turn + 1e-12)
}

/// A mechanism in contact: mass matrix M (n×n), contact Jacobian J (rows×n), and generalized velocities.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism {
    /// M, symmetric and positive definite.
    pub mass: DMatrix<f64>,
    /// J: contact velocities are J v.
    pub jacobian: DMatrix<f64>,
    /// The velocity (or acceleration) without contact impulses (or forces).
    pub free: DVector<f64>,
}

impl Mechanism {
    /// G = J M⁻¹ Jᵀ and J v_free in double-double arithmetic, with bounds of their errors; `None` where M has no Cholesky factor.
    pub(crate) fn delassus(&self) -> Option<(extended::Matrix, Vec<Ball>)> {
        extended::delassus(&self.mass, &self.jacobian, &self.free)
    }
}

/// A contact problem: find impulses λ and velocities c = G λ + b that obey each contact's law.
///
/// - G = J M⁻¹ Jᵀ is the Delassus matrix, symmetric and positive semidefinite (kg⁻¹).
/// - b is the free velocity: c without contact impulses.
/// - The contact velocities before an impact are `before`. Only restitution uses them.
/// - Coulomb's law: 0 ≤ λ_n ⊥ c_n ≥ 0; λ_t is in the friction set of λ_n and makes c_tᵀλ_t least.
/// - Restitution e replaces c_n by c_n + e·c_n⁻ where the contact closes before (c_n⁻ < 0).
///
/// At the level of forces, read *force* for impulse and *acceleration* for velocity.
///
/// ```
/// use featherbench_contact::{Contact, Level, Problem};
/// use nalgebra::{DMatrix, DVector};
/// // A point of 2 kg meets the ground at 3 m/s and slides along it at 1 m/s.
/// let problem =
///     Problem::from_delassus("point", Level::Impulse, vec![Contact::planar("tip", 0.5)], DMatrix::from_row_slice(2, 2, &[0.5, 0.0, 0.0, 0.5]), DVector::from_vec(vec![-3.0, 1.0]))?;
/// assert_eq!(problem.rows(), 2);
/// # Ok::<(), featherbench_contact::Malformed>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    name: String,
    level: Level,
    contacts: Vec<Contact>,
    offsets: Vec<usize>,
    delassus: DMatrix<f64>,
    free: DVector<f64>,
    before: DVector<f64>,
    mechanism: Option<Mechanism>,
}

impl Problem {
    /// The problem of a Delassus matrix and a free velocity.
    ///
    /// # Errors
    /// [`Malformed`] names the field: sizes, numbers that are not finite, symmetry, definiteness, contacts.
    pub fn from_delassus(
        name: impl Into<String>,
        level: Level,
        contacts: Vec<Contact>,
        delassus: DMatrix<f64>,
        free: DVector<f64>,
    ) -> Result<Self, Malformed> {
        let offsets = offsets(&contacts, level)?;
        let rows = offsets[contacts.len()];
        malformed::matrix(&delassus, "delassus", (rows, rows))?;
        malformed::vector(&free, "free", rows)?;
        malformed::symmetric(&delassus, "delassus")?;
        malformed::semidefinite(&delassus, "delassus")?;
        let before = free.clone();
        Ok(Self { name: name.into(), level, contacts, offsets, delassus, free, before, mechanism: None })
    }

    /// The problem of a mechanism in contact. G and b are computed in double-double arithmetic and rounded.
    ///
    /// # Errors
    /// [`Malformed`] names the field.
    pub fn from_mechanism(name: impl Into<String>, level: Level, contacts: Vec<Contact>, mechanism: Mechanism) -> Result<Self, Malformed> {
        let offsets = offsets(&contacts, level)?;
        let rows = offsets[contacts.len()];
        let dofs = mechanism.mass.nrows();
        malformed::matrix(&mechanism.mass, "mechanism.mass", (dofs, dofs))?;
        malformed::matrix(&mechanism.jacobian, "mechanism.jacobian", (rows, dofs))?;
        malformed::vector(&mechanism.free, "mechanism.free", dofs)?;
        malformed::symmetric(&mechanism.mass, "mechanism.mass")?;
        if Cholesky::new(mechanism.mass.clone()).is_none() {
            return Err(Malformed::new("mechanism.mass", Defect::NotPositiveDefinite));
        }
        let (delassus, free) = mechanism.delassus().ok_or_else(|| Malformed::new("mechanism.mass", Defect::NotPositiveDefinite))?;
        let (delassus, free) = (delassus.map(Ball::to_f64), DVector::from_iterator(rows, free.iter().map(|x| x.to_f64())));
        malformed::matrix(&delassus, "mechanism.jacobian", (rows, rows))?;
        let before = free.clone();
        Ok(Self { name: name.into(), level, contacts, offsets, delassus, free, before, mechanism: Some(mechanism) })
    }

    /// The same problem with other contact velocities before the impact. By default they are the free velocity.
    ///
    /// # Errors
    /// [`Malformed`] for another size or a number that is not finite.
    pub fn with_before(self, before: DVector<f64>) -> Result<Self, Malformed> {
        malformed::vector(&before, "before", self.rows())?;
        Ok(Self { before, ..self })
    }

    /// The same problem under another name.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Impulses and velocities, or forces and accelerations.
    pub fn level(&self) -> Level {
        self.level
    }

    /// The contacts, in the order of their rows.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The number of rows of all contacts.
    pub fn rows(&self) -> usize {
        self.offsets[self.contacts.len()]
    }

    /// The rows of one contact, the normal row first.
    pub fn range(&self, contact: usize) -> Range<usize> {
        self.offsets[contact]..self.offsets[contact + 1]
    }

    /// The Delassus matrix G.
    pub fn delassus(&self) -> &DMatrix<f64> {
        &self.delassus
    }

    /// The free velocity b.
    pub fn free(&self) -> &DVector<f64> {
        &self.free
    }

    /// The contact velocities before the impact.
    pub fn before(&self) -> &DVector<f64> {
        &self.before
    }

    /// The mechanism, where the problem was made from one.
    pub fn mechanism(&self) -> Option<&Mechanism> {
        self.mechanism.as_ref()
    }

    /// What restitution adds to c: e·c_n⁻ in the normal row of each contact that closes, zero elsewhere.
    pub fn restitution_shift(&self) -> DVector<f64> {
        let mut shift = DVector::zeros(self.rows());
        for (contact, row) in self.contacts.iter().zip(&self.offsets) {
            if self.before[*row] < 0.0 {
                shift[*row] = contact.restitution * self.before[*row];
            }
        }
        shift
    }

    /// The velocities c = G λ + b.
    ///
    /// # Panics
    /// If `impulses` does not have [`Problem::rows`] numbers.
    pub fn velocities(&self, impulses: &DVector<f64>) -> DVector<f64> {
        &self.delassus * impulses + &self.free
    }

    /// The change of kinetic energy by the impulses, ½ λᵀ(c + b), in J.
    ///
    /// # Panics
    /// If `impulses` does not have [`Problem::rows`] numbers.
    pub fn energy_change(&self, impulses: &DVector<f64>) -> f64 {
        0.5 * impulses.dot(&(self.velocities(impulses) + &self.free))
    }

    /// The kinetic energy ½ vᵀ M v of the mechanism without contact impulses, in J.
    pub fn free_energy(&self) -> Option<f64> {
        let mechanism = self.mechanism.as_ref()?;
        Some(0.5 * mechanism.free.dot(&(&mechanism.mass * &mechanism.free)))
    }

    /// Scales that make measures free of units: of velocities the largest |b| (1 if b = 0), of impulses that divided by the largest G_ii.
    pub fn scales(&self) -> Scales {
        let velocity = self.free.amax();
        let velocity = if velocity > 0.0 { velocity } else { 1.0 };
        let inverse_mass = self.delassus.diagonal().amax();
        Scales { velocity, impulse: if inverse_mass > 0.0 { velocity / inverse_mass } else { velocity } }
    }
}

/// The scales of a problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of velocities, in m/s (or m/s²).
    pub velocity: f64,
    /// Of impulses, in N·s (or N).
    pub impulse: f64,
}
