//! The balance of power along an exact motion: ∫ (vᵀτ − dÊ/dt) dt = ∫ vᵀr dt, to the order of the quadrature.

use super::{Case, arm, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::{energy, inverse_dynamics};
use featherbench_model::Model;
use featherbench_residuals::{Payload, PowerBalance, Quadrature, State};
use serde_json::json;

/// Intervals of the finest sum, and of the one before it. The sixth order reaches 1e-13 there, above rounding.
const INTERVALS: [usize; 2] = [16, 32];
/// The length of the motion, s. It is no period of it: over one, each rule would be exact.
const TIME: f64 = 2.0;
/// Amplitude (rad) and rate (rad/s) of each joint.
const WAVES: [[f64; 2]; 2] = [[0.8, 1.3], [-0.6, 2.1]];

pub(super) fn cases() -> Vec<Case> {
    Quadrature::ALL.map(case).into()
}

fn motion(time: f64) -> [Vec<f64>; 3] {
    let waves = WAVES.map(|[amplitude, rate]| {
        let (sine, cosine) = (rate * time).sin_cos();
        [amplitude * sine, amplitude * rate * cosine, -amplitude * rate * rate * sine]
    });
    [0, 1, 2].map(|order| waves.iter().map(|wave| wave[order]).collect())
}

/// The true arm has 1.2 kg in its second rod, the nominal one 1 kg: r is a payload, and τ the true inverse dynamics.
fn case(rule: Quadrature) -> Case {
    Case {
        name: "arm with a heavier rod".into(),
        quantity: "power",
        method: rule.name().into(),
        params: json!({"intervals": INTERVALS, "time": TIME, "waves": WAVES}),
        numbers: vec![error("order_error", "theory"), told("order", "1"), told("balance_error", "J"), told("residual_work", "J")],
        evaluate: Box::new(move |_| {
            let [nominal, truth] = [1.0, 1.2].map(|mass| Model::<f64>::build(&arm(mass).describe()));
            let (nominal, truth) = (nominal.map_err(failed)?, truth.map_err(failed)?);
            let inertia = 0.2 * 0.25 / 12.0;
            let payload = Payload::new(&arm(1.0).describe(), 1, 0.2, [0.0, 0.0, -0.25], [inertia, 0.0, 0.0, inertia, 0.0, 0.0]);
            let payload = payload.map_err(failed)?;
            let balance = |intervals: usize| {
                let forces = |state: &State<'_>| Ok(inverse_dynamics(&truth, state.q, state.v, state.a)?);
                let stored = |q: &[f64], v: &[f64]| Ok(energy(&nominal, q, v).map(|parts| parts.kinetic + parts.potential)?);
                PowerBalance::of((rule, intervals, TIME), motion, &payload, forces, stored)
            };
            let [coarse, fine] = INTERVALS.map(balance);
            let (coarse, fine) = (coarse.map_err(failed)?, fine.map_err(failed)?);
            if fine.error() == 0.0 {
                return Err(NoAnswer::Failed("the finest sum has no error to fit".into()));
            }
            let order = (coarse.error() / fine.error()).abs().log2();
            Ok(vec![(order - f64::from(rule.order())).abs(), order, fine.error().abs(), fine.residual])
        }),
    }
}
