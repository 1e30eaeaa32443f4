//! The studies with the truth: accuracy of methods with realistic losses, and condition numbers of straight chains.

use featherbench_results::{ModelOrigin, Relation, RobotInfo, Row, RunInfo, Verdict};

use super::{HOSTILE, Random, base};

/// Robots of these studies alone: name, family, degrees of freedom.
const OWN: [(&str, &str, u64); 12] = [
    ("rand3d-20", "rand3d", 20),
    ("rand3d-20-tip1e-3", "rand3d-20-tip", 20),
    ("rand3d-20-tip1e3", "rand3d-20-tip", 20),
    ("rand3d-20-tip1e6", "rand3d-20-tip", 20),
    ("rand3d-20-offset1e2", "rand3d-20-offset", 20),
    ("rand3d-20-offset1e4", "rand3d-20-offset", 20),
    ("rand3d-20-offset1e6", "rand3d-20-offset", 20),
    ("rand3d-20-fast", "rand3d", 20),
    ("straight-8", "straight", 8),
    ("straight-16", "straight", 16),
    ("straight-32", "straight", 32),
    ("straight-64", "straight", 64),
];
/// Engine, method, quantity.
const SUBJECTS: [(&str, &str, &str); 10] = [
    ("featherbench", "aba", "fd"),
    ("featherbench", "ltdl", "fd"),
    ("pinocchio", "aba_local", "fd"),
    ("pinocchio", "aba_world", "fd"),
    ("mujoco", "forward", "fd"),
    ("drake", "aba", "fd"),
    ("featherbench", "rnea_packed", "id"),
    ("drake", "inverse_dynamics", "id"),
    ("featherbench", "crba", "mass_matrix"),
    ("mujoco", "crb", "mass_matrix"),
];

/// The robots.
pub fn models() -> Vec<RobotInfo> {
    let model = |(name, _, joints): (&str, &str, u64)| RobotInfo {
        properties: None,
        name: name.into(),
        hash: format!("{:064x}", joints * 104_729 + name.len() as u64),
        origin: ModelOrigin::Generated,
        licence: "BSD-3-Clause".into(),
        source: format!("gen {name}"),
        nq: joints,
        nv: joints,
        bodies: joints,
        depth: joints,
        notes: Vec::new(),
    };
    OWN.into_iter().map(model).collect()
}

/// Whether a robot is of these studies alone.
pub fn is_own(model: &RobotInfo) -> bool {
    OWN.iter().any(|(name, ..)| *name == model.name)
}

/// Appends the rows.
pub fn rows(run: &RunInfo, random: &mut Random, rows: &mut Vec<Row>) {
    for model in &run.robots {
        let family = OWN.iter().find(|(name, ..)| *name == model.name).map_or_else(|| super::family(model), |(_, family, _)| family);
        let row = Row { family: family.into(), ..base(run, model) };
        if model.name.starts_with("straight") {
            conditioning(&row, model.nv as f64, rows);
        } else if is_own(model) || model.name.starts_with("chain") || model.name == HOSTILE {
            digits(&row, model, random, rows);
        }
    }
}

fn number_after(name: &str, suffix: &str) -> Option<f64> {
    name.split_once(suffix)?.1.parse().ok()
}

/// The median error of a method: a little for rounding, more for depth, offset and a heavy tip.
fn median(method: &str, model: &RobotInfo) -> f64 {
    let n = model.nv as f64;
    let offset = number_after(&model.name, "-offset").unwrap_or(0.0);
    let tip = number_after(&model.name, "-tip").unwrap_or(1.0).max(1.0);
    2e-16
        * match method {
            "aba" | "aba_local" => n.powf(0.3) * tip,
            "ltdl" => n.powi(4) * tip,
            "aba_world" => n.powi(2) * tip + 50.0 * offset.powi(2),
            "forward" => n.powi(4) * tip + 1e6 * offset,
            _ => 1.0,
        }
}

fn digits(row: &Row, model: &RobotInfo, random: &mut Random, rows: &mut Vec<Row>) {
    for (engine, method, quantity) in SUBJECTS {
        let quantity = if quantity == "mass_matrix" && model.nv > 64 { "mass_matrix_probe" } else { quantity };
        let row = Row {
            study: "accuracy".into(),
            engine: engine.into(),
            method: method.into(),
            quantity: quantity.into(),
            states: "all".into(),
            reference: "truth".into(),
            ..row.clone()
        };
        if engine == "drake" && model.name == HOSTILE {
            rows.push(row.without_value(Verdict::Error, "M is singular: there is no true answer"));
            continue;
        }
        if engine == "mujoco" && model.name == HOSTILE {
            rows.push(row.without_value(Verdict::Skip, "no helical joint </script>"));
            continue;
        }
        let error = if model.nv == 2 && quantity == "id" { 0.0 } else { median(method, model) };
        let spread = 1.5 + random.unit();
        if quantity == "fd" {
            let row = Row { metric: "true_forward".into(), floor: Some(2e-16 * model.nv as f64), ..row.clone() };
            rows.push(row.gated(error, Relation::Le, 1e-7));
        } else {
            rows.push(Row { metric: "true".into(), ..row.clone() }.gated(3.0 * error, Relation::Le, 1e-14));
        }
        let floor = (quantity == "fd").then_some(2e-16 * model.nv as f64);
        for (metric, factor) in [("error_q1", 1.0 / spread), ("error_median", 1.0), ("error_q3", spread), ("error_worst", 9.0)] {
            rows.push(Row { metric: metric.into(), floor, ..row.clone() }.informed(error * factor));
        }
    }
    if model.name == "rand3d-20-tip1e6" {
        let row = Row { study: "accuracy".into(), engine: "all".into(), quantity: "fd".into(), states: "all".into(), ..row.clone() };
        rows.push(Row { metric: "limited_by_the_reference".into(), ..row }.informed(3.0));
    }
}

fn conditioning(row: &Row, n: f64, rows: &mut Vec<Row>) {
    let row = Row {
        study: "conditioning".into(),
        engine: "featherbench".into(),
        method: "eigenvalues".into(),
        quantity: "mass_matrix".into(),
        states: "straight".into(),
        ..row.clone()
    };
    let metric = |metric: &str, floor| Row { metric: metric.into(), floor, ..row.clone() };
    rows.push(metric("kappa", Some(1e-16 * n)).informed(3.0 * n.powi(4)));
    rows.push(metric("kappa_scaled", Some(1e-16 * n)).informed(2.0 * n.powf(4.25)));
    if n > 8.0 {
        rows.push(metric("kappa_exponent", None).gated(4.0, Relation::Ge, 3.5));
        rows.push(metric("kappa_scaled_exponent", None).informed(4.25));
    }
}
