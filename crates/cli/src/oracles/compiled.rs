//! Engines that cargo builds: each is a Cargo workspace of its own in `oracles/`, built when it is first asked for.
//!
//! Beside what was built stands the hash of everything of the project's that it is made of; where that is another now, it is built again.

use crate::fail::Fail;
use crate::message::tell;
use crate::progress::spinner;
use crate::root::Root;
use featherbench_bench::{DescribedEngine, Engine, Engines, hash};
use featherbench_engines::{Limits, Oracle, native};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::ffi::OsString;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// How it is compiled, beside its own manifest: what the crates' manifests inherit, and the compiler's flags.
const SETTINGS: [&str; 2] = ["Cargo.toml", ".cargo/config.toml"];
/// What the names of the project's packages begin with; the rest is the name of the crate's folder.
const OURS: &str = "featherbench-";

/// An engine that cargo builds.
pub struct Compiled<'a> {
    root: &'a Root,
    name: &'a str,
    /// Its workspace, a folder in `oracles/`.
    folder: &'a str,
    /// The file that cargo makes: a program, or a library that this program serves.
    product: String,
    is_library: bool,
    needs: String,
}

impl<'a> Compiled<'a> {
    /// The engine of this workspace and program.
    pub fn program(root: &'a Root, engine: &'a DescribedEngine, folder: &'a str, program: &str) -> Self {
        Self { root, name: &engine.name, folder, product: program.to_owned(), is_library: false, needs: engine.needs.join(" and, ") }
    }

    /// The engine of this workspace and library.
    pub fn library(root: &'a Root, engine: &'a DescribedEngine, folder: &'a str, library: &str) -> Self {
        let product = format!("{DLL_PREFIX}{library}{DLL_SUFFIX}");
        Self { product, is_library: true, ..Self::program(root, engine, folder, library) }
    }

    /// What was built, if it is there and made of the present sources.
    fn built(&self) -> Result<Option<PathBuf>, String> {
        let (folder, product) = (self.root.built(self.folder), self.product());
        let made_of = std::fs::read_to_string(folder.join("built")).unwrap_or_default();
        Ok((made_of == sources(self.root.path(), self.folder)? && product.is_file()).then_some(product))
    }

    fn product(&self) -> PathBuf {
        self.root.built(self.folder).join("release").join(&self.product)
    }

    /// What starts it.
    fn command(&self, product: PathBuf) -> Result<Vec<OsString>, String> {
        if !self.is_library {
            return Ok(vec![product.into_os_string()]);
        }
        let program = std::env::current_exe().map_err(|error| format!("this program does not know where it is: {error}"))?;
        Ok(native::command(&program, &product, None))
    }

    fn missing(&self, message: String) -> Fail {
        let Self { name, folder, needs, .. } = self;
        let advice = format!(
            "{name} is compiled from oracles/{folder} by cargo, which needs {needs}; try again with `featherbench oracles install {name}`. \
             Suites that do not ask for {name} need none of it"
        );
        Fail::Missing { message, advice }
    }

    /// Builds it unless it is there.
    pub fn install(&self) -> Result<PathBuf, Fail> {
        let missing = |reason: String| self.missing(format!("{} cannot be built: {reason}", self.name));
        match self.built().map_err(missing)? {
            Some(product) => Ok(product),
            None => self.build().map_err(missing),
        }
    }

    /// Builds it if need be, and starts it. What it is made of is its identity, for runs that are resumed.
    pub fn start(&self, limits: Limits) -> Result<Oracle, Fail> {
        let product = self.install()?;
        let made_of = sources(self.root.path(), self.folder).map_err(Fail::input)?;
        let silent = |reason| self.missing(format!("{} does not answer: {reason}", self.name));
        let started = self.command(product).and_then(|command| Oracle::start(command, limits));
        Ok(started.map_err(silent)?.with_sources(&made_of))
    }

    /// Its status, or why it does not answer.
    pub fn told(&self, engines: &Engines) -> String {
        self.status(engines).unwrap_or_else(|reason| reason)
    }

    /// Its version and where it is, if it answers.
    ///
    /// # Errors
    /// A sentence that says why it does not.
    fn status(&self, engines: &Engines) -> Result<String, String> {
        let product = self
            .built()?
            .ok_or_else(|| format!("is not built: run `featherbench oracles install {}`, or a suite that asks for it", self.name))?;
        let oracle = self.command(product.clone()).and_then(|command| Oracle::start(command, Limits::default()));
        let oracle = oracle.map_err(|reason| format!("does not answer: {reason}"))?;
        Ok(super::answering(engines, self.name, &oracle.identity().version, product.display()))
    }

    /// Has cargo build it. The hash is written last: what a build that breaks off leaves behind is not taken.
    fn build(&self) -> Result<PathBuf, String> {
        let (made_of, folder) = (sources(self.root.path(), self.folder)?, self.root.built(self.folder));
        let stamp = folder.join("built");
        let named = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
        std::fs::create_dir_all(&folder).map_err(|error| named(&folder, error))?;
        let _ = std::fs::remove_file(&stamp);
        // The workspace's own folder, not a link to it: the crates beside it are found from there, and so are the compiler's flags.
        let workspace = self.root.oracles().join(self.folder);
        let workspace = workspace.canonicalize().map_err(|error| named(&workspace, error))?;
        let product = self.product();
        cargo_build(self.name, &workspace, &folder, &["--release"], &product)?;
        ::featherbench_results::atomic_write(&stamp, made_of.as_bytes()).map_err(|error| error.to_string())?;
        Ok(product)
    }
}

/// Has cargo build in a workspace, with its progress on the terminal. `product` is the file that it shall make.
///
/// # Errors
/// A sentence that says why it is not there.
pub fn cargo_build(name: &str, workspace: &Path, target: &Path, arguments: &[&str], product: &Path) -> Result<(), String> {
    let start = Instant::now();
    // Where there is no such folder, the system says that cargo is not there.
    if !workspace.is_dir() {
        return Err(format!("{} is not there", workspace.display()));
    }
    let target = std::path::absolute(target).map_err(|error| format!("{}: {error}", target.display()))?;
    let bar = spinner(&format!("building {name} (a minute or two, once) …"));
    let mut cargo = Command::new("cargo");
    let spawned = cargo
        .current_dir(workspace)
        .args(["build", "--locked", "--color", "never", "--target-dir"])
        .arg(target)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = spawned.map_err(|error| format!("cargo cannot be started: {error}"))?;
    let mut lines = Vec::new();
    for line in child.stderr.take().into_iter().flat_map(|errors| BufReader::new(errors).lines().map_while(Result::ok)) {
        bar.set_message(format!("building {name}: {}", line.trim()));
        lines.push(line);
    }
    let status = child.wait().map_err(|error| format!("cargo: {error}"))?;
    bar.finish_and_clear();
    if !status.success() {
        return Err(format!("`cargo build` in {} failed ({status}): {}", workspace.display(), complaint(&lines)));
    }
    if !product.is_file() {
        return Err(format!("cargo built something, but not {}; a CARGO_BUILD_TARGET would be why", product.display()));
    }
    tell!("built {name} in {:.0} s: {}", start.elapsed().as_secs_f64(), product.display());
    Ok(())
}

/// Cargo's first error, and the innermost cause that it gives.
fn complaint(lines: &[String]) -> String {
    let words = |line: &String| line.trim().to_owned();
    let first = lines.iter().find(|line| line.starts_with("error")).or(lines.last()).map(words).unwrap_or_default();
    let cause = lines.iter().rposition(|line| line.starts_with("Caused by")).and_then(|at| lines.get(at + 1)).map(words);
    cause.map_or_else(|| first.clone(), |cause| format!("{first}: {cause}"))
}

/// The folders of the project's crates that a workspace is compiled with, by its lock file: those of mechanics and of the harness, or in
/// `oracles/` what engines share.
fn crates(project: &Path, folder: &str) -> Result<Vec<PathBuf>, String> {
    let file = project.join("oracles").join(folder).join("Cargo.lock");
    let lock = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let names = lock.lines().filter_map(|line| line.strip_prefix("name = \"")?.strip_prefix(OURS)?.strip_suffix('"'));
    // Its own package is not among the crates.
    let found = names.filter(|name| *name != folder).filter_map(|name| {
        let folders = ["crates/mechanics", "crates/harness", "oracles"].map(|floor| PathBuf::from(floor).join(name));
        folders.into_iter().find(|folder| project.join(folder).is_dir())
    });
    Ok(found.collect())
}

/// The hash of the sources and the lock file.
fn sources(project: &Path, folder: &str) -> Result<String, String> {
    let mut files: Vec<PathBuf> = SETTINGS.map(PathBuf::from).into();
    let own = PathBuf::from("oracles").join(folder);
    files.push(own.join("Cargo.lock"));
    for folder in crates(project, folder)?.into_iter().chain([own]) {
        files.push(folder.join("Cargo.toml"));
        files.push(folder.join("build.rs"));
        let mut folders = vec![folder.join("src")];
        while let Some(folder) = folders.pop() {
            let error = |error| format!("{}: {error}", project.join(&folder).display());
            for entry in std::fs::read_dir(project.join(&folder)).map_err(error)? {
                let path = folder.join(entry.map_err(error)?.file_name());
                if project.join(&path).is_dir() { &mut folders } else { &mut files }.push(path);
            }
        }
    }
    files.sort();
    // Names as well: a file that moves is another module. What is not there (few crates have a build script) is a fact like another.
    let read = |path: &PathBuf| [path.as_os_str().as_encoded_bytes().to_vec(), std::fs::read(project.join(path)).unwrap_or_default()];
    let parts: Vec<Vec<u8>> = files.iter().flat_map(read).collect();
    Ok(hash::of_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
    }

    #[test]
    fn all_of_the_project_that_it_is_made_of_is_hashed() {
        let crates =
            |folder: &str| crates(&project(), folder).map(|folders| folders.iter().map(|f| f.display().to_string()).collect::<Vec<_>>());
        // Scenes bring what they are made of.
        let rapier = ["contact", "dynamics", "formats", "model", "protocol", "robots", "scenes", "spatial"]
            .map(|name| format!("crates/{}/{name}", if name == "protocol" { "harness" } else { "mechanics" }));
        assert_eq!(crates("rapier").unwrap(), rapier);
        assert_eq!(crates("dynibo").unwrap(), ["oracles/interface"]);
        let factorizing =
            ["crates/mechanics/dynamics", "oracles/factors", "oracles/interface", "crates/mechanics/model", "crates/mechanics/spatial"];
        assert_eq!(crates("faer").unwrap(), factorizing);
        assert_eq!(crates("nalgebra").unwrap(), factorizing);
        assert!(crates("no-such-engine").unwrap_err().contains("no-such-engine"));
    }

    #[test]
    fn what_changes_is_built_again() {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = folder.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        for name in ["crates/mechanics/model", "crates/mechanics/formats", "oracles/interface", "oracles/rapier"] {
            write(&format!("{name}/src/deep/a.rs"), "one");
        }
        let lock = ["formats", "interface", "model", "rapier"].map(|name| format!("name = \"featherbench-{name}\"\n")).concat();
        write("oracles/rapier/Cargo.lock", &lock);
        let sources = |folder: &Path| sources(folder, "rapier");
        let mut seen = vec![sources(folder.path()).unwrap()];
        write("oracles/rapier/Cargo.lock", &format!("{lock}version = 2\n"));
        seen.push(sources(folder.path()).unwrap());
        for path in [
            "oracles/rapier/build.rs",
            "oracles/interface/src/deep/a.rs",
            "crates/mechanics/model/src/deep/a.rs",
            "crates/mechanics/formats/src/b.rs",
            "Cargo.toml",
        ] {
            write(path, "another");
            seen.push(sources(folder.path()).unwrap());
        }
        write("crates/mechanics/formats/tests/c.rs", "a test is no part of it");
        assert_eq!(sources(folder.path()).ok().as_ref(), seen.last());
        let of = seen.len();
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), of);
    }

    #[test]
    fn the_cause_that_cargo_gives_is_told() {
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let offline =
            "    Updating crates.io index\nerror: failed to get `x`\n\nCaused by:\n  download failed\n\nCaused by:\n  no network\n";
        assert_eq!(complaint(&lines(offline)), "error: failed to get `x`: no network");
        assert_eq!(complaint(&lines("   Compiling a\nerror[E0425]: no value\n --> a.rs")), "error[E0425]: no value");
        assert_eq!((complaint(&lines("killed")), complaint(&[])), ("killed".into(), String::new()));
    }
}
