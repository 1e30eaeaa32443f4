//! Logs: what is read, what is refused by name and line, and derivatives.

use featherbench_identification::{
    Arm, Base, FlagKind, Fourier, Gravity, LinearModel, Log, LogProblem, Samples, Search, Smoothing, Table, Terms, excite, ordinary,
    samples,
};
use featherbench_robots::{Family, Random};
use featherbench_spatial::larger;

fn arm() -> LinearModel {
    LinearModel::new(&Arm::general(3, 4).describe(Gravity::Parallel, 1), Terms::NONE).unwrap()
}

fn trajectory(linear: &LinearModel) -> Fourier {
    let base = Base::of_robot(linear, 1).unwrap();
    excite(linear, &base, &Search { draws: 2, changes: 0, frequency: 0.5, harmonics: 3, ..Search::default() }).unwrap().trajectory
}

fn motion(linear: &LinearModel, count: usize) -> Samples {
    trajectory(linear).samples(linear, &linear.nominal(), count, 2.0).unwrap()
}

fn read(text: &str, linear: &LinearModel) -> Result<Log, featherbench_identification::LogError> {
    Log::of_table(Table::of_csv(text, "log.csv")?, linear)
}

/// The CSV of a short log, with a change.
fn changed(linear: &LinearModel, change: impl Fn(&mut Vec<Vec<String>>)) -> String {
    let text = Log::of_samples(&motion(linear, 40)).to_csv(linear);
    let mut rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    change(&mut rows);
    rows.iter().map(|row| row.join(",") + "\n").collect()
}

#[test]
fn csv_is_read_back_to_the_bit() {
    let linear = arm();
    let written = Log::of_samples(&motion(&linear, 40));
    let back = read(&written.to_csv(&linear), &linear).unwrap();
    assert_eq!(Log { file: String::new(), ..back }, written);
    // A floating robot has numbered columns, and no torque at its base.
    let floating = LinearModel::new(&Family::parse("quadruped").unwrap().generate().unwrap(), Terms::NONE).unwrap();
    let written = Log::of_samples(&Samples::random(&floating, 5, 1, &floating.nominal()).unwrap());
    assert_eq!(Log { file: String::new(), ..read(&written.to_csv(&floating), &floating).unwrap() }, written);
}

/// The crate reads CSV alone, and says who reads Parquet.
#[test]
fn a_parquet_file_is_named_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.parquet");
    std::fs::write(&path, "PAR1 and no more").unwrap();
    let refused = Log::read(&path, &arm()).unwrap_err();
    assert_eq!(refused.problem, LogProblem::Parquet);
    assert!(refused.to_string().contains("log.parquet: is a Parquet file: `featherbench identify` reads it"), "{refused}");
    // Less than the word that a Parquet file begins with.
    std::fs::write(&path, "PAR").unwrap();
    assert_eq!(Log::read(&path, &arm()).unwrap_err().problem, LogProblem::Empty);
}

#[test]
fn bad_logs_are_refused_by_line_and_column() {
    let linear = arm();
    let refused = |change: &dyn Fn(&mut Vec<Vec<String>>)| read(&changed(&linear, change), &linear).unwrap_err();
    let place = |rows: &[Vec<String>], column: &str| rows[0].iter().position(|name| name == column).unwrap();

    let missing = refused(&|rows| rows[0][3] = "q3".into());
    assert!(matches!(&missing.problem, LogProblem::MissingColumn { column, .. } if column == "q.joint_3"), "{missing}");
    let nan = refused(&|rows| rows[7][2] = "NaN".into());
    assert_eq!(nan.line, Some(8));
    assert!(nan.to_string().starts_with("log.csv:8: column 'q.joint_2' is NaN"), "{nan}");
    let empty = refused(&|rows| {
        let tau = place(rows, "tau.joint_1");
        rows[4][tau] = String::new();
    });
    assert!(matches!(&empty.problem, LogProblem::NoNumber { column, .. } if column == "tau.joint_1"), "{empty}");
    assert_eq!(empty.line, Some(5));
    let back = refused(&|rows| rows.swap(10, 11));
    assert!(matches!(back.problem, LogProblem::TimeNotRising { .. }) && back.line == Some(12), "{back}");
    let short = refused(&|rows| drop(rows[9].pop()));
    assert!(short.line == Some(10) && matches!(short.problem, LogProblem::Unreadable(_)), "{short}");
    let twice = refused(&|rows| rows[0][2] = "q.joint_1".into());
    assert!(matches!(twice.problem, LogProblem::TwoColumns { .. }), "{twice}");
    assert_eq!(refused(&|rows| rows.truncate(2)).problem, LogProblem::Empty);
    // A column that nobody asks for may hold anything.
    let other =
        changed(&linear, |rows| rows.iter_mut().enumerate().for_each(|(k, row)| row.push(if k == 0 { "note".into() } else { "x".into() })));
    assert!(read(&other, &linear).is_ok());

    let floating = LinearModel::new(&Family::parse("quadruped").unwrap().generate().unwrap(), Terms::NONE).unwrap();
    let log = Log { v: None, ..Log::of_samples(&Samples::random(&floating, 5, 1, &floating.nominal()).unwrap()) };
    assert!(matches!(read(&log.to_csv(&floating), &floating).unwrap_err().problem, LogProblem::NeedsVelocity { .. }));
}

#[test]
fn gaps_and_saturated_torques_are_flagged_and_left_out() {
    let linear = arm();
    let mut log = Log::of_samples(&motion(&linear, 200));
    let step = log.step();
    log.time[100..].iter_mut().for_each(|t| *t += 20.0 * step);
    let limit = linear.dofs()[1].effort;
    log.tau[3 * 60 + 1] = limit;
    log.tau[3 * 61 + 1] = -limit;
    let flags = log.examine(&linear);
    assert_eq!(
        flags.iter().map(|flag| (flag.kind, flag.line, flag.count)).collect::<Vec<_>>(),
        [(FlagKind::Gap, Some(102), 1), (FlagKind::Saturated, Some(62), 2)]
    );
    assert_eq!(flags[1].about, "tau.joint_2");
    let smoothing = Smoothing { order: 4, half: 5, stride: 1 };
    let found = samples(&log, &linear, smoothing).unwrap();
    // Two stretches of a hundred rows, each without its first and last five.
    assert_eq!(found.count(), 180);
    assert_eq!(found.used.iter().filter(|used| !**used).count(), 12);
    let exact = ordinary(&linear, &found).unwrap();
    assert!(exact.fit.total < 1e-3, "{}", exact.fit.total);

    // Without a limit a plateau at the largest magnitude is one.
    let mut robot = linear.description().clone();
    robot.bodies[1].joint.effort.clear();
    let unlimited = LinearModel::new(&robot, Terms::NONE).unwrap();
    (60..66).for_each(|row| log.tau[3 * row + 1] = 500.0);
    let flags = log.examine(&unlimited);
    assert_eq!((flags[1].line, flags[1].count), (Some(62), 6));
}

/// Local polynomials of the order p have derivatives of the trajectory that err by O(h^(p−1)): halving the step divides the error of q̈ by 8 to 16.
#[test]
fn derivatives_converge() {
    let linear = arm();
    let motion = trajectory(&linear);
    let worst = |count: usize| {
        let exact = motion.samples(&linear, &linear.nominal(), count, 2.0).unwrap();
        let log = Log { v: None, ..Log::of_samples(&exact) };
        let found = samples(&log, &linear, Smoothing { order: 4, half: 5, stride: 1 }).unwrap();
        let differences = found.a.iter().zip(&exact.a[3 * 5..]).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, |most: f64, x| larger(most, x))
    };
    let (coarse, fine) = (worst(200), worst(400));
    println!("{coarse:e} {fine:e}");
    assert!((3.0..4.5).contains(&(coarse / fine).log2()), "{coarse:e} {fine:e}");
    assert!(fine < 1e-2);
}

/// From noisy positions and torques alone, the base parameters to some per cent.
#[test]
fn a_noisy_log_identifies() {
    let linear = arm();
    let mut log = Log { v: None, ..Log::of_samples(&motion(&linear, 2000)) };
    let mut random = Random::named(1, "log");
    log.q.iter_mut().for_each(|q| *q += random.uniform(-1e-4, 1e-4));
    log.tau.iter_mut().for_each(|tau| *tau += random.uniform(-0.3, 0.3));
    let found = samples(&log, &linear, Smoothing { order: 4, half: 20, stride: 41 }).unwrap();
    assert_eq!(found.count(), 1960_usize.div_ceil(41));
    let estimate = ordinary(&linear, &found).unwrap();
    let due = estimate.base.values(&linear.nominal());
    let largest = due.iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
    let worst = estimate.beta.iter().zip(&due).fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs()));
    println!("{worst:e} of {largest:e}");
    assert!(worst < 0.03 * largest);
    let without = Log { v: None, ..log };
    assert!(matches!(
        samples(&without, &linear, Smoothing::NONE).unwrap_err().problem,
        LogProblem::NoDerivatives { missing: "velocities" }
    ));
    assert!(matches!(
        samples(&without, &linear, Smoothing { half: 1500, ..Smoothing::USUAL }).unwrap_err().problem,
        LogProblem::TooShort { window: 3001 }
    ));
}
