//! A new engine in Python: a folder in the package of the oracles and one table in `engines.toml`.

use super::{Outcome, copy_python, installed_python};
use crate::support::{Sandbox, project};
use std::os::unix::fs::symlink;

/// The engine of `chain.py`. Its package is installed for all oracles.
const TABLE: &str = r#"
[chain]
title = "Chain"
package = { name = "numpy", version = "2.4.6", released = "2026-01-31", licence = "BSD-3-Clause", home = "https://numpy.org" }
start = { kind = "python", module = "chain" }
"#;

/// It is listed, it answers, a suite asks it, and its name is taken.
pub fn by_folder_and_table() -> Outcome {
    installed_python()?;
    let sandbox = Sandbox::new();
    let (theirs, ours) = (project().join("oracles"), sandbox.path("oracles"));
    std::fs::remove_file(&ours).unwrap();
    std::fs::create_dir_all(sandbox.path("target")).unwrap();
    symlink(project().join("target/oracles"), sandbox.path("target/oracles")).unwrap();
    copy_python(&theirs.join("featherbench_oracles"), &ours.join("featherbench_oracles"));
    for file in ["requirements.txt", "packages.txt", "conventions.toml"] {
        symlink(theirs.join(file), ours.join(file)).unwrap();
    }
    let module = ours.join("featherbench_oracles/chain");
    std::fs::create_dir(&module).unwrap();
    std::fs::write(module.join("__init__.py"), "").unwrap();
    std::fs::copy(theirs.join("chain.py"), module.join("__main__.py")).unwrap();
    let engines = std::fs::read_to_string(theirs.join("engines.toml")).unwrap();
    std::fs::write(ours.join("engines.toml"), engines + TABLE).unwrap();

    sandbox.run(&["oracles", "status"]).expect(0, &["chain            1", "mujoco"]);
    sandbox
        .run(&["list", "--suite", "smoke"])
        .expect(0, &["rapier, dynibo, faer, nalgebra, adam, idyntree, mujoco_warp, newton, mjx, pybullet, exudyn, simbody, jaxsim, frax, sapien, openusd, usd_converters, clarabel, soromox, pyelastica, chain"]);
    sandbox.run(&["run", "--suite", "smoke", "--engine", "chain=sh", "--out", "out"]).expect(2, &["the name 'chain' is taken"]);
    let suite = "about = \"one engine\"\nseed = 1\nstates = 4\nengines = [\"chain\"]\n[[robot]]\nmodel = \"chain-planar-2\"\nfamily = \"chain\"\n\
                 [agreement]\n";
    sandbox.write("one.toml", suite);
    sandbox.run(&["run", "--suite", "one.toml", "--filter", "agreement/", "--out", "out"]).expect(0, &["report:"]);
    let rows = std::fs::read_to_string(sandbox.path("out/rows.csv")).unwrap();
    assert!(rows.lines().any(|row| row.contains(",chain,1,") && row.contains(",id,") && row.contains(",pass,")), "{rows}");
    Ok(())
}
