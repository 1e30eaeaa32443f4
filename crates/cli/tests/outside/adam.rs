//! Adam, if it is installed: C code that is generated and compiled for each robot, its answers against our own kernels, and what it refuses.

use super::native;
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot};
use featherbench_engines::Oracle;
use featherbench_results::{Base, ModelOrigin};

/// It agrees on chains, trees and arms, fixed and floating, with gravity of any direction.
pub fn agrees(adam: &Oracle) {
    let words = [
        "chain-spatial-5",
        "binary_tree:depth=3",
        "joints:kind=revolute,base=fixed,armature=false",
        "joints:kind=revolute,base=free,armature=false",
        "ur5",
        "anymal_c",
    ];
    for words in words {
        let upright = native::robot(words, 12);
        for gravity in [upright.description.gravity, [1.0, -2.0, -3.0]] {
            let mut description = upright.description.clone();
            description.gravity = gravity;
            let robot = Robot::new(&description, words, ModelOrigin::Generated, 12, 1).unwrap();
            // Its articulated body algorithm is that of a floating base.
            let fixed = robot.properties().base == Base::Fixed;
            let found = native::compare(adam, &robot, if fixed { &["aba"] } else { &[] });
            assert_eq!(found.len(), if fixed { 9 } else { 10 }, "{words}: {found:?}");
            for native::Found { quantity, method, share } in found {
                let share = share.unwrap_or_else(|reason| panic!("{words} {}: {reason}", quantity.name()));
                assert!(share <= 1.0, "{words} {gravity:?} {} by {method}: {share} of its tolerance", quantity.name());
            }
        }
    }
}

/// The clock is that of the loop, states beyond the batch begin again, and relocated data give the same bits.
pub fn is_clocked(adam: &Oracle) {
    let robot = native::robot("chain-spatial-5", 12);
    let mut bias = adam.prepare(&robot, Quantity::Bias, "rnea", &robot.states).unwrap();
    assert!(adam.has_clock() && !adam.estimates());
    bias.run(0..12).unwrap();
    let before = bias.read().to_vec();
    assert!(bias.clock(7..4007).unwrap().as_nanos() > 0);
    assert_eq!(bias.relocate(3), Ok(true));
    assert!(bias.clock(0..12).unwrap().as_nanos() > 0);
    bias.run(0..12).unwrap();
    assert_eq!(bias.read(), before);
}

/// What it does not have is refused by name.
pub fn refuses(adam: &Oracle) {
    let kind = |kind: &str| native::robot(&format!("joints:kind={kind},base=fixed,armature=false"), 4);
    let cases = [
        (native::robot("tree:n=6,armature=true", 4), "bias", "armature"),
        (kind("prismatic"), "bias", "prismatic"),
        (kind("spherical"), "bias", "spherical"),
        (native::robot("chain:n=41,layout=spatial", 4), "bias", "40 degrees"),
        (native::robot("chain-spatial-5", 4), "fd", "floating base"),
        (native::robot("chain-planar-2", 4), "body_jacobian", "two joints"),
    ];
    for (robot, quantity, word) in cases {
        let quantity = Quantity::parse(quantity).unwrap();
        let method = adam.methods(quantity).remove(0);
        let asked = adam.prepare(&robot, quantity, &method, &robot.states).and_then(|mut prepared| prepared.run(0..1));
        assert!(matches!(&asked, Err(NoAnswer::NotOffered(reason)) if reason.contains(word)), "{word}: {asked:?}");
    }
}
