//! `featherbench explain`: one cell of a run, from question to verdict.

use crate::args::ExplainArgs;
use crate::fail::Fail;
use crate::say::say;
use crate::shell::{quoted, words};
use ::featherbench_results::{Row, RunInfo};
use featherbench_bench::{NoAnswer, OUTCOMES_NAME, Outcome, OutcomeStore, Quantity};

/// Prints what a cell asked, what was answered, and how it was judged.
pub fn explain(args: &ExplainArgs) -> Result<(), Fail> {
    let (info, records) = ::featherbench_results::read_run(&args.folder)?;
    let rows: Vec<&Row> = records.iter().filter(|row| row.cell.starts_with(&args.cell)).collect();
    let Some(first) = rows.first() else {
        let message =
            format!("{} has no cell that begins with '{}'; ids stand in the column 'cell' of rows.csv", args.folder.display(), args.cell);
        return Err(Fail::input(message));
    };
    if let Some(other) = rows.iter().find(|row| row.cell != first.cell) {
        return Err(Fail::input(format!("'{}' begins more than one cell: {}, {}; give more digits", args.cell, first.cell, other.cell)));
    }
    let quantity = Quantity::parse(&first.quantity).map_or("", describe);
    say!("cell      {}", first.cell);
    say!("study     {}", first.study);
    say!("robot     {} ({}; nv {}, depth {})", first.robot, first.family, count(first.nv), count(first.depth));
    say!("asked     {} {} by {} in {}", first.engine, first.engine_version, first.method, first.precision);
    say!("quantity  {}: {quantity}", first.quantity);
    say!("params    {}", first.params);
    if args.folder.join(OUTCOMES_NAME).is_file() {
        let (outcomes, lost) = OutcomeStore::look(&args.folder)?;
        match outcomes.get(&first.cell) {
            Some(Outcome::Values(values)) => {
                let head: Vec<String> = values.iter().take(6).map(|value| format!("{value:?}")).collect();
                say!("answer    {} numbers: {}{}", values.len(), head.join(", "), if values.len() > 6 { ", …" } else { "" });
            }
            Some(Outcome::Text(text)) => {
                let head: String = text.chars().take(400).collect();
                let more = if head.len() < text.len() { " …" } else { "" };
                say!("answer    a text of {} characters: {head}{more}", text.chars().count());
            }
            Some(Outcome::NoAnswer(NoAnswer::NotOffered(reason))) => say!("answer    not offered: {reason}"),
            Some(Outcome::NoAnswer(NoAnswer::Failed(reason))) => say!("answer    failed: {reason}"),
            None => say!("answer    not kept{}", lost.map_or_else(String::new, |lost| format!(": {lost}"))),
        }
    }
    say!("");
    for row in &rows {
        let number = |value: Option<f64>| value.map_or_else(|| "–".into(), |value| format!("{value:.3e}"));
        let against = if row.reference.is_empty() { String::new() } else { format!(" against {}", row.reference) };
        say!(
            "{:<9} {:<10} {:<24} {} {} (bound {}, margin {} decades){against} {}",
            row.verdict.as_str(),
            [row.body.as_str(), &row.states, &row.cache].concat(),
            row.metric,
            number(row.value),
            row.unit,
            number(row.bound),
            row.margin.map_or_else(|| "–".into(), |margin| format!("{margin:.1}")),
            row.reason
        );
    }
    say!("\nagain     {}", again(&info, first).map_err(Fail::input)?);
    Ok(())
}

/// Options of a run that say where it was written and how much of it: each with its value.
const OF_THE_RUN: [&str; 2] = ["--filter", "--out"];
/// Options that continue a run.
const CONTINUING: [&str; 2] = ["--resume", "--allow-mixed"];

/// The command that makes a cell's rows again: that of the run, with a filter that leaves the study of the robot. The rows compare an answer
/// with those of others, so the others are asked too.
fn again(info: &RunInfo, row: &Row) -> Result<String, String> {
    let all = words(&info.command)?;
    let (program, given) = all.split_at(all.iter().position(|word| word == "--").map_or(0, |at| at + 1));
    let mut kept: Vec<String> = Vec::new();
    let mut words = given.iter();
    while let Some(word) = words.next() {
        if OF_THE_RUN.contains(&word.as_str()) {
            words.next();
        } else if !CONTINUING.contains(&word.as_str()) && !OF_THE_RUN.iter().any(|option| word.starts_with(&format!("{option}="))) {
            kept.push(word.clone());
        }
    }
    let has = |kept: &[String], option: &str| kept.iter().any(|word| word == option || word.starts_with(&format!("{option}=")));
    // A comparison of files has no filter: it is made again as a whole.
    if !has(&kept, "compare") {
        if !has(&kept, "run") {
            kept.push("run".into());
        }
        if !has(&kept, "--suite") && info.suite != "default" {
            kept.extend(["--suite".into(), info.suite.clone()]);
        }
        if !has(&kept, "--live") && info.live {
            kept.push("--live".into());
        }
        // Cells that belong to no robot, or draw one, are known by their study.
        let of_study = row.robot.is_empty() || row.study == "repeatability";
        let robot = if of_study { String::new() } else { format!("{}/", regex_lite::escape(&row.robot)) };
        kept.extend(["--filter".into(), format!("^{}/{robot}", row.study)]);
    }
    Ok(program.iter().chain(&kept).map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
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
        Quantity::FactorEntries => "numbers of the engine's own triangular factor of M",
        Quantity::Solve => "M⁻¹τ with given factors",
        Quantity::MassMatrixInverse => "M⁻¹",
        Quantity::InverseDynamicsDq => "∂ID/∂q on the tangent space of the configurations",
        Quantity::InverseDynamicsDv => "∂ID/∂v",
        Quantity::ForwardDynamicsDq => "∂FD/∂q on the tangent space of the configurations",
        Quantity::ForwardDynamicsDv => "∂FD/∂v",
        Quantity::CoriolisMatrix => "Coriolis matrix C with Ṁ = C + Cᵀ",
        Quantity::TorqueRegressor => "torque regressor Y, τ − armature·a = Y π",
        Quantity::InverseDynamicsSecond => "second derivatives of weighted inverse dynamics",
        Quantity::ForwardDynamicsSecond => "second derivatives of weighted forward dynamics",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(command: &str, live: bool, suite: &str) -> String {
        let info = RunInfo { command: command.into(), live, suite: suite.into(), ..RunInfo::default() };
        let row = Row { study: "agreement".into(), robot: "tree_0.3".into(), ..Row::default() };
        again(&info, &row).unwrap()
    }

    #[test]
    fn the_command_keeps_what_the_answer_depends_on() {
        let only = "--filter '^agreement/tree_0\\.3/'";
        assert_eq!(of("cargo run --release --", false, "default"), format!("cargo run --release -- run {only}"));
        assert_eq!(
            of("cargo run --release -- run --suite smoke --live --seed 3 --filter 'x|y' --out a --resume", true, "smoke"),
            format!("cargo run --release -- run --suite smoke --live --seed 3 {only}")
        );
        assert_eq!(of("run --filter=x --out=a --allow-mixed", true, "smoke"), format!("run --suite smoke --live {only}"));
        let external = "run --engine 'mine=sh '\"'\"'my oracle.sh'\"'\"''";
        assert_eq!(of(external, false, "default"), format!("{external} {only}"));
        assert_eq!(of("compare 'my robot.urdf' --floating --out x", true, "compare"), "compare 'my robot.urdf' --floating");
    }
}
