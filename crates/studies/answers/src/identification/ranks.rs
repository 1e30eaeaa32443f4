//! Ranks of the torque regressor: the number of base parameters follows a law of the joints and of gravity.

use super::{Case, count, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_identification::{Arm, Base, Gravity, LinearModel, Motion, Stacking, Terms};
use featherbench_model::Description;
use featherbench_robots::Family;
use serde_json::json;

const QUANTITY: &str = "rank";
/// Where gravity is for arms of one plane.
const PLANES: [(&str, [f64; 3], usize); 3] =
    [("in its plane", [0.0, 0.0, -9.81], 0), ("across its plane", [0.0, -9.81, 0.0], 2), ("none", [0.0; 3], 2)];

/// By which way a rank is found.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Torque,
    Energy,
    Base,
    Rest,
}

impl Way {
    fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Energy => "energy",
            Self::Base => "base rows",
            Self::Rest => "at rest",
        }
    }
}

type Make = Box<dyn Fn() -> Result<Description, NoAnswer> + Send + Sync>;

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    // Shoulders whose first axes meet lose two first moments per pair without gravity.
    for (arm, [along, oblique, none]) in
        [(Arm::puma560(), [36, 38, 34]), (Arm::ur5(), [36, 38, 34]), (Arm::panda(), [43, 45, 39]), (Arm::iiwa(), [43, 45, 39])]
    {
        let n = arm.joints.len();
        for (gravity, due) in [(Gravity::Parallel, along), (Gravity::Oblique, oblique), (Gravity::Zero, none)] {
            of_arm(&mut cases, &arm, gravity, &[Way::Torque, Way::Energy], due);
        }
        of_arm(&mut cases, &arm, Gravity::Parallel, &[Way::Rest], 2 * n - 2);
        of_arm(&mut cases, &arm, Gravity::Oblique, &[Way::Rest], 2 * n);
    }
    for n in [2, 3, 5, 8] {
        let arm = Arm::general(n, 5);
        for (gravity, due) in [(Gravity::Parallel, 7 * n - 6), (Gravity::Oblique, 7 * n - 4), (Gravity::Zero, 7 * n - 6)] {
            of_arm(&mut cases, &arm, gravity, &[Way::Torque, Way::Energy], due);
        }
    }
    for n in [2, 3, 6] {
        for (words, gravity, less) in PLANES {
            let make = move || {
                let robot = family(&format!("chain:n={n}"))?;
                Ok(Description { gravity, ..robot })
            };
            let params = json!({"robot": format!("chain:n={n}"), "gravity": gravity});
            cases.push(case(format!("planar {n}R, gravity {words}"), params, Way::Torque, 3 * n - less, Box::new(make)));
        }
    }
    for (spec, name, n) in [
        ("chain:n=2,layout=spatial,base=free", "floating 2R", 2),
        ("chain:n=6,layout=spatial,base=free", "floating 6R", 6),
        ("chain:n=12,layout=spatial,base=free", "floating 12R", 12),
        ("chain:n=30,layout=spatial,base=free", "floating 30R", 30),
        ("quadruped", "quadruped", 12),
    ] {
        for way in [Way::Torque, Way::Base] {
            cases.push(case(name.into(), json!({"robot": spec}), way, 7 * n + 10, Box::new(move || family(spec))));
        }
    }
    cases
}

fn family(spec: &str) -> Result<Description, NoAnswer> {
    Family::parse(spec).and_then(|family| family.generate()).map_err(failed)
}

fn of_arm(cases: &mut Vec<Case>, arm: &Arm, gravity: Gravity, ways: &[Way], due: usize) {
    for &way in ways {
        let own = arm.clone();
        let params = json!({"joints": arm.joints, "gravity": gravity.vector()});
        let name = format!("{}, gravity {}", arm.name, gravity.name());
        cases.push(case(name, params, way, due, Box::new(move || Ok(own.describe(gravity, 1)))));
    }
}

fn case(name: String, params: serde_json::Value, way: Way, due: usize, make: Make) -> Case {
    Case {
        name,
        quantity: QUANTITY,
        method: way.name().into(),
        params,
        numbers: vec![
            count("rank", due as f64, "law"),
            error("first_dropped_over_last_kept", "theory"),
            told("last_kept", "1"),
            told("first_dropped", "1"),
            told("unknowns", "1"),
        ],
        evaluate: Box::new(move |seed| {
            let linear = LinearModel::new(&make()?, Terms::NONE).map_err(failed)?;
            let base = match way {
                Way::Torque => Base::of_robot(&linear, seed),
                Way::Energy => Base::of_energy(&linear, seed),
                Way::Base => Base::of_states(&linear, seed, &Stacking { dofs: 0..6, weights: None }, Motion::Any),
                Way::Rest => Base::of_states(&linear, seed, &Stacking::plain(&linear), Motion::AtRest),
            }
            .map_err(failed)?;
            let (first, rank) = (base.singular[0], base.rank());
            let kept = base.singular[rank - 1] / first;
            let dropped = base.singular.get(rank).map_or(0.0, |value| value / first);
            Ok(vec![rank as f64, 1.0 / base.gap, kept, dropped, linear.unknowns().len() as f64])
        }),
    }
}
