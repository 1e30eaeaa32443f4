//! The data dictionary of a run: what the names mean that occur in its rows.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::Row;

/// A name in the rows of a study, with its meaning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Term {
    /// The study.
    pub study: String,
    /// The name.
    pub name: String,
    /// The units of its values, sorted; [`RATIO`](crate::RATIO) for a pure ratio. Empty for a parameter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub units: Vec<String>,
    /// What it means; empty if no study says so.
    pub meaning: String,
}

/// The names in three columns of a run: what was asked, what was measured, and the keys of `params`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Dictionary {
    /// Names in the column `quantity`.
    pub quantities: Vec<Term>,
    /// Names in the column `metric`.
    pub metrics: Vec<Term>,
    /// Keys of the column `params`.
    pub parameters: Vec<Term>,
}

/// The column of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// `quantity`.
    Quantity,
    /// `metric`.
    Metric,
    /// A key of `params`.
    Parameter,
}

/// Names of a column by study, with the units of their values.
type Names<'a> = BTreeMap<(&'a str, String), BTreeSet<&'a str>>;

impl Dictionary {
    /// Every name that occurs in rows, with the meaning that `meaning` knows for study, column and name.
    pub fn of(rows: &[Row], meaning: impl Fn(&str, Named, &str) -> Option<String>) -> Self {
        let (mut quantities, mut metrics, mut parameters) = (Names::new(), Names::new(), Names::new());
        // Thousands of rows share few texts of parameters.
        let mut read = BTreeSet::new();
        for row in rows {
            let study = row.study.as_str();
            let unit = if row.unit == "1" { crate::RATIO } else { row.unit.as_str() };
            for (names, name) in [(&mut quantities, &row.quantity), (&mut metrics, &row.metric)] {
                if !name.is_empty() {
                    let units = names.entry((study, name.clone())).or_default();
                    units.extend((!unit.is_empty()).then_some(unit));
                }
            }
            if read.insert((study, row.params.as_str())) {
                let params: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&row.params).unwrap_or_default();
                parameters.extend(params.into_iter().map(|(key, _)| ((study, key), BTreeSet::new())));
            }
        }
        let terms = |names: Names, column: Named| -> Vec<Term> {
            let term = |((study, name), units): ((&str, String), BTreeSet<&str>)| {
                let meaning = meaning(study, column, &name).unwrap_or_default();
                Term { study: study.to_owned(), name, units: units.into_iter().map(str::to_owned).collect(), meaning }
            };
            names.into_iter().map(term).collect()
        };
        Self {
            quantities: terms(quantities, Named::Quantity),
            metrics: terms(metrics, Named::Metric),
            parameters: terms(parameters, Named::Parameter),
        }
    }

    /// The names without a meaning: `study: name`.
    pub fn unexplained(&self) -> Vec<String> {
        let all = self.quantities.iter().chain(&self.metrics).chain(&self.parameters);
        all.filter(|term| term.meaning.is_empty()).map(|term| format!("{}: {}", term.study, term.name)).collect()
    }
}
