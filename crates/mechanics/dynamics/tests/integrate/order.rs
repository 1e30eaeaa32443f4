//! The order of each integrator on every kind of joint, by the slope of its error.

use crate::common;

use common::{ROBOTS, build, larger, lifted, one_of, within};
use featherbench_dynamics::integrate::{
    DormandPrince, Dynamics, ImplicitMidpoint, Instant, Integrator, RungeKutta4, SymplecticEuler, System,
};
use featherbench_model::{Model, difference};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Angle, DoubleDouble, Force, Lift, Vec3};

/// Springs and dampers at each joint, and wrenches that change with time.
#[derive(Clone, Copy)]
struct Shaken;

impl System for Shaken {
    fn has_wrenches(&self) -> bool {
        true
    }

    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], wrenches: &mut [Force<T>]) {
        for (tau, v) in tau.iter_mut().zip(at.v) {
            *tau -= T::from_f64(0.2) * *v;
        }
        let (sin, cos) = (at.time * T::from_f64(3.0)).sin_cos();
        for wrench in wrenches {
            *wrench = Force::new(Vec3::new(sin, cos, T::zero()) * T::from_f64(0.3), Vec3::new(cos, T::zero(), sin));
        }
    }
}

/// The state after a time in `steps` equal steps from a state of the batch.
fn after<T: Angle, I: Integrator<T>>(
    integrator: &mut I,
    model: &Model<f64>,
    states: &StateBatch,
    time: f64,
    steps: usize,
) -> (Vec<T>, Vec<T>)
where
    f64: Lift<T>,
{
    let mut f = Dynamics::new(model, Shaken, &[]).unwrap();
    let (mut q, mut v): (Vec<T>, Vec<T>) = (lifted(states.q(0)), lifted(states.v(0)));
    let h = T::from_f64(time) / T::from_f64(steps as f64);
    for step in 0..steps {
        integrator.step(&mut f, h * T::from_f64(step as f64), h, &mut q, &mut v).unwrap();
    }
    (q, v)
}

/// The distance of a state from the true one, in 32 digits.
fn error<T: Angle + Lift<DoubleDouble>>(
    model: &Model<f64>,
    truth: &(Vec<DoubleDouble>, Vec<DoubleDouble>),
    found: &(Vec<T>, Vec<T>),
) -> f64 {
    let q: Vec<DoubleDouble> = found.0.iter().map(|x| x.lift()).collect();
    let way = difference(&model.topology, &truth.0, &q).unwrap();
    let speeds = found.1.iter().zip(&truth.1).map(|(found, truth)| Lift::<DoubleDouble>::lift(*found) - *truth);
    way.into_iter().chain(speeds).fold(0.0, |gap, x| larger(gap, x.to_f64().abs()))
}

/// The slope of the error between two numbers of steps is the order.
fn check<I: Integrator<DoubleDouble>>(
    name: &str,
    model: &Model<f64>,
    truth: &(Vec<DoubleDouble>, Vec<DoubleDouble>),
    mut integrator: I,
    steps: usize,
    states: &StateBatch,
) {
    let [coarse, fine] = [steps, 2 * steps].map(|steps| error(model, truth, &after(&mut integrator, model, states, TIME, steps)));
    let slope = (coarse / fine).log2();
    // The next term of the error is about h times the robot's rates smaller.
    within(&format!("{name}: order {} by the errors {coarse:.1e} and {fine:.1e}", I::ORDER), (slope - f64::from(I::ORDER)).abs(), 0.15);
}

const TIME: f64 = 0.05;

#[test]
fn the_error_falls_at_the_order() {
    for (name, recipe) in ROBOTS.iter().step_by(one_of(2)) {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 1, 3);
        let truth = after(&mut DormandPrince::<DoubleDouble>::new(t), &model, &states, TIME, 512);
        check(&format!("symplectic Euler, {name}"), &model, &truth, SymplecticEuler::new(t), 256, &states);
        check(&format!("midpoint, {name}"), &model, &truth, ImplicitMidpoint::new(t), 64, &states);
        check(&format!("Runge–Kutta, {name}"), &model, &truth, RungeKutta4::new(t), 32, &states);
        check(&format!("Dormand–Prince, {name}"), &model, &truth, DormandPrince::new(t), 64, &states);
    }
}

/// A step in doubles is that in double-double up to rounding.
#[test]
fn doubles_lose_only_roundings() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 1, 3);
        macro_rules! check {
            ($($method:ident),+) => {$(
                let truth = after(&mut $method::<DoubleDouble>::new(t), &model, &states, TIME, 4);
                let found = after(&mut $method::<f64>::new(t), &model, &states, TIME, 4);
                // Accelerations of up to 10³ with some roundings of their size, over a twentieth of a second.
                within(&format!("{}, {name}: rounding", stringify!($method)), error(&model, &truth, &found), 5e-14);
            )+};
        }
        check!(SymplecticEuler, ImplicitMidpoint, RungeKutta4, DormandPrince);
    }
}
