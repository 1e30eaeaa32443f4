//! `compare --fix`: a copy of the file in which what its engines disagree about is said so that they agree.
//!
//! | what the engines do | what the copy has |
//! |---|---|
//! | repair or refuse an inertia that no mass distribution has | the nearest one that some has, with its distance |
//! | drop or keep an inertia without a mass | none |
//! | compute mass and inertia of a link that says neither, or take a default | a mass of zero |
//! | lose or transpose the rotation of an inertial | the inertia in the axes of the link |
//! | leave out products of inertia | the inertia in its principal axes |
//!
//! The copy is compared again: that shows what is mended. All else of the file stays, comments and blanks too.

use super::outcome::params;
use crate::fail::Fail;
use crate::message::{say, tell};
use ::featherbench_results::{Row, atomic_write};
use featherbench_bench::{FileFormat, Robot, WATER};
use featherbench_formats::urdf::{FileInertial, FileLink, Parsed};
use featherbench_model::Description;
use featherbench_report::numbers::count;
use std::path::Path;

/// A link without a mass.
const NOTHING: FileInertial =
    FileInertial { mass: 0.0, com: [0.0; 3], rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], inertia: [0.0; 6] };

/// Writes the copy of the one file; whether anything was mended.
pub fn write(robots: &[Robot], records: &[Row], out: &Path) -> Result<bool, Fail> {
    let [robot] = robots else { return Err(Fail::input("--fix: give one file".into())) };
    let Some(file) = robot.file.as_ref().filter(|file| file.format == FileFormat::Urdf) else {
        return Err(Fail::input("--fix mends URDF files; of others the report says what to set after loading".into()));
    };
    let text = featherbench_formats::urdf::content(&file.path).map_err(|error| Fail::input(error.to_string()))?;
    let name = file.path.display().to_string();
    let parsed = Parsed::of(text.as_bytes(), &name).map_err(|error| Fail::input(error.to_string()))?;
    let causes = |link: &FileLink| causes(&robot.description, records, &link.name);
    let changes: Vec<(String, FileInertial, String)> =
        parsed.links(WATER).iter().filter_map(|link| change(link, &causes(link)).map(|(to, why)| (link.name.clone(), to, why))).collect();
    let inertials: Vec<(String, FileInertial)> = changes.iter().map(|(link, to, _)| (link.clone(), *to)).collect();
    let (text, mended) = parsed.with_inertials(&inertials);
    for one in &mended {
        let why = changes.iter().find(|(link, ..)| *link == one.link).map_or("", |(.., why)| why.as_str());
        say!("{name}:{}: link '{}': {why}\n  {}", one.line, one.link, one.element);
    }
    atomic_write(out, text.as_bytes())?;
    tell!("{}: {} changed", out.display(), count(mended.len(), "inertial"));
    Ok(!mended.is_empty())
}

/// The causes of the differences of the body that has a link.
fn causes(robot: &Description, records: &[Row], link: &str) -> Vec<String> {
    let carrier = robot.frames.iter().find(|frame| frame.name == link).and_then(|frame| frame.body);
    let body = carrier.map_or(link, |body| robot.bodies[body].name.as_str());
    let rows = records.iter().filter(|row| row.study == "import" && row.metric == "difference" && row.body == body);
    rows.filter_map(|row| params(row)["cause"].as_str().map(str::to_owned)).collect()
}

/// What a link gets in place of its inertial, and why.
fn change(link: &FileLink, causes: &[String]) -> Option<(FileInertial, String)> {
    let has = |names: &[&str]| causes.iter().any(|cause| names.contains(&cause.as_str()));
    let Some(given) = link.inertial else {
        return has(&["geometry", "default_inertia"]).then(|| (NOTHING, "it says no mass, and engines take one: now it says zero".into()));
    };
    if let Some((nearest, distance)) = given.nearest_consistent() {
        let far = format!("no mass distribution has this inertia; the nearest that one has is {:.2} % away", 100.0 * distance);
        return Some((nearest, far));
    }
    if given.mass == 0.0 && given.inertia != [0.0; 6] && has(&["massless_link", "dropped", "edited", "number"]) {
        return Some((NOTHING, "an inertia without a mass, which engines keep or drop: now there is none".into()));
    }
    if has(&["inertial_rotation_lost", "transposed"]) && given.rotation != NOTHING.rotation {
        return Some((given.in_axes_of_link(), "the inertia in the axes of the link".into()));
    }
    if has(&["off_diagonals"]) {
        return Some((given.in_principal_axes(), "the inertia in its principal axes".into()));
    }
    None
}
