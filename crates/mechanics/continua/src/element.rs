//! How a rod is discretised, and the bodies that this makes.
//!
//! Each file makes the bodies of one kind of element. They are bodies of a [`Description`](featherbench_model::Description): primitive
//! joints that our algorithms know. What ties their coordinates to those of the element is a [`Block`](crate::block::Block).

pub(crate) mod links;
pub(crate) mod ritz;
pub(crate) mod sections;
pub(crate) mod string;

use crate::{Basis, Defect, Refused, Strain};
use featherbench_model::{BodyDescription, JointDescription, JointType, Placement};
use nalgebra::DMatrix;

/// A discretisation of a rod.
#[derive(Clone, Debug, PartialEq)]
pub enum Element {
    /// Rigid links with springs at their joints: a spring of stiffness (strain stiffness)/h per strain, h the length of an element. The
    /// coordinates are those of the joints. So ABA serves it as it is: O(n).
    Links {
        /// The number of springs along the rod, per strain.
        count: usize,
        /// Where the joints are.
        hinges: Hinges,
        /// The strains, each a joint; on each link in the order of [`Strain`] with extension and shears first.
        strains: Vec<Strain>,
    },
    /// Shape functions of small deflections in the frame of the clamped end. The masses are at Gauss points. Stiffening by axial force is
    /// of second order in the deflection, and not part of it.
    Ritz {
        /// The shape functions of each strain.
        basis: Basis,
        /// What is deflected: [`Strain::Twist`], [`Strain::BendY`], [`Strain::BendZ`], [`Strain::Extension`]. Shears have no shape
        /// functions.
        strains: Vec<Strain>,
    },
    /// Elements of constant strain: each is a part of a screw motion, so large deflections are exact for the strain that there is. The
    /// masses are at Gauss points along the element.
    Sections {
        /// The number of elements.
        count: usize,
        /// The strains that vary; the others are those of a straight rod.
        strains: Vec<Strain>,
        /// Gauss points per element.
        points: usize,
    },
    /// A string: links without springs. Gravity or another tension makes it stiff.
    String {
        /// The number of links.
        count: usize,
        /// Where the mass is.
        masses: Masses,
        /// Whether it swings about z alone, or about y and z.
        planar: bool,
    },
}

/// Where the springs of rigid links are. h = L/n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hinges {
    /// At the start of each link, each with stiffness EI/h: a quadrature of order 1, since the spring at the clamp stands for h/2 only.
    Start,
    /// At the start of each link, with 2EI/h at the clamp: the trapezoidal rule, of order 2.
    StartStiffWall,
    /// In the middle of each element, with EI/h: the midpoint rule, of order 2. Half an element is rigid with the host.
    Middle,
}

/// Where the mass of a string is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// A point mass at the end of each link: for the hanging string the squared frequencies are (g/ℓ) times the roots of the Laguerre
    /// polynomial.
    Ends,
    /// Uniform rods.
    Uniform,
}

/// Where a rod begins: its x axis leaves the host along the placement's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Host {
    pub(crate) body: Option<usize>,
    pub(crate) placement: Placement,
}

/// A spring at the joint of a body: torque or force per radian or metre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    pub(crate) body: usize,
    pub(crate) stiffness: f64,
}

/// Bodies whose joints follow common coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) bodies: Vec<usize>,
    pub(crate) ties: Ties,
    pub(crate) stiffness: DMatrix<f64>,
}

/// How they follow.
#[derive(Clone, Debug)]
pub(crate) enum Ties {
    /// One-dof joints: q = Φ s.
    Linear { shapes: DMatrix<f64> },
    /// Free joints along a screw motion, each at this distance from the one before.
    Screw { steps: Vec<f64>, strains: Vec<Strain> },
}

/// What an element made.
pub(crate) struct Made {
    pub(crate) tip: usize,
    pub(crate) tip_placement: Placement,
    pub(crate) springs: Vec<Spring>,
    pub(crate) pieces: Vec<Piece>,
}

impl Element {
    /// An error that names what no element can have.
    pub(crate) fn check(&self) -> Result<(), Refused> {
        let some = |field: &str, count: usize| if count == 0 { Err(Refused::new(field, Defect::None)) } else { Ok(()) };
        match self {
            Self::Links { count, strains, .. } => {
                some("element.count", *count)?;
                each_once(strains)
            }
            Self::Ritz { basis, strains } => {
                let terms = basis.terms(false);
                some("element.basis", terms)?;
                each_once(strains)?;
                let shear = strains.iter().find(|strain| matches!(strain, Strain::ShearY | Strain::ShearZ));
                match shear {
                    Some(shear) => Err(Refused::new(
                        "element.strains",
                        Defect::Tree { reason: format!("{shear:?} has no shape functions; use twist, bending and extension") },
                    )),
                    None => Ok(()),
                }
            }
            Self::Sections { count, strains, points } => {
                some("element.count", *count)?;
                each_once(strains)?;
                // One point mass per element and strain at least; two make M positive definite for all strains together with those before.
                if *points < 2 {
                    return Err(Refused::new("element.points", Defect::Points { found: *points, needed: 2 }));
                }
                Ok(())
            }
            Self::String { count, .. } => some("element.count", *count),
        }
    }
}

fn each_once(strains: &[Strain]) -> Result<(), Refused> {
    let mut sorted = strains.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    if strains.is_empty() || sorted.len() != strains.len() {
        return Err(Refused::new("element.strains", Defect::Strains { found: strains.len(), different: sorted.len() }));
    }
    Ok(())
}

/// A body without mass, on a joint at a distance along x from its parent.
pub(crate) fn massless(name: String, parent: Option<usize>, kind: JointType, placement: Placement) -> BodyDescription {
    let joint = JointDescription { name: format!("{name}.joint"), kind, placement, ..JointDescription::default() };
    BodyDescription { name, parent, mass: 0.0, com: [0.0; 3], inertia: [0.0; 6], joint }
}

/// The placement at a distance along x.
pub(crate) fn along(x: f64) -> Placement {
    Placement { translation: [x, 0.0, 0.0], ..Placement::default() }
}

/// The joint of a strain: a turn or a slide.
pub(crate) fn joint_of(strain: Strain) -> JointType {
    let axis = strain.axis();
    if strain.turns() { JointType::Revolute { axis } } else { JointType::Prismatic { axis } }
}

/// Adds a piece of rod of this length to a body, from x on.
pub(crate) fn add_piece(body: &mut BodyDescription, rod: &crate::Rod, x: f64, length: f64) {
    let mass = rod.mass_per_length() * length;
    let [about_x, about_y, about_z] = rod.rotary_inertia().map(|rotary| rotary * length);
    let thin = mass * length * length / 12.0;
    body.mass = mass;
    body.com = [x + 0.5 * length, 0.0, 0.0];
    body.inertia = [about_x, 0.0, 0.0, about_y + thin, 0.0, about_z + thin];
}

/// A placement moved along its x axis.
pub(crate) fn along_x(placement: &Placement, x: f64) -> Placement {
    let mut result = *placement;
    for (k, t) in result.translation.iter_mut().enumerate() {
        *t += placement.rotation[3 * k] * x;
    }
    result
}
