//! The native peers: engines as libraries that this program compiles, once, from `oracles/native` and the installed packages.
//!
//! A library is kept in the user's cache folder under a hash of everything that it is made of: sources, flags, the compiler's and the
//! packages' versions, and the processor, for which it is compiled.

use crate::fail::Fail;
use crate::oracles;
use crate::root::Root;
use featherbench_bench::{Engine, Identity, hash};
use featherbench_engines::{Limits, Oracle, peer};
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// The peers, in the order of reports: Pinocchio by each compiler, because the compiler decides how fast it is.
pub const PEERS: [&str; 3] = ["pinocchio-clang", "pinocchio-gcc", "mujoco-native"];

/// What Pinocchio is compiled with: optimised for this processor, and with room for its many joint types in Boost's lists.
const PINOCCHIO_FLAGS: [&str; 10] = [
    "-std=c++17",
    "-O3",
    "-march=native",
    "-DNDEBUG",
    "-fPIC",
    "-fvisibility=hidden",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
];
/// What the C files beside MuJoCo's library are compiled with; the library itself is used as it is shipped.
const MUJOCO_FLAGS: [&str; 5] = ["-std=c11", "-O3", "-march=native", "-fPIC", "-fvisibility=hidden"];

/// The wheel of Eigen that fits Pinocchio's; the headers alone are taken from it.
const EIGEN: &str = "cmeel-eigen==3.4.1";

/// Everything that goes into a library.
struct Recipe {
    name: &'static str,
    compiler: PathBuf,
    flags: &'static [&'static str],
    /// Folders of foreign headers.
    include: Vec<PathBuf>,
    sources: Vec<PathBuf>,
    /// Behind the objects when linking.
    link: Vec<OsString>,
    /// Lines of `key=value`, for the peer's `hello`.
    build: String,
    /// Where the library is, once it is made.
    library: PathBuf,
}

/// The library of a peer.
///
/// # Errors
/// Why there is none: what is missing, or that it has not been built.
pub fn library(root: &Root, name: &str) -> Result<PathBuf, String> {
    let recipe = Recipe::new(root, name)?;
    let missing = || format!("{name} is not built: run `featherbench oracles install --native`");
    if recipe.library.is_file() { Ok(recipe.library) } else { Err(missing()) }
}

/// Starts a peer in a child process of this program; with a core, it is pinned there.
///
/// # Errors
/// A sentence, when it is not built or does not answer.
pub fn start(root: &Root, name: &str, limits: Limits, core: Option<usize>) -> Result<Oracle, String> {
    let program = std::env::current_exe().map_err(|error| format!("this program does not know where it is: {error}"))?;
    Oracle::start(peer::command(&program, &library(root, name)?, core), limits)
}

/// Builds the peers that can be built here and are not yet.
pub fn install(root: &Root) -> Result<(), Fail> {
    let missing = |message: String| Fail::Missing {
        message,
        advice:
            "native peers need clang++ or g++ (Debian: apt-get install clang), and for Pinocchio the headers of Eigen (fetched from the \
                 package index, or Debian's libeigen3-dev)"
                .into(),
    };
    if let Err(reason) = eigen().map(|_| ()).or_else(|_| fetch_eigen(root)) {
        // Pinocchio is then left out, and says so below.
        eprintln!("{reason}");
    }
    let mut built = 0;
    for name in PEERS {
        match Recipe::new(root, name) {
            Ok(recipe) if recipe.library.is_file() => eprintln!("{name} is built: {}", recipe.library.display()),
            Ok(recipe) => recipe.make().map_err(missing)?,
            // With one compiler there is one Pinocchio.
            Err(reason) => {
                eprintln!("{name} is left out: {reason}");
                continue;
            }
        }
        built += 1;
    }
    if built == 0 { Err(missing("no native peer can be built here".into())) } else { Ok(()) }
}

/// Prints which peers answer, and where they are.
pub fn status(root: &Root) {
    for name in PEERS {
        let peer = start(root, name, Limits::default(), None);
        match peer.and_then(|peer| Ok((peer, library(root, name)?))) {
            Ok((peer, library)) => {
                let Identity { version, build, .. } = peer.identity();
                println!("{name:<16} {version:<8} {}  {}", build.get("compiler").map_or("", String::as_str), library.display());
            }
            Err(reason) => println!("{name:<16} {reason}"),
        }
    }
}

impl Recipe {
    fn new(root: &Root, name: &str) -> Result<Self, String> {
        let known = || PEERS.into_iter().find(|known| *known == name);
        let name = known().ok_or_else(|| format!("there is no native peer {name}; there are {}", PEERS.join(", ")))?;
        let folder = root.oracles().join("native");
        let packages = packages(root)?;
        let (flags, tools): (&[&str], &[&str]) = match name {
            "pinocchio-clang" => (&PINOCCHIO_FLAGS[..], &["clang++"]),
            "pinocchio-gcc" => (&PINOCCHIO_FLAGS[..], &["g++"]),
            _ => (&MUJOCO_FLAGS[..], &["clang", "gcc", "cc"]),
        };
        let (compiler, version) =
            tools.iter().find_map(|tool| compiler(tool)).ok_or_else(|| format!("there is no {}", tools.join(" or ")))?;
        let (sources, headers, include, link, wheel) = if name == "mujoco-native" {
            let (wheel, package) = (version_of(&packages, "mujoco")?, packages.join("mujoco"));
            let engine = find(&package, "libmujoco.so.")?;
            let link = vec![engine.into(), joined("-Wl,-rpath,", &package), "-lm".into()];
            let group = folder.join("mujoco");
            let own = vec![folder.join("peer.h"), folder.join("coordinates.h"), group.join("robot.h")];
            (vec![group.join("robot.c"), group.join("methods.c")], own, vec![package.join("include")], link, wheel)
        } else {
            let (prefix, group) = (packages.join("cmeel.prefix/include"), folder.join("pinocchio"));
            let (headers, eigen_version) = eigen()?;
            let sources = ["robot", "inverse", "forward", "inertia", "kinematics"].map(|name| group.join(format!("{name}.cc")));
            let own = vec![folder.join("peer.h"), folder.join("coordinates.h"), group.join("robot.h")];
            let wheel = format!("{}, {eigen_version}", version_of(&packages, "libpinocchio")?);
            (sources.into(), own, vec![prefix, headers], Vec::new(), wheel)
        };
        let build = format!("compiler={version}\nflags={}\npackages={wheel}", flags.join(" "));
        // Where headers stand is no part of it; where a library is linked from is.
        let mut parts = vec![format!("{name}\n{build}\n{:?}\n{link:?}", processor()).into_bytes()];
        for source in sources.iter().chain(&headers) {
            parts.push(std::fs::read(source).map_err(|error| format!("{}: {error}", source.display()))?);
        }
        let parts: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
        let library = cache()?.join(format!("{name}-{}.so", &hash::of_parts(&parts)[..16]));
        Ok(Self { name, compiler, flags, include, sources, link, build, library })
    }

    /// Compiles and links in a folder of its own, then moves the library to its place.
    fn make(&self) -> Result<(), String> {
        let folder = self.library.with_extension(format!("{}.part", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let made = self.compile_in(&folder);
        let moved = made.and_then(|library| std::fs::rename(library, &self.library).map_err(|error| error.to_string()));
        // What is left of a build is of no use to anybody.
        let _ = std::fs::remove_dir_all(&folder);
        moved.map_err(|reason| format!("{}: {reason}", self.name))
    }

    fn compile_in(&self, folder: &Path) -> Result<PathBuf, String> {
        let bar = bar(self.name, self.sources.len());
        let start = Instant::now();
        let (next, failures) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let object = |source: &Path| folder.join(source.file_name().unwrap_or_default()).with_extension("o");
        let worker = || {
            while let Some(source) = self.sources.get(next.fetch_add(1, Ordering::Relaxed)) {
                let mut command = Command::new(&self.compiler);
                command.args(self.flags).args(self.include.iter().flat_map(|folder| [OsString::from("-isystem"), folder.into()]));
                command.args([text_macro("FB_ENGINE", self.name), text_macro("FB_BUILD", &self.build)]);
                let result = finished(command.arg("-c").arg(source).arg("-o").arg(object(source)));
                let name = source.file_name().unwrap_or_default().to_string_lossy();
                match result {
                    Ok(_) if bar.is_hidden() => eprintln!("{}: compiled {name} ({:.0} s)", self.name, start.elapsed().as_secs_f64()),
                    Ok(_) => bar.inc(1),
                    Err(reason) => failures.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(format!("{name}: {reason}")),
                }
            }
        };
        // No more compilers than cores: each takes up to a gigabyte.
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| (0..cores.min(self.sources.len())).for_each(|_| drop(scope.spawn(worker))));
        bar.finish_and_clear();
        if let Some(failure) = failures.lock().unwrap_or_else(std::sync::PoisonError::into_inner).first() {
            return Err(failure.clone());
        }
        let library = folder.join("peer.so");
        let objects = self.sources.iter().map(|source| object(source));
        let mut command = Command::new(&self.compiler);
        finished(command.args(["-shared", "-Wl,--no-undefined", "-o"]).arg(&library).args(objects).args(&self.link))?;
        eprintln!("built {} in {:.0} s: {}", self.name, start.elapsed().as_secs_f64(), self.library.display());
        Ok(library)
    }
}

/// `-DNAME="text"` with the text as a C string.
fn text_macro(name: &str, text: &str) -> String {
    format!("-D{name}=\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

fn joined(flag: &str, path: &Path) -> OsString {
    let mut joined = OsString::from(flag);
    joined.push(path);
    joined
}

/// Runs a command to its end.
fn finished(command: &mut Command) -> Result<Output, String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command.stdin(Stdio::null()).output().map_err(|error| format!("{program} cannot be started: {error}"))?;
    if output.status.success() {
        return Ok(output);
    }
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    let telling = words.lines().find(|line| line.contains("error")).or(words.lines().last()).unwrap_or("no message");
    Err(format!("{program} failed ({}): {telling}", output.status))
}

/// A compiler on the path and the first line of its version.
fn compiler(name: &str) -> Option<(PathBuf, String)> {
    let output = finished(Command::new(name).arg("--version")).ok()?;
    let version = String::from_utf8_lossy(&output.stdout).lines().next()?.to_owned();
    // Some systems call clang `g++`: that would be the same library twice.
    if name == "g++" && version.contains("clang") { None } else { Some((name.into(), version)) }
}

/// The processor's features, on which `-march=native` depends.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let lines = text.lines().filter(|line| line.starts_with("model name") || line.starts_with("flags"));
    Some(lines.take(2).collect())
}

/// The folder of the installed packages.
fn packages(root: &Root) -> Result<PathBuf, String> {
    let python = oracles::python(root).ok_or("the reference engines are not installed: run `featherbench oracles install`")?;
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
    let entry = find(packages, &format!("{name}-"))?;
    let entry = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(entry.trim_end_matches(".dist-info").replace('-', " "))
}

/// Where peers are kept.
fn cache() -> Result<PathBuf, String> {
    // A relative folder would be another one wherever the program is started.
    let named = |variable: &str| std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let from_home = || named("HOME").map(|home| home.join(".cache"));
    let folder = named("XDG_CACHE_HOME").or_else(from_home).ok_or("neither XDG_CACHE_HOME nor HOME says where the cache folder is")?;
    Ok(folder.join("featherbench/peers"))
}

/// Eigen's headers and their version: the fetched wheel's, or else the system's.
fn eigen() -> Result<(PathBuf, String), String> {
    let wheel = cache()?.join(EIGEN);
    let candidates = [wheel.join("cmeel.prefix/include/eigen3"), "/usr/include/eigen3".into()];
    let found = candidates.into_iter().find(|folder| folder.join("Eigen/Core").is_file());
    let headers = found
        .ok_or("there are no headers of Eigen: `featherbench oracles install --native` fetches them, or install Debian's libeigen3-dev")?;
    let macros = headers.join("Eigen/src/Core/util/Macros.h");
    let text = std::fs::read_to_string(&macros).map_err(|error| format!("{}: {error}", macros.display()))?;
    let number = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("#define EIGEN_{name}_VERSION ")));
        line.map(|number| number.trim().to_owned()).unwrap_or_default()
    };
    let version = ["WORLD", "MAJOR", "MINOR"].map(number).join(".");
    Ok((headers, format!("eigen {version}")))
}

/// Fetches Eigen's wheel into the cache folder and unpacks it; the environment of the engines stays as it is.
fn fetch_eigen(root: &Root) -> Result<(), String> {
    let folder = cache()?;
    let part = folder.join(format!("{EIGEN}.{}.part", std::process::id()));
    std::fs::create_dir_all(&part).map_err(|error| format!("{}: {error}", part.display()))?;
    let python = oracles::python(root).ok_or("the reference engines are not installed: run `featherbench oracles install`")?;
    let fetched = finished(Command::new(&python).args(["-m", "pip", "download", "--quiet", "--no-deps", "--dest"]).arg(&part).arg(EIGEN))
        .and_then(|_| find(&part, "cmeel_eigen"))
        .and_then(|wheel| finished(Command::new(&python).args(["-m", "zipfile", "-e"]).arg(wheel).arg(&part)))
        // An environment made by uv has no pip.
        .or_else(|_| finished(Command::new("uv").args(["pip", "install", "--no-deps", "--target"]).arg(&part).arg(EIGEN)))
        .and_then(|_| std::fs::rename(&part, folder.join(EIGEN)).map_err(|error| error.to_string()));
    let _ = std::fs::remove_dir_all(&part);
    fetched.map_err(|reason| format!("Eigen's headers cannot be fetched: {reason}"))
}

fn bar(name: &str, files: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        eprintln!("building {name} (files to compile: {files}, up to a minute each) …");
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(files as u64);
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} compiling {prefix}: {pos} of {len} files") {
        bar.set_style(style);
    }
    bar.set_prefix(name.to_owned());
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}
