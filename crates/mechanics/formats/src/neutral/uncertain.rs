//! Reading the section `uncertain`: each distribution has its own numbers, and no others.

use featherbench_model::{Acts, Correlation, Distribution, Target, TargetField, Uncertain, UncertainVariable};
use serde::Deserialize;

/// The section, with names in the place of indices.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Section {
    variables: Vec<Variable>,
    #[serde(default)]
    correlations: Vec<Pair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Variable {
    name: String,
    #[serde(with = "Known")]
    distribution: Distribution,
    #[serde(with = "As")]
    acts: Acts,
    on: Vec<Number>,
}

#[derive(Deserialize)]
#[serde(remote = "Acts", rename_all = "snake_case")]
enum As {
    Value,
    Factor,
}

/// A distribution with the numbers of its type, and no others.
#[derive(Deserialize)]
#[serde(remote = "Distribution", tag = "type", rename_all = "snake_case", deny_unknown_fields)]
enum Known {
    Uniform { low: f64, high: f64 },
    Lognormal { mean: f64, deviation: f64 },
    Gamma { mean: f64, deviation: f64 },
    Normal { mean: f64, deviation: f64 },
    TruncatedNormal { mean: f64, deviation: f64, low: f64, high: f64 },
}

/// A number of the robot whose index fits its field.
#[derive(Deserialize)]
#[serde(try_from = "NumberFields")]
struct Number(Target);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NumberFields {
    body: usize,
    field: String,
    index: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Pair {
    first: usize,
    second: usize,
    value: f64,
}

impl TryFrom<NumberFields> for Number {
    type Error = String;
    fn try_from(NumberFields { body, field, index }: NumberFields) -> Result<Self, String> {
        let place = || index.ok_or_else(|| format!("'{field}' needs an 'index', counted from 0"));
        let field = match field.as_str() {
            "mass" => TargetField::Mass,
            "density" => TargetField::Density,
            "com" => TargetField::Com(place()?),
            "inertia" => TargetField::Inertia(place()?),
            "armature" => TargetField::Armature(place()?),
            "damping" => TargetField::Damping(place()?),
            "friction" => TargetField::Friction(place()?),
            other => {
                let known = "mass, density, com, inertia, armature, damping, friction";
                return Err(format!("'{other}' is no number of a body or its joint; choose one of {known}"));
            }
        };
        match (field.name(), index) {
            ((name, None), Some(_)) => Err(format!("'{name}' has an 'index', and there is but one; remove it")),
            _ => Ok(Self(Target { body, field })),
        }
    }
}

impl From<Section> for Uncertain {
    fn from(section: Section) -> Self {
        let variable = |Variable { name, distribution, acts, on }: Variable| UncertainVariable {
            name,
            distribution,
            acts,
            on: on.into_iter().map(|number| number.0).collect(),
        };
        let pair = |Pair { first, second, value }: Pair| Correlation { first, second, value };
        Self {
            variables: section.variables.into_iter().map(variable).collect(),
            correlations: section.correlations.into_iter().map(pair).collect(),
        }
    }
}
