//! Files: rows as CSV, and whole runs.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use crate::disk::{atomic_write, atomic_write_with, read_text};
use crate::{COLUMNS, CSV_NAME, Checksums, ColumnType, DRAWINGS_NAME, Dictionary, RATIO, ResultsError, Row, RunInfo, drawing, schema_json};

/// Name of the provenance file in a run's folder.
pub const RUN_NAME: &str = "run.json";
/// Name of the description of the columns in a run's folder.
pub const SCHEMA_NAME: &str = "schema.json";

/// The rows as the text of a CSV file, header first. `path` is the file in errors: the text is meant for it.
///
/// The unit 1 of a pure ratio is written as the word [`RATIO`]. Some readers guess the type of a column from its first rows. They took a
/// column that begins with many `1` for integers, and failed at the first other unit. Quotes do not help against that.
pub fn to_csv(records: &[Row], path: &Path) -> Result<Vec<u8>, ResultsError> {
    check_finite(records, path)?;
    let mut bytes = Vec::new();
    csv_into(records, &mut bytes).map_err(|source| ResultsError::Io { path: path.to_owned(), source })?;
    Ok(bytes)
}

/// Writes rows to a CSV file, in one step. Their text is never in memory as a whole.
pub fn write_csv(path: &Path, records: &[Row]) -> Result<(), ResultsError> {
    check_finite(records, path)?;
    atomic_write_with(path, |file| csv_into(records, file))
}

/// Refuses rows with a number that is not finite.
fn check_finite(records: &[Row], path: &Path) -> Result<(), ResultsError> {
    for (index, record) in records.iter().enumerate() {
        for (name, value) in record.floats() {
            if let Some(value) = value.filter(|value| !value.is_finite()) {
                return Err(ResultsError::NonFinite { path: path.to_owned(), field: format!("{name} of row {}", index + 1), value });
            }
        }
    }
    Ok(())
}

/// Writes the header and the rows.
fn csv_into(records: &[Row], out: &mut (dyn Write + Send)) -> io::Result<()> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    writer.write_record(COLUMNS.iter().map(|column| column.name))?;
    for record in records {
        if record.unit == "1" {
            writer.serialize(Row { unit: RATIO.into(), ..record.clone() })?;
        } else {
            writer.serialize(record)?;
        }
    }
    writer.flush()
}

/// Reads rows from a CSV file. The header must be this version's, every field must have its type, every row all fields, and no pass a value
/// beyond its bound.
pub fn read_csv(path: &Path) -> Result<Vec<Row>, ResultsError> {
    parse_csv(&read_text(path)?, path)
}

/// The rows of a CSV text, by the same rules; `path` is its name in errors.
pub fn parse_csv(text: &str, path: &Path) -> Result<Vec<Row>, ResultsError> {
    let mut reader = csv::ReaderBuilder::new().from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| csv_error(path, &error))?;
    for position in 0..header.len().max(COLUMNS.len()) {
        let found = header.get(position).unwrap_or_default();
        let expected = COLUMNS.get(position).map_or("", |column| column.name);
        if found != expected {
            return Err(ResultsError::Header {
                path: path.to_owned(),
                position: position + 1,
                found: found.into(),
                expected: expected.into(),
            });
        }
    }
    if !text.ends_with('\n') {
        let line = text.lines().count() as u64;
        return Err(ResultsError::Damaged { path: path.to_owned(), line, what: "the file ends in the middle of a row".into() });
    }
    let header = header.clone();
    let mut records = Vec::new();
    let mut raw = csv::StringRecord::new();
    while reader.read_record(&mut raw).map_err(|error| csv_error(path, &error))? {
        let line = raw.position().map_or(0, csv::Position::line);
        let field_error = |column: &str, what| ResultsError::Field { path: path.to_owned(), line, column: column.to_owned(), what };
        if let Some((column, what)) = unknown_word(&raw) {
            return Err(field_error(column, what));
        }
        let mut record: Row = raw.deserialize(Some(&header)).map_err(|error| csv_error(path, &error))?;
        if record.unit == RATIO {
            record.unit = "1".into();
        }
        if let Some((column, what)) = record.contradiction() {
            return Err(field_error(column, what));
        }
        records.push(record);
    }
    Ok(records)
}

/// Writes a run's files into its folder, each in one step: rows, columns, drawings if it has any, `run.json`, and last their checksums. So a
/// folder without checksums is known to be unfinished.
///
/// # Errors
/// [`ResultsError`]; the folder then has no valid checksums of the earlier files.
pub fn write_run(folder: &Path, run: &RunInfo, records: &[Row]) -> Result<(), ResultsError> {
    write_run_with(folder, run, records, &Dictionary::default(), &[])
}

/// The same, with what the names in the rows mean, and with the checksums of further files of the run that are in the folder already.
///
/// # Errors
/// As [`write_run`].
pub fn write_run_with(folder: &Path, run: &RunInfo, records: &[Row], dictionary: &Dictionary, more: &[&str]) -> Result<(), ResultsError> {
    write_csv(&folder.join(CSV_NAME), records)?;
    atomic_write(&folder.join(SCHEMA_NAME), schema_json(dictionary).as_bytes())?;
    let drawn: &[&str] = if run.drawings.is_empty() { &[] } else { &[DRAWINGS_NAME] };
    for name in drawn {
        let path = folder.join(name);
        atomic_write(&path, drawing::drawings_to_text(&run.drawings, &path)?.as_bytes())?;
    }
    let names = [&[CSV_NAME, SCHEMA_NAME, RUN_NAME], drawn, more].concat();
    let files = names.iter().map(|&name| name.to_owned()).collect();
    RunInfo { rows: records.len() as u64, files, ..run.clone() }.write(&folder.join(RUN_NAME))?;
    Checksums::of(folder, &names)?.write()
}

/// Reads a run's folder back.
///
/// # Errors
/// [`ResultsError`]: every file of the run must have its checksum, and the number of rows must be that which was written.
pub fn read_run(folder: &Path) -> Result<(RunInfo, Vec<Row>), ResultsError> {
    let sums = Checksums::read(folder)?;
    let text = |name: &str| {
        let path = folder.join(name);
        // Bytes with the right checksum are a text, unless the list was made for another file.
        let text = String::from_utf8(sums.bytes(name)?);
        text.map_err(|error| ResultsError::Io { path, source: io::Error::new(io::ErrorKind::InvalidData, error) })
    };
    let path = folder.join(CSV_NAME);
    let mut run = RunInfo::parse(&text(RUN_NAME)?, &folder.join(RUN_NAME))?;
    if sums.names().any(|name| name == DRAWINGS_NAME) {
        run.drawings = drawing::parse_drawings(&text(DRAWINGS_NAME)?, &folder.join(DRAWINGS_NAME))?;
    }
    let records = parse_csv(&text(CSV_NAME)?, &path)?;
    // `run.json` names them too: so no line of the list is missed.
    let due = run.files.iter().map(String::as_str).chain([SCHEMA_NAME]).filter(|name| ![CSV_NAME, RUN_NAME, DRAWINGS_NAME].contains(name));
    for name in due.chain(sums.names()).collect::<BTreeSet<&str>>() {
        sums.check(name)?;
    }
    let found = records.len() as u64;
    if found != run.rows {
        return Err(ResultsError::RowCount { path, found, expected: run.rows });
    }
    Ok((run, records))
}

/// The first field with a word that its column does not have, as column and complaint. The CSV reader's own error would not name the
/// column.
fn unknown_word(row: &csv::StringRecord) -> Option<(&'static str, String)> {
    COLUMNS.iter().zip(row).find_map(|(column, word)| {
        let known = column.words.is_empty() || word.is_empty() && column.kind == ColumnType::Word || column.words.contains(&word);
        (!known).then(|| (column.name, format!("`{word}` is none of {}", column.words.join(", "))))
    })
}

/// The file, line and column of the CSV reader's error.
fn csv_error(path: &Path, error: &csv::Error) -> ResultsError {
    let path = path.to_owned();
    let line = error.position().map_or(0, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => match err.field().and_then(|field| COLUMNS.get(field as usize)) {
            Some(column) => ResultsError::Field { path, line, column: column.name.into(), what: err.kind().to_string() },
            None => ResultsError::Damaged { path, line, what: err.kind().to_string() },
        },
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            ResultsError::Damaged { path, line, what: format!("{len} fields instead of {expected_len}: the row is cut or altered") }
        }
        _ => ResultsError::Damaged { path, line, what: error.to_string() },
    }
}
