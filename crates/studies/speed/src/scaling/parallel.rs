//! Counted operations of our algorithms on several cores: their work and their span, beside the work of the serial algorithm.
//!
//! The *work* is all operations together. The *span* is the largest number of operations that wait for each other: the time on unlimited cores,
//! in operations. On p cores a schedule that leaves no core idle while a task is ready takes at most `work/p + (1 − 1/p)·span` (R. L. Graham,
//! *Bounds on multiprocessing timing anomalies*, 1969). So two cores beat one if `work/2 + span/2` is below the serial work.
//!
//! The work is counted by running the plain text on a scalar that counts, in a pool of one thread. Operations have the weights of `work.rs`.
//!
//! | method | span |
//! |---|---|
//! | sub-trees (`rnea_parallel`, `aba_parallel`, `crba_parallel`) | the work, times the share of the trunk and the heaviest task ([`Division`]) |
//! | from both ends (`twisted`) | the longer side, from the operations per joint of both sides |

use super::work::weighted;
use featherbench_bench::{NoAnswer, Quantity, Robot};
use featherbench_dynamics::{Aba, Crba, Division, ParallelAba, ParallelCrba, ParallelRnea, Rnea, TreeSparse, Twisted};
use featherbench_spatial::Counted;
use rayon::ThreadPoolBuilder;

/// The methods that divide a tree into sub-trees, with their quantities and the power of the depth that their division weighs a dof by.
pub(super) const BY_SUB_TREES: [(Quantity, &str, u32); 3] = [
    (Quantity::InverseDynamics, "rnea_parallel", 0),
    (Quantity::ForwardDynamics, "aba_parallel", 0),
    (Quantity::MassMatrixSparse, "crba_parallel", 1),
];
/// The method that divides a chain.
pub(super) const FROM_BOTH_ENDS: &str = "twisted";

/// Bodies by which the base side is lengthened to count its operations per joint: a whole number of the generator's patterns of axes.
const LONGER: usize = 12;

/// Serial work, parallel work and span of a method at the robot's first state.
///
/// # Errors
/// [`NoAnswer`] when there is no such method, or it does not do this robot.
pub(super) fn counts(robot: &Robot, method: &str) -> Result<[f64; 3], NoAnswer> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| NoAnswer::Failed(error.to_string()))?;
    // The counter belongs to the thread of the pool.
    pool.install(|| if method == FROM_BOTH_ENDS { from_both_ends(robot) } else { by_sub_trees(robot, method) })
}

fn by_sub_trees(robot: &Robot, method: &str) -> Result<[f64; 3], NoAnswer> {
    let (model, topology) = (&robot.model, &robot.model.topology);
    let [q, v, a, tau] = inputs(robot);
    let mut out = vec![Counted(0.0); topology.nv()];
    let [serial, work] = match method {
        "rnea_parallel" => {
            let (mut rnea, mut parallel) = (Rnea::new(topology), ParallelRnea::new(topology));
            [counted(|| rnea.run(model, &q, &v, &a, None, &mut out))?, counted(|| parallel.run(model, &q, &v, &a, None, &mut out))?]
        }
        "aba_parallel" => {
            let (mut aba, mut parallel) = (Aba::new(topology), ParallelAba::new(topology));
            [counted(|| aba.run(model, &q, &v, &tau, None, &mut out))?, counted(|| parallel.run(model, &q, &v, &tau, None, &mut out))?]
        }
        _ => {
            let (mut crba, mut parallel, mut matrix) = (Crba::new(topology), ParallelCrba::new(topology), TreeSparse::new(topology));
            [counted(|| crba.run(model, &q, &mut matrix))?, counted(|| parallel.run(model, &q, &mut matrix))?]
        }
    };
    let power = BY_SUB_TREES.iter().find(|(_, name, _)| *name == method).map(|(_, _, power)| *power);
    let power = power.ok_or_else(|| NoAnswer::NotOffered(format!("there is no counted method {method}")))?;
    Ok([serial, work, work * Division::of(topology, power).span_share()])
}

/// The base side has b operations per joint, the tip side t, as the serial algorithm. A base side that is longer by k joints costs k (b − t).
fn from_both_ends(robot: &Robot) -> Result<[f64; 3], NoAnswer> {
    let (model, topology) = (&robot.model, &robot.model.topology);
    let [q, v, _, tau] = inputs(robot);
    let mut out = vec![Counted(0.0); topology.nv()];
    let none = || NoAnswer::NotOffered("it does chains of one-dof joints, with a fixed or a free base".into());
    let mut aba = Aba::new(topology);
    let serial = counted(|| aba.run(model, &q, &v, &tau, None, &mut out))?;
    let mut twisted = Twisted::new(topology).ok_or_else(none)?;
    let cut = twisted.cut();
    let work = counted(|| twisted.run(model, &q, &v, &tau, None, &mut out))?;
    let mut longer = Twisted::with_cut(topology, cut + LONGER).ok_or_else(none)?;
    let more = counted(|| longer.run(model, &q, &v, &tau, None, &mut out))?;
    let bodies = topology.bodies() as f64;
    let tip = serial / bodies;
    let base = tip + (more - work) / LONGER as f64;
    let [base, tip] = [base * cut as f64, tip * (bodies - cut as f64)];
    Ok([serial, work, if base > tip { base } else { tip }])
}

/// q, v, a and τ of the first state.
fn inputs(robot: &Robot) -> [Vec<Counted>; 4] {
    let states = &robot.states;
    [states.q(0), states.v(0), states.a(0), states.tau(0)].map(|values| values.iter().map(|&x| Counted(x)).collect())
}

/// The weighted operations of a call.
fn counted<E: std::fmt::Display>(call: impl FnOnce() -> Result<(), E>) -> Result<f64, NoAnswer> {
    let mut done = Ok(());
    let operations = Counted::count(|| done = call());
    done.map_err(|error| NoAnswer::Failed(error.to_string()))?;
    Ok(weighted(operations))
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_bench::alone;

    fn shares(spec: &str, method: &str) -> [f64; 2] {
        let [serial, work, span] = counts(&alone::robot(spec, 1).unwrap(), method).unwrap();
        [work / serial, span / serial]
    }

    /// 421 operations per joint on the tip side and 786 on the base side with 0.3 of the joints, as `twisted.rs` states: 1.26 times the work. There
    /// a division counts one. Here it weighs 8, and the base side has some ten divisions per joint more: 0.3·10·7/421 = 0.05.
    #[test]
    fn a_chain_from_both_ends_has_a_third_more_work_and_two_thirds_of_it_wait() {
        let [work, span] = shares("chain:n=1200,layout=spatial", "twisted");
        let plain = (0.7 * 421.0 + 0.3 * 786.0) / 421.0;
        assert!((plain..plain + 0.06).contains(&work), "{work}");
        assert!((span - 0.7).abs() < 0.01, "{span}");
    }

    #[test]
    fn sub_trees_add_little_work_and_most_of_it_is_parallel() {
        for (_, method, _) in BY_SUB_TREES {
            let [work, span] = shares("binary_tree:depth=10", method);
            assert!((1.0..1.2).contains(&work) && (0.02..0.2).contains(&span), "{method}: {work} {span}");
            // One sub-tree: everything waits.
            let [work, span] = shares("chain:n=60,layout=spatial", method);
            assert!((work - 1.0).abs() < 0.05 && (span - work).abs() < 1e-12, "{method}: {work} {span}");
        }
        assert!(matches!(counts(&alone::robot("star:n=3", 1).unwrap(), "twisted"), Err(NoAnswer::NotOffered(_))));
    }

    /// Many small parts below a long trunk, and parts that stand on the world: forces go to the root together, and a part on the world has
    /// none to carry.
    #[test]
    fn small_parts_add_little_work() {
        for spec in ["centipede:segments=100,leg=3", "star:n=100", "tree:n=300,seed=6,spread=0.05"] {
            let [work, _] = shares(spec, "crba_parallel");
            assert!((1.0..1.5).contains(&work), "{spec}: {work}");
        }
    }
}
