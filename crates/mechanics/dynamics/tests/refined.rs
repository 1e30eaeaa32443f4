//! Refined forward dynamics is right to the last digit where the plain algorithm loses up to ten digits.
//!
//! The truth here is the same algorithm's text in double-double, refined by a double-double residual. Its error is below 10⁻²² in every
//! case:
//! enough to judge `f64` digits. It is not an independent witness; that is crate `reference`'s task.

use crate::common;

use common::{ROBOTS, build, describe, distance, dyadic_chain, larger, largest, lifted, within, wrenches};
use featherbench_dynamics::{
    Aba, Crba, Error, Ltdl, NotPositiveDefinite, Refined, Rnea, forward_dynamics, mass_matrix, refined_forward_dynamics,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Compensated, DoubleDouble, Force, Lift, Real};
use std::f64::consts::PI;
use wide::f64x8;

/// Half a unit in the last place: what rounding the exact result makes of each number, and so of a vector's 2-norm.
const ROUNDING: f64 = f64::EPSILON / 2.0;

type Extended = Vec<DoubleDouble>;

/// Accelerations by the articulated-body algorithm in double-double, refined twice in double-double.
fn truth<P: Real + Lift<DoubleDouble>>(model: &Model<P>, q: &[f64], v: &[f64], tau: &[f64], wrenches: Option<&[Force<f64>]>) -> Extended {
    let wrenches: Option<Vec<Force<DoubleDouble>>> = wrenches.map(|wrenches| wrenches.iter().map(|f| f.lift()).collect());
    let wrenches = wrenches.as_deref();
    let (q, v, tau): (Extended, Extended, Extended) = (lifted(q), lifted(v), lifted(tau));
    let (mut aba, mut rnea) = (Aba::new(&model.topology), Rnea::new(&model.topology));
    let [mut a, mut taken, mut correction] = [(); 3].map(|()| vec![DoubleDouble::zero(); v.len()]);
    aba.run(model, &q, &v, &tau, wrenches, &mut a).unwrap();
    for _ in 0..2 {
        rnea.run(model, &q, &v, &a, wrenches, &mut taken).unwrap();
        let residual: Extended = tau.iter().zip(&taken).map(|(tau, taken)| *tau - *taken).collect();
        aba.solve(model, &residual, &mut correction).unwrap();
        a.iter_mut().zip(&correction).for_each(|(a, correction)| *a += *correction);
    }
    a
}

fn norm(x: impl Iterator<Item = f64>) -> f64 {
    x.map(|x| x * x).sum::<f64>().sqrt()
}

/// ‖a − truth‖/‖truth‖ in the 2-norm.
fn error<T: Copy + Lift<DoubleDouble>>(a: &[T], truth: &[DoubleDouble]) -> f64 {
    norm(a.iter().zip(truth).map(|(a, truth)| (a.lift() - *truth).to_f64())) / norm(truth.iter().map(|truth| truth.to_f64()))
}

/// The same in the kinetic-energy norm √(xᵀMx).
fn energy_error<T: Copy + Lift<DoubleDouble>>(model: &Model<f64>, q: &[f64], a: &[T], truth: &[DoubleDouble]) -> f64 {
    let matrix = mass_matrix(model, &lifted::<DoubleDouble>(q)).unwrap();
    let norm = |x: &[DoubleDouble]| {
        let mut product = x.to_vec();
        matrix.mul(x, &mut product).unwrap();
        x.iter().zip(&product).fold(DoubleDouble::zero(), |sum, (x, y)| x.mul_add(*y, sum)).sqrt().to_f64()
    };
    let off: Extended = a.iter().zip(truth).map(|(a, truth)| a.lift() - *truth).collect();
    norm(&off) / norm(truth)
}

/// Accelerations by one more workspace, and what it holds unrounded.
fn refined<R: Real + Lift<f64>>(steps: usize, model: &Model<f64>, q: &[f64], v: &[f64], tau: &[f64]) -> (Vec<f64>, Vec<R>)
where
    f64: Lift<R>,
{
    let (mut workspace, mut a) = (Refined::<R>::new(&model.topology, steps), vec![0.0; v.len()]);
    workspace.run(model, q, v, tau, None, &mut a).unwrap();
    let unrounded = workspace.accelerations().to_vec();
    (a, unrounded)
}

/// The table of the reference chains: family, reach of the angles in π, factor on the velocities, states, and the error that the plain
/// algorithm may have.
fn table() -> Vec<(String, f64, f64, usize, f64)> {
    let small = 0.2 / PI;
    let mut cases = Vec::new();
    for (n, states) in [(10, 20), (20, 20), (50, 20), (200, 5), (512, 2)] {
        for (layout, reach) in [("planar", small), ("planar", 0.0), ("spatial", 1.0)] {
            cases.push((format!("chain:n={n},layout={layout}"), reach, 1.0, states, 1e-13));
        }
    }
    for (layout, reach) in [("planar", small), ("spatial", 1.0)] {
        // The loss is the ratio of the masses in units of the last place, times a few hundred for other roundings.
        for (tip, loss) in [("1e-6", 1e-13), ("1e-3", 1e-13), ("1e3", 1e-11), ("1e6", 1e-8)] {
            cases.push((format!("chain:n=20,layout={layout},tip_scale={tip}"), reach, 1.0, 20, loss));
        }
        for offset in ["1e2", "1e4", "1e6"] {
            cases.push((format!("chain:n=20,layout={layout},base_offset={offset}"), reach, 1.0, 5, 1e-13));
        }
        for n in [20, 200] {
            cases.push((format!("chain:n={n},layout={layout}"), reach, 1e3, 5, 1e-13));
        }
    }
    cases.push(("humanoid:hand_mass=1".into(), 1.0, 1.0, 20, 1e-13));
    cases.push(("humanoid:hand_mass=1000".into(), 1.0, 1.0, 20, 1e-11));
    cases
}

#[test]
fn every_case_of_the_table_is_right_to_the_last_digit() {
    for (family, reach, speed, count, loss) in table() {
        let model = Model::build(&describe(&family)).unwrap();
        let mut states = StateBatch::random(&model, count, 7);
        if reach != 1.0 {
            states.q.iter_mut().for_each(|q| *q *= reach);
        }
        states.v.iter_mut().for_each(|v| *v *= speed);
        let name = format!("{family}, reach {reach:.2}π, speed {speed}");
        for k in 0..states.count() {
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            let truth = truth(&model, q, v, tau, None);
            within(&format!("{name}: plain"), error(&forward_dynamics(&model, q, v, tau).unwrap(), &truth), loss);

            // Every number is the exact one rounded; one in a thousand lay nearly between two doubles. That is below the goal of 4·2⁻⁵².
            let goal = ROUNDING * 1.001;
            let (one, unrounded) = refined::<Compensated>(1, &model, q, v, tau);
            within(&format!("{name}: one step"), error(&one, &truth), goal);
            let (two, _) = refined::<Compensated>(2, &model, q, v, tau);
            within(&format!("{name}: two steps"), error(&two, &truth), goal);
            within(&format!("{name}: double-double"), error(&refined::<DoubleDouble>(1, &model, q, v, tau).0, &truth), goal);

            // Rounding to f64 is an error of up to 1e-12 in the energy norm of a straight chain. Before rounding the error is negligible.
            let unrounded: Extended = unrounded.into_iter().map(Compensated::to_double_double).collect();
            within(&format!("{name}: M-norm"), energy_error(&model, q, &unrounded, &truth), 4.0 * f64::EPSILON);

            // A plain residual: the error of inverse dynamics grows with the length of the path, like its square root or slower.
            let bound = 8.0 * f64::EPSILON * (model.topology.nv() as f64 / 50.0).sqrt().max(1.0);
            within(&format!("{name}: f64 residual"), error(&refined::<f64>(1, &model, q, v, tau).0, &truth), bound);
        }
    }
}

#[test]
fn every_kind_of_joint_with_wrenches_and_armature() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 10, 3);
        let f = wrenches(&model, 5);
        let (mut workspace, mut a) = (Refined::<Compensated>::new(&model.topology, 1), vec![0.0; model.topology.nv()]);
        for k in 0..states.count() {
            let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
            workspace.run(&model, q, v, tau, Some(&f), &mut a).unwrap();
            within(name, error(&a, &truth(&model, q, v, tau, Some(&f))), ROUNDING * 1.001);
        }
    }
}

/// Eight states in registers and each alone. All operations but the sines and cosines of the start are the same. After two steps what is left
/// of the start differs by 10⁻²⁴. So one number in 10⁸ is rounded to its other neighbour. None is here.
#[test]
fn registers_of_states_give_what_each_state_alone_gives() {
    let robots = ROBOTS.iter().map(|(name, recipe)| ((*name).to_owned(), build(recipe)));
    let heavy = ["humanoid:hand_mass=1000", "chain:n=20,layout=spatial,tip_scale=1e6"];
    let heavy = heavy.map(|family| (family.to_owned(), Model::build(&describe(family)).unwrap()));
    for (name, model) in robots.chain(heavy) {
        let states = StateBatch::random(&model, 8, 13);
        let f = wrenches(&model, 6);
        let (nv, steps) = (model.topology.nv(), 2);
        let lanes = |state: fn(&StateBatch, usize) -> &[f64]| -> Vec<f64x8> {
            (0..state(&states, 0).len()).map(|entry| f64x8::new(std::array::from_fn(|lane| state(&states, lane)[entry]))).collect()
        };
        let (q, v, tau) = (lanes(StateBatch::q), lanes(StateBatch::v), lanes(StateBatch::tau));
        let wide_f: Vec<Force<f64x8>> = f.iter().map(|f| f.lift()).collect();
        let (mut a, mut workspace) = (vec![f64x8::ZERO; nv], Refined::<Compensated<f64x8>, f64x8>::new(&model.topology, steps));
        workspace.run(&model, &q, &v, &tau, Some(&wide_f), &mut a).unwrap();
        for lane in 0..8 {
            let (mut alone, mut single) = (vec![0.0; nv], Refined::<Compensated>::new(&model.topology, steps));
            single.run(&model, states.q(lane), states.v(lane), states.tau(lane), Some(&f), &mut alone).unwrap();
            let together: Vec<f64> = a.iter().map(|a| a.to_array()[lane]).collect();
            assert_eq!(together, alone, "{name}, lane {lane}");
            let of_lane = |number: &Compensated<f64x8>| {
                let [value, rest] = number.to_parts().map(|part| part.to_array()[lane]);
                DoubleDouble::from_sum(value, rest)
            };
            let together: Extended = workspace.accelerations().iter().map(of_lane).collect();
            let alone: Extended = single.accelerations().iter().map(|number| number.to_double_double()).collect();
            // The heavy robots keep six digits at the start: 10⁻¹⁸ and 10⁻²⁴ after the steps, and 10⁻²⁶ is the error of the residual.
            within(&format!("{name}, lane {lane}: unrounded"), error(&together, &alone), 1e-23);
        }
    }
}

/// The parameters of a description with 32 digits, and a register of copies of one state.
#[test]
fn registers_take_a_model_in_double_double() {
    let extended = Model::<DoubleDouble>::build(&describe("humanoid:hand_mass=1000")).unwrap();
    let states = StateBatch::random(&Model::<f64>::build(&describe("humanoid:hand_mass=1000")).unwrap(), 5, 2);
    let t = &extended.topology;
    let (mut wide, mut single) = (Refined::<Compensated<f64x8>, f64x8>::new(t, 2), Refined::<Compensated>::new(t, 2));
    let (mut a, mut alone) = (vec![f64x8::ZERO; t.nv()], vec![0.0; t.nv()]);
    for k in 0..states.count() {
        let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
        wide.run(&extended, &lifted(q), &lifted(v), &lifted(tau), None, &mut a).unwrap();
        single.run(&extended, q, v, tau, None, &mut alone).unwrap();
        for lane in 0..8 {
            assert_eq!(a.iter().map(|a| a.to_array()[lane]).collect::<Vec<_>>(), alone, "state {k}, lane {lane}");
        }
    }
}

/// A chain whose numbers are the same in single precision: its accelerations are the exact ones, rounded to single precision.
#[test]
fn single_precision_is_right_to_its_last_digit() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for bodies in [1, 5, 12] {
        let exact = dyadic_chain(&axes, bodies);
        let model: Model<f32> = exact.lift();
        let states = StateBatch::random(&exact, 20, 4);
        let (mut workspace, mut a) = (Refined::<Compensated<f32>, f32>::new(&model.topology, 3), vec![0.0; model.topology.nv()]);
        for k in 0..states.count() {
            let [q, v, tau] = [states.q(k), states.v(k), states.tau(k)].map(|x| x.iter().map(|x| *x as f32).collect::<Vec<f32>>());
            workspace.run(&model, &q, &v, &tau, None, &mut a).unwrap();
            let [q, v, tau, a] = [&q, &v, &tau, &a].map(|x| x.iter().map(|x| f64::from(*x)).collect::<Vec<f64>>());
            // As in double precision, one number in a thousand may lie nearly in the middle.
            let goal = f64::from(f32::EPSILON) / 2.0 * 1.001;
            within(&format!("{bodies} bodies, single precision"), error(&a, &truth(&exact, &q, &v, &tau, None)), goal);
        }
    }
}

#[test]
fn solutions_are_those_of_the_mass_matrix() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 5, 8);
        let (mut aba, mut crba, mut ltdl) = (Aba::new(t), Crba::new(t), Ltdl::new(t));
        let [mut a, mut x, mut y] = [(); 3].map(|()| vec![0.0; t.nv()]);
        for k in 0..states.count() {
            aba.run(&model, states.q(k), states.v(k), states.tau(k), None, &mut a).unwrap();
            crba.run(&model, states.q(k), ltdl.matrix_mut()).unwrap();
            ltdl.factor().unwrap();
            // Twice on one workspace: a solution leaves the inertias as they are.
            for f in [states.a(k), states.v(k)] {
                aba.solve(&model, f, &mut x).unwrap();
                y.copy_from_slice(f);
                ltdl.solve(&mut y).unwrap();
                // The factorization loses up to a hundred units in the last place to the condition numbers of these robots.
                within(name, distance(&x, &y) / largest(&y), 128.0 * f64::EPSILON);
            }
        }
    }
}

/// The robot of a description with decimal numbers, not the one that its rounded inertias make.
#[test]
fn a_model_in_double_double_gives_the_accelerations_of_the_description() {
    let description = describe("humanoid:hand_mass=1000");
    let (plain, extended) = (Model::<f64>::build(&description).unwrap(), Model::<DoubleDouble>::build(&description).unwrap());
    let states = StateBatch::random(&plain, 10, 2);
    for k in 0..states.count() {
        let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
        let truth = truth(&extended, q, v, tau, None);
        let mut workspace = Refined::<DoubleDouble>::new(&extended.topology, 2);
        let mut a = vec![0.0; v.len()];
        workspace.run(&extended, q, v, tau, None, &mut a).unwrap();
        within("the description", error(&a, &truth), ROUNDING * 1.001);
        within("the description, unrounded", error(workspace.accelerations(), &truth), 1e-24);
        workspace.run(&plain, q, v, tau, None, &mut a).unwrap();
        let off = error(workspace.accelerations(), &truth);
        within("rounded inertias", off, 4.0 * f64::EPSILON);
        assert!(off > 1e-20, "the two robots are not the same: {off:e}");
    }
}

/// With a tip 10¹⁰ times as heavy as a link the plain algorithm keeps about five digits. Each step adds about as many.
#[test]
fn steps_converge_and_say_how_far_they_moved() {
    let model = Model::build(&describe("chain:n=20,layout=spatial,tip_scale=1e10")).unwrap();
    let states = StateBatch::random(&model, 20, 7);
    let mut errors = [0.0_f64; 4];
    for k in 0..states.count() {
        let (q, v, tau) = (states.q(k), states.v(k), states.tau(k));
        let truth = truth(&model, q, v, tau, None);
        for (steps, worst) in errors.iter_mut().enumerate() {
            let mut workspace = Refined::<DoubleDouble>::new(&model.topology, steps);
            let mut a = vec![0.0; model.topology.nv()];
            workspace.run(&model, q, v, tau, None, &mut a).unwrap();
            if steps == 0 {
                assert_eq!(a, forward_dynamics(&model, q, v, tau).unwrap(), "no step is the plain algorithm");
                assert!(workspace.correction().iter().all(|&x| x == 0.0));
            } else {
                // What the step added is the error before it, to a digit at least.
                let (before, _) = refined::<DoubleDouble>(steps - 1, &model, q, v, tau);
                let moved = norm(workspace.correction().iter().copied());
                let off = norm(before.iter().zip(&truth).map(|(a, truth)| (DoubleDouble::from_f64(*a) - *truth).to_f64()));
                // Rounded accelerations have the error of the rounding as well.
                assert!(moved <= 1.1 * off + ROUNDING * norm(before.iter().copied()), "{moved:e} against {off:e}");
            }
            *worst = larger(*worst, error(workspace.accelerations(), &truth));
        }
    }
    let [plain, first, second, third] = errors;
    assert!(plain > 1e-8, "the plain algorithm loses more than half of the digits: {plain:e}");
    // Seen: 3e-6, 5e-11, 7e-16, 3e-20. Each step adds about the digits of the start.
    assert!(first < 1e-4 * plain && second < 1e-4 * first && third < 1e-3 * second, "{errors:?}");
}

#[test]
fn a_used_workspace_gives_the_same_bits() {
    let model = build(&ROBOTS[7].1);
    let states = StateBatch::random(&model, 4, 1);
    let mut workspace = Refined::<Compensated>::new(&model.topology, 2);
    let mut a = vec![0.0; model.topology.nv()];
    for k in [0, 1, 2, 3, 0] {
        workspace.run(&model, states.q(k), states.v(k), states.tau(k), None, &mut a).unwrap();
        assert_eq!(a, refined_forward_dynamics(&model, states.q(k), states.v(k), states.tau(k), 2).unwrap());
    }
}

#[test]
fn bad_input_is_answered() {
    let model = build(&ROBOTS[7].1);
    let t = &model.topology;
    let (nq, nv) = (t.nq(), t.nv());
    let (q, x, short) = (vec![0.5; nq], vec![0.5; nv], vec![0.5; nv - 1]);
    let (mut a, mut short_a) = (vec![0.0; nv], vec![0.0; nv - 1]);
    let few = vec![Force::zero(); t.bodies() - 1];
    let refusal = |result: Result<(), Error>| match result {
        Err(Error::Dimension(error)) => (error.what, error.expected, error.found),
        other => panic!("expected a dimension error, got {other:?}"),
    };
    let mut workspace = Refined::<Compensated>::new(t, 1);
    assert_eq!(refusal(workspace.run(&model, &x, &x, &x, None, &mut a)), ("configuration q", nq, nv));
    assert_eq!(refusal(workspace.run(&model, &q, &short, &x, None, &mut a)), ("velocity v", nv, nv - 1));
    assert_eq!(refusal(workspace.run(&model, &q, &x, &short, None, &mut a)), ("joint forces tau", nv, nv - 1));
    assert_eq!(refusal(workspace.run(&model, &q, &x, &x, None, &mut short_a)), ("acceleration a", nv, nv - 1));
    assert_eq!(refusal(workspace.run(&model, &q, &x, &x, Some(&few), &mut a)), ("external wrenches", t.bodies(), t.bodies() - 1));
    let other = build(&ROBOTS[0].1);
    let mut foreign = Refined::<Compensated>::new(&other.topology, 1);
    assert!(refusal(foreign.run(&model, &q, &x, &x, None, &mut a)).0.ends_with("of the workspace"));
    let mut aba = Aba::<f64>::new(t);
    assert_eq!(refusal(aba.solve(&model, &short, &mut a).map_err(Error::from)), ("joint forces f", nv, nv - 1));
    assert_eq!(refusal(aba.solve(&model, &x, &mut short_a).map_err(Error::from)), ("solution x", nv, nv - 1));
    assert!(refusal(aba.solve(&other, &x, &mut a).map_err(Error::from)).0.ends_with("of the workspace"));
}

#[test]
fn massless_bodies_and_nan_are_answered() {
    let mut model = build(&ROBOTS[0].1);
    let n = model.topology.nv();
    let (ones, nans) = (vec![1.0; n], vec![f64::NAN; n]);
    assert!(matches!(refined_forward_dynamics(&model, &nans, &ones, &ones, 1), Err(Error::NotPositiveDefinite(_))));
    for (v, tau) in [(&nans, &ones), (&ones, &nans)] {
        let a = refined_forward_dynamics(&model, &ones, v, tau, 2).unwrap();
        assert!(a.iter().any(|a| a.is_nan()), "as the plain algorithm: what is not a number is not hidden");
    }
    model.inertias[n - 1] = featherbench_spatial::RigidBodyInertia::zero();
    let refused = refined_forward_dynamics(&model, &ones, &ones, &ones, 1);
    assert!(matches!(refused, Err(Error::NotPositiveDefinite(NotPositiveDefinite { dof, .. })) if dof == n - 1));
}
