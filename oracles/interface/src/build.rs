//! What `hello` tells of an engine, found by its build script.

use std::process::Command;

/// Sets `ORACLE_VERSION`, the version of the engine's package in the lock file, and `ORACLE_COMPILER` and `ORACLE_FLAGS`. `profile` is what the
/// manifest adds to the compiler's flags.
///
/// # Panics
/// If the lock file does not hold the package: the build ends there.
pub fn tell(package: &str, profile: &str) {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=Cargo.lock");
    let lock = std::fs::read_to_string("Cargo.lock").unwrap_or_default();
    let version = version(&lock, package);
    println!("cargo::rustc-env=ORACLE_VERSION={}", version.unwrap_or_else(|| panic!("Cargo.lock holds no {package}")));
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let compiler = Command::new(rustc).arg("--version").output().ok().and_then(|output| String::from_utf8(output.stdout).ok());
    println!("cargo::rustc-env=ORACLE_COMPILER={}", compiler.unwrap_or_default().trim());
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo::rustc-env=ORACLE_FLAGS={flags} {profile}");
}

/// The version of a package in the text of a lock file.
fn version<'a>(lock: &'a str, package: &str) -> Option<&'a str> {
    let named = format!("name = \"{package}\"");
    let entry = lock.split("[[package]]").find(|entry| entry.lines().any(|line| line == named))?;
    entry.split("version = \"").nth(1)?.split('"').next()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_version_is_that_of_the_whole_name() {
        let lock = "[[package]]\nname = \"faer-traits\"\nversion = \"1.0.0\"\n\n[[package]]\nname = \"faer\"\nversion = \"2.0.0\"\n";
        assert_eq!(super::version(lock, "faer"), Some("2.0.0"));
        assert_eq!(super::version(lock, "gemm"), None);
    }
}
