//! Python environments: the one that most engines share, and those of engines that are installed alone.

use crate::fail::Fail;
use crate::message::tell;
use crate::oracles::interpreters::{self, Interpreter};
use crate::oracles::package;
use crate::progress::spinner;
use crate::root::Root;
use featherbench_bench::{DescribedEngine, Engines, hash};
use indicatif::ProgressBar;
use std::ffi::OsString;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A Python environment with what was installed into it.
pub struct Environment<'a> {
    bar: &'a ProgressBar,
    /// What is said where a step fails.
    advice: &'a str,
    /// Whether uv installs, and not pip.
    uv: bool,
    /// Its Python.
    pub python: PathBuf,
}

impl<'a> Environment<'a> {
    /// Makes an environment in a folder and installs packages into it: what the installer is told of them.
    ///
    /// Its Python is the newest of the [`interpreters`] for which all packages have wheels. Each is tried, the newest first, until the
    /// installation succeeds. An environment that is there is kept, with its Python, where the file `installed` beside its folder says
    /// that an installation succeeded once. To have a newer Python, remove the environment.
    pub fn install(bar: &'a ProgressBar, folder: &Path, advice: &'a str, packages: &[OsString]) -> Result<Self, Fail> {
        let parent = folder.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).map_err(|error| Fail::input(format!("{}: {error}", parent.display())))?;
        let uv = Command::new("uv").arg("--version").output().is_ok_and(|output| output.status.success());
        let environment = Self { bar, advice, uv, python: folder.join("bin/python") };
        if parent.join("installed").exists() && environment.python.exists() {
            environment.add(packages)?;
            return Ok(environment);
        }
        let mut failures: Vec<String> = Vec::new();
        for interpreter in interpreters::found(uv) {
            let made = environment.remake(folder, &interpreter).and_then(|()| environment.add(packages));
            let Err(failure) = made else {
                failures.iter().for_each(|failure| tell!("passed over: {failure}"));
                return Ok(environment);
            };
            let reason = if let Fail::Missing { message, .. } = failure { message } else { failure.to_string() };
            failures.push(format!("Python {}: {reason}", interpreter.told()));
        }
        if failures.is_empty() {
            failures.push("no python3 of version 3.11 or later, with venv, is on the path or among pyenv's".into());
        }
        Err(environment.missing(failures.join("; ")))
    }

    /// Makes the environment of an interpreter. One that is of the same version is kept: an installation that broke off goes on.
    fn remake(&self, folder: &Path, interpreter: &Interpreter) -> Result<(), Fail> {
        if Interpreter::of(self.python.clone().into()).is_some_and(|there| there.version == interpreter.version) {
            return Ok(());
        }
        if folder.exists() {
            std::fs::remove_dir_all(folder).map_err(|error| Fail::input(format!("{}: {error}", folder.display())))?;
        }
        if self.uv {
            return self.step("uv", &["venv".into(), "--python".into(), interpreter.name.clone(), folder.into()]);
        }
        self.step(&interpreter.name.to_string_lossy(), &["-m".into(), "venv".into(), folder.into()])
    }

    /// Installs packages by their wheels: what is compiled here would be other code on each machine.
    fn add(&self, packages: &[OsString]) -> Result<(), Fail> {
        let wheels = ["--only-binary", ":all:"].map(OsString::from);
        if self.uv {
            let install = ["pip".into(), "install".into(), "--python".into(), self.python.as_os_str().to_owned()];
            return self.step("uv", &[&install, &wheels[..], packages].concat());
        }
        let install = ["-m", "pip", "install", "--progress-bar", "off"].map(OsString::from);
        self.step(&self.python.to_string_lossy(), &[&install, &wheels[..], packages].concat())
    }

    fn missing(&self, message: String) -> Fail {
        Fail::Missing { message, advice: self.advice.into() }
    }

    /// Unpacks packages into a folder of their own.
    pub fn install_into(&self, folder: &Path, packages: &[OsString]) -> Result<(), Fail> {
        if !self.uv {
            // Emptied first: pip does not replace what stands there.
            let _ = std::fs::remove_dir_all(folder);
        }
        self.add(&[&["--target".into(), folder.as_os_str().to_owned()], packages].concat())
    }

    /// Runs one command of the installation, showing its last line.
    fn step(&self, program: &str, arguments: &[OsString]) -> Result<(), Fail> {
        let shown: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy()).collect();
        self.bar.set_message(format!("{program} {}", shown.join(" ")));
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| self.missing(format!("{program} cannot be started: {error}")))?;
        let errors = child.stderr.take();
        let collector = std::thread::spawn(move || -> Vec<String> {
            errors.map(|errors| BufReader::new(errors).lines().map_while(Result::ok).collect()).unwrap_or_default()
        });
        if let Some(output) = child.stdout.take() {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                self.bar.set_message(line);
            }
        }
        let status = child.wait().map_err(|error| self.missing(format!("{program}: {error}")))?;
        let errors = collector.join().unwrap_or_default();
        if status.success() {
            return Ok(());
        }
        let last = errors.iter().rev().find(|line| line.to_lowercase().contains("error")).or(errors.last()).cloned().unwrap_or_default();
        Err(self.missing(format!("`{program} {}` failed ({status}): {last}", shown.join(" "))))
    }
}

/// The lines of a requirements file that ask for something.
pub fn pins(path: &Path) -> Result<Vec<String>, Fail> {
    let text = std::fs::read_to_string(path).map_err(|error| Fail::input(format!("{}: {error}", path.display())))?;
    let lines = text.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    Ok(lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect())
}

/// An engine in Python with an environment of its own, so that the installation of the other engines is no larger.
pub struct Alone<'a> {
    root: &'a Root,
    engine: &'a DescribedEngine,
    /// The module of the oracles' package.
    module: &'a str,
    /// The engine's own package, as it is asked for.
    pin: String,
}

impl<'a> Alone<'a> {
    /// The engine of this module.
    pub fn new(root: &'a Root, engine: &'a DescribedEngine, engines: &Engines, module: &'a str) -> Self {
        let pin = engines.package(engine).map_or_else(String::new, |package| format!("{}=={}", package.name, package.version));
        Self { root, engine, module, pin }
    }

    fn folder(&self) -> PathBuf {
        self.root.built(&self.engine.name)
    }

    fn requirements(&self) -> PathBuf {
        self.root.oracles().join("featherbench_oracles").join(self.module).join("requirements.txt")
    }

    /// What an installation is known by: the hash of what it was asked for.
    fn stamp(&self) -> Result<String, Fail> {
        let mut asked = pins(&self.requirements())?;
        asked.push(self.pin.clone());
        asked.sort();
        Ok(hash::of(asked.join("\n").as_bytes()))
    }

    /// The environment's Python, if what is asked for now is installed.
    fn python(&self) -> Option<PathBuf> {
        let python = self.folder().join("venv/bin/python");
        let there = std::fs::read_to_string(self.folder().join("installed")).ok()?;
        (self.stamp().ok()? == there && python.exists()).then_some(python)
    }

    /// Makes the environment unless it is there. The stamp is written last: what an installation that breaks off leaves behind is not taken.
    pub fn install(&self) -> Result<PathBuf, Fail> {
        if let Some(python) = self.python() {
            return Ok(python);
        }
        let Self { engine, .. } = self;
        let advice = format!("{} needs {}; suites that do not ask for it need none of it", engine.name, engine.needs.join(" and, "));
        let stamp = self.stamp()?;
        let bar = spinner(&format!("installing {} ({}) …", engine.title, engine.needs.join(", ")));
        // All packages are pinned: an installer that chose others would make other code.
        let packages: [OsString; 4] = ["--no-deps".into(), self.pin.clone().into(), "-r".into(), self.requirements().into_os_string()];
        let environment = Environment::install(&bar, &self.folder().join("venv"), &advice, &packages)?;
        bar.finish_and_clear();
        ::featherbench_results::atomic_write(&self.folder().join("installed"), stamp.as_bytes())?;
        Ok(environment.python)
    }

    /// What starts its oracle.
    ///
    /// # Errors
    /// A sentence, when it is not installed.
    pub fn command(&self) -> Result<Vec<OsString>, String> {
        let missing = || format!("{} is not installed: run `featherbench oracles install {0}`", self.engine.name);
        package::command(self.root, &self.python().ok_or_else(missing)?, self.module)
    }
}
