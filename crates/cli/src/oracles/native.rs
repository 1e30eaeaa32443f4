//! The native oracles: engines as libraries that CMake builds, once, from `oracles/native` and the installed packages.
//!
//! A library is kept in the user's cache folder under a hash of everything that it is made of. These are the sources, the files that tell
//! CMake how to compile them, the versions of the compiler and of the packages, and the processor.

use crate::fail::Fail;
use crate::message::tell;
use crate::oracles;
use crate::progress::spinner;
use crate::root::Root;
use featherbench_bench::{DescribedEngine, Engine, Engines, Identity, Library, Start, hash};
use featherbench_engines::{Limits, Oracle, native};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// The oldest CMake that `oracles/native/CMakeLists.txt` takes.
const CMAKE: (u32, u32) = (3, 22);

/// Everything that goes into a library.
struct Recipe<'a> {
    name: &'a str,
    /// CMake's settings: `-DNAME=VALUE`.
    settings: Vec<String>,
    /// Where the library is, once it is made.
    library: PathBuf,
}

/// The library of a native oracle.
///
/// # Errors
/// Why there is none: what is missing, or that it has not been built.
fn built(root: &Root, engine: &DescribedEngine, library: &Library) -> Result<PathBuf, String> {
    let recipe = Recipe::new(root, engine, library)?;
    let missing = || format!("{} is not built: run `featherbench oracles install --native`", engine.name);
    if recipe.library.is_file() { Ok(recipe.library) } else { Err(missing()) }
}

/// Starts a native oracle in a child process of this program.
///
/// # Errors
/// A sentence, when it is not built or does not answer.
pub fn start(root: &Root, engine: &DescribedEngine, library: &Library, limits: Limits) -> Result<Oracle, String> {
    let program = std::env::current_exe().map_err(|error| format!("this program does not know where it is: {error}"))?;
    Oracle::start(native::command(&program, &built(root, engine, library)?, None), limits)
}

/// Builds those of the named native oracles that can be built here and are not yet.
pub fn install(root: &Root, engines: &Engines, named: &[&DescribedEngine]) -> Result<(), Fail> {
    let missing = |engine: &DescribedEngine, message: String| {
        let version = engines.package(engine).map_or("", |package| package.version.as_str());
        let advice = format!("{} {version} needs {}", engine.name, engine.needs.join(", "));
        Fail::Missing { message, advice }
    };
    if let Err(reason) = install_tools(root) {
        // What is left out for want of them says so below.
        tell!("{reason}");
    }
    let mut left_out = None;
    let mut built = 0;
    for engine in named {
        let Start::Native(library) = &engine.start else { continue };
        match Recipe::new(root, engine, library) {
            Ok(recipe) if recipe.library.is_file() => tell!("{} is built: {}", engine.name, recipe.library.display()),
            Ok(recipe) => recipe.make(root).map_err(|reason| missing(engine, reason))?,
            // With one compiler there is one of the engines that are built by two.
            Err(reason) => {
                tell!("{} is left out: {reason}", engine.name);
                left_out = left_out.or_else(|| Some(missing(engine, "no native oracle can be built here".into())));
                continue;
            }
        }
        built += 1;
    }
    match left_out {
        Some(fail) if built == 0 => Err(fail),
        _ => Ok(()),
    }
}

/// Its version, its compiler and where it is, if it answers.
///
/// # Errors
/// A sentence that says why it does not.
pub fn status(root: &Root, engines: &Engines, engine: &DescribedEngine, library: &Library) -> Result<String, String> {
    let oracle = start(root, engine, library, Limits::default())?;
    let Identity { version, build, .. } = oracle.identity();
    let compiler = build.get("compiler").map_or("", String::as_str);
    let library = built(root, engine, library)?;
    Ok(super::answering(engines, &engine.name, version, format_args!("{compiler}  {}", library.display())))
}

impl<'a> Recipe<'a> {
    fn new(root: &Root, engine: &'a DescribedEngine, library: &Library) -> Result<Self, String> {
        let Library { folder, language, compilers, .. } = library;
        let (native, packages) = (root.oracles().join("native"), packages(root)?);
        let found = compilers.iter().find_map(|name| Some((name, compiler(name)?)));
        let (compiler, version) = found.ok_or_else(|| format!("there is no {}", compilers.join(" or ")))?;
        let versions = library.packages.iter().map(|package| version_of(&packages, package)).collect::<Result<Vec<_>, _>>()?;
        // Where headers stand is no part of the hash; where a library is linked from is.
        let linked = library.linked.as_ref().map(|folder| packages.join(folder));
        let mut settings = vec![
            format!("-DORACLE_ENGINE={folder}"),
            format!("-DORACLE_COMPILER={version}"),
            format!("-DORACLE_VERSIONS={}", versions.join(", ")),
            format!("-DCMAKE_{}_COMPILER={compiler}", language.cmake()),
        ];
        let mut parts = vec![format!("{settings:?}\n{:?}\n{linked:?}", processor()).into_bytes()];
        settings.push(format!("-DORACLE_PACKAGES={}", packages.display()));
        let sources = native.join(folder);
        let entries = std::fs::read_dir(&sources).map_err(|error| format!("{}: {error}", sources.display()))?;
        let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        files.sort();
        for file in ["CMakeLists.txt", "coordinates.h", "oracle.h"].map(|name| native.join(name)).iter().chain(&files) {
            parts.push(std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?);
        }
        let parts: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
        let library = cache()?.join(format!("{}-{}.so", engine.name, &hash::of_parts(&parts)[..16]));
        Ok(Self { name: &engine.name, settings, library })
    }

    /// Builds in a folder of its own, then moves the library to its place.
    fn make(&self, root: &Root) -> Result<(), String> {
        let (name, start) = (self.name, Instant::now());
        let bar = spinner(&format!("building {name} (up to some minutes, once) …"));
        let folder = self.library.with_extension(format!("{}.part", std::process::id()));
        let (mut configure, mut build) = (tool(root, "cmake")?, tool(root, "cmake")?);
        configure.args(["-G", "Ninja", "-S"]).arg(root.oracles().join("native")).arg("-B").arg(&folder).args(&self.settings);
        // No more compilers than cores: each takes up to a gigabyte.
        let cores = std::thread::available_parallelism().map_or(1, usize::from).to_string();
        build.arg("--build").arg(&folder).args(["--target", name, "--parallel", &cores]);
        let see = |line: &str| {
            bar.set_message(format!("{name}: {line}"));
            if let Some(source) =
                line.split_once("] Building ").and_then(|(_, object)| object.rsplit('/').next()).filter(|_| bar.is_hidden())
            {
                tell!("{name}: compiled {} ({:.0} s)", source.trim_end_matches(".o"), start.elapsed().as_secs_f64());
            }
        };
        let built = run(configure, see).and_then(|()| run(build, see));
        let moved =
            built.and_then(|()| std::fs::rename(folder.join(format!("{name}.so")), &self.library).map_err(|error| error.to_string()));
        bar.finish_and_clear();
        // What is left of a build is of no use to anybody.
        let _ = std::fs::remove_dir_all(&folder);
        moved.map_err(|reason| format!("{name}: {reason}"))?;
        tell!("built {name} in {:.0} s: {}", start.elapsed().as_secs_f64(), self.library.display());
        Ok(())
    }
}

/// Installs what `oracles/native/requirements.txt` pins into the engines' environment; not a tool that the system has.
fn install_tools(root: &Root) -> Result<(), String> {
    let (python, packages) = (python(root)?, packages(root)?);
    let file = root.oracles().join("native/requirements.txt");
    let pins = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let there = |pin: &str| match pin.split_once("==") {
        Some((name, version)) => {
            packages.join(format!("{}-{version}.dist-info", name.replace('-', "_"))).is_dir()
                || tool(root, name).ok().and_then(answer).is_some_and(|words| name != "cmake" || new_enough(&words))
        }
        None => pin.is_empty() || pin.starts_with('#'),
    };
    let pins: Vec<&str> = pins.lines().filter(|pin| !there(pin)).collect();
    if pins.is_empty() {
        return Ok(());
    }
    let bar = spinner(&format!("installing {} …", pins.join(", ")));
    let command = |program: &Path, arguments: &[&str]| {
        let mut command = Command::new(program);
        command.args(arguments).args(&pins);
        command
    };
    // An environment that uv made has no pip.
    let by_uv = || run(command(Path::new("uv"), &["pip", "install", "--no-deps", "--python", &python.to_string_lossy()]), |_| ());
    let by_pip = run(command(&python, &["-m", "pip", "install", "--no-deps"]), |line| bar.set_message(line.to_owned()));
    by_pip.or_else(|reason| by_uv().map_err(|_| format!("{} cannot be installed: {reason}", pins.join(", "))))
}

/// A tool of the engines' environment, or else of the system.
fn tool(root: &Root, name: &str) -> Result<Command, String> {
    // CMake itself stands beside the script that a wheel has for it, which names the environment's first place and no later one.
    let mut folders = vec![packages(root)?.join("cmake/data/bin"), python(root)?.with_file_name("")];
    folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    let path = std::env::join_paths(folders).map_err(|error| format!("PATH: {error}"))?;
    let mut command = Command::new(name);
    command.env("PATH", path);
    Ok(command)
}

/// Whether `cmake --version` tells of one that will do.
fn new_enough(words: &str) -> bool {
    let mut numbers = words.split([' ', '.']).filter_map(|number| number.parse().ok());
    (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) >= CMAKE
}

/// What a program prints of its version.
fn answer(mut command: Command) -> Option<String> {
    let output = command.arg("--version").stdin(Stdio::null()).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Runs a command to its end, and shows each of its lines to `see`.
fn run(mut command: Command, see: impl Fn(&str)) -> Result<(), String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = |error: std::io::Error| format!("{program} cannot be started: {error}");
    let (reader, writer) = std::io::pipe().map_err(failed)?;
    let mut child = command.stdin(Stdio::null()).stdout(writer.try_clone().map_err(failed)?).stderr(writer).spawn().map_err(failed)?;
    // It holds the other end of the pipe.
    drop(command);
    let lines: Vec<String> = BufReader::new(reader).lines().map_while(Result::ok).inspect(|line| see(line)).collect();
    let status = child.wait().map_err(failed)?;
    if status.success() { Ok(()) } else { Err(format!("{program} failed ({status}): {}", complaint(&lines))) }
}

/// The first line that tells of an error. What CMake has to say stands in the lines below it, up to an empty one.
fn complaint(lines: &[String]) -> String {
    let first = lines.iter().position(|line| line.to_lowercase().contains("error")).unwrap_or(lines.len().saturating_sub(1));
    let length = if lines.get(first).is_some_and(|line| line.starts_with("CMake Error")) { lines.len() } else { 1 };
    let told: Vec<&str> = lines.iter().skip(first).take(length).map(|line| line.trim()).take_while(|line| !line.is_empty()).collect();
    if told.is_empty() { "no message".into() } else { told.join(" ") }
}

/// The first line of the version of a compiler on the path.
fn compiler(name: &str) -> Option<String> {
    let version = answer(Command::new(name))?.lines().next()?.to_owned();
    // Some systems call clang `g++`: that would be the same library twice.
    if name == "g++" && version.contains("clang") { None } else { Some(version) }
}

/// The processor's features, on which `-march=native` depends.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let lines = text.lines().filter(|line| line.starts_with("model name") || line.starts_with("flags"));
    Some(lines.take(2).collect())
}

/// The engines' Python.
fn python(root: &Root) -> Result<PathBuf, String> {
    oracles::python(root).ok_or_else(|| "the reference engines are not installed: run `featherbench oracles install`".into())
}

/// The folder of the installed packages.
fn packages(root: &Root) -> Result<PathBuf, String> {
    let python = python(root)?;
    let library = python.parent().and_then(Path::parent).map(|environment| environment.join("lib")).ok_or("the environment has no lib")?;
    Ok(find(&library, "python3")?.join("site-packages"))
}

/// The entry of a folder whose name begins like this.
fn find(folder: &Path, beginning: &str) -> Result<PathBuf, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut entries = entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(beginning));
    entries.next().map(|entry| entry.path()).ok_or_else(|| format!("{} has no {beginning}*", folder.display()))
}

/// `name version` of an installed package.
fn version_of(packages: &Path, name: &str) -> Result<String, String> {
    let entry = find(packages, &format!("{name}-")).map_err(|reason| format!("{reason}: run `featherbench oracles install --native`"))?;
    let entry = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
    // The wheels of C++ libraries are named after the layout that they share.
    Ok(entry.trim_end_matches(".dist-info").trim_start_matches("cmeel_").replace('-', " "))
}

/// Where the libraries are kept.
fn cache() -> Result<PathBuf, String> {
    // A relative folder would be another one wherever the program is started.
    let named = |variable: &str| std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let from_home = || named("HOME").map(|home| home.join(".cache"));
    let folder = named("XDG_CACHE_HOME").or_else(from_home).ok_or("neither XDG_CACHE_HOME nor HOME says where the cache folder is")?;
    Ok(folder.join("featherbench/native"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_is_told() {
        let told = |text: &str| complaint(&text.lines().map(str::to_owned).collect::<Vec<_>>());
        let cmake =
            "-- The C compiler is unknown\nCMake Error at CMakeLists.txt:8 (message):\n  no headers:\n  install them\n\n\n-- Incomplete";
        assert_eq!(told(cmake), "CMake Error at CMakeLists.txt:8 (message): no headers: install them");
        let ninja =
            "[1/3] Building C object robot.c.o\nFAILED: robot.c.o\ncc -c robot.c\nrobot.c:1:2: error: no such thing\n  int\nstopped";
        assert_eq!(told(ninja), "robot.c:1:2: error: no such thing");
        assert_eq!((told("one\nkilled"), told("")), ("killed".into(), "no message".into()));
    }

    #[test]
    fn an_old_cmake_will_not_do() {
        assert!(
            ["3.22.1", "3.31.6-gabc", "4.0.0"]
                .map(|version| format!("cmake version {version}\n\nCMake suite"))
                .iter()
                .all(|words| new_enough(words))
        );
        assert!(["cmake version 3.21.9", "cmake version 2.99", "cmake", ""].iter().all(|words| !new_enough(words)));
    }
}
