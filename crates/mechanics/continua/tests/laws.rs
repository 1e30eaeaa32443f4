//! Orders and prefactors of the discretisations. Small deflections and strings are cases of the study `continuum`.

use crate::beams::{links, ritz, rod, sections, tip_under};
use crate::wide::{smallest_eigenvalue, wide};
use featherbench_continua::known::{
    cantilever_root, elastica, hermite_frequency_prefactor, links_frequency_prefactor, links_tip_prefactor, lumped_axial,
    sections_frequency_prefactor, sections_tip_prefactor, tip_ratio,
};
use featherbench_continua::{
    Basis, Element, Hinges, Load, Material, Rod, Section, Settings, Status, Strain, equilibrium, fit, generalized, modes, systems,
};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::collections::BTreeMap;

fn frequencies(element: &Element) -> Vec<f64> {
    let (beam, _) = systems::cantilever(&rod(), element).unwrap();
    modes(&beam, &beam.rest(), &[]).unwrap().frequencies()
}

/// Slope within 0.05 of theory over these refinements, prefactor within 3 %.
fn assert_law(name: &str, refinements: &[usize], error: impl Fn(usize) -> f64, order: f64, next: f64, prefactor: f64) {
    let errors: Vec<_> = refinements.iter().map(|n| (*n as f64, error(*n))).collect();
    let law = fit(&errors, order, next);
    println!("{name}: {law:?} for {order} and {prefactor}");
    assert!(errors.len() >= 4 && (law.order - order).abs() < 0.05, "{name}: {law:?}");
    assert!((law.prefactor / prefactor - 1.0).abs() < 0.03, "{name}: {law:?} for {prefactor}");
}

/// The matrices of a chain of rigid links in absolute angles, written down from kinematics: the second route of the frequencies. Heights of
/// link ends are Σ l θ; link i of length l has the mass l, ∫ (w + x θ)² dx = l (w² + w l θ + l² θ²/3).
fn chain(lengths: &[f64], springs: &[f64]) -> Vec<f64> {
    let n = lengths.len();
    let mass = DMatrix::from_fn(n, n, |a, b| {
        (a.max(b)..n)
            .map(|i| {
                let l = lengths[i];
                // w = Σ_{k<i} l_k θ_k: the coefficient of θ_a is l_a if a < i
                let (wa, wb) = (if a < i { lengths[a] } else { 0.0 }, if b < i { lengths[b] } else { 0.0 });
                let (own_a, own_b) = (f64::from(a == i), f64::from(b == i));
                l * (wa * wb + 0.5 * l * (wa * own_b + wb * own_a) + l * l / 3.0 * own_a * own_b)
            })
            .sum::<f64>()
    });
    let stiffness = DMatrix::from_fn(n, n, |a, b| match a.abs_diff(b) {
        0 => springs[a] + springs.get(a + 1).unwrap_or(&0.0),
        1 => -springs[a.max(b)],
        _ => 0.0,
    });
    generalized(&stiffness, &mass).unwrap().0.into_iter().map(f64::sqrt).collect()
}

#[test]
fn frequencies_of_links_are_those_of_a_chain_in_absolute_angles() {
    for n in [1, 2, 5, 12] {
        let h = 1.0 / n as f64;
        for hinges in [Hinges::Start, Hinges::StartStiffWall, Hinges::Middle] {
            let (mut lengths, mut springs) = (vec![h; n], vec![1.0 / h; n]);
            match hinges {
                Hinges::Middle => lengths[n - 1] = 0.5 * h,
                Hinges::StartStiffWall => springs[0] = 2.0 / h,
                Hinges::Start => {}
            }
            for (ours, second) in frequencies(&links(n, hinges)).iter().zip(chain(&lengths, &springs)) {
                // The condition of M is some n⁴, and of the second route's eigenvalues so much is lost.
                assert!((ours / second - 1.0).abs() < 1e-11, "{hinges:?} {n}: {ours} {second}");
            }
        }
    }
}

#[test]
fn frequency_errors_have_order_and_prefactor() {
    let found = RefCell::new(BTreeMap::new());
    let error = |name: &'static str, n: usize, k: usize| {
        let element = || match name {
            "middle" => links(n, Hinges::Middle),
            "sections" => sections(n),
            "Hermite" => ritz(Basis::Hermite(n)),
            _ => links(n, Hinges::Start),
        };
        found.borrow_mut().entry((name, n)).or_insert_with(|| frequencies(&element()))[k] / cantilever_root(k).powi(2) - 1.0
    };
    for k in 0..3 {
        let theory = links_frequency_prefactor(Hinges::Middle, k);
        assert_law("middle", &[8, 16, 32, 64], |n| error("middle", n, k), 2.0, 4.0, theory);
        let theory = sections_frequency_prefactor(k);
        assert_law("sections", &[8, 16, 32, 64], |n| error("sections", n, k), 2.0, 4.0, theory);
        let theory = hermite_frequency_prefactor(k);
        // The law holds where an element is short beside a half wave.
        assert_law("Hermite", &[4, 6, 8, 12].map(|n| n * (2 * k + 1)), |n| error("Hermite", n, k), 4.0, 6.0, theory);
        // The wall's spring is h/2 too soft: the rod is as if longer by h/2, and ω ∝ 1/L².
        assert_law("start", &[24, 48, 96, 144], |n| error("start", n, k), 1.0, 2.0, -1.0);
    }
}

#[test]
fn monomials_have_the_errors_of_ritz() {
    // M_ij = 1/(i + j + 5), K_ij = (i+2)(i+1)(j+2)(j+1)/(i + j + 1), by inverse iteration in double-double.
    for (r, printed) in [(3, 3.0170384e-4), (4, 1.5392236e-6), (5, 3.8476854e-8), (6, 8.1333e-11)] {
        let entry = |f: &dyn Fn(f64, f64) -> [f64; 2]| {
            let row = |i: usize| (0..r).map(|j| f(i as f64, j as f64)).map(|[a, b]| wide(a) / wide(b)).collect::<Vec<_>>();
            (0..r).map(row).collect::<Vec<_>>()
        };
        let mass = entry(&|i, j| [1.0, i + j + 5.0]);
        let stiffness = entry(&|i, j| [(i + 2.0) * (i + 1.0) * (j + 2.0) * (j + 1.0), i + j + 1.0]);
        let second = smallest_eigenvalue(&stiffness, &mass).sqrt();
        let ours = frequencies(&ritz(Basis::Monomials(r)))[0];
        // The Gauss sums are in doubles; Rayleigh's quotient in double-double adds no more.
        assert!((ours / second - 1.0).abs() < 1e-14, "{r}: {ours} {second}");
        let error = ours / cantilever_root(0).powi(2) - 1.0;
        assert!((error / printed - 1.0).abs() < 1e-4, "{r}: {error:e} {printed:e}");
    }
}

#[test]
fn the_elastica_is_met_with_the_order_of_each_element() {
    let error = |element: Element| tip_under(&element, 1.0)[1] / elastica(1.0).deflection - 1.0;
    let theory = |hinges| links_tip_prefactor(hinges, 1.0);
    assert_law("middle", &[4, 8, 16, 32], |n| error(links(n, Hinges::Middle)), 2.0, 4.0, theory(Hinges::Middle));
    assert_law("sections", &[4, 8, 16, 32], |n| error(sections(n)), 2.0, 4.0, sections_tip_prefactor(1.0));
    assert_law("start", &[8, 16, 32, 64], |n| error(links(n, Hinges::Start)), 1.0, 2.0, theory(Hinges::Start));
    assert!((error(links(4, Hinges::Middle)) + 1.71e-2).abs() < 1e-4);
}

#[test]
fn axial_links_are_masses_and_springs() {
    for n in [1, 2, 6, 15] {
        let element = Element::Links { count: n, hinges: Hinges::Middle, strains: vec![Strain::Extension] };
        for (k, w) in frequencies(&element).iter().enumerate() {
            // EA = ρA = L = 1
            assert!((w / lumped_axial(n, k, 1.0, 1.0) - 1.0).abs() < 1e-12, "{n} {k}");
        }
    }
    // Exact modes are exact, of a bar and of a shaft; linear splines are above by (2k + 1)² π²/96n².
    for strain in [Strain::Extension, Strain::Twist] {
        let bar = |basis: Basis| frequencies(&Element::Ritz { basis, strains: vec![strain] });
        // GJ/ρ(I_y + I_z) = ½ · 2/2
        let speed = if strain == Strain::Twist { 0.5_f64.sqrt() } else { 1.0 };
        for (k, w) in bar(Basis::Modes(4)).iter().enumerate() {
            let exact = speed * (2 * k + 1) as f64 * std::f64::consts::FRAC_PI_2;
            assert!((w / exact - 1.0).abs() < 1e-13, "{strain:?} {k}: {w} {exact}");
        }
        let prefactor = std::f64::consts::PI.powi(2) / 96.0;
        assert_law(
            "hat",
            &[4, 8, 16, 32],
            |n| bar(Basis::Hermite(n))[0] / (speed * std::f64::consts::FRAC_PI_2) - 1.0,
            2.0,
            4.0,
            prefactor,
        );
    }
}

#[test]
fn shear_extension_and_twist_are_those_of_timoshenko() {
    let material = Material { young: 5.0, poisson: 0.25, density: 1.0, damping: 0.0 };
    let rod = Rod::new(material, Section::rectangle(0.2, 0.3), 1.5).unwrap();
    let strains = vec![Strain::Twist, Strain::BendZ, Strain::Extension, Strain::ShearY];
    let length = rod.length();
    for (n, element) in [1, 4].into_iter().flat_map(|n| {
        let sections = Element::Sections { count: n, strains: strains.clone(), points: 2 };
        [(n, sections), (n, Element::Links { count: n, hinges: Hinges::Middle, strains: strains.clone() })]
    }) {
        let (beam, tip) = systems::cantilever(&rod, &element).unwrap();
        // Small: terms of the second order are below the tolerance.
        let (force, moment) = (1e-9, 1e-9);
        let under = |load: Load| {
            let found = equilibrium(&beam, &[load], &Settings::default()).unwrap();
            assert_eq!(found.status, Status::Converged);
            beam.place(&found.s, &tip).unwrap()
        };
        let across = under(Load::force(tip.body, tip.placement.translation, [0.0, force, 0.0])).translation.y / force;
        let bending = length.powi(3) / (3.0 * rod.stiffness(Strain::BendZ)) * tip_ratio(Hinges::Middle, n);
        let known = bending + length / rod.stiffness(Strain::ShearY);
        assert!((across / known - 1.0).abs() < 1e-7, "{element:?}: {across} {known}");
        let along = under(Load::force(tip.body, tip.placement.translation, [force, 0.0, 0.0])).translation.x - length;
        // A difference of 1e-9 beside 1.5: the rounding is 1e-7 of it.
        assert!((along / force / (length / rod.stiffness(Strain::Extension)) - 1.0).abs() < 1e-6, "{element:?}: {along}");
        let turned = under(Load::moment(tip.body, [moment, 0.0, 0.0])).rotation.to_array()[7] / moment;
        assert!((turned / (length / rod.stiffness(Strain::Twist)) - 1.0).abs() < 1e-9, "{element:?}: {turned}");
    }
}
