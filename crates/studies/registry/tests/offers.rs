//! Every study × an engine that offers nothing: a row says so. A study that is silent about an engine that it asks is found by one that offers
//! all that ours does.

use crate::registry::setup;
use featherbench_bench::run::{Opening, Run, Silent};
use featherbench_bench::{Cell, Context, Engine, Engines, Evaluation, Gates, Identity, NoAnswer, Quantity, Robot, Study, Suite};
use featherbench_engines::Featherbench;
use featherbench_registry::{names, of_suite, sections};
use featherbench_results::{EngineSource, ModelOrigin, RunInfo, Verdict};
use featherbench_robots::{Family, StateBatch};
use std::path::Path;

/// Our engine by another name, or an engine that offers nothing.
struct Other {
    identity: Identity,
    able: Option<Featherbench>,
}

impl Other {
    fn boxed(name: &str, able: bool) -> Box<dyn Engine> {
        let identity = Identity { name: name.into(), version: "1".into(), source: EngineSource::Live, build: Default::default() };
        Box::new(Self { identity, able: able.then(Featherbench::new) })
    }
}

impl Engine for Other {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.able.as_ref().map(|able| able.methods(quantity)).unwrap_or_default()
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        match &self.able {
            Some(able) => able.prepare(robot, quantity, method, states),
            None => Err(NoAnswer::NotOffered("nothing is".into())),
        }
    }
}

/// Suites with one study each: those of the project cut down to one table, and each study with no settings but engines, where it takes them.
fn suites() -> Vec<(String, Suite)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/suites");
    let head = "about = \"a\"\nseed = 1\nengines = [\"mute\"]\n";
    let mut made = Vec::new();
    for name in names() {
        let settings = [String::new(), "engines = [\"mute\"]\n".into(), "engines = [\"mute\"]\nwindows = 1\n".into()];
        let plain = settings.iter().map(|settings| format!("{head}[{name}]\n{settings}")).collect::<Vec<_>>();
        // The tables of the project's suites, with this engine in the place of theirs.
        let written = std::fs::read_dir(&folder).unwrap().filter_map(|entry| {
            let text = std::fs::read_to_string(entry.unwrap().path()).ok()?;
            let table = text.split(&format!("\n[{name}]\n")).nth(1)?;
            let end = table.find("\n[[robot]]").or_else(|| table.find("\n[draw]")).unwrap_or(table.len());
            let table: Vec<&str> = table[..end].split("\n[").collect();
            let own = table[..1].iter().chain(table[1..].iter().take_while(|more| more.starts_with('[') || more.starts_with(name)));
            let table = own.copied().collect::<Vec<_>>().join("\n[");
            let lines = table.lines().map(|line| if line.starts_with("engines = ") { "engines = [\"mute\"]" } else { line });
            Some(format!("{head}[{name}]\n{}\n", lines.collect::<Vec<_>>().join("\n")))
        });
        for text in plain.into_iter().chain(written) {
            let Ok(suite) = Suite::parse(&text, Path::new("one.toml")) else { continue };
            if of_suite(&setup(&suite, true)).is_ok_and(|studies| studies.iter().any(|study| study.name() == name)) {
                made.push((name.to_owned(), suite));
            }
        }
    }
    made
}

fn study(suite: &Suite, name: &str) -> Box<dyn Study> {
    of_suite(&setup(suite, true)).unwrap().into_iter().find(|study| study.name() == name).unwrap()
}

#[test]
fn no_study_is_silent_about_an_engine_that_offers_nothing() {
    let ci = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../ci");
    let gates = Gates::read(&ci, &Engines::read(&ci.join("../oracles/engines.toml")).unwrap()).unwrap();
    let description = Family::parse("chain:n=2,layout=planar").unwrap().generate().unwrap();
    let robots = [Robot::new(&description, "chain", ModelOrigin::Generated, 2, 1).unwrap()];
    let asks = |study: &dyn Study, able: bool| {
        let engines: [Box<dyn Engine>; 2] = [Box::new(Featherbench::new()), Other::boxed("mute", able)];
        let context = Context { robots: &robots, engines: &engines, gates: &gates, seed: 1 };
        study.plan(&context).iter().any(|cell| cell.engine == "mute")
    };
    let (mut tried, mut told, mut silent) = (std::collections::BTreeSet::new(), 0, Vec::new());
    for (name, suite) in suites() {
        tried.insert(name.clone());
        let of = study(&suite, &name);
        let engines: [Box<dyn Engine>; 2] = [Box::new(Featherbench::new()), Other::boxed("mute", false)];
        let context = Context { robots: &robots, engines: &engines, gates: &gates, seed: 1 };
        if !(of.asks(engines[1].as_ref()) || asks(of.as_ref(), true)) {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::open(&folder.path().join("run"), Opening::New, RunInfo::default()).unwrap();
        // Only what is asked of this engine is evaluated.
        let keep = |cell: &Cell| cell.engine == "mute";
        let rows = run.conduct(&[of], &context, &keep, &Silent).unwrap();
        match rows.iter().find(|row| row.study == name && row.engine == "mute" && row.value.is_none() && !row.reason.is_empty()) {
            Some(row) => assert!(matches!(row.verdict, Verdict::Skip | Verdict::Info | Verdict::Error), "{name}: {row:?}"),
            None => silent.push(format!("{name}: {}", rows.len())),
        }
        told += 1;
        // The report takes such rows.
        sections(&run.info, &rows);
    }
    assert_eq!(tried.len(), names().len(), "every study is made: {tried:?}");
    assert!(told >= 12, "{told}");
    assert!(silent.is_empty(), "{silent:?}");
}
