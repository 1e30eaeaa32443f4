//! The table of a Parquet file as CSV: who reads it as a log has the numbers of the file.

use featherbench_identification::{Arm, Gravity, LinearModel, Log, LogProblem, Samples, Table, Terms};
use featherbench_parquet::{Error, table};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType, FloatType, Int32Type, Int64Type,
};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes a column; absent values have the level 0.
type Column<'a> = Box<dyn Fn(&mut parquet::file::writer::SerializedColumnWriter) + 'a>;

fn column<'a, T: DataType>(values: Vec<T::T>, levels: Option<&'a [i16]>) -> Column<'a> {
    Box::new(move |out| {
        out.typed::<T>().write_batch(&values, levels, None).unwrap();
    })
}

/// A file of one group with these columns, compressed.
fn write(path: &Path, schema: &str, columns: &[Column]) {
    let schema = Arc::new(parse_message_type(&format!("message log {{ {schema} }}")).unwrap());
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(std::fs::File::create(path).unwrap(), schema, Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for column in columns {
        let mut out = group.next_column().unwrap().unwrap();
        column(&mut out);
        out.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

fn scratch() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    (folder, path)
}

#[test]
fn a_log_is_read_as_csv_is() {
    let linear = LinearModel::new(&Arm::general(3, 4).describe(Gravity::Parallel, 1), Terms::NONE).unwrap();
    let samples = Samples::random(&linear, 40, 1, &linear.nominal()).unwrap();
    let samples = Samples { time: (0..40).map(|k| 0.1 * f64::from(k)).collect(), ..samples };
    let text = Log::of_samples(&samples).to_csv(&linear);
    let csv = Log::of_table(Table::of_csv(&text, "log").unwrap(), &linear).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let names = lines.next().unwrap();
    let rows: Vec<Vec<f64>> = lines.map(|row| row.iter().map(|x| x.parse().unwrap()).collect()).collect();
    let columns: Vec<Column> = (0..names.len()).map(|k| column::<DoubleType>(rows.iter().map(|row| row[k]).collect(), None)).collect();
    let (_folder, path) = scratch();
    write(&path, &names.iter().map(|name| format!("required double {name}; ")).collect::<String>(), &columns);

    let read = Table::of_csv(&table(&path).unwrap(), "log").unwrap().with_rows_for_lines();
    let parquet = Log::of_table(read, &linear).unwrap();
    assert_eq!(parquet, Log { lines: (1..=40).collect(), ..csv });
}

/// Every kind of field, as the reader of logs takes it: its number, or a text that is none.
#[test]
fn fields_keep_their_numbers() {
    let (_folder, path) = scratch();
    let doubles = [0.1, -0.0, 5e-324, f64::MAX, 1e22, f64::MIN_POSITIVE];
    let singles = [0.1_f32, -0.0, 1e-45, f32::MAX, 16_777_217.0, 3.0];
    // Beyond 2⁵³ they are rounded, as a cast rounds them: ties to even.
    let longs = [i64::MAX, i64::MIN, (1 << 53) + 1, (1 << 53) + 3, 0, -7];
    let ints = [i32::MAX, i32::MIN, 1, 2, 3, 4];
    let half = |bits: u16| FixedLenByteArray::from(bits.to_le_bytes().to_vec());
    let schema = "required double #d; required float f; required int64 l; required int64 ul (UINT_64); required int32 i; \
        required int32 us (UINT_16); required int32 money (DECIMAL(9, 2)); required fixed_len_byte_array(2) h (FLOAT16); optional double gap; \
        required binary text (STRING); required boolean flag;";
    let texts = ["5", "#", " 1 ", "a,\"b\"\n", "", "NaN"].map(|text| ByteArray::from(text.as_bytes().to_vec()));
    let columns = [
        column::<DoubleType>(doubles.to_vec(), None),
        column::<FloatType>(singles.to_vec(), None),
        column::<Int64Type>(longs.to_vec(), None),
        column::<Int64Type>(vec![-1; 6], None),
        column::<Int32Type>(ints.to_vec(), None),
        column::<Int32Type>(vec![65_535; 6], None),
        column::<Int32Type>(vec![-50; 6], None),
        column::<FixedLenByteArrayType>(vec![half(0x3e00); 6], None),
        column::<DoubleType>(vec![2.0; 5], Some(&[1, 1, 0, 1, 1, 1])),
        column::<ByteArrayType>(texts.to_vec(), None),
        column::<BoolType>(vec![true; 6], None),
    ];
    write(&path, schema, &columns);
    let read = Table::of_csv(&table(&path).unwrap(), "log").unwrap().with_rows_for_lines();
    assert_eq!(read.names, ["#d", "f", "l", "ul", "i", "us", "money", "h", "gap", "text", "flag"]);
    assert_eq!(read.lines, [1, 2, 3, 4, 5, 6]);
    let bits = |name: &str| read.gather(&[name.to_owned()]).unwrap().into_iter().map(f64::to_bits).collect::<Vec<u64>>();
    let due = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    assert_eq!(bits("#d"), due(&doubles));
    assert_eq!(bits("f"), due(&singles.map(f64::from)));
    assert_eq!(bits("l"), due(&longs.map(|x| x as f64)));
    assert_eq!(bits("ul"), due(&[u64::MAX as f64; 6]));
    assert_eq!(bits("i"), due(&ints.map(f64::from)));
    assert_eq!(bits("us"), due(&[65_535.0; 6]));
    assert_eq!((bits("money"), bits("h")), (due(&[-0.5; 6]), due(&[1.5; 6])));
    for (name, line, said) in [("gap", 3, "null"), ("text", 1, "\"5\""), ("flag", 1, "true")] {
        let error = read.gather(&[name.to_owned()]).unwrap_err();
        assert_eq!(error.line, Some(line), "{error}");
        assert!(matches!(&error.problem, LogProblem::NoNumber { text, .. } if text == said), "{error}");
    }
    // No text is a number, not even one that reads like it.
    for (row, text) in table(&path).unwrap().split("\n").skip(1).zip(["5", "#"]) {
        assert!(row.contains(&format!(",\"\"\"{text}\"\"\",")), "{row}");
    }
}

/// What is no finite number is told as such by the reader of logs.
#[test]
fn numbers_that_are_not_finite_stay_so() {
    let (_folder, path) = scratch();
    for (value, single) in [(f64::NAN, f32::NAN), (f64::INFINITY, f32::INFINITY), (f64::NEG_INFINITY, f32::NEG_INFINITY)] {
        write(
            &path,
            "required double d; required float f;",
            &[column::<DoubleType>(vec![value], None), column::<FloatType>(vec![single], None)],
        );
        let read = Table::of_csv(&table(&path).unwrap(), "log").unwrap();
        for name in ["d", "f"] {
            let error = read.gather(&[name.to_owned()]).unwrap_err();
            assert!(matches!(error.problem, LogProblem::NotFinite { value: found, .. } if found.to_bits() == value.to_bits()), "{error}");
        }
    }
}

#[test]
fn a_file_that_only_begins_like_one_is_refused() {
    let (_folder, path) = scratch();
    assert!(matches!(table(&path), Err(Error::Unreadable { .. })));
    std::fs::write(&path, "PAR1 and no more").unwrap();
    let said = table(&path).unwrap_err().to_string();
    assert!(said.contains("log.parquet: the Parquet file is not readable: ") && said.contains("Snappy"), "{said}");
}
