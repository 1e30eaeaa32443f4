//! `featherbench identify`: a robot's parameters from a log, and motions that tell them.

use crate::args::{Estimator, Format, IdentifyArgs, Term};
use crate::fail::Fail;
use crate::message::tell;
use crate::message::{say, text};
use crate::report::parquet;
use crate::robots::generate;
use crate::robots::sections::{Taker, heed};
use crate::root::Root;
use crate::{oracles, robots};
use featherbench_bench::{Engine, FileContent, FileFormat, SemidefiniteProblem};
use featherbench_engines::Limits;
use featherbench_formats::urdf::{Base as UrdfBase, Options};
use featherbench_identification::{
    Base, Change, Flag, Identified, LinearModel, Log, LogProblem, Method, Request, Search, Semidefinite, Smoothing, Table, Terms, changes,
    described, excite, identify as estimate, samples,
};
use featherbench_model::Description;
use serde_json::{Value, json};
use std::path::Path;

/// The engine of semidefinite programmes.
const SOLVER: &str = "clarabel";
/// Its tolerance: below the margin that the programme leaves.
const TOLERANCE: f64 = 1e-9;
/// The most of its iterations.
const ITERATIONS: usize = 500;
/// Samples of a motion that is written.
const SAMPLES: usize = 1000;
/// Changes that are printed; --json has them all.
const SHOWN: usize = 24;

/// Identifies a robot, or writes a motion.
pub fn identify(root: &dyn Fn() -> Result<Root, Fail>, args: &IdentifyArgs) -> Result<(), Fail> {
    let description = robot(root, args)?;
    let taker = if args.excite.is_some() { Taker::Excitation } else { Taker::Identification };
    let not_used = heed(&description, &args.robot.display().to_string(), taker)?;
    let linear = LinearModel::new(&description, terms(&args.terms)).map_err(bad)?;
    match (&args.excite, &args.log) {
        (Some(path), _) => motion(&linear, args, path, &not_used),
        (None, Some(log)) => from_log(root, &linear, args, log, &not_used),
        (None, None) => Err(Fail::input("give a log, or --excite FILE".into())),
    }
}

fn bad(error: impl std::fmt::Display) -> Fail {
    Fail::input(error.to_string())
}

fn robot(root: &dyn Fn() -> Result<Root, Fail>, args: &IdentifyArgs) -> Result<Description, Fail> {
    let path = &args.robot;
    if path.extension().is_some_and(|ending| ending == "json") {
        return robots::read_model(path);
    }
    let content = FileContent::recognised(path)?;
    if content.format == FileFormat::Mjcf {
        return generate::compiled(&root()?, &content, args.floating);
    }
    let base = if args.floating { UrdfBase::Floating } else { UrdfBase::Fixed };
    let (description, notes) = content.urdf(&Options { base, independent_mimics: false, allow_massless: false })?;
    notes.iter().for_each(|note| tell!("note: {}: {note}", path.display()));
    Ok(description)
}

fn terms(asked: &[Term]) -> Terms {
    let has = |term| asked.contains(&term);
    Terms { armature: has(Term::Armature), viscous: has(Term::Viscous), coulomb: has(Term::Coulomb), offset: has(Term::Offset) }
}

/// Searches an exciting motion and writes it as a log with the torques that the description predicts.
fn motion(linear: &LinearModel, args: &IdentifyArgs, path: &Path, not_used: &[&str]) -> Result<(), Fail> {
    let base = Base::of_robot(linear, 1).map_err(bad)?;
    let found = excite(linear, &base, &Search { frequency: args.frequency, ..Search::default() }).map_err(bad)?;
    let samples = found.trajectory.samples(linear, &linear.nominal(), SAMPLES, 1.0).map_err(bad)?;
    ::featherbench_results::atomic_write(path, Log::of_samples(&samples).to_csv(linear).as_bytes())?;
    if args.json {
        let answer = json!({
            "base_parameters": base.rank(), "condition": found.condition, "condition_of_scaled_columns": found.scaled,
            "condition_of_first_draw": found.first, "tried": found.tried, "seconds": 1.0 / args.frequency, "not_used": not_used,
        });
        say!("{answer}");
        return Ok(());
    }
    say!("{}: a motion of {} s that tells {} base parameters", path.display(), 1.0 / args.frequency, base.rank());
    say!(
        "  cond(Y) {:.1}, with scaled columns {:.1}; the first of {} motions had {:.1}",
        found.condition,
        found.scaled,
        found.tried,
        found.first
    );
    say!("  positions, speeds and torques are within 98 % of their limits, by the description");
    Ok(())
}

fn from_log(
    root: &dyn Fn() -> Result<Root, Fail>,
    linear: &LinearModel,
    args: &IdentifyArgs,
    path: &Path,
    not_used: &[&str],
) -> Result<(), Fail> {
    if args.window.is_multiple_of(2) {
        return Err(Fail::input(format!("--window {}: give an odd number of rows, so that one is in the middle", args.window)));
    }
    let log = read(path, linear)?;
    let smoothing = Smoothing { order: args.order, half: args.window / 2, stride: args.stride.unwrap_or(args.window) };
    smoothing.check().map_err(bad)?;
    let samples = samples(&log, linear, smoothing).map_err(bad)?;
    let method = match args.method {
        Estimator::Ordinary => Method::Ordinary,
        Estimator::Weighted => Method::Weighted,
        Estimator::Total => Method::Total,
        Estimator::LogCholesky => Method::LogCholesky,
        Estimator::Semidefinite => Method::Semidefinite,
    };
    let oracle = match method {
        Method::Semidefinite => {
            let root = root()?;
            let engines = oracles::described(&root)?;
            Some(oracles::start(&root, engines.get(SOLVER).map_err(Fail::input)?, Limits::default())?)
        }
        _ => None,
    };
    let solve = |problem: &Semidefinite| {
        let solver = oracle.as_ref().and_then(|oracle| oracle.semidefinite_solver()).ok_or("the engine does not offer it")?;
        let method = solver.semidefinite_methods().into_iter().next().ok_or("the engine has no method")?;
        let data = SemidefiniteProblem {
            unknowns: problem.unknowns(),
            matrix: problem.matrix.clone(),
            target: problem.target.clone(),
            maps: problem.maps.clone(),
        };
        let found = solver.semidefinite_least_squares(&data, &method, TOLERANCE, ITERATIONS).map_err(|error| error.to_string())?;
        if found.converged { Ok(found.x) } else { Err(format!("{SOLVER} ends with '{}'", found.status)) }
    };
    let request = Request { method, held_out: args.held_out, solver: oracle.is_some().then_some(&solve) };
    let found = estimate(linear, &samples, &request).map_err(bad)?;
    let mut flags = log.examine(linear);
    flags.extend(found.flags.iter().cloned());
    let changed = match &args.out {
        Some(out) => write(linear, &found, out, args.lossy)?,
        None => described(linear, &found.theta).map(|robot| changes(linear.description(), &robot)).unwrap_or_default(),
    };
    if args.json {
        say!("{}", answer(linear, &found, &flags, &changed, not_used))
    } else {
        text(&told(linear, &found, &flags, &changed, path))
    }
    match &found.held_out {
        Some((_, before, after)) if after.total.is_nan() || after.total > before.total => Err(Fail::Gate(format!(
            "what is held out is predicted worse ({:.3e}) than by the description ({:.3e})",
            after.total, before.total
        ))),
        _ => Ok(()),
    }
}

/// Reads a log, in Parquet by the program that reads it.
fn read(path: &Path, linear: &LinearModel) -> Result<Log, Fail> {
    let log = match Log::read(path, linear) {
        Err(error) if error.problem == LogProblem::Parquet => {
            let table = Table::of_csv(&parquet::table(path)?, &error.file).map_err(bad)?;
            Log::of_table(table.with_rows_for_lines(), linear)
        }
        read => read,
    };
    log.map_err(bad)
}

/// Writes the robot, and says what changed.
fn write(linear: &LinearModel, found: &Identified, out: &Path, lossy: bool) -> Result<Vec<Change>, Fail> {
    let robot = described(linear, &found.theta).map_err(bad)?;
    match generate::by_ending(out) {
        Format::Neutral => generate::write(&robot, Some(out)).map_err(bad)?,
        format => {
            if let Some(text) = generate::written(&robot, format, lossy)? {
                ::featherbench_results::atomic_write(out, text.as_bytes())?;
            }
        }
    }
    tell!("{}: {} with {} new numbers", out.display(), robot.name, changes(linear.description(), &robot).len());
    Ok(changes(linear.description(), &robot))
}

/// The answer for people: how well torques are predicted first.
fn told(linear: &LinearModel, found: &Identified, flags: &[Flag], changed: &[Change], path: &Path) -> String {
    let mut text = match &found.held_out {
        Some((count, before, after)) => format!(
            "{}: {} samples that were held out are predicted to {:.2} % of their torques (description: {:.2} %)\n",
            path.display(),
            count,
            100.0 * after.total,
            100.0 * before.total
        ),
        None => format!("{}: {} samples are fitted to {:.2} % of their torques\n", path.display(), found.fitted, 100.0 * found.fit.total),
    };
    text += &format!(
        "  {} of {} base parameters by {} from {} samples; condition {:.1e}, σ gap {:.1e}\n",
        found.estimate.base.rank(),
        found.rank_of_robot,
        found.method.name(),
        found.fitted,
        found.estimate.base.condition(),
        found.estimate.base.gap
    );
    let impossible = found.bodies.iter().filter(|body| !body.is_consistent()).count();
    text += &match impossible {
        0 => "  every body can exist: no pseudo-inertia has a negative eigenvalue\n".to_owned(),
        count => format!("  {count} bodies cannot exist: take log_cholesky or semidefinite to write the robot\n"),
    };
    for flag in flags {
        text += &format!("  flag {flag}\n");
    }
    text += "\n  joint                 rms N·m   of spread   white residual (Ljung–Box, p)\n";
    for (dof, of) in linear.dofs().iter().enumerate() {
        let white = found.fit.whiteness[dof].map_or("too few samples".to_owned(), |white| {
            format!("{} ({:.3})", if white.is_white() { "yes" } else { "no" }, white.probability)
        });
        text += &format!("  {:<20} {:>9.3e}  {:>9.3e}   {white}\n", of.name, found.fit.rms[dof], found.fit.relative[dof]);
    }
    text += "\n  base parameter, with half of its 95 % interval\n";
    for (i, name) in found.estimate.base.names(linear).iter().enumerate() {
        let half = found.estimate.half_width(i).map_or_else(String::new, |half| format!(" ± {half:.2e}"));
        text += &format!("  {:>12.5e}{half}   {name}\n", found.beta[i]);
    }
    if !changed.is_empty() {
        text += "\n  what changes in the description\n";
        for change in changed.iter().take(SHOWN) {
            text +=
                &format!("  {:<20} {:<10} {:>12.5e} → {:>12.5e} {}\n", change.of, change.field, change.before, change.after, change.unit);
        }
        if changed.len() > SHOWN {
            text += &format!("  and {} more (--json has them)\n", changed.len() - SHOWN);
        }
    }
    let legend = linear.description().bodies.iter().enumerate().map(|(k, body)| format!("{} {}", k + 1, body.name));
    text + &format!("\n  numbers in names: bodies {}; friction and armature count dofs\n", legend.collect::<Vec<_>>().join(", "))
}

/// The answer for programs. What is not a number is null.
fn answer(linear: &LinearModel, found: &Identified, flags: &[Flag], changed: &[Change], not_used: &[&str]) -> Value {
    let fit = |fit: &featherbench_identification::Fit| {
        json!({
            "relative": fit.total, "rms": fit.rms, "relative_to_spread": fit.relative,
            "whiteness_probability": fit.whiteness.iter().map(|white| white.map(|white| white.probability)).collect::<Vec<_>>(),
        })
    };
    let names = found.estimate.base.names(linear);
    let base = names.iter().enumerate().map(|(i, name)| {
        json!({"name": name, "value": found.beta[i], "standard_deviation": found.estimate.deviation(i), "half_width_95": found.estimate.half_width(i)})
    });
    let unknowns = linear.unknowns().iter().zip(&found.theta).zip(linear.nominal());
    let parameters = unknowns
        .map(|((unknown, value), before)| json!({"name": unknown.name(), "unit": unknown.unit(), "before": before, "value": value}));
    json!({
        "not_used": not_used,
        "robot": linear.description().name,
        "method": found.method.name(),
        "samples": found.fitted,
        "base_parameters_of_robot": found.rank_of_robot,
        "condition": found.estimate.base.condition(),
        "gap": found.estimate.base.gap,
        "dofs": linear.dofs().iter().map(|dof| &dof.name).collect::<Vec<_>>(),
        "fit": fit(&found.fit),
        "held_out": found.held_out.as_ref().map(|(count, before, after)| json!({"samples": count, "before": fit(before), "after": fit(after)})),
        "base_parameters": base.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "smallest_eigenvalues": found.bodies.iter().map(|body| body.smallest).collect::<Vec<_>>(),
        "flags": flags.iter().map(|flag| json!({"kind": flag.kind.name(), "about": flag.about, "line": flag.line, "count": flag.count, "consequence": flag.consequence})).collect::<Vec<_>>(),
        "changes": changed.iter().map(|change| json!({"of": change.of, "field": change.field, "unit": change.unit, "before": change.before, "after": change.after})).collect::<Vec<_>>(),
    })
}
