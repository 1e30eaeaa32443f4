//! What to do about the differences of an engine, tried before it is told.
//!
//! The advice is to set fields by the engine's interface after loading. It is applied to what the engine holds, and the result is compared
//! again. If M and inverse dynamics are then still others, the advice would not help and is not given.

use super::comparison::Alone;
use super::replay::{Reference, carried};
use super::{Class, Comparison, Field, LARGEST, bound, fields};
use featherbench_bench::Robot;
use featherbench_bench::measure::worst;
use featherbench_model::{Description, Model};

/// Fields that are named; the report lists all.
const NAMED: usize = 3;

/// The advice that helps, if one does.
pub(super) fn tried(ours: &Description, theirs: &Description, found: &Comparison, classes: &[Class], robot: &Robot) -> Option<String> {
    let felt: Vec<usize> = (0..classes.len()).filter(|&k| matches!(classes[k], Class::Physics | Class::Pose)).collect();
    let settable = |&k: &usize| found.findings[k].alone.is_some() && found.findings[k].difference.field != Field::JointType;
    if felt.is_empty() || !felt.iter().all(settable) || robot.states.nv > LARGEST {
        return None;
    }
    // Our robot without what is set would be theirs. So theirs with what is set is ours with all that is not.
    let mut set = ours.clone();
    for (_, finding) in found.findings.iter().enumerate().filter(|(k, _)| !felt.contains(k)) {
        let Some(Alone::Body(_, alone)) = &finding.alone else { continue };
        if let Some(body) = set.bodies.iter_mut().find(|body| body.name == alone.name) {
            fields::copy(finding.difference.field, alone, body);
        }
    }
    let model = Model::build(&set).ok()?;
    let states = carried(ours, &robot.states, ours, &model);
    let effect = Reference::new(ours, states)?.effect_of(&set)?;
    if worst(effect.id, effect.mass_matrix) > bound(robot.depth, found.precision) || theirs.bodies.is_empty() {
        return None;
    }
    let place = |&k: &usize| {
        let difference = &found.findings[k].difference;
        let body = if difference.body.is_empty() { "the robot".to_owned() } else { format!("'{}'", difference.body) };
        format!("the {} of {body} to {}", difference.field.name().replace('_', " "), difference.ours)
    };
    let named: Vec<String> = felt.iter().take(NAMED).map(place).collect();
    let more = if felt.len() > NAMED { format!(", and the other {} that the report lists,", felt.len() - NAMED) } else { String::new() };
    Some(format!("set {}{more} after loading", named.join(", ")))
}
