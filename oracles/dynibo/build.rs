//! Sets what `hello` tells: the version of dynibo in the lock file, the compiler's version and its flags.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=Cargo.lock");
    let lock = std::fs::read_to_string("Cargo.lock").unwrap_or_default();
    let entry = lock.split("[[package]]").find(|entry| entry.contains("name = \"dynibo\""));
    let version = entry.and_then(|entry| entry.split("version = \"").nth(1)?.split('"').next());
    println!("cargo::rustc-env=DYNIBO_VERSION={}", version.expect("Cargo.lock holds no dynibo"));
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let compiler = Command::new(rustc).arg("--version").output().ok().and_then(|output| String::from_utf8(output.stdout).ok());
    println!("cargo::rustc-env=DYNIBO_COMPILER={}", compiler.unwrap_or_default().trim());
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo::rustc-env=DYNIBO_FLAGS={flags} -C opt-level=3 -C codegen-units=1 -C lto=fat");
}
