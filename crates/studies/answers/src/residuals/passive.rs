//! Projections of drawn linear residuals onto passive ones: the certificate, nearness, and the energy along a motion.

use super::forces::draw;
use super::{Case, arm, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::Energy;
use featherbench_dynamics::integrate::{Integrator, RungeKutta4};
use featherbench_model::Model;
use featherbench_residuals::{Corrected, Linear, Passive, Projection, Rigid};
use featherbench_robots::Random;
use nalgebra::DMatrix;
use serde_json::json;

const DRAWS: usize = 50;
/// The smallest eigenvalue that L + A must have, kg·m².
const MARGIN: f64 = 1e-3;

pub(super) fn cases() -> Vec<Case> {
    [2, 7, 18].map(projections).into_iter().chain([energy_law()]).collect()
}

fn projection(n: usize) -> Projection {
    Projection { mass_below: DMatrix::zeros(n, n), margin: MARGIN }
}

/// Of drawn residuals of n dofs: how many certificates fail, the smallest eigenvalues, and how far they are from nearest.
///
/// The nearest point P of a convex set to X has ⟨X − P, Y − P⟩ ≤ 0 for each Y of it. `beyond_nearest` is the largest of these products, over
/// |X|², with other projections as Y.
fn projections(n: usize) -> Case {
    Case {
        name: format!("{n} dofs"),
        quantity: "passive",
        method: "projection".into(),
        params: json!({"dofs": n, "draws": DRAWS, "margin": MARGIN}),
        numbers: vec![
            count("violations", 0.0, "theory"),
            error("beyond_nearest", "theory"),
            told("smallest_damping", "N·m·s/rad"),
            told("smallest_inertia", "kg·m²"),
            told("moved", "1"),
        ],
        evaluate: Box::new(move |seed| {
            let mut random = Random::named(seed, &format!("passive {n}"));
            let (mut violations, mut moved, mut raw, mut near) = (0, 0.0_f64, Vec::new(), Vec::new());
            let [mut damping, mut inertia] = [f64::INFINITY; 2];
            for _ in 0..DRAWS {
                let theta = draw(&mut random, Linear::parameters(n, n));
                let linear = Linear::new(n, n, theta.clone()).map_err(failed)?;
                let (passive, distance) = Passive::nearest(&linear, &projection(n)).map_err(failed)?;
                let certificate = passive.certificate(&projection(n).mass_below).map_err(failed)?;
                violations += usize::from(!certificate.holds(n as f64 * passive.damping_scale()));
                // A NaN would have failed its certificate.
                (damping, inertia) = (damping.min(certificate.damping), inertia.min(certificate.inertia));
                moved += distance / DRAWS as f64;
                near.push(passive.to_linear().map_err(failed)?.theta().to_vec());
                raw.push(theta);
            }
            let product = |x: &[f64], p: &[f64], y: &[f64]| (0..x.len()).map(|k| (x[k] - p[k]) * (y[k] - p[k])).sum::<f64>();
            let over = |x: &[f64], p: &[f64], y: &[f64]| {
                let share = product(x, p, y) / x.iter().map(|x| x * x).sum::<f64>();
                if share < 0.0 { 0.0 } else { share }
            };
            let beyond = (0..DRAWS).flat_map(|k| near.iter().map(move |y| (k, y))).map(|(k, y)| over(&raw[k], &near[k], y));
            Ok(vec![violations as f64, largest(beyond), damping, inertia, moved])
        }),
    }
}

/// d/dt (Ê + E) = −vᵀD v along a motion of the arm without forces: the integral of the right side beside the change of the left.
fn energy_law() -> Case {
    const STEP: f64 = 1e-3;
    const STEPS: usize = 2000;
    Case {
        name: "arm with a drawn passive residual".into(),
        quantity: "passive",
        method: "energy law".into(),
        params: json!({"step": STEP, "steps": STEPS}),
        numbers: vec![error("energy_error", "theory"), told("dissipated", "J")],
        evaluate: Box::new(|seed| {
            let model = Model::<f64>::build(&arm(1.0).describe()).map_err(failed)?;
            let mut random = Random::named(seed, "passive motion");
            let mut theta = draw(&mut random, 14);
            // More damping than is drawn, so that some is left: entries of D at row · 7 + 2 + column.
            [2, 10].into_iter().for_each(|place| theta[place] += 1.0);
            let linear = Linear::new(2, 2, theta).map_err(failed)?;
            let (passive, _) = Passive::nearest(&linear, &projection(2)).map_err(failed)?;
            let mut corrected = Corrected::new(Rigid::new(&model), passive.clone()).map_err(failed)?;
            let energy = |q: &[f64], v: &[f64]| -> Result<f64, NoAnswer> {
                let nominal = Energy::new(&model.topology).run(&model, q, v).map_err(failed)?;
                Ok(nominal.kinetic + nominal.potential + passive.energy(q, v).map_err(failed)?)
            };
            // An acceleration that is not found ends the motion as NaN.
            let mut acceleration = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
                match corrected.forward(q, v, &[0.0; 2]) {
                    Ok(found) => a.copy_from_slice(&found),
                    Err(_) => a.fill(f64::NAN),
                }
                Ok(())
            };
            let (mut q, mut v) = (vec![0.6, -0.4], vec![0.7, 0.4]);
            let start = energy(&q, &v)?;
            let mut powers = vec![passive.dissipated(&v).map_err(failed)?];
            let mut rule = RungeKutta4::new(&model.topology);
            for step in 0..STEPS {
                rule.step(&mut acceleration, step as f64 * STEP, STEP, &mut q, &mut v).map_err(failed)?;
                powers.push(passive.dissipated(&v).map_err(failed)?);
            }
            // Simpson's rule.
            let lost: f64 = powers.windows(3).step_by(2).map(|p| STEP / 3.0 * (p[0] + 4.0 * p[1] + p[2])).sum();
            let change = energy(&q, &v)? - start;
            Ok(vec![(change + lost).abs() / largest([start, change, lost]), lost])
        }),
    }
}
