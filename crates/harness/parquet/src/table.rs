//! The table of a Parquet file as CSV text.

use crate::Error;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::fs::File;
use std::path::Path;

/// The table of a file as CSV: a line of names, then a line per row. A number is read back from it to the bit.
///
/// A field of text is in quotation marks of its own, `"5"`, and is no number. A field that is absent is the word `null`. Two things that
/// the file had are lost. Readers of CSV trim the space around the name of a column. A number no longer tells that it was a decimal or a
/// half float: it is a number like another.
///
/// # Errors
/// [`Error::Unreadable`] when the file is no Parquet, or is compressed by another method than Snappy.
pub fn table(path: &Path) -> Result<String, Error> {
    let unreadable = |what: String| Error::Unreadable { path: path.to_owned(), what };
    let opened = File::open(path).map_err(|error| unreadable(error.to_string()))?;
    let bad = |error| unreadable(format!("the Parquet file is not readable: {error} (plain and Snappy compression are read)"));
    let reader = SerializedFileReader::new(opened).map_err(bad)?;
    // A name that begins with # is quoted: its line would be a comment.
    let mut out = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(Vec::new());
    let unwritable = |error: csv::Error| unreadable(error.to_string());
    let names = reader.metadata().file_metadata().schema().get_fields().iter().map(|field| field.name().to_owned());
    out.write_record(names.collect::<Vec<_>>()).map_err(unwritable)?;
    for row in reader.get_row_iter(None).map_err(bad)? {
        let row = row.map_err(bad)?;
        out.write_record(row.get_column_iter().map(|(_, field)| text(field))).map_err(unwritable)?;
    }
    let bytes = out.into_inner().map_err(|error| unreadable(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))
}

/// A field. Whole numbers keep their digits; who reads them as f64 rounds them beyond 2⁵³.
fn text(field: &Field) -> String {
    match field {
        // The shortest decimal that reads back to the same f64.
        Field::Double(x) => format!("{x:?}"),
        Field::Float(x) => format!("{:?}", f64::from(*x)),
        other => other.to_string(),
    }
}
