//! The study of growth on engines that fail in every way: each failure is a row with its reason, and none ends the run.

use featherbench_bench::alone::{self, Ask, Measured, Question};
use featherbench_bench::run::{Silent, compare, evaluate, plan};
use featherbench_bench::{Context, Engine, Gates, Memory, NoAnswer, OutcomeStore};
use featherbench_doubles::Double;
use featherbench_engines::Featherbench;
use featherbench_registry::sections;
use featherbench_results::{Kind, Row, RunInfo, Verdict};
use featherbench_speed::{Growth, GrowthSettings};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What an engine does at a size.
type Behaviour = fn(&Question, usize) -> Result<Measured, NoAnswer>;

fn settings(must: u64) -> GrowthSettings {
    settings_with(must, "")
}

/// The settings with more keys.
fn settings_with(must: u64, more: &str) -> GrowthSettings {
    let text = format!(
        "about = \"a\"\nseed = 1\n[growth]\nseconds = 0.001\npatience = 5\nmemory = 512\nengines = [\"double\"]\n{more}\
         [[growth.lines]]\nname = \"chain\"\nof = \"chain:n=*,layout=spatial\"\nsizes = [10, 20, 40, 80]\nmust = {must}\n"
    );
    let suite = featherbench_bench::Suite::parse(&text, Path::new("s.toml")).unwrap();
    suite.settings("growth").unwrap().unwrap()
}

/// The settings with other sizes for other engines.
fn settings_with_peers(must: u64) -> GrowthSettings {
    let mut settings = settings(must);
    settings.lines[0].peers = Some(vec![10, 40]);
    settings
}

/// The right answer with made-up times: n microseconds per call by `aba`, n² tenths of a nanosecond by others.
fn right(question: &Question, dofs: usize) -> Result<Measured, NoAnswer> {
    let n = dofs as f64;
    let seconds = if question.method == "aba" { 1e-6 * n } else { 5e-8 * n * n };
    let memory = Memory { peak: 2_000_000 + 600_000 * dofs as u64, resident: 1_000_000 + 600_000 * dofs as u64 };
    let robot = alone::robot(&question.robot, question.seed)?;
    let real = Question { seconds: 0.0, ..question.clone() };
    let answer = alone::measure(&Featherbench::new(), &robot, &real, || None)?.answer;
    let calls = (0..9).map(|k| seconds * (1.0 + 0.01 * f64::from(k))).collect();
    Ok(Measured { dofs, build: 1e-3, calls, memory: Some(memory), answer })
}

/// Asks ours rightly, and the double as it behaves.
fn ask(double: Behaviour) -> Ask {
    Arc::new(move |question| {
        let dofs = alone::robot(&question.robot, question.seed)?.states.nv;
        if question.engine == "double" { double(question, dofs) } else { right(question, dofs) }
    })
}

fn rows_in(folder: &Path, study: &Growth) -> Vec<Row> {
    let gates: Gates = featherbench_doubles::gates("");
    let double = Double::of(&featherbench_doubles::robot("chain:n=2")).by_usual_methods();
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Featherbench::new()), Box::new(double)];
    let context = Context { robots: &[], engines: &engines, gates: &gates, seed: featherbench_doubles::SEED };
    let store = OutcomeStore::open(folder).unwrap();
    let cells = plan(study, &context, &|_| true);
    compare(study, &context, evaluate(study, &context, cells, &store, &Silent).unwrap())
}

fn rows(must: u64, double: Behaviour) -> Vec<Row> {
    rows_of(settings(must), ask(double))
}

fn rows_of(settings: GrowthSettings, ask: Ask) -> Vec<Row> {
    rows_in(tempfile::tempdir().unwrap().path(), &Growth::new(settings, ask))
}

/// The row on the largest size of an engine's method of forward dynamics.
fn largest<'a>(rows: &'a [Row], engine: &str, method: &str) -> &'a Row {
    let of = |row: &&Row| row.engine == engine && row.method == method && row.quantity == "fd" && row.metric == "largest";
    rows.iter().find(of).unwrap()
}

#[test]
fn what_grows_is_measured() {
    let rows = rows(10, right);
    assert!(rows.iter().all(|row| row.kind == Kind::Measured && row.verdict == Verdict::Info), "nothing here is judged");
    let value = |metric: &str, robot: &str| {
        let of = |row: &&Row| row.engine == "featherbench" && row.method == "aba" && row.metric == metric && row.robot == robot;
        rows.iter().find(of).unwrap_or_else(|| panic!("no {metric} of '{robot}'"))
    };
    let seconds = value("seconds", "chain:n=20,layout=spatial");
    assert!((seconds.value.unwrap() - 2e-5 * 1.04).abs() < 1e-12 && seconds.ci_low <= seconds.value && seconds.value <= seconds.ci_high);
    let exponent = value("time_exponent", "");
    assert!((exponent.value.unwrap() - 1.0).abs() < 1e-9 && exponent.ci_low < exponent.ci_high, "{exponent:?}");
    assert_eq!(value("memory_per_dof", "").value, Some(600_000.0));
    assert_eq!(
        (value("resident", "chain:n=40,layout=spatial").value, value("peak", "chain:n=40,layout=spatial").value),
        (Some(25_000_000.0), Some(26_000_000.0))
    );
    assert_eq!((value("largest", "").value, value("largest", "").reason.as_str()), (Some(80.0), ""));
    assert!(value("error", "chain:n=80,layout=spatial").value.unwrap() < 1e-13);
    // 5e-8 n² and 1e-6 n are equal at n = 20.
    let crossover = rows.iter().find(|row| row.metric == "crossover_measured" && row.method == "ltdl").unwrap();
    assert!((crossover.value.unwrap() - 20.0).abs() < 1e-9, "{crossover:?}");
}

#[test]
fn methods_on_several_threads_stand_beside_the_serial_one() {
    let threaded: Ask = Arc::new(|question| {
        let parallel = ["rnea_parallel", "aba_parallel", "crba_parallel", "ltdl_parallel", "twisted"].contains(&question.method.as_str());
        assert!(matches!((parallel, question.threads), (true, 1 | 2) | (false, 1)), "{question:?}");
        let n = alone::robot(&question.robot, question.seed)?.states.nv;
        let mut measured = right(question, n)?;
        // A fifth more work than the serial method, divided by the threads, and 20 µs once.
        if question.method == "twisted" {
            measured.calls = vec![(1.2e-6 * n as f64) / question.threads as f64 + 2e-5; 3];
        }
        Ok(measured)
    });
    let rows = rows_of(settings_with(10, "threads = [1, 2]\n"), threaded);
    let of = |method: &str, metric: &str| -> Vec<&Row> {
        rows.iter()
            .filter(|row| row.engine == "featherbench" && row.method == method && row.metric == metric && row.quantity == "fd")
            .collect()
    };
    // On two threads (0.6 + 20/n)/1.04 crosses one at n = 45.5; the power law between 40 and 80 crosses near it. On one thread it is above one.
    let [crossing] = of("twisted_2", "crossover_measured")[..] else { panic!("{rows:#?}") };
    assert!((crossing.value.unwrap() - 45.5).abs() < 2.0 && crossing.reference == "aba", "{crossing:?}");
    assert!(of("twisted_1", "crossover_measured").is_empty());
    assert!(crossing.params.contains("\"threads\":2"), "{}", crossing.params);
    // Threads and, for the articulated-body algorithm, the serial method: one answer at each of four sizes.
    assert_eq!(of("aba_parallel_2", "seconds").len(), 0, "a chain is no tree with branches");
    let one = of("twisted_2", "different_answers");
    assert!(one.len() == 4 && one.iter().all(|row| row.value == Some(1.0) && row.verdict == Verdict::Pass && row.kind == Kind::Exact));
    assert!(of("twisted_1", "different_answers").is_empty(), "one row for all numbers of threads");
}

#[test]
fn an_answer_that_depends_on_the_threads_fails() {
    let spoilt: Ask = Arc::new(|question| {
        let mut measured = right(question, alone::robot(&question.robot, question.seed)?.states.nv)?;
        if question.method == "twisted" && question.threads == 2 {
            measured.answer[3] = measured.answer[3].next_up();
        }
        Ok(measured)
    });
    let rows = rows_of(settings_with(10, "threads = [1, 2]\n"), spoilt);
    let red: Vec<&Row> = rows.iter().filter(|row| row.verdict == Verdict::Fail).collect();
    assert!(red.len() == 4 && red.iter().all(|row| row.metric == "different_answers" && row.value == Some(2.0)), "{red:#?}");
}

#[test]
fn an_engine_is_asked_all_its_methods_of_a_robot_before_the_next_and_at_its_own_sizes() {
    let asked = Arc::new(std::sync::Mutex::new(Vec::new()));
    let recorded: Ask = {
        let (asked, inner) = (Arc::clone(&asked), ask(right));
        Arc::new(move |question| {
            if question.engine == "double" {
                asked.lock().unwrap().push(question.robot.clone());
            }
            inner(question)
        })
    };
    let rows = rows_of(settings_with_peers(10), recorded);
    let mut asked = asked.lock().unwrap().clone();
    let questions = asked.len();
    asked.dedup();
    assert_eq!(asked, ["chain:n=10,layout=spatial", "chain:n=40,layout=spatial"]);
    assert!(questions > asked.len(), "{questions} questions: there are several methods");
    let sizes = |engine: &str| {
        let mut sizes: Vec<u64> =
            rows.iter().filter(|row| row.engine == engine && row.metric == "seconds").filter_map(|row| row.nv).collect();
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    };
    assert_eq!((sizes("double"), sizes("featherbench")), (vec![10, 40], vec![10, 20, 40, 80]));
}

#[test]
fn a_size_that_is_expected_to_take_too_long_is_not_asked() {
    // Cubic: 2 calls take 0.8 s for 20 dofs.
    let slow: Ask = Arc::new(|question| {
        let n = alone::robot(&question.robot, question.seed)?.states.nv;
        assert!(question.method != "aba" || n < 40, "{question:?}");
        let calls = vec![if question.method == "aba" { 0.4 * (n as f64 / 20.0).powi(3) } else { 1e-3 }; 3];
        Ok(Measured { calls, build: 0.0, ..right(question, n)? })
    });
    // Of 20 dofs 6.4 s for 40 are expected, more than the five of the suite.
    let rows = rows_of(settings(40), slow);
    let row = largest(&rows, "featherbench", "aba");
    assert_eq!((row.value, row.verdict), (Some(20.0), Verdict::Info), "{}", row.reason);
    assert_eq!(row.reason, "chain:n=40,layout=spatial: not asked: 6 s are expected by the last two sizes, and the suite waits 5 s");
    assert_eq!(largest(&rows, "featherbench", "ltdl").value, Some(80.0));
}

#[test]
fn an_engine_that_stops_is_a_row_with_its_reason() {
    let failing: [(Behaviour, &str); 4] = [
        (
            |question, dofs| {
                if dofs > 20 {
                    Err(NoAnswer::Failed("the oracle exited (signal: 9 (SIGKILL); memory limit 512 MiB): no message".into()))
                } else {
                    right(question, dofs)
                }
            },
            "SIGKILL",
        ),
        (|question, dofs| if dofs > 20 { Err(NoAnswer::NotOffered("XML depth".into())) } else { right(question, dofs) }, "XML depth"),
        (
            |question, dofs| {
                let mut measured = right(question, dofs)?;
                if dofs > 20 {
                    measured.answer[7] = f64::NAN;
                }
                Ok(measured)
            },
            "not finite",
        ),
        (
            |question, dofs| {
                let mut measured = right(question, dofs)?;
                if dofs > 20 {
                    measured.calls.clear();
                }
                Ok(measured)
            },
            "no time",
        ),
    ];
    for (double, words) in failing {
        let rows = rows(20, double);
        let row = largest(&rows, "double", "aba");
        assert_eq!((row.value, row.verdict), (Some(20.0), Verdict::Info), "{words}");
        assert!(row.reason.starts_with("chain:n=40,layout=spatial: ") && row.reason.contains(words), "{}", row.reason);
        assert_eq!(largest(&rows, "featherbench", "aba").value, Some(80.0), "the others go on");
        let beyond = |row: &&Row| row.engine == "double" && row.nv.is_some_and(|nv| nv > 20);
        assert_eq!(rows.iter().filter(beyond).count(), 0);
        // The page says so, in its answer and in its table.
        let page = sections(&RunInfo::default(), &rows);
        let section = page.iter().find(|section| section.anchor == "scaling").unwrap().body.0.clone();
        assert!(section.contains("stops after 20: chain:n=40,layout=spatial") && section.matches(words).count() >= 2, "{section}");
        assert!(section.contains("Our forward dynamics of a chain of 80 degrees of freedom"), "{section}");
    }
}

#[test]
fn an_engine_that_fails_where_all_must_answer_is_an_error() {
    let failing: Behaviour = |question, dofs| if dofs > 10 { Err(NoAnswer::Failed("out of memory".into())) } else { right(question, dofs) };
    let row = largest(&rows(20, failing), "double", "aba").clone();
    assert_eq!((row.value, row.verdict), (None, Verdict::Error));
    assert!(row.reason.contains("out of memory"));
    // What it does not offer is no failure.
    let row = largest(&rows(20, |_, _| Err(NoAnswer::NotOffered("no chains".into()))), "double", "aba").clone();
    assert_eq!((row.value, row.verdict), (Some(0.0), Verdict::Info));
}

#[test]
fn a_wrong_answer_shows_in_its_error() {
    let wrong: Behaviour = |question, dofs| {
        let mut measured = right(question, dofs)?;
        measured.answer.iter_mut().for_each(|a| *a *= 1.0 + 1e-6);
        Ok(measured)
    };
    let rows = rows(80, wrong);
    let errors: Vec<f64> = rows
        .iter()
        .filter(|row| row.engine == "double" && row.method == "aba" && row.metric == "error")
        .filter_map(|row| row.value)
        .collect();
    assert!(errors.len() == 4 && errors.iter().all(|error| (error / 1e-6 - 1.0).abs() < 1e-6), "{errors:?}");
    // One number too few is no answer of this robot.
    let short: Behaviour = |question, dofs| {
        let mut measured = right(question, dofs)?;
        measured.answer.pop();
        Ok(measured)
    };
    let row = largest(&self::rows(10, short), "double", "aba").clone();
    assert_eq!((row.value, row.verdict), (None, Verdict::Error));
    assert!(row.reason.contains("its answer has 9 numbers, 10 are due"), "{}", row.reason);
    // Nor is one whose error overflows.
    let huge: Behaviour = |question, dofs| {
        let mut measured = right(question, dofs)?;
        measured.answer.fill(1e300);
        Ok(measured)
    };
    let row = largest(&self::rows(10, huge), "double", "aba").clone();
    assert!(row.verdict == Verdict::Error && row.reason.contains("its error is inf"), "{}", row.reason);
}

#[test]
fn a_resumed_run_measures_nothing_twice_and_has_the_same_bytes() {
    let asked = Arc::new(AtomicUsize::new(0));
    let counted: Ask = {
        let (asked, inner) = (Arc::clone(&asked), ask(right));
        Arc::new(move |question| {
            asked.fetch_add(1, Ordering::Relaxed);
            inner(question)
        })
    };
    let study = Growth::new(settings(10), counted);
    let folder = tempfile::tempdir().unwrap();
    let bytes = || featherbench_results::to_csv(&rows_in(folder.path(), &study), folder.path()).unwrap();
    let whole = bytes();
    let first = asked.load(Ordering::Relaxed);
    assert!(first > 0 && bytes() == whole && asked.load(Ordering::Relaxed) == first);
    let path = folder.path().join(featherbench_bench::OUTCOMES_NAME);
    let outcomes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &outcomes[..outcomes.len() / 2]).unwrap();
    assert!(bytes() == whole && asked.load(Ordering::Relaxed) > first);
}

#[test]
fn a_question_is_asked_with_the_limits_of_the_suite() {
    let checked: Ask = Arc::new(|question| {
        assert_eq!((question.limits.memory, question.limits.answer.as_secs(), question.seed), (512 << 20, 5, featherbench_doubles::SEED));
        assert_eq!(question.threads, 1, "{question:?}");
        Err(NoAnswer::NotOffered("a test".into()))
    });
    let rows = rows_in(tempfile::tempdir().unwrap().path(), &Growth::new(settings(10), checked));
    assert!(rows.len() > 4 && rows.iter().all(|row| row.metric == "largest" && row.value == Some(0.0)), "{rows:?}");
}
