//! The catalogue of a run's failures, with the engines: known deviations become robots of few bodies, whose programs print their errors.

use super::Outcome;
use crate::support::{Ended, project};
use featherbench_reduction::Catalogue;
use std::path::Path;
use std::process::Command;

/// Runs of a second, each with the deviation that every seed of it shows, by the name of its line.
const RUNS: [(&str, &str, &str); 3] = [
    ("joints", "agreement/joints-cylindrical-free-armature/(featherbench|pinocchio)/kinetic_energy/", "pinocchio-kinetic-energy-armature"),
    ("derivatives", "derivatives/joints-universal-fixed/pinocchio/id_d", "pinocchio-moving-subspace"),
    ("default", "agreement/binary-tree-4/(featherbench|mujoco)/(mass_matrix|fd)/", "mujoco-light-links"),
];
/// Measures that the programs print, too.
const PRINTED: [&str; 5] = ["scaled", "true", "backward", "forward", "true_forward"];
/// The largest factor between an error and what a program prints. Its measure is that of the study, in the engine's own coordinates, where the
/// magnitudes of a turned joint are up to √3 larger; a derivative's entries have no weights there.
const FACTOR: f64 = 10.0;
/// The most bodies of a reduced robot.
const FEW: usize = 5;

/// Known deviations are reduced, and their programs show them.
pub fn programs_print_their_errors(python: &Path) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let featherbench = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_featherbench"));
        Ended::new(command.current_dir(project()).args(arguments).env("NO_COLOR", "1").output().unwrap())
    };
    for (suite, filter, name) in RUNS {
        let run = folder.path().join(suite);
        let out = run.to_str().unwrap();
        featherbench(&["run", "--suite", suite, "--live", "--no-timing", "--filter", filter, "--out", out]).expect(0, &["report:"]);
        featherbench(&["reduce", out]).expect(0, &[name, "cases:"]);
        let catalogue = Catalogue::read(&run.join("catalogue")).unwrap().unwrap();
        assert!(catalogue.lines.len() > 60, "{suite}: a line for each known deviation");
        let mut shown = Vec::new();
        for line in &catalogue.lines {
            let Some(case) = line.reduction() else { continue };
            assert!(case.reduced_bodies <= FEW, "{line:?}");
            let place = run.join("catalogue").join(&line.name);
            assert!(case.files.iter().all(|file| place.join(file).is_file()), "{line:?}");
            let Some(error) = case.reduced_error.filter(|_| PRINTED.contains(&case.metric.as_str())) else { continue };
            if line.engine == "featherbench" || !case.files.iter().any(|file| file == "reproduce.py") {
                continue;
            }
            let told = Command::new(python).arg(place.join("reproduce.py")).output().unwrap();
            assert!(told.status.success(), "{}: {}", line.name, String::from_utf8_lossy(&told.stderr));
            let printed: f64 = String::from_utf8_lossy(&told.stdout).trim().parse().unwrap();
            assert!((error / FACTOR..=error * FACTOR).contains(&printed), "{}: {printed:e} is printed, {error:e} was found", line.name);
            shown.push(line.name.as_str());
        }
        assert!(shown.contains(&name), "{suite}: {shown:?}");
        featherbench(&["report", out]).expect(0, &["report:"]);
        let page = std::fs::read_to_string(run.join("sections/catalogue.html")).unwrap();
        let link = format!("catalogue/{name}/reproduce.py");
        assert!(page.contains(&link) && run.join(link).is_file(), "the report has the catalogue");
    }
    Ok(())
}
