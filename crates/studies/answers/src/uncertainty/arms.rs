//! Accelerations of robots whose masses are uncertain by ±20 %: derivatives, variances, indices, and the same bits for any number of threads.

use super::{Case, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::forward_dynamics;
use featherbench_model::{Description, Model};
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::{Dual, RigidBodyInertia, Vec3};
use featherbench_uncertainty::{
    Estimate, Points, Quantity, RobotResponse, Sampling, Space, State, chaos, first_order, sample, sensitivity, spread,
};
use serde_json::json;

/// The half width of each mass, of its nominal value.
const SPREAD: f64 = 0.2;
/// One so small that first order is right: what it leaves out of a variance is 2.5e-7 of what it does at [`SPREAD`].
const SMALL: f64 = 1e-4;
/// The arm of six joints.
pub(super) const ARM: &str = "chain:n=6,layout=spatial";
/// Its degrees of freedom.
const DOFS: usize = 6;
/// Order of the series: 5⁶ nodes.
const ORDER: usize = 4;

/// A robot at a drawn state, with uncertain masses.
pub(super) struct Uncertain {
    pub(super) robot: Description,
    state: State,
    pub(super) space: Space,
    pub(super) response: RobotResponse,
}

impl Uncertain {
    pub(super) fn new(family: &str, seed: u64) -> Result<Self, NoAnswer> {
        Self::within(family, SPREAD, seed)
    }

    /// With masses within another part of their values.
    fn within(family: &str, relative: f64, seed: u64) -> Result<Self, NoAnswer> {
        let mut robot = Family::parse(family).and_then(|family| family.generate()).map_err(failed)?;
        robot.uncertain = spread(&robot, relative).map_err(failed)?;
        let model: Model<f64> = Model::build(&robot).map_err(failed)?;
        let drawn = StateBatch::random(&model, 1, seed);
        let state = State { q: drawn.q(0).into(), v: drawn.v(0).into(), drive: drawn.tau(0).into() };
        let response = RobotResponse::new(&robot, &state, Quantity::Acceleration, None).map_err(failed)?;
        Ok(Self { space: Space::of(&robot.uncertain).map_err(failed)?, robot, state, response })
    }
}

pub(super) fn cases() -> Vec<Case> {
    let robots = [ARM, "quadruped", "humanoid"].map(derivatives);
    let joints = (0..DOFS).map(joint);
    let threads = [(Points::Random, "monte_carlo"), (Points::Sobol, "sobol")].map(|(points, method)| threads(points, method));
    robots.into_iter().chain(joints).chain(threads).chain([indices()]).collect()
}

/// J = −M⁻¹ Y ∂π/∂x against the articulated-body algorithm over dual numbers, of the largest derivative.
fn derivatives(family: &'static str) -> Case {
    Case {
        name: format!("{family}, masses"),
        quantity: "derivatives",
        method: "regressor".into(),
        params: json!({"robot": family, "spread": SPREAD}),
        numbers: vec![error("error", "dual numbers")],
        evaluate: Box::new(move |seed| {
            let known = Uncertain::new(family, seed)?;
            let linear = known.response.linear().map_err(failed)?;
            let nominal: Model<f64> = Model::build(&known.robot).map_err(failed)?;
            let dual = |list: &[f64]| -> Vec<Dual<f64>> { list.iter().map(|x| Dual::constant(*x)).collect() };
            let (mut worst, mut size) = (0.0, 0.0);
            for (k, variable) in known.robot.uncertain.variables.iter().enumerate() {
                let mut model: Model<Dual<f64>> = lifted(&nominal);
                for target in &variable.on {
                    let place = nominal.described[target.body];
                    let inertia = nominal.inertias[place];
                    // m and m c grow with the mass; the inertia about the origin by that of a point mass at c.
                    let com = inertia.com();
                    let grown = RigidBodyInertia::from_com(inertia.mass, com, featherbench_spatial::Sym3::zero());
                    let seeded = |value: f64, slope: f64| Dual::new(value, slope);
                    let both = inertia.rotational.to_array().into_iter().zip(grown.rotational.to_array());
                    let mut rotational = [Dual::constant(0.0); 6];
                    rotational.iter_mut().zip(both).for_each(|(entry, (value, slope))| *entry = seeded(value, slope));
                    let first = inertia.first_moment.to_array().map(|value| seeded(value, value));
                    model.inertias[place] = RigidBodyInertia {
                        mass: seeded(inertia.mass, inertia.mass),
                        first_moment: Vec3::from_array(first),
                        rotational: featherbench_spatial::Sym3::from_array(rotational),
                    };
                }
                let State { q, v, drive } = &known.state;
                let found = forward_dynamics(&model, &dual(q), &dual(v), &dual(drive)).map_err(failed)?;
                for (i, a) in found.iter().enumerate() {
                    worst = largest([worst, a.derivative - linear.jacobian[(i, k)]]);
                    size = largest([size, a.derivative]);
                }
            }
            Ok(vec![worst / size])
        }),
    }
}

/// A model whose parameters are constants.
fn lifted(model: &Model<f64>) -> Model<Dual<f64>> {
    model.lift()
}

/// The variance of a joint's acceleration: samples against the series, and over that of first order.
fn joint(dof: usize) -> Case {
    Case {
        name: format!("{ARM}, joint {dof}"),
        quantity: "arm",
        method: "monte_carlo".into(),
        params: json!({"robot": ARM, "spread": SPREAD, "dof": dof, "order": ORDER}),
        numbers: vec![
            error("mean_deviation", "polynomial chaos"),
            error("variance_deviation", "polynomial chaos"),
            error("small_variance_error", "first order"),
            told("variance_ratio", "1"),
            told("first_order_deviation", "rad/s²"),
            told("deviation", "rad/s²"),
        ],
        evaluate: Box::new(move |seed| {
            let known = Uncertain::new(ARM, seed)?;
            let linear = known.response.linear().map_err(failed)?;
            let first = first_order(&known.space, &linear).map_err(failed)?.covariance[(dof, dof)];
            let series = chaos(&known.space, &known.response, ORDER).map_err(failed)?;
            let settings = Sampling { samples: 1 << 17, seed, replicates: 64, ..Sampling::default() };
            let found = sample(&known.space, &known.response, None, &settings, &|_| ()).map_err(failed)?;
            let output = &found.outputs[dof];
            let small = Uncertain::within(ARM, SMALL, seed)?;
            let small_series = chaos(&small.space, &small.response, 1).map_err(failed)?.variance(dof);
            let small_first = first_order(&small.space, &small.response.linear().map_err(failed)?).map_err(failed)?.covariance[(dof, dof)];
            Ok(vec![
                output.mean.deviations(series.mean(dof)),
                output.variance.deviations(series.variance(dof)),
                (small_series / small_first - 1.0).abs(),
                series.variance(dof) / first,
                first.sqrt(),
                output.variance.value.sqrt(),
            ])
        }),
    }
}

/// Results of one thread and of two: how many numbers differ in a bit.
fn threads(points: Points, method: &'static str) -> Case {
    const FAMILY: &str = "chain:n=7,layout=spatial";
    Case {
        name: format!("{FAMILY}, threads"),
        quantity: "threads",
        method: method.into(),
        params: json!({"robot": FAMILY, "spread": SPREAD, "threads": [1, 2]}),
        numbers: vec![count("different_bits", 0.0, "one thread"), told("numbers", "1")],
        evaluate: Box::new(move |seed| {
            let known = Uncertain::new(FAMILY, seed)?;
            let linear = known.response.linear().map_err(failed)?;
            let run = |threads| -> Result<Vec<u64>, NoAnswer> {
                let settings = Sampling { points, samples: 100_000, seed, threads: Some(threads), ..Sampling::default() };
                let found = sample(&known.space, &known.response, Some(&linear), &settings, &|_| ()).map_err(failed)?;
                let of_output = found.outputs.iter().flat_map(|output| {
                    let controlled = output.controlled.map_or([0.0; 2], |controlled| [controlled.value, controlled.error]);
                    let plain = [output.mean.value, output.mean.error, output.variance.value, output.variance.error];
                    plain.into_iter().chain(controlled).chain(output.moments.sums).map(f64::to_bits).chain(output.histogram.counts.clone())
                });
                Ok(of_output.chain(found.covariance.iter().map(|entry| entry.to_bits())).collect())
            };
            let (one, two) = (run(1)?, run(2)?);
            let different = one.iter().zip(&two).filter(|(a, b)| a != b).count() + one.len().abs_diff(two.len());
            Ok(vec![different as f64, one.len() as f64])
        }),
    }
}

/// Sobol' indices of every mass for every joint: samples against the coefficients of the series.
fn indices() -> Case {
    Case {
        name: format!("{ARM}, masses"),
        quantity: "indices",
        method: "sobol".into(),
        params: json!({"robot": ARM, "spread": SPREAD, "order": ORDER}),
        numbers: vec![error("index_deviation", "polynomial chaos"), told("index_error", "1"), told("interaction", "1")],
        evaluate: Box::new(move |seed| {
            let known = Uncertain::new(ARM, seed)?;
            let series = chaos(&known.space, &known.response, ORDER).map_err(failed)?;
            let settings = Sampling { points: Points::Sobol, samples: 1 << 14, seed, replicates: 64, ..Sampling::default() };
            let found = sensitivity(&known.space, &known.response, &settings).map_err(failed)?;
            // An index of a mass without effect is zero but for rounding, and so is its error.
            let of = |found: Estimate, known| Estimate { error: found.error + 1e-12, ..found }.deviations(known);
            let (mut farthest, mut worst, mut interaction) = (0.0, 0.0, 0.0);
            for (dof, own) in found.iter().enumerate() {
                for (i, [first, total]) in series.sobol_indices(dof).map_err(failed)?.into_iter().enumerate() {
                    farthest = largest([farthest, of(own.first[i], first), of(own.total[i], total)]);
                    worst = largest([worst, own.first[i].value - first, own.total[i].value - total]);
                    interaction = largest([interaction, total - first]);
                }
            }
            Ok(vec![farthest, worst, interaction])
        }),
    }
}
