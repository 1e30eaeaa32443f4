//! The Python of the engines' environment: the newest for which all packages can be installed. The interpreters here are programs for the
//! shell that say a version, and make environments whose pip does what the test wants.

use crate::support::{Ended, Sandbox};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Writes an interpreter `python3.MINOR` into a folder, in whose environments pip succeeds or fails.
fn interpreter(folder: &Path, minor: u32, pip: &str) {
    let version = format!("echo 3 {minor} 0 final cpython");
    let text = format!(
        r#"#!/bin/sh
if [ "$1" = -c ]; then {version}; exit; fi
/bin/mkdir -p "$3/bin"
echo '#!/bin/sh
if [ "$1" = -c ]; then {version}; else {pip}; fi' > "$3/bin/python"
/bin/chmod +x "$3/bin/python"
"#
    );
    let file = folder.join(format!("python3.{minor}"));
    std::fs::write(&file, text).unwrap();
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Installs with the interpreters of a folder alone.
fn install(sandbox: &Sandbox, folder: &Path) -> Ended {
    let mut command = sandbox.command(&["oracles", "install"]);
    Ended::new(command.env("PATH", folder).env("PYENV_ROOT", folder).output().unwrap())
}

/// The minor version of the environment's Python.
fn minor(sandbox: &Sandbox) -> String {
    let output = std::process::Command::new(sandbox.path("target/oracles/venv/bin/python")).arg("-c").output().unwrap();
    String::from_utf8(output.stdout).unwrap().split(' ').nth(1).unwrap().to_owned()
}

const LACKS: &str = "echo ERROR: No matching distribution found for dartpy >&2; exit 1";

#[test]
fn the_newest_python_that_has_all_packages_is_taken() {
    let sandbox = Sandbox::new();
    let folder = sandbox.path("pythons");
    std::fs::create_dir(&folder).unwrap();
    for (minor, pip) in [(9, "exit 0"), (11, "exit 0"), (12, "exit 0"), (14, LACKS)] {
        interpreter(&folder, minor, pip);
    }
    install(&sandbox, &folder).expect(0, &["passed over: Python 3.14.0", "No matching distribution found for dartpy", "installed the"]);
    assert_eq!(minor(&sandbox), "12");
    // What is installed stays as it is when a newer one appears, also where other packages are asked for.
    interpreter(&folder, 13, "exit 0");
    install(&sandbox, &folder).expect(0, &["are installed in"]);
    std::fs::write(sandbox.path("target/oracles/installed"), "other packages").unwrap();
    install(&sandbox, &folder).expect(0, &["installed the"]);
    assert_eq!(minor(&sandbox), "12");
}

#[test]
fn with_the_oldest_python_alone_the_engines_are_installed() {
    let sandbox = Sandbox::new();
    let folder = sandbox.path("pythons");
    std::fs::create_dir(&folder).unwrap();
    interpreter(&folder, 10, "exit 0");
    install(&sandbox, &folder).expect(3, &["no python3 of version 3.11 or later", "recorded answers"]);
    interpreter(&folder, 11, "exit 0");
    install(&sandbox, &folder).expect(0, &["installed the"]);
    assert_eq!(minor(&sandbox), "11");
}

/// Each is named with its reason, and the next try begins with the newest again.
#[test]
fn where_none_has_all_packages_each_is_named() {
    let sandbox = Sandbox::new();
    let folder = sandbox.path("pythons");
    std::fs::create_dir(&folder).unwrap();
    for minor in [11, 12] {
        interpreter(&folder, minor, LACKS);
    }
    let named = ["Python 3.12.0: ", "Python 3.11.0: ", "No matching distribution found for dartpy"];
    install(&sandbox, &folder).expect(3, &named);
    interpreter(&folder, 12, "exit 0");
    install(&sandbox, &folder).expect(0, &["installed the"]);
    assert_eq!(minor(&sandbox), "12");
}
