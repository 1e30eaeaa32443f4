//! From a description file's section `continua` to rods.

use crate::{Assembly, Basis, Element, Hinges, Masses, Material, Refused, Rod, Section, Strain, Tip};
use featherbench_model::{
    BodyDescription, Continuum as Described, ContinuumElement, ContinuumSection, ContinuumStrain, Description, JointDescription,
};
use std::f64::consts::PI;

/// Gauss points of a section of constant strain: with two, the mass of a slightly bent section is exact but for a term beyond its error.
const POINTS: usize = 2;

impl Assembly {
    /// The robot of a description with its continua attached, and the tip of each, in their order. A tip's body is fixed there.
    ///
    /// ```
    /// use featherbench_continua::Assembly;
    /// use featherbench_model::{Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, Description};
    /// let beam = Continuum {
    ///     name: "beam".into(),
    ///     body: None,
    ///     placement: Default::default(),
    ///     length: 1.0,
    ///     material: ContinuumMaterial { young: 2.1e11, poisson: 0.3, density: 7850.0, damping: 0.0 },
    ///     section: ContinuumSection::Rectangle { width: 0.02, height: 0.01 },
    ///     element: ContinuumElement::Sections,
    ///     count: 4,
    ///     strains: vec![ContinuumStrain::BendY],
    ///     tip: None,
    /// };
    /// let (assembly, tips) = Assembly::of(&Description { continua: vec![beam], ..Description::default() })?;
    /// assert_eq!(tips.len(), 1);
    /// assert_eq!(assembly.build()?.topology().nv(), 4);
    /// # Ok::<(), featherbench_continua::Refused>(())
    /// ```
    ///
    /// # Errors
    /// [`Refused`] with the continuum's name and field.
    pub fn of(description: &Description) -> Result<(Self, Vec<Tip>), Refused> {
        let mut assembly = Self::new(Description { continua: Vec::new(), ..description.clone() });
        let mut tips = Vec::with_capacity(description.continua.len());
        for described in &description.continua {
            let named = |refused: Refused| Refused { field: format!("continua '{}': {}", described.name, refused.field), ..refused };
            let tip = attach(&mut assembly, described).map_err(named)?;
            tips.push(tip);
        }
        Ok((assembly, tips))
    }
}

fn attach(assembly: &mut Assembly, described: &Described) -> Result<Tip, Refused> {
    let material = described.material;
    let material = Material { young: material.young, poisson: material.poisson, density: material.density, damping: material.damping };
    let rod = Rod::new(material, section(described.section), described.length)?;
    let tip = assembly.attach(&described.name, &rod, &element(described), described.body, described.placement)?;
    if let Some(carried) = described.tip {
        let joint =
            JointDescription { name: format!("{}.carried.joint", described.name), placement: tip.placement, ..JointDescription::default() };
        let name = format!("{}.carried", described.name);
        assembly.add(BodyDescription {
            name,
            parent: Some(tip.body),
            mass: carried.mass,
            com: carried.com,
            inertia: carried.inertia,
            joint,
        });
    }
    Ok(tip)
}

fn section(described: ContinuumSection) -> Section {
    match described {
        ContinuumSection::Circle { radius } => Section::circle(radius),
        ContinuumSection::Tube { inner, outer } => {
            let (area, second) = (PI * (outer * outer - inner * inner), PI / 4.0 * (outer.powi(4) - inner.powi(4)));
            // Cowper (1966), for ν = 0: 6 (1 + m²)² / (7 (1 + m²)² + 20 m²), m the ratio of the radii.
            let square = (inner / outer).powi(2);
            let sum = (1.0 + square).powi(2);
            Section { area, second_moments: [second; 2], torsion: 2.0 * second, shear_factor: 6.0 * sum / (7.0 * sum + 20.0 * square) }
        }
        ContinuumSection::Rectangle { width, height } => Section::rectangle(width, height),
        ContinuumSection::General { area, second_moments, torsion, shear_factor } => {
            Section { area, second_moments, torsion, shear_factor }
        }
    }
}

fn element(described: &Described) -> Element {
    let count = described.count;
    let strains: Vec<Strain> = described.strains.iter().map(|strain| strain_of(*strain)).collect();
    let planar = !strains.contains(&Strain::BendY);
    let links = |hinges, strains| Element::Links { count, hinges, strains };
    match described.element {
        ContinuumElement::LinksStart => links(Hinges::Start, strains),
        ContinuumElement::LinksStartStiffWall => links(Hinges::StartStiffWall, strains),
        ContinuumElement::LinksMiddle => links(Hinges::Middle, strains),
        ContinuumElement::Monomials => Element::Ritz { basis: Basis::Monomials(count), strains },
        ContinuumElement::Modes => Element::Ritz { basis: Basis::Modes(count), strains },
        ContinuumElement::Hermite => Element::Ritz { basis: Basis::Hermite(count), strains },
        ContinuumElement::Sections => Element::Sections { count, strains, points: POINTS },
        ContinuumElement::StringLinks => Element::String { count, masses: Masses::Uniform, planar },
        ContinuumElement::StringPoints => Element::String { count, masses: Masses::Ends, planar },
    }
}

fn strain_of(described: ContinuumStrain) -> Strain {
    match described {
        ContinuumStrain::Twist => Strain::Twist,
        ContinuumStrain::BendY => Strain::BendY,
        ContinuumStrain::BendZ => Strain::BendZ,
        ContinuumStrain::Extension => Strain::Extension,
        ContinuumStrain::ShearY => Strain::ShearY,
        ContinuumStrain::ShearZ => Strain::ShearZ,
    }
}
