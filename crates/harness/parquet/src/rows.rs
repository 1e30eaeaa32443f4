//! Rows as Parquet, for polars, pandas and DuckDB: a folder for each study, `study=agreement/part-0.parquet`.
//!
//! The column `study` is in the names of the folders, as hive has it, and in no file. Empty texts are null: they do not apply. So a column has the
//! same type in every study, and no reader guesses one.

use crate::Error;
use featherbench_results::{COLUMNS, Column, ColumnType, RATIO, Row, atomic_write_with};
use parquet::basic::Compression;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::parser::parse_message_type;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Rows that are encoded together: readers take one such group at a time.
const GROUP: usize = 1 << 17;

/// The column that is in the names of the folders.
const PARTITION: &str = "study";

/// Writes rows into a folder, study by study, and returns the files in alphabetical order. Rows keep their order within a study.
///
/// # Errors
/// [`Error::Results`] when a file cannot be written; [`Error::Partition`] when a study has no name that a folder can have.
pub fn write_rows(folder: &Path, rows: &[Row]) -> Result<Vec<PathBuf>, Error> {
    let mut studies: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        studies.entry(&row.study).or_default().push(row);
    }
    let plain = |name: &&&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
    if let Some(study) = studies.keys().find(|name| !plain(name)) {
        return Err(Error::Partition { path: folder.to_owned(), study: (*study).to_owned() });
    }
    let write = |(study, rows): (&str, Vec<&Row>)| {
        let path = folder.join(format!("{PARTITION}={study}")).join("part-0.parquet");
        atomic_write_with(&path, |file| encode(file, &rows).map_err(io::Error::other))?;
        Ok(path)
    };
    studies.into_iter().map(write).collect()
}

/// The columns of each file.
fn columns() -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(|column| column.name != PARTITION)
}

fn schema() -> String {
    let line = |column: &Column| {
        let (kind, note) = match column.kind {
            ColumnType::Text | ColumnType::Word => ("OPTIONAL BYTE_ARRAY", " (STRING)"),
            ColumnType::Integer => ("OPTIONAL INT64", ""),
            ColumnType::Float => ("OPTIONAL DOUBLE", ""),
            ColumnType::Flag => ("REQUIRED BOOLEAN", ""),
        };
        format!("{kind} {}{note};", column.name)
    };
    format!("message row {{ {} }}", columns().map(line).collect::<Vec<_>>().join(" "))
}

fn encode(file: &mut (dyn Write + Send), rows: &[&Row]) -> Result<(), ParquetError> {
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(file, Arc::new(parse_message_type(&schema())?), Arc::new(properties))?;
    for rows in rows.chunks(GROUP) {
        let mut group = writer.next_row_group()?;
        for column in columns() {
            let mut out = group.next_column()?.ok_or_else(|| ParquetError::General(format!("there is no column {}", column.name)))?;
            match column.kind {
                ColumnType::Text | ColumnType::Word => {
                    optional::<ByteArrayType>(
                        &mut out,
                        rows.iter().map(|row| text(row, column.name).map(|text| ByteArray::from(text.as_bytes().to_vec()))),
                    )?;
                }
                ColumnType::Integer => {
                    optional::<Int64Type>(&mut out, rows.iter().map(|row| integer(row, column.name).and_then(|x| i64::try_from(x).ok())))?;
                }
                ColumnType::Float => optional::<DoubleType>(&mut out, rows.iter().map(|row| float(row, column.name)))?,
                ColumnType::Flag => {
                    let values: Vec<bool> = rows.iter().map(|row| if column.name == "valid" { row.valid } else { row.estimated }).collect();
                    out.typed::<BoolType>().write_batch(&values, None, None)?;
                }
            }
            out.close()?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}

/// Writes values of which some are absent.
fn optional<T: parquet::data_type::DataType>(
    out: &mut SerializedColumnWriter,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let (mut present, mut levels) = (Vec::new(), Vec::new());
    for value in values {
        levels.push(i16::from(value.is_some()));
        present.extend(value);
    }
    out.typed::<T>().write_batch(&present, Some(&levels), None)?;
    Ok(())
}

/// A text of a row; none if it is empty.
fn text<'a>(row: &'a Row, column: &str) -> Option<&'a str> {
    let text = match column {
        "run" => &row.run,
        "cell" => &row.cell,
        "family" => &row.family,
        "robot" => &row.robot,
        "engine" => &row.engine,
        "engine_version" => &row.engine_version,
        "method" => &row.method,
        "precision" => &row.precision,
        "quantity" => &row.quantity,
        "states" => &row.states,
        "body" => &row.body,
        "cache" => &row.cache,
        "metric" => &row.metric,
        "kind" => row.kind.as_str(),
        // As in the CSV file.
        "unit" if row.unit == "1" => RATIO,
        "unit" => &row.unit,
        "reference" => &row.reference,
        "relation" => row.relation?.as_str(),
        "verdict" => row.verdict.as_str(),
        "reason" => &row.reason,
        "params" => &row.params,
        _ => return None,
    };
    Some(text).filter(|text| !text.is_empty())
}

fn integer(row: &Row, column: &str) -> Option<u64> {
    match column {
        "nq" => row.nq,
        "nv" => row.nv,
        "bodies" => row.bodies,
        "depth" => row.depth,
        _ => None,
    }
}

fn float(row: &Row, column: &str) -> Option<f64> {
    row.floats().into_iter().find(|(name, _)| *name == column).and_then(|(_, value)| value)
}
