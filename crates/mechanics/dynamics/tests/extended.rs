//! Dual numbers over double-double run through the kernels: derivatives with thirty digits.

use crate::common;

use common::{ROBOTS, build, lifted, within};
use featherbench_dynamics::inverse_dynamics;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Compensated, DoubleDouble, Dual, Lift, Real};

fn dd(x: f64) -> DoubleDouble {
    DoubleDouble::from_f64(x)
}

/// Numbers that move with the given rates.
fn moving<T: Real>(values: &[f64], rates: &[f64]) -> Vec<Dual<T>>
where
    f64: Lift<T>,
{
    values.iter().zip(rates).map(|(value, rate)| Dual::new(value.lift(), rate.lift())).collect()
}

/// Inverse dynamics is linear in the acceleration: its derivative is a difference without a remainder.
#[test]
fn the_derivative_by_acceleration_is_a_difference() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 2, 12);
        for k in 0..states.count() {
            let (q, v, a, direction) = (states.q(k), states.v(k), states.a(k), states.tau(k));
            let (still_q, still_v) = (vec![0.0; q.len()], vec![0.0; v.len()]);
            let tau = inverse_dynamics(&model, &moving::<DoubleDouble>(q, &still_q), &moving(v, &still_v), &moving(a, direction)).unwrap();
            let moved: Vec<DoubleDouble> = a.iter().zip(direction).map(|(a, rate)| DoubleDouble::from_sum(*a, *rate)).collect();
            let moved = inverse_dynamics(&model, &lifted(q), &lifted(v), &moved).unwrap();
            for (tau, moved) in tau.iter().zip(&moved) {
                // Some hundred operations on numbers of up to a hundred, each good to a few 2⁻¹⁰⁶.
                within(name, (tau.derivative - (*moved - tau.value)).to_f64().abs(), 1e-28);
            }
        }
    }
}

/// The derivative by joint angles, against a central difference with a step of 10⁻⁹, whose own error is of order 10⁻¹⁸.
#[test]
fn the_derivative_by_configuration_is_a_limit_of_differences() {
    let model = build(&ROBOTS[0].1);
    let states = StateBatch::random(&model, 3, 4);
    for k in 0..states.count() {
        let (q, v, a, direction) = (states.q(k), states.v(k), states.a(k), states.tau(k));
        let still = vec![0.0; v.len()];
        let step = dd(1e-9);
        let at = |sign: f64| {
            let q: Vec<DoubleDouble> = q.iter().zip(direction).map(|(q, rate)| dd(*rate).mul_add(step * dd(sign), dd(*q))).collect();
            inverse_dynamics(&model, &q, &lifted(v), &lifted(a)).unwrap()
        };
        let (ahead, behind) = (at(1.0), at(-1.0));
        let tau = inverse_dynamics(&model, &moving::<DoubleDouble>(q, direction), &moving(v, &still), &moving(a, &still)).unwrap();
        let compensated = inverse_dynamics(&model, &moving::<Compensated>(q, direction), &moving(v, &still), &moving(a, &still)).unwrap();
        for i in 0..v.len() {
            let difference = (ahead[i] - behind[i]) / (step + step);
            // Third derivatives of a chain of eight are up to some thousands; the difference itself is good to 1e-29/1e-9.
            within("∂ID/∂q", (tau[i].derivative - difference).to_f64().abs(), 1e-14);
            within("∂ID/∂q, compensated", (compensated[i].derivative.to_double_double() - tau[i].derivative).to_f64().abs(), 1e-28);
        }
    }
}
