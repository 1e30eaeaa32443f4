//! A made-up run, with the size and the problems of a real one.

use std::collections::BTreeMap;

use featherbench_results::{
    Convention, Culprit, EngineInfo, EngineSource, Expectation, GateKind, GitInfo, Host, Kind, ModelOrigin, Relation, RobotInfo, Row,
    RunInfo, Verdict, canonical_json,
};

mod truth;

/// A model's name that contains markup.
pub const HOSTILE: &str = "robot \"</script><script>alert('x')</script>&amp;<b>";

/// Families, the models' names in each, and their joints.
const FAMILIES: [(&str, &str, &[u64]); 7] = [
    ("chain", "chain_2d", &[2, 5, 10, 20, 50, 100]),
    ("chain", "chain_3d", &[2, 5, 10, 20, 50, 100, 200]),
    ("tree", "tree_binary", &[7, 15, 31, 63, 127]),
    ("star", "star", &[5, 20, 80]),
    ("humanoid", "humanoid", &[30, 44]),
    ("quadruped", "quadruped", &[18, 22]),
    ("joints", "joints_mixed", &[6, 12, 24, 48]),
];
/// Robots and their joints.
const ROBOTS: [(&str, u64); 6] = [("panda", 9), ("iiwa14", 7), ("anymal_b", 18), ("atlas_v4", 36), ("jvrc1", 44), (HOSTILE, 12)];
const METHODS: [(&str, &[&str]); 4] =
    [("pinocchio", &["aba_local", "aba_world", "crba"]), ("mujoco", &["forward"]), ("drake", &["multibody"]), ("dart", &["dynamics"])];
const QUANTITIES: [&str; 14] = [
    "mass_matrix",
    "mass_matrix_probe",
    "bias",
    "id",
    "id_wrench",
    "fd",
    "kinetic_energy",
    "potential_energy",
    "com",
    "momentum",
    "body_placement",
    "body_velocity",
    "body_jacobian",
    "readback",
];
const CASES: [&str; 5] = ["random", "zero", "straight", "fast", "limit"];

/// SplitMix64: the same numbers on every platform.
struct Random(u64);

impl Random {
    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn models() -> Vec<RobotInfo> {
    let model = |name: String, joints: u64, family: &str, origin: ModelOrigin| {
        let depth = match family {
            "tree" => u64::from(joints.ilog2()) + 1,
            "star" => 1,
            "humanoid" | "quadruped" | "robot" => 3 + joints / 6,
            _ => joints,
        };
        let source = if origin == ModelOrigin::Robot { "example-robot-data 4.3".into() } else { format!("gen {family} --joints {joints}") };
        let hash = format!("{:064x}", joints * 7919 + name.len() as u64);
        RobotInfo {
            properties: None,
            name,
            hash,
            origin,
            licence: "BSD-3-Clause".into(),
            source,
            nq: joints + 1,
            nv: joints,
            bodies: joints,
            depth,
            notes: Vec::new(),
        }
    };
    let generated = FAMILIES.iter().flat_map(|(family, stem, sizes)| {
        sizes.iter().map(move |&joints| model(format!("{stem}_{joints}"), joints, family, ModelOrigin::Generated))
    });
    let robots = ROBOTS.iter().map(|&(name, joints)| model(name.into(), joints, "robot", ModelOrigin::Robot));
    let mut models: Vec<RobotInfo> = generated.chain(robots).collect();
    models.extend(truth::models());
    models
}

fn family(model: &RobotInfo) -> &'static str {
    FAMILIES.iter().find(|(_, stem, _)| model.name.starts_with(stem)).map_or("robot", |(family, ..)| family)
}

fn base(run: &RunInfo, model: &RobotInfo) -> Row {
    Row {
        run: run.run.clone(),
        cell: model.hash[..16].into(),
        family: family(model).into(),
        robot: model.name.clone(),
        nq: Some(model.nq),
        nv: Some(model.nv),
        bodies: Some(model.bodies),
        depth: Some(model.depth),
        precision: "f64".into(),
        unit: "1".into(),
        ..Row::default()
    }
}

fn convention(engine: &str, topic: &str) -> Convention {
    Convention {
        engine: engine.into(),
        topic: topic.into(),
        theirs: format!("{topic} as {engine} has it"),
        ours: "as we have it".into(),
        conversion: "`file.py: function`, twice".into(),
        test: format!("test_{engine}"),
    }
}

/// The run's provenance.
pub fn run_info() -> RunInfo {
    let engine = |name: &str, version: &str, source, status: &str, reason: &str| EngineInfo {
        name: name.into(),
        version: version.into(),
        released: "2026-01-31".into(),
        source,
        build: BTreeMap::from([("flags".into(), "-O3 -march=x86-64-v3".into()), ("eigen".into(), "3.4.0".into())]),
        status: status.into(),
        reason: reason.into(),
    };
    RunInfo {
        run: "2026-01-31T1200-7f3a".into(),
        suite: "default".into(),
        suite_hash: "9b1c0f".into(),
        command: "featherbench run --suite default --out reports/2026-01-31T1200-7f3a".into(),
        started: "2026-01-31T12:00:00Z".into(),
        version: "0.1.0".into(),
        git: GitInfo { revision: "4f2d1c9ab0".into(), dirty: true },
        binary_hash: "c0ffee".into(),
        rustc: "rustc 1.95.0".into(),
        profile: "release".into(),
        target_features: ["avx2", "avx512f", "bmi2", "fma"].map(String::from).into(),
        host: Host {
            cpu: "An Example CPU @ 3.0 GHz".into(),
            cores: 8,
            affinity: "3".into(),
            governor: "performance".into(),
            load: Some(0.12),
            kernel: "Linux 6.12.0".into(),
            memory: Some(34_359_738_368),
        },
        seed: 20_260_131,
        engines: vec![
            engine("featherbench", "0.1.0", EngineSource::Own, "ok", ""),
            engine("pinocchio", "4.1.0", EngineSource::Recorded, "ok", ""),
            engine("mujoco", "3.4.0", EngineSource::Recorded, "ok", ""),
            engine("drake", "1.48.0", EngineSource::Recorded, "ok", ""),
            engine("dart", "", EngineSource::Recorded, "missing", "no recording for this suite"),
        ],
        conventions: [("mujoco", "free v"), ("drake", "screw <pitch>")].map(|(engine, topic)| convention(engine, topic)).into(),
        robots: models(),
        seconds: BTreeMap::from([("accuracy".into(), 11.4), ("timing".into(), 30.25)]),
        expected: vec![
            Expectation::new(GateKind::Counts, "drake: passing rows of id".into(), 175, 175),
            Expectation::new(GateKind::Counts, "mujoco: passing rows of fd".into(), 350, 331)
                .because("19 rows are missing".into())
                .about(Culprit { quantity: "fd".into(), ..Culprit::engine("mujoco") }),
        ],
        ..RunInfo::default()
    }
}

/// The rows of the machine.
fn machine(run: &RunInfo, rows: &mut Vec<Row>) {
    let row = Row {
        run: run.run.clone(),
        study: "timing".into(),
        engine: "featherbench".into(),
        quantity: "machine".into(),
        kind: Kind::Measured,
        ..Row::default()
    };
    for (metric, value) in [("fma_per_ns", 57.0), ("fma_per_ns_per_lane", 7.125), ("clock_ns", 20.0), ("empty_call_ns", 1.4)] {
        rows.push(Row { metric: metric.into(), ..row.clone() }.informed(value));
    }
}

/// About 12 000 rows of agreement, pairs, times, operations, accuracy and conditioning.
pub fn rows(run: &RunInfo) -> Vec<Row> {
    let mut random = Random(1);
    let mut rows = Vec::new();
    for model in run.robots.iter().filter(|model| !truth::is_own(model)) {
        agreement(run, model, &mut random, &mut rows);
        times(run, model, &mut random, &mut rows);
        let structure = Row {
            study: "operations".into(),
            engine: "featherbench".into(),
            quantity: "mass_matrix".into(),
            metric: "nonzeros".into(),
            ..base(run, model)
        };
        rows.push(structure.gated((model.nv * 2) as f64, Relation::Eq, (model.nv * 2) as f64));
    }
    machine(run, &mut rows);
    truth::rows(run, &mut random, &mut rows);
    rows
}

/// Whether a file of a report is raw data: rows as they are.
pub fn holds_rows(name: &str) -> bool {
    ["robot-", "study-", "unpassed.", "times."].iter().any(|start| name.starts_with(start)) && name.ends_with(".js")
}

/// Elements of a page: every opening tag makes one.
pub fn nodes(page: &str) -> usize {
    page.as_bytes().windows(2).filter(|pair| pair[0] == b'<' && pair[1].is_ascii_alphabetic()).count()
}

/// The run again and again with other robots, cut at this many rows; at least once as it is.
pub fn large(count: usize) -> (RunInfo, Vec<Row>) {
    let mut run = run_info();
    let (once, robots) = (rows(&run), run.robots.clone());
    let mut all = once.clone();
    for copy in (2..).take_while(|copy| (copy - 1) * once.len() < count) {
        let renamed = |name: &str| if name.is_empty() { String::new() } else { format!("{name} {copy}") };
        run.robots.extend(robots.iter().map(|robot| RobotInfo { name: renamed(&robot.name), ..robot.clone() }));
        all.extend(once.iter().map(|row| Row { robot: renamed(&row.robot), ..row.clone() }));
    }
    all.truncate(count.max(once.len()));
    (run, all)
}

fn agreement(run: &RunInfo, model: &RobotInfo, random: &mut Random, rows: &mut Vec<Row>) {
    for (engine, methods) in METHODS {
        let version = run.engines.iter().find(|info| info.name == engine).map(|info| info.version.clone()).unwrap_or_default();
        let of_engine = Row {
            study: "agreement".into(),
            engine: engine.into(),
            engine_version: version,
            reference: "featherbench".into(),
            ..base(run, model)
        };
        if engine == "dart" {
            rows.push(of_engine.without_value(Verdict::Skip, "no recording for this suite"));
            continue;
        }
        for quantity in QUANTITIES {
            let of_quantity = Row { quantity: quantity.into(), ..of_engine.clone() };
            if engine == "mujoco" && family(model) == "joints" {
                rows.push(of_quantity.without_value(Verdict::Skip, "a helical joint has no MuJoCo equivalent"));
                continue;
            }
            if engine == "drake" && model.name == "atlas_v4" && quantity == "body_jacobian" {
                rows.push(of_quantity.without_value(Verdict::Error, "the oracle's process ended: signal 11"));
                continue;
            }
            let methods = if quantity == "fd" { methods } else { &methods[methods.len() - 1..] };
            for method in methods {
                for case in CASES {
                    let row = Row { method: (*method).into(), states: case.into(), ..of_quantity.clone() };
                    rows.extend(errors(&row, model, random));
                }
            }
        }
        for other in ["pinocchio", "mujoco"].into_iter().filter(|&other| engine == "drake" || engine == "mujoco" && other == "pinocchio") {
            for quantity in ["mass_matrix", "id", "fd"] {
                let row = Row {
                    quantity: quantity.into(),
                    reference: other.into(),
                    metric: "pairwise".into(),
                    states: "random".into(),
                    ..of_engine.clone()
                };
                rows.push(row.informed(1e-15 * (model.depth as f64).powf(1.5) * (1.0 + 5.0 * random.unit())));
            }
        }
    }
}

/// A row's errors: for forward dynamics a forward and a backward one.
fn errors(row: &Row, model: &RobotInfo, random: &mut Random) -> Vec<Row> {
    let depth = model.depth as f64;
    let spread = 10.0_f64.powf(1.5 * random.unit() - 1.0);
    let fast = if row.states == "fast" { 3.0 } else { 1.0 };
    if row.quantity != "fd" {
        let value = if row.states == "zero" && row.quantity.ends_with("energy") { 0.0 } else { 2.2e-16 * depth.sqrt() * spread * fast };
        // Gates of different width, so that the heatmap has different colours.
        let comfort = 10.0_f64.powi(QUANTITIES.iter().position(|&quantity| quantity == row.quantity).map_or(0, |index| index as i32 % 5));
        return vec![Row { metric: "scaled".into(), ..row.clone() }.gated(value, Relation::Le, 1e-14 * comfort * depth.sqrt())];
    }
    // Factorising in world coordinates loses digits with depth; articulated bodies in local ones hardly do.
    let growth = if row.method == "aba_local" { depth } else { depth.powf(2.2) };
    let forward = Row { metric: "forward".into(), floor: Some(1e-16 * depth), ..row.clone() };
    let forward = forward.gated(2e-16 * growth * spread * fast, Relation::Le, 3e-14 * depth.powf(1.8));
    let backward = Row { metric: "backward".into(), ..row.clone() };
    let blunder = if row.engine == "drake" && model.name == "star_80" && row.states == "fast" { 1e4 } else { 1.0 };
    let mut backward = backward.gated(blunder * 2e-16 * growth.sqrt() * spread, Relation::Le, 1e-13);
    if row.engine == "pinocchio" && backward.verdict == Verdict::Fail {
        backward = backward.deviating("world frames lose digits on long chains");
    }
    if row.engine == "mujoco" && model.name == HOSTILE && row.states == "limit" {
        backward = Row { metric: "backward".into(), ..row.clone() }.gated(f64::NAN, Relation::Le, 1e-13);
    }
    let kappa = Row { metric: "kappa".into(), ..row.clone() }.informed(10.0 * depth * depth);
    vec![forward, backward, kappa]
}

fn times(run: &RunInfo, model: &RobotInfo, random: &mut Random, rows: &mut Vec<Row>) {
    const ALGORITHMS: [(&str, &str, f64, f64); 7] = [
        ("id", "rnea_packed", 22.0, 1.0),
        ("fd", "aba", 55.0, 1.0),
        ("fd", "ltdl", 17.0, 1.7),
        ("mass_matrix_sparse", "crba", 14.0, 1.55),
        ("factorization", "ltdl", 2.0, 1.9),
        ("solve", "ltdl", 1.5, 1.6),
        ("body_placement", "kinematics_packed", 9.0, 1.0),
    ];
    for (algorithm, method, constant, exponent) in ALGORITHMS {
        for cache in ["stream", "hot"] {
            let penalty = if cache == "hot" { 0.8 } else { 1.0 };
            let ns = 30.0 + constant * penalty * (model.nv as f64).powf(exponent) * (1.0 + 0.1 * random.unit());
            let row = Row {
                study: "timing".into(),
                engine: "featherbench".into(),
                engine_version: "0.1.0".into(),
                method: method.into(),
                quantity: algorithm.into(),
                cache: cache.into(),
                kind: Kind::Measured,
                unit: "ns".into(),
                params: canonical_json(&serde_json::json!({"states": 1000, "p10": 0.97 * ns, "p90": 1.1 * ns})),
                ..base(run, model)
            };
            rows.push(Row { metric: "ns_per_call".into(), ..row.clone() }.measured(ns, 0.99 * ns, 1.02 * ns));
            if model.name == HOSTILE || random.unit() < 0.5 {
                continue;
            }
            let ratios = Row { unit: "1".into(), reference: format!("featherbench {method}"), ..row };
            let control = 1.0 + 0.02 * (random.unit() - 0.5);
            let judged = |row: Row| {
                let quiet = (control - 1.0).abs() <= 0.006;
                if quiet { row } else { row.invalid("the second copy of featherbench over the first is not 1") }
            };
            let row = Row { metric: "control".into(), ..ratios.clone() };
            rows.push(judged(row.measured(control, control - 0.006, control + 0.006)));
            let other = 1.1 + 2.0 * random.unit();
            let row = Row { engine: "pinocchio".into(), method: "other".into(), metric: "ratio".into(), ..ratios };
            rows.push(judged(row.measured(other, 0.98 * other, 1.03 * other)));
        }
    }
}
