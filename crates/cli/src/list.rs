//! `featherbench list`.

use crate::args::ListArgs;
use crate::fail::Fail;
use crate::message::{self, say};
use crate::oracles;
use crate::robots::{self, Loaded};
use crate::root::Root;
use featherbench_bench::{Cell, Context, Engine, Factor, OWN, Planted, Robot, Suite};
use featherbench_engines::{Featherbench, Limits};
use featherbench_registry::Setup;
use featherbench_robots::Family;
use serde_json::{Value, json};

/// Prints what there is to run.
pub fn list(root: &Root, args: &ListArgs) -> Result<(), Fail> {
    if args.gates {
        return gates(root, args.json);
    }
    if args.json {
        say!("{:#}", json(root, args)?);
    } else {
        message::text(&text(root, args)?);
    }
    Ok(())
}

/// Prints every gate, and whether a fault that is planted in it fires it.
fn gates(root: &Root, json: bool) -> Result<(), Fail> {
    let gates = root.read_gates()?;
    let planted = gates.planted();
    let silent = planted.iter().filter(|planted| !planted.fired).count();
    if json {
        let gate = |Planted { gate, fired }: &Planted| {
            json!({
                "study": gate.study, "metric": gate.metric, "quantities": gate.quantities, "bound": gate.bound,
                "times": times(gate.times).0, "fires": fired,
            })
        };
        say!("{:#}", json!({ "gates": planted.iter().map(gate).collect::<Vec<_>>(), "silent": silent }));
        return fires(silent, planted.len());
    }
    for Planted { gate, fired } in &planted {
        let factor = times(gate.times).1;
        let word = if *fired { "fires" } else { "NEVER FIRES" };
        say!("{word:<12} {:<15} {:<24} {:e}{factor}  {}", gate.study, gate.metric, gate.bound, gate.quantities.join(", "));
    }
    say!("{} gates, {silent} of them that no planted fault fires", planted.len());
    fires(silent, planted.len())
}

/// A factor of a bound, as a word and as the end of a line.
fn times(factor: Factor) -> (&'static str, &'static str) {
    match factor {
        Factor::One => ("one", ""),
        Factor::Depth => ("depth", " per joint of depth"),
        Factor::DepthAndAmplification => ("depth_and_amplification", " per joint of depth and amplification"),
    }
}

fn fires(silent: usize, all: usize) -> Result<(), Fail> {
    if silent > 0 { Err(Fail::Gate(format!("{silent} of {all} gates never fire: another one stands before them"))) } else { Ok(()) }
}

/// The cells of a suite on its robots.
fn cells(root: &Root, loaded: &Loaded) -> Result<Vec<Cell>, Fail> {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
    let gates = root.read_gates()?;
    let context = Context { robots: &loaded.robots, engines: &engines, gates: &gates, seed: loaded.suite.seed };
    let reproduce = oracles::reproducer(root, Limits::default());
    let measure = oracles::measurer(root)?;
    let setup = Setup { suite: &loaded.suite, live: true, program: "", reproduce, measure };
    let studies = featherbench_registry::of_suite(&setup)?;
    Ok(studies.iter().flat_map(|study| study.plan(&context)).collect())
}

/// The name of every suite and what it is about.
fn suites(root: &Root) -> Result<Vec<(String, String)>, Fail> {
    let about = |name: String| Ok((Suite::read(&robots::suite_path(root, &name)?)?.0.about, name));
    robots::suites(root)?.into_iter().map(about).map(|suite| suite.map(|(about, name)| (name, about))).collect()
}

/// What there is to run, for programs. `list --help` describes the fields.
fn json(root: &Root, args: &ListArgs) -> Result<Value, Fail> {
    let loaded = robots::load(root, &args.suite, false, None, None)?;
    let suite = json!({ "name": loaded.name, "about": loaded.suite.about });
    if args.cells {
        let cell = |cell: &Cell| {
            let Cell { study, robot, engine, quantity, method, .. } = cell;
            json!({
                "cell": cell.id(), "path": cell.path(), "study": study, "robot": robot, "engine": engine, "quantity": quantity, "method": method,
            })
        };
        return Ok(json!({ "suite": suite, "cells": cells(root, &loaded)?.iter().map(cell).collect::<Vec<_>>() }));
    }
    let robot = |robot: &Robot| {
        json!({
            "robot": robot.name, "family": robot.family, "base": robot.base().to_string(), "nv": robot.states.nv, "bodies": robot.states.bodies,
            "depth": robot.depth,
        })
    };
    let described = oracles::described(root)?;
    let names = |names: Vec<&str>| std::iter::once(OWN).chain(names).map(str::to_owned).collect::<Vec<_>>();
    let suites = suites(root)?.into_iter().map(|(name, about)| json!({ "name": name, "about": about }));
    Ok(json!({
        "suite": suite,
        "robots": loaded.robots.iter().map(robot).collect::<Vec<_>>(),
        "suites": suites.collect::<Vec<_>>(),
        "engines": names(described.names(|engine| !engine.is_native())),
        "timed": names(described.names(|engine| engine.clock.is_some())),
        "studies": featherbench_registry::names(),
        "families": Family::NAMES,
    }))
}

fn text(root: &Root, args: &ListArgs) -> Result<String, Fail> {
    if args.conventions {
        return Ok(featherbench_bench::conventions::markdown(&featherbench_bench::conventions::read(&root.conventions())?));
    }
    let loaded = robots::load(root, &args.suite, false, None, None)?;
    if args.cells {
        return Ok(cells(root, &loaded)?.iter().map(|cell| format!("{}  {}\n", cell.id(), cell.path())).collect());
    }
    let mut text = format!("suite {}: {}\n\n", loaded.name, loaded.suite.about);
    text += "robot                     family       base   nv  bodies  depth\n";
    for robot in &loaded.robots {
        let states = &robot.states;
        text += &format!(
            "{:<25} {:<12} {:<5} {:>4} {:>7} {:>6}\n",
            robot.name,
            robot.family,
            robot.base(),
            states.nv,
            states.bodies,
            robot.depth
        );
    }
    text += "\nsuites:\n";
    for (name, about) in suites(root)? {
        text += &format!("  {name:<16} {about}\n");
    }
    let described = oracles::described(root)?;
    text += &format!("\nengines:  featherbench, {}\n", described.names(|engine| !engine.is_native()).join(", "));
    text += &format!("timed:    featherbench, {}\n", described.names(|engine| engine.clock.is_some()).join(", "));
    text += &format!("studies:  {}\n", featherbench_registry::names().join(", "));
    text += "\nfamilies of generated robots, with their parameters:\n";
    for name in Family::NAMES {
        let family = Family::parse(name).map_err(|error| Fail::input(error.to_string()))?;
        text += &format!("  {family}\n");
    }
    Ok(text)
}
