//! Installing the reference engines, and looking at them.

use crate::args::InstallArgs;
use crate::compiled::Compiled;
use crate::fail::Fail;
use crate::native;
use crate::package;
use crate::root::Root;
use featherbench_bench::{DescribedEngine, Engine, Engines, NoAnswer, OWN, Start};
use featherbench_engines::{Limits, Oracle, alone};
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsString;
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

/// What the oracles share.
const SHARED: &str = "requirements.txt";
/// The packages of robots.
const ROBOTS: &str = "packages.txt";
/// What is said where the environment is missing.
const MISSING: &str = "the reference engines are not installed: run `featherbench oracles install`";

/// The engines that `oracles/engines.toml` describes.
pub fn described(root: &Root) -> Result<Engines, Fail> {
    Ok(Engines::read(&root.described())?)
}

/// The environment's Python, or `None` when the engines are not installed in these versions.
pub fn python(root: &Root) -> Option<PathBuf> {
    let python = root.engines().join("venv/bin/python");
    let wanted = stamp(root).ok()?;
    let there = std::fs::read_to_string(root.engines().join("installed")).ok()?;
    (there == wanted && python.exists()).then_some(python)
}

/// Installs what is named: engines of this Python environment by all of it, the others one by one. Without a name, the environment.
pub fn install_named(root: &Root, args: &InstallArgs) -> Result<(), Fail> {
    let engines = described(root)?;
    let named = |name: &String| engines.get(name).map_err(Fail::input);
    let mut named: Vec<&DescribedEngine> = args.engines.iter().map(named).collect::<Result<_, _>>()?;
    if args.native {
        named.extend(engines.iter().filter(|engine| engine.is_native()));
    }
    for engine in &named {
        let compiled = match &engine.start {
            Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program),
            Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library),
            Start::Python { .. } | Start::Native(_) => continue,
        };
        eprintln!("{} is built: {}", engine.name, compiled.install()?.display());
    }
    let (native, others): (Vec<&DescribedEngine>, Vec<_>) = named.into_iter().partition(|engine| engine.is_native());
    if !native.is_empty() || others.is_empty() || others.iter().any(|engine| engine.is_python()) {
        install(root)?;
    }
    if native.is_empty() { Ok(()) } else { native::install(root, &engines, &native) }
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
    let requirements = root.oracles().join(SHARED);
    let packages = root.oracles().join(ROBOTS);
    let pins = described(root)?.pins().into_iter().map(OsString::from);
    let engines: Vec<OsString> = pins.chain(["-r".into(), requirements.into_os_string()]).collect();
    let python = environment.join("bin/python");
    let bar = spinner("installing the reference engines (about 1.6 GB) …");
    let text = |path: &Path| path.as_os_str().to_owned();
    let uv = Command::new("uv").arg("--version").output().is_ok_and(|output| output.status.success());
    if uv {
        if !python.exists() {
            step(&bar, "uv", &["venv".into(), "--python".into(), "3.11".into(), text(&environment)])?;
        }
        let install = ["pip".into(), "install".into(), "--python".into(), text(&python)];
        let files = ["--no-deps".into(), "--target".into(), text(&root.packages()), "-r".into(), text(&packages)];
        step(&bar, "uv", &[&install[..], &engines].concat())?;
        step(&bar, "uv", &[&install[..], &files].concat())?;
    } else {
        if !python.exists() {
            step(&bar, "python3", &["-m".into(), "venv".into(), text(&environment)])?;
        }
        let install = ["-m", "pip", "install", "--progress-bar", "off"].map(OsString::from);
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

/// What an installation is known by: the hash of what it was asked for, in any order and whatever the comments.
fn stamp(root: &Root) -> Result<String, Fail> {
    let mut environment = described(root)?.pins();
    environment.extend(pins(&root.oracles().join(SHARED))?);
    let mut robots = pins(&root.oracles().join(ROBOTS))?;
    let asked = [&mut environment, &mut robots].map(|asked| {
        asked.sort();
        asked.dedup();
        asked.join("\n")
    });
    Ok(featherbench_bench::hash::of_parts(&asked.each_ref().map(|asked| asked.as_bytes())))
}

/// The lines of a requirements file that ask for something.
fn pins(path: &Path) -> Result<Vec<String>, Fail> {
    let text = std::fs::read_to_string(path).map_err(|error| Fail::input(format!("{}: {error}", path.display())))?;
    let lines = text.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    Ok(lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect())
}

/// Starts an engine's oracle, in the way that its description says. An engine that cargo builds is built if need be; the others must be
/// installed.
pub fn start(root: &Root, engine: &DescribedEngine, limits: Limits) -> Result<Oracle, Fail> {
    let missing = |message| Fail::Missing { message, advice: "look at `featherbench oracles status`".into() };
    match &engine.start {
        Start::Python { module } => {
            let command = python(root).ok_or_else(|| MISSING.to_owned()).and_then(|python| package::command(root, &python, module));
            command.and_then(|command| Oracle::start(command, limits)).map_err(missing)
        }
        Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program).start(limits),
        Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library).start(limits),
        Start::Native(library) => native::start(root, engine, library, limits).map_err(missing),
    }
}

/// Evaluates reproductions of known deviations in the engines' environment.
pub fn reproducer(root: &Root, limits: Limits) -> featherbench_studies::Reproduce {
    let command = python(root).ok_or_else(|| MISSING.to_owned()).and_then(|python| package::command(root, &python, "reproduce"));
    Arc::new(move |name, seeds| match &command {
        Ok(command) => featherbench_engines::reproduce(command, limits, name, seeds),
        Err(reason) => Err(NoAnswer::Failed(reason.clone())),
    })
}

/// Measures questions, each in a process of its own: ours by this program, other engines by their oracles.
pub fn measurer(root: &Root) -> Result<featherbench_bench::alone::Ask, Fail> {
    let program = std::env::current_exe().map_err(|error| Fail::input(format!("this program's path: {error}")))?;
    let (root, described) = (root.clone(), described(root)?);
    Ok(Arc::new(move |question| {
        if question.engine == OWN {
            return alone::ask(&alone::command(&program), question);
        }
        let failed = |reason: String| NoAnswer::Failed(reason);
        let engine = described.get(&question.engine).map_err(|error| failed(error.to_string()))?;
        let oracle = start(&root, engine, question.limits).map_err(|fail| failed(fail.to_string()))?;
        let robot = featherbench_bench::alone::robot(&question.robot, question.seed)?;
        featherbench_bench::alone::measure(&oracle, &robot, question, || None)
    }))
}

/// Prints what answers.
pub fn status(root: &Root) -> Result<(), Fail> {
    let engines = described(root)?;
    let installed = python(root).is_some();
    let mut broken = Vec::new();
    for engine in engines.iter() {
        let told = match &engine.start {
            Start::Python { .. } => match start(root, engine, Limits::default()) {
                Ok(oracle) => oracle.identity().version.clone(),
                Err(_) if !installed => "is not installed: run `featherbench oracles install`".into(),
                Err(fail) => {
                    broken.push(engine.name.as_str());
                    format!("does not answer: {fail}")
                }
            },
            Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program).told(),
            Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library).told(),
            Start::Native(library) => native::status(root, engine, library).unwrap_or_else(|reason| reason),
        };
        println!("{:<16} {told}", engine.name);
    }
    if !installed {
        let message = "the reference engines are not installed (or not in the versions of oracles/engines.toml)".into();
        return Err(Fail::Missing { message, advice: "run `featherbench oracles install`".into() });
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
