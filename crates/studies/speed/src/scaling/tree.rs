//! A tree of the study: a robot of the suite, or one that its generator gives when it is needed.

use super::What;
use featherbench_bench::{Asked, Cell, Context, Identity, NoAnswer, Robot, alone, hash};
use featherbench_model::Description;
use featherbench_results::Row;
use featherbench_study::case_row;
use std::borrow::Cow;

/// The sizes of a tree, at the beginning of the values of each cell: generated trees are not kept.
pub(crate) const SIZES: usize = 4;

/// The robot of a cell. A generated one is known by its generator's text.
pub(super) fn robot<'a>(asked: &Asked<'a>) -> Result<Cow<'a, Robot>, NoAnswer> {
    match asked.robot() {
        Ok(robot) => Ok(Cow::Borrowed(robot)),
        Err(_) => alone::robot(&asked.cell.robot, asked.context.seed).map(Cow::Owned),
    }
}

/// nq, nv, bodies and depth.
pub(super) fn sizes(robot: &Robot) -> [f64; SIZES] {
    [robot.states.nq, robot.states.nv, robot.description.bodies.len(), robot.depth].map(|size| size as f64)
}

/// A cell about a tree that is not among the suite's robots.
pub(crate) fn cell(study: &str, seed: u64, tree: &str, engine: &Identity, quantity: &str, method: &str, what: What) -> Cell {
    // The text and the seed of the state are all there is to it.
    let robot_hash = hash::of_parts(&[tree.as_bytes(), &seed.to_le_bytes()]);
    Cell { robot_hash, ..Cell::of_case(study, tree, (&engine.name, &engine.version), quantity, method, what) }
}

/// The family of a tree: that of the robot, or the first word of the generator's text.
pub(crate) fn family(context: &Context, tree: &str) -> String {
    context.robot(tree).map_or_else(|| tree.split(':').next().unwrap_or(tree).to_owned(), |robot| robot.family.clone())
}

/// A row with the fields of its cell.
pub(crate) fn row(context: &Context, cell: &Cell, sizes: Option<&[f64]>) -> Row {
    let size = |which: usize| sizes.and_then(|sizes| sizes.get(which)).map(|&size| size as u64);
    Row {
        family: family(context, &cell.robot),
        robot: cell.robot.clone(),
        nq: size(0),
        nv: size(1),
        bodies: size(2),
        depth: size(3),
        unit: "1".into(),
        ..case_row(cell)
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
