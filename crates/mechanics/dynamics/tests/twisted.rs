//! Forward dynamics of a chain from both ends: right in exact enough arithmetic, accurate in `f64`, and the same on any number of threads.

use crate::common;

use common::{Kind, Recipe, describe, generated, lifted, robot, within, wrenches};
use featherbench_dynamics::{Aba, Error, Twisted};
use featherbench_model::{Description, Model, Topology};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Counted, DoubleDouble, Force, Lift, Operations, Real};
use rayon::ThreadPoolBuilder;

fn two_norm<T: Real + Lift<DoubleDouble>>(values: &[T], truth: &[DoubleDouble]) -> f64 {
    let square = |x: DoubleDouble| (x * x).to_f64();
    let off: f64 = values.iter().zip(truth).map(|(value, truth)| square(value.lift() - *truth)).sum();
    (off / truth.iter().map(|truth| square(*truth)).sum::<f64>()).sqrt()
}

fn aba<P: Real + Lift<T>, T: Real>(model: &Model<P>, states: &StateBatch, k: usize, f: Option<&[Force<T>]>) -> Vec<T>
where
    f64: Lift<T>,
{
    let [q, v, tau] = [states.q(k), states.v(k), states.tau(k)].map(lifted::<T>);
    let mut a = vec![T::zero(); model.topology.nv()];
    Aba::new(&model.topology).run(model, &q, &v, &tau, f, &mut a).unwrap();
    a
}

fn twisted<P: Real + Lift<T>, T: Real>(model: &Model<P>, states: &StateBatch, k: usize, f: Option<&[Force<T>]>, cut: usize) -> Vec<T>
where
    f64: Lift<T>,
{
    let [q, v, tau] = [states.q(k), states.v(k), states.tau(k)].map(lifted::<T>);
    let mut a = vec![T::zero(); model.topology.nv()];
    Twisted::with_cut(&model.topology, cut).expect("a chain").run(model, &q, &v, &tau, f, &mut a).unwrap();
    a
}

/// Chains of every one-dof joint, with a fixed and a free base, with and without armature.
fn chains() -> Vec<(&'static str, Description)> {
    use Kind::{Free, Helical, Prismatic, Revolute};
    let random = |kinds: &'static [Kind], armature| robot(&Recipe { kinds, bodies: 14, branched: false, armature }, 11);
    let mut free = Recipe { kinds: &[Free, Revolute, Helical, Revolute, Prismatic, Revolute], bodies: 6, branched: false, armature: true };
    let with_armature = robot(&free, 11);
    free.armature = false;
    vec![
        ("spatial", describe("chain:n=13,layout=spatial")),
        ("planar", describe("chain:n=13")),
        ("snake", describe("snake:n=13")),
        ("random revolute", random(&[Revolute], false)),
        ("random screws", random(&[Revolute, Prismatic, Helical], false)),
        ("random screws with armature", random(&[Helical, Prismatic, Revolute], true)),
        ("random on a free base", robot(&free, 11)),
        ("random on a free base with armature", with_armature),
    ]
}

/// In 32 digits both algorithms are right, so they agree to more than 20: with every cut, state and wrench.
#[test]
fn both_ends_give_the_accelerations_of_the_articulated_body_algorithm() {
    let mut runs = 0;
    for (name, description) in chains() {
        // Rotations are orthonormal to 32 digits only if the model is formed with as many.
        let model: Model<DoubleDouble> = Model::build(&description).expect("a robot");
        let states = StateBatch::agreement(&Model::build(&description).expect("a robot"), 3, 5);
        let f: Vec<Force<DoubleDouble>> = wrenches(&Model::build(&description).expect("a robot"), 4).iter().map(|f| f.lift()).collect();
        for k in 0..states.count() {
            for f in [None, Some(&f[..])] {
                let truth = aba::<_, DoubleDouble>(&model, &states, k, f);
                for cut in 1..model.topology.bodies() {
                    let off = two_norm(&twisted::<_, DoubleDouble>(&model, &states, k, f, cut), &truth);
                    // κ(M) is at most 1e6 here: rounding to 2⁻¹⁰⁴ leaves more than 25 digits.
                    within(&format!("{name}: state {k}, cut {cut}"), off, 1e-24);
                    runs += 1;
                }
            }
        }
    }
    assert!(runs > 400, "{runs} runs");
}

/// The error against 32 digits is at most four times that of the articulated-body algorithm, in the mean over states and at worst.
#[test]
fn accuracy_is_that_of_the_articulated_body_algorithm() {
    let narrow = 0.2 / std::f64::consts::PI;
    let cases = [
        ("chain:n=100,layout=spatial", 1.0),
        ("chain:n=1000,layout=spatial", 1.0),
        ("chain:n=100", narrow),
        ("chain:n=1000", narrow),
        ("chain:n=100", 0.0),
        ("snake:n=100", 1.0),
        ("snake:n=1000", 1.0),
        ("chain:n=100,layout=spatial,tip_scale=1e3", 1.0),
        ("chain:n=100,layout=spatial,tip_scale=1e6", 1.0),
        ("tree:n=100,spread=0", 1.0),
    ];
    for (spec, reach) in cases {
        let model = generated(spec);
        let mut states = StateBatch::random(&model, 4, 9);
        if reach < 1.0 {
            states.q.iter_mut().for_each(|q| *q *= reach);
        }
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for k in 0..states.count() {
            let truth = aba::<_, DoubleDouble>(&model, &states, k, None);
            theirs.push(two_norm(&aba::<_, f64>(&model, &states, k, None), &truth));
            let [q, v, tau] = [states.q(k), states.v(k), states.tau(k)];
            let mut a = vec![0.0; model.topology.nv()];
            Twisted::new(&model.topology).expect("a chain").run(&model, q, v, tau, None, &mut a).unwrap();
            ours.push(two_norm(&a, &truth));
        }
        let worst = |errors: &[f64]| errors.iter().copied().fold(f64::EPSILON, common::larger);
        let mean = |errors: &[f64]| errors.iter().map(|error| error.ln()).sum::<f64>() / errors.len() as f64;
        println!("{spec}, reach {reach:.2}: worst {:.1e}, of ABA {:.1e}", worst(&ours), worst(&theirs));
        within(&format!("{spec}: ratio of the worst errors"), worst(&ours) / worst(&theirs), 4.0);
        within(&format!("{spec}: ratio of the mean errors"), (mean(&ours) - mean(&theirs)).exp(), 4.0);
    }
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    for (name, description) in chains() {
        let model: Model<f64> = Model::build(&description).expect("a robot");
        let states = StateBatch::random(&model, 1, 5);
        let on = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| twisted::<_, f64>(&model, &states, 0, None, 4))
        };
        let alone = on(1);
        assert_eq!(on(2), alone, "{name}");
        assert_eq!(on(3), alone, "{name}");
    }
}

/// A body without inertia about its joint cannot be eliminated from the base side; the answer is right all the same, to the bit of ABA.
#[test]
fn massless_bodies_are_left_to_the_articulated_body_algorithm() {
    let mut model = generated("chain:n=20,layout=spatial");
    model.inertias[2] = featherbench_spatial::RigidBodyInertia::zero();
    let states = StateBatch::random(&model, 1, 5);
    assert_eq!(twisted::<_, f64>(&model, &states, 0, None, 8), aba::<_, f64>(&model, &states, 0, None));

    // A tip without inertia is the error of ABA.
    model.inertias[19] = featherbench_spatial::RigidBodyInertia::zero();
    let (q, v, tau, mut a) = (states.q(0), states.v(0), states.tau(0), vec![0.0; 20]);
    let serial = Aba::new(&model.topology).run(&model, q, v, tau, None, &mut a).unwrap_err();
    assert!(matches!(serial, Error::NotPositiveDefinite(_)));
    let found = Twisted::new(&model.topology).unwrap().run(&model, q, v, tau, None, &mut a).unwrap_err();
    assert_eq!(found.to_string(), serial.to_string());
}

#[test]
fn other_trees_have_no_workspace() {
    let refuses = |spec: &str| Twisted::<f64>::new(&generated(spec).topology).is_none();
    for spec in ["binary_tree:depth=3", "star:n=3", "joints:kind=spherical,shape=single", "chain:n=1", "snake:n=2", "hand"] {
        assert!(refuses(spec), "{spec}");
    }
    assert!(!refuses("chain:n=2") && !refuses("snake:n=3"));
    // A workspace of a chain refuses a tree of as many bodies.
    let (chain, tree) = (generated("chain:n=7"), generated("binary_tree:depth=3"));
    let states = StateBatch::random(&tree, 1, 5);
    let mut a = vec![0.0; 7];
    let refused = Twisted::new(&chain.topology).unwrap().run(&tree, states.q(0), states.v(0), states.tau(0), None, &mut a);
    assert!(matches!(refused, Err(Error::Dimension(_))));
}

/// The operations per joint of both sides. They are exact: a joint more on a side adds them.
#[test]
fn work_per_joint_is_what_the_documentation_says() {
    let counted = |n: usize, cut: usize| -> Operations {
        let model = generated(&format!("chain:n={n},layout=spatial"));
        let states = StateBatch::random(&model, 1, 5);
        let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        pool.install(|| Counted::count(|| drop(twisted::<_, Counted>(&model, &states, 0, None, cut))))
    };
    let serial = |n: usize| -> Operations {
        let model = generated(&format!("chain:n={n},layout=spatial"));
        let states = StateBatch::random(&model, 1, 5);
        Counted::count(|| drop(aba::<_, Counted>(&model, &states, 0, None)))
    };
    let per_joint = |more: Operations, less: Operations| (more.total() - less.total()) / 8;
    let (base, tip) = (per_joint(counted(28, 14), counted(20, 6)), per_joint(counted(28, 6), counted(20, 6)));
    let alone = per_joint(serial(28), serial(20));
    println!("base side {base}, tip side {tip}, ABA {alone}");
    assert_eq!(tip, alone, "the tip side is the articulated-body algorithm");
    assert_eq!((base, alone), (786, 421));
}

/// The cut is a share of the chain, and a free base stands on the base side.
#[test]
fn topologies_of_chains_are_accepted() {
    let topology: Topology = generated("snake:n=40").topology;
    assert!(Twisted::<f64>::with_cut(&topology, 0).is_some() && Twisted::<f64>::with_cut(&topology, 100).is_some());
}
