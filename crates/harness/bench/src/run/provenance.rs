//! The origin of a run: source, program, machine.

use crate::{Robot, hash};
use featherbench_results::{GitInfo, Host, RobotInfo, RunInfo};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The facts about this program and machine on which a run's rows depend; the caller adds suite, engines and models.
pub fn collect(root: &Path) -> RunInfo {
    let features = env!("FEATHERBENCH_TARGET_FEATURES");
    let mut target_features: Vec<String> = features.split(',').filter(|feature| !feature.is_empty()).map(str::to_owned).collect();
    target_features.sort_unstable();
    RunInfo {
        version: env!("CARGO_PKG_VERSION").into(),
        git: git(root),
        binary_hash: binary_hash(),
        rustc: env!("FEATHERBENCH_RUSTC").into(),
        profile: env!("FEATHERBENCH_PROFILE").into(),
        target_features,
        host: host(),
        ..RunInfo::default()
    }
}

/// The facts about the robots of a run.
pub fn robots(robots: &[Robot]) -> Vec<RobotInfo> {
    let of = |robot: &Robot| {
        let provenance = robot.description.provenance.clone().unwrap_or_default();
        RobotInfo {
            name: robot.name.clone(),
            hash: robot.hash.clone(),
            origin: robot.origin,
            licence: provenance.licence,
            source: provenance.source,
            nq: robot.states.nq as u64,
            nv: robot.states.nv as u64,
            bodies: robot.states.bodies as u64,
            depth: robot.depth as u64,
            properties: Some(robot.properties()),
            notes: robot.model.warnings.iter().map(ToString::to_string).collect(),
        }
    };
    robots.iter().map(of).collect()
}

/// The key in the build of an external engine with the content hash of its program. (Its version is only what the program says.)
pub const PROGRAM: &str = "program";

/// The key in the build of an engine compiled from the project's sources, with their hash.
pub const SOURCES: &str = "sources";

/// The facts, by name, that a resumed run must share with the run that it continues.
pub fn fingerprint(info: &RunInfo) -> BTreeMap<String, String> {
    let run = [
        ("suite", info.suite_hash.clone()),
        ("program", info.binary_hash.clone()),
        ("set of target features", hash::of(info.target_features.join(",").as_bytes())),
        ("libm", libm()),
        ("source of answers", if info.live { "live".into() } else { "recorded".into() }),
    ];
    let programs = info.engines.iter().flat_map(|engine| {
        let hash = move |what: &str| Some((format!("{what} of engine {}", engine.name), engine.build.get(what)?.clone()));
        [PROGRAM, SOURCES].into_iter().filter_map(hash)
    });
    run.into_iter().map(|(what, value)| (what.to_owned(), value)).chain(programs).collect()
}

/// A hash of the bits of sines and cosines from the mathematics library at fixed arguments.
fn libm() -> String {
    let mut random = featherbench_robots::Random::named(0, "libm");
    let bits = (0..1000).flat_map(|_| {
        let (s, c) = random.uniform(-10.0, 10.0).sin_cos();
        [s.to_bits(), c.to_bits()]
    });
    hash::of(&bits.flat_map(u64::to_le_bytes).collect::<Vec<u8>>())
}

fn binary_hash() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    bytes.map(|bytes| hash::of(&bytes)).unwrap_or_default()
}

fn git(root: &Path) -> GitInfo {
    let ask = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let revision = ask(&["rev-parse", "HEAD"]).unwrap_or_default();
    let dirty = ask(&["status", "--porcelain"]).is_some_and(|changes| !changes.is_empty());
    GitInfo { revision, dirty }
}

fn host() -> Host {
    let read = |path: &str| std::fs::read_to_string(path).map(|text| text.trim().to_owned()).unwrap_or_default();
    let field = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name));
        line.and_then(|line| line.split_once(':')).map(|(_, value)| value.trim().to_owned()).unwrap_or_default()
    };
    let memory = field(&read("/proc/meminfo"), "MemTotal");
    let kilobytes: u64 = memory.trim_end_matches("kB").trim().parse().unwrap_or(0);
    Host {
        cpu: field(&read("/proc/cpuinfo"), "model name"),
        cores: std::thread::available_parallelism().map_or(0, |cores| cores.get() as u64),
        affinity: field(&read("/proc/self/status"), "Cpus_allowed_list"),
        governor: read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
        load: read("/proc/loadavg").split_whitespace().next().and_then(|load| load.parse().ok()),
        kernel: read("/proc/sys/kernel/osrelease"),
        memory: (kilobytes > 0).then_some(kilobytes << 10),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::{EngineInfo, EngineSource};

    #[test]
    fn a_run_shares_the_programs_and_the_sources_of_its_engines() {
        let engine = |name: &str, key: &str, hash: &str| EngineInfo {
            name: name.into(),
            version: "1".into(),
            released: String::new(),
            source: EngineSource::Live,
            build: [(key.to_owned(), hash.to_owned())].into(),
            status: "ok".into(),
            reason: String::new(),
        };
        let engines = vec![engine("mine", PROGRAM, "1"), engine("rapier", SOURCES, "2"), engine("drake", "language", "Python")];
        let shared = fingerprint(&RunInfo { engines, ..RunInfo::default() });
        let of_engines: Vec<(&str, &str)> =
            shared.iter().filter(|(what, _)| what.contains(" of engine ")).map(|(what, hash)| (what.as_str(), hash.as_str())).collect();
        assert_eq!(of_engines, [("program of engine mine", "1"), ("sources of engine rapier", "2")]);
    }
}
