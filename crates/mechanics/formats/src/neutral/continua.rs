//! Reading and writing the section `continua`: slender bodies that deform.

use super::fields::{BodyIndex, PlacementFields};
use super::write::{Writer, index, quoted};
use featherbench_model::{Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumStrain, ContinuumTip};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContinuumFields {
    name: String,
    body: BodyIndex,
    placement: PlacementFields,
    length: f64,
    material: MaterialFields,
    #[serde(with = "Section")]
    section: ContinuumSection,
    element: Element,
    count: usize,
    strains: Vec<Strain>,
    tip: Option<TipFields>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialFields {
    young: f64,
    poisson: f64,
    density: f64,
    damping: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TipFields {
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
}

#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Element(ContinuumElement);

#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Strain(ContinuumStrain);

/// A section with the fields of its type, and no others.
#[derive(Deserialize)]
#[serde(remote = "ContinuumSection", tag = "type", rename_all = "snake_case", deny_unknown_fields)]
enum Section {
    Circle { radius: f64 },
    Tube { inner: f64, outer: f64 },
    Rectangle { width: f64, height: f64 },
    General { area: f64, second_moments: [f64; 2], torsion: f64, shear_factor: f64 },
}

impl TryFrom<String> for Element {
    type Error = String;
    fn try_from(word: String) -> Result<Self, String> {
        let found = ContinuumElement::ALL.into_iter().find(|element| element.name() == word);
        let known = || ContinuumElement::ALL.map(ContinuumElement::name).join(", ");
        found.map(Self).ok_or_else(|| format!("'{word}' is no element; choose one of {}", known()))
    }
}

impl TryFrom<String> for Strain {
    type Error = String;
    fn try_from(word: String) -> Result<Self, String> {
        let found = ContinuumStrain::ALL.into_iter().find(|strain| strain.name() == word);
        let known = || ContinuumStrain::ALL.map(ContinuumStrain::name).join(", ");
        found.map(Self).ok_or_else(|| format!("'{word}' is no strain; choose from {}", known()))
    }
}

impl From<ContinuumFields> for Continuum {
    fn from(fields: ContinuumFields) -> Self {
        let ContinuumFields { name, body, placement, length, material, section, element, count, strains, tip } = fields;
        let MaterialFields { young, poisson, density, damping } = material;
        Self {
            name,
            body: body.0,
            placement: placement.into(),
            length,
            material: ContinuumMaterial { young, poisson, density, damping },
            section,
            element: element.0,
            count,
            strains: strains.into_iter().map(|strain| strain.0).collect(),
            tip: tip.map(|TipFields { mass, com, inertia }| ContinuumTip { mass, com, inertia }),
        }
    }
}

impl Writer<'_> {
    pub(super) fn continuum(&mut self, continuum: &Continuum) {
        let Continuum { name, body, placement, length, material, section, element, count, strains, tip } = continuum;
        self.put(format_args!("{{\"name\":{},\"body\":{},\"placement\":", quoted(name), index(*body)));
        self.placement(placement);
        self.key(2, "length");
        let ContinuumMaterial { young, poisson, density, damping } = material;
        self.put(format_args!("{length:?},\"material\":{{\"young\":{young:?},\"poisson\":{poisson:?},"));
        self.put(format_args!("\"density\":{density:?},\"damping\":{damping:?}}}"));
        self.key(2, "section");
        self.put(format_args!("{{\"type\":\"{}\"", section.name()));
        match section {
            ContinuumSection::Circle { radius } => self.put(format_args!(",\"radius\":{radius:?}}}")),
            ContinuumSection::Tube { inner, outer } => self.put(format_args!(",\"inner\":{inner:?},\"outer\":{outer:?}}}")),
            ContinuumSection::Rectangle { width, height } => self.put(format_args!(",\"width\":{width:?},\"height\":{height:?}}}")),
            ContinuumSection::General { area, second_moments: [y, z], torsion, shear_factor } => {
                self.put(format_args!(",\"area\":{area:?},\"second_moments\":[{y:?},{z:?}],\"torsion\":{torsion:?}"));
                self.put(format_args!(",\"shear_factor\":{shear_factor:?}}}"));
            }
        }
        let strains: Vec<String> = strains.iter().map(|strain| format!("\"{}\"", strain.name())).collect();
        self.key(2, "element");
        self.put(format_args!("\"{}\",\"count\":{count},\"strains\":[{}]", element.name(), strains.join(",")));
        if let Some(ContinuumTip { mass, com, inertia }) = tip {
            self.key(2, "tip");
            self.put(format_args!("{{\"mass\":{mass:?},\"com\":"));
            self.numbers(com);
            self.push(",\"inertia\":");
            self.numbers(inertia);
            self.push("}");
        }
        self.push("}");
    }
}
