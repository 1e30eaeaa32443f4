//! Lagrange's equations from positions alone, differentiated by nested dual numbers.
//!
//! Computes the bodies' positions as functions of q. The innermost dual number moves q along v: so it gives velocities without any formula
//! for them. With Σ = ½tr(I)·1 − I, the second moment of mass about the centre of mass, and A the armature:
//!
//! ```text
//! L(q, v) = Σ_b ½ m |ċ|² + ½ tr(Ṙ Σ Ṙᵀ) + m g·c  + ½ Σ A v²
//! τ_i = d/dt ∂L/∂v_i − ∂L/∂q_i          M_ij = ∂²L/∂v_i∂v_j
//! ```
//!
//! The two outer levels are (v along the i-th unit vector) and (q along v, v along a). The coefficient of their product is d/dt ∂L/∂v_i.
//! There are no angular velocities, no Jacobians and no Coriolis terms. It is for joints whose q is as long as their v (revolute,
//! prismatic, helical, planar, universal, …). Source: Lagrange (1788), II.4; dual numbers as in `scalar.rs`.
//! Cost: O(bodies) per τ_i and per entry of M, with eight multi-precision numbers per number: usable for few degrees of freedom.

use crate::linear::{Factors, Matrix};
use crate::robot::{Kind, Robot};
use crate::scalar::{Dual, Scalar};
use crate::space::{Mat3, Vec3};
use crate::{Error, Mp};
use std::array::from_fn;

/// Two directions of differentiation at once.
type Hyper = Dual<Dual<Mp>>;

/// A body's rotation and origin, with their rates.
type Pose<T> = (Mat3<Dual<T>>, Vec3<Dual<T>>);

fn hyper(value: &Mp, first: &Mp, second: &Mp) -> Hyper {
    Dual { value: Dual { value: value.clone(), rate: first.clone() }, rate: Dual { value: second.clone(), rate: Mp::zero() } }
}

/// τ = ID(q, v, a) of a robot without spherical and free joints.
///
/// # Errors
/// [`Error::Length`], or [`Error::Unsupported`] naming a joint whose coordinates are not a vector.
pub fn inverse_dynamics(robot: &Robot, q: &[Mp], v: &[Mp], a: &[Mp]) -> Result<Vec<Mp>, Error> {
    Robot::check("a", a.len(), robot.nv())?;
    check(robot, q, v)?;
    let (one, zero) = (robot.precision().integer(1), Mp::zero());
    let unit = |i: usize, k: usize| if i == k { one.clone() } else { zero.clone() };
    let torque = |i: usize| {
        let along = |x: &[Mp], first: &dyn Fn(usize) -> Mp, second: &[Mp]| -> Vec<Hyper> {
            x.iter().zip(second).enumerate().map(|(k, (x, second))| hyper(x, &first(k), second)).collect()
        };
        // First direction: v_i. Second: time, along which q moves by v and v by a.
        let momentum_rate = lagrangian(robot, &along(q, &|_| zero.clone(), v), &along(v, &|k| unit(i, k), a)).rate.rate;
        let still = vec![zero.clone(); v.len()];
        let slope = lagrangian(robot, &along(q, &|k| unit(i, k), &still), &along(v, &|_| zero.clone(), &still)).value.rate;
        momentum_rate - slope
    };
    Ok((0..robot.nv()).map(torque).collect())
}

/// M(q) = ∂²L/∂v² of a robot without spherical and free joints.
///
/// # Errors
/// As [`inverse_dynamics`].
pub fn mass_matrix(robot: &Robot, q: &[Mp]) -> Result<Matrix, Error> {
    let n = robot.nv();
    let (one, zero) = (robot.precision().integer(1), Mp::zero());
    check(robot, q, &vec![zero.clone(); n])?;
    let constant: Vec<Hyper> = q.iter().map(Hyper::constant).collect();
    let mut mass = Matrix::zero(n);
    for i in 0..n {
        for j in 0..=i {
            let unit = |i: usize, k: usize| if i == k { &one } else { &zero };
            let v: Vec<Hyper> = (0..n).map(|k| hyper(&zero, unit(i, k), unit(j, k))).collect();
            let entry = lagrangian(robot, &constant, &v).rate.rate;
            mass.set(j, i, entry.clone());
            mass.set(i, j, entry);
        }
    }
    Ok(mass)
}

/// q̈ = FD(q, v, τ) of a robot without spherical and free joints.
///
/// # Errors
/// As [`inverse_dynamics`], or [`Error::NotPositiveDefinite`].
pub fn forward_dynamics(robot: &Robot, q: &[Mp], v: &[Mp], tau: &[Mp]) -> Result<Vec<Mp>, Error> {
    Robot::check("tau", tau.len(), robot.nv())?;
    let bias = inverse_dynamics(robot, q, v, &vec![Mp::zero(); robot.nv()])?;
    let force: Vec<Mp> = tau.iter().zip(&bias).map(|(tau, h)| tau - h).collect();
    Ok(Factors::new(&mass_matrix(robot, q)?)?.solve(&force))
}

fn check(robot: &Robot, q: &[Mp], v: &[Mp]) -> Result<(), Error> {
    if let Some(body) = robot.bodies.iter().find(|body| matches!(body.kind, Kind::Spherical | Kind::Free)) {
        return Err(Error::Unsupported { body: body.name.clone(), kind: body.word });
    }
    Robot::check("q", q.len(), robot.nq())?;
    Robot::check("v", v.len(), robot.nv())
}

/// L(q, v) over any scalar, by one more dual number.
fn lagrangian<T: Scalar>(robot: &Robot, q: &[T], v: &[T]) -> T {
    let moving: Vec<Dual<T>> = q.iter().zip(v).map(|(q, v)| Dual { value: q.clone(), rate: v.clone() }).collect();
    let mut twice = robot.armature.iter().zip(v).fold(T::zero(), |sum, (armature, v)| sum.plus(&T::constant(armature).times(v).times(v)));
    let mut work = T::zero();
    let mut poses: Vec<Pose<T>> = Vec::with_capacity(robot.bodies());
    for body in &robot.bodies {
        let (across, shift) = displacement(robot, &body.kind, &moving[body.q..]);
        let (turned, moved) = (Mat3::constant(&body.rotation), Vec3::constant(&body.translation));
        let (in_parent, at_parent) = (turned.product(&across), moved.plus(&turned.apply(&shift)));
        let (rotation, origin) = match body.parent {
            Some(parent) => {
                let (rotation, origin) = &poses[parent];
                (rotation.product(&in_parent), origin.plus(&rotation.apply(&at_parent)))
            }
            None => (in_parent, at_parent),
        };
        let center = origin.plus(&rotation.apply(&Vec3::constant(&body.com)));
        let mass = T::constant(&body.mass);
        for i in 0..3 {
            let rate = &center.0[i].rate;
            twice = twice.plus(&rate.times(rate).times(&mass));
            work = work.plus(&center.0[i].value.times(&mass).times(&T::constant(&robot.gravity.0[i])));
            // Row i of Ṙ: its quadratic form with Σ.
            let rates = Vec3::<T>(from_fn(|j| rotation.0[i].0[j].rate.clone()));
            twice = twice.plus(&rates.dot(&Mat3::constant(&second_moment(&body.inertia)).apply(&rates)));
        }
        poses.push((rotation, origin));
    }
    twice.half().plus(&work)
}

/// Σ = ½tr(I)·1 − I.
fn second_moment(inertia: &Mat3<Mp>) -> Mat3<Mp> {
    let half_trace = (0..3).map(|i| inertia.0[i].0[i].clone()).sum::<Mp>().half();
    Mat3(from_fn(|i| {
        Vec3(from_fn(|j| {
            let entry = -&inertia.0[i].0[j];
            if i == j { entry + &half_trace } else { entry }
        }))
    }))
}

/// Rotation and translation across a joint whose coordinates are a vector.
fn displacement<T: Scalar>(robot: &Robot, kind: &Kind, q: &[T]) -> (Mat3<T>, Vec3<T>) {
    let exact_one = robot.precision().integer(1);
    let one = T::constant(&exact_one);
    let unit = |i: usize| Vec3::<T>(from_fn(|j| if i == j { one.clone() } else { T::zero() }));
    let still = || Mat3(from_fn(unit));
    match kind {
        Kind::Revolute(u) => (Mat3::turn(&Vec3::constant(u), &q[0], &one), Vec3::zero()),
        Kind::Prismatic(u) => (still(), Vec3::constant(u).times(&q[0])),
        Kind::Helical(u, pitch) => {
            let axis = Vec3::constant(u);
            (Mat3::turn(&axis, &q[0], &one), axis.times(&T::constant(pitch)).times(&q[0]))
        }
        Kind::Planar => (Mat3::turn(&unit(2), &q[2], &one), Vec3([q[0].clone(), q[1].clone(), T::zero()])),
        Kind::Universal => (Mat3::turn(&unit(0), &q[0], &one).product(&Mat3::turn(&unit(1), &q[1], &one)), Vec3::zero()),
        Kind::Translation => (still(), Vec3(from_fn(|i| q[i].clone()))),
        Kind::Cylindrical(u) => (Mat3::turn(&Vec3::constant(u), &q[0], &one), Vec3::constant(u).times(&q[1])),
        Kind::EulerZyx => {
            let [z, y, x] = from_fn(|k| Mat3::turn(&unit(2 - k), &q[k], &one));
            (z.product(&y).product(&x), Vec3::zero())
        }
        // `check` has returned an error before.
        Kind::Spherical | Kind::Free => (still(), Vec3::zero()),
    }
}
