//! `featherbench explain`: one cell of a run, from question to verdict.

use crate::args::ExplainArgs;
use crate::fail::Fail;
use ::record::Record;
use harness::{OUTCOMES_NAME, Outcome, OutcomeStore, Quantity, Refusal};

/// Prints what a cell asked, what was answered, and how it was judged.
pub fn explain(args: &ExplainArgs) -> Result<(), Fail> {
    let (info, records) = ::record::read_run(&args.folder)?;
    let rows: Vec<&Record> = records.iter().filter(|row| row.cell.starts_with(&args.cell)).collect();
    let Some(first) = rows.first() else {
        let message = format!(
            "{} has no cell that begins with '{}'; ids stand in the column 'cell' of records.csv",
            args.folder.display(),
            args.cell
        );
        return Err(Fail::input(message));
    };
    if let Some(other) = rows.iter().find(|row| row.cell != first.cell) {
        return Err(Fail::input(format!("'{}' begins more than one cell: {}, {}; give more digits", args.cell, first.cell, other.cell)));
    }
    let quantity = Quantity::parse(&first.quantity).map_or("", describe);
    println!("cell      {}", first.cell);
    println!("study     {}", first.study);
    println!("robot     {} ({}; nv {}, depth {})", first.model, first.problem, count(first.nv), count(first.depth));
    println!("asked     {} {} by {} in {}", first.engine, first.engine_version, first.method, first.scalar);
    println!("quantity  {}: {quantity}", first.quantity);
    println!("params    {}", first.params);
    if args.folder.join(OUTCOMES_NAME).is_file() {
        match OutcomeStore::open(&args.folder)?.get(&first.cell) {
            Some(Outcome::Values(values)) => {
                let head: Vec<String> = values.iter().take(6).map(|value| format!("{value:?}")).collect();
                println!("answer    {} numbers: {}{}", values.len(), head.join(", "), if values.len() > 6 { ", …" } else { "" });
            }
            Some(Outcome::Reading(reading)) => {
                let description = &reading.description;
                println!("answer    a robot of {} bodies and {} dofs", description.bodies.len(), description.nv());
                reading.notes.iter().for_each(|note| println!("note      {}: {}", note.cause, note.text));
            }
            Some(Outcome::Refused(Refusal::Unsupported(reason))) => println!("answer    not offered: {reason}"),
            Some(Outcome::Refused(Refusal::Failed(reason))) => println!("answer    failed: {reason}"),
            None => println!("answer    not kept"),
        }
    }
    println!();
    for row in &rows {
        let number = |value: Option<f64>| value.map_or_else(|| "–".into(), |value| format!("{value:.3e}"));
        let against = if row.reference.is_empty() { String::new() } else { format!(" against {}", row.reference) };
        println!(
            "{:<9} {:<10} {:<24} {} {} (bound {}, margin {} decades){against} {}",
            row.verdict.as_str(),
            row.case,
            row.metric,
            number(row.value),
            row.unit,
            number(row.bound),
            row.margin.map_or_else(|| "–".into(), |margin| format!("{margin:.1}")),
            row.reason
        );
    }
    println!(
        "\nagain     cargo run --release -- run --suite {} --only '^{}/{}/{}/{}/{}$'",
        info.suite, first.study, first.model, first.engine, first.quantity, first.method
    );
    Ok(())
}

fn count(number: Option<u64>) -> String {
    number.map_or_else(|| "–".into(), |number| number.to_string())
}

/// What a quantity is, in a phrase.
fn describe(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::InverseDynamics => "inverse dynamics τ = M a + h",
        Quantity::InverseDynamicsWrench => "inverse dynamics under external wrenches",
        Quantity::Bias => "bias force h, gravity included",
        Quantity::MassMatrix => "joint-space inertia matrix M",
        Quantity::MassMatrixProbe => "M times four vectors, its diagonal and its last row",
        Quantity::MassMatrixSparse => "M in the tree-sparse layout",
        Quantity::ForwardDynamics => "forward dynamics a = M⁻¹(τ − h)",
        Quantity::ForwardDynamicsSingle => "forward dynamics in single precision",
        Quantity::KineticEnergy => "kinetic energy",
        Quantity::PotentialEnergy => "potential energy",
        Quantity::CenterOfMass => "centre of mass",
        Quantity::Momentum => "centroidal momentum",
        Quantity::BodyPlacement => "placement of each body in the world",
        Quantity::BodyVelocity => "velocity of each body's origin, world axes",
        Quantity::BodyAcceleration => "classical acceleration of each body's origin, world axes",
        Quantity::BodyJacobian => "Jacobian of the deepest body, world axes",
        Quantity::Readback => "inertias and placements that the engine holds after building the robot",
        Quantity::StoredEntries => "stored numbers of the sparse mass matrix",
        Quantity::Factorization => "factors of M = LᵀDL",
        Quantity::Solve => "M⁻¹τ with given factors",
        Quantity::MassMatrixInverse => "M⁻¹",
    }
}
