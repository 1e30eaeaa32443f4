//! One robot on several threads: the answers of the serial algorithms to the bit, with any number of threads.

use crate::common;

use common::{ROBOTS, build, generated, wrenches};
use featherbench_dynamics::{Aba, Crba, Error, Ltdl, ParallelAba, ParallelCrba, ParallelLtdl, ParallelRnea, Rnea, TreeSparse};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::Real;
use rayon::ThreadPoolBuilder;

/// Trees that are divided in different ways: into many sub-trees, small ones along a spine, chains, one chain, and single bodies.
const TREES: [&str; 10] = [
    "binary_tree:depth=11",
    "centipede:segments=200",
    "platform:robots=30,n=9",
    "platform:robots=2,n=300",
    "chain:n=50,layout=spatial",
    "star:n=200",
    "snake:n=1",
    "tree:n=700,joints=all,base=free,armature=true",
    "tree:n=300,joints=all,spread=1",
    "humanoid",
];

fn models() -> impl Iterator<Item = (String, Model<f64>)> {
    TREES
        .iter()
        .map(|spec| ((*spec).to_owned(), generated(spec)))
        .chain(ROBOTS.iter().map(|(name, recipe)| ((*name).to_owned(), build(recipe))))
}

/// Calls `each` in pools of one, two and five threads.
fn in_pools(mut each: impl FnMut(usize) + Send) {
    for threads in [1, 2, 5] {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(|| each(threads));
    }
}

#[test]
fn answers_are_those_of_one_thread_to_the_bit() {
    let mut runs = 0;
    for (name, model) in models() {
        let t = &model.topology;
        let (states, f) = (StateBatch::random(&model, 2, 3), wrenches(&model, 4));
        let (mut rnea, mut aba, mut crba, mut ltdl) = (Rnea::new(t), Aba::new(t), Crba::new(t), Ltdl::new(t));
        let (mut tau, mut a, mut matrix) = (vec![0.0; t.nv()], vec![0.0; t.nv()], TreeSparse::new(t));
        let (mut rnea_p, mut aba_p, mut crba_p, mut ltdl_p) =
            (ParallelRnea::new(t), ParallelAba::new(t), ParallelCrba::new(t), ParallelLtdl::new(t));
        for k in 0..states.count() {
            for f in [None, Some(&f[..])] {
                rnea.run(&model, states.q(k), states.v(k), states.a(k), f, &mut tau).unwrap();
                aba.run(&model, states.q(k), states.v(k), states.tau(k), f, &mut a).unwrap();
                crba.run(&model, states.q(k), &mut matrix).unwrap();
                ltdl.run(&matrix).unwrap();
                in_pools(|threads| {
                    let (mut tau_p, mut a_p, mut matrix_p) = (vec![f64::NAN; t.nv()], vec![f64::NAN; t.nv()], TreeSparse::new(t));
                    rnea_p.run(&model, states.q(k), states.v(k), states.a(k), f, &mut tau_p).unwrap();
                    assert_eq!(tau_p, tau, "{name}: RNEA on {threads} threads");
                    aba_p.run(&model, states.q(k), states.v(k), states.tau(k), f, &mut a_p).unwrap();
                    assert_eq!(a_p, a, "{name}: ABA on {threads} threads");
                    crba_p.run(&model, states.q(k), &mut matrix_p).unwrap();
                    assert_eq!(matrix_p, matrix, "{name}: CRBA on {threads} threads");
                    ltdl_p.run(&matrix_p).unwrap();
                    assert_eq!(ltdl_p.factors().factors(), ltdl.factors(), "{name}: LTDL on {threads} threads");
                    runs += 1;
                });
            }
        }
    }
    assert!(runs >= 12 * TREES.len(), "{runs} runs");
}

/// A joint without inertia: the same dof is named as by one thread.
#[test]
fn errors_are_those_of_one_thread() {
    let mut failed = 0;
    for spec in ["binary_tree:depth=9", "centipede:segments=40", "platform:robots=20,n=6", "tree:n=200,joints=all,base=free"] {
        let mut model = generated(spec);
        let bodies = model.topology.bodies();
        let (t, states) = (model.topology.clone(), StateBatch::random(&model, 1, 3));
        // Two bodies at a time lose themselves and what they carry.
        for (first, second) in [(0, bodies - 1), (bodies / 3, bodies / 2), (bodies / 5, bodies / 5 + 1)] {
            let whole = model.inertias.clone();
            let mut empty = vec![false; bodies];
            for (i, joint) in t.joints().iter().enumerate() {
                empty[i] = i == first || i == second || joint.parent.is_some_and(|parent| empty[parent]);
                if empty[i] {
                    model.inertias[i] = featherbench_spatial::RigidBodyInertia::zero();
                }
            }
            let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
            let mut a = vec![0.0; t.nv()];
            let serial = Aba::new(&t).run(&model, q, v, tau, None, &mut a).unwrap_err();
            assert!(matches!(serial, Error::NotPositiveDefinite(_)));
            let mut matrix = TreeSparse::new(&t);
            Crba::new(&t).run(&model, q, &mut matrix).unwrap();
            let factored = Ltdl::new(&t).run(&matrix).unwrap_err();
            in_pools(|threads| {
                let found = ParallelAba::new(&t).run(&model, q, v, tau, None, &mut a).unwrap_err();
                assert_eq!(found.to_string(), serial.to_string(), "{spec}: ABA on {threads} threads");
                let found = ParallelLtdl::new(&t).run(&matrix).unwrap_err();
                assert_eq!(found.to_string(), factored.to_string(), "{spec}: LTDL on {threads} threads");
                failed += 1;
            });
            model.inertias = whole;
        }
    }
    assert_eq!(failed, 36);
}

/// The plan belongs to a tree: another one of the same size is refused.
#[test]
fn another_tree_of_the_same_size_is_refused() {
    let (tree, chain) = (generated("binary_tree:depth=8"), generated("chain:n=255,layout=spatial"));
    let states = StateBatch::random(&chain, 1, 3);
    let (q, v, tau, mut out) = (states.q(0), states.v(0), states.tau(0), vec![f64::zero(); 255]);
    assert!(ParallelAba::new(&tree.topology).run(&chain, q, v, tau, None, &mut out).is_err());
    assert!(ParallelRnea::new(&tree.topology).run(&chain, q, v, tau, None, &mut out).is_err());
    let mut matrix = TreeSparse::new(&chain.topology);
    assert!(ParallelCrba::new(&tree.topology).run(&chain, q, &mut matrix).is_err());
    assert!(ParallelLtdl::new(&tree.topology).run(&matrix).is_err());
}
