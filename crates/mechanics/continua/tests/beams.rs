//! Beams that several tests use.

use featherbench_continua::{Basis, Element, Hinges, Load, Rod, Settings, Status, Strain, equilibrium, systems};

/// Bending about z alone.
pub const BEND: [Strain; 1] = [Strain::BendZ];

/// EI = ρA = L = 1, without rotary inertia.
pub fn rod() -> Rod {
    Rod::textbook(1.0, 1.0, 1.0).unwrap()
}

pub fn links(count: usize, hinges: Hinges) -> Element {
    Element::Links { count, hinges, strains: BEND.to_vec() }
}

pub fn sections(count: usize) -> Element {
    Element::Sections { count, strains: BEND.to_vec(), points: 2 }
}

pub fn ritz(basis: Basis) -> Element {
    Element::Ritz { basis, strains: BEND.to_vec() }
}

/// The place of the tip under a dead force α across the rod.
pub fn tip_under(element: &Element, alpha: f64) -> [f64; 3] {
    let (beam, tip) = systems::cantilever(&rod(), element).unwrap();
    let load = Load::force(tip.body, tip.placement.translation, [0.0, alpha, 0.0]);
    let found = equilibrium(&beam, &[load], &Settings::default()).unwrap();
    assert_eq!(found.status, Status::Converged, "{element:?}");
    beam.place(&found.s, &tip).unwrap().translation.to_array()
}
