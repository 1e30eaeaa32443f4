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
    distribution: Known,
    acts: As,
    on: Vec<Number>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum As {
    Value,
    Factor,
}

/// A distribution whose numbers fit its type.
#[derive(Deserialize)]
#[serde(try_from = "DistributionFields")]
struct Known(Distribution);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DistributionFields {
    #[serde(rename = "type")]
    kind: String,
    low: Option<f64>,
    high: Option<f64>,
    mean: Option<f64>,
    deviation: Option<f64>,
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

impl TryFrom<DistributionFields> for Known {
    type Error = String;
    fn try_from(fields: DistributionFields) -> Result<Self, String> {
        let DistributionFields { kind, low, high, mean, deviation } = fields;
        let own: &[&str] = match kind.as_str() {
            "uniform" => &["low", "high"],
            "lognormal" | "gamma" | "normal" => &["mean", "deviation"],
            "truncated_normal" => &["mean", "deviation", "low", "high"],
            other => {
                let known = "uniform, lognormal, gamma, normal, truncated_normal";
                return Err(format!("the distribution '{other}' is unknown; choose one of {known}"));
            }
        };
        let given = [("low", low), ("high", high), ("mean", mean), ("deviation", deviation)];
        if let Some((field, _)) = given.into_iter().find(|(field, value)| value.is_some() && !own.contains(field)) {
            return Err(format!("the distribution '{kind}' has '{field}', which such a one has not; it has {}", own.join(", ")));
        }
        let number = |name: &str| {
            let found = given.into_iter().find(|(field, _)| *field == name).and_then(|(_, value)| value);
            found.ok_or_else(|| format!("the distribution '{kind}' has no '{name}'; it needs {}", own.join(", ")))
        };
        Ok(Self(match kind.as_str() {
            "uniform" => Distribution::Uniform { low: number("low")?, high: number("high")? },
            "lognormal" => Distribution::Lognormal { mean: number("mean")?, deviation: number("deviation")? },
            "gamma" => Distribution::Gamma { mean: number("mean")?, deviation: number("deviation")? },
            "normal" => Distribution::Normal { mean: number("mean")?, deviation: number("deviation")? },
            _ => Distribution::TruncatedNormal {
                mean: number("mean")?,
                deviation: number("deviation")?,
                low: number("low")?,
                high: number("high")?,
            },
        }))
    }
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
            distribution: distribution.0,
            acts: match acts {
                As::Value => Acts::Value,
                As::Factor => Acts::Factor,
            },
            on: on.into_iter().map(|number| number.0).collect(),
        };
        let pair = |Pair { first, second, value }: Pair| Correlation { first, second, value };
        Self {
            variables: section.variables.into_iter().map(variable).collect(),
            correlations: section.correlations.into_iter().map(pair).collect(),
        }
    }
}
