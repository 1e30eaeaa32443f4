//! Numbers as texts print them, one row each: what we compute must be the printed number to its last digit.
//!
//! Where a law of another file is judged to 3 %, its prefactor is here to the digits that are printed. A number may be rounded or cut at its last
//! digit, so that one unit of it is allowed.

use super::vibrations::{frequencies, mass_condition, string_squares};
use super::{Case, NoAnswer, case, error, failed, statics, told};
use featherbench_continua::known::{bessel_zero, cantilever_root, elastica};
use featherbench_continua::{Masses, fit};
use serde_json::json;

/// The value that is printed: a function of nothing else.
type Value = fn() -> Result<f64, NoAnswer>;

/// Of each: the case, how it is computed, the number as printed, and its value.
const PRINTED: [(&str, &str, &str, Value); 35] = [
    ("β of mode 1", "newton", "1.87510406871196", || Ok(cantilever_root(0))),
    ("β of mode 2", "newton", "4.69409113297417", || Ok(cantilever_root(1))),
    ("β of mode 3", "newton", "7.85475743823761", || Ok(cantilever_root(2))),
    ("β of mode 4", "newton", "10.9955407348755", || Ok(cantilever_root(3))),
    ("ω √(L/g) of a hanging string, mode 1", "newton", "1.20241277885", || Ok(0.5 * bessel_zero(0))),
    ("ω √(L/g) of a hanging string, mode 2", "newton", "2.76003905514", || Ok(0.5 * bessel_zero(1))),
    ("ω √(L/g) of a hanging string, mode 3", "newton", "4.32686395646", || Ok(0.5 * bessel_zero(2))),
    ("elastica's deflection, α = 0.1", "quadrature", "0.033295319268174", || Ok(elastica(0.1).deflection)),
    ("elastica's deflection, α = 1", "quadrature", "0.30172077379981", || Ok(elastica(1.0).deflection)),
    ("elastica's deflection, α = 2", "quadrature", "0.49345748039671", || Ok(elastica(2.0).deflection)),
    ("elastica's deflection, α = 5", "quadrature", "0.71379152361191", || Ok(elastica(5.0).deflection)),
    ("elastica's deflection, α = 10", "quadrature", "0.8106090248803", || Ok(elastica(10.0).deflection)),
    ("elastica's reach, α = 1", "quadrature", "0.94356676371662", || Ok(elastica(1.0).reach)),
    ("elastica's reach, α = 10", "quadrature", "0.44500440224625", || Ok(elastica(10.0).reach)),
    ("frequency error n², mode 1", "links_middle", "0.229", || frequency_prefactor(0)),
    ("frequency error n², mode 2", "links_middle", "0.797", || frequency_prefactor(1)),
    ("frequency error n², mode 3", "links_middle", "1.308", || frequency_prefactor(2)),
    ("ω² error n² of a hanging string, mode 1", "string_links", "0.0613", || string_prefactor(0)),
    ("ω² error n² of a hanging string, mode 2", "string_links", "2.06", || string_prefactor(1)),
    ("tip's error, α = 1, n = 4", "links_middle", "1.7e-2", || tip_error(4)),
    ("tip's error, α = 1, n = 64", "links_middle", "6.7e-5", || tip_error(64)),
    ("ω of mode 1, r = 2", "monomials", "3.53273154", || Ok(frequencies("monomials", 2)?[0])),
    ("ω of mode 2, r = 2", "monomials", "34.80689311", || Ok(frequencies("monomials", 2)?[1])),
    ("error of ω in per cent, r = 1", "monomials", "27.19", || Ok(100.0 * monomials(1)?)),
    ("error of ω in per cent, r = 2", "monomials", "0.4754", || Ok(100.0 * monomials(2)?)),
    ("error of ω, r = 3", "monomials", "3.0e-4", || monomials(3)),
    ("error of ω, r = 4", "monomials", "1.5e-6", || monomials(4)),
    ("error of ω, r = 6", "monomials", "8.1e-11", || monomials(6)),
    ("condition of M, r = 6", "monomials", "1.3e9", || mass_condition(6)),
    ("tip's ratio, r = 1", "monomials", "0.75", || statics::compliance("monomials", 1)),
    ("tip's ratio, r = 1", "modes", "0.970688", || statics::compliance("modes", 1)),
    ("tip's ratio, r = 2", "modes", "0.995404", || statics::compliance("modes", 2)),
    ("tip's ratio, r = 3", "modes", "0.998556", || statics::compliance("modes", 3)),
    ("tip's ratio, r = 4", "modes", "0.999377", || statics::compliance("modes", 4)),
    ("tip's ratio, r = 2", "monomials", "1", || statics::compliance("monomials", 2)),
];

/// The two refinements from which prefactors are extrapolated: the term after it is of order 4 (of strings h⁴ ln h).
const FINE: [usize; 2] = [32, 64];

pub(super) fn cases() -> Vec<Case> {
    let of = |(name, method, text, value): (&str, &str, &'static str, Value)| {
        let numbers = vec![error("digits_error", "printed"), told("value", "1")];
        case(name, "printed", method, json!({"printed": text}), numbers, move || {
            let found = value()?;
            let (due, unit) = read(text).ok_or_else(|| failed(format!("{text} is no number")))?;
            Ok(vec![(found - due).abs() / unit, found])
        })
    };
    PRINTED.into_iter().map(of).collect()
}

/// A printed number, and the unit of its last digit. A number without decimals is exact: its unit is what rounding leaves.
fn read(text: &str) -> Option<(f64, f64)> {
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let decimals = digits.split_once('.').map(|(_, decimals)| decimals.len() as i32);
    let unit = decimals.map_or(Some(1e-12), |decimals| Some(10.0_f64.powi(exponent.parse::<i32>().ok()? - decimals)))?;
    Some((text.parse().ok()?, unit))
}

/// The limit of (ω/ω_exact − 1) n² of links.
fn frequency_prefactor(k: usize) -> Result<f64, NoAnswer> {
    let error = |n: usize| Ok((n as f64, frequencies("links_middle", n)?[k] / cantilever_root(k).powi(2) - 1.0));
    Ok(fit(&FINE.into_iter().map(error).collect::<Result<Vec<_>, NoAnswer>>()?, 2.0, 4.0).prefactor)
}

/// The limit of (ω²/ω²_exact − 1) n² of a hanging chain of uniform rods.
fn string_prefactor(k: usize) -> Result<f64, NoAnswer> {
    let exact = (0.5 * bessel_zero(k)).powi(2);
    let error = |n: usize| Ok((n as f64, string_squares(Masses::Uniform, n)?[k] / exact - 1.0));
    Ok(fit(&FINE.into_iter().map(error).collect::<Result<Vec<_>, NoAnswer>>()?, 2.0, 4.0).prefactor)
}

/// The magnitude of the tip's relative error of so many links under α = 1.
fn tip_error(n: usize) -> Result<f64, NoAnswer> {
    Ok((statics::deflection("links_middle", n, 1.0)? / elastica(1.0).deflection - 1.0).abs())
}

/// ω₁/β₁² − 1 of so many monomials.
fn monomials(terms: usize) -> Result<f64, NoAnswer> {
    Ok(frequencies("monomials", terms)?[0] / cantilever_root(0).powi(2) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn units_are_those_of_the_last_digit() {
        for (text, due) in [("2.06", 0.01), ("0.0613", 1e-4), ("1.3e9", 1e8), ("6.7e-5", 1e-6), ("1", 1e-12)] {
            let (value, unit) = read(text).unwrap();
            assert_eq!(value, text.parse::<f64>().unwrap());
            assert!((unit / due - 1.0).abs() < 1e-12, "{text}: {unit}");
        }
        assert!(read("1.2.3").is_none() && read("1.2ex").is_none());
    }
}
