//! Continuum: what do discretised rods and strings answer where the answer is known?
//!
//! - `beams.rs`: one cantilever by every element of ours and of engines: the error over refinements, its order and prefactor, and the cost;
//! - `statics.rs`: small and large deflections, and equilibria that are none of the branch from rest;
//! - `vibrations.rs`: frequencies of shape functions and of strings;
//! - `motions.rs`: momentum, energy, and the limits of a heavy hub and of a stiff rod;
//! - `passive.rs`: eigenvalues of M, K and D;
//! - `printed.rs`: numbers of texts, to their last digit;
//! - `shapes.rs`: a gripper finger and an arm with a cable, read from their description files.
//!
//! The rod has EI = ρA = L = 1 where nothing else is said, so forces are α = F L²/EI, and frequencies are β².

mod beams;
mod motions;
mod passive;
mod printed;
pub(crate) mod section;
mod shapes;
mod statics;
#[cfg(test)]
mod tests;
mod vibrations;
pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, Outcome, Study};
use featherbench_continua::{Basis, Element, Fit, Hinges, Rod, Strain};
use featherbench_results::Row;
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, Number, count, error, failed, largest, told};
use serde::Deserialize;
use serde_json::Value;

/// The study's name in rows.
const STUDY: &str = "continuum";

/// The table `[continuum]` of a suite.
#[derive(Clone, Debug, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// The engines whose rods are compared if they are installed.
    #[serde(default)]
    engines: Vec<String>,
}

/// The study: cases of our own, and one beam by every engine.
struct Continuum {
    known: KnownAnswers,
    settings: Settings,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "continuum",
    make: |setup| setup.made(STUDY, |settings| Continuum { known: KnownAnswers::new(STUDY, cases()), settings }),
    sections: section::sections,
    words: words::WORDS,
};

/// Every case of ours.
fn cases() -> Vec<Case> {
    [statics::cases(), vibrations::cases(), passive::cases(), motions::cases(), printed::cases(), shapes::cases()]
        .into_iter()
        .flatten()
        .collect()
}

impl Study for Continuum {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = self.known.plan(context);
        cells.extend(beams::plan(context, &self.settings.engines));
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        if asked.cell.quantity == beams::QUANTITY { beams::evaluate(asked).into() } else { self.known.evaluate(asked) }
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let mut rows = self.known.compare_all(context, finished);
        rows.extend(beams::rows(context, finished));
        rows
    }
}

/// A case of ours.
fn case(
    name: impl Into<String>,
    quantity: &'static str,
    method: impl Into<String>,
    params: Value,
    numbers: Vec<Number>,
    evaluate: impl Fn() -> Result<Vec<f64>, NoAnswer> + Send + Sync + 'static,
) -> Case {
    Case { name: name.into(), quantity, method: method.into(), params, numbers, evaluate: Box::new(move |_| evaluate()) }
}

/// The rod of EI = ρA = L = 1, without rotary inertia.
fn rod() -> Result<Rod, NoAnswer> {
    Rod::textbook(1.0, 1.0, 1.0).map_err(failed)
}

/// The elements that are compared, by name: with so many elements, terms or parts, bending about z.
fn element(name: &str, count: usize) -> Result<Element, NoAnswer> {
    let strains = vec![Strain::BendZ];
    let links = |hinges| Element::Links { count, hinges, strains: strains.clone() };
    let ritz = |basis| Element::Ritz { basis, strains: strains.clone() };
    Ok(match name {
        "links_start" => links(Hinges::Start),
        "links_start_stiff_wall" => links(Hinges::StartStiffWall),
        "links_middle" => links(Hinges::Middle),
        "sections" => Element::Sections { count, strains: strains.clone(), points: POINTS },
        "monomials" => ritz(Basis::Monomials(count)),
        "modes" => ritz(Basis::Modes(count)),
        "hermite" => ritz(Basis::Hermite(count)),
        other => return Err(NoAnswer::NotOffered(format!("we have no element {other}"))),
    })
}

/// Gauss points of a section of constant strain. A small deflection is a polynomial of degree 2 in it: two points integrate its square exactly but
/// for a term of order h⁴ of the energy, below the error of the element.
const POINTS: usize = 2;

/// A law |error| → prefactor / n^order, with the order of the term after it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Law {
    order: f64,
    next: f64,
    prefactor: f64,
}

impl Law {
    /// By how much a fit misses the order, and the prefactor relative to it.
    fn missed(&self, fit: &Fit) -> [f64; 2] {
        [fit.order - self.order, fit.prefactor / self.prefactor - 1.0]
    }

    /// The numbers of a case that fits it.
    fn numbers() -> Vec<Number> {
        vec![error("order_error", "theory"), error("prefactor_error", "theory"), told("order", "1"), told("prefactor", "1")]
    }

    /// The values of these numbers.
    fn fitted(&self, errors: &[(f64, f64)]) -> Vec<f64> {
        let fit = featherbench_continua::fit(errors, self.order, self.next);
        let [order, prefactor] = self.missed(&fit).map(f64::abs);
        vec![order, prefactor, fit.order, fit.prefactor]
    }
}
