//! The derivative of an elastic bounce: ∂(z, ż)(T)/∂(z, ż)(0) of a ball that falls on the ground, by each engine against the exact one.
//!
//! ```text
//! s = √(v₀² + 2 g z₀),  t₁ = (v₀ + s)/g,  τ = T − t₁      z = s τ − ½ g τ²,  ż = s − g τ
//! ```
//!
//! An engine's ground is a spring of stiffness k. Its own derivative is off by −(∂ż/∂x₀) π √(m/k) in z (`guide/studies/scenes.md`, "Derivative of a bounce"): the row
//! `spring_share` says how much of the error that is. What is left comes from steps that do not meet the instant of the impact.

use super::rows::{Told, blank, without_answer};
use super::{BOUNCE, cell, of_engine};
use featherbench_bench::{Asked, Cell, Context, Gates, NoAnswer, OWN, Outcome};
use featherbench_hybrid::systems::BouncingBall;
use featherbench_hybrid::{Settings, Start, sensitivity, simulate};
use featherbench_results::{Row, Verdict};
use featherbench_scenes::{Body, Scene};
use featherbench_spatial::larger;
use serde_json::json;

/// z₀ and T: from rest.
const HEIGHT: f64 = 1.0;
const DURATION: f64 = 0.7;
const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.1;
const MASS: f64 = 1.0;
/// Stiffnesses, N/m, with steps, s.
const CASES: [(f64, f64); 5] = [(1e4, 1e-3), (1e4, 1e-4), (1e4, 1e-5), (1e6, 1e-3), (1e6, 1e-4)];

/// z, ż and their derivative, row by row.
pub(super) fn exact() -> [f64; 6] {
    let (g, s) = (GRAVITY, (2.0 * GRAVITY * HEIGHT).sqrt());
    let tau = DURATION - s / g;
    let (z, v) = (s * tau - g * tau * tau / 2.0, s - g * tau);
    // ∂s/∂z₀ = g/s and ∂τ/∂z₀ = −1/s; at rest ∂s/∂v₀ = 0 and ∂τ/∂v₀ = −1/g.
    [z, v, g / s * tau - v / s, -v / g, 2.0 * g / s, 1.0]
}

fn scene() -> Scene {
    let ball = Body::ball("ball", MASS, RADIUS, [0.0, 0.0, RADIUS + HEIGHT]);
    Scene { name: "elastic_bounce".into(), gravity: [0.0, 0.0, -GRAVITY], friction: 0.5, restitution: 1.0, bodies: vec![ball] }
}

/// Ours, and a cell for each way of each engine.
pub(super) fn plan(context: &Context) -> Vec<Cell> {
    let mut cells = Vec::new();
    for engine in context.engines {
        let identity = engine.identity();
        if identity.name == OWN {
            cells.push(cell("elastic_bounce", of_engine(identity), "saltation", BOUNCE, json!({"height": HEIGHT, "duration": DURATION})));
        }
        let variants = engine.scene_engine().map(|scenes| scenes.derivative_variants()).unwrap_or_default();
        cells.extend(variants.iter().map(|variant| {
            let params = json!({"height": HEIGHT, "duration": DURATION, "cases": CASES, "settings": variant.settings});
            cell("elastic_bounce", of_engine(identity), &variant.name, BOUNCE, params)
        }));
    }
    cells
}

/// Six numbers of each case: z, ż, and the derivative row by row.
pub(super) fn evaluate(asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
    if asked.cell.engine == OWN {
        return own();
    }
    let engine = asked.offered(|engine| engine.scene_engine())?;
    let mut values = Vec::new();
    for (stiffness, dt) in CASES {
        let found = engine.differentiate(&scene(), &asked.cell.method, stiffness, dt, (DURATION / dt).round() as usize)?;
        values.extend([found.state[0] - RADIUS, found.state[1]]);
        values.extend(found.matrix.as_flattened());
    }
    Ok(values)
}

/// By the saltation matrix of `featherbench_hybrid`.
fn own() -> Result<Vec<f64>, NoAnswer> {
    let failed = |error: featherbench_hybrid::HybridError| NoAnswer::Failed(error.to_string());
    let start = Start { mode: 0, time: 0.0, state: vec![HEIGHT, 0.0, 0.0] };
    let theta = [GRAVITY, 1.0];
    let run = simulate(&BouncingBall, &theta, &start, DURATION, &Settings::default()).map_err(failed)?;
    let by = sensitivity(&BouncingBall, &theta, &run).map_err(failed)?;
    let lost = || NoAnswer::Failed("the run has no state at its end".into());
    let end = run.state.first().zip(run.state.get(1)).ok_or_else(lost)?;
    let column = |k: usize| by.columns.get(k).and_then(|column| Some([*column.first()?, *column.get(1)?])).ok_or_else(lost);
    let ([zz, vz], [zv, vv]) = (column(0)?, column(1)?);
    Ok(vec![*end.0, *end.1, zz, zv, vz, vv])
}

/// Of each case: the derivative's entries by z₀, its error, how much of that is the spring's, and the state's error.
pub(super) fn rows(gates: &Gates, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let own = cell.engine == OWN;
    let values = match outcome.answer() {
        Ok(values) => values,
        Err(no_answer) => return vec![without_answer(blank(cell, &cell.params), no_answer)],
    };
    let cases = if own { &[(f64::INFINITY, 0.0)][..] } else { &CASES[..] };
    if values.len() != 6 * cases.len() {
        let due = format!("{} numbers came, {} are due", values.len(), 6 * cases.len());
        return vec![blank(cell, &cell.params).without_value(Verdict::Error, due)];
    }
    let exact = exact();
    let error = |found: &[f64]| {
        let scale = exact[2..].iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
        found.iter().zip(&exact[2..]).map(|(found, exact)| (found - exact).abs()).fold(0.0, larger) / scale
    };
    let mut rows = Vec::new();
    for (&(stiffness, dt), found) in cases.iter().zip(values.chunks_exact(6)) {
        let settings = cell.params["settings"].clone();
        let told = Told { scene: None, duration: None, settings, dt: Some(dt), stiffness: Some(stiffness) };
        let params = if own { cell.params.clone() } else { json!(told) };
        let of = |metric: &str, unit: &str| Row {
            metric: metric.into(),
            unit: unit.into(),
            reference: "closed form".into(),
            ..blank(cell, &params)
        };
        let row = of("derivative_error", "1");
        rows.push(if own { gates.judge(row, error(&found[2..]), 1.0) } else { row.informed(error(&found[2..])) });
        rows.push(of("dz_dz0", "1").informed(found[2]));
        rows.push(of("dv_dz0", "1/s").informed(found[4]));
        let off = (found[0] - exact[0]).abs() / HEIGHT;
        rows.push(of("state_error", "1").informed(larger(off, (found[1] - exact[1]).abs() / exact[1].abs())));
        if !own {
            let spring = std::f64::consts::PI * (MASS / stiffness).sqrt();
            let moved = [-exact[4] * spring, -exact[5] * spring, 0.0, 0.0];
            let of_spring: Vec<f64> = exact[2..].iter().zip(moved).map(|(exact, moved)| exact + moved).collect();
            rows.push(of("spring_share", "1").informed(error(&of_spring)));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form by differences of itself, and by the saltation matrix.
    #[test]
    fn the_exact_derivative_by_two_routes() {
        let exact = exact();
        let end = |z0: f64, v0: f64| {
            let s = (v0 * v0 + 2.0 * GRAVITY * z0).sqrt();
            let tau = DURATION - (v0 + s) / GRAVITY;
            [s * tau - GRAVITY * tau * tau / 2.0, s - GRAVITY * tau]
        };
        let h = 1e-6;
        for row in 0..2 {
            let by_z = (end(HEIGHT + h, 0.0)[row] - end(HEIGHT - h, 0.0)[row]) / (2.0 * h);
            let by_v = (end(HEIGHT, h)[row] - end(HEIGHT, -h)[row]) / (2.0 * h);
            // Central differences of 1e-6 leave 1e-9.
            assert!((by_z - exact[2 + 2 * row]).abs() < 1e-8 && (by_v - exact[3 + 2 * row]).abs() < 1e-8);
        }
        assert!((exact[2] - 0.1006).abs() < 1e-4 && (exact[4] - 4.429).abs() < 1e-3);
        for (ours, exact) in own().unwrap().iter().zip(exact) {
            assert!((ours - exact).abs() < 1e-12, "{ours:e} {exact:e}");
        }
    }
}
