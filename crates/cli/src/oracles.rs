//! Installing the reference engines, and looking at them.

use crate::fail::Fail;
use crate::native;
use crate::package;
use crate::rapier;
use crate::root::Root;
use featherbench_bench::{Engine, NoAnswer};
use featherbench_engines::{Limits, Oracle};
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsString;
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

/// Engines that come with the project, in the order of reports.
pub const ENGINES: [&str; 4] = ["pinocchio", "mujoco", "drake", "dart"];
/// Those of them that estimate what their engine's own calls take, so that timing can name them as peers.
pub const ESTIMATING: [&str; 2] = ["drake", "dart"];

/// The environment's Python, or `None` when the engines are not installed in these versions.
pub fn python(root: &Root) -> Option<PathBuf> {
    let python = root.engines().join("venv/bin/python");
    let wanted = stamp(root).ok()?;
    let there = std::fs::read_to_string(root.engines().join("installed")).ok()?;
    (there == wanted && python.exists()).then_some(python)
}

/// Makes the environment unless it is there; what was downloaded before a break is used again.
pub fn install(root: &Root) -> Result<PathBuf, Fail> {
    if let Some(python) = python(root) {
        eprintln!("the reference engines are installed in {}", root.engines().display());
        return Ok(python);
    }
    let folder = root.engines();
    let environment = folder.join("venv");
    std::fs::create_dir_all(&folder).map_err(|error| Fail::input(format!("{}: {error}", folder.display())))?;
    let requirements = root.oracles().join("requirements.txt");
    let packages = root.oracles().join("packages.txt");
    let python = environment.join("bin/python");
    let bar = spinner("installing the reference engines (about 1.4 GB) …");
    let text = |path: &Path| path.as_os_str().to_owned();
    let uv = Command::new("uv").arg("--version").output().is_ok_and(|output| output.status.success());
    if uv {
        if !python.exists() {
            step(&bar, "uv", &["venv".into(), "--python".into(), "3.11".into(), text(&environment)])?;
        }
        let install = ["pip".into(), "install".into(), "--python".into(), text(&python)];
        let engines = ["-r".into(), text(&requirements)];
        let files = ["--no-deps".into(), "--target".into(), text(&root.packages()), "-r".into(), text(&packages)];
        step(&bar, "uv", &[&install[..], &engines].concat())?;
        step(&bar, "uv", &[&install[..], &files].concat())?;
    } else {
        if !python.exists() {
            step(&bar, "python3", &["-m".into(), "venv".into(), text(&environment)])?;
        }
        let install = ["-m", "pip", "install", "--progress-bar", "off"].map(OsString::from);
        let engines = ["-r".into(), text(&requirements)];
        // Into a folder of their own, emptied first: pip does not replace what stands there.
        let _ = std::fs::remove_dir_all(root.packages());
        let files = ["--no-deps".into(), "--target".into(), text(&root.packages()), "-r".into(), text(&packages)];
        step(&bar, &python.to_string_lossy(), &[&install[..], &engines].concat())?;
        step(&bar, &python.to_string_lossy(), &[&install[..], &files].concat())?;
    }
    bar.finish_and_clear();
    let stamp = stamp(root)?;
    ::featherbench_results::atomic_write(&folder.join("installed"), stamp.as_bytes())?;
    eprintln!("installed the reference engines in {}", folder.display());
    Ok(python)
}

/// Runs one command of the installation, showing its last line.
fn step(bar: &ProgressBar, program: &str, arguments: &[OsString]) -> Result<(), Fail> {
    let missing = |message: String| {
        let advice = "the engines need Python 3.11 with venv (Debian: python3 python3-venv) and a reachable package index; \
                      without them, `featherbench run` compares with the recorded answers";
        Fail::Missing { message, advice: advice.into() }
    };
    let shown: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy()).collect();
    bar.set_message(format!("{program} {}", shown.join(" ")));
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| missing(format!("{program} cannot be started: {error}")))?;
    let errors = child.stderr.take();
    let collector = std::thread::spawn(move || -> Vec<String> {
        errors.map(|errors| BufReader::new(errors).lines().map_while(Result::ok).collect()).unwrap_or_default()
    });
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            bar.set_message(line);
        }
    }
    let status = child.wait().map_err(|error| missing(format!("{program}: {error}")))?;
    let errors = collector.join().unwrap_or_default();
    if status.success() {
        return Ok(());
    }
    let last = errors.iter().rev().find(|line| line.to_lowercase().contains("error")).or(errors.last()).cloned().unwrap_or_default();
    Err(missing(format!("`{program} {}` failed ({status}): {last}", shown.join(" "))))
}

/// Progress of something long; without a terminal, `announced` is printed once.
pub fn spinner(announced: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        eprintln!("{announced}");
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

/// What an installation is known by: the hash of what it was asked for.
fn stamp(root: &Root) -> Result<String, Fail> {
    let mut asked = Vec::new();
    for name in ["requirements.txt", "packages.txt"] {
        let path = root.oracles().join(name);
        asked.extend(std::fs::read(&path).map_err(|error| Fail::input(format!("{}: {error}", path.display())))?);
    }
    Ok(featherbench_bench::hash::of(&asked))
}

/// Starts the oracle of an engine that is to be timed, where the engines are installed.
pub fn start_timed(root: &Root, engine: &str, limits: Limits) -> Result<Oracle, String> {
    let missing = "the reference engines are not installed: run `featherbench oracles install`";
    start(root, &python(root).ok_or(missing)?, engine, limits)
}

/// Starts an engine's oracle.
pub fn start(root: &Root, python: &Path, engine: &str, limits: Limits) -> Result<Oracle, String> {
    Oracle::start(package::command(root, python, engine)?, limits)
}

/// Evaluates reproductions of known deviations in the engines' environment.
pub fn reproducer(root: &Root, limits: Limits) -> featherbench_studies::Reproduce {
    let missing = || "the reference engines are not installed; run `featherbench oracles install`".to_owned();
    let command = python(root).ok_or_else(missing).and_then(|python| package::command(root, &python, "reproduce"));
    Arc::new(move |name, seeds| match &command {
        Ok(command) => featherbench_engines::reproduce(command, limits, name, seeds),
        Err(reason) => Err(NoAnswer::Failed(reason.clone())),
    })
}

/// Prints what answers.
pub fn status(root: &Root) -> Result<(), Fail> {
    native::status(root);
    rapier::status(root);
    let Some(python) = python(root) else {
        let message = "the reference engines are not installed (or in other versions than oracles/requirements.txt asks)".into();
        return Err(Fail::Missing { message, advice: "run `featherbench oracles install`".into() });
    };
    let mut broken = Vec::new();
    for engine in ENGINES {
        match start(root, &python, engine, Limits::default()) {
            Ok(oracle) => println!("{engine:<10} {}", oracle.identity().version),
            Err(reason) => {
                println!("{engine:<10} does not answer: {reason}");
                broken.push(engine);
            }
        }
    }
    if broken.is_empty() {
        return Ok(());
    }
    let advice = format!("remove {} and run `featherbench oracles install` again", root.engines().display());
    Err(Fail::Missing { message: format!("no answer from {}", broken.join(", ")), advice })
}

/// The package's folder of robots, for suites that read URDF files live.
pub fn robots(root: &Root) -> Option<PathBuf> {
    let library = root.engines().join("venv/lib");
    let versions = std::fs::read_dir(library).ok()?;
    let inside = "site-packages/cmeel.prefix/share/example-robot-data/robots";
    versions.filter_map(Result::ok).map(|version| version.path().join(inside)).find(|folder| folder.is_dir())
}
