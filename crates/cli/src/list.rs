//! `featherbench list`.

use crate::args::ListArgs;
use crate::fail::Fail;
use crate::oracles;
use crate::robots;
use crate::root::Root;
use crate::say::{self, say};
use featherbench_bench::{Context, Engine, Factor, Planted, Suite};
use featherbench_engines::{Featherbench, Limits};
use featherbench_robots::Family;
use featherbench_studies::{Kernels, Setup};

/// Prints what there is to run.
pub fn list(root: &Root, args: &ListArgs) -> Result<(), Fail> {
    if args.gates {
        return gates(root);
    }
    say::text(&text(root, args)?);
    Ok(())
}

/// Prints every gate, and whether a fault that is planted in it fires it.
fn gates(root: &Root) -> Result<(), Fail> {
    let gates = root.read_gates()?;
    let planted = gates.planted();
    for Planted { gate, fired } in &planted {
        let factor = match gate.times {
            Factor::One => "",
            Factor::Depth => " per joint of depth",
            Factor::DepthAndAmplification => " per joint of depth and amplification",
        };
        let word = if *fired { "fires" } else { "NEVER FIRES" };
        say!("{word:<12} {:<15} {:<24} {:e}{factor}  {}", gate.study, gate.metric, gate.bound, gate.quantities.join(", "));
    }
    let silent = planted.iter().filter(|planted| !planted.fired).count();
    say!("{} gates, {silent} of them that no planted fault fires", planted.len());
    if silent > 0 {
        Err(Fail::Gate(format!("{silent} of {} gates never fire: another one stands before them", planted.len())))
    } else {
        Ok(())
    }
}

fn text(root: &Root, args: &ListArgs) -> Result<String, Fail> {
    if args.conventions {
        return Ok(featherbench_bench::conventions::markdown(&featherbench_bench::conventions::read(&root.conventions())?));
    }
    let loaded = robots::load(root, &args.suite, false, None)?;
    if args.cells {
        let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new())];
        let gates = root.read_gates()?;
        let context = Context { robots: &loaded.robots, engines: &engines, gates: &gates, seed: loaded.suite.seed };
        let (kernels, reproduce) = (featherbench_engines::timed as Kernels, oracles::reproducer(root, Limits::default()));
        let measure = oracles::measurer(root)?;
        let setup = Setup { suite: &loaded.suite, live: true, program: "", kernels, reproduce, measure };
        let studies = featherbench_studies::of_suite(&setup)?;
        let cells = studies.iter().flat_map(|study| study.plan(&context));
        return Ok(cells.map(|cell| format!("{}  {}\n", cell.id(), cell.path())).collect());
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
    for name in robots::suites(root)? {
        let (suite, _) = Suite::read(&robots::suite_path(root, &name)?)?;
        text += &format!("  {name:<16} {}\n", suite.about);
    }
    let described = oracles::described(root)?;
    text += &format!("\nengines:  featherbench, {}\n", described.names(|engine| !engine.is_native()).join(", "));
    text += &format!("timed:    featherbench, {}\n", described.names(|engine| engine.clock.is_some()).join(", "));
    text += &format!("studies:  {}\n", featherbench_studies::names().join(", "));
    text += "\nfamilies of generated robots, with their parameters:\n";
    for name in Family::NAMES {
        let family = Family::parse(name).map_err(|error| Fail::input(error.to_string()))?;
        text += &format!("  {family}\n");
    }
    Ok(text)
}
