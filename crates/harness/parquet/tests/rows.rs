//! Rows as Parquet: each column has its type, and what is read back is what a CSV file holds.

use featherbench_parquet::{Error, write_rows};
use featherbench_results::{COLUMNS, ColumnType, Kind, Relation, Row, Verdict, to_csv};
use parquet::basic::{LogicalType, Type};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::fs::File;
use std::path::Path;

/// Rows in which every column is filled somewhere and every optional one is empty somewhere.
fn rows() -> Vec<Row> {
    let text = |word: &str| word.to_owned();
    let full = Row {
        run: text("r"),
        cell: text("00ff"),
        study: text("timing"),
        family: text("chain"),
        robot: text("π-arm, \"left\"\n"),
        nq: Some(0),
        nv: Some(7),
        bodies: Some(u64::from(u32::MAX)),
        depth: Some(3),
        engine: text("drake"),
        engine_version: text("1.51.1"),
        method: text("aba"),
        precision: text("f64"),
        quantity: text("fd"),
        states: text("random"),
        body: text("hand"),
        cache: text("hot"),
        metric: text("ns_per_call"),
        kind: Kind::Measured,
        unit: text("ns"),
        reference: text("truth"),
        floor: Some(5e-324),
        params: text("{\"a\":1}"),
        estimated: true,
        ..Row::default()
    };
    let measured = full.clone().measured(0.1, -0.0, f64::MAX).invalid("the control is off");
    let gated = Row { unit: text("1"), study: text("agreement"), ..full.clone() }.gated(1e-15, Relation::Le, 1e-14);
    let empty = Row { study: text("agreement"), ..Row::default() }.without_value(Verdict::Skip, "not offered");
    vec![gated, measured, empty, Row { study: text("timing"), ..full.gated(f64::NAN, Relation::Ge, 1.0) }]
}

/// The fields of a file, row by row, as a CSV file writes them; the study is taken from the folder's name.
fn read(path: &Path) -> Vec<Vec<String>> {
    let study = path.parent().unwrap().file_name().unwrap().to_str().unwrap().strip_prefix("study=").unwrap();
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let field = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Long(number) => number.to_string(),
        Field::Double(number) => format!("{number:?}"),
        Field::Bool(flag) => flag.to_string(),
        other => panic!("{other:?}"),
    };
    let row = |row: parquet::record::Row| {
        let mut fields: Vec<String> = row.get_column_iter().map(|(_, value)| field(value)).collect();
        fields.insert(COLUMNS.iter().position(|column| column.name == "study").unwrap(), study.to_owned());
        fields
    };
    reader.get_row_iter(None).unwrap().map(|read| row(read.unwrap())).collect()
}

#[test]
fn what_is_read_back_is_what_the_csv_file_holds() {
    let folder = tempfile::tempdir().unwrap();
    let files = write_rows(folder.path(), &rows()).unwrap();
    let names: Vec<_> = files.iter().map(|path| path.strip_prefix(folder.path()).unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["study=agreement/part-0.parquet", "study=timing/part-0.parquet"]);

    let csv = to_csv(&rows(), Path::new("rows.csv")).unwrap();
    let mut records: Vec<Vec<String>> = csv::Reader::from_reader(csv.as_slice())
        .records()
        .map(|record| {
            let number = |(column, text): (&featherbench_results::Column, &str)| match column.kind {
                ColumnType::Float if !text.is_empty() => format!("{:?}", text.parse::<f64>().unwrap()),
                _ => text.to_owned(),
            };
            COLUMNS.iter().zip(record.unwrap().iter()).map(number).collect()
        })
        .collect();
    // Studies in alphabetical order, the rows of each in theirs.
    records.sort_by(|a, b| a[2].cmp(&b[2]));
    let found: Vec<Vec<String>> = files.iter().flat_map(|path| read(path)).collect();
    assert_eq!(found, records);
    for (at, column) in COLUMNS.iter().enumerate() {
        assert!(found.iter().any(|row| !row[at].is_empty()), "no row fills {}", column.name);
    }
}

#[test]
fn every_file_has_the_same_typed_columns() {
    let folder = tempfile::tempdir().unwrap();
    for path in write_rows(folder.path(), &rows()).unwrap() {
        let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
        let schema = reader.metadata().file_metadata().schema_descr();
        let due: Vec<_> = COLUMNS.iter().filter(|column| column.name != "study").collect();
        assert_eq!(schema.num_columns(), due.len());
        for (found, column) in schema.columns().iter().zip(due) {
            assert_eq!(found.name(), column.name);
            let (kind, optional) = match column.kind {
                ColumnType::Text | ColumnType::Word => (Type::BYTE_ARRAY, true),
                ColumnType::Integer => (Type::INT64, true),
                ColumnType::Float => (Type::DOUBLE, true),
                ColumnType::Flag => (Type::BOOLEAN, false),
            };
            assert_eq!((found.physical_type(), found.self_type().is_optional()), (kind, optional), "{}", column.name);
            assert_eq!(found.logical_type_ref() == Some(&LogicalType::String), kind == Type::BYTE_ARRAY, "{}", column.name);
        }
    }
}

/// More rows than are encoded together.
#[test]
fn long_studies_have_several_groups() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<Row> = (0..140_000).map(|k| Row { study: "long".into(), ..Row::default() }.informed(f64::from(k))).collect();
    let files = write_rows(folder.path(), &rows).unwrap();
    let reader = SerializedFileReader::new(File::open(&files[0]).unwrap()).unwrap();
    assert!(reader.metadata().num_row_groups() > 1);
    let value = COLUMNS.iter().position(|column| column.name == "value").unwrap();
    let found: Vec<String> = read(&files[0]).into_iter().map(|mut row| row.swap_remove(value)).collect();
    assert_eq!(found.len(), rows.len());
    assert!(found.iter().enumerate().all(|(k, value)| *value == format!("{:?}", k as f64)));
}

#[test]
fn a_study_that_no_folder_can_be_named_after_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for study in ["", "../x", "a=b"] {
        let error = write_rows(folder.path(), &[Row { study: study.into(), ..Row::default() }]).unwrap_err();
        assert!(matches!(&error, Error::Partition { study: named, .. } if named == study), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
