//! `featherbench gen`: writes a robot.

use crate::args::{Format, GenArgs};
use crate::fail::Fail;
use crate::message::{self, tell};
use crate::root::Root;
use crate::{oracles, robots};
use featherbench_bench::{FileBase, FileContent, FileFormat, RobotSource};
use featherbench_constrained::{Mechanism, Mobility, gruebler_in_plane};
use featherbench_formats::OnLoss;
use featherbench_formats::neutral::{self, NeutralError};
use featherbench_formats::urdf::{Base, Options};
use featherbench_model::{Description, neutral as at_home};
use featherbench_robots::Family;
use std::path::Path;

/// Generates or imports a robot and writes it.
pub fn generate(root: &Root, args: &GenArgs) -> Result<(), Fail> {
    let description = match (&args.file, args.family.as_str()) {
        (Some(file), "urdf") => {
            let base = if args.floating { Base::Floating } else { Base::Fixed };
            let options = Options { base, independent_mimics: args.independent_mimics, allow_massless: args.allow_massless };
            let (description, notes) = robots::import(file, &options)?;
            notes.iter().for_each(|note| tell!("note: {}: {note}", file.display()));
            description
        }
        (Some(file), "mjcf" | "sdf" | "usd") => compiled(root, &FileContent::recognised(file)?, args.floating)?,
        (Some(file), "neutral") => robots::read_model(file)?,
        (_, spec) if spec.contains(':') => {
            let generated = Family::parse(spec).and_then(|family| family.generate());
            generated.map_err(|error| Fail::input(error.to_string()))?
        }
        _ => family(args)?,
    };
    description.warnings().iter().for_each(|warning| tell!("warning: {warning}"));
    if !description.loops.is_empty() {
        tell!("loops: {}", mobility(&description)?);
    }
    match exported(&description, args)? {
        Some(text) => match &args.out {
            Some(path) => ::featherbench_results::atomic_write(path, text.as_bytes())?,
            None => message::text(&text),
        },
        None => write(&description, args.out.as_deref()).map_err(|error| Fail::input(error.to_string()))?,
    }
    if let Some(path) = &args.out {
        tell!("{}: {} ({} bodies, {} dofs)", path.display(), description.name, description.bodies.len(), description.nv());
    }
    Ok(())
}

/// What the loops of a robot leave free: by count, and in truth at the neutral configuration.
fn mobility(description: &Description) -> Result<String, Fail> {
    let bad = |error: &dyn std::error::Error| Fail::input(format!("{}: {error}", description.name));
    let Mechanism { graph, model, constraints } = Mechanism::of(description).map_err(|error| bad(&error))?;
    let in_plane = gruebler_in_plane(description).map_or_else(String::new, |count| format!(" (in a plane {count})"));
    let counted = format!("{} closed by joints; Grübler's count {}{in_plane}", graph.loops(), graph.gruebler(6));
    // At half a turn an orientation has no residual: the count is told all the same.
    Ok(match Mobility::at(&model, &constraints, &at_home(&model.topology)) {
        Ok(found) => format!(
            "{counted}; at the neutral configuration {} rows of rank {}, {} degrees of freedom of {}, largest residual {:.1e}",
            constraints.rows(),
            found.rank,
            found.freedom(),
            found.dofs,
            found.residual
        ),
        Err(error) => format!("{counted}; at the neutral configuration: {error}"),
    })
}

/// Writes a description file, piece by piece: that of a million links has some hundred MB.
pub fn write(description: &Description, path: Option<&Path>) -> Result<(), NeutralError> {
    match path {
        Some(path) => {
            if let Some(folder) = path.parent() {
                // If there is none afterwards, the error of the file says so.
                let _ = std::fs::create_dir_all(folder);
            }
            neutral::write(description, path)
        }
        None => neutral::write_to(description, &mut message::Output, "standard output"),
    }
}

/// What the reference engine of a format makes of a file, with its notes. A bad file is told before any engine is started.
pub fn compiled(root: &Root, content: &FileContent, floating: bool) -> Result<Description, Fail> {
    let (path, form) = (&content.path, content.format.name().to_uppercase());
    if content.format == FileFormat::Urdf {
        return Err(Fail::input(format!("{}: this is a URDF; read it by `featherbench gen urdf --file …`", path.display())));
    }
    if floating {
        let advice = if content.format == FileFormat::Mjcf { "; give its root body a <freejoint/>" } else { "" };
        return Err(Fail::input(format!("--floating: {form} says itself what floats{advice}")));
    }
    let described = oracles::described(root)?;
    let engine = described.get(content.format.reference()).map_err(Fail::input)?;
    if engine.is_python() {
        oracles::python(root).ok_or_else(|| Fail::Missing {
            message: format!("{}: {} reads {form} files, and it is not installed", path.display(), engine.title),
            advice: "install the reference engines by `featherbench oracles install`".into(),
        })?;
    }
    let source = RobotSource::compiled(content.file(FileBase::Fixed)?, &robots::reference(root, content.format)?)?;
    source.notes.iter().for_each(|note| tell!("note: {}: {note}", path.display()));
    if !source.keyframes.is_empty() {
        let count = source.keyframes.len();
        tell!("note: {}: keyframes, which a description does not hold (`compare` takes them as states): {count}", path.display());
    }
    Ok(source.description)
}

/// The robot as a URDF, MJCF or USD if one is asked for, with a note on everything that was left out.
fn exported(description: &Description, args: &GenArgs) -> Result<Option<String>, Fail> {
    let by_ending = args.out.as_deref().map_or(Format::Neutral, by_ending);
    written(description, args.format.unwrap_or(by_ending), args.lossy)
}

/// The format that a file's ending asks for.
pub fn by_ending(path: &Path) -> Format {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("urdf") => Format::Urdf,
        Some("xml" | "mjcf") => Format::Mjcf,
        Some("usda") => Format::Usd,
        _ => Format::Neutral,
    }
}

/// The robot's text in a format, `None` for the neutral one.
pub fn written(description: &Description, format: Format, lossy: bool) -> Result<Option<String>, Fail> {
    let on_loss = if lossy { OnLoss::LeaveOut } else { OnLoss::Refuse };
    let exported = match format {
        Format::Neutral => return Ok(None),
        Format::Urdf => featherbench_formats::urdf::to_string(description, on_loss),
        Format::Mjcf => featherbench_formats::mjcf::to_string(description, on_loss),
        Format::Usd => featherbench_formats::usd::to_string(description, on_loss),
    };
    let (text, losses) = exported.map_err(|error| {
        let way_out = if error.can_be_left_out() { "\n(--lossy leaves this out)" } else { "" };
        Fail::input(format!("{error}{way_out}"))
    })?;
    losses.iter().for_each(|loss| tell!("left out: {loss}"));
    Ok(Some(text))
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
