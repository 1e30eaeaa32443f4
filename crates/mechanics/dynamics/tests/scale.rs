//! Robots of many joints: the answers are right, and no algorithm calls itself for each joint.

use crate::common;

use common::{describe, within};
use featherbench_dynamics::{Aba, Crba, Energy, Kinematics, Ltdl, Momentum, ParallelAba, ParallelRnea, Refined, Rnea, TreeSparse, Twisted};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Compensated, Vec3};

/// Runs it on a thread whose stack of 256 KiB has no room for a call per joint: two bytes for each of a chain of 10⁵.
fn on_a_small_stack(test: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(256 << 10).spawn(test).expect("a thread");
    thread.join().expect("the test passes on a small stack");
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn off(x: &[f64], y: &[f64]) -> f64 {
    let difference: Vec<f64> = x.iter().zip(y).map(|(x, y)| x - y).collect();
    norm(&difference) / norm(y)
}

/// Depth 10⁵: from the family to the accelerations and back, and until everything is dropped.
#[test]
fn a_chain_of_a_hundred_thousand_joints_needs_no_deep_stack() {
    on_a_small_stack(|| {
        let description = describe("chain:n=100000,layout=spatial");
        description.validate().unwrap();
        let model: Model<f64> = Model::build(&description).unwrap();
        let t = &model.topology;
        assert_eq!((t.depth(), t.stored()), (100_000, 5_000_050_000));
        let states = StateBatch::random(&model, 1, 1);
        let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
        let (mut a, mut back) = (vec![0.0; t.nv()], vec![0.0; t.nv()]);

        let mut aba = Aba::new(t);
        aba.run(&model, q, v, tau, None, &mut a).unwrap();
        Twisted::new(t).unwrap().run(&model, q, v, tau, None, &mut back).unwrap();
        // Both err by some 1e-15, as on chains of 1000 (twisted.rs).
        within("Twisted against Aba", off(&back, &a), 1e-13);
        ParallelAba::new(t).run(&model, q, v, tau, None, &mut back).unwrap();
        assert_eq!(back, a);

        let mut refined = Refined::<Compensated>::new(t, 1);
        refined.run(&model, q, v, tau, None, &mut back).unwrap();
        within("Aba against refined", off(&a, &back), 1e-13);
        within("the last correction is what the start missed", norm(refined.correction()) / norm(&back), 1e-13);

        // Inverse dynamics gives the joint forces back; their terms are some n times as large.
        let mut rnea = Rnea::new(t);
        rnea.run(&model, q, v, &back, None, &mut a).unwrap();
        let mut parallel = vec![0.0; t.nv()];
        ParallelRnea::new(t).run(&model, q, v, &back, None, &mut parallel).unwrap();
        assert_eq!(parallel, a);
        assert!(a.iter().all(|tau| tau.is_finite()));

        let mut kinematics = Kinematics::new(t);
        kinematics.run(&model, q, v, &back).unwrap();
        assert!(kinematics.body(99_999).unwrap().velocity.lin.norm().is_finite());
        assert!(Energy::new(t).run(&model, q, v).unwrap().kinetic > 0.0);
        assert_eq!(Momentum::new(t).run(&model, q, v).unwrap().center.mass, 100_000.0);
    });
}

/// M⁻¹ f without M: inverse dynamics at rest, without gravity, gives f back.
#[test]
fn the_inverse_of_m_is_applied_without_m() {
    let mut model: Model<f64> = Model::build(&describe("snake:n=100000")).unwrap();
    model.gravity = Vec3::zero();
    let t = &model.topology;
    let states = StateBatch::random(&model, 1, 1);
    let (q, f, still) = (states.q(0), states.tau(0), vec![0.0; t.nv()]);
    let (mut aba, mut x, mut back) = (Aba::new(t), vec![0.0; t.nv()], vec![0.0; t.nv()]);
    aba.run(&model, q, &still, f, None, &mut back).unwrap();
    aba.solve(&model, f, &mut x).unwrap();
    // At rest and without gravity, forward dynamics is M⁻¹ f as well.
    within("M⁻¹ f against forward dynamics", off(&x, &back), 1e-13);
    Refined::<Compensated>::new(t, 1).run(&model, q, &still, f, None, &mut back).unwrap();
    within("M⁻¹ f against refined forward dynamics", off(&x, &back), 1e-13);
}

/// A tree of logarithmic depth: the mass matrix, its factors and a solution against ABA.
#[test]
fn a_binary_tree_of_sixteen_thousand_joints_is_factored() {
    on_a_small_stack(|| {
        let model: Model<f64> = Model::build(&describe("binary_tree:depth=14")).unwrap();
        let t = &model.topology;
        // Σ d_k = 13·2¹⁴ + 1
        assert_eq!((t.nv(), t.stored()), (16_383, 13 * (1 << 14) + 1));
        let states = StateBatch::random(&model, 1, 1);
        let (mut matrix, mut ltdl) = (TreeSparse::new(t), Ltdl::new(t));
        Crba::new(t).run(&model, states.q(0), &mut matrix).unwrap();
        ltdl.run(&matrix).unwrap();
        let mut x = states.tau(0).to_vec();
        ltdl.solve(&mut x).unwrap();

        let mut by_aba = vec![0.0; t.nv()];
        let mut aba = Aba::new(t);
        aba.run(&model, states.q(0), states.v(0), states.tau(0), None, &mut by_aba).unwrap();
        aba.solve(&model, states.tau(0), &mut by_aba).unwrap();
        // κ(M) of 14 links in a row is some 1e4, and both err by a part of κ ε.
        within("LTDL against ABA", off(&x, &by_aba), 1e-12);
    });
}
