//! Six equal carts whose one mass is uncertain: six torques that are always equal. (The lesson's MATLAB lab: M = m·1.)

use super::{Case, count, error, failed, largest};
use featherbench_model::{
    Acts, BodyDescription, Description, Distribution, JointDescription, JointType, Target, TargetField, UncertainVariable,
};
use featherbench_robots::Random;
use featherbench_uncertainty::{Estimate, Points, Quantity, RobotResponse, Space, State, chaos, draw};
use serde_json::json;

const CARTS: usize = 6;
const SPREAD: f64 = 0.2;
const ACCELERATION: f64 = 5.0;
/// Samples of a set, and sets, for the standard errors of a set's mean and deviation.
const SET: usize = 100;
const SETS: usize = 4000;

/// Carts of 1 kg on the world, each on a rail of its own.
fn carts() -> Description {
    let cart = |k: usize| BodyDescription {
        name: format!("cart {k}"),
        parent: None,
        mass: 1.0,
        com: [0.0; 3],
        inertia: [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
        joint: JointDescription {
            name: format!("rail {k}"),
            kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] },
            ..JointDescription::default()
        },
    };
    let mut robot = Description { name: "carts".into(), bodies: (0..CARTS).map(cart).collect(), ..Description::default() };
    robot.uncertain.variables = vec![UncertainVariable {
        name: "mass".into(),
        distribution: Distribution::Uniform { low: 1.0 - SPREAD, high: 1.0 + SPREAD },
        acts: Acts::Factor,
        on: (0..CARTS).map(|body| Target { body, field: TargetField::Mass }).collect(),
    }];
    robot
}

pub(super) fn cases() -> Vec<Case> {
    vec![Case {
        name: "six carts of one mass".into(),
        quantity: "torques",
        method: "inverse_dynamics".into(),
        params: json!({"carts": CARTS, "spread": SPREAD, "acceleration": ACCELERATION, "set": SET}),
        numbers: vec![
            count("rank", 1.0, "theory"),
            count("lower_bound", 4.0, "closed form"),
            count("upper_bound", 6.0, "closed form"),
            error("moment_error", "closed form"),
            error("mean_error_deviation", "closed form"),
            error("deviation_error_deviation", "closed form"),
        ],
        evaluate: Box::new(|seed| {
            let robot = carts();
            let state = State { q: vec![0.0; CARTS], v: vec![0.0; CARTS], drive: vec![ACCELERATION; CARTS] };
            let response = RobotResponse::new(&robot, &state, Quantity::Torque, None).map_err(failed)?;
            let space = Space::of(&robot.uncertain).map_err(failed)?;
            let first = featherbench_uncertainty::first_order(&space, &response.linear().map_err(failed)?).map_err(failed)?;
            let bounds = response.torque_bounds(&space).map_err(failed)?;
            let low = bounds.iter().fold(f64::INFINITY, |least, bound| if bound[0] < least { bound[0] } else { least });
            let high = largest(bounds.iter().map(|bound| bound[1]));
            // Torques are affine in the mass: a series of order one is exact. Mean 5 N, deviation 5·2δ/√12 = 1/√3 N.
            let series = chaos(&space, &response, 1).map_err(failed)?;
            let deviation_known = ACCELERATION * 2.0 * SPREAD / 12.0_f64.sqrt();
            let moments = (0..CARTS).flat_map(|k| [series.mean(k) / ACCELERATION - 1.0, series.variance(k).sqrt() / deviation_known - 1.0]);
            let moment_error = largest(moments);
            // Sets of a hundred: their means deviate by σ/√N, their deviations s by sd(s²)/2σ with Var s² = σ⁴ (2/(N − 1) + (κ − 3)/N) and the
            // kurtosis κ = 9/5 of the uniform distribution, to the order 1/N.
            let n = SET as f64;
            let known = [deviation_known / n.sqrt(), 0.5 * deviation_known * (2.0 / (n - 1.0) - 1.2 / n).sqrt()];
            let mut random = Random::named(seed, "sets");
            let drawn = draw(&space, &response, Points::Random, (SET * SETS) as u64, random.bits64()).map_err(failed)?;
            let sets = drawn[0].chunks(SET).map(featherbench_uncertainty::Moments::of);
            let (means, deviations): (Vec<f64>, Vec<f64>) = sets.map(|set| (set.mean, set.variance().sqrt())).unzip();
            let of = |values: &[f64], known: f64| {
                let found = featherbench_uncertainty::Moments::of(values);
                let value = found.variance().sqrt();
                // The error of a spread is that of its variance over twice the spread; the closed form leaves out the order 1/N.
                let error = found.variance_error() / (2.0 * value) + known / n;
                Estimate { value, error, freedom: found.count - 1.0 }.deviations(known)
            };
            Ok(vec![first.covariance.rank(1e-10) as f64, low, high, moment_error, of(&means, known[0]), of(&deviations, known[1])])
        }),
    }]
}
