//! A round trip: a file is written again by every writer, and what is read from each copy is compared with what is read from the file.

use super::other_file::OtherFile;
use super::{Source, compiled};
use crate::fail::Fail;
use crate::message::tell;
use featherbench_bench::{Engine, Rewritten, Robot};
use featherbench_formats::{OnLoss, mjcf, urdf, usd};
use featherbench_model::Description;
use std::path::{Path, PathBuf};

/// The folder of the copies, in that of the run.
const FOLDER: &str = "written";

/// Where the copies are made. A run begins in an empty folder, so it is beside it, in the same file system.
pub fn beside(run: &Path) -> PathBuf {
    let name = run.file_name().unwrap_or_default().to_string_lossy();
    run.with_file_name(format!(".{name}.{FOLDER}.{}", std::process::id()))
}

/// Moves the copies into the folder of the run.
pub fn keep(run: &Path) -> Result<(), Fail> {
    let (from, to) = (beside(run), run.join(FOLDER));
    std::fs::rename(&from, &to).map_err(|error| Fail::input(format!("{}: {error}", to.display())))
}

/// The copies of each robot's file. A writer that fails is told, and so is what ours leave out.
pub fn written(robots: &[Robot], engines: &[Box<dyn Engine>], folder: &Path) -> Result<Vec<OtherFile>, Fail> {
    let mut copies = Vec::new();
    for (k, robot) in robots.iter().enumerate() {
        let Some(file) = &robot.file else { continue };
        let into = folder.join(k.to_string());
        std::fs::create_dir_all(&into).map_err(|error| Fail::input(format!("{}: {error}", into.display())))?;
        let mut all = ours(&robot.description, &into)?;
        for engine in engines {
            match engine.rewrite(file, &into) {
                Ok(written) => all.extend(written),
                Err(reason) => tell!("{} does not write '{}': {reason}", engine.identity().name, robot.name),
            }
        }
        for Rewritten { by, file } in all {
            let copy = file.map_err(Fail::input).and_then(|path| read(&path, engines));
            match copy.map(|copy| OtherFile::of_writer(&by, robot, &copy)) {
                Ok(copy) => copies.extend(copy),
                Err(fail) => tell!("{by} of '{}': {fail}", robot.name),
            }
        }
    }
    Ok(copies)
}

/// What our writers make of a robot. What a format cannot hold is left out.
fn ours(description: &Description, into: &Path) -> Result<Vec<Rewritten>, Fail> {
    let formats = [
        ("our URDF", "ours.urdf", urdf::to_string(description, OnLoss::LeaveOut)),
        ("our MJCF", "ours.xml", mjcf::to_string(description, OnLoss::LeaveOut)),
        ("our USD", "ours.usda", usd::to_string(description, OnLoss::LeaveOut)),
    ];
    let mut all = Vec::new();
    for (by, name, text) in formats {
        let file = match text {
            Ok((text, losses)) => {
                losses.iter().for_each(|loss| tell!("{by} leaves out: {loss}"));
                let path = into.join(name);
                ::featherbench_results::atomic_write(&path, text.as_bytes())?;
                Ok(path)
            }
            Err(error) => Err(error.to_string()),
        };
        all.push(Rewritten { by: by.into(), file });
    }
    Ok(all)
}

/// A copy as its reference reads it.
fn read(path: &Path, engines: &[Box<dyn Engine>]) -> Result<Robot, Fail> {
    let (robot, _) = match Source::open(path, false)? {
        Source::Read(read) => *read,
        Source::Unread(file) => {
            let reference = file.format.reference();
            compiled(file, engines.iter().find(|engine| engine.identity().name == reference).map(AsRef::as_ref))?
        }
    };
    Ok(robot)
}
