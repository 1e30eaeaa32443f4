//! Frequencies: roots, shape functions, strings.

use super::{Case, Law, NoAnswer, case, element, error, failed, largest, rod, told};
use featherbench_continua::known::{bessel_zero, cantilever_root, laguerre_zeros, string_frequency_prefactor};
use featherbench_continua::{Masses, mass_matrix, modes, systems};
use nalgebra::SymmetricEigen;
use serde_json::json;
use std::f64::consts::PI;

/// Numbers of masses of the strings whose every frequency is known.
const MASSES: [usize; 7] = [1, 2, 3, 5, 8, 13, 20];

/// ω₁/β₁² − 1 of r monomials, to its printed digits. In double-double arithmetic by inverse iteration in `crates/mechanics/continua/tests/laws.rs`.
const MONOMIALS: [(usize, f64, f64); 6] = [
    (1, 0.271_933_0, 1e-6),
    (2, 4.754_323e-3, 1e-6),
    (3, 3.017_038_4e-4, 1e-7),
    (4, 1.539_223_6e-6, 1e-6),
    (5, 3.847_685_4e-8, 1e-6),
    (6, 8.133_3e-11, 1e-3),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = vec![roots(), bessel(), laguerre(), first_monomial()];
    cases.extend(MONOMIALS.iter().map(|&(terms, due, digits)| monomials(terms, due, digits)));
    cases.push(exact_modes());
    let string = |masses, name, mode, law, counts| string_law(masses, name, mode, law, counts);
    // The next term is h⁴ ln h.
    let second = |prefactor| Law { order: 2.0, next: 4.0, prefactor };
    cases.push(string(Masses::Ends, "string_points", 0, Law { order: 1.0, next: 2.0, prefactor: -0.5 }, [16, 24, 32, 48, 64]));
    cases.push(string(Masses::Uniform, "string_links", 0, second(string_frequency_prefactor(0)), [8, 16, 24, 32, 64]));
    cases.push(string(Masses::Uniform, "string_links", 1, second(string_frequency_prefactor(1)), [16, 24, 32, 48, 64]));
    cases
}

/// ω of a cantilever with this element.
pub(super) fn frequencies(name: &str, n: usize) -> Result<Vec<f64>, NoAnswer> {
    let (beam, _) = systems::cantilever(&rod()?, &element(name, n)?).map_err(failed)?;
    Ok(modes(&beam, &beam.rest(), &[]).map_err(failed)?.frequencies())
}

/// β by Newton's method against bisection of another form of the equation, cos β cosh β + 1 over cosh β, between the extrema.
fn roots() -> Case {
    case("cantilever", "roots", "newton", json!({"roots": 8}), vec![error("error", "bisection")], || {
        let value = |beta: f64| beta.cos() + 1.0 / beta.cosh();
        let misses = (0..8).map(|k| {
            let (mut low, mut high) = (f64::from(k) * PI + if k == 0 { 0.1 } else { 0.0 }, f64::from(k + 1) * PI);
            let rising = value(high) > value(low);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if (value(middle) < 0.0) == rising { low = middle } else { high = middle }
            }
            cantilever_root(k as usize) / low - 1.0
        });
        Ok(vec![largest(misses)])
    })
}

/// Zeros of J₀ against the sign of its integral, 1/π ∫ cos(x sin t) dt, by bisection.
fn bessel() -> Case {
    case("string", "roots", "bessel", json!({"roots": 8}), vec![error("error", "bisection")], || {
        // The trapezoidal rule of a periodic function: 200 points leave rounding alone for x up to 30.
        let value = |x: f64| (0..200).map(|i| (x * (PI * f64::from(i) / 200.0).sin()).cos()).sum::<f64>() / 200.0;
        let misses = (0..8).map(|k| {
            let middle = (f64::from(k) + 0.75) * PI;
            let (mut low, mut high) = (middle - 0.8, middle + 0.8);
            let rising = value(high) > value(low);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (value(middle) < 0.0) == rising { low = middle } else { high = middle }
            }
            bessel_zero(k as usize) / low - 1.0
        });
        Ok(vec![largest(misses)])
    })
}

/// n end masses on a string: ω² = (g/ℓ) times the zeros of the Laguerre polynomial.
fn laguerre() -> Case {
    case("string", "string_frequencies", "string_points", json!({"masses": MASSES}), vec![error("error", "Laguerre zeros")], || {
        let (gravity, link) = (9.81, 0.3);
        let mut missed = Vec::new();
        for n in MASSES {
            let (string, _) = systems::hanging_string(n, Masses::Ends, n as f64 * link, 2.0, gravity).map_err(failed)?;
            let squares = modes(&string, &string.rest(), &[]).map_err(failed)?.squares;
            missed.extend(squares.iter().zip(laguerre_zeros(n)).map(|(square, zero)| square / (gravity / link * zero) - 1.0));
        }
        Ok(vec![largest(missed)])
    })
}

/// ω₁ = √20 with s² alone, and with s³ both roots of a quadratic equation.
fn first_monomial() -> Case {
    case("cantilever", "ritz_frequencies", "monomials", json!({"terms": [1, 2]}), vec![error("error", "closed form")], || {
        let one = frequencies("monomials", 1)?;
        // det(K − λM) with K = [[4, 6], [6, 12]], M = [[1/5, 1/6], [1/6, 1/7]].
        let (a, b, c) = (1.0_f64 / 35.0 - 1.0 / 36.0, -(4.0 / 7.0 + 12.0 / 5.0 - 2.0), 12.0);
        let root = (b * b - 4.0 * a * c).sqrt();
        // 2c/(−b ± √…) has no cancellation.
        let due = [2.0 * c / (-b + root), (-b + root) / (2.0 * a)];
        let two = frequencies("monomials", 2)?;
        let misses = two.iter().zip(due).map(|(w, square)| w / square.sqrt() - 1.0);
        Ok(vec![largest(misses.chain([one[0] / 20.0_f64.sqrt() - 1.0]))])
    })
}

/// The error of ω₁ with more monomials, and what it costs: the condition of M.
fn monomials(terms: usize, due: f64, digits: f64) -> Case {
    let numbers = vec![error("digits_error", "double-double"), told("frequency_error", "1"), told("condition", "1")];
    case(format!("cantilever, {terms} monomials"), "ritz_error", "monomials", json!({"terms": terms}), numbers, move || {
        let found = frequencies("monomials", terms)?[0] / cantilever_root(0).powi(2) - 1.0;
        // In units of the printed digits.
        Ok(vec![(found / due - 1.0).abs() / digits, found, mass_condition(terms)?])
    })
}

/// The condition of M of so many monomials.
pub(super) fn mass_condition(terms: usize) -> Result<f64, NoAnswer> {
    let (beam, _) = systems::cantilever(&rod()?, &element("monomials", terms)?).map_err(failed)?;
    let mass = SymmetricEigen::new(mass_matrix(&beam, &beam.rest()).map_err(failed)?).eigenvalues;
    Ok(mass.max() / mass.min())
}

/// ω² of a hanging string of this many links, increasing, with g = L = 1.
pub(super) fn string_squares(masses: Masses, n: usize) -> Result<Vec<f64>, NoAnswer> {
    let (string, _) = systems::hanging_string(n, masses, 1.0, 1.0, 1.0).map_err(failed)?;
    Ok(modes(&string, &string.rest(), &[]).map_err(failed)?.squares)
}

/// Exact modes have exact frequencies, each of them.
fn exact_modes() -> Case {
    case("cantilever", "ritz_frequencies", "modes", json!({"terms": 4}), vec![error("error", "roots")], || {
        let found = frequencies("modes", 4)?;
        Ok(vec![largest(found.iter().enumerate().map(|(k, w)| w / cantilever_root(k).powi(2) - 1.0))])
    })
}

/// A hanging string comes to the zeros of J₀: ω² over (j/2)² g/L.
fn string_law(masses: Masses, name: &'static str, mode: usize, law: Law, counts: [usize; 5]) -> Case {
    let title = format!("string, mode {}", mode + 1);
    case(title, "string_law", name, json!({"counts": counts, "mode": mode}), Law::numbers(), move || {
        let errors = counts.iter().map(|&n| Ok((n as f64, string_squares(masses, n)?[mode] / (0.5 * bessel_zero(mode)).powi(2) - 1.0)));
        Ok(law.fitted(&errors.collect::<Result<Vec<_>, NoAnswer>>()?))
    })
}
