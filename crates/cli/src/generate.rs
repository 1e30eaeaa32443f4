//! `featherbench gen`: writes the description of a robot.

use crate::args::GenArgs;
use crate::fail::Fail;
use crate::problems;
use formats::urdf::{Base, Options};
use model::Description;
use model::generate::Family;

/// Generates or imports a robot and writes its description.
pub fn generate(args: &GenArgs) -> Result<(), Fail> {
    let description = match (&args.file, args.family.as_str()) {
        (Some(file), "urdf") => {
            let base = if args.floating { Base::Floating } else { Base::Fixed };
            let options = Options { base, independent_mimics: args.independent_mimics, allow_massless: args.allow_massless };
            let (description, notes) = problems::import(file, &options)?;
            notes.iter().for_each(|note| eprintln!("note: {}: {note}", file.display()));
            description
        }
        (_, spec) if spec.contains(':') => {
            let generated = Family::parse(spec).and_then(|family| family.generate());
            generated.map_err(|error| Fail::input(error.to_string()))?
        }
        _ => family(args)?,
    };
    description.warnings().iter().for_each(|warning| eprintln!("warning: {warning}"));
    match &args.out {
        Some(path) => {
            formats::neutral::write(&description, path).map_err(|error| Fail::input(error.to_string()))?;
            eprintln!("{}: {} ({} bodies, {} dofs)", path.display(), description.name, description.bodies.len(), description.nv());
        }
        None => print!("{}", formats::neutral::to_string(&description).map_err(|error| Fail::input(error.to_string()))?),
    }
    Ok(())
}

fn family(args: &GenArgs) -> Result<Description, Fail> {
    let mut parameters: Vec<(String, String)> = Vec::new();
    for pair in &args.parameters {
        let (key, value) = pair.split_once('=').ok_or_else(|| Fail::input(format!("--set {pair}: give key=value")))?;
        parameters.push((key.into(), value.into()));
    }
    parameters.extend(args.n.map(|n| ("n".into(), n.to_string())));
    parameters.extend(args.seed.map(|seed| ("seed".into(), seed.to_string())));
    let given = parameters.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    let generated = Family::from_parameters(&args.family, given).and_then(|family| family.generate());
    generated.map_err(|error| Fail::input(error.to_string()))
}
