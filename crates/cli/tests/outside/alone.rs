//! Engines with an environment of their own, if they are installed.

use super::native::{self, PATIENT};
use super::{Outcome, Unpassed, oracle_command};
use crate::support::{Ended, project};
use featherbench_bench::{Engine, Engines, Quantity, Robot};
use featherbench_engines::Oracle;
use featherbench_results::{Base, ModelOrigin};
use std::ffi::OsString;
use std::process::Command;

/// The command of an engine's oracle. Those of the night are asked with FEATHERBENCH_NIGHTLY alone.
pub fn command(engine: &str) -> Result<Vec<OsString>, Unpassed> {
    let engines = Engines::read(&project().join("oracles/engines.toml")).unwrap();
    let night = engines.iter().any(|described| described.name == engine && described.night);
    if night && std::env::var_os("FEATHERBENCH_NIGHTLY").is_none() {
        return Err(Unpassed::Nightly("FEATHERBENCH_NIGHTLY is not set".into()));
    }
    let folder = project().join("target/oracles").join(engine);
    let python = folder.join("venv/bin/python");
    let installed = python.exists() && folder.join("installed").exists();
    let reason = format!("{engine} is not installed (`featherbench oracles install {engine}`)");
    let skipped = || if night { Unpassed::Nightly(reason) } else { Unpassed::Skipped(reason) };
    if installed { Ok(oracle_command(&python, engine)) } else { Err(skipped()) }
}

/// A test that asks an engine.
pub fn with(engine: &str, test: fn(&Oracle)) -> Outcome {
    let command = command(engine)?;
    test(&Oracle::start(command, PATIENT).unwrap());
    Ok(())
}

/// It conforms to the protocol, and says these words. Some engines compile when they are asked, which takes longer than most answers.
pub fn conforms(engine: &str, words: &[&str]) -> Outcome {
    let command = command(engine)?;
    let mut check = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    check.current_dir(project()).args(["oracles", "check", "--timeout", "600"]).args(command);
    Ended::new(check.output().unwrap()).expect(0, &[&["conforms"], words].concat());
    Ok(())
}

/// iDynTree conforms but for its Coriolis matrix of robots that float.
pub fn idyntree_conforms() -> Outcome {
    let command = command("idyntree")?;
    let mut check = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    check.current_dir(project()).args(["oracles", "check", "--timeout", "600"]).args(command);
    let words = ["error: 1 of ", "coriolis_matrix by coriolis_and_mass_matrices: 2 of 4 robots differ", "iDynTree has no armature"];
    Ended::new(check.output().unwrap()).expect(1, &words);
    Ok(())
}

/// It agrees on chains, trees and arms, fixed and floating, with gravity of any direction; in `f32` to as many times its rounding.
pub fn agrees(engine: &Oracle) {
    let words = [
        "chain-spatial-5",
        "binary_tree:depth=3",
        "joints:kind=revolute,base=fixed,armature=false",
        "joints:kind=prismatic,base=fixed,armature=false",
        "joints:kind=revolute,base=free,armature=false",
        "ur5",
        "anymal_c",
    ];
    let mut asked = 0;
    let rounding = if engine.identity().scalar() == "f32" { f64::from(f32::EPSILON) / f64::EPSILON } else { 1.0 };
    for words in words {
        let upright = native::robot(words, 12);
        for gravity in [upright.description.gravity, [1.0, -2.0, -3.0]] {
            let mut description = upright.description.clone();
            description.gravity = gravity;
            let robot = Robot::new(&description, words, ModelOrigin::Generated, 12, 1).unwrap();
            let floats = robot.properties().base == Base::Free;
            // What an engine does not offer of a robot is skipped by its reason; `oracles check` lists it. iDynTree's Coriolis matrix of a
            // floating robot is a known deviation.
            let found = native::compare(engine, &robot, if floats { &["coriolis_and_mass_matrices"] } else { &[] });
            let answered = found.iter().filter(|found| found.share.is_ok()).count();
            // Some have a fixed base alone.
            assert!(answered >= 3 || answered == 0 && floats, "{words}: {found:?}");
            asked += usize::from(answered > 0);
            for native::Found { quantity, method, share } in found {
                let Ok(share) = share else { continue };
                assert!(
                    share <= rounding,
                    "{words} {gravity:?} {} by {method}: {share} of its tolerance, at most {rounding}",
                    quantity.name()
                );
            }
        }
    }
    assert!(asked >= 6, "{asked} robots were answered");
}

/// iDynTree's rate of M of a floating robot is not dM/dt, and so its Coriolis matrix is another one. Of a fixed base both are right.
pub fn idyntree_has_another_coriolis_matrix(engine: &Oracle) {
    for (base, deviates) in [("free", true), ("fixed", false)] {
        let robot = native::robot(&format!("joints:kind=revolute,base={base},armature=false"), 12);
        let found = native::compare(engine, &robot, &[]);
        let coriolis = found.iter().find(|found| found.quantity == Quantity::CoriolisMatrix).unwrap();
        let share = coriolis.share.clone().unwrap();
        assert_eq!(share > 1e9, deviates, "{base}: {share} of its tolerance");
        assert!(deviates || share <= 1.0, "{base}: {share} of its tolerance");
    }
}
