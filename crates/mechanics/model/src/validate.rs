//! The two levels of validation: malformed is an error, unphysical is a warning of the model.

use crate::orthonormal::{not_a_rotation, rotation, unit};
use crate::{BodyDescription, ContinuumDefect, Description, JointType, LoopDefect, ResidualDefect, UncertainDefect};
use thiserror::Error;

/// Why a description is not a robot. Every message names the body and says what to do.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Malformed {
    /// No body moves.
    #[error("the robot has no moving body; give it at least one body whose joint is not fixed")]
    Empty,
    /// A number is NaN or infinite.
    #[error("body '{body}': {field} is {value}; write a finite number")]
    NotFinite {
        /// The body's name.
        body: String,
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// The mass is negative.
    #[error("body '{body}': mass is {mass} kg; a mass cannot be negative")]
    NegativeMass {
        /// The body's name.
        body: String,
        /// The mass.
        mass: f64,
    },
    /// The parent index does not exist.
    #[error("body '{body}': parent {parent} does not exist (there are {count} bodies, counted from 0; the world is -1)")]
    Orphan {
        /// The body's name.
        body: String,
        /// The index that it names.
        parent: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// The chain of parents returns to the body.
    #[error("body '{body}': its chain of parents returns to itself; cut the cycle so that every chain ends at the world")]
    Cycle {
        /// The body's name.
        body: String,
    },
    /// Two bodies share a name.
    #[error("two bodies are named '{body}'; names must be unique")]
    DuplicateName {
        /// The name.
        body: String,
    },
    /// The length of the axis is not one.
    #[error("body '{body}': the axis of joint '{joint}' has length {length}; give a unit vector")]
    NonUnitAxis {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// The axis' length.
        length: f64,
    },
    /// The rotation is not orthonormal, or it is a reflection.
    #[error("body '{body}': the rotation of joint '{joint}' misses orthonormality by {error:e}; give a rotation matrix in row-major order")]
    NotARotation {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// Largest entry of |RRᵀ − 1|, or of |det R − 1|.
        error: f64,
    },
    /// A per-dof list has the wrong length.
    #[error("body '{body}': {field} of joint '{joint}' has {found} numbers; a {kind} joint takes {expected} (or none)")]
    WrongLength {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// The field.
        field: &'static str,
        /// The joint's kind.
        kind: &'static str,
        /// Numbers found.
        found: usize,
        /// Degrees of freedom.
        expected: usize,
    },
    /// A per-dof number is negative where it must not be.
    #[error("body '{body}': {field} of joint '{joint}' is negative ({value})")]
    Negative {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// The field.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// The lower limit is above the upper.
    #[error("body '{body}': joint '{joint}' has lower limit {lower} above upper limit {upper}")]
    CrossedLimits {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// The lower limit.
        lower: f64,
        /// The upper limit.
        upper: f64,
    },
    /// Armature on a free joint: engines define it differently.
    #[error("body '{body}': armature on the free joint '{joint}'; engines disagree on its meaning, set it to zero")]
    ArmatureOnFreeJoint {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
    },
    /// The rotation of a frame is not orthonormal, or it is a reflection.
    #[error("frame '{frame}': its rotation misses orthonormality by {error:e}; give a rotation matrix in row-major order")]
    FrameNotARotation {
        /// The frame's name.
        frame: String,
        /// Largest entry of |RRᵀ − 1|, or of |det R − 1|.
        error: f64,
    },
    /// A frame is fixed to a body that does not exist.
    #[error("frame '{frame}': body {body} does not exist")]
    FrameOrphan {
        /// The frame's name.
        frame: String,
        /// The index that it names.
        body: usize,
    },
    /// A loop is none.
    #[error("loops[{index}] '{name}': {defect}")]
    Loop {
        /// The loop's name.
        name: String,
        /// Its place in the list, counted from 0.
        index: usize,
        /// What is wrong with it.
        defect: LoopDefect,
    },
    /// A continuum is none.
    #[error("continua[{index}] '{name}': {defect}")]
    Continuum {
        /// The continuum's name.
        name: String,
        /// Its place in the list, counted from 0.
        index: usize,
        /// What is wrong with it.
        defect: ContinuumDefect,
    },
    /// Bodies deform where a rigid tree is asked for.
    #[error("its continua ({}) deform, and this is for rigid bodies alone; take them out, or use featherbench_continua", names.join(", "))]
    Deforms {
        /// Their names.
        names: Vec<String>,
    },
    /// A residual is none.
    #[error("residuals[{index}] '{name}': {defect}")]
    Residual {
        /// The residual's name.
        name: String,
        /// Its place in the list, counted from 0.
        index: usize,
        /// What is wrong with it.
        defect: ResidualDefect,
    },
    /// An uncertain variable or correlation is none.
    #[error("uncertain{} '{name}': {defect}", place.map_or_else(String::new, |k| format!(".variables[{k}]")))]
    Uncertain {
        /// The variable's name.
        name: String,
        /// Its place in the list, counted from 0; `None` of what is about several.
        place: Option<usize>,
        /// What is wrong with it.
        defect: UncertainDefect,
    },
}

impl Malformed {
    /// The body, frame, loop, continuum, residual or variable of the error, so that a parser can say where it is in the file.
    pub fn about(&self) -> Option<&str> {
        match self {
            Self::Empty | Self::Deforms { .. } => None,
            Self::FrameOrphan { frame, .. } | Self::FrameNotARotation { frame, .. } => Some(frame),
            Self::Loop { name, .. } | Self::Continuum { name, .. } | Self::Residual { name, .. } | Self::Uncertain { name, .. } => {
                Some(name)
            }
            Self::NotFinite { body, .. }
            | Self::NegativeMass { body, .. }
            | Self::Orphan { body, .. }
            | Self::Cycle { body }
            | Self::DuplicateName { body }
            | Self::NonUnitAxis { body, .. }
            | Self::NotARotation { body, .. }
            | Self::WrongLength { body, .. }
            | Self::Negative { body, .. }
            | Self::CrossedLimits { body, .. }
            | Self::ArmatureOnFreeJoint { body, .. } => Some(body),
        }
    }
}

/// Something unusual about a robot. It is an error only where an algorithm meets a pivot that is not positive.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// A moving body has no mass.
    #[error("body '{body}' moves but has no mass")]
    Massless {
        /// The body's name.
        body: String,
    },
    /// The principal moments violate the triangle inequality, or one is negative: no mass distribution has this inertia.
    #[error("body '{body}' has an inertia that no mass distribution has (second moment eigenvalue {least:e} of {scale:e})")]
    Unphysical {
        /// The body's name.
        body: String,
        /// Smallest eigenvalue of the second moment of mass ½tr(I)·1 − I.
        least: f64,
        /// Trace of the inertia.
        scale: f64,
    },
    /// An axis or a rotation is normalised by more than an ulp.
    #[error("body '{body}': the {field} of joint '{joint}' misses {} by {by:e}; it is normalised", if *.field == "axis" { "unit length" } else { "orthonormality" })]
    Normalised {
        /// The body's name.
        body: String,
        /// The joint's name.
        joint: String,
        /// `axis` or `rotation`.
        field: &'static str,
        /// | |u| − 1 | of an axis, half the largest entry of |RRᵀ − 1| of a rotation.
        by: f64,
    },
    /// The description has loops. A model does not.
    #[error("its loops ({}) are left out: model, states and answers are those of the tree without them", names.join(", "))]
    Loops {
        /// Their names.
        names: Vec<String>,
    },
}

/// An axis may miss length one by as much as a rotation misses orthonormality.
const AXIS_TOLERANCE: f64 = 1e-6;

impl Description {
    /// Checks that the description is a forest of bodies with finite, meaningful numbers.
    ///
    /// # Errors
    /// The first [`Malformed`] finding: in the order of the bodies, of the frames, of the loops, of the continua, of the residuals, of the
    /// uncertain parameters.
    pub fn validate(&self) -> Result<(), Malformed> {
        let count = self.bodies.len();
        let mut names = std::collections::HashSet::new();
        finite("world", "gravity", &self.gravity)?;
        for body in &self.bodies {
            if !names.insert(body.name.as_str()) {
                return Err(Malformed::DuplicateName { body: body.name.clone() });
            }
            if let Some(parent) = body.parent.filter(|&parent| parent >= count) {
                return Err(Malformed::Orphan { body: body.name.clone(), parent, count });
            }
            body.validate()?;
        }
        self.validate_acyclic()?;
        for frame in &self.frames {
            if let Some(body) = frame.body.filter(|&body| body >= count) {
                return Err(Malformed::FrameOrphan { frame: frame.name.clone(), body });
            }
            finite(&frame.name, "frame placement", &frame.placement.rotation)?;
            finite(&frame.name, "frame placement", &frame.placement.translation)?;
            if let Some(error) = not_a_rotation(&frame.placement.rotation) {
                return Err(Malformed::FrameNotARotation { frame: frame.name.clone(), error });
            }
        }
        let name = |index: usize| self.loops[index].name.clone();
        self.validate_loops().map_err(|(index, defect)| Malformed::Loop { name: name(index), index, defect })?;
        let name = |index: usize| self.continua[index].name.clone();
        self.validate_continua().map_err(|(index, defect)| Malformed::Continuum { name: name(index), index, defect })?;
        let name = |index: usize| self.residuals[index].name.clone();
        self.validate_residuals().map_err(|(index, defect)| Malformed::Residual { name: name(index), index, defect })?;
        self.validate_uncertain()
    }

    /// An error if a body deforms: for what computes with rigid trees alone.
    ///
    /// # Errors
    /// [`Malformed::Deforms`], naming the continua.
    ///
    /// ```
    /// use featherbench_model::Description;
    ///
    /// assert!(Description::default().must_be_rigid().is_ok());
    /// ```
    pub fn must_be_rigid(&self) -> Result<(), Malformed> {
        if self.continua.is_empty() {
            return Ok(());
        }
        Err(Malformed::Deforms { names: self.continua.iter().map(|continuum| continuum.name.clone()).collect() })
    }

    /// Every chain of parents must end at the world; a chain of more steps than there are bodies has a cycle.
    fn validate_acyclic(&self) -> Result<(), Malformed> {
        let mut grounded = vec![false; self.bodies.len()];
        for start in 0..self.bodies.len() {
            let (mut path, mut at) = (Vec::new(), Some(start));
            while let Some(body) = at.filter(|&body| !grounded[body]) {
                if path.len() > self.bodies.len() {
                    return Err(Malformed::Cycle { body: self.bodies[start].name.clone() });
                }
                path.push(body);
                at = self.bodies[body].parent;
            }
            path.into_iter().for_each(|body| grounded[body] = true);
        }
        Ok(())
    }

    /// The warnings:
    ///
    /// - axes and rotations that are normalised by more than an ulp,
    /// - moving bodies without mass,
    /// - moving bodies with an inertia that no mass distribution has,
    /// - loops, of which a model knows nothing.
    pub fn warnings(&self) -> Vec<Warning> {
        let moving = self.bodies.iter().filter(|body| body.joint.kind != JointType::Fixed);
        let names: Vec<String> = self.loops.iter().map(|tie| tie.name.clone()).collect();
        let loops = (!names.is_empty()).then_some(Warning::Loops { names });
        self.normalised().chain(moving.filter_map(BodyDescription::warning)).chain(loops).collect()
    }

    /// The axes and rotations that the canonical form normalises by more than an ulp. A canonical description has none.
    pub fn normalised(&self) -> impl Iterator<Item = Warning> + '_ {
        self.bodies.iter().flat_map(|body| {
            let axis = body.joint.kind.axis().map(|axis| ("axis", unit(axis).missed));
            let turned = ("rotation", rotation(body.joint.placement.rotation).missed);
            let missed = axis.into_iter().chain([turned]).filter(|&(_, by)| by > f64::EPSILON);
            missed.map(|(field, by)| Warning::Normalised { body: body.name.clone(), joint: body.joint.name.clone(), field, by })
        })
    }
}

impl BodyDescription {
    fn validate(&self) -> Result<(), Malformed> {
        let (body, joint) = (|| self.name.clone(), || self.joint.name.clone());
        finite(&self.name, "mass", &[self.mass])?;
        finite(&self.name, "com", &self.com)?;
        finite(&self.name, "inertia", &self.inertia)?;
        finite(&self.name, "placement.rotation", &self.joint.placement.rotation)?;
        finite(&self.name, "placement.translation", &self.joint.placement.translation)?;
        if self.mass < 0.0 {
            return Err(Malformed::NegativeMass { body: body(), mass: self.mass });
        }
        if let Some(axis) = self.joint.kind.axis() {
            finite(&self.name, "axis", &axis)?;
            let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (length - 1.0).abs() > AXIS_TOLERANCE {
                return Err(Malformed::NonUnitAxis { body: body(), joint: joint(), length });
            }
        }
        if let JointType::Helical { pitch, .. } = self.joint.kind {
            finite(&self.name, "pitch", &[pitch])?;
        }
        if let Some(error) = not_a_rotation(&self.joint.placement.rotation) {
            return Err(Malformed::NotARotation { body: body(), joint: joint(), error });
        }
        self.validate_dofs()
    }

    fn validate_dofs(&self) -> Result<(), Malformed> {
        let joint = &self.joint;
        let (kind, expected) = (joint.kind.name(), joint.kind.nv());
        let lists = [
            ("armature", &joint.armature, true),
            ("damping", &joint.damping, true),
            ("friction", &joint.friction, true),
            ("lower", &joint.lower, false),
            ("upper", &joint.upper, false),
            ("velocity", &joint.velocity, true),
            ("effort", &joint.effort, true),
        ];
        for (field, values, non_negative) in lists {
            finite(&self.name, field, values)?;
            if !values.is_empty() && values.len() != expected {
                let (body, joint) = (self.name.clone(), joint.name.clone());
                return Err(Malformed::WrongLength { body, joint, field, kind, found: values.len(), expected });
            }
            if let Some(&value) = values.iter().find(|&&value| non_negative && value < 0.0) {
                return Err(Malformed::Negative { body: self.name.clone(), joint: joint.name.clone(), field, value });
            }
        }
        if let Some((&lower, &upper)) = joint.lower.iter().zip(&joint.upper).find(|(lower, upper)| lower > upper) {
            return Err(Malformed::CrossedLimits { body: self.name.clone(), joint: joint.name.clone(), lower, upper });
        }
        if joint.kind == JointType::Free && joint.armature.iter().any(|&armature| armature != 0.0) {
            return Err(Malformed::ArmatureOnFreeJoint { body: self.name.clone(), joint: joint.name.clone() });
        }
        Ok(())
    }

    fn warning(&self) -> Option<Warning> {
        if self.mass == 0.0 {
            return Some(Warning::Massless { body: self.name.clone() });
        }
        // ½tr(I)·1 − I is the second moment of mass about the centre of mass: it must be positive semidefinite.
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let scale = xx + yy + zz;
        let half = 0.5 * scale;
        let least = least_eigenvalue([half - xx, -xy, -xz, half - yy, -yz, half - zz]);
        // A planar body has an exact zero there: allow the rounding of a file with 6 digits.
        (least < -1e-6 * scale.abs()).then(|| Warning::Unphysical { body: self.name.clone(), least, scale })
    }
}

fn finite(body: &str, field: &'static str, values: &[f64]) -> Result<(), Malformed> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(Malformed::NotFinite { body: body.to_owned(), field, value }),
        None => Ok(()),
    }
}

/// Smallest eigenvalue of a symmetric 3×3 matrix by the trigonometric formula (O. K. Smith 1961). Its error is about 1e-8 of the scale, far
/// below what the warning needs.
fn least_eigenvalue([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> f64 {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let spread = ((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
    if spread == 0.0 {
        return mean;
    }
    let det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let angle = (det / (2.0 * spread.powi(3))).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * spread * (angle + 2.0 * std::f64::consts::FRAC_PI_3).cos()
}
