//! Rods on robots: what a [`Continuum`] is built from.

use crate::element::{Host, Piece, Spring, Ties, along_x, links, ritz, sections, string};
use crate::{Continuum, Defect, Element, Refused, Rod};
use featherbench_model::{BodyDescription, Description, JointType, Loop, Placement};

/// A robot with rods: a description to which rods are attached, each at a body or at the world.
///
/// ```
/// use featherbench_continua::{Assembly, Element, Hinges, Load, Rod, Strain, equilibrium};
/// // A cantilever of 16 links along x, bending about z, with a force of 0.1 EI/L² at its tip: δ ≈ 0.1/3 L.
/// let rod = Rod::textbook(1.0, 1.0, 1.0)?;
/// let mut assembly = Assembly::new(Default::default());
/// let element = Element::Links { count: 16, hinges: Hinges::Middle, strains: vec![Strain::BendZ] };
/// let tip = assembly.attach("beam", &rod, &element, None, Default::default())?;
/// let beam = assembly.build()?;
/// let load = Load::force(tip.body, tip.placement.translation, [0.0, 0.1, 0.0]);
/// let found = equilibrium(&beam, &[load], &Default::default())?;
/// let place = beam.place(&found.s, &tip)?;
/// assert!((place.translation.y / 0.0332953 - 1.0).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Assembly {
    description: Description,
    springs: Vec<(Spring, f64)>,
    pieces: Vec<(Piece, f64)>,
}

/// The end of a rod: a body of the assembly, and the end's place on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// The index of the body in the assembly.
    pub body: usize,
    /// The end of the rod in the body's frame, x along the rod.
    pub placement: Placement,
}

impl Assembly {
    /// The robot alone; an empty description for rods that are clamped to the world.
    pub fn new(description: Description) -> Self {
        Self { description, springs: Vec::new(), pieces: Vec::new() }
    }

    /// Attaches a rod to a body, or to the world, at this placement: x along the rod. Gives the rod's other end.
    ///
    /// # Errors
    /// [`Refused`]: the body does not exist, or the element has no part.
    pub fn attach(&mut self, name: &str, rod: &Rod, element: &Element, host: Option<usize>, placement: Placement) -> Result<Tip, Refused> {
        element.check()?;
        let bodies = self.description.bodies.len();
        if let Some(body) = host.filter(|body| *body >= bodies) {
            return Err(Refused::new("host", Defect::ClampedToNothing { body, bodies }));
        }
        let host = Host { body: host, placement };
        let into = &mut self.description.bodies;
        let made = match element {
            Element::Links { count, hinges, strains } => links::make(into, name, rod, &host, (*count, *hinges, strains)),
            Element::Ritz { basis, strains } => ritz::make(into, name, rod, &host, *basis, strains),
            Element::Sections { count, strains, points } => sections::make(into, name, rod, &host, (*count, strains, *points)),
            Element::String { count, masses, planar } => string::make(into, name, rod, &host, (*count, *masses, *planar)),
        };
        let damping = rod.material().damping;
        self.springs.extend(made.springs.into_iter().map(|spring| (spring, damping)));
        self.pieces.extend(made.pieces.into_iter().map(|piece| (piece, damping)));
        Ok(Tip { body: made.tip, placement: made.tip_placement })
    }

    /// Adds a body, for example one that a tip carries; gives its index. Its parent is an index of this assembly.
    pub fn add(&mut self, body: BodyDescription) -> usize {
        self.description.bodies.push(body);
        self.description.bodies.len() - 1
    }

    /// Ties bodies beside the tree, for example a rod's end to the world. The dynamics of this crate are those of the tree:
    /// `featherbench_constrained` closes the loop on [`Continuum::model`], where rods of links and strings have their own coordinates.
    pub fn tie(&mut self, tie: Loop) {
        self.description.loops.push(tie);
    }

    /// The description with all bodies so far.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The robot with rigid rods: every elastic joint is fixed where the rod is straight. Its dofs are those of the robot, in their order;
    /// a rod that stands on the world is no longer there.
    pub fn rigid(&self) -> Description {
        let mut description = self.description.clone();
        let fix = |body: &mut BodyDescription| body.joint.kind = JointType::Fixed;
        self.springs.iter().for_each(|(spring, _)| fix(&mut description.bodies[spring.body]));
        for (piece, _) in &self.pieces {
            for (k, body) in piece.bodies.iter().enumerate() {
                let body = &mut description.bodies[*body];
                fix(body);
                if let Ties::Screw { steps, .. } = &piece.ties {
                    body.joint.placement = along_x(&body.joint.placement, steps[k]);
                }
            }
        }
        description
    }

    /// The robot with its rods, ready to compute with.
    ///
    /// # Errors
    /// [`Refused`] when the bodies are no tree.
    pub fn build(self) -> Result<Continuum, Refused> {
        let Self { description, springs, pieces } = self;
        Continuum::build(&description, &springs, pieces)
    }
}
