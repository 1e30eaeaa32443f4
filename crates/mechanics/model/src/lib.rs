//! What a robot is: its description and its compiled model.
//!
//! A [`Description`] is what users write: named bodies and joints of every kind, as plain numbers. [`Model::build`] compiles it:
//! - fixed joints are merged;
//! - bodies are put in depth-first order;
//! - composed joints (planar, universal, …) become chains of the primitive joints of [`JointKind`], with massless bodies between;
//! - a body whose joint turns about, or slides along, a coordinate axis gets axes in which that is z ([`Label`]).
//!
//! So no kernel meets a configuration-dependent motion subspace.
//!
//! [`Topology`] is the scalar-free part of a model; `Model<P>` adds the parameters.

mod canonical;
mod configuration;
mod continua;
mod description;
mod error;
mod joint;
mod joint_type;
mod label;
mod loops;
mod model;
mod orthonormal;
mod residuals;
mod section;
mod tangent;
mod topology;
mod uncertain;
mod validate;
mod words;

pub use configuration::{difference, integrate, interpolate, neutral};
pub use continua::{Continuum, ContinuumDefect, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, ContinuumTip};
pub use description::{BodyDescription, Description, Frame, JointDescription, Placement, Provenance};
pub use error::DimensionError;
pub use joint::{Axis, JointKind};
pub use joint_type::{JointType, OneDof};
pub use label::Label;
pub use loops::{Loop, LoopDefect, LoopEnd, LoopKind, LoopMotion};
pub use model::Model;
pub use residuals::{DescribedResidual, ResidualDefect, ResidualLaw, ResidualNumbers};
pub use section::Section;
pub use tangent::{TangentMap, d_difference, d_integrate};
pub use topology::{Joint, Topology};
pub use uncertain::{Acts, Correlation, Distribution, Target, TargetField, Uncertain, UncertainDefect, UncertainVariable};
pub use validate::{Malformed, Warning};
