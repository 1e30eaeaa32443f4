//! A tree of the study: a robot of the suite, or one that its generator gives when it is needed.

use featherbench_bench::alone;
use featherbench_bench::{Cell, Context, Identity, NoAnswer, Robot};
use featherbench_model::Description;
use featherbench_results::Row;
use serde_json::Value;
use std::borrow::Cow;

/// The sizes of a tree, at the beginning of the values of each cell: generated trees are not kept.
pub(crate) const SIZES: usize = 4;

/// The robot of a cell. A generated one is known by its generator's text.
pub(super) fn robot<'a>(context: &'a Context, name: &str) -> Result<Cow<'a, Robot>, NoAnswer> {
    match context.robot(name) {
        Some(robot) => Ok(Cow::Borrowed(robot)),
        None => alone::robot(name, context.seed).map(Cow::Owned),
    }
}

/// nq, nv, bodies and depth.
pub(super) fn sizes(robot: &Robot) -> [f64; SIZES] {
    [robot.states.nq, robot.states.nv, robot.description.bodies.len(), robot.depth].map(|size| size as f64)
}

/// A cell about a tree that is not among the suite's robots.
pub(crate) fn cell(study: &str, seed: u64, tree: &str, engine: &Identity, quantity: &str, method: &str, params: Value) -> Cell {
    Cell {
        study: study.into(),
        robot: tree.into(),
        // The text and the seed of the state are all there is to it.
        robot_hash: featherbench_bench::hash::of_parts(&[tree.as_bytes(), &seed.to_le_bytes()]),
        params,
        engine: engine.name.clone(),
        version: engine.version.clone(),
        method: method.into(),
        quantity: quantity.into(),
        scalar: "f64".into(),
    }
}

/// The family of a tree: that of the robot, or the first word of the generator's text.
pub(crate) fn family(context: &Context, tree: &str) -> String {
    context.robot(tree).map_or_else(|| tree.split(':').next().unwrap_or(tree).to_owned(), |robot| robot.family.clone())
}

/// A row with the fields of its cell.
pub(crate) fn row(context: &Context, cell: &Cell, sizes: Option<&[f64]>) -> Row {
    let size = |which: usize| sizes.and_then(|sizes| sizes.get(which)).map(|&size| size as u64);
    Row {
        cell: cell.id(),
        study: cell.study.clone(),
        family: family(context, &cell.robot),
        robot: cell.robot.clone(),
        nq: size(0),
        nv: size(1),
        bodies: size(2),
        depth: size(3),
        params: featherbench_results::canonical_json(&cell.params),
        engine: cell.engine.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        precision: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        unit: "1".into(),
        ..Row::default()
    }
}

/// The parent of each dof, from the description alone. Bodies stand after their parents, in depth-first order.
pub(super) fn dof_parents(robot: &Description) -> Vec<Option<usize>> {
    let (mut parents, mut last_of) = (Vec::new(), Vec::with_capacity(robot.bodies.len()));
    for body in &robot.bodies {
        let mut parent: Option<usize> = body.parent.and_then(|parent: usize| last_of[parent]);
        for _ in 0..body.joint.kind.nv() {
            parents.push(parent);
            parent = Some(parents.len() - 1);
        }
        // A body without dofs hands on its parent's.
        last_of.push(parent);
    }
    parents
}
