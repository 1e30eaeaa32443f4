//! The integrators of the kernels against closed forms: errors fall at the order, to the motion of the textbook.

use featherbench_dynamics::integrate::{
    DormandPrince, Dynamics, ImplicitMidpoint, Integrator, Passive, RungeKutta4, SymplecticEuler, Tolerance,
};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_reference::closed::{DoublePendulum, FreeTop, HeavyTop, Pendulum};
use featherbench_reference::{Mp, Precision, nearest_doubles};
use featherbench_spatial::{Motion, Quaternion, Vec3};

fn number(x: f64) -> Mp {
    Precision::bits(160).number(x).unwrap()
}

fn body(parent: Option<usize>, mass: f64, com: [f64; 3], inertia: [f64; 6], kind: JointType, at: [f64; 3]) -> BodyDescription {
    let placement = Placement { translation: at, ..Placement::default() };
    let joint = JointDescription { kind, placement, ..JointDescription::default() };
    BodyDescription { name: format!("below {parent:?}"), parent, mass, com, inertia, joint }
}

fn build(gravity: f64, bodies: Vec<BodyDescription>) -> Model<f64> {
    Model::build(&Description { gravity: [0.0, 0.0, -gravity], bodies, ..Description::default() }).unwrap()
}

fn double(x: &Mp) -> f64 {
    nearest_doubles(std::slice::from_ref(x))[0]
}

/// The errors of one method after `time` with `steps`, `2·steps` and `4·steps` equal steps fall at the order.
fn falls<I: Integrator<f64>>(
    name: &str,
    mut integrator: I,
    model: &Model<f64>,
    start: (&[f64], &[f64]),
    time: f64,
    steps: usize,
    error: &dyn Fn(&[f64], &[f64]) -> f64,
) {
    let errors = [steps, 2 * steps, 4 * steps].map(|steps| {
        let mut f = Dynamics::new(model, Passive, &[]).unwrap();
        let (mut q, mut v) = (start.0.to_vec(), start.1.to_vec());
        let h = time / steps as f64;
        for step in 0..steps {
            integrator.step(&mut f, h * step as f64, h, &mut q, &mut v).unwrap();
        }
        error(&q, &v)
    });
    assert!(errors[0] > errors[1], "{name}: {errors:?}");
    // The shortest steps decide: there the terms after the first are about a tenth of it, or less.
    let slope = (errors[1] / errors[2]).log2();
    let off = (slope - f64::from(I::ORDER)).abs();
    assert!(off < 0.2, "{name}: order {slope} by the errors {errors:?}");
}

/// Each method, with steps that leave errors far above rounding; then steps by a tolerance.
macro_rules! all_fall {
    ($model:expr, $q:expr, $v:expr, $time:expr, $steps:expr, $error:expr) => {
        let (t, model) = (&$model.topology, &$model);
        falls("symplectic Euler", SymplecticEuler::new(t), model, ($q, $v), $time, 64 * $steps, $error);
        falls("midpoint", ImplicitMidpoint::new(t), model, ($q, $v), $time, 16 * $steps, $error);
        falls("Runge–Kutta", RungeKutta4::new(t), model, ($q, $v), $time, 4 * $steps, $error);
        falls("Dormand–Prince", DormandPrince::new(t), model, ($q, $v), $time, 2 * $steps, $error);
        let (mut q, mut v) = ($q.to_vec(), $v.to_vec());
        let tolerance = Tolerance { absolute: 1e-12, relative: 1e-12, ..Tolerance::default() };
        let mut f = Dynamics::new(model, Passive, &[]).unwrap();
        DormandPrince::new(t).run(&mut f, [0.0, $time], &mut q, &mut v, &tolerance, |_, _, _| ()).unwrap();
        let error = $error(&q, &v);
        // Some hundred steps, each with its tolerance.
        assert!(error < 1e-9, "adaptive: {error:e}");
    };
}

#[test]
fn pendulum_swings_and_turns_as_elliptic_functions_say() {
    // ω₀² = m g l/(m l²) = 4: one kilogramme at two metres, g = 8
    let model = build(8.0, vec![body(None, 1.0, [0.0, 0.0, -2.0], [0.0; 6], JointType::Revolute { axis: [0.0, 1.0, 0.0] }, [0.0; 3])]);
    for rate in [3.0, 5.0] {
        let exact = Pendulum::passing(&number(2.0), &number(rate)).unwrap();
        let (angle, speed) = exact.at(&number(1.25));
        let (angle, speed) = (double(&angle), double(&speed));
        let error = |q: &[f64], v: &[f64]| (q[0] - angle).abs() + (v[0] - speed).abs();
        all_fall!(model, &[0.0], &[rate], 1.25, 16, &error);
    }
}

/// The closed form has accelerations only: it is integrated beside the kernels by the same method, and gives the same motion.
#[test]
fn double_pendulum_moves_with_the_accelerations_of_the_textbook() {
    let (mass, length, gravity) = ([1.5, 0.75], [1.0, 0.5], 9.75);
    let rod = |k: usize, parent, at: [f64; 3]| {
        let i = mass[k] * length[k] * length[k] / 12.0;
        body(parent, mass[k], [0.0, 0.0, length[k] / 2.0], [i, 0.0, 0.0, i, 0.0, 0.0], JointType::Revolute { axis: [0.0, 1.0, 0.0] }, at)
    };
    let model = build(gravity, vec![rod(0, None, [0.0; 3]), rod(1, Some(0), [0.0, 0.0, length[0]])]);
    let exact = DoublePendulum::uniform(mass.map(number), length.map(number), number(gravity));
    let mut textbook = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
        let pair = |x: &[f64]| [number(x[0]), number(x[1])];
        let found = exact.acceleration(&pair(q), &pair(v), &pair(&[0.0, 0.0]));
        a.copy_from_slice(&nearest_doubles(&found));
        Ok(())
    };
    let mut kernels = Dynamics::new(&model, Passive, &[]).unwrap();
    let mut integrator = RungeKutta4::new(&model.topology);
    let ((mut q, mut v), (mut p, mut w)) = (([0.5, -1.0], [0.0, 2.0]), ([0.5, -1.0], [0.0, 2.0]));
    for _ in 0..100 {
        integrator.step(&mut textbook, 0.0, 0.01, &mut q, &mut v).unwrap();
        integrator.step(&mut kernels, 0.0, 0.01, &mut p, &mut w).unwrap();
    }
    assert!((q[0] - 0.5).abs() > 0.5, "it has fallen: {q:?}");
    for k in 0..2 {
        // Accelerations of up to a hundred with a few roundings, over one second in which errors grow e-fold about ten times.
        assert!((q[k] - p[k]).abs() < 1e-11 && (v[k] - w[k]).abs() < 1e-11, "{q:?} {p:?} {v:?} {w:?}");
    }
}

#[test]
fn free_top_turns_as_elliptic_functions_say() {
    let moments = [0.5, 0.875, 1.25];
    let inertia = [moments[0], 0.0, 0.0, moments[1], 0.0, moments[2]];
    let model = build(9.75, vec![body(None, 1.0, [0.0; 3], inertia, JointType::Spherical, [0.0; 3])]);
    let exact = FreeTop::new(moments.map(number), &number(1.5), &number(2.0)).unwrap();
    let omega = nearest_doubles(&exact.at(&number(2.0)));
    // The attitude has no closed form here; angular momentum in world axes is what it must keep.
    let momentum = |q: &[f64], v: &[f64]| {
        let rotation = Quaternion::from_array([q[0], q[1], q[2], q[3]]).to_rotation();
        (rotation * Vec3::new(moments[0] * v[0], moments[1] * v[1], moments[2] * v[2])).to_array()
    };
    let (q, v) = ([0.0, 0.0, 0.0, 1.0], [1.5, 0.0, 2.0]);
    let before = momentum(&q, &v);
    let error = |q: &[f64], v: &[f64]| {
        let rates = (0..3).map(|k| (v[k] - omega[k]).abs()).sum::<f64>();
        rates + momentum(q, v).iter().zip(before).map(|(x, y)| (x - y).abs()).sum::<f64>()
    };
    all_fall!(model, &q, &v, 2.0, 16, &error);
}

#[test]
fn heavy_top_precesses_steadily() {
    // A ball joint at the origin, the centre on the symmetry axis z: A = 0.5, C = 0.25, m g l = 2
    let (transverse, axial, weight) = (0.5, 0.25, 2.0);
    let (mass, reach, gravity) = (1.0, 0.25, 8.0);
    let about_com = transverse - mass * reach * reach;
    let inertia = [about_com, 0.0, 0.0, about_com, 0.0, axial];
    let model = build(gravity, vec![body(None, mass, [0.0, 0.0, reach], inertia, JointType::Spherical, [0.0; 3])]);
    let top = HeavyTop { transverse: number(transverse), axial: number(axial), weight: number(weight) };
    let tilt = 0.5_f64;
    let [slow, _] = top.steady(&number(tilt), &number(10.0)).unwrap();
    let (precession, spin) = (double(&slow.precession), double(&slow.spin));
    // R = R_z(φ) R_x(θ) R_z(ψ)
    let attitude = |time: f64| {
        let turn = |axis: [f64; 3], angle: f64| Quaternion::exp(Vec3::from_array(axis.map(|x| x * angle)));
        (turn([0.0, 0.0, 1.0], precession * time) * turn([1.0, 0.0, 0.0], tilt) * turn([0.0, 0.0, 1.0], spin * time)).to_array()
    };
    let rates = |time: f64| nearest_doubles(&slow.body_rates(&number(spin * time)).0);
    let time = 0.75;
    let (end_q, end_v) = (attitude(time), rates(time));
    let error = |q: &[f64], v: &[f64]| {
        let way = Quaternion::from_array(end_q).conjugate() * Quaternion::from_array([q[0], q[1], q[2], q[3]]);
        way.log().norm() + (0..3).map(|k| (v[k] - end_v[k]).abs()).sum::<f64>()
    };
    all_fall!(model, &attitude(0.0), &rates(0.0), time, 16, &error);
}

/// A thrown body: its centre falls on a parabola, and a screw motion without forces is what one step of any length makes.
#[test]
fn what_the_group_describes_is_exact_in_one_step() {
    let inertia = [0.5, 0.0, 0.0, 0.5, 0.0, 1.25];
    let model = build(0.0, vec![body(None, 2.0, [0.0; 3], inertia, JointType::Free, [0.0; 3])]);
    let (mut q, mut v) = ([1.0_f64, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.7, 0.0, 0.0, 5.0]);
    let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
    RungeKutta4::new(&model.topology).step(&mut f, 0.0, 1.0, &mut q, &mut v).unwrap();
    let (turn, shift) = Motion::new(Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, 0.7)).exp();
    for (found, expected) in q.iter().zip([1.0 + shift.x, 2.0 + shift.y, 3.0 + shift.z].into_iter().chain(turn.to_array())) {
        assert!((found - expected).abs() < 8.0 * f64::EPSILON, "{q:?}");
    }
}
