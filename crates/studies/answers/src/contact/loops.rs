//! Robots with loops: mobility, constrained dynamics, and drift in time.

use super::{Case, Number, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_constrained::stabilise::{Projection, Run, Simulation, Stabilisation};
use featherbench_constrained::systems::{Biped, Bricard, Ladder, Squeezer};
use featherbench_constrained::{Constrained, Kkt, Mechanism, Method, Mobility, Proximal, RANK, RangeSpace};
use featherbench_model::neutral;
use featherbench_robots::Random;
use serde_json::json;

/// Draws of each case.
const DRAWS: usize = 200;

pub(super) fn cases() -> Vec<Case> {
    let named = [Named::FourBar, Named::TwoWindows, Named::Bricard, Named::Squeezer, Named::Biped];
    named.into_iter().map(mobility).chain(accelerations()).chain(runs()).chain([singularity(), squeezer()]).collect()
}

/// A robot of `featherbench_constrained::systems`, with what is known of its mobility.
#[derive(Clone, Copy)]
pub(super) enum Named {
    FourBar,
    TwoWindows,
    Bricard,
    Squeezer,
    Biped,
}

impl Named {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::FourBar => "four-bar",
            Self::TwoWindows => "four-bar, two windows",
            Self::Bricard => "Bricard",
            Self::Squeezer => "Andrews' squeezer",
            Self::Biped => "biped",
        }
    }

    /// The dimension of motions, Grübler's count, and the true mobility.
    fn known(self) -> (usize, f64, f64) {
        match self {
            Self::FourBar | Self::TwoWindows | Self::Squeezer => (3, 1.0, 1.0),
            Self::Bricard => (6, 0.0, 1.0),
            Self::Biped => (6, 6.0, 12.0),
        }
    }

    /// The robot, and a configuration that closes its loops.
    pub(super) fn make(self) -> Result<(Mechanism, Vec<f64>), NoAnswer> {
        let ladder = |windows| Ladder { windows, ..Ladder::default() };
        let (mechanism, q) = match self {
            Self::FourBar => (ladder(1).mechanism(), Some(ladder(1).spread(0.7))),
            Self::TwoWindows => (ladder(2).mechanism(), Some(ladder(2).spread(0.7))),
            Self::Bricard => (Bricard::default().mechanism(), Some(vec![0.0; 5])),
            Self::Squeezer => (Squeezer::default().mechanism(), Some(Squeezer::start().to_vec())),
            Self::Biped => (Biped::default().mechanism(), None),
        };
        let mechanism = mechanism.map_err(failed)?;
        let q = q.unwrap_or_else(|| neutral(&mechanism.model.topology));
        Ok((mechanism, q))
    }
}

/// Grübler's count, and the true mobility: the least of the drawn configurations, since a singular one has more. How many have more is told, and
/// how many were drawn nearer because their projection did not end.
fn mobility(named: Named) -> Case {
    let (motion, gruebler, freedom) = named.known();
    Case {
        name: named.name().into(),
        quantity: "mobility",
        method: "rank".into(),
        params: json!({"motion": motion, "tolerance": RANK, "draws": DRAWS}),
        numbers: vec![
            count("gruebler", gruebler, "theory"),
            count("freedom", freedom, "theory"),
            told("singular", "1"),
            told("halved", "1"),
            error("loop", "loops"),
        ],
        evaluate: Box::new(move |seed| {
            let (mechanism, start) = named.make()?;
            let (model, constraints) = (&mechanism.model, &mechanism.constraints);
            let mut random = Random::named(seed, named.name());
            let (mut found, mut open, mut halved) = (Vec::new(), 0.0, 0);
            for _ in 0..DRAWS {
                let step: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-0.2, 0.2)).collect();
                // A row that depends on others does so on the loops alone: next to them it has a rest of the size of the residual.
                let closing = Projection { tolerance: 1e-14, ..Projection::default() };
                let (q, halvings) = closing.beside(model, constraints, &start, &step).map_err(failed)?;
                halved += usize::from(halvings > 0);
                let mobility = Mobility::at(model, constraints, &q).map_err(failed)?;
                found.push(mobility.freedom());
                open = largest([open, mobility.residual]);
            }
            let least = found.iter().min().copied().unwrap_or_default();
            let singular = found.iter().filter(|freedom| **freedom > least).count();
            Ok(vec![mechanism.graph.gruebler(motion) as f64, least as f64, singular as f64, halved as f64, open])
        }),
    }
}

/// A method by its name.
fn method(name: &str) -> Result<Box<dyn Method>, NoAnswer> {
    Ok(match name {
        "kkt" => Box::new(Kkt::default()),
        "range_space" => Box::new(RangeSpace::default()),
        "proximal" => Box::new(Proximal::default()),
        _ => return Err(NoAnswer::Failed(format!("there is no method '{name}'"))),
    })
}

/// θ̈ of ladders with random numbers, against the closed form, in its own size and that of the centripetal terms.
fn accelerations() -> impl Iterator<Item = Case> {
    let of = |windows: usize| ["kkt", "range_space", "proximal"].into_iter().map(move |name| acceleration(windows, name));
    [1, 2, 5, 40].into_iter().flat_map(of)
}

fn acceleration(windows: usize, by: &'static str) -> Case {
    // Forty windows cost a second per hundred draws.
    let draws = if windows < 10 { DRAWS } else { 10 };
    let iterative = by == "proximal";
    let of = |metric, reference| if iterative { Number { reference, ..told(metric, "1") } } else { error(metric, reference) };
    Case {
        name: format!("four-bar, {windows} windows"),
        quantity: "loop_dynamics",
        method: by.into(),
        params: json!({"windows": windows, "draws": draws}),
        numbers: vec![of("error", "closed form"), of("residual", "equations"), told("iterations", "1")],
        evaluate: Box::new(move |seed| {
            let method = method(by)?;
            let mut random = Random::named(seed, &format!("{windows} windows"));
            let (mut missed, mut residual, mut iterations) = (0.0, 0.0, 0_usize);
            for _ in 0..draws {
                let ladder = Ladder {
                    windows,
                    crank: random.uniform(0.5, 2.0),
                    coupler: random.uniform(0.5, 2.0),
                    crank_mass: random.uniform(0.5, 2.0),
                    coupler_mass: random.uniform(0.5, 2.0),
                    gravity: random.uniform(5.0, 15.0),
                };
                let mechanism = ladder.mechanism().map_err(failed)?;
                let (theta, rate) = (random.uniform(-1.2, 1.2), random.uniform(-2.0, 2.0));
                let (q, v) = (ladder.spread(theta), ladder.spread(rate));
                let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).map_err(failed)?;
                let found = dynamics.run(&q, &v, &vec![0.0; v.len()], method.as_ref()).map_err(failed)?;
                let due = ladder.spread(ladder.acceleration(theta));
                let size = largest(due.iter().copied()) + rate * rate;
                missed = largest([missed, largest(found.acceleration.iter().zip(&due).map(|(a, b)| a - b)) / size]);
                residual = largest([residual, found.residual / size]);
                if found.iterations > iterations {
                    iterations = found.iterations;
                }
            }
            Ok(vec![missed, residual, iterations as f64])
        }),
    }
}

fn projected(mechanism: &Mechanism, method: &Kkt, q: &[f64], v: &[f64], step: f64, steps: usize) -> Result<Run, NoAnswer> {
    let simulation = Simulation {
        model: &mechanism.model,
        constraints: &mechanism.constraints,
        forces: &|_, _, _, _| (),
        method,
        stabilisation: Stabilisation::Projection(Projection { tolerance: 1e-12, cut: 1e-8, iterations: 50, reach: 0.5 }),
    };
    simulation.run(q, v, step, steps).map_err(failed)
}

/// Seconds that a run lasts.
const SECONDS: f64 = 10.0;

/// IFToMM A02 with N windows and A04: 10 s by two steps. The loops stay closed; the energy drifts at the integrator's order.
fn runs() -> impl Iterator<Item = Case> {
    let ladders = [1, 2, 5].into_iter().map(|windows| (format!("A02, N = {windows}"), Some(windows)));
    ladders.chain([("A04".to_owned(), None)]).map(|(name, windows)| Case {
        name,
        quantity: "loop_motion",
        method: "kkt, projection".into(),
        params: json!({"windows": windows, "seconds": SECONDS}),
        numbers: vec![error("loop", "loops"), error("order", "theory"), told("energy_drift", "J"), told("coarse_energy_drift", "J")],
        evaluate: Box::new(move |_| {
            let (mechanism, q, v) = match windows {
                Some(windows) => {
                    let ladder = Ladder { windows, ..Ladder::default() };
                    // θ = π points up, where the tip's speed along x is a θ̇: 1 m/s.
                    let start = (ladder.spread(std::f64::consts::PI), ladder.spread(1.0 / ladder.crank));
                    (ladder.mechanism().map_err(failed)?, start.0, start.1)
                }
                None => (Bricard::default().mechanism().map_err(failed)?, vec![0.0; 5], vec![0.0; 5]),
            };
            let run = |steps: usize| projected(&mechanism, &Kkt { tolerance: 1e-10 }, &q, &v, SECONDS / steps as f64, steps);
            let [coarse, fine] = [run(1250)?, run(2500)?];
            let order = (coarse.energy_drift() / fine.energy_drift()).log2();
            // The method of Runge and Kutta: at least fourth order. Where errors of fifth order count, the drift falls faster.
            let missed = if order < 4.0 { 4.0 - order } else { 0.0 };
            Ok(vec![largest([coarse.position_drift(), fine.position_drift()]), missed, fine.energy_drift(), coarse.energy_drift()])
        }),
    })
}

/// The parallelogram three times through its flat configuration.
fn singularity() -> Case {
    Case {
        name: "four-bar through its singularity".into(),
        quantity: "loop_motion",
        method: "kkt, projection".into(),
        params: json!({"start": 3.0, "rate": 1.0, "steps": [750, 1500, 3000]}),
        numbers: vec![error("loop", "loops"), error("order", "theory"), told("energy_drift", "J"), told("coarse_energy_drift", "J")],
        evaluate: Box::new(|_| {
            let ladder = Ladder::default();
            let mechanism = ladder.mechanism().map_err(failed)?;
            let (q, v) = (ladder.spread(3.0), ladder.spread(1.0));
            let run = |steps: usize| projected(&mechanism, &Kkt { tolerance: 1e-10 }, &q, &v, 3.0 / steps as f64, steps);
            let [coarse, fine] = [run(1500)?, run(3000)?];
            let order = (coarse.energy_drift() / fine.energy_drift()).log2();
            let missed = if order < 4.0 { 4.0 - order } else { 0.0 };
            Ok(vec![largest([coarse.position_drift(), fine.position_drift()]), missed, fine.energy_drift(), coarse.energy_drift()])
        }),
    }
}

/// β, Θ, γ, δ, Φ, ε, Ω of the squeezer at 0.03 s, as the test set for IVP solvers prints them.
const WITNESS: [f64; 7] = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    0.524_409_965_880_530_4,
    -0.534_730_116_322_694_8,
    1.048_080_741_042_263,
    0.534_730_116_322_694_8,
];

/// Andrews' squeezer at 0.03 s: Richardson's limit of two steps, against the witness. Two formulations of ours agree to 2e-11, and differ from the
/// witness by 1.2e-9 in β: that is the witness's accuracy.
fn squeezer() -> Case {
    Case {
        name: "Andrews' squeezer at 0.03 s".into(),
        quantity: "loop_motion",
        method: "kkt, projection".into(),
        params: json!({"steps": [3000, 6000]}),
        numbers: vec![error("loop", "loops"), error("witness", "test set for IVP solvers"), told("of_limit", "rad")],
        evaluate: Box::new(|_| {
            let squeezer = Squeezer::default();
            let mechanism = squeezer.mechanism().map_err(failed)?;
            let forces = |_: f64, q: &[f64], _: &[f64], tau: &mut [f64]| squeezer.add_forces(q, tau);
            let simulation = Simulation {
                model: &mechanism.model,
                constraints: &mechanism.constraints,
                forces: &forces,
                method: &Kkt::default(),
                stabilisation: Stabilisation::Projection(Projection::default()),
            };
            let run = |steps: usize| simulation.run(&Squeezer::start(), &[0.0; 7], 0.03 / steps as f64, steps).map_err(failed);
            let [coarse, fine] = [run(3000)?, run(6000)?];
            let limit: Vec<f64> = fine.q.iter().zip(&coarse.q).map(|(fine, coarse)| fine + (fine - coarse) / 15.0).collect();
            let apart = |a: &[f64], b: &[f64]| largest(a.iter().zip(b).map(|(a, b)| a - b));
            Ok(vec![fine.position_drift(), apart(&limit, &WITNESS), apart(&fine.q, &limit)])
        }),
    }
}
