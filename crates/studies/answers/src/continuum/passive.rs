//! Passivity: M ≻ 0, K ⪰ 0, D ⪰ 0 by the eigenvalues of symmetric parts, and energy that never rises. A collocation basis fails.

use super::{Case, NoAnswer, case, count, element, error, failed, told};
use featherbench_continua::{Basis, Continuum, Material, Motion, Rod, Section, collocation, energies, library, mass_matrix, passivity};
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use nalgebra::DMatrix;
use serde_json::json;

/// The elements and how many of each.
const ELEMENTS: [(&str, usize); 7] = [
    ("links_start", 6),
    ("links_start_stiff_wall", 6),
    ("links_middle", 6),
    ("sections", 4),
    ("monomials", 3),
    ("modes", 3),
    ("hermite", 3),
];
/// The damping time of the rod, s, and how long it swings, s.
const DAMPING: f64 = 0.02;
const TIME: f64 = 0.5;

pub(super) fn cases() -> Vec<Case> {
    let of = |(name, terms): (&'static str, usize)| [judged(name, terms), damped(name, terms)];
    ELEMENTS.into_iter().flat_map(of).chain((2..=5).map(collocated)).collect()
}

/// A soft thick rod, bent.
fn beam(name: &str, terms: usize) -> Result<(Continuum, Vec<f64>), NoAnswer> {
    let material = Material { young: 60.0, poisson: 0.3, density: 1.0, damping: DAMPING };
    let rod = Rod::new(material, Section::rectangle(0.2, 0.3), 2.0).map_err(failed)?;
    let (beam, _) = library::cantilever(&rod, &element(name, terms)?).map_err(failed)?;
    let bent = (0..beam.topology().nq()).map(|k| 0.2 / (1.0 + k as f64)).collect();
    Ok((beam, bent))
}

fn judged(name: &'static str, terms: usize) -> Case {
    let numbers = vec![count("passive", 1.0, "theory"), told("least_of_m", "1"), told("least_of_k", "1"), told("least_of_d", "1")];
    case("damped cantilever", "passivity", name, json!({"elements": terms}), numbers, move || {
        let (beam, s) = beam(name, terms)?;
        let found = passivity(&mass_matrix(&beam, &s).map_err(failed)?, &beam.stiffness_matrix(), &beam.damping_matrix());
        let [m, k, d] = found.smallest;
        Ok(vec![f64::from(u8::from(found.passive())), m, k, d])
    })
}

/// The largest rise of the energy in a step, over the energy at the beginning; and what is left of it.
fn damped(name: &'static str, terms: usize) -> Case {
    let numbers = vec![error("energy_rise", "theory"), told("energy_left", "1")];
    case("damped cantilever", "energy", name, json!({"elements": terms, "time": TIME}), numbers, move || {
        let (beam, mut s) = beam(name, terms)?;
        let mut rate = vec![0.0; beam.topology().nv()];
        let total = |s: &[f64], rate: &[f64]| energies(&beam, s, rate).map_or(f64::NAN, |e| e.kinetic + e.potential);
        let first = total(&s, &rate);
        let (mut last, mut rise) = (first, 0.0);
        let tolerance = Tolerance { absolute: 1e-11, relative: 1e-11, ..Tolerance::default() };
        let mut motion = Motion::new(&beam, |_| Vec::new());
        let seen = |_: f64, s: &[f64], rate: &[f64]| {
            let now = total(s, rate);
            let by = (now - last) / first;
            if by.is_nan() || by > rise {
                rise = by;
            }
            last = now;
        };
        DormandPrince::new(beam.topology()).run(&mut motion, [0.0, TIME], &mut s, &mut rate, &tolerance, seen).map_err(failed)?;
        Ok(vec![rise, last / first])
    })
}

/// Collocation at Gauss points is not passive, and it is said.
fn collocated(terms: usize) -> Case {
    let numbers = vec![count("passive", 0.0, "theory"), told("least_of_m", "1"), told("asymmetry_of_m", "1")];
    case(format!("collocation, {terms} monomials"), "passivity", "collocation", json!({"terms": terms}), numbers, move || {
        let (mass, stiffness) = collocation(&super::rod()?, Basis::Monomials(terms)).map_err(failed)?;
        let found = passivity(&mass, &stiffness, &DMatrix::zeros(terms, terms));
        Ok(vec![f64::from(u8::from(found.passive())), found.smallest[0], found.asymmetry[0]])
    })
}
