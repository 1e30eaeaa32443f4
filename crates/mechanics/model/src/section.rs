//! The sections of a description: what it can say of a robot beyond its bodies, their joints and gravity.
//!
//! Who computes with a description uses a section, or says by its name that it does not.

use crate::words::words;
use crate::{Description, JointDescription};

words! {
    /// What a description can say of a robot beyond its bodies, their joints and gravity.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Section {
        /// Named frames fixed to bodies.
        Frames => "frames",
        /// What ties bodies beside the tree.
        Loops => "loops",
        /// Bodies that deform.
        Continua => "continua",
        /// What the true robot needs beyond its rigid bodies.
        Residuals => "residuals",
        /// Which numbers are uncertain.
        Uncertain => "uncertain parameters",
        /// Armature of joints.
        Armature => "armature",
        /// Viscous damping of joints.
        Damping => "damping",
        /// Dry friction of joints.
        Friction => "friction",
        /// Position limits of joints.
        PositionLimits => "position limits",
        /// Speed limits of joints.
        SpeedLimits => "speed limits",
        /// Effort limits of joints.
        EffortLimits => "effort limits",
    }
}

impl Description {
    /// The sections that this robot has, with the names of what is in each: loops, frames, joints.
    ///
    /// ```
    /// use featherbench_model::{Description, Frame, Placement, Section};
    ///
    /// let camera = Frame { name: "camera".into(), body: None, placement: Placement::default() };
    /// let robot = Description { frames: vec![camera], ..Description::default() };
    /// assert_eq!(robot.sections(), [(Section::Frames, vec!["camera"])]);
    /// ```
    pub fn sections(&self) -> Vec<(Section, Vec<&str>)> {
        // By name, so that a field that is added does not compile until it is a section or no section.
        let Self { name: _, gravity: _, bodies, frames, loops, continua, residuals, uncertain, provenance: _ } = self;
        let joints = |has: fn(&JointDescription) -> bool| -> Vec<&str> {
            bodies.iter().map(|body| &body.joint).filter(|joint| has(joint)).map(|joint| joint.name.as_str()).collect()
        };
        let all = Section::ALL.map(|section| {
            let names = match section {
                Section::Frames => frames.iter().map(|frame| frame.name.as_str()).collect(),
                Section::Loops => loops.iter().map(|tie| tie.name.as_str()).collect(),
                Section::Continua => continua.iter().map(|continuum| continuum.name.as_str()).collect(),
                Section::Residuals => residuals.iter().map(|residual| residual.name.as_str()).collect(),
                Section::Uncertain => uncertain.variables.iter().map(|variable| variable.name.as_str()).collect(),
                Section::Armature => joints(|joint| is_some(&joint.armature)),
                Section::Damping => joints(|joint| is_some(&joint.damping)),
                Section::Friction => joints(|joint| is_some(&joint.friction)),
                Section::PositionLimits => joints(|joint| is_finite(&joint.lower) || is_finite(&joint.upper)),
                Section::SpeedLimits => joints(|joint| is_finite(&joint.velocity)),
                Section::EffortLimits => joints(|joint| is_finite(&joint.effort)),
            };
            (section, names)
        });
        all.into_iter().filter(|(_, names)| !names.is_empty()).collect()
    }
}

/// Whether one of these numbers is not the zero that an absent list stands for.
fn is_some(numbers: &[f64]) -> bool {
    numbers.iter().any(|x| *x != 0.0)
}

/// Whether one of these limits is a limit.
fn is_finite(limits: &[f64]) -> bool {
    limits.iter().any(|x| x.is_finite())
}
