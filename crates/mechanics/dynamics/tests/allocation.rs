//! No call on a workspace allocates.

#![allow(unsafe_code, reason = "a counting allocator has to implement the unsafe trait GlobalAlloc")]

use crate::common;

use common::{ROBOTS, build, describe, wrenches};
use featherbench_dynamics::integrate::{
    Adjoint, Analytic, ByDuals, Cost, CostGradient, DormandPrince, Forward, ImplicitMidpoint, Motors, Rollout, RungeKutta4,
    SymplecticEuler, Tolerance, Visit,
};
use featherbench_dynamics::{
    Aba, Batch, Bias, CenterOfMass, Coriolis, Crba, Energy, FdDerivatives, FdHessian, FdPartials, FdSecondPartials, FloatingBase,
    IdDerivatives, IdHessian, IdPartials, IdSecondPartials, Jacobian, JacobianRate, Kinematics, Ltdl, Momentum, MomentumMatrix, PackedAba,
    PackedCenterOfMass, PackedCrba, PackedJacobian, PackedKinematics, PackedModel, PackedMomentum, PackedRnea, ParameterSensitivity,
    Refined, Regressor, RegressorMatrix, Rnea, State, TreePair, TreeSparse, Twisted, mass_matrix, to_lanes,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Compensated, DoubleDouble, Vec3};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    /// Bytes that this thread has allocated, less those that it has freed.
    static HELD: Cell<i64> = const { Cell::new(0) };
}

fn count(allocated: usize, freed: usize) {
    // A thread that is being torn down has no counter.
    if allocated > 0 {
        let _ = ALLOCATIONS.try_with(|allocations| allocations.set(allocations.get() + 1));
    }
    let _ = HELD.try_with(|held| held.set(held.get() + allocated as i64 - freed as i64));
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        // SAFETY: the caller's promise about `layout` is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, layout.size());
        // SAFETY: the caller's promise about `pointer` and `layout` is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size, layout.size());
        // SAFETY: the caller's promise about the arguments is passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn no_algorithm_allocates_in_a_call() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 3, 1);
        let f = wrenches(&model, 1);
        let mut out = vec![0.0; t.nv()];
        let (mut rnea, mut bias, mut aba, mut crba) = (Rnea::new(t), Bias::new(t), Aba::new(t), Crba::new(t));
        let (mut kinematics, mut energy, mut momentum) = (Kinematics::new(t), Energy::new(t), Momentum::new(t));
        let (mut center, mut jacobian) = (CenterOfMass::new(t), Jacobian::new(t));
        let (mut refined, mut extended) = (Refined::<Compensated>::new(t, 2), Refined::<DoubleDouble>::new(t, 1));
        let (mut matrix, mut ltdl, mut inverse) = (TreeSparse::new(t), Ltdl::new(t), vec![0.0; t.nv() * t.nv()]);
        // The first selected inverse makes its square.
        crba.run(&model, states.q(0), ltdl.matrix_mut()).unwrap();
        ltdl.factor().unwrap();
        ltdl.selected_inverse(&mut matrix).unwrap();
        let packed = PackedModel::new(&model);
        let (mut packed_rnea, mut packed_aba, mut packed_crba) =
            (PackedRnea::new(&packed), PackedAba::new(&packed), PackedCrba::new(&packed));
        let (mut packed_kinematics, mut packed_center) = (PackedKinematics::new(&packed), PackedCenterOfMass::new(&packed));
        let mut packed_momentum = PackedMomentum::new(&packed);
        let mut packed_jacobian = PackedJacobian::new(&packed);

        let before = ALLOCATIONS.get();
        for k in 0..states.count() {
            let (q, v, a, tau) = (states.q(k), states.v(k), states.a(k), states.tau(k));
            rnea.run(&model, q, v, a, Some(&f), &mut out).unwrap();
            packed_rnea.run(&packed, q, v, a, Some(&f), &mut out).unwrap();
            packed_rnea.bias(&packed, q, v, Some(&f), &mut out).unwrap();
            packed_aba.run(&packed, q, v, tau, Some(&f), &mut out).unwrap();
            packed_crba.run(&packed, q, &mut matrix).unwrap();
            bias.run(&model, q, v, Some(&f), &mut out).unwrap();
            aba.run(&model, q, v, tau, Some(&f), &mut out).unwrap();
            aba.solve(&model, tau, &mut out).unwrap();
            refined.run(&model, q, v, tau, Some(&f), &mut out).unwrap();
            extended.run(&model, q, v, tau, None, &mut out).unwrap();
            assert!(refined.accelerations().len() + refined.correction().len() == 2 * t.nv());
            crba.run(&model, q, &mut matrix).unwrap();
            ltdl.run(&matrix).unwrap();
            ltdl.solve(&mut out).unwrap();
            ltdl.inverse(&mut inverse).unwrap();
            ltdl.selected_inverse(&mut matrix).unwrap();
            crba.run(&model, q, ltdl.matrix_mut()).unwrap();
            ltdl.factor().unwrap();
            matrix.mul(v, &mut out).unwrap();
            kinematics.run(&model, q, v, a).unwrap();
            assert!(kinematics.iter().all(|body| body.velocity.ang.x.is_finite()));
            packed_kinematics.run(&packed, q, v, a).unwrap();
            assert!(packed_kinematics.iter().all(|body| body.velocity.ang.x.is_finite()));
            packed_center.run(&packed, q).unwrap();
            packed_momentum.run(&packed, q, v).unwrap();
            packed_jacobian.run(&packed, q, t.bodies() - 1).unwrap();
            energy.run(&model, q, v).unwrap();
            momentum.run(&model, q, v).unwrap();
            center.run(&model, q).unwrap();
            jacobian.run(&model, q, t.bodies() - 1).unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
        drop(vec![0_u8; 10]);
        assert!(ALLOCATIONS.get() > before, "the counter counts");
    }
}

#[test]
fn no_derivative_allocates_in_a_call() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 3, 1);
        let f = wrenches(&model, 1);
        let (mut id, mut fd) = (IdDerivatives::new(t), FdDerivatives::new(t));
        let (mut id_partials, mut fd_partials) = (IdPartials::new(t), FdPartials::new(t));
        let (mut id_hessian, mut fd_hessian) = (IdHessian::new(t), FdHessian::new(t));
        let (mut id_second, mut fd_second) = (IdSecondPartials::new(t), FdSecondPartials::new(t));
        let (mut coriolis, mut pair) = (Coriolis::new(t), TreePair::new(t));
        let (mut jacobian, mut momentum) = (JacobianRate::new(t), MomentumMatrix::new(t));
        let (mut regressor, mut columns) = (Regressor::new(t), RegressorMatrix::new(&model));
        let mut sensitivity = ParameterSensitivity::new(&model);
        let (mut out, mut dense) = (vec![0.0; t.nv()], vec![0.0; t.nv() * columns.columns()]);
        let (mut kinetic, mut potential) = (vec![0.0; columns.columns()], vec![0.0; columns.columns()]);
        let mut matrix = TreeSparse::new(t);

        let before = ALLOCATIONS.get();
        for k in 0..3 {
            let (q, v, a) = (states.q(k), states.v(k), states.a(k));
            let state = State { q, v, given: a, wrenches: Some(&f) };
            id.run(&model, q, v, a, Some(&f), &mut id_partials).unwrap();
            fd.run(&model, q, v, a, Some(&f), &mut fd_partials).unwrap();
            id_hessian.run(&model, state, v, &mut id_second).unwrap();
            fd_hessian.run(&model, state, v, &mut fd_partials, &mut fd_second).unwrap();
            id_partials.q.mul(v, &mut out).unwrap();
            id_partials.q.mul_transposed(v, &mut out).unwrap();
            id_partials.q.mul_rows(&fd_partials.v, &mut fd_partials.q).unwrap();
            id_partials.v.write_dense(&mut fd_partials.v).unwrap();
            coriolis.run(&model, q, v, &mut pair).unwrap();
            coriolis.christoffel(&model, q, 0, &mut pair).unwrap();
            pair.symmetric_sum(&mut matrix).unwrap();
            jacobian.run(&model, q, v, t.bodies() - 1, Vec3::zero()).unwrap();
            momentum.run(&model, q, v).unwrap();
            regressor.torque(&model, q, v, a, &mut columns).unwrap();
            regressor.momentum(&model, q, v, &mut columns).unwrap();
            regressor.energy(&model, q, v, &mut kinetic, &mut potential).unwrap();
            columns.mul(&kinetic, &mut out).unwrap();
            columns.mul_transposed(v, &mut kinetic).unwrap();
            sensitivity.run(&model, state, &mut out, &mut dense).unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    }
}

/// The first call of a kind makes its workspace.
#[test]
fn no_batch_of_derivatives_allocates_in_a_second_call() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let (t, n) = (&model.topology, model.topology.nv());
        let states = StateBatch::random(&model, 9, 1);
        let (q, v, a) = (&states.q, &states.v, &states.a);
        let (mut pairs, mut dense) = (vec![0.0; 9 * 5 * t.stored()], vec![0.0; 9 * (n + 3 * n * n)]);
        let mut coriolis = vec![0.0; 9 * 2 * t.stored()];
        let mut regressors = vec![0.0; 9 * RegressorMatrix::<f64>::new(&model).values().len()];
        let mut batch = Batch::<f64>::new(&model);
        let mut before = 0;
        for _ in 0..2 {
            before = ALLOCATIONS.get();
            batch.id_derivatives(q, v, a, None, &mut pairs).unwrap();
            batch.fd_derivatives(q, v, a, None, &mut dense).unwrap();
            batch.coriolis_matrix(q, v, &mut coriolis).unwrap();
            batch.torque_regressor(q, v, a, &mut regressors).unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    }
}

/// Steps, their derivatives, sensitivities and the adjoint.
#[test]
fn no_integration_allocates_in_a_call() {
    /// Half of the squared velocity at the end.
    struct Speed;
    impl Cost<f64> for Speed {
        fn value(&mut self, at: &Visit<'_, f64>) -> f64 {
            if at.last { 0.5 * at.v.iter().map(|v| v * v).sum::<f64>() } else { 0.0 }
        }

        fn add_gradient(&mut self, at: &Visit<'_, f64>, gradient: &mut CostGradient<'_, f64>) {
            if at.last {
                gradient.v.iter_mut().zip(at.v).for_each(|(sum, v)| *sum += v);
            }
        }
    }
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 1, 1);
        let steps = [1e-3; 4];
        let controls: Vec<f64> = (0..4).map(f64::from).collect();
        let rollout = Rollout { start: 0.0, steps: &steps, q: states.q(0), v: states.v(0), controls: &controls, parameters: &[] };
        let motors = Motors { dofs: vec![t.nv() - 1] };
        let mut duals = ByDuals::new(&model, motors.clone(), &[]).unwrap();
        let mut recursions = Analytic::new(&model, motors, &[]).unwrap();
        let (mut forward, mut adjoint) = (Forward::new(t, 1), Adjoint::new(t, 4, 2, 1));
        let (directions, mut ends) = (vec![1.0; rollout.variables()], vec![0.0; 2 * t.nv()]);
        let mut gradient = directions.clone();
        let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
        let mut pair = DormandPrince::with_derivatives(t, 1);
        macro_rules! all {
            ($($integrator:expr),+) => {$(
                let mut integrator = $integrator;
                let before = ALLOCATIONS.get();
                forward.run(&mut integrator, &mut recursions, &rollout, &directions, &mut ends).unwrap();
                forward.run(&mut integrator, &mut duals, &rollout, &directions, &mut ends).unwrap();
                adjoint.run(&mut integrator, &mut recursions, &rollout, &mut Speed, &mut gradient).unwrap();
                assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
            )+};
        }
        all!(
            SymplecticEuler::with_derivatives(t, 1),
            ImplicitMidpoint::with_derivatives(t, 1),
            RungeKutta4::with_derivatives(t, 1),
            DormandPrince::with_derivatives(t, 1)
        );
        let before = ALLOCATIONS.get();
        pair.run(&mut duals, [0.0, 1e-2], &mut q, &mut v, &Tolerance::default(), |_, _, _| ()).unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}: adaptive");
    }
}

/// What is done with factors, and the partition of a floating base.
#[test]
fn no_algebra_of_factors_allocates_in_a_call() {
    let mut floating = 0;
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 1, 1);
        let matrix = mass_matrix(&model, states.q(0)).unwrap();
        let ltdl = matrix.clone().into_ltdl().unwrap();
        let mut base = FloatingBase::new(t).ok();
        let joints = t.nv().saturating_sub(6);
        let (mut x, mut complement) = (states.tau(0).to_vec(), vec![0.0; joints * joints]);

        let before = ALLOCATIONS.get();
        ltdl.multiply_root(&mut x).unwrap();
        ltdl.multiply_root_transposed(&mut x).unwrap();
        ltdl.solve_root(&mut x).unwrap();
        ltdl.solve_root_transposed(&mut x).unwrap();
        assert!(ltdl.log_determinant().is_finite());
        if let Some(base) = &mut base {
            base.run(&matrix).unwrap();
            assert!(base.base_acceleration(&x).unwrap()[0].is_finite() && base.articulated_inertia()[0][0] > 0.0);
            base.joint_complement(&mut complement).unwrap();
            floating += 1;
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    }
    assert!(floating > 0);
}

/// On one core a batch without failures allocates nothing, in row order and in lane order.
#[test]
fn no_batch_allocates_in_a_call() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 21, 1);
        let (q, v, a, tau) = (&states.q, &states.v, &states.a, &states.tau);
        let (mut out, mut matrices) = (vec![0.0; v.len()], vec![0.0; 21 * t.stored()]);
        let lanes = |rows: &[f64], each| to_lanes(rows, each).unwrap();
        let (q_lanes, v_lanes, mut out_lanes) = (lanes(q, t.nq()), lanes(v, t.nv()), lanes(v, t.nv()));
        let forces: Vec<f64> = (0..21).flat_map(|_| wrenches(&model, 1)).flat_map(|f| f.to_array()).collect();
        let (force_lanes, forces) = (lanes(&forces, 6 * t.bodies()), Some(&forces[..]));
        let mut batch = Batch::<f64>::new(&model);
        batch.refined_forward_dynamics(q, v, tau, None, 1, &mut out).unwrap();

        let before = ALLOCATIONS.get();
        batch.inverse_dynamics(q, v, a, forces, &mut out).unwrap();
        batch.bias_force(q, v, forces, &mut out).unwrap();
        batch.forward_dynamics(q, v, tau, forces, &mut out).unwrap();
        batch.refined_forward_dynamics(q, v, tau, forces, 2, &mut out).unwrap();
        batch.mass_matrix(q, &mut matrices).unwrap();
        batch.factors(q, &mut matrices).unwrap();
        batch.solve(q, tau, &mut out).unwrap();
        batch.forward_dynamics(&q_lanes, &v_lanes, &v_lanes, Some(&force_lanes), &mut out_lanes).unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "{name}");
    }
}

/// Bytes that a value holds on the heap.
fn held<X>(make: impl FnOnce() -> X) -> (i64, X) {
    let before = HELD.get();
    let value = make();
    (HELD.get() - before, value)
}

/// Memory per joint of a chain of revolute joints, in bytes: what the documentation says. It is the same for each joint more, so linear.
#[test]
fn memory_per_joint_is_what_the_documentation_says() {
    let sizes = |n: i64| -> Vec<(&'static str, i64)> {
        let robot = describe(&format!("chain:n={n},layout=spatial"));
        let (model_bytes, model) = held(|| Model::<f64>::build(&robot).unwrap());
        let t = &model.topology;
        vec![
            ("Model", model_bytes),
            ("Rnea", held(|| Rnea::<f64>::new(t)).0),
            ("Aba", held(|| Aba::<f64>::new(t)).0),
            ("Twisted", held(|| Twisted::<f64>::with_cut(t, n as usize / 2).unwrap()).0),
            ("Kinematics", held(|| Kinematics::<f64>::new(t)).0),
            ("Energy", held(|| Energy::<f64>::new(t)).0),
            ("Momentum", held(|| Momentum::<f64>::new(t)).0),
            ("Refined", held(|| Refined::<Compensated>::new(t, 1)).0),
        ]
    };
    let (small, large, larger) = (sizes(200), sizes(400), sizes(600));
    let mut total = 0;
    let mut found = Vec::new();
    for (((name, small), (_, large)), (_, larger)) in small.into_iter().zip(large).zip(larger) {
        assert_eq!(large - small, larger - large, "{name} is linear");
        found.push((name, (large - small) / 200));
        if name == "Model" || name == "Aba" {
            total += (large - small) / 200;
        }
    }
    // q, v, τ and v̇ are four numbers more.
    assert!(total + 32 <= 1000, "{total} bytes per joint for model and ABA");
    // The numbers of 8 bytes of each link, of a joint's parameters and of its place in the tree. Kinematics keeps a label in 8 bytes more.
    let (x, motion, inertia, vector) = (12, 6, 21, 3);
    let model = 8 * (x + motion + 10 + 3 + 2) + 1 + 56 + 8 + 16 + 8;
    let rnea = 8 * (x + motion);
    let aba = 8 * (x + inertia + 3 * motion + 2);
    let braced = 8 * (x + 10 + vector + inertia + 4 * motion + 1);
    let kinematics = 8 * (2 * x + vector + 3 * motion + 1);
    let documented = [
        ("Model", model),
        ("Rnea", rnea),
        ("Aba", aba),
        ("Twisted", (aba + braced) / 2),
        ("Kinematics", kinematics),
        ("Energy", kinematics),
        ("Momentum", kinematics + 8 * (1 + vector + motion)),
        // two numbers for each of RNEA, q, v, a, τ and the wrench; residual, correction and M δ
        ("Refined", aba + 2 * rnea + 16 * (4 + motion) + 8 * (2 + 2 * motion)),
    ];
    assert_eq!(found, documented);
    let bytes: Vec<i64> = documented.map(|(_, bytes)| bytes).to_vec();
    assert_eq!(bytes, [353, 144, 424, 496, 368, 368, 448, 984], "the table of the crate's documentation");
}
