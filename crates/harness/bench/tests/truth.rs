//! The truth against the independent multi-precision witness, and the conditioning bound against perturbed inputs.

use featherbench_bench::measure::worst;
use featherbench_bench::truth::{TruthModel, conditioning_bound};
use featherbench_bench::{Robot, hash};
use featherbench_reference::{Precision, Robot as Witness, nearest_doubles};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, Random, StateBatch};

fn robot(spec: &str, states: usize) -> Robot {
    let family = Family::parse(spec).unwrap();
    let robot = Robot::new(&family.generate().unwrap(), family.name(), ModelOrigin::Generated, states, 5).unwrap();
    let narrow = StateBatch::narrow(&robot.model, states, 5, std::f64::consts::PI, 1.0);
    robot.at(narrow)
}

/// Largest |a − b| over the largest |b|.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().map(|x| x.abs()).fold(0.0, worst);
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / largest).fold(0.0, worst)
}

/// Asserts that both agree to within a tolerance relative to the largest entry.
#[track_caller]
fn agree(spec: &str, tolerance: f64) {
    let robot = robot(spec, 3);
    let truth = TruthModel::new(&robot).unwrap();
    let witness = Witness::new(&robot.description, Precision::for_dofs(robot.states.nv)).unwrap();
    for k in 0..robot.states.count() {
        let states = &robot.states;
        let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
        let ours = truth.at(&robot, k).unwrap();
        let id = nearest_doubles(&witness.inverse_dynamics(q, v, a).unwrap());
        let fd = nearest_doubles(&witness.forward_dynamics(q, v, tau).unwrap());
        let mass = nearest_doubles(witness.mass_matrix(q).unwrap().entries());
        let n = states.nv;
        let our_mass: Vec<f64> = (0..n * n).map(|entry| ours.mass.get(entry / n, entry % n)).collect();
        for (name, error) in [
            ("id", apart(&ours.inverse_dynamics, &id)),
            ("M", apart(&our_mass, &mass)),
            ("fd", apart(&ours.forward_dynamics.unwrap(), &fd)),
        ] {
            assert!(error <= tolerance, "{spec}, state {k}: {name} apart by {error:e}");
        }
    }
}

#[test]
fn the_truth_is_that_of_the_independent_witness() {
    // Both round the same numbers: they differ by at most half an ulp of the largest entry.
    for spec in [
        "chain:n=12,layout=planar",
        "chain:n=12,layout=spatial,tip_scale=1e6",
        "chain:n=12,base_offset=1e6",
        "star:n=4",
        "humanoid:hand_mass=1000",
        "joints:kind=common,base=free,shape=single",
        "tree:n=6,joints=all,armature=true",
    ] {
        agree(spec, 0.5 * f64::EPSILON);
    }
}

#[test]
fn half_an_ulp_in_the_inputs_moves_the_answer_by_the_floor_at_most() {
    for spec in ["chain:n=10,layout=planar", "chain:n=10,layout=spatial,tip_scale=1e3", "quadruped"] {
        let robot = robot(spec, 1);
        let floor = conditioning_bound(&robot, 0).unwrap();
        let truth = |robot: &Robot| TruthModel::new(robot).unwrap().at(robot, 0).unwrap().forward_dynamics.unwrap();
        let still = truth(&robot);
        let norm = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut random = Random::named(3, &hash::of(spec.as_bytes()));
        let mut farthest = 0.0_f64;
        for _ in 0..20 {
            // An ulp is too small beside the rounding of the answer: 2²⁰ ulps are used, and the bound is multiplied by the same.
            let mut nudge = |x: &mut f64| *x *= 1.0 + random.uniform(-0.5, 0.5) * f64::EPSILON * 1_048_576.0;
            let mut states = robot.states.clone();
            [&mut states.v, &mut states.tau].into_iter().flatten().for_each(&mut nudge);
            let mut nudged = robot.clone().at(states);
            nudged.description.bodies.iter_mut().for_each(|body| {
                nudge(&mut body.mass);
                body.joint.placement.translation.iter_mut().for_each(&mut nudge);
            });
            let moved: Vec<f64> = truth(&nudged).iter().zip(&still).map(|(a, b)| a - b).collect();
            farthest = worst(farthest, norm(&moved) / norm(&still) / 1_048_576.0);
        }
        assert!(farthest <= floor, "{spec}: {farthest:e} beyond the floor {floor:e}");
        assert!(farthest >= 0.002 * floor, "{spec}: the floor {floor:e} is no worst case of {farthest:e}, it is out of sight");
    }
}
