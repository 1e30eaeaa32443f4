//! The simplest uncertainty of a robot: each mass within a part of its value.

use crate::Error;
use featherbench_model::{Acts, Description, Distribution, Target, TargetField, Uncertain, UncertainVariable};

/// A factor uniform in (1 − relative, 1 + relative) on the mass of each moving body that has one, independent of the others.
///
/// # Errors
/// [`Error`] when the description is none, no body has a mass, or the spread is not between 0 and 1.
pub fn spread(description: &Description, relative: f64) -> Result<Uncertain, Error> {
    let moving = description.bodies.iter().enumerate().filter(|(_, body)| body.mass > 0.0 && body.joint.kind.nv() > 0);
    let distribution = Distribution::Uniform { low: 1.0 - relative, high: 1.0 + relative };
    let variable = |(body, described): (usize, &featherbench_model::BodyDescription)| UncertainVariable {
        name: format!("mass of {}", described.name),
        distribution,
        acts: Acts::Factor,
        on: vec![Target { body, field: TargetField::Mass }],
    };
    let uncertain = Uncertain { variables: moving.map(variable).collect(), correlations: Vec::new() };
    if uncertain.variables.is_empty() {
        return Err(Error::NoVariables);
    }
    Description { uncertain: uncertain.clone(), ..description.clone() }.validate()?;
    Ok(uncertain)
}
