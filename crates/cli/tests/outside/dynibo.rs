//! Dynibo, if it is built: a library that cargo makes, its answers against our own kernels, and what it refuses.

use super::Outcome;
use super::library;
use super::native;
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::Oracle;
use featherbench_results::ModelOrigin;

/// A test that asks dynibo.
pub fn with_dynibo(test: fn(&Oracle)) -> Outcome {
    library::with("dynibo", test)
}

/// It agrees on chains, trees and arms, fixed and floating, with gravity of any size and direction.
pub fn agrees(dynibo: &Oracle) {
    let words = [
        "chain-spatial-10",
        "chain:n=36,layout=spatial",
        "chain-spatial-100",
        "binary_tree:depth=5",
        "joints:kind=revolute,base=fixed,armature=false",
        "joints:kind=prismatic,base=fixed,armature=false",
        "joints:kind=revolute,base=free,armature=false",
        "joints:kind=prismatic,base=free,armature=false",
        "panda",
        "ur5",
        "g1",
        "anymal_c",
    ];
    for words in words {
        let upright = native::robot(words, 12);
        for gravity in [upright.description.gravity, [1.0, -2.0, -3.0], [0.0, 0.0, 4.0]] {
            let mut description = upright.description.clone();
            description.gravity = gravity;
            let robot = Robot::new(&description, words, ModelOrigin::Generated, 12, 1).unwrap();
            let found = native::compare(dynibo, &robot, &[]);
            assert_eq!(found.len(), 8, "{words}");
            for native::Found { quantity, method, share } in found {
                let share = share.unwrap_or_else(|reason| panic!("{words} {}: {reason}", quantity.name()));
                assert!(share <= 1.0, "{words} {gravity:?} {} by {method}: {share} of its tolerance", quantity.name());
            }
        }
    }
}

/// Known deviation (oracles/README.md): M loses digits on a straight chain, unless its numbers are exact in products.
///
/// Links of 0.5 m are such numbers, links of 0.55 m are not. At the straight configuration the error of M is 20.4 times what is allowed;
/// it is the same for every seed, because all other configurations are far below.
pub fn loses_digits_of_a_straight_chain(dynibo: &Oracle) {
    let mut description = native::robot("chain:n=36,layout=spatial", 1).description;
    for body in &mut description.bodies {
        body.com = body.com.map(|length| 1.1 * length);
        body.inertia = body.inertia.map(|inertia| 1.1 * 1.1 * inertia);
        body.joint.placement.translation = body.joint.placement.translation.map(|length| 1.1 * length);
    }
    let robot = Robot::new(&description, "chain", ModelOrigin::Generated, 12, 1).unwrap();
    for native::Found { quantity, method, share } in native::compare(dynibo, &robot, &[]) {
        let share = share.unwrap_or_else(|reason| panic!("{}: {reason}", quantity.name()));
        let is_known = matches!(quantity, Quantity::MassMatrix | Quantity::MassMatrixSparse);
        let (least, largest) = if is_known { (1.0, 2.0 * 20.4) } else { (0.0, 1.0) };
        assert!((least..=largest).contains(&share), "{} by {method}: {share} of its tolerance", quantity.name());
    }
}

/// What it does not have is refused by name.
pub fn refuses(dynibo: &Oracle) {
    let mut weightless = native::robot("panda", 1).description;
    weightless.gravity = [0.0; 3];
    let weightless = Robot::new(&weightless, "weightless", ModelOrigin::Generated, 4, 1).unwrap();
    let kind = |kind: &str| native::robot(&format!("joints:kind={kind},base=fixed,armature=false"), 4);
    let cases = [
        (native::robot("humanoid", 4), "armature"),
        (kind("spherical"), "spherical"),
        (kind("universal"), "universal"),
        (weightless, "gravity"),
    ];
    for (robot, word) in cases {
        let refused = dynibo.prepare(&robot, Quantity::InverseDynamics, "rnea", &robot.states).err();
        assert!(matches!(&refused, Some(NoAnswer::NotOffered(reason)) if reason.contains(word)), "{word}: {refused:?}");
    }
}
