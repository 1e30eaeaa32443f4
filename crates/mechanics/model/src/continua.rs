//! Bodies of a description that deform: slender beams, rods and strings, with their material, their section and their discretisation.
//!
//! Continua are data. A [`Model`](crate::Model) is a rigid tree, and refuses a description that has them; `featherbench_continua` makes
//! elements of them. A body is named by its index in the description.

use crate::orthonormal::not_a_rotation;
use crate::words::words;
use crate::{Description, Placement};
use std::collections::HashSet;
use thiserror::Error;

/// A slender body that is clamped to a body of the tree, or to the world, at its root.
///
/// Its axis is x of the root's frame. Without load and without curvature it lies there from 0 to its length.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuum {
    /// Its name, unique among the continua.
    pub name: String,
    /// The body that its root is clamped to, or `None` for the world.
    pub body: Option<usize>,
    /// The root's frame on that body.
    pub placement: Placement,
    /// Its length, m.
    pub length: f64,
    /// What it is made of.
    pub material: ContinuumMaterial,
    /// Its section, the same all along.
    pub section: ContinuumSection,
    /// How it is discretised.
    pub element: ContinuumElement,
    /// How many elements, or shape functions for each strain.
    pub count: usize,
    /// What may deform; the rest is rigid.
    pub strains: Vec<ContinuumStrain>,
    /// The rigid body that its tip carries.
    pub tip: Option<ContinuumTip>,
}

/// A homogeneous, isotropic, linearly elastic material with Kelvin–Voigt damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuumMaterial {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν; the shear modulus is E / (2(1 + ν)).
    pub poisson: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
    /// The damping time η, s: the stress is E(ε + η ε̇), and in shear alike.
    pub damping: f64,
}

/// A section: the frame's x is along the body, y and z are the principal axes of the section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContinuumSection {
    /// A solid circle.
    Circle {
        /// Its radius, m.
        radius: f64,
    },
    /// A circular tube.
    Tube {
        /// The inner radius, m.
        inner: f64,
        /// The outer radius, m.
        outer: f64,
    },
    /// A solid rectangle.
    Rectangle {
        /// Its extent along y, m.
        width: f64,
        /// Its extent along z, m.
        height: f64,
    },
    /// Numbers of a section of any shape.
    General {
        /// Area, m².
        area: f64,
        /// Second moments of area about y and z, m⁴.
        second_moments: [f64; 2],
        /// Torsion constant, m⁴: torque is G times this times twist.
        torsion: f64,
        /// The shear factor k, at most 1: shear force is k G area times shear strain.
        shear_factor: f64,
    },
}

words! {
    /// How a continuum is discretised.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ContinuumElement {
        /// Rigid links of equal length; each has its springs at its start.
        LinksStart => "links_start",
        /// The same, with springs of twice the stiffness at the root.
        LinksStartStiffWall => "links_start_stiff_wall",
        /// Rigid links of equal length; the springs are in the middle of the elements.
        LinksMiddle => "links_middle",
        /// The deflection is a sum of monomials s², s³, ….
        Monomials => "monomials",
        /// The deflection is a sum of the exact modes of a clamped beam.
        Modes => "modes",
        /// The deflection is a cubic Hermite spline.
        Hermite => "hermite",
        /// A Cosserat rod with strains that are constant in each element.
        Sections => "sections",
        /// A string of rigid links without springs.
        StringLinks => "string_links",
        /// A string with a point mass at the end of each link.
        StringPoints => "string_points",
    }
}

words! {
    /// A strain of a rod, in axes of its section: rotations, then translations, as in a 6-vector.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum ContinuumStrain {
        /// Twist κ_x, about x.
        Twist => "twist",
        /// Curvature κ_y: bending about y.
        BendY => "bend_y",
        /// Curvature κ_z: bending about z.
        BendZ => "bend_z",
        /// Extension along x.
        Extension => "extension",
        /// Shear along y.
        ShearY => "shear_y",
        /// Shear along z.
        ShearZ => "shear_z",
    }
}

/// A rigid body that is fixed to the tip. Its axes are those of the tip's section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuumTip {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the tip's frame, m.
    pub com: [f64; 3],
    /// Rotational inertia about the centre of mass in the tip's axes (xx, xy, xz, yy, yz, zz), kg·m².
    pub inertia: [f64; 6],
}

/// What is wrong with a continuum.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ContinuumDefect {
    /// Another continuum has the same name.
    #[error("another continuum has the same name; names must be unique")]
    DuplicateName,
    /// A number is NaN or infinite.
    #[error("{field} is {value}; write a finite number")]
    NotFinite {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// It is clamped to a body that does not exist.
    #[error("body: it is clamped to nothing: body {body} does not exist (there are {count} bodies, counted from 0; the world is -1)")]
    ClampedToNothing {
        /// The index that it names.
        body: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// The rotation of the root is not orthonormal, or it is a reflection.
    #[error("placement: its rotation misses orthonormality by {error:e}; give a rotation matrix in row-major order")]
    NotARotation {
        /// Largest entry of |RRᵀ − 1|, or of |det R − 1|.
        error: f64,
    },
    /// A number that must be positive is not.
    #[error("{field} is {value}; it must be positive")]
    NotPositive {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// A number is negative that must not be.
    #[error("{field} is {value}; it cannot be negative")]
    Negative {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// Poisson's ratio of no stable material.
    #[error("material.poisson is {value}; Poisson's ratio of a stable material is above -1 and at most 0.5")]
    Poisson {
        /// The ratio.
        value: f64,
    },
    /// A tube without a wall.
    #[error("section.inner is {inner} m, and section.outer is {outer} m; a wall needs an outer radius above the inner one")]
    NoWall {
        /// The inner radius.
        inner: f64,
        /// The outer radius.
        outer: f64,
    },
    /// A shear factor above one.
    #[error("section.shear_factor is {value}; it is at most 1")]
    ShearFactor {
        /// The factor.
        value: f64,
    },
    /// No elements.
    #[error("count is 0; a continuum has one element at least")]
    NoElements,
    /// Nothing may deform.
    #[error("strains: the list is empty; name what may deform, or describe a rigid body")]
    NoStrain,
    /// A strain stands twice.
    #[error("strains: '{strain}' stands twice")]
    RepeatedStrain {
        /// The strain's word.
        strain: &'static str,
    },
    /// A string that does not swing about z.
    #[error("strains: a string turns about z, or about y and z; name bend_z too")]
    StringAboutY,
    /// The element does not have this strain.
    #[error("strains: '{strain}' is none of a continuum of element '{element}'; it has {known}")]
    StrainOfOther {
        /// The strain's word.
        strain: &'static str,
        /// The element's word.
        element: &'static str,
        /// The strains that it has.
        known: String,
    },
}

impl ContinuumElement {
    /// The strains that it can have. A string bends freely: its links turn about z, or about y and z.
    pub fn strains(self) -> &'static [ContinuumStrain] {
        use ContinuumStrain::{BendY, BendZ, Extension, Twist};
        match self {
            Self::LinksStart | Self::LinksStartStiffWall | Self::LinksMiddle | Self::Sections => &ContinuumStrain::ALL,
            Self::Monomials | Self::Modes | Self::Hermite => &[Twist, BendY, BendZ, Extension],
            Self::StringLinks | Self::StringPoints => &[BendY, BendZ],
        }
    }

    fn is_string(self) -> bool {
        matches!(self, Self::StringLinks | Self::StringPoints)
    }
}

impl ContinuumSection {
    /// The word for it in a description file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circle { .. } => "circle",
            Self::Tube { .. } => "tube",
            Self::Rectangle { .. } => "rectangle",
            Self::General { .. } => "general",
        }
    }

    fn check(self) -> Result<(), ContinuumDefect> {
        match self {
            Self::Circle { radius } => positive("section.radius", radius),
            Self::Tube { inner, outer } => {
                not_negative("section.inner", inner)?;
                positive("section.outer", outer)?;
                if inner < outer { Ok(()) } else { Err(ContinuumDefect::NoWall { inner, outer }) }
            }
            Self::Rectangle { width, height } => {
                positive("section.width", width)?;
                positive("section.height", height)
            }
            Self::General { area, second_moments, torsion, shear_factor } => {
                positive("section.area", area)?;
                second_moments.into_iter().try_for_each(|moment| positive("section.second_moments", moment))?;
                positive("section.torsion", torsion)?;
                positive("section.shear_factor", shear_factor)?;
                if shear_factor <= 1.0 { Ok(()) } else { Err(ContinuumDefect::ShearFactor { value: shear_factor }) }
            }
        }
    }
}

impl ContinuumMaterial {
    fn check(self) -> Result<(), ContinuumDefect> {
        positive("material.young", self.young)?;
        finite("material.poisson", &[self.poisson])?;
        if !(self.poisson > -1.0 && self.poisson <= 0.5) {
            return Err(ContinuumDefect::Poisson { value: self.poisson });
        }
        positive("material.density", self.density)?;
        not_negative("material.damping", self.damping)
    }
}

impl Continuum {
    fn check(&self, count: usize) -> Result<(), ContinuumDefect> {
        if let Some(body) = self.body.filter(|body| *body >= count) {
            return Err(ContinuumDefect::ClampedToNothing { body, count });
        }
        finite("placement.rotation", &self.placement.rotation)?;
        finite("placement.translation", &self.placement.translation)?;
        if let Some(error) = not_a_rotation(&self.placement.rotation) {
            return Err(ContinuumDefect::NotARotation { error });
        }
        positive("length", self.length)?;
        self.material.check()?;
        self.section.check()?;
        if self.count == 0 {
            return Err(ContinuumDefect::NoElements);
        }
        self.check_strains()?;
        match &self.tip {
            Some(tip) => {
                not_negative("tip.mass", tip.mass)?;
                finite("tip.com", &tip.com)?;
                finite("tip.inertia", &tip.inertia)
            }
            None => Ok(()),
        }
    }

    fn check_strains(&self) -> Result<(), ContinuumDefect> {
        if self.strains.is_empty() {
            return Err(ContinuumDefect::NoStrain);
        }
        let own = self.element.strains();
        if self.element.is_string() && self.strains == [ContinuumStrain::BendY] {
            return Err(ContinuumDefect::StringAboutY);
        }
        for (k, strain) in self.strains.iter().enumerate() {
            let name = strain.name();
            if self.strains[..k].contains(strain) {
                return Err(ContinuumDefect::RepeatedStrain { strain: name });
            }
            if !own.contains(strain) {
                let known = own.iter().map(|strain| strain.name()).collect::<Vec<_>>().join(", ");
                return Err(ContinuumDefect::StrainOfOther { strain: name, element: self.element.name(), known });
            }
        }
        Ok(())
    }
}

impl Description {
    /// The first malformed continuum, by its index.
    pub(crate) fn validate_continua(&self) -> Result<(), (usize, ContinuumDefect)> {
        let mut names = HashSet::new();
        for (index, continuum) in self.continua.iter().enumerate() {
            if !names.insert(continuum.name.as_str()) {
                return Err((index, ContinuumDefect::DuplicateName));
            }
            continuum.check(self.bodies.len()).map_err(|defect| (index, defect))?;
        }
        Ok(())
    }
}

fn finite(field: &'static str, values: &[f64]) -> Result<(), ContinuumDefect> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(ContinuumDefect::NotFinite { field, value }),
        None => Ok(()),
    }
}

fn positive(field: &'static str, value: f64) -> Result<(), ContinuumDefect> {
    finite(field, &[value])?;
    if value > 0.0 { Ok(()) } else { Err(ContinuumDefect::NotPositive { field, value }) }
}

fn not_negative(field: &'static str, value: f64) -> Result<(), ContinuumDefect> {
    finite(field, &[value])?;
    if value >= 0.0 { Ok(()) } else { Err(ContinuumDefect::Negative { field, value }) }
}
