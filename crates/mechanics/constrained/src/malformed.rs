//! What can be wrong with a constraint. Each error names the constraint.

use thiserror::Error;

/// A constraint that is none.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("constraint '{name}': {defect}")]
pub struct BadConstraint {
    /// The name of the constraint.
    pub name: String,
    /// What is wrong with it.
    pub defect: Defect,
}

/// What is wrong with a constraint.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Defect {
    /// NaN or infinite.
    #[error("{field} is {value}; give a finite number")]
    NotFinite {
        /// The field.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// A body that does not exist.
    #[error("its {side} frame is on body {body}, but the model has {bodies} bodies, counted from 0")]
    NoBody {
        /// Which frame.
        side: &'static str,
        /// The body named.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A matrix that is no rotation.
    #[error("the rotation of its {side} frame misses orthonormality by {miss:e} (determinant {determinant}); give a rotation matrix")]
    NotARotation {
        /// Which frame.
        side: &'static str,
        /// The largest entry of |R Rᵀ − 1|.
        miss: f64,
        /// The determinant: negative for a reflection.
        determinant: f64,
    },
    /// Both frames on one body, or both in the world.
    #[error("both frames are on one body, which cannot move in itself; name two bodies")]
    SameBody,
    /// A point that is held along no axis.
    #[error("the point is held along no axis; name one at least")]
    NoAxis,
    /// A distance that is not positive.
    #[error("the length is {length} m; a distance is positive (a length of zero is a point constraint)")]
    Length {
        /// The length.
        length: f64,
    },
    /// A gear of fewer than two wheels.
    #[error("{found} coordinates; a gear has two at least")]
    FewTerms {
        /// How many.
        found: usize,
    },
    /// A wheel without teeth.
    #[error("the coefficient of dof {dof} is zero; leave the dof out")]
    ZeroCoefficient {
        /// The dof.
        dof: usize,
    },
    /// A dof named twice.
    #[error("dof {dof} is named twice")]
    RepeatedDof {
        /// The dof.
        dof: usize,
    },
    /// A dof that does not exist.
    #[error("it names dof {dof}, but the model has {dofs} dofs, counted from 0")]
    NoDof {
        /// The dof named.
        dof: usize,
        /// How many there are.
        dofs: usize,
    },
    /// A dof of a spherical or free joint.
    #[error("dof {dof} belongs to a spherical or free joint, which has no coordinate per dof; name a joint of one dof")]
    NoCoordinate {
        /// The dof.
        dof: usize,
    },
    /// Two constraints share a name.
    #[error("another constraint has the same name; names must be unique")]
    DuplicateName,
}
