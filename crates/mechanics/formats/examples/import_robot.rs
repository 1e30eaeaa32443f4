//! Converts a URDF file into a neutral description file with its provenance: the files of `datasets/models` were made so (see its README).
//!
//! ```text
//! cargo run -p featherbench-formats --example import_robot -- robot.urdf out.json --name NAME --base fixed|floating
//!     --source "package, version, file" --licence SPDX --header "…" --readme "…" [--allow-massless] [--independent-mimics]
//! ```

use featherbench_formats::{neutral, urdf};
use featherbench_model::{Description, Model, Provenance};
use std::error::Error;
use std::process::ExitCode;

const USAGE: &str = "usage: import_robot URDF OUT --name NAME --base fixed|floating --source TEXT --licence SPDX --header TEXT --readme TEXT \
                     [--allow-massless] [--independent-mimics]";

fn main() -> ExitCode {
    match run(std::env::args().skip(1).collect()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(mut arguments: Vec<String>) -> Result<(), Box<dyn Error>> {
    let mut flag = |name: &str| {
        let before = arguments.len();
        arguments.retain(|argument| argument != name);
        arguments.len() < before
    };
    let mut options = urdf::Options {
        allow_massless: flag("--allow-massless"),
        independent_mimics: flag("--independent-mimics"),
        ..urdf::Options::default()
    };
    let mut value = |name: &str| -> Result<String, Box<dyn Error>> {
        let place = arguments.iter().position(|argument| argument == name).ok_or_else(|| format!("{name} is missing\n{USAGE}"))?;
        if place + 1 >= arguments.len() {
            return Err(format!("{name} has no value\n{USAGE}").into());
        }
        Ok(arguments.drain(place..place + 2).nth(1).unwrap_or_default())
    };
    options.base = match value("--base")?.as_str() {
        "fixed" => urdf::Base::Fixed,
        "floating" => urdf::Base::Floating,
        other => return Err(format!("--base {other}: it is fixed or floating").into()),
    };
    let name = value("--name")?;
    let provenance = Provenance {
        source: value("--source")?,
        licence: value("--licence")?,
        header: value("--header")?,
        readme: value("--readme")?,
        notes: Vec::new(),
    };
    let [input, output] = arguments.as_slice() else {
        return Err(USAGE.into());
    };

    let (description, notes) = urdf::read(input, &options)?;
    let mut changes = vec![format!("read as {} base, gravity (0, 0, -9.81); fixed joints merged", base_word(options.base))];
    changes.extend(notes.iter().map(ToString::to_string));
    let description = Description { name, provenance: Some(Provenance { notes: changes, ..provenance }), ..description };
    neutral::write(&description, output)?;

    let model = Model::<f64>::build(&description)?;
    println!("{}: nq {}, nv {}, {} bodies", description.name, description.nq(), description.nv(), description.bodies.len());
    model.warnings.iter().for_each(|warning| println!("  warning: {warning}"));
    Ok(())
}

fn base_word(base: urdf::Base) -> &'static str {
    match base {
        urdf::Base::Fixed => "fixed",
        urdf::Base::Floating => "floating",
    }
}
