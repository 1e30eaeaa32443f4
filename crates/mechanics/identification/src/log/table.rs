//! A table of numbers by column name, from CSV.

use super::{LogError, LogProblem};
use std::fmt::Display;
use std::path::Path;

/// What a Parquet file begins with.
const PARQUET: &[u8] = b"PAR1";

/// Columns of numbers with their names.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Table {
    /// Where it comes from, for messages.
    pub file: String,
    /// Names of the columns.
    pub names: Vec<String>,
    /// The fields, row after row. A field that is empty or no number is an error only if its column is used.
    rows: Vec<Vec<Cell>>,
    /// The line of each row; its number where the file has no lines.
    pub lines: Vec<usize>,
}

/// A field.
#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Number(f64),
    Text(String),
}

impl Table {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// [`LogError`] when the file cannot be read; [`LogProblem::Parquet`] when it is a Parquet file, which this crate does not read.
    pub fn read(path: &Path) -> Result<Self, LogError> {
        let file = path.display().to_string();
        let bad = |problem| LogError { file: file.clone(), line: None, problem };
        let unreadable = |error: &dyn Display| bad(LogProblem::Unreadable(error.to_string()));
        let bytes = std::fs::read(path).map_err(|error| unreadable(&error))?;
        if bytes.starts_with(PARQUET) {
            return Err(bad(LogProblem::Parquet));
        }
        let text = String::from_utf8(bytes).map_err(|error| unreadable(&error))?;
        Self::of_csv(&text, &file)
    }

    /// The table of a CSV text: a line of names, then numbers.
    ///
    /// # Errors
    /// [`LogError`] when a row has another length than the line of names, or a name comes twice.
    pub fn of_csv(text: &str, file: &str) -> Result<Self, LogError> {
        let unreadable = |error: &csv::Error| {
            let line = error.position().map(|position| position.line() as usize);
            let text = match error.kind() {
                csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                    format!("{len} fields, but there are {expected_len} columns; each row has one field per column")
                }
                _ => error.to_string(),
            };
            LogError { file: file.into(), line, problem: LogProblem::Unreadable(text) }
        };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        let names: Vec<String> = reader
            .headers()
            .map_err(|error| unreadable(&error))?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_owned())
            .collect();
        let mut table = Self { file: file.into(), names, ..Self::default() };
        table.check_names()?;
        for record in reader.records() {
            let record = record.map_err(|error| unreadable(&error))?;
            table.lines.push(record.position().map_or(0, |position| position.line() as usize));
            let cell = |text: &str| text.parse().map_or_else(|_| Cell::Text(text.to_owned()), Cell::Number);
            table.rows.push(record.iter().map(cell).collect());
        }
        Ok(table)
    }

    /// The same with numbers of rows, from one, for lines: of a file that was converted to CSV, and whose rows are in no lines.
    pub fn with_rows_for_lines(self) -> Self {
        Self { lines: (1..=self.rows.len()).collect(), ..self }
    }

    fn check_names(&self) -> Result<(), LogError> {
        let twice = self.names.iter().enumerate().find(|(k, name)| self.names[..*k].contains(name));
        match twice {
            None => Ok(()),
            Some((_, column)) => {
                Err(LogError { file: self.file.clone(), line: None, problem: LogProblem::TwoColumns { column: column.clone() } })
            }
        }
    }

    /// Whether there is such a column.
    pub fn has(&self, column: &str) -> bool {
        self.names.iter().any(|name| name == column)
    }

    /// The numbers of some columns, row after row.
    ///
    /// # Errors
    /// [`LogError`] when a column is missing, or a field is no finite number.
    pub fn gather(&self, columns: &[String]) -> Result<Vec<f64>, LogError> {
        let columns: Vec<Option<String>> = columns.iter().cloned().map(Some).collect();
        self.gather_some(&columns)
    }

    /// The same, with zeros for `None`.
    pub(super) fn gather_some(&self, columns: &[Option<String>]) -> Result<Vec<f64>, LogError> {
        let bad = |line, problem| LogError { file: self.file.clone(), line, problem };
        let place = |column: &Option<String>| match column {
            None => Ok(None),
            Some(column) => match self.names.iter().position(|name| name == column) {
                Some(place) => Ok(Some(place)),
                None => Err(bad(None, LogProblem::MissingColumn { column: column.clone(), present: self.names.clone() })),
            },
        };
        let places: Vec<Option<usize>> = columns.iter().map(place).collect::<Result<_, _>>()?;
        let mut values = Vec::with_capacity(self.rows.len() * columns.len());
        for (row, &line) in self.rows.iter().zip(&self.lines) {
            for &place in &places {
                let Some(place) = place else {
                    values.push(0.0);
                    continue;
                };
                let column = || self.names[place].clone();
                match row.get(place) {
                    Some(Cell::Number(value)) if value.is_finite() => values.push(*value),
                    Some(Cell::Number(value)) => return Err(bad(Some(line), LogProblem::NotFinite { column: column(), value: *value })),
                    Some(Cell::Text(text)) => return Err(bad(Some(line), LogProblem::NoNumber { column: column(), text: text.clone() })),
                    None => return Err(bad(Some(line), LogProblem::NoNumber { column: column(), text: String::new() })),
                }
            }
        }
        Ok(values)
    }
}
