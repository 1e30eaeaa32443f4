//! Rows and runs are read back as they were written; damage is named.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use featherbench_results::{
    Base, COLUMNS, CSV_NAME, Checksums, ColumnType, Convention, Culprit, DRAWINGS_NAME, Drawing, DrawnBody, EngineInfo, EngineSource,
    Expectation, Feature, GateKind, GitInfo, Host, Kind, ModelOrigin, Properties, RUN_FORMAT, RUN_NAME, RecordedTimes, Relation,
    ResultsError, RobotInfo, Row, RunInfo, SCHEMA_NAME, ShardInfo, Verdict, atomic_write, canonical_json, read_csv, read_run, schema_json,
    to_csv, write_csv, write_run,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Text with every character that CSV quotes.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![Just(String::new()), "[a-z_0-9]{1,12}", "[ -~\\n\\r\t\"',;éπ漢]{0,20}", Just("</script>\r\n\"x\",".to_owned())]
}

fn finite() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite()))
}

fn word<T: Copy + std::fmt::Debug + 'static>(all: &'static [T]) -> impl Strategy<Value = T> {
    prop::sample::select(all)
}

prop_compose! {
    fn any_record()(
        names in prop::collection::vec(text(), 17),
        sizes in prop::collection::vec(prop::option::of(any::<u64>()), 4),
        numbers in prop::collection::vec(finite(), 6),
        flags in prop::collection::vec(any::<bool>(), 2),
        kind in word(Kind::ALL),
        relation in prop::option::of(word(Relation::ALL)),
        verdict in prop::sample::select(&[Verdict::Fail, Verdict::Info, Verdict::Skip, Verdict::Error, Verdict::Deviation][..]),
    ) -> Row {
        let mut names = names.into_iter();
        let mut next = || names.next().unwrap_or_default();
        Row {
            run: next(), cell: next(), study: next(), family: next(), robot: next(),
            nq: sizes[0], nv: sizes[1], bodies: sizes[2], depth: sizes[3],
            params: canonical_json(&serde_json::json!({"k": next()})),
            engine: next(), engine_version: next(), method: next(), precision: next(), quantity: next(), states: next(), body: next(), cache: next(),
            metric: next(),
            kind, value: numbers[0], ci_low: numbers[4], ci_high: numbers[5], unit: next(), reference: next(), relation, bound: numbers[1], floor: numbers[2], margin: numbers[3],
            verdict, valid: flags[0], estimated: flags[1], reason: next(),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn a_row_survives_csv_and_json(record in any_record()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        let rows = vec![record.clone(), Row::default(), record.clone()];
        write_csv(&path, &rows).unwrap();
        let read = read_csv(&path).unwrap();
        prop_assert_eq!(&read, &rows);
        // Doubles compare equal for both signs of zero; their bits do not.
        prop_assert_eq!(read[0].value.map(f64::to_bits), record.value.map(f64::to_bits));
        let json = serde_json::to_string(&record).unwrap();
        prop_assert_eq!(serde_json::from_str::<Row>(&json).unwrap(), record);
    }

    #[test]
    fn gated_rows_survive_too(value in any::<f64>(), bound in any::<f64>(), relation in word(Relation::ALL)) {
        let row = Row { metric: "scaled".into(), ..Row::default() }.gated(value, relation, bound);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        write_csv(&path, std::slice::from_ref(&row)).unwrap();
        prop_assert_eq!(read_csv(&path).unwrap(), vec![row]);
    }
}

/// SplitMix64: every bit pattern is as likely as any other.
fn bit_patterns(count: usize) -> impl Iterator<Item = f64> {
    let mut state = 0x0123_4567_89ab_cdef_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from_bits(z ^ (z >> 31))
    })
    .filter(|value| value.is_finite())
    .take(count)
}

#[test]
fn a_million_bit_patterns_survive_csv_and_json() {
    let edges = [0.0, -0.0, f64::MIN_POSITIVE, f64::from_bits(1), f64::MAX, f64::MIN, f64::EPSILON, 0.1, 1e22, 9_007_199_254_740_993.0];
    let values: Vec<f64> = edges.into_iter().chain(bit_patterns(1_000_000)).collect();

    // The csv crate's own serialisation, the one that rows go through.
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    for value in &values {
        writer.serialize((Some(value),)).unwrap();
    }
    let bytes = writer.into_inner().unwrap();
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
    let mut count = 0;
    for (row, value) in reader.deserialize::<(Option<f64>,)>().zip(&values) {
        assert_eq!(row.unwrap().0.map(f64::to_bits), Some(value.to_bits()), "{value:e}");
        count += 1;
    }
    assert_eq!(count, values.len());

    let json = serde_json::to_string(&values).unwrap();
    let read: Vec<f64> = serde_json::from_str(&json).unwrap();
    assert!(read.iter().zip(&values).all(|(read, value)| read.to_bits() == value.to_bits()));
    assert_eq!(read.len(), values.len());
}

#[test]
fn struct_header_and_schema_agree() {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();

    // The struct's own order, as serde sees it.
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(Row::default()).unwrap();
    let by_struct = String::from_utf8(writer.into_inner().unwrap()).unwrap();
    assert_eq!(by_struct.lines().next().unwrap(), names.join(","));
    let by_writer = String::from_utf8(to_csv(&[], Path::new("x")).unwrap()).unwrap();
    assert_eq!(by_writer, names.join(",") + "\n");

    let schema: serde_json::Value = serde_json::from_str(&schema_json(&featherbench_results::Dictionary::default())).unwrap();
    let columns = schema["columns"].as_array().unwrap();
    assert_eq!(schema["file"], CSV_NAME);
    let row = serde_json::to_value(Row {
        nq: Some(1),
        nv: Some(1),
        bodies: Some(1),
        depth: Some(1),
        floor: Some(0.5),
        ci_low: Some(0.25),
        ci_high: Some(0.75),
        ..Row::default().gated(0.5, Relation::Le, 1.5)
    })
    .unwrap();
    assert_eq!(row.as_object().unwrap().len(), columns.len());
    for (column, name) in columns.iter().zip(&names) {
        assert_eq!(column["name"], *name);
        assert!(!column["description"].as_str().unwrap().is_empty(), "{name} has no description");
        let value = &row[*name];
        let fits = match column["type"].as_str().unwrap() {
            "text" => value.is_string(),
            "integer" => value.is_u64(),
            "float" => value.is_f64(),
            "flag" => value.is_boolean(),
            "word" => column["words"].as_array().unwrap().contains(value),
            other => panic!("unknown type {other}"),
        };
        assert!(fits, "{name}: {value}");
    }
}

#[test]
fn words_are_read_as_they_are_written() {
    for &verdict in Verdict::ALL {
        assert_eq!(Verdict::parse(verdict.as_str()), Some(verdict));
        assert_eq!(serde_json::to_value(verdict).unwrap(), verdict.as_str());
    }
    assert_eq!(Verdict::parse("Pass"), None);
}

/// Three valid rows as text, and the error of reading them after `change`.
fn after(change: impl Fn(String) -> String) -> ResultsError {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.csv");
    let row = |value| Row { engine: "mujoco".into(), nv: Some(7), ..Row::default() }.gated(value, Relation::Le, 1e-14);
    let text = String::from_utf8(to_csv(&[row(1e-16), row(2.5e-15), row(1e-13)], &path).unwrap()).unwrap();
    fs::write(&path, change(text)).unwrap();
    read_csv(&path).expect_err("the file was damaged")
}

#[test]
fn damage_is_named_with_file_line_and_column() {
    for (old, new, words) in [
        ("2.5e-15", "2.5x-15", "rows.csv:3: column `value`"),
        (",7,", ",-7,", "rows.csv:2: column `nv`"),
        (",fail,", ",passed,", "rows.csv:4: column `verdict`"),
        ("2.5e-15", "NaN", "rows.csv:3: column `value`: NaN is not a finite number"),
        ("2.5e-15", "2.5e-5", "rows.csv:3: column `verdict`: pass, but 2.5e-5 is not at most 1e-14"),
        ("nv,bodies", "dofs,bodies", "column 7 is `dofs`, expected `nv`"),
        ("nv,bodies", "dofs,bodies", "rows.csv:1"),
        ("mujoco,", "", "rows.csv:2: 32 fields instead of 33"),
    ] {
        let message = after(|text| text.replacen(old, new, 1)).to_string();
        assert!(message.contains(words), "{message}");
    }
    let message = after(|text| text[..text.len() - 1].to_owned()).to_string();
    assert!(message.contains("rows.csv:4: the file ends in the middle of a row"), "{message}");
    assert!(matches!(after(|_| String::new()), ResultsError::Header { position: 1, .. }));
}

#[test]
fn every_truncation_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let row = Row { robot: "a\nb".into(), reason: "x,\"y\"".into(), ..Row::default() }.informed(0.1);
    write_run(folder.path(), &RunInfo::default(), &[row.clone(), row]).unwrap();
    for name in [CSV_NAME, RUN_NAME] {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() - 1 {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(read_run(folder.path()).is_err(), "{name} cut to {length} bytes was accepted");
        }
        fs::write(&path, &whole).unwrap();
    }
    assert!(read_run(folder.path()).is_ok());
}

fn run_info() -> RunInfo {
    RunInfo {
        format: RUN_FORMAT,
        run: "2026-01-01-a".into(),
        suite: "default".into(),
        suite_hash: "00ff".into(),
        command: "featherbench run --suite default".into(),
        started: "2026-01-01T00:00:00Z".into(),
        version: "0.1.0".into(),
        git: GitInfo { revision: "abc".into(), dirty: true },
        binary_hash: "11".into(),
        rustc: "1.95".into(),
        profile: "release".into(),
        target_features: vec!["avx2".into(), "fma".into()],
        host: Host {
            cpu: "cpu".into(),
            cores: 2,
            affinity: "0".into(),
            governor: "".into(),
            load: Some(0.1),
            kernel: "6".into(),
            memory: Some(1 << 40),
        },
        seed: u64::MAX,
        live: false,
        rows: 1,
        files: Vec::new(),
        engines: vec![EngineInfo {
            name: "featherbench".into(),
            version: "0.1.0".into(),
            released: "2026-01-31".into(),
            source: EngineSource::Own,
            build: BTreeMap::from([("fma".into(), "on".into())]),
            status: "ok".into(),
            reason: "".into(),
        }],
        studies: vec!["agreement".into()],
        drawings: BTreeMap::from([(
            "panda".into(),
            Drawing(vec![DrawnBody {
                name: "hand".into(),
                parent: None,
                mass: 0.7,
                origin: [0.1, 0.0, -2.0],
                centre: [0.0; 3],
                axes: [[1.0, 0.0, 0.5]; 3],
            }]),
        )]),
        robots: vec![RobotInfo {
            properties: Some(Properties {
                joints: vec!["revolute".into()],
                armature: vec!["revolute".into()],
                base: Base::Fixed,
                dofs: 7,
                offset: 0.0,
                mass_ratio: 3.5,
                features: vec![Feature::Balanced, Feature::HeightField],
            }),
            name: "chain".into(),
            hash: "22".into(),
            origin: ModelOrigin::Generated,
            licence: "MIT".into(),
            source: "gen chain".into(),
            nq: 1,
            nv: 1,
            bodies: 1,
            depth: 1,
            notes: vec!["the axis is normalised".into()],
        }],
        seconds: BTreeMap::from([("accuracy".into(), 0.1)]),
        others: [("timing".to_owned(), 0.4)].into(),
        expected: vec![
            Expectation::new(GateKind::Counts, "id".into(), 2, 1).because("one is missing".into()).about(Culprit::engine("drake")),
        ],
        recorded_times: vec![RecordedTimes {
            machine: "another".into(),
            started: "2026-01-01T00:00:00Z".into(),
            engine: "drake".into(),
            version: "1.2".into(),
            quantity: "id".into(),
            robots: 3,
            median: 2.5,
            least: 1.5,
            most: 3.5,
            estimated: true,
        }],
        shards: vec![ShardInfo {
            shard: "2/7".into(),
            started: "2026-01-01T00:00:00Z".into(),
            seconds: 0.25,
            host: Host { cpu: "another".into(), ..Host::default() },
            cells: 3,
        }],
        conventions: vec![Convention {
            engine: "featherbench".into(),
            topic: "free q".into(),
            theirs: "wxyz".into(),
            ours: "xyzw".into(),
            conversion: "".into(),
            test: "t".into(),
        }],
    }
}

#[test]
fn a_run_survives_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [Row::default().informed(0.1)];
    write_run(&folder.path().join("new/run"), &run_info(), &rows).unwrap();
    let (run, read) = read_run(&folder.path().join("new/run")).unwrap();
    assert_eq!(run.files, [CSV_NAME, SCHEMA_NAME, RUN_NAME, DRAWINGS_NAME], "each has a checksum");
    assert_eq!(RunInfo { files: Vec::new(), ..run }, run_info());
    assert_eq!(read, rows);
    assert_eq!(
        fs::read_to_string(folder.path().join("new/run").join(SCHEMA_NAME)).unwrap(),
        schema_json(&featherbench_results::Dictionary::default())
    );
}

#[test]
fn drawings_are_a_file_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    write_run(folder.path(), &run_info(), &[]).unwrap();
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(!text(RUN_NAME).contains("\"drawings\":"), "{}", text(RUN_NAME));
    assert!(text(DRAWINGS_NAME).lines().nth(1).unwrap().starts_with("\"panda\":[{\"name\":\"hand\""), "a robot a line");
    assert!(text("checksums.txt").contains(DRAWINGS_NAME));
    // An older version had them in run.json.
    let drawings = serde_json::to_string(&run_info().drawings).unwrap();
    let old = text(RUN_NAME).replacen('{', &format!("{{\"drawings\":{drawings},"), 1);
    let read = RunInfo::parse(&old, Path::new(RUN_NAME)).unwrap();
    assert_eq!(RunInfo { files: Vec::new(), ..read }, RunInfo { rows: 0, ..run_info() });
    // A run without drawings has no such file.
    let bare = folder.path().join("bare");
    let plain = RunInfo { drawings: BTreeMap::new(), rows: 0, ..run_info() };
    write_run(&bare, &plain, &[]).unwrap();
    assert!(!bare.join(DRAWINGS_NAME).exists());
    assert_eq!(RunInfo { files: Vec::new(), ..read_run(&bare).unwrap().0 }, plain);
    let mut lost = run_info();
    lost.drawings.get_mut("panda").unwrap().0[0].mass = f64::NAN;
    assert!(write_run(&bare, &lost, &[]).unwrap_err().to_string().contains("the drawing of panda"));
}

#[test]
fn a_run_that_was_altered_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_run(folder.path(), &run_info(), &[Row::default()]).unwrap();
    let path = folder.path().join(RUN_NAME);
    let text = fs::read_to_string(&path).unwrap();
    let read = |change: &str, to: &str| {
        fs::write(&path, text.replacen(change, to, 1)).unwrap();
        // Altered by a program that renews the checksums.
        Checksums::of(folder.path(), &[CSV_NAME, RUN_NAME, SCHEMA_NAME]).unwrap().write().unwrap();
        read_run(folder.path()).expect_err("altered").to_string()
    };
    assert!(read("\"format\": 2", "\"format\": 3").contains("format 3, this program reads format 2"));
    assert!(read("\"seed\"", "\"sead\"").contains("unknown field `sead`"));
    assert!(read("\"rows\": 1", "\"rows\": 3").contains("holds 1 rows, but its run wrote 3"));
}

#[test]
fn numbers_that_are_not_finite_are_never_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.csv");
    let row = Row { value: Some(f64::NAN), ..Row::default() };
    let error = write_csv(&path, &[Row::default(), row]).unwrap_err().to_string();
    assert!(error.contains("value of row 2"), "{error}");
    let run = RunInfo { seconds: BTreeMap::from([("timing".into(), f64::INFINITY)]), ..run_info() };
    let error = run.write(&path).unwrap_err().to_string();
    assert!(error.contains("`timing` is inf"), "{error}");
    assert!(!path.exists());
}

/// Readers that guess a column's type use its first rows. A field is an integer, a number, a truth value or something else, in quotes or
/// not. So does polars 2.1, with a hundred rows; pandas does it part by part.
fn guessed(fields: &[&str]) -> &'static str {
    let of = |field: &&str| match field.trim_matches('"') {
        "" => None,
        field if field.parse::<i64>().is_ok() => Some("integer"),
        field if field.parse::<f64>().is_ok() => Some("float"),
        "true" | "false" => Some("truth value"),
        _ => Some("text"),
    };
    let mut kinds: Vec<&str> = fields.iter().filter_map(of).collect();
    kinds.sort_unstable();
    kinds.dedup();
    match kinds[..] {
        [] => "nothing",
        [one] => one,
        ["float", "integer"] => "float",
        _ => "text",
    }
}

/// The raw fields of a CSV line, quotes included.
fn raw(line: &str) -> Vec<&str> {
    let (mut fields, mut start, mut quoted) = (Vec::new(), 0, false);
    for (at, c) in line.char_indices() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => {
                fields.push(&line[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    fields.push(&line[start..]);
    fields
}

/// Two hundred rows of pure ratios, then times in other units. The type that a reader guesses from the first hundred rows must be right for
/// all later ones. A column that is empty there is guessed to be text, which every field is.
#[test]
fn the_first_hundred_rows_do_not_mislead_about_the_rest() {
    let ratio = Row {
        run: "today".into(),
        engine: "featherbench".into(),
        engine_version: "0.1.0".into(),
        unit: "1".into(),
        nv: Some(7),
        ..Row::default()
    }
    .gated(1.0, Relation::Le, 2.0);
    let time = Row { unit: "1/ns".into(), floor: Some(0.5), ..ratio.clone() }.informed(25.9);
    let rows: Vec<Row> = std::iter::repeat_n(ratio, 200).chain(std::iter::repeat_n(time, 200)).collect();
    let text = String::from_utf8(to_csv(&rows, Path::new("x")).unwrap()).unwrap();
    let lines: Vec<Vec<&str>> = text.lines().skip(1).map(raw).collect();
    assert!(lines.len() == 400 && lines.iter().all(|line| line.len() == COLUMNS.len()));
    for (position, column) in COLUMNS.iter().enumerate() {
        let of = |lines: &[Vec<&str>]| guessed(&lines.iter().map(|line| line[position]).collect::<Vec<_>>());
        let (first, rest) = (of(&lines[..100]), of(&lines[100..]));
        let due = match column.kind {
            ColumnType::Text | ColumnType::Word => "text",
            ColumnType::Integer => "integer",
            ColumnType::Float => "float",
            ColumnType::Flag => "truth value",
        };
        assert!(first == "nothing" || first == due, "{}: {first}", column.name);
        assert!(first == "nothing" || rest == "nothing" || rest == first, "{}: {first}, then {rest}", column.name);
        assert!(column.name != "unit" || first == "text", "{first}");
    }
    assert_eq!(featherbench_results::parse_csv(&text, Path::new("x")).unwrap(), rows);
}

#[test]
fn an_atomic_write_leaves_the_old_file_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    atomic_write(&path, b"old").unwrap();
    atomic_write(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file was left behind");
    // A folder in the place of the file: the write fails, names the path, and removes its temporary file.
    let blocked = folder.path().join("blocked");
    fs::create_dir(&blocked).unwrap();
    fs::write(blocked.join("inside"), b"").unwrap();
    let error = atomic_write(&blocked, b"new").unwrap_err().to_string();
    assert!(error.contains("blocked"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    assert!(atomic_write(Path::new("/"), b"").is_err());
}

/// Other programs are told from a fifth of a core on, and the study that they disturbed most is what counts.
#[test]
fn a_busy_machine_is_told() {
    let run = |others: &[(&str, f64)]| RunInfo {
        others: others.iter().map(|(study, cores)| ((*study).to_owned(), *cores)).collect(),
        ..RunInfo::default()
    };
    assert_eq!(run(&[]).busy(), None);
    assert_eq!(run(&[("timing", 0.19)]).busy(), None);
    let busy = run(&[("contact_timing", 0.1), ("timing", 0.94)]).busy().unwrap();
    assert!(busy.starts_with("Other programs kept 0.9 of 0 cores busy"), "{busy}");
}
