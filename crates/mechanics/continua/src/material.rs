//! What a rod is made of: material, cross-section, length. Each number is checked, and a bad one is refused by its name.
//!
//! Units: SI. Axes of a section: x along the rod; y and z are the principal axes of its area. I_y = ∫ z² dA is for bending about y.

use std::f64::consts::PI;
use thiserror::Error;

/// A linear elastic, isotropic material with Kelvin–Voigt damping: stress = E (ε + η ε̇).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν: more than −1, at most ½.
    pub poisson: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Damping time η, s: the damping matrix is η times the stiffness matrix.
    pub damping: f64,
}

impl Material {
    /// The shear modulus G = E / (2 (1 + ν)), Pa.
    pub fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }
}

/// A cross-section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Area A, m².
    pub area: f64,
    /// Second moments I_y = ∫ z² dA and I_z = ∫ y² dA, m⁴.
    pub second_moments: [f64; 2],
    /// The torsion constant J, m⁴: the moment is G J times the twist per length.
    pub torsion: f64,
    /// The shear factor k, at most 1: the shear force is k G A times the shear strain.
    pub shear_factor: f64,
}

impl Section {
    /// A full circle of this radius, with Cowper's shear factor for ν = 0: 6/7.
    pub fn circle(radius: f64) -> Self {
        let second = PI * radius.powi(4) / 4.0;
        Self { area: PI * radius * radius, second_moments: [second; 2], torsion: 2.0 * second, shear_factor: 6.0 / 7.0 }
    }

    /// A rectangle of `width` along y and `height` along z.
    ///
    /// The torsion constant is Saint-Venant's series `a b³/3 (1 − 192 b/(π⁵ a) Σ tanh(k π a/2b)/k⁵)` over odd k, a the longer side.
    pub fn rectangle(width: f64, height: f64) -> Self {
        let (a, b) = if width > height { (width, height) } else { (height, width) };
        // 40 terms leave less than 1e-9 / 192 of the sum, and the rest is summed as its tail integral ∫ dk / (2 k⁵).
        let sum: f64 = (0..40).map(|i| f64::from(2 * i + 1)).map(|k| (k * PI * a / (2.0 * b)).tanh() / k.powi(5)).sum();
        let tail = 1.0 / (8.0 * 80.0_f64.powi(4));
        let torsion = a * b.powi(3) / 3.0 * (1.0 - 192.0 * b / (PI.powi(5) * a) * (sum + tail));
        let second_moments = [width * height.powi(3) / 12.0, height * width.powi(3) / 12.0];
        Self { area: width * height, second_moments, torsion, shear_factor: 5.0 / 6.0 }
    }
}

/// A straight uniform rod: material, section, length, all checked.
///
/// ```
/// use featherbench_continua::{Material, Rod, Section};
/// let steel = Material { young: 2.1e11, poisson: 0.3, density: 7850.0, damping: 1e-4 };
/// let rod = Rod::new(steel, Section::circle(0.005), 1.0)?;
/// assert!((rod.mass() - 0.6165).abs() < 1e-4);
/// let refused = Rod::new(Material { poisson: 0.6, ..steel }, Section::circle(0.005), 1.0).unwrap_err();
/// assert_eq!(refused.field, "material.poisson");
/// # Ok::<(), featherbench_continua::Refused>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    material: Material,
    section: Section,
    length: f64,
    rotary: bool,
}

impl Rod {
    /// A rod of this material, section and length, if the numbers are those of a rod.
    ///
    /// # Errors
    /// [`Refused`] with the name of the first number that is not.
    pub fn new(material: Material, section: Section, length: f64) -> Result<Self, Refused> {
        positive("material.young", material.young)?;
        finite("material.poisson", material.poisson)?;
        if !(material.poisson > -1.0 && material.poisson <= 0.5) {
            return Err(Refused::new("material.poisson", Defect::Poisson { value: material.poisson }));
        }
        positive("material.density", material.density)?;
        finite("material.damping", material.damping)?;
        if material.damping < 0.0 {
            return Err(Refused::new("material.damping", Defect::Negative { value: material.damping }));
        }
        positive("section.area", section.area)?;
        positive("section.second_moments[0]", section.second_moments[0])?;
        positive("section.second_moments[1]", section.second_moments[1])?;
        positive("section.torsion", section.torsion)?;
        positive("section.shear_factor", section.shear_factor)?;
        if section.shear_factor > 1.0 {
            return Err(Refused::new("section.shear_factor", Defect::ShearFactor { value: section.shear_factor }));
        }
        positive("length", length)?;
        Ok(Self { material, section, length, rotary: true })
    }

    /// The rod with EI and ρA given directly, as textbooks state beams: E = EI, I_y = I_z = 1, A = 1, ν = 0, without rotary inertia.
    /// Its length is `length`, its extension and shear are as stiff as its bending.
    ///
    /// # Errors
    /// [`Refused`] as [`Rod::new`].
    pub fn textbook(bending: f64, mass_per_length: f64, length: f64) -> Result<Self, Refused> {
        let material = Material { young: bending, poisson: 0.0, density: mass_per_length, damping: 0.0 };
        let section = Section { area: 1.0, second_moments: [1.0; 2], torsion: 2.0, shear_factor: 1.0 };
        Ok(Self::new(material, section, length)?.without_rotary_inertia())
    }

    /// The rod without the rotary inertia ρI of its sections: Euler–Bernoulli's beam.
    pub fn without_rotary_inertia(self) -> Self {
        Self { rotary: false, ..self }
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The section.
    pub fn section(&self) -> &Section {
        &self.section
    }

    /// The length, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The mass, kg.
    pub fn mass(&self) -> f64 {
        self.mass_per_length() * self.length
    }

    /// ρA, kg/m.
    pub fn mass_per_length(&self) -> f64 {
        self.material.density * self.section.area
    }

    /// Rotary inertia per length of the section about x, y and z, kg·m: ρ (I_y + I_z), ρ I_y, ρ I_z; zero without rotary inertia. About x
    /// it stays: without it a twist would move no mass.
    pub fn rotary_inertia(&self) -> [f64; 3] {
        let [y, z] = self.section.second_moments.map(|second| self.material.density * second);
        if self.rotary { [y + z, y, z] } else { [y + z, 0.0, 0.0] }
    }

    /// The stiffness of a strain: G J, E I_y, E I_z for twist and curvatures (N·m²), E A, k G A, k G A for extension and shears (N).
    pub fn stiffness(&self, strain: Strain) -> f64 {
        let (Material { young, .. }, Section { area, second_moments, torsion, shear_factor }) = (self.material, self.section);
        match strain {
            Strain::Twist => self.material.shear() * torsion,
            Strain::BendY => young * second_moments[0],
            Strain::BendZ => young * second_moments[1],
            Strain::Extension => young * area,
            Strain::ShearY | Strain::ShearZ => shear_factor * self.material.shear() * area,
        }
    }
}

/// A strain of a rod along x, in the order of ξ = [κ; ε]: the angular and linear rate of the section's frame along the rod, in its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Strain {
    /// Twist κ_x, rad/m.
    Twist,
    /// Curvature κ_y, rad/m: bending about y, deflection along −z.
    BendY,
    /// Curvature κ_z, rad/m: bending about z, deflection along y.
    BendZ,
    /// Extension ε_x − 1.
    Extension,
    /// Shear ε_y.
    ShearY,
    /// Shear ε_z.
    ShearZ,
}

impl Strain {
    /// All six, in order.
    pub const ALL: [Self; 6] = [Self::Twist, Self::BendY, Self::BendZ, Self::Extension, Self::ShearY, Self::ShearZ];

    /// Its place in ξ = [κ; ε].
    pub fn index(self) -> usize {
        self as usize
    }

    /// The axis that it turns about or moves along.
    pub(crate) fn axis(self) -> [f64; 3] {
        let mut axis = [0.0; 3];
        axis[self.index() % 3] = 1.0;
        axis
    }

    /// Whether it is a rotation per length.
    pub fn turns(self) -> bool {
        self.index() < 3
    }
}

/// A number, or a place, that is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("field '{field}': {defect}")]
pub struct Refused {
    /// The name of the field, such as `material.young`.
    pub field: String,
    /// What is wrong with it.
    pub defect: Defect,
}

impl Refused {
    pub(crate) fn new(field: &str, defect: Defect) -> Self {
        Self { field: field.into(), defect }
    }
}

/// What is wrong with a field.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Defect {
    /// NaN or infinite.
    #[error("is {value}; give a finite number")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// Zero or less where only more is possible.
    #[error("is {value}; give a number above 0")]
    NotPositive {
        /// The number.
        value: f64,
    },
    /// Less than zero.
    #[error("is {value}; give at least 0")]
    Negative {
        /// The number.
        value: f64,
    },
    /// Poisson's ratio of no stable material.
    #[error("Poisson's ratio is {value}; it is above −1 and at most 0.5, or the material would give work when it is sheared or pressed")]
    Poisson {
        /// The ratio.
        value: f64,
    },
    /// A shear factor above one.
    #[error("the shear factor is {value}; it is at most 1")]
    ShearFactor {
        /// The factor.
        value: f64,
    },
    /// No element, term or point.
    #[error("is 0; give at least 1")]
    None,
    /// A number of quadrature points that does not integrate the masses.
    #[error("is {found}; this basis needs at least {needed} for a mass matrix that is positive definite")]
    Points {
        /// What is there.
        found: usize,
        /// What is needed.
        needed: usize,
    },
    /// A body that does not exist.
    #[error("the rod is clamped to body {body}, but there are {bodies}: it is clamped to nothing; name a body that exists, or the world")]
    ClampedToNothing {
        /// The index of the body.
        body: usize,
        /// How many bodies there are.
        bodies: usize,
    },
    /// A strain twice, or none.
    #[error("names {found} strains, {different} of them different; name at least one, each once")]
    Strains {
        /// How many are named.
        found: usize,
        /// How many are different.
        different: usize,
    },
    /// The tree of bodies is malformed.
    #[error("{reason}")]
    Tree {
        /// What the model says of it.
        reason: String,
    },
}

pub(crate) fn finite(field: &str, value: f64) -> Result<(), Refused> {
    if value.is_finite() { Ok(()) } else { Err(Refused::new(field, Defect::NotFinite { value })) }
}

fn positive(field: &str, value: f64) -> Result<(), Refused> {
    finite(field, value)?;
    if value > 0.0 { Ok(()) } else { Err(Refused::new(field, Defect::NotPositive { value })) }
}
