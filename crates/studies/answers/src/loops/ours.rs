//! Our methods, behind the same trait as engines.

use super::ask::Question;
use super::drive::Driven;
use super::systems::System;
use featherbench_bench::{LoopAccelerations, LoopDrive, LoopMotion, LoopSolver, LoopStates, LoopSteps, NoAnswer};
use featherbench_constrained::stabilise::{Projection, Simulation, Stabilisation};
use featherbench_constrained::{Constrained, Kkt, Mechanism, Method, Proximal, RangeSpace};
use featherbench_model::Description;
use featherbench_study::known::failed;
use serde_json::{Value, json};
use std::time::Instant;

const ACCELERATIONS: [&str; 3] = ["kkt", "range_space", "proximal"];
/// The reference first: it is what the limit of steps is made of.
const MOTIONS: [&str; 2] = ["rk4_kkt_projection", "rk4_kkt_baumgarte"];
/// Rows that depend on others at a flat parallelogram do so to the digits that a state has: 10⁻¹⁶ of an angle, over 10⁻⁶.
const RANK: f64 = 1e-10;
/// The time constant of Baumgarte's stabilisation, s: that of Pinocchio's method beside it.
const BAUMGARTE: f64 = 0.05;

/// The methods for a question. Bricard's six-bar has no motion by Baumgarte's stabilisation: beside its loop the redundant row is independent, and
/// the acceleration that it asks for contradicts the others.
pub(super) fn methods(question: &Question) -> &'static [&'static str] {
    match question {
        Question::Accelerations(_) | Question::Singular => &ACCELERATIONS,
        Question::Motion(..) if question.system() == System::Bricard => &MOTIONS[..1],
        Question::Motion(..) => &MOTIONS,
    }
}

/// Our engine as one that holds loops.
pub(super) struct Ours;

fn method(name: &str) -> Result<Box<dyn Method>, NoAnswer> {
    Ok(match name {
        "kkt" => Box::new(Kkt::default()),
        "range_space" => Box::new(RangeSpace::default()),
        "proximal" => Box::new(Proximal::default()),
        _ => return Err(NoAnswer::NotOffered(format!("we have no method {name}"))),
    })
}

impl LoopSolver for Ours {
    fn acceleration_methods(&self) -> Vec<String> {
        ACCELERATIONS.map(str::to_owned).into()
    }

    fn motion_methods(&self) -> Vec<String> {
        MOTIONS.map(str::to_owned).into()
    }

    fn loop_accelerations(
        &self,
        robot: &Description,
        name: &str,
        states: &LoopStates,
        repeats: usize,
    ) -> Result<LoopAccelerations, NoAnswer> {
        let method = method(name)?;
        let mechanism = Mechanism::of(robot).map_err(failed)?;
        let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).map_err(failed)?;
        let (nq, nv) = (robot.nq(), robot.nv());
        let mut acceleration = Vec::with_capacity(states.v.len());
        let start = Instant::now();
        for _ in 0..repeats {
            acceleration.clear();
            for k in 0..states.count {
                let (q, v, tau) = (&states.q[k * nq..][..nq], &states.v[k * nv..][..nv], &states.tau[k * nv..][..nv]);
                acceleration.extend(dynamics.run(q, v, tau, method.as_ref()).map_err(failed)?.acceleration);
            }
        }
        Ok(LoopAccelerations { acceleration, time: start.elapsed(), settings: settings(name) })
    }

    /// Its time includes the measurement of drift after each step.
    fn loop_motion(
        &self,
        robot: &Description,
        drive: Option<&LoopDrive>,
        name: &str,
        (q, v): (&[f64], &[f64]),
        steps: LoopSteps,
    ) -> Result<LoopMotion, NoAnswer> {
        let stabilisation = match name {
            "rk4_kkt_projection" => Stabilisation::Projection(Projection { tolerance: 1e-12, cut: 1e-8, iterations: 50, reach: 0.5 }),
            "rk4_kkt_baumgarte" => Stabilisation::Baumgarte { alpha: 1.0 / BAUMGARTE, beta: 1.0 / BAUMGARTE },
            _ => return Err(NoAnswer::NotOffered(format!("we have no motion by {name}"))),
        };
        let mechanism = Mechanism::of(robot).map_err(failed)?;
        let (model, constraints) = (&mechanism.model, &mechanism.constraints);
        let method = &Kkt { tolerance: RANK };
        let driven = drive.map(|drive| Driven { drive, model });
        let forces = |_: f64, q: &[f64], _: &[f64], tau: &mut [f64]| {
            // A run refuses forces that are not finite.
            if driven.as_ref().is_some_and(|driven| driven.add(q, tau).is_err()) {
                tau.fill(f64::NAN);
            }
        };
        let simulation = Simulation { model, constraints, forces: &forces, method, stabilisation };
        let LoopSteps { dt, steps, every } = steps;
        let (mut at, mut rate) = (q.to_vec(), v.to_vec());
        let (mut qs, mut vs) = (Vec::new(), Vec::new());
        let start = Instant::now();
        for _ in 0..steps / every {
            let run = simulation.run(&at, &rate, dt, every).map_err(failed)?;
            (at, rate) = (run.q, run.v);
            qs.extend_from_slice(&at);
            vs.extend_from_slice(&rate);
        }
        Ok(LoopMotion { q: qs, v: vs, time: start.elapsed(), settings: settings(name) })
    }
}

fn settings(name: &str) -> Value {
    match name {
        "kkt" => json!({"rank": Kkt::default().tolerance}),
        "range_space" => json!({"rank": RangeSpace::default().tolerance}),
        "proximal" => {
            let Proximal { mu, tolerance, iterations } = Proximal::default();
            json!({"mu_share": mu, "accuracy": tolerance, "iterations": iterations})
        }
        "rk4_kkt_baumgarte" => json!({"rank": RANK, "baumgarte_seconds": BAUMGARTE}),
        _ => json!({"rank": RANK, "projection": 1e-12}),
    }
}
