//! Ranks of the torque regressor against the laws of the literature, and the same ranks from energies.

use featherbench_identification::{Arm, Base, Gravity, LinearModel, Motion, Samples, Stacking, Terms};
use featherbench_model::Description;
use featherbench_robots::Family;
use featherbench_spatial::larger;

fn linear(description: &Description) -> LinearModel {
    LinearModel::new(description, Terms::NONE).unwrap()
}

fn family(spec: &str) -> Description {
    Family::parse(spec).unwrap().generate().unwrap()
}

/// The rank, with the gap that SCIENCE asks for.
fn rank(description: &Description) -> usize {
    let base = Base::of_robot(&linear(description), 1).unwrap();
    println!(
        "{:<16} rank {:>3} of {:>3}  gap {:.1e}  condition {:.1e}",
        description.name,
        base.rank(),
        base.map.ncols(),
        base.gap,
        base.condition()
    );
    assert!(base.gap > 1e6, "{}: gap {:e}", description.name, base.gap);
    base.rank()
}

fn rank_by_energy(description: &Description) -> usize {
    Base::of_energy(&linear(description), 3).unwrap().rank()
}

#[test]
fn named_arms_have_their_known_ranks() {
    for (arm, ranks) in
        [(Arm::puma560(), [36, 38, 34]), (Arm::ur5(), [36, 38, 34]), (Arm::panda(), [43, 45, 39]), (Arm::iiwa(), [43, 45, 39])]
    {
        for (gravity, due) in [Gravity::Parallel, Gravity::Oblique, Gravity::Zero].into_iter().zip(ranks) {
            let robot = arm.describe(gravity, 1);
            assert_eq!(rank(&robot), due, "{} {gravity:?}", arm.name);
            assert_eq!(rank_by_energy(&robot), due, "{} {gravity:?} by energy", arm.name);
        }
    }
}

/// At rest gravity alone speaks: 2n − 2 along the first axis, 2n oblique.
#[test]
fn static_ranks() {
    for (arm, along, oblique) in [(Arm::puma560(), 10, 12), (Arm::ur5(), 10, 12), (Arm::panda(), 12, 14), (Arm::iiwa(), 12, 14)] {
        for (gravity, due) in [(Gravity::Parallel, along), (Gravity::Oblique, oblique)] {
            let linear = linear(&arm.describe(gravity, 1));
            let base = Base::of_states(&linear, 1, &Stacking::plain(&linear), Motion::AtRest).unwrap();
            assert_eq!(base.rank(), due, "{} {gravity:?}", arm.name);
        }
    }
}

/// 7n − 6 under gravity along the first axis, 7n − 4 oblique, 7n − 6 without.
#[test]
fn general_arms_follow_the_law() {
    for n in [1, 2, 3, 5, 8] {
        let arm = Arm::general(n, 5);
        assert_eq!(rank(&arm.describe(Gravity::Parallel, 1)), 7 * n - 6, "{n}");
        assert_eq!(rank(&arm.describe(Gravity::Oblique, 1)), 7 * n - 4, "{n}");
        assert_eq!(rank(&arm.describe(Gravity::Zero, 1)), 7 * n - 6, "{n}");
    }
}

/// Planar arms: 3n if gravity is in their plane, 3n − 2 if not.
#[test]
fn planar_arms_follow_the_law() {
    for n in [1, 2, 3, 6, 9] {
        let mut robot = family(&format!("chain:n={n}"));
        assert_eq!(rank(&robot), 3 * n);
        // The chain turns about y.
        robot.gravity = [0.0, -9.81, 0.0];
        assert_eq!(rank(&robot), 3 * n - 2);
        robot.gravity = [0.0; 3];
        assert_eq!(rank(&robot), 3 * n - 2);
    }
}

/// Floating robots: 7n + 10, and the six equations of the base alone tell as much.
#[test]
fn floating_robots_follow_the_law() {
    for (spec, n) in [
        ("chain:n=2,layout=spatial,base=free", 2),
        ("chain:n=6,layout=spatial,base=free", 6),
        ("quadruped", 12),
        ("chain:n=30,layout=spatial,base=free", 30),
    ] {
        let robot = family(spec);
        assert_eq!(rank(&robot), 7 * n + 10, "{spec}");
        let linear = linear(&robot);
        let base_alone = Stacking { dofs: 0..6, weights: None };
        let base = Base::of_states(&linear, 1, &base_alone, Motion::Any).unwrap();
        assert_eq!(base.rank(), 7 * n + 10, "{spec}, base rows");
    }
}

/// Sliders along one line: all masses are told apart, and no first moment has an effect.
#[test]
fn base_parameters_are_named() {
    use featherbench_model::{BodyDescription, JointDescription, JointType};
    let slide = |k: usize| BodyDescription {
        name: format!("slide_{k}"),
        parent: k.checked_sub(1),
        mass: 1.0,
        com: [0.1, 0.0, 0.2],
        inertia: [0.01, 0.0, 0.0, 0.01, 0.0, 0.01],
        joint: JointDescription {
            name: format!("rail_{k}"),
            kind: JointType::Prismatic { axis: [0.0, 0.0, 1.0] },
            ..JointDescription::default()
        },
    };
    let robot =
        Description { name: "slides".into(), gravity: [0.0, 0.0, -9.81], bodies: (0..3).map(slide).collect(), ..Description::default() };
    let linear = LinearModel::new(&robot, Terms { viscous: true, coulomb: true, ..Terms::NONE }).unwrap();
    let base = Base::of_robot(&linear, 1).unwrap();
    assert_eq!(base.names(&linear), ["m1", "m2", "m3", "fv1", "fv2", "fv3", "fc1", "fc2", "fc3"]);
    // m₁ (v̇ + g) = I_a v̇ + f_0 with I_a = m₁ and f_0 = m₁ g: one of the three is not told apart.
    let linear = LinearModel::new(&robot, Terms { armature: true, offset: true, ..Terms::NONE }).unwrap();
    let base = Base::of_robot(&linear, 1).unwrap();
    assert_eq!(base.names(&linear)[0], "m1 + 0.101937 f01");
    assert_eq!(base.names(&linear)[3], "Ia1 - 0.101937 f01");

    // A planar double pendulum of 0.5 m: what the second mass adds to the first axis.
    let linear = LinearModel::new(&family("chain:n=2"), Terms { armature: true, ..Terms::NONE }).unwrap();
    let base = Base::of_robot(&linear, 1).unwrap();
    assert_eq!(base.names(&linear), ["mx1 + 0.5 m2", "mz1", "Iyy1 + 0.25 m2 + Ia1", "mx2", "mz2", "Iyy2", "Ia2"]);
}

/// β = B θ is the whole effect of θ on the torques: parameters with the same β have the same torques.
#[test]
fn parameters_of_one_beta_have_one_torque() {
    let linear = linear(&Arm::puma560().describe(Gravity::Parallel, 2));
    let base = Base::of_robot(&linear, 1).unwrap();
    let theta = linear.nominal();
    // The base parameters alone, on the unknowns that stand for them.
    let mut other = vec![0.0; theta.len()];
    for (&own, value) in base.independent.iter().zip(base.values(&theta)) {
        other[own] = value;
    }
    let samples = Samples::random(&linear, 20, 9, &theta).unwrap();
    let torques = linear.torques(&samples, &other).unwrap();
    let largest = samples.tau.iter().fold(0.0, |most: f64, tau| larger(most, tau.abs()));
    let worst = torques.iter().zip(&samples.tau).fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs()));
    // β is known to RANK's roundings times the condition of the columns.
    assert!(worst < 1e-11 * largest, "{worst:e} of {largest:e}");
}
