//! A robot as it comes to a run: its description, and what else its source says of it.

use crate::{Engine, FileBase, FileContent, HarnessError, ImportNote, NoAnswer, RobotFile};
use featherbench_formats::urdf::{Base, Options, Parsed};
use featherbench_model::{Description, Warning};
use featherbench_results::ModelOrigin;

/// A robot as its description file, its generator or its own file describes it.
pub struct RobotSource {
    /// The description.
    pub description: Description,
    /// Where it comes from.
    pub origin: ModelOrigin,
    /// What the reader of its file normalised.
    pub warnings: Vec<Warning>,
    /// Configurations that its file names.
    pub keyframes: Vec<Vec<f64>>,
    /// What was left out of its file or altered.
    pub notes: Vec<String>,
    /// Those notes, and others, without which engines cannot be compared on it.
    pub remarks: Vec<String>,
    /// Its own file.
    pub file: Option<RobotFile>,
}

impl RobotSource {
    /// A robot without a file of its own.
    pub fn new(description: Description, origin: ModelOrigin) -> Self {
        Self { description, origin, warnings: Vec::new(), keyframes: Vec::new(), notes: Vec::new(), remarks: Vec::new(), file: None }
    }

    /// The reference reading of a URDF: ours. As engines read such files by default: mimics move on their own, and a body without mass is
    /// known by its warning.
    ///
    /// # Errors
    /// [`HarnessError::Urdf`], naming file, line and column.
    pub fn urdf(content: &FileContent, base: FileBase) -> Result<Self, HarnessError> {
        let path = std::path::absolute(&content.path).map_err(|source| HarnessError::io(&content.path, source))?;
        let name = path.display().to_string();
        // A bad value is a finding about the file, and the rest is compared: zeros stand where its characters are, so that places stay.
        let as_written = Parsed::of(&content.bytes, &name)?;
        let bad = as_written.bad_values();
        let mut repaired = Vec::new();
        let parsed = if bad.is_empty() {
            as_written
        } else {
            repaired.clone_from(&content.bytes);
            bad.iter().for_each(|value| repaired[value.range.clone()].fill(b'0'));
            Parsed::of(&repaired, &name)?
        };
        let root = if base == FileBase::Free { Base::Floating } else { Base::Fixed };
        let (description, notes) = parsed.import(&Options { base: root, independent_mimics: true, allow_massless: true })?;
        let file = content.file_of_urdf(&parsed, base)?;
        let bad = bad.into_iter().map(|value| value.text);
        let told: Vec<String> = bad.clone().chain(notes.iter().map(ToString::to_string)).collect();
        Ok(Self {
            remarks: bad.chain(told.iter().filter(|note| note.contains("mimic")).cloned()).collect(),
            notes: told,
            warnings: notes.into_iter().filter_map(|note| note.warning).collect(),
            ..Self::of_file(description, file)
        })
    }

    /// The reference reading of a file that is no URDF: that of [`FileFormat::reference`](crate::FileFormat::reference), with the file's own
    /// inertias where that engine refuses those.
    ///
    /// # Errors
    /// [`HarnessError::Config`] when the compiler does not read it.
    pub fn compiled(file: RobotFile, compiler: &dyn Engine) -> Result<Self, HarnessError> {
        let bad = |message| HarnessError::Config { path: file.path.clone(), message };
        let refused = |no_answer: NoAnswer| bad(format!("{} does not read it: {no_answer}", compiler.identity().name));
        let mut reading = compiler.read(&file).map_err(refused)?;
        if let Some(written) = reading.written.take() {
            reading.description = written.canonical().map_err(|error| bad(error.to_string()))?;
        }
        let told = |note: &ImportNote| {
            let left = if note.cause == "not_compared" { "left out: " } else { "" };
            format!("{left}{}{}", note.about.as_ref().map_or_else(String::new, |about| format!("{about}: ")), note.text)
        };
        let armature = reading.notes.iter().filter(|note| note.cause.ends_with("_armature"));
        let bad = reading.notes.iter().filter(|note| note.cause == "bad_value");
        let bad = bad.map(|note| note.text.split("; this engine").next().unwrap_or_default().to_owned());
        let armature = armature.map(|note| format!("'{}': {}", note.about.as_deref().unwrap_or_default(), note.text));
        let left: Vec<&str> = reading.notes.iter().filter(|note| note.cause == "not_compared").map(|note| note.text.as_str()).collect();
        let left = (!left.is_empty()).then(|| left.join("; "));
        let loops = reading.description.warnings().into_iter().filter(|warning| matches!(warning, Warning::Loops { .. }));
        Ok(Self {
            notes: reading.notes.iter().map(told).collect(),
            remarks: bad.chain(armature).chain(loops.map(|warning| warning.to_string())).chain(left).collect(),
            keyframes: reading.keyframes,
            ..Self::of_file(reading.description, file)
        })
    }

    /// A robot by its file's name: one package holds several variants of one robot's name.
    fn of_file(mut description: Description, file: RobotFile) -> Self {
        if let Some(stem) = file.path.file_stem() {
            description.name = stem.to_string_lossy().into_owned();
        }
        Self { file: Some(file), ..Self::new(description, ModelOrigin::Robot) }
    }
}
